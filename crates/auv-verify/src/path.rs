//! A trajectory against everything its problem asks for.

use crate::altitude::AltitudeCheck;
use crate::motion::{Turns, pitch_rad, speed_rounding_mps, water_speeds};
use crate::obstacles::closest_approach;
use crate::path_report::{PathReport, PathViolation, Worst};
use auv_obstacles::TimedPoint;
use auv_planning::{PathProblem, Trajectory, Vehicle};
use auv_types::{Point3, Vector3};

/// How far start and end may be off, metres.
pub(crate) const END_TOLERANCE_M: f64 = 1e-3;
/// How far the departure may be off, seconds.
pub(crate) const TIME_TOLERANCE_S: f64 = 1e-6;
/// How much of a speed limit may be exceeded.
const SPEED_TOLERANCE: f64 = 1e-4;
/// Share of the least turn radius that a vertex must reach.
const RADIUS_SHARE: f64 = 0.99;
/// How much the pitch limit may be exceeded, radians.
const PITCH_TOLERANCE_RAD: f64 = 1e-4;
/// How far rounding may lead out of the box or into a clearance, metres.
pub(crate) const DISTANCE_TOLERANCE_M: f64 = 1e-6;

/// Where and how a trajectory must start and end; `None` leaves it free.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RequiredEnds {
    /// Where and when it starts.
    pub start: Option<TimedPoint>,
    /// Ground velocity that it continues within the turn radius, m/s.
    pub start_velocity: Option<Vector3<f64>>,
    /// Where it ends, metres.
    pub target: Option<Point3<f64>>,
}

impl RequiredEnds {
    /// As the problem states.
    #[must_use]
    pub fn of(problem: &PathProblem<'_>) -> Self {
        Self {
            start: Some(TimedPoint::new(problem.start, problem.departure_s)),
            start_velocity: problem.start_velocity,
            target: Some(problem.target),
        }
    }

    /// All free: for the rest of a trajectory under way.
    #[must_use]
    pub fn free() -> Self {
        Self::default()
    }
}

/// Checks a trajectory against the problem it was planned for.
///
/// The problem itself is taken to be valid ([`PathProblem::validate`]). The check is exact except
/// for changes of the current and of the standard deviation of the bed's depth between samples.
///
/// Complexity: O(segments x regions) at worst. A region out of reach or time costs O(1); eight
/// segments out of a region's reach cost as much as one.
#[must_use]
pub fn verify_trajectory(problem: &PathProblem<'_>, trajectory: &Trajectory) -> PathReport {
    verify_part(problem, &RequiredEnds::of(problem), trajectory)
}

/// Checks a trajectory wherever and whenever it starts and ends: [`verify_part`] with free ends.
#[must_use]
pub fn verify_motion(problem: &PathProblem<'_>, trajectory: &Trajectory) -> PathReport {
    verify_part(problem, &RequiredEnds::free(), trajectory)
}

/// Checks any trajectory, for instance one followed by a task's stay or the rest of one, against the
/// constraints of a problem, with the given ends instead of the problem's own.
///
/// With a free start the first segment may be the rest of a longer one, so the turn after it is
/// judged by the second segment alone.
#[must_use]
pub fn verify_part(
    problem: &PathProblem<'_>,
    ends: &RequiredEnds,
    trajectory: &Trajectory,
) -> PathReport {
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

/// The first point that is not finite, or where time runs back or stands still while the place
/// changes.
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

fn check_ends(ends: &RequiredEnds, points: &[TimedPoint], report: &mut PathReport) {
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
    ends: &RequiredEnds,
    points: &[TimedPoint],
    report: &mut PathReport,
) {
    let is_cut = ends.start.is_none();
    let mut turns = Turns::new(points[0], ends.start_velocity);
    let mut worst = WorstSegments::new();
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
        worst.slow.see(least_mps + rounding_mps, i);
        worst.fast.see(most_mps - rounding_mps, i);
        if let Some(radius_m) = turns.go_to(to, is_cut) {
            report.min_turn_radius_m = report.min_turn_radius_m.min(radius_m);
            worst.tight.see(radius_m, i);
        }
        let pitch_rad = pitch_rad(from, to);
        report.max_pitch_rad = report.max_pitch_rad.max(pitch_rad);
        worst.steep.see(pitch_rad, i);
    }
    report.violations.extend(worst.beyond(problem.vehicle));
}

