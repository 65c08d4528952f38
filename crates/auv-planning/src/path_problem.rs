//! What a path planner is asked.

use crate::motion::{Floor, LEAST_SPEED_SHARE, NotFlyable, format_point, speed_over_ground_mps};
use crate::{Trajectory, Vehicle};
use auv_obstacles::{Region, TimedPoint};
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
    /// The box the vehicle must stay in.
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
            violations.require(
                velocity.iter().all(|x| x.is_finite()),
                "start_velocity",
                || "is not finite; give m/s or none".into(),
            );
        }
        violations.require(self.departure_s.is_finite(), "departure_s", || {
            "is not finite; give seconds".into()
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
        speed_over_ground_mps(speed, direction, &water, LEAST_SPEED_SHARE)
    }

    /// Speed over ground in m/s on a straight piece entered at `time_s`, reduced so that the vehicle
    /// needs no more than its greatest speed anywhere on it. A slower vehicle meets the current of a
    /// later time, so the reduction repeats until the speed no longer changes.
    fn slowed(
        &self,
        mut speed: f64,
        [from, to]: [Point3<f64>; 2],
        (direction, piece_m): (&Vector3<f64>, f64),
        time_s: f64,
    ) -> Result<f64, NotFlyable> {
        let Some(field) = self.current else {
            return Ok(speed);
        };
        for _ in 0..8 {
            let before = speed;
            let elapsed_s = piece_m / speed;
            // Ends and middle; more where the vehicle is slow over ground.
            let travelled_m = elapsed_s * self.vehicle.speed_mps;
            let samples = 2.0 * (travelled_m / 100.0).ceil().clamp(1.0, 100.0);
            for k in 0..=samples as usize {
                let share = k as f64 / samples;
                let place = from + (to - from) * share;
                let water = field.velocity_at(&place, time_s + elapsed_s * share);
                let most = self.vehicle.max_speed_mps;
                let limit = speed_over_ground_mps(most, direction, &water, LEAST_SPEED_SHARE);
                speed = speed.min(limit.ok_or(NotFlyable { place })?);
            }
            if speed >= before * (1.0 - 1e-6) {
                break;
            }
        }
        Ok(speed)
    }

    /// Whether the current may change so much along a piece that a vehicle that cruises at its middle
    /// needs more than its greatest speed at an end.
    fn may_exceed_max_speed(&self) -> bool {
        let spare_mps = self.vehicle.max_speed_mps - self.vehicle.speed_mps;
        self.current
            .is_some_and(|field| 2.0 * field.max_speed_mps() > spare_mps)
    }

    /// Times a polyline from the departure on, at cruising speed through the water (Eq. 17).
    ///
    /// With a current, segments are cut into pieces of at most 50 m. Each piece is travelled in the
    /// current at its middle, slower where the vehicle would exceed its greatest speed at an end of
    /// the piece. Repeated points are merged.
    ///
    /// # Errors
    /// [`NotFlyable`] where the current is too strong.
    pub fn timed(&self, points: &[Point3<f64>]) -> Result<Trajectory, NotFlyable> {
        let first = points.first().copied().unwrap_or(self.start);
        let mut timed = vec![TimedPoint::new(first, self.departure_s)];
        let mut time_s = self.departure_s;
        let mut at = first;
        let may_exceed_max_speed = self.may_exceed_max_speed();
        for &point in points.iter().skip(1) {
            let length_m = (point - at).norm();
            if length_m <= 1e-9 {
                continue;
            }
            let direction = (point - at) / length_m;
            let pieces = if self.current.is_some() {
                (length_m / 50.0).ceil().max(1.0)
            } else {
                1.0
            };
            let piece_m = length_m / pieces;
            let begin = at;
            for k in 1..=pieces as usize {
                let middle = begin + direction * (piece_m * (k as f64 - 0.5));
                let guess_s = time_s + 0.5 * piece_m / self.vehicle.speed_mps;
                let mut speed = self
                    .ground_speed_mps(&direction, &middle, guess_s)
                    .ok_or(NotFlyable { place: middle })?;
                let from = at;
                at = if k == pieces as usize {
                    point
                } else {
                    begin + direction * (piece_m * k as f64)
                };
                if may_exceed_max_speed {
                    speed = self.slowed(speed, [from, at], (&direction, piece_m), time_s)?;
                }
                time_s += piece_m / speed;
                timed.push(TimedPoint::new(at, time_s));
            }
        }
        Ok(Trajectory::from_ordered(timed))
    }
}
