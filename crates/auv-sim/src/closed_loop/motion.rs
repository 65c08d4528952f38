//! How sea and vehicle move between two ticks, and how that is judged.

use crate::closed_loop::ClosedLoop;
use crate::disturbance::{Disturbance, SensingError};
use crate::limits::Asked;
use crate::oracle::SeaInterval;
use crate::{Entry, Guidance, Recorder};
use auv_obstacles::{Region, TimedPoint};
use auv_ocean::{CurrentField, SeaBed};
use auv_planning::Trajectory;
use auv_types::{Point3, Vector3, Violations};

impl ClosedLoop<'_> {
    /// Advances sea and vehicle until the next scan or the time the synchroniser is due.
    pub(crate) fn fly_to_next_tick(
        &mut self,
        disturbance: &mut dyn Disturbance,
        recorder: &mut dyn Recorder,
    ) -> Result<(), Violations> {
        let error = self.error(disturbance);
        let until_s = self.next_tick_after(error);
        let water = self.scenario.true_current.as_deref();
        let added = disturbance.water(self.time_s);
        self.field.step(until_s - self.time_s, &|place, time_s| {
            let natural = water.map_or_else(Vector3::zeros, |w| w.velocity_at(place, time_s));
            added.map_or(natural, |added| natural + added)
        });
        self.track.clear();
        self.track
            .push(TimedPoint::new(self.vehicle.position(), self.time_s));
        let pace = disturbance.pace(self.time_s);
        self.follow(until_s, error, pace, added);
        self.check_track(until_s)?;
        if let Some(trajectory) = &self.trajectory {
            for at in &self.track[1..] {
                let told = trajectory.at(at.time_s + error.clock_s).0 - error.shift;
                self.following.see((at.position - told).norm());
            }
        }
        self.note_surfacing();
        self.navigate(added);
        self.note_dock();
        let bed = self.scenario.bed_between(self.time_s, until_s);
        let bed = bed.as_ref().map(|bed| bed as &dyn SeaBed);
        let whole: Vec<Region>;
        let truth = if disturbance.obstacles().is_empty() {
            self.field.regions()
        } else {
            whole = [self.field.regions(), disturbance.obstacles()].concat();
            &whole
        };
        let scenario = self.scenario;
        let mut asked = Asked::of(&scenario.mission, scenario.guidance_error_m);
        if self.surfaces {
            asked.bounds.low.z = asked.bounds.low.z.min(0.0);
        }
        let judgement = &mut self.judgement;
        judgement.judge(&self.track, truth, &self.ships, bed, &asked);
        let broken = &mut judgement.limits_broken;
        scenario.fences.judge(&self.track, broken);
        if disturbance.wants_truth() {
            disturbance.record_truth(self.interval(until_s, truth, (pace, added)));
        }
        recorder.record(Entry::Flown {
            track: &self.track,
            truth,
            predicted: &self.predicted,
        });
        self.time_s = until_s;
        Ok(())
    }

    /// Whether the vehicle moved as it has to: a vehicle of the caller's own may not.
    fn check_track(&self, until_s: f64) -> Result<(), Violations> {
        let mut violations = Violations::new();
        let end = self.track[self.track.len() - 1];
        let finite = |p: &TimedPoint| p.position.iter().all(|x| x.is_finite());
        let in_order = self
            .track
            .windows(2)
            .all(|pair| pair[0].time_s <= pair[1].time_s);
        let arrived = (end.position - self.vehicle.position()).norm() <= 1e-6;
        let in_time = self.track.len() > 1 && (end.time_s - until_s).abs() <= 1e-6;
        let sound = self.track.iter().all(finite) && in_order && in_time && arrived;
        violations.require(sound, "vehicle", || {
            format!(
                "moved to {} at {} s, and was to move until {until_s} s; give finite points in the order of time, the \
                 last one where the vehicle is at that time",
                end.position, end.time_s
            )
        });
        violations.into_result()
    }

    /// When the next scan or the synchroniser's own tick is due, mission time in seconds.
    fn next_tick_after(&self, error: SensingError) -> f64 {
        let mut until_s = self.next_scan_s;
        let due_s = self.synchroniser.due_s() - error.clock_s;
        if due_s > self.time_s {
            until_s = until_s.min(due_s);
        }
        if until_s <= self.time_s {
            until_s = self.time_s + self.scenario.tick_s;
        }
        until_s
    }

    /// Surfacing leaves the box upwards on purpose, until the vehicle is back in it.
    fn note_surfacing(&mut self) {
        let top_m = self.scenario.mission.limits().low.z;
        let within = self.vehicle.position().z >= top_m;
        self.surfaces = self.synchroniser.surfaces() || self.surfaces && !within;
    }

    /// What the vehicle believes after the last track.
    fn navigate(&mut self, added: Option<Vector3<f64>>) {
        let natural = self.scenario.true_current.as_deref();
        let natural = natural.filter(|_| self.scenario.current_moves_vehicle);
        let pushed = added.map(|added| Pushed { natural, added });
        let water = pushed
            .as_ref()
            .map_or(natural, |w| Some(w as &dyn CurrentField));
        let navigator = self.navigator.as_mut();
        if let Some(jump) = navigator.and_then(|n| n.take(&self.track, water)) {
            self.tracker.moved(&jump);
        }
    }

    /// The truth since the last tick, for the oracle.
    fn interval(
        &self,
        until_s: f64,
        truth: &[Region],
        (pace, added): (f64, Option<Vector3<f64>>),
    ) -> SeaInterval {
        let natural = self.scenario.true_current.as_deref();
        let natural = natural.filter(|_| self.scenario.current_moves_vehicle);
        SeaInterval {
            from_s: self.time_s,
            until_s,
            place: self.track[0].position,
            regions: truth.to_vec(),
            water: added.unwrap_or_else(Vector3::zeros),
            water_differs_mps: natural.map_or(0.0, CurrentField::max_speed_mps),
            max_speed_mps: self.scenario.mission.vehicle.max_speed_mps * pace,
        }
    }

    /// Moves the vehicle along what it follows.
    fn follow(
        &mut self,
        until_s: f64,
        error: SensingError,
        pace: f64,
        added: Option<Vector3<f64>>,
    ) {
        let natural = self.scenario.true_current.as_deref();
        let natural = natural.filter(|_| self.scenario.current_moves_vehicle);
        let pushed = added.map(|added| Pushed { natural, added });
        let water = pushed
            .as_ref()
            .map_or(natural, |w| Some(w as &dyn CurrentField));
        let Some(trajectory) = &self.trajectory else {
            let here = TimedPoint::new(self.vehicle.position(), until_s);
            return self.track.push(here);
        };
        if error == SensingError::NONE && (pace - 1.0).abs() <= 0.0 {
            let guidance = Guidance {
                trajectory,
                from_s: self.time_s,
                until_s,
                pace: 1.0,
                mission: &self.scenario.mission,
                water,
            };
            return self.vehicle.advance(&guidance, &mut self.track);
        }
        // The trajectory in true time and true coordinates; a pace above 1 brings later points forward.
        let hurry = pace.max(1.0);
        let truly = |p: &TimedPoint| {
            let time_s = p.time_s - error.clock_s;
            let time_s = self.time_s + (time_s - self.time_s) / hurry;
            TimedPoint::new(p.position - error.shift, time_s)
        };
        let here = TimedPoint::new(self.vehicle.position(), self.time_s);
        let trajectory = Trajectory::new(trajectory.points().iter().map(truly).collect())
            .unwrap_or_else(|_| Trajectory::hover(here, until_s - self.time_s));
        let guidance = Guidance {
            trajectory: &trajectory,
            from_s: self.time_s,
            until_s,
            pace,
            mission: &self.scenario.mission,
            water,
        };
        self.vehicle.advance(&guidance, &mut self.track);
    }
}

/// The sum of a current and a uniform one.
#[derive(Debug)]
struct Pushed<'a> {
    natural: Option<&'a dyn CurrentField>,
    added: Vector3<f64>,
}

impl CurrentField for Pushed<'_> {
    fn velocity_at(&self, place: &Point3<f64>, time_s: f64) -> Vector3<f64> {
        let natural = self.natural.map(|field| field.velocity_at(place, time_s));
        natural.unwrap_or_else(Vector3::zeros) + self.added
    }

    fn max_speed_mps(&self) -> f64 {
        self.natural.map_or(0.0, |field| field.max_speed_mps()) + self.added.norm()
    }
}
