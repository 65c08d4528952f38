//! The fixes at the surface of a route before it is flown.

use crate::Mission;
use crate::senses::ANTENNA_M;
use crate::surfacing::{AGAIN_SHARE, MOST_FIXES, next_place_s};
use auv_graph::NodeId;
use auv_types::{Point3, libm};

/// Into so many pieces a straight way is cut to find where the error asks for a fix.
const PIECES: u32 = 16;

/// What is known of the last fix while a route is timed.
#[derive(Debug)]
pub(crate) struct FixesAhead<'m> {
    mission: &'m Mission,
    /// When the last one was taken, seconds.
    fix_s: f64,
    /// Where, and the way through the water since.
    fixed_at: Point3<f64>,
    way_m: f64,
}

/// A leg that is timed, straight from a place to a waypoint.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LegAhead<'r> {
    pub(crate) from: Point3<f64>,
    pub(crate) to: NodeId,
    pub(crate) leaves_s: f64,
    /// How long it takes without fixes, seconds.
    pub(crate) takes_s: f64,
    /// How long its end waits for windows, and how long its work takes then, seconds.
    pub(crate) waits_s: f64,
    pub(crate) work_s: f64,
    /// The route from its end on.
    pub(crate) rest: &'r [NodeId],
}

/// What fixes add to a leg, seconds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct FixesOnLeg {
    /// Before its end is reached.
    pub(crate) under_way_s: f64,
    /// While its work is done.
    pub(crate) at_work_s: f64,
}

/// What a vehicle does for a while.
#[derive(Clone, Copy, PartialEq)]
enum Doing {
    /// It flies on: on the way down from a fix too.
    Way,
    /// It works at one place: a fix interrupts that.
    Work,
    /// It waits at one place until a time: a fix is part of it.
    Wait,
}

/// A straight way, or a stay where both ends are one place.
#[derive(Clone, Copy)]
struct Stretch {
    doing: Doing,
    from: Point3<f64>,
    to: Point3<f64>,
    takes_s: f64,
    speed_mps: f64,
    /// Whether fixes from time to time may be taken on it.
    may_fix: bool,
}

impl Stretch {
    fn at(&self, time_s: f64) -> Point3<f64> {
        let share = (time_s / self.takes_s.max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
        self.from + (self.to - self.from) * share
    }
}

impl<'m> FixesAhead<'m> {
    pub(crate) fn new(mission: &'m Mission, launch_s: f64) -> Self {
        Self {
            mission,
            fix_s: launch_s,
            fixed_at: mission.position_of(mission.start),
            way_m: 0.0,
        }
    }

    /// What the fixes on a leg, with work at its end, add to it: those from time to time, those that the error asks
    /// for, the one before work that the next would interrupt, and the one before docking.
    pub(crate) fn on_leg(&mut self, leg: &LegAhead<'_>) -> FixesOnLeg {
        let mission = self.mission;
        if mission.navigation.is_none() && mission.surfacing.is_none() {
            return FixesOnLeg::default();
        }
        let there = mission.position_of(leg.to);
        let speed_mps = mission.vehicle.speed_mps;
        let way = Stretch {
            doing: Doing::Way,
            from: leg.from,
            to: there,
            takes_s: leg.takes_s,
            speed_mps,
            may_fix: mission.fix_places.is_empty(),
        };
        let mut under_way_s = self.along(&way, leg.leaves_s);
        let arrives_s = |under_way_s: f64| leg.leaves_s + leg.takes_s + under_way_s;
        under_way_s += self.at_place_s(leg, arrives_s(under_way_s), leg.waits_s + leg.work_s);
        under_way_s += self.before_work_s(leg, arrives_s(under_way_s));
        under_way_s += self.before_docking_s(leg.to);
        // A vehicle that hovers makes no way.
        let stays_mps = if mission.vehicle.min_speed_mps > 0.0 {
            speed_mps
        } else {
            0.0
        };
        let stay = |doing: Doing, takes_s: f64| Stretch {
            doing,
            from: there,
            to: there,
            takes_s,
            speed_mps: stays_mps,
            may_fix: mission.fix_places.is_empty() || mission.fix_places.contains(&leg.to),
        };
        let mut now_s = arrives_s(under_way_s) + leg.waits_s;
        let later_s = self.along(&stay(Doing::Wait, leg.waits_s), now_s - leg.waits_s);
        now_s += later_s;
        let mut at_work_s = later_s + self.along(&stay(Doing::Work, leg.work_s), now_s);
        if leg.waits_s + leg.work_s > 0.0 {
            at_work_s += self.at_place_s(leg, now_s + leg.work_s + at_work_s - later_s, 0.0);
        }
        FixesOnLeg {
            under_way_s,
            at_work_s,
        }
    }