/// The slowest, fastest and steepest segments and the tightest turn.
struct WorstSegments {
    slow: Worst,
    fast: Worst,
    tight: Worst,
    steep: Worst,
}

impl WorstSegments {
    fn new() -> Self {
        Self {
            slow: Worst::least(),
            fast: Worst::greatest(),
            tight: Worst::least(),
            steep: Worst::greatest(),
        }
    }

    /// Those beyond the vehicle's limits.
    fn beyond(&self, vehicle: &Vehicle) -> impl Iterator<Item = PathViolation> {
        let Vehicle {
            min_speed_mps,
            max_speed_mps,
            turn_radius_m,
            max_pitch_rad,
            ..
        } = *vehicle;
        let slow = self.slow.beyond(min_speed_mps * (1.0 - SPEED_TOLERANCE));
        let fast = self.fast.beyond(max_speed_mps * (1.0 + SPEED_TOLERANCE));
        let tight = self.tight.beyond(turn_radius_m * RADIUS_SHARE);
        let steep = self.steep.beyond(max_pitch_rad + PITCH_TOLERANCE_RAD);
        let violations = [
            slow.map(|(segment, speed_mps)| PathViolation::TooSlow {
                segment,
                speed_mps,
                limit_mps: min_speed_mps,
            }),
            fast.map(|(segment, speed_mps)| PathViolation::TooFast {
                segment,
                speed_mps,
                limit_mps: max_speed_mps,
            }),
            tight.map(|(point, radius_m)| PathViolation::TurnsTooTight {
                point,
                radius_m,
                limit_m: turn_radius_m,
            }),
            steep.map(|(segment, pitch_rad)| PathViolation::TooSteep {
                segment,
                pitch_rad,
                limit_rad: max_pitch_rad,
            }),
        ];
        violations.into_iter().flatten()
    }
}

/// A box is convex, so checking the points checks the segments between them.
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
    let mut altitude = AltitudeCheck::new();
    for point in [points[0], points[points.len() - 1]] {
        altitude.check(problem, &point, &point);
    }
    for pair in points.windows(2) {
        altitude.check(problem, &pair[0], &pair[1]);
    }
    report.min_altitude_m = altitude.least_m;
    if let Some(low) = altitude.lowest {
        report.violations.push(PathViolation::TooLow {
            place: low.place,
            time_s: low.time_s,
            altitude_m: low.altitude_m,
            required_m: low.required_m,
        });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn malformed_points_are_named() {
        let at = |x: f64, time_s: f64| TimedPoint::new(Point3::new(x, 0.0, 5.0), time_s);
        assert_eq!(malformed(&[]), Some(PathViolation::Empty));
        let good = [at(0.0, 0.0), at(9.0, 6.0), at(9.0, 6.0), at(9.0, 9.0)];
        assert_eq!(malformed(&good), None);
        for point in 0..good.len() {
            for spoilt in [at(f64::NAN, 0.0), at(0.0, f64::INFINITY)] {
                let mut points = good;
                points[point] = spoilt;
                let named = PathViolation::NotFinite { point };
                assert_eq!(malformed(&points), Some(named));
            }
        }
        // It moves in no time, or back in time; at once or after a while.
        let stands = |points: &[TimedPoint]| malformed(points).map(|v| v.to_string());
        let named = |point: usize| Some(PathViolation::TimeStands { point }.to_string());
        assert_eq!(stands(&[at(0.0, 5.0), at(1.0, 5.0)]), named(1));
        assert_eq!(stands(&[at(0.0, 5.0), at(0.0, 4.0)]), named(1));
        assert_eq!(
            stands(&[good[0], good[1], good[2], at(10.0, 6.0)]),
            named(3)
        );
    }
}
