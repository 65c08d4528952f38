//! How a mission ends, and the tables it leaves.

use auv_graph::NodeId;
use std::fmt;

/// How a mission ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum Outcome {
    /// The destination was reached within the budget.
    Docked,
    /// The destination was reached after the budget.
    Late,
    /// The mission ended elsewhere.
    Aborted(AbortReason),
}

/// Why a mission ended elsewhere than at its destination.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum AbortReason {
    /// No way leads to the destination any more.
    Unreachable,
    /// The vehicle made no progress for `max_shut_in_s`: no path led to any waypoint.
    ShutIn,
    /// No path led to any waypoint, and the energy left is needed to surface.
    EnergySpent,
    /// The mission lasted `timeout_factor` times its budget.
    TimedOut,
    /// The clock ran backwards, stood still for too long or was not a number.
    BadClock,
    /// The position was lost for longer than dead reckoning is trusted.
    BadPosition,
    /// The sonar was silent for too long.
    SonarLost,
    /// The altitude above the sea bed was not measured for too long.
    NoAltitude,
    /// The measured altitude was below half the least altitude: the sea bed is not as charted.
    TooLow,
    /// The vehicle left one trajectory after the other without getting nearer to its target, or reported that it
    /// cannot follow any.
    CannotFollow,
    /// Water in the vehicle.
    Leak,
}

impl fmt::Display for Outcome {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Docked => "docked",
            Self::Late => "late",
            Self::Aborted(_) => "aborted",
        })
    }
}

impl Outcome {
    /// The stable code for logs and programs. `Display` gives a text for people, which may change.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Docked => "docked",
            Self::Late => "late",
            Self::Aborted(_) => "aborted",
        }
    }
}

impl AbortReason {
    /// The stable code for logs and programs. `Display` gives a text for people, which may change.
    #[must_use]
    pub const fn code(self) -> &'static str {
        match self {
            Self::Unreachable => "unreachable",
            Self::ShutIn => "shut_in",
            Self::EnergySpent => "energy_spent",
            Self::TimedOut => "timed_out",
            Self::BadClock => "bad_clock",
            Self::BadPosition => "bad_position",
            Self::SonarLost => "sonar_lost",
            Self::NoAltitude => "no_altitude",
            Self::TooLow => "too_low",
            Self::CannotFollow => "cannot_follow",
            Self::Leak => "leak",
        }
    }
}

impl fmt::Display for AbortReason {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Unreachable => "no way leads to the destination",
            Self::ShutIn => "no path led on for too long",
            Self::EnergySpent => "the battery is needed to surface",
            Self::TimedOut => "the mission lasted far beyond its budget",
            Self::BadClock => "the clock ran backwards, stood still or gave no number",
            Self::BadPosition => "the position was lost",
            Self::SonarLost => "the sonar was lost",
            Self::NoAltitude => "the altitude above the sea bed was lost",
            Self::TooLow => "the sea bed is nearer than charted",
            Self::CannotFollow => "the vehicle cannot follow its trajectories",
            Self::Leak => "water in the vehicle",
        })
    }
}

/// Why a route was asked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum RouteReason {
    /// The mission starts.
    Start,
    /// The last leg took longer than expected.
    Late,
    /// The policy asks at every waypoint.
    Waypoint,
    /// The leg was given up: its waypoint stays covered, no path leads there, or time runs short.
    LegDropped,
    /// The leg will take longer than expected.
    Projected,
    /// The sonar was silent for too long: the vehicle goes home and leaves tasks undone.
    SonarLost,
}

impl RouteReason {
    /// The reason in a few words.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Start => "start",
            Self::Late => "leg late",
            Self::Waypoint => "waypoint",
            Self::LegDropped => "leg dropped",
            Self::Projected => "projected late",
            Self::SonarLost => "sonar lost",
        }
    }
}