    /// What fixes add to a stretch, seconds.
    fn along(&mut self, whole: &Stretch, begins_s: f64) -> f64 {
        // Of the stretch so much is over, and so much time was added to it.
        let (mut over_s, mut added_s) = (0.0, 0.0);
        for _ in 0..MOST_FIXES {
            let left_s = whole.takes_s - over_s;
            let rest = Stretch {
                from: whole.at(over_s),
                takes_s: left_s,
                ..*whole
            };
            let now_s = begins_s + over_s + added_s;
            let due_s = self.until_due_s(&rest, now_s);
            let free_s = due_s.min(self.until_lost_s(&rest));
            if free_s >= left_s {
                self.way_m += left_s * whole.speed_mps;
                return added_s;
            }
            over_s += free_s;
            let leads_on_s = match whole.doing {
                Doing::Way => left_s - free_s,
                Doing::Work | Doing::Wait => 0.0,
            };
            let fix_s = self.takes(whole.at(over_s), now_s + free_s, leads_on_s);
            if whole.doing == Doing::Wait {
                over_s += fix_s;
                if over_s >= whole.takes_s {
                    return over_s - whole.takes_s;
                }
            } else {
                added_s += fix_s;
            }
        }
        added_s
    }

    /// Takes a fix at a place, and says what it adds, seconds: up, at the surface, and down as far as the rest of
    /// the way does not lead down anyway.
    fn takes(&mut self, here: Point3<f64>, begins_s: f64, leads_on_s: f64) -> f64 {
        let rises_s = self.rises_s(here.z);
        let fixed_s = rises_s + self.mission.at_surface_s();
        *self = Self {
            mission: self.mission,
            fix_s: begins_s + fixed_s,
            fixed_at: here,
            way_m: (rises_s - leads_on_s).max(0.0) * self.mission.vehicle.speed_mps,
        };
        fixed_s + (rises_s - leads_on_s).max(0.0)
    }

    /// How long it takes up until the antenna is out of the water, seconds: the way up is level at its end.
    fn rises_s(&self, depth_m: f64) -> f64 {
        let part = (ANTENNA_M / depth_m.max(ANTENNA_M)).min(1.0);
        let level =
            libm::cbrt(6.0 * part) / libm::cbrt(std::f64::consts::TAU * std::f64::consts::TAU);
        self.up_s(depth_m) * (1.0 - level).max(0.5)
    }

    fn up_s(&self, depth_m: f64) -> f64 {
        self.mission.ascent_from_m(depth_m) / self.mission.vehicle.speed_mps
    }

    fn every_s(&self) -> f64 {
        let told = self.mission.surfacing;
        told.map_or(f64::INFINITY, |told| told.every_s)
    }

    /// How long before the next one is due a fix from time to time is begun at a depth, seconds.
    fn ahead_s(&self, depth_m: f64) -> f64 {
        let earlier_s = self.mission.fix_earlier_s(depth_m);
        self.up_s(depth_m) + self.mission.at_surface_s() + earlier_s
    }

    /// How long on a stretch until a fix from time to time is begun, seconds.
    fn until_due_s(&self, rest: &Stretch, now_s: f64) -> f64 {
        if !rest.may_fix {
            return f64::INFINITY;
        }
        (self.fix_s + self.every_s() - self.ahead_s(rest.from.z) - now_s).max(0.0)
    }

    /// How long on a stretch until the error asks for a fix, seconds.
    fn until_lost_s(&self, rest: &Stretch) -> f64 {
        let navigation = self.mission.navigation.unwrap_or_default();
        let Some(most_m) = navigation.most_error_m else {
            return f64::INFINITY;
        };
        let mut times_s = (1..=PIECES).map(|i| rest.takes_s * f64::from(i) / f64::from(PIECES));
        let is_lost = |time_s: &f64| {
            let way_m = self.way_m + time_s * rest.speed_mps;
            let away_m = (rest.at(*time_s) - self.fixed_at).norm();
            navigation.sigma_m(way_m, away_m) > most_m
        };
        times_s.find(is_lost).unwrap_or(f64::INFINITY)
    }

