//! Checks of a planner, and those it failed.

use std::fmt;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// One check that a planner failed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedCheck {
    /// The claim that does not hold.
    pub check: &'static str,
    /// What happened instead.
    pub reason: String,
}

impl fmt::Display for FailedCheck {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.check, self.reason)
    }
}

/// All checks that a planner failed, one a line when displayed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FailedChecks(pub Vec<FailedCheck>);

impl FailedChecks {
    /// All failures of several parts of a kit.
    pub(super) fn joined<const N: usize>(parts: [Vec<FailedCheck>; N]) -> Result<(), Self> {
        let failures: Vec<_> = parts.into_iter().flatten().collect();
        if failures.is_empty() {
            Ok(())
        } else {
            Err(Self(failures))
        }
    }
}

impl fmt::Display for FailedChecks {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, failure) in self.0.iter().enumerate() {
            let separator = if i == 0 { "" } else { "\n" };
            write!(f, "{separator}{failure}")?;
        }
        Ok(())
    }
}

impl std::error::Error for FailedChecks {}

/// What happened instead, where a claim does not hold.
pub(super) type CheckResult = Result<(), String>;

/// A claim and how it is checked.
pub(super) type Check<'a> = (&'static str, &'a dyn Fn() -> CheckResult);

/// Runs all checks and says which begins; a panic fails the check it happens in.
pub(super) fn run_all(began: &dyn Fn(&'static str), checks: &[Check<'_>]) -> Vec<FailedCheck> {
    checks
        .iter()
        .filter_map(|&(check, claim)| {
            began(check);
            let outcome = catch_unwind(AssertUnwindSafe(claim));
            let reason = outcome
                .unwrap_or_else(|_| Err("the planner panics".into()))
                .err()?;
            Some(FailedCheck { check, reason })
        })
        .collect()
}

pub(super) fn ensure(holds: bool, otherwise: impl FnOnce() -> String) -> CheckResult {
    if holds { Ok(()) } else { Err(otherwise()) }
}
