//! Fixes at the surface: what they cost, and whether the vehicle can dock after one.

use crate::{Mission, Navigation};
use auv_types::{Violations, libm};

/// Between two fixes work may take longer than planned by this, seconds.
const SLOWER_S: f64 = 60.0;
/// A fix is given this much more time than it takes, seconds.
pub(crate) const SPARE_S: f64 = 5.0;
/// A fix from time to time is sought this much earlier, because it may not be free at once, seconds.
const RETRIES_S: f64 = 120.0;

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
        // From time to time counts from fix to fix, the error from the surface on.
        let told = self.surfacing.map_or(0.0, |told| {
            let earlier_s = self.fix_earlier_s(self.position_of(self.destination).z);
            takes_s / (told.every_s - earlier_s).max(takes_s)
        });
        told.max(takes_s / (most_m / grows_mps + takes_s))
    }

    /// How much earlier than it must be a fix from time to time is taken at a depth, because it may not be free at
    /// once, seconds. Where little time is left from one to the next, half of it.
    pub(crate) fn fix_earlier_s(&self, depth_m: f64) -> f64 {
        let every_s = self.surfacing.map_or(f64::INFINITY, |told| told.every_s);
        let up_s = self.ascent_from_m(depth_m) / self.vehicle.speed_mps;
        let free_s = every_s - 2.0 * up_s - self.at_surface_s() - SPARE_S;
        SPARE_S + RETRIES_S.min(0.5 * free_s).max(0.0)
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
        self.fix_places
            .is_empty()
            .then(|| self.free_between_s(depth_m))?
    }

    /// The same wherever fixes are taken.
    fn free_between_s(&self, depth_m: f64) -> Option<f64> {
        let told = self.surfacing?;
        let up_s = self.ascent_from_m(depth_m) / self.vehicle.speed_mps;
        let earlier_s = self.fix_earlier_s(depth_m);
        Some(told.every_s - 2.0 * up_s - self.at_surface_s() - earlier_s - SLOWER_S)
    }

    /// How long a fix at a waypoint for fixes has to wait for work there, seconds: until it is done, or not at all
    /// where it is interrupted anyway.
    pub(crate) fn fix_waits_s(&self, depth_m: f64, work_s: f64) -> f64 {
        let free_s = self.free_between_s(depth_m).unwrap_or(f64::INFINITY);
        if work_s <= free_s { work_s } else { 0.0 }
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
            let takes_s = up_s + self.at_surface_s() + SPARE_S;
            violations.require(surfacing.every_s > takes_s, "surface.every_s", || {
                format!(
                    "is {} s, but a fix takes {takes_s:.0} s, the way up to the surface and down again included; give more",
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

    #[test]
    fn fixes_are_sought_earlier_than_they_must_be_where_there_is_time_for_that() {
        let mut often = mission(0.0, None);
        let takes_s = 2.0 * often.ascent_m() / 1.5 + 60.0 + SPARE_S;
        let mut earlier_s = |free_s: f64| {
            often.surfacing = Some(crate::Surfacing::every(takes_s + free_s));
            let depth_m = often.position_of(often.destination).z;
            (often.fix_earlier_s(depth_m), often.fixes_share())
        };
        let (much, some, none) = (earlier_s(3_000.0), earlier_s(100.0), earlier_s(0.0));
        assert!((much.0 - 125.0).abs() < 1e-9 && (some.0 - 55.0).abs() < 1e-9);
        assert!((none.0 - SPARE_S).abs() < 1e-9);
        // What is taken earlier is lost for everything else.
        let share = |lost_s: f64, free_s: f64| (takes_s - 5.0) / (takes_s + free_s - lost_s);
        assert!((much.1 - share(125.0, 3_000.0)).abs() < 1e-9);
        assert!((some.1 - share(55.0, 100.0)).abs() < 1e-9);
        let mut violations = Violations::new();
        often.check_navigation(&mut violations);
        assert!(
            violations.to_string().contains("surface.every_s"),
            "{violations}"
        );
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
