//! From a taut string to a trajectory that the vehicle can fly: corners rounded, depth changed no
//! faster than its pitch allows, the start continued in the direction flown.

use crate::certify::{Verdict, examine};
use crate::laps::{is_too_steep, laps};
use crate::string::Strand;
use crate::work::LOOK_UP;
use auv_planning::polyline::rounded;
use auv_planning::{PathProblem, Score, Trajectory};
use auv_types::{Point3, Vector3, libm};

/// How the trajectory leaves the start: corners before the string begins.
#[derive(Clone, Debug)]
pub(crate) struct Launch {
    /// From the start on, without the point at which the string begins.
    before: Vec<Point3<f64>>,
    /// Where the string begins.
    pub(crate) from: Point3<f64>,
    /// When, seconds.
    pub(crate) departure_s: f64,
}

/// A finished trajectory with the string behind it and what it breaks.
#[derive(Clone, Debug)]
pub(crate) struct Candidate {
    pub(crate) strand: Strand,
    pub(crate) trajectory: Trajectory,
    pub(crate) verdict: Verdict,
}

impl Candidate {
    /// Makes a string flyable and examines it; `None` where the current is too strong.
    pub(crate) fn new(problem: &PathProblem<'_>, launch: &Launch, strand: Strand) -> Option<Self> {
        let mut corners = launch.before.clone();
        corners.extend(strand.points.iter().map(|p| p.position));
        let mut points = rounded(&corners, problem.vehicle.turn_radius_m);
        drop_stubs(&mut points, 0.03 * problem.vehicle.turn_radius_m);
        level(problem, &mut points);
        let trajectory = problem.timed(&points).ok()?;
        let verdict = examine(problem, &trajectory);
        Some(Self {
            strand,
            trajectory,
            verdict,
        })
    }

    /// Units of work that making and examining it took.
    pub(crate) fn work(&self, problem: &PathProblem<'_>) -> u64 {
        let points = self.trajectory.points().len() as u64;
        let look_ups = if problem.sea_bed.is_some() { 16 } else { 4 };
        points * (problem.regions.len() as u64 / 16 + look_ups * LOOK_UP)
    }

    pub(crate) fn is_clear(&self) -> bool {
        self.verdict.short_m <= 0.0
    }

    /// By how many metres it falls short, and how many seconds it takes.
    pub(crate) fn score(&self) -> Score {
        Score::new(self.verdict.short_m, self.trajectory.duration_s())
    }

    pub(crate) fn is_better(&self, other: &Self) -> bool {
        self.score() < other.score()
    }
}

/// Drops inner points closer than `stub_m` to the one before: where one arc ends and the next
/// begins, a stub would count as a tighter turn than either.
fn drop_stubs(points: &mut Vec<Point3<f64>>, stub_m: f64) {
    let last = points.len() - 1;
    let mut kept = 1;
    for i in 1..last {
        let before_m = (points[i] - points[kept - 1]).norm();
        if before_m > stub_m && (points[last] - points[i]).norm() > stub_m {
            points[kept] = points[i];
            kept += 1;
        }
    }
    points[kept] = points[last];
    points.truncate(kept + 1);
}

/// Changes depth no faster than the pitch allows, as close to the string's depths as that permits
/// on the way to the target's depth.
fn level(problem: &PathProblem<'_>, points: &mut [Point3<f64>]) {
    if problem.vehicle.max_pitch_rad >= std::f64::consts::FRAC_PI_2 {
        return;
    }
    let slope = libm::tan(problem.vehicle.max_pitch_rad);
    let across = |a: &Point3<f64>, b: &Point3<f64>| (b.xy() - a.xy()).norm();
    let mut left_m: f64 = points
        .windows(2)
        .map(|pair| across(&pair[0], &pair[1]))
        .sum();
    let last = points.len() - 1;
    let end_z = points[last].z;
    for i in 1..last {
        let step_m = across(&points[i - 1], &points[i]);
        left_m -= step_m;
        let (before_z, reach_m) = (points[i - 1].z, slope * step_m);
        // First what leads to the target, then what can be reached from here.
        let z = points[i]
            .z
            .max(end_z - slope * left_m)
            .min(end_z + slope * left_m);
        points[i].z = z.max(before_z - reach_m).min(before_z + reach_m);
    }
}

impl Launch {
    /// Through corners to where the string begins, `length_m` on.
    pub(crate) fn new(
        problem: &PathProblem<'_>,
        before: Vec<Point3<f64>>,
        from: Point3<f64>,
        length_m: f64,
    ) -> Self {
        Self {
            before,
            from,
            departure_s: problem.departure_s + length_m.max(0.0) / problem.vehicle.speed_mps,
        }
    }

    /// Ways to leave the start, the plainest first: straight off where any direction will do, else
    /// through a corner ahead, wider and wider, else round to either side. Laps come last, first
    /// where the target is too steep for any other.
    pub(crate) fn ways(problem: &PathProblem<'_>) -> Vec<Self> {
        let (level, laps) = (Self::level_ways(problem), laps(problem));
        let ways = if is_too_steep(problem, 1.0) {
            [laps, level]
        } else {
            [level, laps]
        };
        ways.concat()
    }

