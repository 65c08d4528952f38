//! What decisions are made from: mission, settings and state, read only.

use crate::beliefs::Beliefs;
use crate::check::Acceptor;
use crate::mode::{Leg, Mode};
use crate::state::State;
use crate::tide::Tide;
use crate::{Mission, SyncSettings};
use auv_graph::NodeId;
use auv_obstacles::TimedPoint;
use auv_planning::motion::{distance_to_regions_m, least_clearance};
use auv_planning::{LegDuration, LegOutline, LegTime, Trajectory, UnderWay};
use auv_types::{Bounds, Point3, Seed};
use std::sync::Arc;

/// Below this speed over ground a vehicle may leave in any direction, m/s.
pub(crate) const AT_REST_MPS: f64 = 0.05;
/// Times that differ by no more than this are the same, seconds.
pub(crate) const MOMENT_S: f64 = 1e-9;

/// What a trajectory dips below the bed as measured by less than this share of `off_track_m` is kept.
const DIP: f64 = 0.01;

/// Mission, settings and state, read only.
#[derive(Clone, Copy, Debug)]
pub(crate) struct View<'a> {
    pub(crate) mission: &'a Arc<Mission>,
    pub(crate) settings: &'a SyncSettings,
    pub(crate) seed: Seed,
    pub(crate) acceptor: Acceptor,
    /// Least travel time home by node, in the current forecast for the start of the leg, seconds.
    pub(crate) home_s: &'a [f64],
    /// Legs by departure, where that matters; `home_s` is not used then.
    pub(crate) tide: Option<&'a Tide>,
    pub(crate) state: &'a State,
}

