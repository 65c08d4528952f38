//! What the kit says of a planner with one fault.

use auv_planning::PlanError;
use auv_verify::conformance::FailedChecks;

/// The error of a planner that gives up.
pub(crate) fn gives_up() -> PlanError {
    PlanError::Failed {
        planner: "faulty".into(),
        reason: "on purpose".into(),
    }
}

/// Never ends.
pub(crate) fn hangs() -> ! {
    loop {
        std::thread::park();
    }
}

/// Each check fails for a reason that begins as given.
#[track_caller]
pub(crate) fn assert_said(outcome: Result<(), FailedChecks>, expected: &[(&str, &str)]) {
    let failures = outcome.unwrap_err().0;
    for (check, reason) in expected {
        let said = failures
            .iter()
            .find(|failure| failure.check == *check)
            .map(|failure| failure.reason.as_str());
        let is_said = said.is_some_and(|said| said.starts_with(reason));
        assert!(
            is_said,
            "\"{check}\" says {said:?}, not {reason:?}: {failures:#?}"
        );
    }
}

/// Whether the kit fails a check.
pub(crate) fn blames(outcome: &Result<(), FailedChecks>, check: &str) -> bool {
    let failures = outcome.as_ref().err().map(|failed| &failed.0);
    failures.is_some_and(|all| all.iter().any(|failure| failure.check == check))
}