/// One row of the route table (Table 2, upper part).
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RouteCall {
    /// Number of the call, from 1.
    pub call: usize,
    /// Why it was made.
    pub reason: RouteReason,
    /// Mission time, seconds.
    pub at_s: f64,
    /// Where the route starts; one past the last waypoint stands for the vehicle's own place.
    pub start: NodeId,
    /// Where the route ends.
    pub destination: NodeId,
    /// Tasks on the route.
    pub tasks: usize,
    /// Weight of the route.
    pub route_weight: f64,
    /// Weight of the tasks done and of the route.
    pub mission_weight: f64,
    /// The planner's cost.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub cost: f64,
    /// Time available before the reserve is taken off, seconds.
    pub available_s: f64,
    /// Time of the route with the arc times that the planner was given, seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub route_s: f64,
    /// Whether the plan passed verification against the problem asked.
    pub valid: bool,
    /// Whether the plan went into force (else the incumbent or the quickest way home did).
    pub adopted: bool,
    /// Evaluations spent.
    pub evaluations: u64,
    /// Computing time as measured, seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub compute_s: f64,
    /// The route.
    pub route: Vec<NodeId>,
}

/// One row of the path table (Table 2, lower part): one leg.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct PathCall {
    /// Number of the route call the leg belongs to, from 1.
    pub route_call: usize,
    /// Number of the leg, from 1.
    pub call: usize,
    /// Where the leg starts.
    pub from: NodeId,
    /// Where the leg ends.
    pub to: NodeId,
    /// Mission time at the start of the leg, seconds.
    pub at_s: f64,
    /// Violation the planner claimed for the first path of the leg.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub violation: f64,
    /// Cost of the first path.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub cost: f64,
    /// Computing time of all path calls of the leg as measured, seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub compute_s: f64,
    /// Time of the leg by Eq. 12: flight, task, waiting and charged computing, seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub leg_s: f64,
    /// Time expected, seconds.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub expected_s: f64,
    /// Time available after the leg, seconds.
    pub available_s: f64,
    /// Whether a new route is asked for after it.
    pub replan: bool,
    /// Whether the next leg of the same route follows.
    pub next_leg: bool,
    /// Path calls of the leg after the first.
    pub replanned_paths: u32,
    /// Time spent waiting for a covered waypoint or evading obstacles, seconds.
    pub waited_s: f64,
    /// Whether the leg's waypoint was reached and its task done.
    pub completed: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeSet;

    const REASONS: [AbortReason; 11] = [
        AbortReason::Unreachable,
        AbortReason::ShutIn,
        AbortReason::EnergySpent,
        AbortReason::TimedOut,
        AbortReason::BadClock,
        AbortReason::BadPosition,
        AbortReason::SonarLost,
        AbortReason::NoAltitude,
        AbortReason::TooLow,
        AbortReason::CannotFollow,
        AbortReason::Leak,
    ];

    #[test]
    fn every_end_has_a_code_and_a_text_of_its_own() {
        let codes: BTreeSet<_> = REASONS.map(AbortReason::code).into();
        let texts: BTreeSet<_> = REASONS.map(|reason| reason.to_string()).into();
        assert_eq!((codes.len(), texts.len()), (11, 11));
        // Checkpoints and exports have the codes too.
        #[cfg(feature = "serde")]
        for reason in REASONS {
            let file = serde_json::to_string(&reason).unwrap();
            assert_eq!(file, format!("\"{}\"", reason.code()));
        }
        for (outcome, code) in [
            (Outcome::Docked, "docked"),
            (Outcome::Late, "late"),
            (Outcome::Aborted(AbortReason::Leak), "aborted"),
        ] {
            assert_eq!((outcome.code(), outcome.to_string()), (code, code.into()));
        }
        let asked = [
            RouteReason::Start,
            RouteReason::Late,
            RouteReason::Waypoint,
            RouteReason::LegDropped,
            RouteReason::Projected,
            RouteReason::SonarLost,
        ];
        let texts: BTreeSet<_> = asked.map(RouteReason::as_str).into();
        assert_eq!(texts.len(), asked.len());
    }
}