    /// What a fix at a waypoint for fixes adds that is to stay there for so long, seconds: where it could not be
    /// taken after that, or after no stay where the next on the route would come too late.
    fn at_place_s(&mut self, leg: &LegAhead<'_>, arrives_s: f64, stays_s: f64) -> f64 {
        let there = self.mission.position_of(leg.to);
        let ahead_s = self.ahead_s(there.z);
        let since_s = arrives_s - self.fix_s;
        let next_s = if stays_s > 0.0 {
            self.mission.fix_waits_s(there.z, stays_s)
        } else {
            next_place_s(self.mission, leg.rest, leg.to)
        };
        let waits = !self.mission.fix_places.contains(&leg.to)
            || since_s <= ahead_s.max(AGAIN_SHARE * self.every_s())
            || since_s + ahead_s + next_s <= self.every_s();
        if waits {
            return 0.0;
        }
        self.takes(there, arrives_s, 0.0)
    }

    /// What the fix before work adds that the next would interrupt and that fits after it, seconds. The vehicle comes
    /// down on the rest of its way.
    fn before_work_s(&mut self, leg: &LegAhead<'_>, arrives_s: f64) -> f64 {
        let there = self.mission.position_of(leg.to);
        let work_s = leg.waits_s + leg.work_s;
        let ahead_s = self.ahead_s(there.z);
        let since_s = arrives_s - self.fix_s;
        let free_s = self.mission.between_fixes_s(there.z);
        let takes_it = work_s > 0.0
            && since_s + work_s + ahead_s > self.every_s()
            && since_s > ahead_s.max(AGAIN_SHARE * self.every_s())
            && free_s.is_some_and(|free_s| work_s <= free_s);
        if !takes_it {
            return 0.0;
        }
        let rises_s = self.rises_s(there.z);
        self.takes(there, arrives_s - rises_s, rises_s)
    }

