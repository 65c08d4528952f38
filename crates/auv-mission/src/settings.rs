//! How the synchroniser decides.

use auv_planning::Budget;
use auv_types::Violations;

/// What a leg is expected to take (specification 3.1); the replan rule compares the real time to it.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum ExpectedTime {
    /// Exactly the edge's time: every detour is late.
    Strict,
    /// The flight alone is compared with the edge's whole time, task included: nearest to the
    /// paper's Table 2.
    TravelVsEstimate,
    /// The edge's travel time stretched by `1 + kappa`, its task, and the mean charged computing
    /// time.
    Slack {
        /// Share of the travel time; 0.02 is calibrated to the paper's Fig. 18.
        kappa: f64,
    },
    /// Given for each path call in order (a scripted replay); `+inf` beyond the list.
    Given(#[cfg_attr(feature = "serde", serde(with = "crate::any_number::list"))] Vec<f64>),
}

/// When a new route is asked for at a waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum ReplanPolicy {
    /// When the leg took longer than expected: the paper's rule.
    Late,
    /// As [`ReplanPolicy::Late`], and in the middle of a leg as soon as the projected time exceeds
    /// the expected one (the route is planned for the expected arrival).
    Projected,
    /// At every waypoint; the incumbent route is kept unless the new one is better. Spare time is
    /// turned into tasks.
    EveryWaypoint,
}

/// Whether computing time is charged to the mission (Eq. 12 and 21).
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum ComputeCharge {
    /// Not charged, as in the paper's Table 2: reproducible.
    None,
    /// A fixed time for each call, seconds: reproducible.
    Fixed {
        /// Each route call.
        route_s: f64,
        /// Each path call.
        path_s: f64,
    },
    /// What the driver measured: not reproducible.
    Measured,
}

/// What the vehicle does when its sonar stays silent.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
#[non_exhaustive]
pub enum WithoutSonar {
    /// The mission is given up along its ladder of contingencies: by default the vehicle surfaces. What
    /// moves is met blind for a minute, not for the whole way home.
    GiveUp,
    /// Home the quickest way, leaving tasks undone, past what was seen before. For water where nothing
    /// moves.
    GoHome,
}

/// What a plan needs to go into force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case")
)]
pub enum Acceptance {
    /// It passes `auv-verify` against the problem it was asked for.
    Verified,
    /// Nothing: the verdict is recorded and the plan flown all the same. For the scripted replay of
    /// the paper's Table 2 only.
    AsClaimed,
}

/// Settings of the synchroniser.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct SyncSettings {
    /// What a leg is expected to take.
    pub expected_time: ExpectedTime,
    /// When routes are replanned.
    pub replan: ReplanPolicy,
    /// Whether computing is charged.
    pub compute: ComputeCharge,
    /// What a plan needs to go into force.
    pub acceptance: Acceptance,
    /// Budget of the first route call, before the vehicle is under way.
    pub launch_budget: Budget,
    /// Budget of each later route call.
    pub route_budget: Budget,
    /// Budget of each path call.
    pub path_budget: Budget,
    /// Time between asking for a path and its departure, seconds: what planning is given while the
    /// vehicle moves on (0: paths depart at once, as when planning takes no mission time). Routes count
    /// it on every leg.
    pub planning_s: f64,
    /// Share of every travel time that routes keep free for detours.
    pub detour_margin: f64,
    /// Time that routes keep free for detours on each leg, seconds.
    pub detour_margin_s: f64,
    /// Whether routes take into account how the predicted obstacles delay the next leg.
    pub forecast: bool,
    /// Extra clearance asked of a new path, metres: a path is given up only when it has lost all of
    /// this, so that small changes of the prediction do not cause replanning.
    pub hysteresis_m: f64,
    /// How far ahead the trajectory in force is checked against the prediction, seconds.
    pub lookahead_s: f64,
    /// Time between two attempts to shorten a trajectory that goes a long way round, seconds.
    pub improve_s: f64,
    /// Share of the straight way's time above which a trajectory goes a long way round.
    pub long_way: f64,
    /// Distance from the trajectory at which it is replanned from the true place, metres.
    pub off_track_m: f64,
    /// Path calls of one leg: when they are spent and its path fails, the leg is dropped, unless it
    /// leads to the destination.
    pub max_path_calls: u32,
    /// Longest wait for a covered waypoint before it is dropped, seconds.
    pub max_wait_s: f64,
    /// Longest time with nothing but waiting, leg after leg: then the vehicle counts as shut in, and the
    /// mission is given up while the way up is still free, seconds.
    pub max_shut_in_s: f64,
    /// Least time between two path calls of a leg whose path is not clear, seconds; in between the
    /// vehicle gets out of the way by itself.
    pub react_s: f64,
    /// Time between two attempts to go on while waiting, seconds.
    pub retry_s: f64,
    /// Silence of the sonar after which the vehicle leaves its tasks, seconds: less than what was beyond
    /// its range takes to come near.
    pub sonar_silence_s: f64,
    /// What it does then.
    pub without_sonar: WithoutSonar,
    /// Time without a measured altitude, once there was one, after which the mission is given up,
    /// seconds.
    pub altitude_silence_s: f64,
    /// Ticks in a row at which the clock may stand still: more, where the ticks come faster than the
    /// clock counts. A vehicle that steers by a clock that has stopped stays where it is.
    pub clock_stalls: u32,
    /// How long dead reckoning stands in for fixes that are missing or implausible, seconds.
    pub position_silence_s: f64,
    /// The mission is aborted when it lasts this many times its budget.
    pub timeout_factor: f64,
}

