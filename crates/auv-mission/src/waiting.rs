//! When no way leads to the target: out of the way, as near as can be, and wait.

use crate::stay::stays;
use crate::{Acceptance, Command, Synchroniser, reflex};
use auv_obstacles::TimedPoint;
use auv_planning::Trajectory;
use auv_planning::motion::distance_to_regions_m;
use auv_types::{Point3, libm};

/// How long a place to wait must stay clear, seconds.
const STAY_CLEAR_S: f64 = 120.0;
/// Distance between the rings of places round a target, metres, and their number.
const RING_M: f64 = 50.0;
const RINGS: u32 = 20;
/// A place to wait is worth going to when it is nearer to the target by this, metres.
const LEAST_GAIN_M: f64 = 100.0;

/// A leg with this share of its time spent waiting made no way.
const NO_WAY: f64 = 0.9;

/// How long a vehicle that cannot stop circles on one trajectory while it waits, seconds.
const CIRCLES_S: f64 = 150.0;

impl Synchroniser {
    /// Whether a region covers the target at the earliest arrival: no path can end there then.
    pub(crate) fn target_will_be_covered(&self) -> bool {
        let Some(leg) = &self.state.leg else {
            return false;
        };
        if self.settings.acceptance == Acceptance::AsClaimed {
            return false;
        }
        let target = self.mission.position_of(leg.to);
        let arrival = TimedPoint::new(target, self.state.now_s + self.straight_s(&target));
        distance_to_regions_m(&arrival, &self.state.regions, 1.0) < 0.0
    }

    /// The place nearest to the leg's covered target where the vehicle can wait for it, if that is
    /// much nearer than the vehicle is: it must be clear on arrival and for a while after.
    pub(crate) fn stand_off(&self) -> Option<Point3<f64>> {
        let leg = self.state.leg.as_ref()?;
        let target = self.mission.position_of(leg.to);
        let here = self.state.position;
        let wanted_m = self.mission.clearance_m + self.settings.hysteresis_m;
        let clear = |place: &Point3<f64>| {
            let arrival_s = self.state.now_s + self.straight_s(place);
            [0.0, 0.5, 1.0].iter().all(|share| {
                let time_s = arrival_s + share * STAY_CLEAR_S;
                let then = TimedPoint::new(*place, time_s);
                distance_to_regions_m(&then, &self.state.regions, wanted_m) >= wanted_m
            })
        };
        let farthest_m = (target - here).norm() - LEAST_GAIN_M;
        let rings = (1..=RINGS)
            .map(|k| RING_M * f64::from(k))
            .take_while(|&ring_m| ring_m <= farthest_m);
        rings.into_iter().find_map(|ring_m| {
            reflex::directions()
                .map(|direction| target + direction * ring_m)
                .filter(|place| self.mission.is_open(place) && clear(place))
                .min_by(|a, b| (a - here).norm().total_cmp(&(b - here).norm()))
        })
    }

    /// How long the vehicle has done nothing but wait, in this leg and in those given up before it,
    /// seconds.
    pub(crate) fn shut_in_s(&self) -> f64 {
        let this = self.state.leg.as_ref();
        let this = this.map(|leg| (false, leg.waited_s, self.leg_s(leg)));
        let before = self.state.path_calls.iter().rev();
        let before = before.map(|call| (call.completed, call.waited_s, call.leg_s));
        let mut made_way = false;
        let idle = this
            .into_iter()
            .chain(before)
            .take_while(|(completed, waited_s, leg_s)| {
                !completed && !std::mem::replace(&mut made_way, *waited_s < NO_WAY * leg_s)
            });
        idle.map(|(_, waited_s, _)| waited_s).sum()
    }

    /// Whether the battery holds no more than it takes to come up from here, twice.
    pub(crate) fn needs_energy_left_to_surface(&self) -> bool {
        self.mission.battery.as_ref().is_some_and(|battery| {
            let vehicle = &self.mission.vehicle;
            let top_m = self.mission.bounds.map_or(0.0, |bounds| bounds.low.z);
            let rise_m = (self.state.position.z - top_m).max(0.0);
            let way_m = rise_m / libm::sin(vehicle.max_pitch_rad).max(0.01);
            let surfacing_j = battery.used_j(way_m / vehicle.speed_mps, way_m);
            battery.usable_j - self.state.used_j <= 2.0 * surfacing_j
        })
    }

    /// One retry with a new seed; then out of the way, or on along what is in force.
    pub(crate) fn path_failed(&mut self, commands: &mut Vec<Command>) {
        let Some(leg) = &mut self.state.leg else {
            return;
        };
        leg.failures = leg.failures.saturating_add(1);
        if leg.failures == 1 {
            return self.ask_path(commands);
        }
        self.get_out_of_the_way(commands);
    }

    /// While a plan is awaited: out of the way of what comes, and no standing still at the end of the
    /// way for a vehicle that cannot.
    pub(crate) fn keep_clear(&mut self, commands: &mut Vec<Command>) {
        let trusting = self.settings.acceptance == Acceptance::AsClaimed;
        if trusting || self.state.in_force.is_none() {
            return;
        }
        if self.in_force_is_over() || !self.in_force_is_clear() {
            self.get_out_of_the_way(commands);
        }
    }

    /// On along what is in force if that is clear, else to the nearest place to wait.
    pub(crate) fn get_out_of_the_way(&mut self, commands: &mut Vec<Command>) {
        let over = self.in_force_is_over();
        let clear = !over && self.in_force_is_clear();
        if let Some(leg) = &mut self.state.leg {
            if clear && leg.stays_from_s.is_some() {
                return;
            }
            leg.waiting = true;
            leg.approaching = false;
            leg.stays_from_s = None;
        }
        if clear {
            return;
        }
        let request = self.bare_problem_request();
        // Circles are flown anew all the time: those of a vehicle that cannot stop are made for a while.
        let for_s = if self.mission.vehicle.can_hover() {
            self.settings.lookahead_s
        } else {
            self.settings.lookahead_s.min(CIRCLES_S)
        };
        let way = reflex::evade(&request.problem(), self.state.velocity, for_s);
        if let Some(way) = way {
            self.follow(way, commands);
        } else if over {
            // Nothing the vehicle can fly obeys box and bed: it stays as well as it can.
            let (here, for_s) = (self.here(), self.settings.retry_s);
            let ways = stays(&request.problem(), here, self.state.velocity, for_s);
            let stay = ways.into_iter().next();
            self.follow(
                stay.unwrap_or_else(|| Trajectory::hover(here, for_s)),
                commands,
            );
        }
    }
}
