//! A straight piece of a path in moving water: how long it takes, and by how much it is not clear.

use crate::taut::regions::GrownRegions;
use crate::taut::work::LOOK_UP;
use auv_obstacles::TimedPoint;
use auv_planning::PathProblem;
use auv_planning::motion::{Floor, LEAST_SPEED_SHARE, speed_over_ground_mps};
use auv_types::{Point3, Vector3, libm};

/// Metres kept above the floor, because it is only sampled once for so many metres.
const FLOOR_MARGIN_M: f64 = 0.02;
const FLOOR_STEP_M: f64 = 8.0;
/// Look-ups of the floor that a proof takes in the mean.
const PROOF_LOOK_UPS: u64 = 8;
/// A piece shorter than this has no direction, metres.
const LEAST_LENGTH_M: f64 = 1e-9;

/// How a piece of a path is held against the floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum FloorCheck {
    /// At some places.
    Sampled,
    /// Everywhere, as the finished path is.
    Proven,
}

/// The sea of a problem, as pieces of paths are flown in it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Water<'a> {
    pub(crate) problem: &'a PathProblem<'a>,
    regions: &'a GrownRegions,
    floor: Option<Floor<'a>>,
    check: FloorCheck,
    /// Greatest change of depth per horizontal metre; infinite without a pitch limit.
    slope: f64,
    /// Metres kept above the floor.
    margin_m: f64,
    /// The current is looked up once for this length, metres.
    current_step_m: f64,
}

/// A flown piece.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Flown {
    pub(crate) seconds: f64,
    /// The sum of what its samples lack in clearance, altitude and pitch, metres; 0 where it is clear.
    pub(crate) short_m: f64,
    /// Units of work.
    pub(crate) work: u64,
}

impl<'a> Water<'a> {
    /// Keeps `slack_m` above the floor and looks up the current once for so many metres of a path.
    pub(crate) fn new(
        problem: &'a PathProblem<'a>,
        regions: &'a GrownRegions,
        (slack_m, check): (f64, FloorCheck),
        current_step_m: f64,
    ) -> Self {
        let free = problem.vehicle.max_pitch_rad >= std::f64::consts::FRAC_PI_2;
        Self {
            problem,
            regions,
            floor: problem.floor(),
            check,
            slope: if free {
                f64::INFINITY
            } else {
                libm::tan(problem.vehicle.max_pitch_rad)
            },
            margin_m: FLOOR_MARGIN_M + slack_m,
            current_step_m,
        }
    }

    /// The shallower of a depth and the deepest allowed at a place, where the box allows that.
    pub(crate) fn raised(&self, place: Point3<f64>) -> Point3<f64> {
        let Some(floor) = &self.floor else {
            return place;
        };
        let deepest_m = floor.deepest_at(place.x, place.y) - self.margin_m;
        let top_m = self.problem.bounds.map_or(0.0, |bounds| bounds.low.z);
        let z = if deepest_m < top_m {
            place.z
        } else {
            place.z.min(deepest_m)
        };
        Point3::new(place.x, place.y, z)
    }

    /// A piece entered at a place and time.
    pub(crate) fn fly(&self, from: &TimedPoint, to: &Point3<f64>) -> Flown {
        let way = to - from.position;
        let length_m = way.norm();
        if length_m < LEAST_LENGTH_M {
            return Flown {
                seconds: 0.0,
                short_m: 0.0,
                work: 1,
            };
        }
        let mut flown = self.travel(from, &(way / length_m), length_m);
        let rise_m = way.z.abs() - self.slope * libm::hypot(way.x, way.y);
        flown.short_m += rise_m.max(0.0);
        self.add_floor(&from.position, &way, length_m, &mut flown);
        let end = TimedPoint::new(*to, from.time_s + flown.seconds);
        if !self.problem.regions.is_empty() {
            let mut short_m = 0.0;
            flown.work += self.regions.contacts(from, &end, |_, contact| {
                short_m += (-contact.gap_m).max(0.0);
            });
            flown.short_m += short_m;
        }
        flown
    }

    /// The time that a piece takes. Where no way is made it is flown at the least speed, and its length
    /// counts as lacking.
    fn travel(&self, from: &TimedPoint, direction: &Vector3<f64>, length_m: f64) -> Flown {
        let speed_mps = self.problem.vehicle.speed_mps;
        let mut flown = Flown {
            seconds: length_m / speed_mps,
            short_m: 0.0,
            work: 2,
        };
        let Some(field) = self.problem.current else {
            return flown;
        };
        flown.seconds = 0.0;
        let pieces = libm::ceil(length_m / self.current_step_m).max(1.0);
        let piece_m = length_m / pieces;
        let mut ground_mps = speed_mps;
        for k in 0..pieces as usize {
            let middle = from.position + direction * (piece_m * (k as f64 + 0.5));
            let time_s = from.time_s + flown.seconds + 0.5 * piece_m / ground_mps;
            let water = field.velocity_at(&middle, time_s);
            let made = speed_over_ground_mps(speed_mps, direction, &water);
            if made.is_none() {
                flown.short_m += piece_m;
            }
            ground_mps = made.unwrap_or(LEAST_SPEED_SHARE * speed_mps);
            flown.seconds += piece_m / ground_mps;
            flown.work += LOOK_UP;
        }
        flown
    }

    /// Adds by how much a piece lies below the floor.
    fn add_floor(&self, from: &Point3<f64>, way: &Vector3<f64>, length_m: f64, flown: &mut Flown) {
        let Some(floor) = &self.floor else {
            return;
        };
        if self.check == FloorCheck::Proven {
            let lower = Vector3::new(0.0, 0.0, 0.5 * self.margin_m);
            flown.short_m += floor.grounding_m(&(from + lower), &(from + way + lower));
            flown.work += PROOF_LOOK_UPS * LOOK_UP;
            return;
        }
        let samples = libm::ceil(length_m / FLOOR_STEP_M).max(1.0);
        for k in 1..=samples as usize {
            let place = from + way * (k as f64 / samples);
            let low_m = place.z - floor.deepest_at(place.x, place.y) + 0.5 * self.margin_m;
            flown.short_m += low_m.max(0.0);
            flown.work += LOOK_UP;
        }
    }
}
