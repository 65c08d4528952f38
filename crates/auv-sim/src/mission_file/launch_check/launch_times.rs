//! When the mission is home, and until when it can be launched.

use super::answer::LaunchCheck;
use auv_mission::{Mission, Outlook, Stop};
use auv_types::{Violation, Violations};

/// Launches tried before the latest is searched more closely.
const COARSE: u32 = 24;
/// The latest launch is found to this, seconds.
const CLOSE_S: f64 = 1.0;

/// Adds the margin and the problem of a mission that has no way home in time.
pub(super) fn fill_in(
    check: &mut LaunchCheck,
    (mission, problems): (&Mission, &Violations),
    (outlook, stops): (&Outlook<'_>, &[Stop]),
) {
    let due_s = mission.launch_s + mission.budget_s;
    check.margin_s = stops.last().map(|home| due_s - home.leave_s);
    let home_s = |delay_s: f64| home_s(mission, outlook, delay_s);
    let margin_s = margin_s(mission, outlook, 0.0);
    // What the current may be to blame for.
    let against = |wrong: &Violation| {
        mission.current.is_some() && ["current", "budget_s"].contains(&&*wrong.place)
    };
    let only = problems.list().iter().all(against) && check.problems.len() == problems.list().len();
    if only && margin_s < 0.0 {
        check.go = false;
        let enough_s = mission.budget_s - mission.reserve_s;
        let told = later_launch(enough_s, home_s).map(|delay_s| against_it(margin_s, delay_s));
        if told.is_some() || check.problems.is_empty() {
            let too_long = || "budget_s: is too short for the quickest way home; give more".into();
            check.problems = vec![told.unwrap_or_else(too_long)];
        }
    }
}

/// Adds the latest launch.
pub(super) fn fill_in_latest(
    check: &mut LaunchCheck,
    mission: &Mission,
    outlook: &Outlook<'_>,
    goes_later: impl Fn(f64) -> bool,
) {
    if check.go {
        let goes = |delay_s| margin_s(mission, outlook, delay_s) >= 0.0 && goes_later(delay_s);
        check.latest_launch_s = latest(mission.budget_s, goes);
    }
}

/// When a mission that does nothing else and is launched later is home, seconds.
fn home_s(mission: &Mission, outlook: &Outlook<'_>, delay_s: f64) -> f64 {
    let launch_s = mission.launch_s + delay_s;
    outlook.home_s(&outlook.earliest_from(mission.start, launch_s, &[]))
}

/// How long before its reserve begins it is home, seconds.
fn margin_s(mission: &Mission, outlook: &Outlook<'_>, delay_s: f64) -> f64 {
    let due_s = mission.launch_s + mission.budget_s - mission.reserve_s;
    due_s - home_s(mission, outlook, delay_s)
}

/// The longest delay up to `most_s` that goes, if there is one.
fn latest(most_s: f64, goes: impl Fn(f64) -> bool) -> Option<f64> {
    let step_s = most_s / f64::from(COARSE);
    let mut steps = (0..COARSE).rev().map(|k| f64::from(k) * step_s);
    let mut low_s = steps.find(|&delay_s| delay_s <= 0.0 || goes(delay_s))?;
    let mut high_s = low_s + step_s;
    while high_s - low_s > CLOSE_S {
        let middle_s = low_s.midpoint(high_s);
        *if goes(middle_s) {
            &mut low_s
        } else {
            &mut high_s
        } = middle_s;
    }
    (low_s > 0.0).then_some(low_s)
}

/// The first launch later than planned, of those tried, that is home after at most `enough_s`.
fn later_launch(enough_s: f64, home_s: impl Fn(f64) -> f64) -> Option<f64> {
    let step_s = enough_s / f64::from(COARSE);
    let mut delays = (1..=4 * COARSE).map(|k| f64::from(k) * step_s);
    delays.find(|delay_s| home_s(*delay_s) - delay_s <= enough_s)
}

/// What is said of a mission that the current keeps from getting home in time, and that would at another launch.
fn against_it(margin_s: f64, delay_s: f64) -> String {
    let what = if margin_s.is_finite() {
        let by_s = -margin_s;
        format!("the quickest way home against it takes {by_s:.0} s too long")
    } else {
        "lets no way lead home".into()
    };
    format!("current: {what}; launch {delay_s:.0} s later")
}
