//! Fixes at the surface: what they cost, and whether the vehicle can dock after one.

use crate::surfacing::EARLIER_S;
use crate::{Mission, Navigation};
use auv_graph::NodeId;
use auv_types::{Point3, Violations, libm};

/// Between two fixes work may take longer than planned by this, seconds.
const SLOWER_S: f64 = 60.0;

impl Mission {
    /// Whether the place is known well enough to dock with this standard deviation of its error, metres.
    #[must_use]
    pub fn may_dock(&self, sigma_m: f64) -> bool {
        Navigation::SIGMAS * sigma_m <= self.docking.tolerance_m
    }

    /// Time that is kept for the last fix before docking, seconds: up, the fix, and down again. 0 where no way
    /// that the budget allows needs one.
    #[must_use]
    pub fn docking_fix_s(&self) -> f64 {
        let Some(navigation) = self.navigation.filter(|_| !self.docks_without_fix()) else {
            return 0.0;
        };
        2.0 * self.ascent_m() / self.vehicle.speed_mps + navigation.fix_at_surface_s
    }

    /// Time that is kept for docking again after a miss, seconds.
    fn retries_s(&self) -> f64 {
        let try_s = 2.0 * self.ascent_m() / self.vehicle.speed_mps + self.at_surface_s();
        let more = self.docking.tries.saturating_sub(1);
        // Nothing is added where there is one try: not even rounding.
        if more == 0 {
            0.0
        } else {
            f64::from(more) * try_s
        }
    }

    /// What routes may plan to use of the time left, seconds: without the reserve and the time for fixes.
    #[must_use]
    pub(crate) fn plannable_s(&self, left_s: f64) -> f64 {
        let left_s = left_s - self.reserve_s - self.retries_s();
        (left_s - self.docking_fix_s()) * (1.0 - self.fixes_share())
    }

    /// The share of all time that goes into fixes from time to time.
    #[must_use]
    pub fn fixes_share(&self) -> f64 {
        let navigation = self.navigation.unwrap_or_default();
        let most_m = navigation.most_error_m.unwrap_or(f64::INFINITY);
        let grows_mps = navigation.sigma_m(1.0, 1.0) * self.vehicle.speed_mps;
        let takes_s = 2.0 * self.ascent_m() / self.vehicle.speed_mps + self.at_surface_s();
        let told_s = self.surfacing.map_or(f64::INFINITY, |told| told.every_s);
        let every_s = (most_m / grows_mps).min(told_s);
        takes_s / (every_s + takes_s)
    }

    /// How long the vehicle stays at the surface for a fix, seconds.
    pub(crate) fn at_surface_s(&self) -> f64 {
        let navigation = self.navigation.unwrap_or_default();
        let most_s = self.surfacing.map_or(f64::INFINITY, |told| told.at_most_s);
        navigation.fix_at_surface_s.min(most_s)
    }

    /// Longest time for work at a depth that no fix from time to time interrupts, seconds: from the way down after
    /// one until the way up for the next. `None` where fixes are not asked for from time to time, or near some
    /// waypoints only.
    #[must_use]
    pub fn between_fixes_s(&self, depth_m: f64) -> Option<f64> {
        let told = self.surfacing.filter(|_| self.fix_places.is_empty())?;
        let up_s = self.ascent_from_m(depth_m) / self.vehicle.speed_mps;
        Some(told.every_s - 2.0 * up_s - self.at_surface_s() - EARLIER_S - SLOWER_S)
    }

    /// Whether the vehicle may dock after any way that its budget allows.
    fn docks_without_fix(&self) -> bool {
        let navigation = self.navigation.unwrap_or_default();
        let direct_m = (self.position_of(self.destination) - self.position_of(self.start)).norm();
        let since_fix_s = self.surfacing.map_or(f64::INFINITY, |told| told.every_s);
        let way_m = since_fix_s.min(self.budget_s) * self.vehicle.speed_mps;
        // A fix may come anywhere: what matters is then how far away the vehicle can be from its place.
        let fixed = self.surfacing.is_some() || navigation.most_error_m.is_some();
        let away_m = if fixed { way_m } else { direct_m };
        let most_m = navigation.most_error_m.unwrap_or(f64::INFINITY);
        self.may_dock(navigation.sigma_m(way_m, away_m).min(most_m))
    }

    /// Length of a helix from the dock's depth to the surface, metres.
    pub(crate) fn ascent_m(&self) -> f64 {
        self.ascent_from_m(self.position_of(self.destination).z)
    }

