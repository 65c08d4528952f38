//! A trajectory against everything its problem asks for.

use crate::altitude::Altitude;
use crate::motion::{Turns, pitch_rad, speed_rounding_mps, water_speeds};
use crate::obstacles::closest_approach;
use crate::path_report::{PathReport, PathViolation, Worst};
use auv_obstacles::TimedPoint;
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Point3, Vector3};

/// How far begin and end may be off, metres.
const END_TOLERANCE_M: f64 = 1e-3;
/// How far the departure may be off, seconds.
const TIME_TOLERANCE_S: f64 = 1e-6;
/// How much of a speed limit may be exceeded.
const SPEED_TOLERANCE: f64 = 1e-4;
/// Share of the least turn radius that a vertex must reach.
const RADIUS_SHARE: f64 = 0.99;
/// How much the pitch limit may be exceeded, radians.
const PITCH_TOLERANCE_RAD: f64 = 1e-4;
/// How far out of the box, or into a clearance, rounding may lead, metres.
const DISTANCE_TOLERANCE_M: f64 = 1e-6;

/// Which ends a trajectory must have; what is `None` is free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Ends {
    /// Where and when it begins.
    pub start: Option<TimedPoint>,
    /// Ground velocity that it continues within the turn radius, m/s.
    pub start_velocity: Option<Vector3<f64>>,
    /// Where it ends, metres.
    pub target: Option<Point3<f64>>,
}

impl Ends {
    /// All ends as the problem states them.
    #[must_use]
    pub fn of(problem: &PathProblem<'_>) -> Self {
        Self {
            start: Some(TimedPoint::new(problem.start, problem.departure_s)),
            start_velocity: problem.start_velocity,
            target: Some(problem.target),
        }
    }

    /// No ends prescribed: for what is left of a trajectory under way.
    #[must_use]
    pub fn free() -> Self {
        Self::default()
    }
}

/// Checks a trajectory against the problem it was planned for.
///
/// The problem itself is taken to be valid ([`PathProblem::validate`]). Exact but for what the
/// current and the spread of the bed's depth do between the places looked at.
///
/// Complexity: O(segments x regions) at worst; regions out of reach or time cost O(1), and parts of
/// eight segments out of a region's reach cost as much as one.
#[must_use]
pub fn verify_trajectory(problem: &PathProblem<'_>, trajectory: &Trajectory) -> PathReport {
    verify_part(problem, &Ends::of(problem), trajectory)
}

/// Checks a trajectory wherever and whenever it begins and ends: [`verify_part`] with free ends.
#[must_use]
pub fn verify_motion(problem: &PathProblem<'_>, trajectory: &Trajectory) -> PathReport {
    verify_part(problem, &Ends::free(), trajectory)
}

/// Checks any trajectory, for instance one with a task's stay appended or what is left of one,
/// against the constraints of a problem and the ends given instead of the problem's own.
///
/// With a free start the first segment may be the rest of a longer one: the turn after it is judged
/// by the second segment alone.
#[must_use]
pub fn verify_part(problem: &PathProblem<'_>, ends: &Ends, trajectory: &Trajectory) -> PathReport {
    let points = trajectory.points();
    let mut report = PathReport::default();
    if let Some(malformed) = malformed(points) {
        report.violations.push(malformed);
        return report;
    }
    check_ends(ends, points, &mut report);
    check_segments(problem, ends, points, &mut report);
    check_box(problem, points, &mut report);
    check_sea_bed(problem, points, &mut report);
    let required_m = problem.clearance_m - DISTANCE_TOLERANCE_M;
    let violations = &mut report.violations;
    report.closest = closest_approach(points, problem.regions, required_m, |approach| {
        violations.push(PathViolation::TooClose {
            approach,
            required_m: problem.clearance_m,
        });
    });
    report
}

/// A point that is not finite, time that runs back or stands still while the place changes.
fn malformed(points: &[TimedPoint]) -> Option<PathViolation> {
    if points.is_empty() {
        return Some(PathViolation::Empty);
    }
    let is_finite =
        |p: &TimedPoint| p.time_s.is_finite() && p.position.iter().all(|x| x.is_finite());
    if let Some(point) = points.iter().position(|p| !is_finite(p)) {
        return Some(PathViolation::NotFinite { point });
    }
    let advances = |pair: &[TimedPoint]| pair[1].time_s > pair[0].time_s || pair[1] == pair[0];
    let stuck = points.windows(2).position(|pair| !advances(pair))?;
    Some(PathViolation::TimeStands { point: stuck + 1 })
}

