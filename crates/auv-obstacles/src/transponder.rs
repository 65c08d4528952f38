//! How far ahead a ship is predicted from its transponder.

use crate::Region;
use std::f64::consts::FRAC_PI_2;

/// A ship is predicted no farther ahead than this, seconds.
const LONGEST_S: f64 = 3600.0;

/// Predicts a ship from what its transponder reports: straight on, at its speed.
///
/// The prediction lasts as long as the vehicle needs to turn away and leave the ship's way from its middle,
/// and as the ship then needs to pass: hull, distance to keep abeam and both speeds decide. A ship at anchor
/// is predicted for an hour.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShipForecast {
    /// The vehicle's speed, m/s.
    pub speed_mps: f64,
    /// The vehicle's turn radius, metres.
    pub turn_radius_m: f64,
    /// Least time ahead, seconds.
    pub least_s: f64,
}

impl ShipForecast {
    /// The region from `now_s` on of a ship as it is reported then, grown by the clearance kept from it.
    #[must_use]
    pub fn ahead(&self, reported: Region, now_s: f64) -> Region {
        let radius_m = reported.radius_at(now_s);
        let leave_s = (FRAC_PI_2 * self.turn_radius_m + radius_m) / self.speed_mps;
        let pass_s = 2.0 * radius_m / reported.velocity_mps.xy().norm();
        let horizon_s = (leave_s + pass_s).min(LONGEST_S).max(self.least_s);
        Region {
            from_s: now_s,
            until_s: now_s + horizon_s,
            ..reported
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Point3, Vector3};

    fn horizon_s(radius_m: f64, ship_mps: f64, least_s: f64) -> f64 {
        let forecast = ShipForecast {
            speed_mps: 1.5,
            turn_radius_m: 20.0,
            least_s,
        };
        let mut ship = Region::cylinder(Point3::origin(), radius_m, -5.0, 20.0);
        ship.velocity_mps = Vector3::new(ship_mps, 0.0, 0.0);
        let ahead = forecast.ahead(ship, 70.0);
        assert_eq!(ahead.from_s, 70.0);
        ahead.until_s - 70.0
    }

    #[test]
    fn a_ship_is_predicted_until_the_vehicle_has_left_its_way_and_it_has_passed() {
        // A quarter turn and 235 m at 1.5 m/s, and twice 235 m at 10 m/s.
        let wanted_s = (FRAC_PI_2 * 20.0 + 235.0) / 1.5 + 47.0;
        assert!((horizon_s(235.0, 10.0, 120.0) - wanted_s).abs() < 1e-9);
        assert!(horizon_s(235.0, 5.0, 120.0) > wanted_s);
        assert!(horizon_s(435.0, 10.0, 120.0) > wanted_s);
        assert_eq!(horizon_s(5.0, 10.0, 120.0), 120.0);
        assert_eq!(horizon_s(235.0, 0.0, 120.0), LONGEST_S);
    }
}
