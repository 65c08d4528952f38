//! The ways along the arcs of a mission's network in the forecast current.

use crate::Mission;
use auv_planning::front::{NetworkFronts, NetworkSea};
use std::sync::Arc;

/// In a current slower than this share of the cruising speed the given ways are near the quickest.
const CALM: f64 = 0.25;
/// Departures are this far apart, or farther where that makes too many, seconds.
const STEP_S: f64 = 3_600.0;
const MOST_DEPARTURES: f64 = 13.0;

impl Mission {
    /// Finds the quickest way along each arc in the forecast current, for departures from the launch to the end
    /// of the budget: [`Mission::fronts`]. Routes then know the ways round a current that is too strong.
    ///
    /// # Determinism
    /// The result depends on the mission's network, times, vehicle, box, bed, guides and current.
    pub fn find_fronts(&mut self) {
        self.fronts = None;
        let Some(current) = self.current.as_deref() else {
            return;
        };
        let is_sound = self.vehicle.validate().is_empty()
            && self.launch_s.is_finite()
            && (0.0..f64::INFINITY).contains(&self.budget_s);
        if !is_sound || current.max_speed_mps() < CALM * self.vehicle.speed_mps {
            return;
        }
        let sea = NetworkSea {
            leg_time: self.leg_time(),
            bounds: self.bounds,
            floor: self.floor(),
        };
        let steps = (self.budget_s / STEP_S)
            .ceil()
            .clamp(1.0, MOST_DEPARTURES - 1.0);
        let departure_s = |k: usize| self.launch_s + self.budget_s * k as f64 / steps;
        let departures_s: Vec<f64> = (0..=steps as usize).map(departure_s).collect();
        let fronts = NetworkFronts::new(&self.network, &sea, &self.guides, &departures_s);
        self.fronts = Some(Arc::new(fronts));
    }
}