fn check_ends(ends: &Ends, points: &[TimedPoint], report: &mut PathReport) {
    let (first, last) = (points[0], points[points.len() - 1]);
    report.duration_s = last.time_s - first.time_s;
    if let Some(start) = ends.start {
        let distance_m = (first.position - start.position).norm();
        if !(distance_m <= END_TOLERANCE_M) {
            report
                .violations
                .push(PathViolation::WrongStart { distance_m });
        }
        if !((first.time_s - start.time_s).abs() <= TIME_TOLERANCE_S) {
            report.violations.push(PathViolation::WrongDeparture {
                time_s: first.time_s,
                expected_s: start.time_s,
            });
        }
    }
    if let Some(target) = ends.target {
        let distance_m = (last.position - target).norm();
        if !(distance_m <= END_TOLERANCE_M) {
            report
                .violations
                .push(PathViolation::WrongTarget { distance_m });
        }
    }
}

fn check_segments(
    problem: &PathProblem<'_>,
    ends: &Ends,
    points: &[TimedPoint],
    report: &mut PathReport,
) {
    let is_cut = ends.start.is_none();
    let mut turns = Turns::new(points[0], ends.start_velocity);
    let (mut slow, mut fast, mut tight, mut steep) = (
        Worst::least(),
        Worst::greatest(),
        Worst::least(),
        Worst::greatest(),
    );
    for (i, pair) in points.windows(2).enumerate() {
        let (from, to) = (&pair[0], &pair[1]);
        let elapsed_s = to.time_s - from.time_s;
        if elapsed_s <= 0.0 {
            continue;
        }
        let length_m = (to.position - from.position).norm();
        report.length_m += length_m;
        let (least_mps, most_mps) = water_speeds(problem, from, to);
        let rounding_mps = speed_rounding_mps(elapsed_s);
        report.min_speed_mps = report.min_speed_mps.min(least_mps);
        report.max_speed_mps = report.max_speed_mps.max(most_mps);
        slow.see(least_mps + rounding_mps, i);
        fast.see(most_mps - rounding_mps, i);
        if let Some(radius_m) = turns.go_to(to, is_cut) {
            report.min_turn_radius_m = report.min_turn_radius_m.min(radius_m);
            tight.see(radius_m, i);
        }
        if length_m > 0.0 {
            let pitch_rad = pitch_rad(from, to);
            report.max_pitch_rad = report.max_pitch_rad.max(pitch_rad);
            steep.see(pitch_rad, i);
        }
    }
    let vehicle = problem.vehicle;
    if let Some((segment, speed_mps)) = slow.beyond(vehicle.min_speed_mps * (1.0 - SPEED_TOLERANCE))
    {
        report.violations.push(PathViolation::TooSlow {
            segment,
            speed_mps,
            limit_mps: vehicle.min_speed_mps,
        });
    }
    if let Some((segment, speed_mps)) = fast.beyond(vehicle.max_speed_mps * (1.0 + SPEED_TOLERANCE))
    {
        report.violations.push(PathViolation::TooFast {
            segment,
            speed_mps,
            limit_mps: vehicle.max_speed_mps,
        });
    }
    if let Some((point, radius_m)) = tight.beyond(vehicle.turn_radius_m * RADIUS_SHARE) {
        report.violations.push(PathViolation::TurnsTooTight {
            point,
            radius_m,
            limit_m: vehicle.turn_radius_m,
        });
    }
    if let Some((segment, pitch_rad)) = steep.beyond(vehicle.max_pitch_rad + PITCH_TOLERANCE_RAD) {
        report.violations.push(PathViolation::TooSteep {
            segment,
            pitch_rad,
            limit_rad: vehicle.max_pitch_rad,
        });
    }
}

/// A box is convex: the points decide for the segments between them.
fn check_box(problem: &PathProblem<'_>, points: &[TimedPoint], report: &mut PathReport) {
    let Some(bounds) = &problem.bounds else {
        return;
    };
    let mut outside = Worst::greatest();
    for (i, point) in points.iter().enumerate() {
        let excess = |k: usize| {
            let x = point.position[k];
            (bounds.low[k] - x).max(x - bounds.high[k])
        };
        outside.see(excess(0).max(excess(1)).max(excess(2)), i);
    }
    if let Some((point, excess_m)) = outside.beyond(DISTANCE_TOLERANCE_M) {
        report
            .violations
            .push(PathViolation::OutsideBox { point, excess_m });
    }
}

fn check_sea_bed(problem: &PathProblem<'_>, points: &[TimedPoint], report: &mut PathReport) {
    if problem.sea_bed.is_none() {
        return;
    }
    let mut altitude = Altitude::unknown();
    for point in [points[0], points[points.len() - 1]] {
        altitude.look_at(problem, &point, &point);
    }
    for pair in points.windows(2) {
        altitude.look_at(problem, &pair[0], &pair[1]);
    }
    report.min_altitude_m = altitude.least_m;
    if let Some(low) = altitude.low {
        report.violations.push(PathViolation::TooLow {
            place: low.place,
            time_s: low.time_s,
            altitude_m: low.altitude_m,
            required_m: low.required_m,
        });
    }
}