    /// Length of a helix from a depth to the surface, metres.
    pub(crate) fn ascent_from_m(&self, depth_m: f64) -> f64 {
        let vehicle = &self.vehicle;
        let slope = libm::tan(0.9 * vehicle.max_pitch_rad.min(1.0));
        (2.0 * depth_m / slope).max(6.0 * vehicle.turn_radius_m)
    }

    /// How the vehicle errs from the last fix over the dock to the dock, 2 standard deviations in metres.
    fn error_at_dock_m(&self) -> f64 {
        let navigation = self.navigation.unwrap_or_default();
        let down_m = self.ascent_m();
        Navigation::SIGMAS
            * navigation.sigma_m(down_m, down_m.min(6.0 * self.vehicle.turn_radius_m))
    }

    /// What is wrong with navigation and docking, and whether the vehicle can dock with them.
    pub(crate) fn check_navigation(&self, violations: &mut Violations) {
        if let Some(surfacing) = &self.surfacing {
            let up_s = 2.0 * self.ascent_m() / self.vehicle.speed_mps;
            violations.require(surfacing.every_s > up_s, "surface.every_s", || {
                format!(
                    "is {} s, but it takes {up_s:.0} s to the surface and down again; give more",
                    surfacing.every_s
                )
            });
        }
        if self.navigation.is_none() || !violations.is_empty() || self.docks_without_fix() {
            return;
        }
        let error_m = self.error_at_dock_m();
        let tolerance_m = self.docking.tolerance_m;
        violations.require(error_m <= tolerance_m, "navigation", || {
            format!(
                "errs by up to {error_m:.1} m on the way down from a fix over {}, but docking.tolerance_m is {tolerance_m}; give a dock nearer the surface, a better navigation or a greater tolerance",
                self.name_of(self.destination)
            )
        });
    }
}

/// The fixes of a route before it is flown.
#[derive(Debug)]
pub(crate) struct FixesAhead {
    /// When the last one was taken, seconds.
    fix_s: f64,
    /// Where, and the way through the water since.
    fixed_at: Point3<f64>,
    way_m: f64,
}

impl FixesAhead {
    pub(crate) fn new(mission: &Mission, launch_s: f64) -> Self {
        Self {
            fix_s: launch_s,
            fixed_at: mission.position_of(mission.start),
            way_m: 0.0,
        }
    }

    /// What the fixes on a leg that takes so long, with work at its end, add to it, seconds: those from time to
    /// time, those that the error asks for, the one before work that the next would interrupt, and the one before
    /// docking.
    pub(crate) fn on_leg(
        &mut self,
        mission: &Mission,
        to: NodeId,
        leaves_s: f64,
        (takes_s, work_s): (f64, f64),
    ) -> f64 {
        if mission.navigation.is_none() && mission.surfacing.is_none() {
            return 0.0;
        }
        let there = mission.position_of(to);
        let up_s = mission.ascent_from_m(there.z) / mission.vehicle.speed_mps;
        self.way_m += takes_s * mission.vehicle.speed_mps;
        let navigation = mission.navigation.unwrap_or_default();
        let sigma_m = navigation.sigma_m(self.way_m, (there - self.fixed_at).norm());
        let most_m = navigation.most_error_m.unwrap_or(f64::INFINITY);
        let every_s = mission.surfacing.map_or(f64::INFINITY, |told| told.every_s);
        let arrives_s = leaves_s + takes_s;
        let since_s = arrives_s + up_s + mission.at_surface_s() - self.fix_s;
        let by_time = if every_s.is_finite() && may_fix(mission, to) {
            (since_s / every_s).max(0.0).floor()
        } else {
            0.0
        };
        let by_error = if sigma_m > most_m { 1.0 } else { 0.0 };
        let done_s = since_s - by_time * every_s + work_s + EARLIER_S;
        let fits = mission
            .between_fixes_s(there.z)
            .is_some_and(|free_s| work_s <= free_s);
        let before_work = if done_s > every_s && work_s > 0.0 && fits {
            1.0
        } else {
            0.0
        };
        let count = by_time.max(by_error) + before_work;
        // On the way down the vehicle gets on, after a turn back to its path; over the dock it goes straight down.
        let turn_m = std::f64::consts::PI * mission.vehicle.turn_radius_m;
        let fix_s = up_s + mission.at_surface_s() + turn_m / mission.vehicle.speed_mps;
        if count > 0.0 {
            let by_then_s = self.fix_s + by_time * every_s;
            *self = Self {
                fix_s: if by_time > before_work {
                    by_then_s
                } else {
                    arrives_s
                },
                fixed_at: there,
                way_m: 0.0,
            };
            // Before work the vehicle comes down on the rest of its way.
            (count - before_work) * fix_s + before_work * (up_s + mission.at_surface_s())
        } else if mission.is_dock(to) && !mission.may_dock(sigma_m) {
            2.0 * up_s + mission.at_surface_s()
        } else {
            0.0
        }
    }
}

