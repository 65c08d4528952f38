//! What the vehicle senses: sonar, altimeter, place and predicted obstacles.

use crate::closed_loop::ClosedLoop;
use crate::disturbance::{Disturbance, Moment, SensingError};
use crate::navigator::Navigator;
use auv_mission::{Navigation, Observation};
use auv_obstacles::truth::TrackedShip;
use auv_obstacles::{ObstacleId, Region};
use auv_ocean::SeaBed;
use auv_types::{Vector3, libm};
use std::sync::Arc;

impl ClosedLoop<'_> {
    /// What the altimeter answers, if there is one and it answers.
    pub(in crate::closed_loop) fn measured_altitude(&mut self) -> Option<f64> {
        let scenario = self.scenario;
        let altimeter = scenario.altimeter.as_ref()?;
        let bed = scenario.bed_between(self.time_s, self.time_s)?;
        let place = self.vehicle.position();
        let altitude_m = bed.depth_at(place.x, place.y) - place.z;
        altimeter.measure(altitude_m, &mut self.altimeter_random)
    }

    /// Scans the true sea. The tracker gets the echoes relative to the position the vehicle believes.
    pub(in crate::closed_loop) fn scan(&mut self, now: &Moment, disturbance: &mut dyn Disturbance) {
        let velocity = self.vehicle.velocity();
        let heading_rad = if velocity.xy().norm() > 1e-6 {
            libm::atan2(velocity.y, velocity.x)
        } else {
            0.0
        };
        let unknown = disturbance.obstacles();
        let whole: Vec<Region>;
        let truth = if unknown.is_empty() {
            self.field.now()
        } else {
            whole = [self.field.now(), unknown].concat();
            &whole
        };
        let mut scan = self.sonar.scan(
            truth,
            &self.vehicle.position(),
            heading_rad,
            self.time_s,
            &mut self.sonar_random,
        );
        let error = self.error(disturbance);
        if error.shift != Vector3::zeros() {
            scan.from += error.shift;
            for echo in &mut scan.detections {
                echo.position += error.shift;
            }
        }
        if error.lost {
            scan.from.x = f64::NAN;
        }
        for scan in disturbance.scans(now, scan) {
            self.tracker.observe(&scan);
        }
    }

    /// The observation the synchroniser gets.
    pub(in crate::closed_loop) fn observation(&self, error: SensingError) -> Observation {
        let slip_s = error.clock_s + error.stamp_s;
        let mut observation = Observation {
            position_sigma_m: self.sigma_m(),
            time_s: self.time_s,
            position: self.vehicle.position(),
            velocity: self.vehicle.velocity(),
            regions: Arc::clone(&self.predicted),
        };
        if error.lost {
            observation.position.x = f64::NAN;
        } else if error.shift != Vector3::zeros() {
            observation.position += error.shift;
        }
        if slip_s != 0.0 {
            observation.time_s += slip_s;
            let later = |region: &Region| Region {
                at_s: region.at_s + slip_s,
                from_s: region.from_s + slip_s,
                until_s: region.until_s + slip_s,
                ..*region
            };
            observation.regions = self.predicted.iter().map(later).collect();
        }
        observation
    }

    /// The errors of clock and place at this tick: the disturbance's and the navigator's.
    pub(in crate::closed_loop) fn error(&self, disturbance: &dyn Disturbance) -> SensingError {
        let mut error = disturbance.sensing_error();
        if let Some(navigator) = &self.navigator {
            error.shift += navigator.error();
        }
        error
    }

    /// What the vehicle believes of its error, standard deviation in metres.
    pub(in crate::closed_loop) fn sigma_m(&self) -> f64 {
        self.navigator.as_ref().map_or(0.0, Navigator::sigma_m)
    }

    /// Predicts regions from the chart, the tracks, and the ships as their transponders report them.
    pub(in crate::closed_loop) fn predict(&mut self) {
        let (policy, forecast) = (&self.scenario.clearance, self.scenario.ship_forecast());
        let error_m = Navigation::SIGMAS * self.sigma_m();
        let (ships, now) = (self.reported_ships(), (self.time_s, error_m));
        let tracker = self.tracker.as_ref();
        let mut predicted = policy.predicted(tracker, &ships, &forecast, now);
        let kept = |fence: &Region| fence.inflated(policy.tracking_error_m).widened(error_m);
        predicted.extend(self.fences.iter().map(kept));
        self.predicted = predicted.into();
    }

    /// The ships as their transponders report them now.
    pub(in crate::closed_loop) fn reported_ships(&self) -> Vec<Region> {
        let ships = self.field.ships().iter().zip(self.ships.clone());
        let reported =
            |(ship, id): (&TrackedShip, u32)| ship.region_at(ObstacleId(id), self.time_s);
        ships.filter_map(reported).collect()
    }
}