    fn level_ways(problem: &PathProblem<'_>) -> Vec<Self> {
        let plain = Self {
            before: Vec::new(),
            from: problem.start,
            departure_s: problem.departure_s,
        };
        let radius_m = problem.vehicle.turn_radius_m;
        let Some(velocity) = problem.start_velocity else {
            return vec![plain];
        };
        let line = problem.target - problem.start;
        if radius_m <= 0.0 || velocity.norm() < 1e-6 {
            return vec![plain];
        }
        let ahead = velocity.normalize();
        let turn_rad = libm::acos((ahead.dot(&line) / line.norm()).clamp(-1.0, 1.0));
        let through = |corners: &[Vector3<f64>], cut_m: f64| {
            let mut before = vec![problem.start];
            let mut length_m = -cut_m;
            for corner in corners {
                length_m += corner.norm();
                before.push(before[before.len() - 1] + corner);
            }
            let from = before.pop().unwrap_or(problem.start);
            Self::new(problem, before, from, length_m)
        };
        let saved_m = |angle: f64| radius_m * (2.0 * libm::tan(0.5 * angle) - angle);
        let mut ways = Vec::new();
        for wider_rad in [0.1, 0.5, 1.0] {
            let angle = turn_rad + wider_rad;
            if angle < 2.3 {
                let reach_m = radius_m * (libm::tan(0.5 * angle) + 0.1);
                ways.push(through(&[ahead * reach_m], saved_m(turn_rad.min(2.2))));
            }
        }
        let level = Vector3::new(-ahead.y, ahead.x, 0.0);
        if level.norm() > 1e-6 {
            let side = level.normalize() * (2.3 * radius_m);
            for side in [side, -side] {
                let quarter_m = saved_m(std::f64::consts::FRAC_PI_2);
                let out = ahead * (1.1 * radius_m);
                ways.push(through(&[out, side], quarter_m));
                // Back along the way come, for targets close by on this side.
                ways.push(through(
                    &[out, side, -ahead * (2.1 * radius_m)],
                    2.0 * quarter_m,
                ));
            }
        }
        ways
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_planning::Vehicle;

    #[test]
    fn depth_changes_no_faster_than_the_pitch_allows_and_reaches_the_target() {
        let vehicle = Vehicle::default();
        let slope = libm::tan(vehicle.max_pitch_rad);
        let depths_m = [10.0, 80.0, 80.0, 10.0, 60.0, 60.0];
        let mut points: Vec<_> = (0..6)
            .map(|i| Point3::new(100.0 * i as f64, 0.0, depths_m[i]))
            .collect();
        let problem = PathProblem::new(points[0], points[5], &vehicle);
        level(&problem, &mut points);
        assert_eq!((points[0].z, points[5].z), (10.0, 60.0));
        for pair in points.windows(2) {
            let step = pair[1] - pair[0];
            assert!(step.z.abs() <= slope * step.x * (1.0 + 1e-12));
        }
        assert_eq!(
            points[1].z,
            10.0 + 100.0 * slope,
            "as near as the pitch allows"
        );
        assert_eq!(points[4].z, points[5].z.min(points[3].z + 100.0 * slope));
    }

    #[test]
    fn points_close_to_their_neighbours_are_dropped_but_the_ends_stay() {
        let mut points: Vec<_> = [0.0, 0.4, 5.0, 5.3, 9.8, 10.0]
            .map(|x| Point3::new(x, 0.0, 0.0))
            .to_vec();
        drop_stubs(&mut points, 0.5);
        let kept: Vec<f64> = points.iter().map(|p| p.x).collect();
        assert_eq!(kept, [0.0, 5.0, 10.0]);
    }

    #[test]
    fn a_start_of_any_course_has_one_departure() {
        let still = Vehicle::paper();
        let problem = PathProblem::new(Point3::origin(), Point3::new(900.0, 0.0, 0.0), &still);
        let ways = Launch::ways(&problem);
        assert_eq!(ways.len(), 1);
        assert_eq!((ways[0].from, ways[0].departure_s), (problem.start, 0.0));
    }

    #[test]
    fn departures_go_on_in_the_direction_flown() {
        let vehicle = Vehicle::default();
        for heading in [0.0, 1.0, 2.0, 3.0] {
            let ahead = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0);
            let problem = PathProblem {
                start_velocity: Some(ahead * 1.5),
                departure_s: 60.0,
                ..PathProblem::new(Point3::origin(), Point3::new(900.0, 0.0, 0.0), &vehicle)
            };
            let ways = Launch::ways(&problem);
            // Both sides, each with and without a stretch back, and the corners ahead that are not
            // too sharp.
            let corners = [0.1, 0.5, 1.0]
                .iter()
                .filter(|&&wider| heading + wider < 2.3);
            assert_eq!(ways.len(), 4 + corners.count());
            for way in &ways {
                let second = way.before.get(1).unwrap_or(&way.from);
                assert!((second.coords.normalize() - ahead).norm() < 1e-9);
                assert!(way.departure_s > 60.0);
            }
        }
    }
}