    /// What the fix before docking adds, seconds.
    fn before_docking_s(&self, to: NodeId) -> f64 {
        let there = self.mission.position_of(to);
        let navigation = self.mission.navigation.unwrap_or_default();
        let sigma_m = navigation.sigma_m(self.way_m, (there - self.fixed_at).norm());
        if self.mission.is_dock(to) && !self.mission.may_dock(sigma_m) {
            2.0 * self.up_s(there.z) + self.mission.at_surface_s()
        } else {
            0.0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use crate::{Navigation, Surfacing};

    fn mission(drift_percent: f64, most_error_m: Option<f64>, every_s: Option<f64>) -> Mission {
        let mut mission = Fixture::new().mission;
        mission.vehicle = auv_planning::Vehicle::default();
        mission.navigation = Some(Navigation {
            drift_percent,
            most_error_m,
            ..Navigation::default()
        });
        mission.surfacing = every_s.map(Surfacing::every);
        mission.docking.tolerance_m = 30.0;
        mission
    }

    /// What fixes add to the legs to waypoints 1 and 2, of 900 m each, with such waits and such work at their ends.
    fn added(mission: &Mission, waits_s: f64, work_s: f64) -> [FixesOnLeg; 2] {
        let mut ahead = FixesAhead::new(mission, 0.0);
        let route = [0, 1, 2].map(NodeId);
        let mut leaves_s = 0.0;
        [1, 2].map(|i| {
            let added = ahead.on_leg(&LegAhead {
                from: mission.position_of(route[i - 1]),
                to: route[i],
                leaves_s,
                takes_s: 600.0,
                waits_s,
                work_s,
                rest: &route[i..],
            });
            leaves_s += 600.0 + waits_s + work_s + added.under_way_s + added.at_work_s;
            added
        })
    }

    /// One fix without the way down and the turn, and the way down.
    fn fix_s(mission: &Mission) -> [f64; 2] {
        let depth_m = mission.position_of(NodeId(1)).z;
        let down_s = FixesAhead::new(mission, 0.0).rises_s(depth_m);
        [down_s + 60.0, down_s]
    }

    #[track_caller]
    fn assert_on_the_way(mission: &Mission, counts: [f64; 2]) {
        let [up_s, down_s] = fix_s(mission);
        for (added, count) in added(mission, 0.0, 0.0).into_iter().zip(counts) {
            let per_fix = [up_s, up_s + down_s].map(|s| count * s);
            let within = per_fix[0] - 1e-6..=per_fix[1] + 1e-6;
            assert!(within.contains(&added.under_way_s), "{added:?}");
            assert!(added.at_work_s <= 0.0);
        }
    }

    #[test]
    fn fixes_on_the_way_add_to_legs_as_the_error_and_the_time_ask() {
        // 9 m of error a leg.
        assert_on_the_way(&mission(1.0, Some(8.0), None), [1.0, 1.0]);
        assert_on_the_way(&mission(1.0, Some(10.0), None), [0.0, 1.0]);
        assert_on_the_way(&mission(0.0, None, None), [0.0, 0.0]);
        // Each is begun about 300 s before it is due.
        let mut often = mission(0.0, None, Some(800.0));
        assert_on_the_way(&often, [1.0, 1.0]);
        often.navigation = None;
        assert_on_the_way(&often, [1.0, 1.0]);
        often.surfacing = None;
        assert_on_the_way(&often, [0.0, 0.0]);
    }

    #[test]
    fn fixes_interrupt_work_that_is_longer_than_from_one_to_the_next() {
        let often = mission(0.0, None, Some(800.0));
        let [up_s, down_s] = fix_s(&often);
        let cycle_s = 800.0 - often.fix_earlier_s(20.0) - often.ascent_m() / 1.5 + down_s;
        let [first, _] = added(&often, 0.0, 4.0 * (cycle_s - up_s - down_s));
        // One before the arrival; then each cycle does less by the fix.
        assert!(
            (first.at_work_s / (up_s + down_s) - 4.0).abs() < 1.0 + 1e-9,
            "{first:?}"
        );
        // Work that fits is not interrupted: the fix is taken before it.
        let [first, _] = added(&mission(0.0, None, Some(1_000.0)), 0.0, 300.0);
        assert!((first.under_way_s - up_s).abs() < 1e-9, "{first:?}");
        assert!(first.at_work_s <= 0.0);
    }

    #[test]
    fn a_fix_is_part_of_a_wait() {
        let [first, _] = added(&mission(0.0, None, Some(2_000.0)), 2_500.0, 0.0);
        assert_eq!(first, FixesOnLeg::default());
        let late = added(&mission(0.0, None, Some(1_000.0)), 1_000.0, 0.0)[0];
        assert!(late.at_work_s > 0.0 && late.at_work_s < 300.0, "{late:?}");
    }

    #[test]
    fn fixes_at_waypoints_are_taken_where_the_next_comes_too_late() {
        let mut often = mission(0.0, None, Some(2_000.0));
        often.fix_places = vec![NodeId(1)];
        let [up_s, down_s] = fix_s(&often);
        let at = |mission: &Mission, work_s| added(mission, 0.0, work_s)[0];
        assert_eq!(at(&often, 0.0), FixesOnLeg::default());
        often.surfacing = Some(Surfacing::every(1_200.0));
        assert!((at(&often, 0.0).under_way_s - up_s - down_s).abs() < 1e-9);
        // After work, if it can wait so long.
        let after = at(&often, 200.0);
        assert!(after.under_way_s <= 0.0 && (after.at_work_s - up_s - down_s).abs() < 1e-9);
    }

    #[test]
    fn a_fix_before_docking_adds_to_the_last_leg_where_it_is_needed() {
        let mut mission = mission(1.0, None, None);
        mission.docking.tolerance_m = 10.0;
        let docks_s = |mission: &Mission| added(mission, 0.0, 0.0).map(|added| added.under_way_s);
        // 18 m of error at the dock: twice that against its 10 m, or 40 m.
        let wanted_s = 2.0 * mission.ascent_m() / 1.5 + 60.0;
        let [first_s, last_s] = docks_s(&mission);
        assert!(first_s <= 0.0 && (last_s - wanted_s).abs() < 1e-9);
        mission.docking.tolerance_m = 40.0;
        assert!(docks_s(&mission).iter().all(|&s| s <= 0.0));
    }
}
