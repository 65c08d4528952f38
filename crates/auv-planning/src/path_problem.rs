//! What a path planner is asked.

use crate::motion::{Floor, format_point, speed_over_ground_mps};
use crate::{Trajectory, Vehicle};
use auv_obstacles::Region;
use auv_ocean::{CurrentField, SeaBed};
use auv_types::{Bounds, Point3, Vector3, Violations};

/// A trajectory from `start` to `target` for one leg. This is all that a planner may know: regions
/// are predictions, never the truth.
#[derive(Clone, Copy, Debug)]
pub struct PathProblem<'a> {
    /// Where the vehicle is at departure, metres.
    pub start: Point3<f64>,
    /// Its ground velocity there in m/s. The trajectory continues it within the turn radius. `None`:
    /// any direction.
    pub start_velocity: Option<Vector3<f64>>,
    /// Where the trajectory ends, metres.
    pub target: Point3<f64>,
    /// When the vehicle departs, mission time in seconds.
    pub departure_s: f64,
    /// The limits of its motion.
    pub vehicle: &'a Vehicle,
    /// The box the vehicle must stay in; its least depth keeps it below the surface. `None`: nothing
    /// does, and a path may leave the water on its way round a region. Give a box in any real sea.
    pub bounds: Option<Bounds>,
    /// The sea bed, if there is one to avoid.
    pub sea_bed: Option<&'a dyn SeaBed>,
    /// Least altitude above the bed, metres.
    pub min_altitude_m: f64,
    /// Standard deviations of the bed's depth added to the least altitude.
    pub altitude_sigmas: f64,
    /// The current that moves the vehicle (`None`: still water).
    pub current: Option<&'a dyn CurrentField>,
    /// The regions that obstacles are predicted to cover.
    pub regions: &'a [Region],
    /// Least distance from every region's surface, metres.
    pub clearance_m: f64,
    /// A trajectory to start the search from, for instance the one in force.
    pub warm_start: Option<&'a Trajectory>,
}

impl<'a> PathProblem<'a> {
    /// A problem in open, still water.
    #[must_use]
    pub fn new(start: Point3<f64>, target: Point3<f64>, vehicle: &'a Vehicle) -> Self {
        Self {
            start,
            start_velocity: None,
            target,
            departure_s: 0.0,
            vehicle,
            bounds: None,
            sea_bed: None,
            min_altitude_m: 0.0,
            altitude_sigmas: 0.0,
            current: None,
            regions: &[],
            clearance_m: 0.0,
            warm_start: None,
        }
    }

    /// All errors in the problem itself. Whether a path exists is not checked.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let far = |p: &Point3<f64>| p.iter().any(|x| !x.is_finite() || x.abs() > 1e7);
        for (point, place) in [(&self.start, "start"), (&self.target, "target")] {
            violations.require(!far(point), place, || {
                format!(
                    "is {}; give finite coordinates within 10,000 km",
                    format_point(point)
                )
            });
        }
        if let Some(velocity) = self.start_velocity {
            // The square of a greater one may overflow, and with it the direction.
            violations.require(
                velocity.iter().all(|x| x.abs() <= 1e9),
                "start_velocity",
                || "is not finite or beyond 1e9; give m/s or none".into(),
            );
        }
        // Beyond, seconds of a leg are lost in the rounding of its times.
        violations.require(self.departure_s.abs() <= 1e10, "departure_s", || {
            "is not finite or beyond 1e10; give seconds of mission time".into()
        });
        if let Some(bounds) = &self.bounds {
            violations.require(bounds.is_valid(), "bounds", || {
                "are not finite or not ordered; give low <= high".into()
            });
        }
        violations.require_not_negative(self.min_altitude_m, "min_altitude_m");
        violations.require_not_negative(self.altitude_sigmas, "altitude_sigmas");
        violations.require_not_negative(self.clearance_m, "clearance_m");
        violations.absorb("vehicle.", self.vehicle.validate());
        for (i, region) in self.regions.iter().enumerate() {
            // The place is formatted only for a faulty region: there may be thousands of regions.
            let mut own = Violations::new();
            region.validate_into("", &mut own);
            if !own.is_empty() {
                violations.absorb(&format!("regions[{i}]"), own);
            }
        }
        violations
    }

    /// The deepest the vehicle may be, where there is a sea bed.
    #[must_use]
    pub fn floor(&self) -> Option<Floor<'a>> {
        self.sea_bed.map(|bed| Floor {
            bed,
            min_altitude_m: self.min_altitude_m,
            altitude_sigmas: self.altitude_sigmas,
        })
    }

    /// The deepest the vehicle may be at a place, metres (`+inf` without a bed).
    #[must_use]
    pub fn deepest_at(&self, north_m: f64, east_m: f64) -> f64 {
        self.floor()
            .map_or(f64::INFINITY, |floor| floor.deepest_at(north_m, east_m))
    }

    /// Speed over ground in m/s along the unit vector `direction` at cruising speed through the
    /// water, which moves with the current; `None` where the vehicle makes no way.
    #[must_use]
    pub fn ground_speed_mps(
        &self,
        direction: &Vector3<f64>,
        place: &Point3<f64>,
        time_s: f64,
    ) -> Option<f64> {
        let speed = self.vehicle.speed_mps;
        let Some(field) = self.current else {
            return Some(speed);
        };
        let water = field.velocity_at(place, time_s);
        speed_over_ground_mps(speed, direction, &water)
    }
}
