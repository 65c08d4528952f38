//! Margins added to predicted regions.

use crate::{ObstaclePredictor, Region, RegionShape, ShipForecast};
use auv_types::Violations;

/// The source of a region.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub enum RegionSource {
    /// A contact tracked by the sonar.
    Contact,
    /// An obstacle on the chart.
    Charted,
    /// A ship at the surface, from its transponder. The vehicle may pass below its keel.
    Ship,
}

/// Distances added to predicted regions before planning.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct ClearancePolicy {
    /// Clearance from tracked contacts, metres.
    pub contact_m: f64,
    /// Clearance from charted obstacles, metres.
    pub charted_m: f64,
    /// Clearance abeam of ships, metres.
    pub ship_abeam_m: f64,
    /// Clearance below the keel of ships, metres.
    pub ship_keel_m: f64,
    /// Greatest distance of the vehicle from its trajectory, metres; added to all of the above.
    pub tracking_error_m: f64,
}

impl ClearancePolicy {
    /// The paper's clearances: zero.
    #[must_use]
    pub const fn paper() -> Self {
        Self {
            contact_m: 0.0,
            charted_m: 0.0,
            ship_abeam_m: 0.0,
            ship_keel_m: 0.0,
            tracking_error_m: 0.0,
        }
    }

    /// Every invalid value.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        violations.require_not_negative(self.contact_m, "contact_m");
        violations.require_not_negative(self.charted_m, "charted_m");
        violations.require_not_negative(self.ship_abeam_m, "ship_abeam_m");
        violations.require_not_negative(self.ship_keel_m, "ship_keel_m");
        violations.require_not_negative(self.tracking_error_m, "tracking_error_m");
        violations
    }

    /// Everything that is predicted from a time on, grown by its clearance: the tracker's charted obstacles, its
    /// contacts, then the ships as their transponders report them now, as far ahead as `forecast` says.
    ///
    /// What is charted and the ships are wider by `place_error_m`, by which the vehicle's own place may be wrong;
    /// contacts are seen from where the vehicle is.
    #[must_use]
    pub fn predicted(
        &self,
        tracker: &dyn ObstaclePredictor,
        ships: &[Region],
        forecast: &ShipForecast,
        (time_s, place_error_m): (f64, f64),
    ) -> Vec<Region> {
        let wider = |region: Region| region.widened(place_error_m);
        let charted = tracker.charted_regions().iter();
        let charted = charted.map(|region| wider(self.inflated(RegionSource::Charted, *region)));
        let contacts = tracker.contacts(time_s).into_iter();
        let contacts = contacts.map(|region| self.inflated(RegionSource::Contact, region));
        let kept_clear = |ship: &Region| wider(self.inflated(RegionSource::Ship, *ship));
        let ships = ships.iter().map(kept_clear);
        let ships = ships.map(|ship| forecast.ahead(ship, time_s));
        charted.chain(contacts).chain(ships).collect()
    }

    /// The region, grown by the clearance for its source and by the tracking error.
    #[must_use]
    pub fn inflated(&self, source: RegionSource, region: Region) -> Region {
        let margin_m = self.tracking_error_m;
        match (source, region.shape) {
            (RegionSource::Contact, _) => region.inflated(self.contact_m + margin_m),
            (RegionSource::Charted, _) => region.inflated(self.charted_m + margin_m),
            (RegionSource::Ship, RegionShape::Ball) => {
                region.inflated(self.ship_abeam_m + margin_m)
            }
            (RegionSource::Ship, RegionShape::Cylinder { top_m, bottom_m }) => Region {
                radius_m: region.radius_m + self.ship_abeam_m + margin_m,
                shape: RegionShape::Cylinder {
                    top_m,
                    bottom_m: bottom_m + self.ship_keel_m + margin_m,
                },
                ..region
            },
        }
    }
}

impl Default for ClearancePolicy {
    /// 15 m from contacts, 10 m from charted obstacles, 200 m abeam and 10 m below ships, and 5 m of
    /// tracking error.
    fn default() -> Self {
        Self {
            contact_m: 15.0,
            charted_m: 10.0,
            ship_abeam_m: 200.0,
            ship_keel_m: 10.0,
            tracking_error_m: 5.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Point3;

    #[test]
    fn what_is_charted_and_ships_grow_by_the_error_of_the_own_place() {
        let rock = Region::ball(Point3::origin(), 50.0);
        let ship = Region::cylinder(Point3::origin(), 50.0, f64::NEG_INFINITY, 8.0);
        let mut tracker = crate::Tracker::new(crate::TrackerSettings::campaign()).unwrap();
        tracker.charted(vec![rock]);
        let policy = ClearancePolicy::default();
        let forecast = ShipForecast {
            speed_mps: 1.5,
            turn_radius_m: 20.0,
            least_s: 120.0,
        };
        let radii = |error_m| {
            let regions = policy.predicted(&tracker, &[ship], &forecast, (100.0, error_m));
            assert_eq!((regions[1].from_s, regions[1].until_s), (100.0, 3700.0));
            assert_eq!(
                regions[1].shape,
                policy.inflated(RegionSource::Ship, ship).shape
            );
            regions.iter().map(|r| r.radius_m).collect::<Vec<_>>()
        };
        assert_eq!(radii(0.0), [65.0, 255.0]);
        assert_eq!(radii(30.0), [95.0, 285.0]);
        // Depth is measured: nothing is nearer below for an error on the map.
        assert_eq!(ship.widened(30.0).shape, ship.shape);
    }

    #[test]
    fn a_ship_is_kept_clear_abeam_and_may_be_passed_below_its_keel() {
        let ship = Region::cylinder(Point3::origin(), 50.0, f64::NEG_INFINITY, 8.0);
        let kept = ClearancePolicy::default().inflated(RegionSource::Ship, ship);
        assert_eq!(kept.radius_m, 255.0);
        assert_eq!(
            kept.shape,
            RegionShape::Cylinder {
                top_m: f64::NEG_INFINITY,
                bottom_m: 23.0
            }
        );
    }
}
