//! Faults of the vehicle: speed, position fix, energy.

use super::Intensity;
use super::injection::Injection;
use crate::Scenario;
use crate::disturbance::{Moment, SensingError};
use auv_mission::{Battery, Event};
use auv_types::rand::RngExt;
use auv_types::{Seed, Vector3, libm};
use std::sync::Arc;

/// Fault 16: the vehicle is faster or slower than planned.
pub(super) struct LegTime {
    pub(super) intensity: Intensity,
}

impl Injection for LegTime {
    fn pace(&self, since_s: f64) -> f64 {
        if since_s < 600.0 {
            self.intensity.of([2.0, 0.5, 0.25, 0.1])
        } else {
            1.0
        }
    }
}

/// Fault 22: the position fix is wrong.
pub(super) struct Navigation {
    intensity: Intensity,
    direction: Vector3<f64>,
}

impl Navigation {
    pub(super) fn new(intensity: Intensity, seed: Seed) -> Self {
        let bearing = seed.stream(0).random_range(0.0..std::f64::consts::TAU);
        let (sin, cos) = libm::sincos(bearing);
        Self {
            intensity,
            direction: Vector3::new(cos, sin, 0.0),
        }
    }
}

impl Injection for Navigation {
    fn sensing_error(&mut self, now: &Moment, error: &mut SensingError) {
        let lasts_s = self.intensity.of([60.0, 60.0, 20.0, f64::INFINITY]);
        if now.since_s < lasts_s {
            error.shift += self.direction * self.intensity.of([10.0, 50.0, 500.0, 0.0]);
            error.lost |= self.intensity.degree() == 4;
        }
    }
}

/// Fault 23: energy is lost.
pub(super) struct Energy {
    intensity: Intensity,
    battery: Battery,
    cruise_mps: f64,
    told: bool,
}

impl Energy {
    pub(super) fn new(intensity: Intensity) -> Self {
        Self {
            intensity,
            battery: Battery {
                usable_j: 0.0,
                hotel_w: 40.0,
                propulsion_j_per_m: 50.0,
            },
            cruise_mps: 0.0,
            told: false,
        }
    }
}

impl Injection for Energy {
    /// Adds a battery that lasts exactly for the budget.
    fn prepare(&mut self, scenario: &mut Scenario) {
        let mut mission = (*scenario.mission).clone();
        self.cruise_mps = mission.vehicle.speed_mps;
        self.battery.usable_j = self
            .battery
            .used_j(mission.budget_s, mission.budget_s * self.cruise_mps);
        mission.battery = Some(self.battery);
        scenario.mission = Arc::new(mission);
    }

    fn events(&mut self, now: &Moment, events: &mut Vec<Event>) {
        if std::mem::replace(&mut self.told, true) {
            return;
        }
        let used_j = self
            .battery
            .used_j(now.time_s, now.time_s * self.cruise_mps);
        let lost = self.intensity.of([0.1, 0.25, 0.5, 0.75]);
        events.push(Event::BatteryMeasured {
            left_j: (self.battery.usable_j - used_j) * (1.0 - lost),
        });
    }
}
