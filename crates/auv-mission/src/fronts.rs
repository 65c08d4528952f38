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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_graph::NodeId;
    use auv_ocean::{CurrentField, UniformCurrent};
    use auv_types::{Point3, Vector3};

    /// Southward at 2.8 m/s within 300 m of the line between the waypoints.
    #[derive(Debug)]
    struct Jet;

    impl CurrentField for Jet {
        fn velocity_at(&self, place: &Point3<f64>, _: f64) -> Vector3<f64> {
            if place.y.abs() < 300.0 {
                Vector3::x() * -2.8
            } else {
                Vector3::zeros()
            }
        }

        fn max_speed_mps(&self) -> f64 {
            2.8
        }
    }

    #[test]
    fn the_way_round_a_jet_is_quicker_than_against_it() {
        let mut mission = Fixture::new().mission;
        // Of the two waypoints 1,800 m apart.
        let arc = mission.network.arc_between(NodeId(0), NodeId(2)).unwrap();
        mission.current = Some(Arc::new(Jet));
        mission.find_fronts();
        let fronts = mission.fronts.as_ref().unwrap();
        let against_s = 1_800.0 / (3.0 - 2.8);
        let round_s = fronts.travel_s(arc, 0.0);
        // Out of the jet, along it, and back in: less than the straight way, more than without the jet.
        assert!((600.0..0.5 * against_s).contains(&round_s), "{round_s} s");
        assert!(fronts.way(arc, 0.0).iter().any(|p| p.y.abs() > 250.0));
        let back = mission.network.arc_between(NodeId(2), NodeId(0)).unwrap();
        assert!(fronts.travel_s(back, 0.0) <= 1_800.0 / 5.8 + 1.0);
    }

    #[test]
    fn no_fronts_are_kept_where_the_current_matters_little_or_nothing_is_known() {
        let mut mission = Fixture::new().mission;
        mission.current = Some(Arc::new(Jet));
        mission.find_fronts();
        assert!(mission.fronts.is_some());
        mission.current = Some(Arc::new(UniformCurrent::new(Vector3::x() * 0.7)));
        mission.find_fronts();
        assert!(
            mission.fronts.is_none(),
            "those of another current are dropped"
        );
        mission.current = Some(Arc::new(UniformCurrent::new(Vector3::x() * 0.8)));
        mission.find_fronts();
        assert!(mission.fronts.is_some());
        for (budget_s, launch_s) in [(f64::NAN, 0.0), (f64::INFINITY, 0.0), (600.0, f64::NAN)] {
            (mission.budget_s, mission.launch_s) = (budget_s, launch_s);
            mission.find_fronts();
            assert!(mission.fronts.is_none());
        }
        (mission.budget_s, mission.launch_s, mission.current) = (600.0, 0.0, None);
        mission.find_fronts();
        assert!(mission.fronts.is_none());
    }
}
