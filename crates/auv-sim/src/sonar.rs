//! The sonar of a simulation.

use auv_obstacles::{Region, Scan, Sonar};
use auv_types::{ChaCha8Rng, Point3};
use std::fmt::Debug;

/// A sonar that scans the true sea: [`crate::Simulation::with_sonar`].
pub trait SimulatedSonar: Debug {
    /// One scan of the true regions that exist at a mission time, from a place, the bow towards a heading (radians
    /// from north to east). Random numbers come from `random` alone.
    fn scan(
        &mut self,
        truth: &[Region],
        from: &Point3<f64>,
        heading_rad: f64,
        time_s: f64,
        random: &mut ChaCha8Rng,
    ) -> Scan;
}

impl SimulatedSonar for Sonar {
    fn scan(
        &mut self,
        truth: &[Region],
        from: &Point3<f64>,
        heading_rad: f64,
        time_s: f64,
        random: &mut ChaCha8Rng,
    ) -> Scan {
        Sonar::scan(self, truth, from, heading_rad, time_s, random)
    }
}