impl SyncSettings {
    /// The paper's synchroniser: replan when late, ledger after every leg, no computing charged, no
    /// margins.
    #[must_use]
    pub fn paper() -> Self {
        Self {
            expected_time: ExpectedTime::Slack { kappa: 0.02 },
            replan: ReplanPolicy::Late,
            detour_margin: 0.0,
            detour_margin_s: 0.0,
            forecast: false,
            ..Self::default()
        }
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let not_negative = [
            (self.planning_s, "planning_s"),
            (self.detour_margin, "detour_margin"),
            (self.detour_margin_s, "detour_margin_s"),
            (self.hysteresis_m, "hysteresis_m"),
            (self.max_wait_s, "max_wait_s"),
            (self.max_shut_in_s, "max_shut_in_s"),
            (self.react_s, "react_s"),
            (self.long_way, "long_way"),
            (self.sonar_silence_s, "sonar_silence_s"),
            (self.position_silence_s, "position_silence_s"),
            (self.altitude_silence_s, "altitude_silence_s"),
        ];
        for (value, place) in not_negative {
            violations.require_not_negative(value, place);
        }
        let positive = [
            (self.lookahead_s, "lookahead_s"),
            (self.off_track_m, "off_track_m"),
            (self.retry_s, "retry_s"),
            (self.improve_s, "improve_s"),
            (self.timeout_factor, "timeout_factor"),
        ];
        for (value, place) in positive {
            violations.require_positive(value, place);
        }
        violations.require(self.max_path_calls > 0, "max_path_calls", || {
            "is 0; allow at least 1".into()
        });
        if let ExpectedTime::Slack { kappa } = self.expected_time {
            violations.require_not_negative(kappa, "expected_time.kappa");
        }
        if let ComputeCharge::Fixed { route_s, path_s } = self.compute {
            violations.require_not_negative(route_s, "compute.route_s");
            violations.require_not_negative(path_s, "compute.path_s");
        }
        violations
    }
}

impl Default for SyncSettings {
    fn default() -> Self {
        Self {
            expected_time: ExpectedTime::Slack { kappa: 0.02 },
            replan: ReplanPolicy::EveryWaypoint,
            compute: ComputeCharge::None,
            acceptance: Acceptance::Verified,
            launch_budget: Budget::evaluations(20_000),
            route_budget: Budget::evaluations(3_000),
            path_budget: Budget::evaluations(1_000),
            planning_s: 0.0,
            detour_margin: 0.003,
            detour_margin_s: 1.0,
            forecast: true,
            hysteresis_m: 5.0,
            lookahead_s: 600.0,
            improve_s: 60.0,
            long_way: 0.05,
            off_track_m: 5.0,
            max_path_calls: 200,
            max_wait_s: 600.0,
            max_shut_in_s: 1800.0,
            react_s: 3.0,
            retry_s: 20.0,
            sonar_silence_s: 120.0,
            without_sonar: WithoutSonar::GiveUp,
            clock_stalls: 10,
            position_silence_s: 30.0,
            altitude_silence_s: 30.0,
            timeout_factor: 2.0,
        }
    }
}