impl<'a> View<'a> {
    pub(crate) fn beliefs(&self) -> &'a Beliefs {
        &self.state.beliefs
    }

    pub(crate) fn now_s(&self) -> f64 {
        self.state.beliefs.now_s
    }

    pub(crate) fn is_ready(&self) -> bool {
        self.state.mode == Mode::Ready
    }

    /// The leg being flown.
    pub(crate) fn leg(&self) -> Option<&'a Leg> {
        match &self.state.mode {
            Mode::Leg(leg) => Some(leg),
            _ => None,
        }
    }

    /// The vehicle's place now.
    pub(crate) fn here(&self) -> TimedPoint {
        TimedPoint::new(self.state.beliefs.position, self.now_s())
    }

    /// The last waypoint reached.
    pub(crate) fn at(&self) -> NodeId {
        self.state.ledger.at(self.mission)
    }

    /// Mission time left, seconds (see [`crate::Synchroniser::available_s`]).
    pub(crate) fn available_s(&self) -> f64 {
        self.state.ledger.available_s(self.mission, self.now_s())
    }

    /// The trajectory in force, with the way on from its end.
    pub(crate) fn in_force(&self) -> Option<&'a Trajectory> {
        self.state.in_force.as_ref().map(|in_force| &in_force.whole)
    }

    /// When what the trajectory in force is followed for ends; now, where there is none.
    pub(crate) fn ends_s(&self) -> f64 {
        let in_force = self.state.in_force.as_ref();
        in_force.map_or(self.now_s(), |in_force| in_force.ends_s)
    }

    /// When a decision is due at the latest: at the end of what the trajectory in force is followed for,
    /// then at the end of the way on.
    pub(crate) fn due_s(&self) -> f64 {
        if self.is_over() {
            self.in_force()
                .map_or(self.now_s(), |whole| whole.end().time_s)
        } else {
            self.ends_s()
        }
    }

    /// Whether what the trajectory in force is followed for is over, or there is none.
    pub(crate) fn is_over(&self) -> bool {
        self.now_s() >= self.ends_s() - MOMENT_S
    }

    /// Whether the trajectory in force is flown to the end of the way on, or there is none.
    pub(crate) fn is_flown(&self) -> bool {
        self.is_over() && !self.goes_on()
    }

    /// Whether the vehicle is on the way on from the end of what the trajectory in force is followed for.
    pub(crate) fn goes_on(&self) -> bool {
        let whole = self.in_force();
        self.is_over() && whole.is_some_and(|whole| self.now_s() < whole.end().time_s - MOMENT_S)
    }

    /// Distance from the vehicle to its place on the trajectory in force, metres.
    fn off_track_m(&self) -> f64 {
        self.in_force().map_or(f64::INFINITY, |in_force| {
            (self.state.beliefs.position - in_force.at(self.now_s()).0).norm()
        })
    }

    /// Whether the vehicle is where the trajectory in force has it now, within `off_track_m`.
    pub(crate) fn is_on_track(&self) -> bool {
        self.off_track_m() <= self.settings.margins.off_track_m
    }

    /// Whether the rest of what the trajectory in force is followed for, or of the way on when that is
    /// over, keeps the mission's clearance over the look-ahead time. A vehicle off its trajectory may be
    /// nearer to an obstacle by that distance.
    pub(crate) fn in_force_is_clear(&self) -> bool {
        let mut until_s = self.now_s() + self.settings.margins.lookahead_s;
        if !self.is_over() {
            until_s = until_s.min(self.ends_s());
        }
        let off_m = self.off_track_m();
        let lag_m = if off_m > self.settings.margins.off_track_m {
            off_m
        } else {
            0.0
        };
        let in_force = self.in_force();
        in_force.is_some_and(|in_force| {
            self.is_clear(in_force, until_s, lag_m)
                && self.is_high(in_force, (self.now_s(), until_s))
        })
    }

    /// Whether the way on from the end of the trajectory in force does not keep the mission's clearance. When
    /// it is being flown, [`View::in_force_is_clear`] tells.
    pub(crate) fn way_on_is_blocked(&self) -> bool {
        let wanted_m = self.mission.clearance_m;
        let window_s = (self.ends_s(), self.ends_s() + self.way_on_s());
        let regions = &self.beliefs().regions;
        let blocked = |whole: &Trajectory| {
            whole.end().time_s > self.ends_s() + MOMENT_S
                && (least_clearance(whole, regions, window_s, wanted_m).clearance_m < wanted_m
                    || !self.is_high(whole, window_s))
        };
        !self.is_over() && self.in_force().is_some_and(blocked)
    }

    /// Whether the vehicle is too low over the bed as measured. On its track that is what counts: plans keep
    /// room below for a vehicle that is off it by its guidance error.
    pub(crate) fn is_too_low(&self) -> bool {
        self.too_low_m() > self.dip_m()
    }

    /// How much too low over the bed as measured the vehicle is, metres; negative where it is high enough.
    fn too_low_m(&self) -> f64 {
        let here = self.beliefs().position;
        let on_track = self.in_force().filter(|_| self.is_on_track());
        let place = on_track.map_or(here, |in_force| in_force.at(self.now_s()).0);
        if self.state.soundings.shoals.is_empty() {
            return f64::NEG_INFINITY;
        }
        place.z - self.mission.deepest_at(place.x, place.y)
    }

    fn dip_m(&self) -> f64 {
        DIP * self.settings.margins.off_track_m + 2.0 * Trajectory::CHORD_ERROR_M
    }

    /// Whether a trajectory is nowhere within a time window lower over the bed as measured than the vehicle may
    /// be, or is now. Where nothing was measured too shallow it was verified over the same bed before.
    fn is_high(&self, trajectory: &Trajectory, (from_s, until_s): (f64, f64)) -> bool {
        if self.state.soundings.shoals.is_empty() {
            return true;
        }
        let dip_m = self.dip_m() + self.too_low_m().max(0.0);
        let part = trajectory.until(until_s).after(from_s);
        self.mission.floor().is_none_or(|floor| {
            let mut pieces = part.segments();
            pieces.all(|(from, to)| floor.grounding_m(&from.position, &to.position) <= dip_m)
        })
    }

    /// Where a waypoint is reached: there, or above it where it is too low over the bed as measured.
    pub(crate) fn raised(&self, node: NodeId) -> Point3<f64> {
        let place = self.mission.position_of(node);
        let depth_m = (place.z - self.raised_m(node)).max(self.mission.limits().low.z);
        Point3::new(place.x, place.y, depth_m.min(place.z))
    }

    /// By how much a waypoint is too low over the bed as measured, metres.
    pub(crate) fn raised_m(&self, node: NodeId) -> f64 {
        if self.state.soundings.is_charted() {
            return 0.0;
        }
        let place = self.mission.position_of(node);
        let too_low_m = place.z - self.mission.deepest_at(place.x, place.y);
        // A little more, so that paths lead there from all sides.
        if too_low_m > 0.0 {
            too_low_m + self.dip_m()
        } else {
            0.0
        }
    }

    /// Whether the vehicle is over a waypoint that the bed as measured lets it no nearer to than it may be off.
    pub(crate) fn is_over_shoal(&self, node: NodeId) -> bool {
        let off_track_m = self.settings.margins.off_track_m;
        let aside = self.beliefs().position - self.mission.position_of(node);
        self.raised_m(node) > off_track_m && aside.xy().norm() <= off_track_m
    }

    /// How long a way on must last, seconds.
    pub(crate) fn way_on_s(&self) -> f64 {
        self.settings.planning.planning_s + self.settings.margins.escape_s
    }

    /// Whether a trajectory keeps, from now until a time, the mission's clearance (or what the vehicle
    /// has left of it now) and `lag_m` more.
    pub(crate) fn is_clear(&self, trajectory: &Trajectory, until_s: f64, lag_m: f64) -> bool {
        let here_m = self.clearance_to_ask_m(self.here());
        let wanted_m = self.mission.clearance_m.min(here_m) + lag_m;
        let (now_s, until_s) = (self.now_s(), trajectory.end().time_s.min(until_s));
        let regions = &self.beliefs().regions;
        least_clearance(trajectory, regions, (now_s, until_s), wanted_m).clearance_m >= wanted_m
    }

    /// The mission's clearance and the hysteresis, metres.
    pub(crate) fn wanted_clearance_m(&self) -> f64 {
        self.mission.clearance_m + self.settings.margins.hysteresis_m
    }

    /// The mission's clearance and the hysteresis, or what is left of both at a place: a path cannot
    /// start farther from an obstacle than the vehicle is. Metres.
    pub(crate) fn clearance_to_ask_m(&self, place: TimedPoint) -> f64 {
        let wanted_m = self.wanted_clearance_m();
        let here_m = distance_to_regions_m(&place, &self.beliefs().regions, wanted_m + 1.0) - 1.0;
        wanted_m.min(here_m.max(0.0))
    }

    /// How the vehicle is under way; `None`: at rest, or turning on the spot.
    pub(crate) fn under_way(&self) -> Option<UnderWay> {
        let (place, velocity) = (self.beliefs().position, self.beliefs().velocity);
        let steers = self.mission.vehicle.turn_radius_m > 0.0 && velocity.norm() > AT_REST_MPS;
        steers.then_some(UnderWay { place, velocity })
    }

    /// How the vehicle is under way when the trajectory in force ends.
    pub(crate) fn under_way_then(&self) -> Option<UnderWay> {
        let in_force = self.state.in_force.as_ref()?;
        let purpose = in_force.purpose();
        let (place, velocity) = (purpose.end().position, purpose.end_velocity());
        let steers = self.mission.vehicle.turn_radius_m > 0.0 && velocity.norm() > AT_REST_MPS;
        steers.then_some(UnderWay { place, velocity })
    }

    /// How long it takes to turn and go straight to a place through still water, with work of `stay_s` there.
    pub(crate) fn leg_to(&self, place: Point3<f64>, stay_s: f64) -> LegDuration {
        let guide = [self.beliefs().position, place];
        let leg = LegOutline {
            stay_s,
            from: self.under_way(),
            ..LegOutline::straight(&guide, self.now_s())
        };
        let duration = LegTime::in_still_water(&self.mission.vehicle).of(&leg);
        duration.unwrap_or_default()
    }

    /// Time to a place along a straight line through still water, seconds.
    pub(crate) fn straight_s(&self, place: &Point3<f64>) -> f64 {
        (place - self.state.beliefs.position).norm() / self.mission.vehicle.speed_mps
    }

    /// The mission's limits, with the vehicle in them.
    pub(crate) fn bounds(&self) -> Bounds {
        let limits = self.mission.limits();
        limits.grown_to(&self.state.beliefs.position)
    }
}

#[cfg(test)]
mod tests;