/// Whether fixes from time to time may be taken on the way to a waypoint.
fn may_fix(mission: &Mission, to: NodeId) -> bool {
    mission.fix_places.is_empty() || mission.fix_places.contains(&to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;

    fn mission(drift_percent: f64, most_error_m: Option<f64>) -> Mission {
        let mut mission = Fixture::new().mission;
        mission.vehicle = auv_planning::Vehicle::default();
        mission.navigation = Some(Navigation {
            drift_percent,
            most_error_m,
            ..Navigation::default()
        });
        mission
    }

    #[test]
    fn time_is_kept_for_the_fix_before_docking() {
        // 5,400 m within the budget: 108 m of error at 2 sigma.
        let fixes = mission(1.0, None);
        let wanted_s = 60.0 + 2.0 * fixes.ascent_m() / 1.5;
        assert!((fixes.docking_fix_s() - wanted_s).abs() < 1e-9 && wanted_s > 200.0);
        let budget_m = fixes.budget_s * 1.5;
        let enough = 100.0 * 5.0 / budget_m;
        assert_eq!(mission(0.99 * enough, None).docking_fix_s(), 0.0);
        assert!(mission(1.01 * enough, None).docking_fix_s() > 0.0);
        // The way since a fix counts, not that since the launch.
        let mut often = mission(2.0 * enough, None);
        often.surfacing = Some(crate::Surfacing::every(0.49 * often.budget_s));
        assert_eq!(often.docking_fix_s(), 0.0);
        assert_eq!(mission(1.0, Some(5.0)).docking_fix_s(), 0.0);
        assert_eq!(fixes.fixes_share(), 0.0);
        // A fix every 1,000 m.
        let share = mission(1.0, Some(10.0)).fixes_share();
        assert!((share - wanted_s / (1_000.0 / 1.5 + wanted_s)).abs() < 1e-9);
    }

    #[test]
    fn time_is_kept_for_each_further_try_to_dock() {
        let mut mission = mission(0.0, None);
        let one_s = mission.plannable_s(1_000.0);
        assert_eq!(one_s, 1_000.0);
        mission.docking.tries = 3;
        // Twice up, 60 s for a fix, and down again.
        let try_s = 2.0 * mission.ascent_m() / 1.5 + 60.0;
        assert!((mission.plannable_s(1_000.0) - (1_000.0 - 2.0 * try_s)).abs() < 1e-9);
    }

    #[test]
    fn routes_plan_with_what_fixes_and_the_reserve_leave() {
        let mut often = mission(1.0, Some(10.0));
        let fix_s = 60.0 + 2.0 * often.ascent_m() / 1.5;
        // A fix every 1,000 m, one before docking, and 50 s of reserve.
        let share = fix_s / (1_000.0 / 1.5 + fix_s);
        often.reserve_s = 50.0;
        let wanted_s = (3_000.0 - 50.0 - fix_s) * (1.0 - share);
        assert!((often.plannable_s(3_000.0) - wanted_s).abs() < 1e-9);
        often.navigation = None;
        assert_eq!(often.plannable_s(3_000.0), 2_950.0);
    }

    #[test]
    fn the_way_up_is_a_helix_a_little_flatter_than_the_vehicle_can_climb() {
        let mut mission = mission(0.0, None);
        let slope = |mission: &Mission| 2.0 * 100.0 / mission.ascent_from_m(100.0);
        // 0.9 of 15 degrees, and of 1 rad where the vehicle is steeper than that.
        assert!((slope(&mission) - 0.240_078_759).abs() < 1e-9);
        mission.vehicle.max_pitch_rad = 1.5;
        assert!((slope(&mission) - 1.260_158_218).abs() < 1e-9);
        // About a whole circle at least.
        assert_eq!(
            mission.ascent_from_m(0.0),
            6.0 * mission.vehicle.turn_radius_m
        );
    }

    /// What fixes add to legs of 900 m each that leave at such times, and one of them.
    fn added_s(mission: &Mission, leaves_s: [f64; 2]) -> ([f64; 2], f64) {
        let mut ahead = FixesAhead::new(mission, 0.0);
        let legs = [1, 2].map(NodeId).into_iter().zip(leaves_s);
        let added = legs.map(|(to, leaves_s)| ahead.on_leg(mission, to, leaves_s, (600.0, 0.0)));
        let turn_m = std::f64::consts::PI * mission.vehicle.turn_radius_m;
        let fix_s = (mission.ascent_m() + turn_m) / 1.5 + 60.0;
        let added: Vec<f64> = added.collect();
        ([added[0], added[1]], fix_s)
    }

    #[track_caller]
    fn assert_fixes(mission: &Mission, leaves_s: [f64; 2], counts: [f64; 2]) {
        let (added_s, fix_s) = added_s(mission, leaves_s);
        for (added_s, count) in added_s.into_iter().zip(counts) {
            assert!((added_s - count * fix_s).abs() < 1e-6, "{added_s} s");
        }
    }

    #[test]
    fn fixes_on_the_way_add_to_legs_as_the_error_and_the_time_ask() {
        // 9 m of error a leg; none right after a fix.
        assert_fixes(&mission(1.0, Some(8.0)), [0.0, 900.0], [1.0, 1.0]);
        assert_fixes(&mission(1.0, Some(10.0)), [0.0, 600.0], [0.0, 1.0]);
        let mut often = mission(0.0, None);
        assert_fixes(&often, [0.0, 600.0], [0.0, 0.0]);
        often.surfacing = Some(crate::Surfacing::every(300.0));
        // The last is over 171 s after the arrival: 771 s after the launch, then 971 s after that of 600 s.
        assert!((often.ascent_m() / 1.5 + 60.0 - 171.0).abs() < 1.0);
        assert_fixes(&often, [0.0, 800.0], [2.0, 3.0]);
        often.navigation = None;
        assert_fixes(&often, [0.0, 800.0], [2.0, 3.0]);
        often.fix_places.push(NodeId(2));
        assert_fixes(&often, [0.0, 600.0], [0.0, 4.0]);
        often.surfacing = None;
        assert_fixes(&often, [0.0, 600.0], [0.0, 0.0]);
    }

    #[test]
    fn a_fix_before_docking_adds_to_the_last_leg_where_it_is_needed() {
        let mut mission = mission(1.0, None);
        let docks_s = |mission: &Mission| added_s(mission, [0.0, 600.0]).0;
        // 18 m of error at the dock: twice that against its 10 m, or 40 m.
        let wanted_s = 2.0 * mission.ascent_m() / 1.5 + 60.0;
        let [first_s, last_s] = docks_s(&mission);
        assert!(first_s == 0.0 && (last_s - wanted_s).abs() < 1e-9);
        mission.docking.tolerance_m = 40.0;
        assert_eq!(docks_s(&mission), [0.0, 0.0]);
    }

    #[test]
    fn a_round_trip_keeps_time_for_the_fix_too() {
        let mut round = mission(1.0, None);
        round.destination = round.start;
        assert!(round.docking_fix_s() > 0.0);
        let mut violations = Violations::new();
        round.navigation = Some(Navigation {
            drift_percent: 20.0,
            ..Navigation::default()
        });
        round.check_navigation(&mut violations);
        assert!(violations.to_string().contains("docking.tolerance_m"));
    }

    #[test]
    fn a_dock_that_cannot_be_found_is_refused_with_the_remedy() {
        let told = |mission: &Mission| {
            let mut violations = Violations::new();
            mission.check_navigation(&mut violations);
            violations.to_string()
        };
        assert_eq!(told(&mission(1.0, None)), "");
        let text = told(&mission(20.0, None));
        assert!(text.contains("docking.tolerance_m is 10"), "{text}");
        let mut wide = mission(20.0, None);
        wide.docking.tolerance_m = 200.0;
        assert_eq!(told(&wide), "");
        let wrong = |mission: &Mission| mission.malformed().to_string();
        assert!(wrong(&mission(f64::NAN, None)).contains("navigation.drift_percent"));
        assert!(wrong(&mission(1.0, Some(0.0))).contains("navigation.most_error_m"));
    }
}
