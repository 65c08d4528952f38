//! The way on from the end of a trajectory: whether the vehicle has a safe end in hand.

use crate::closed_loop::{LEVEL_M, last_loop};
use crate::obstacles::closest_approach;
use crate::path::{DISTANCE_TOLERANCE_M, END_TOLERANCE_M, TIME_TOLERANCE_S, verify_motion};
use crate::way_on_report::{EndState, KeptEnd, WayOnReport, WayOnViolation};
use crate::{PathReport, PathViolation};
use auv_obstacles::{Region, TimedPoint};
use auv_planning::{PathProblem, Trajectory};

/// How far below the surface, or the top of the box, a vehicle that drifts may be, metres.
const AT_SURFACE_M: f64 = 0.01;

/// What is asked of a way on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WayOn {
    /// When what the trajectory is followed for ends and the way on starts, mission time in seconds.
    pub ends_s: f64,
    /// How long the way on must last, seconds.
    pub lasts_s: f64,
    /// The state in which it must end.
    pub end: EndState,
}

/// Checks a whole trajectory: what it is followed for, and the way on from there.
///
/// - The vehicle can fly all of it: speed, turns, pitch, box and bed, as [`verify_motion`] checks them.
/// - From `ends_s` on for `lasts_s` it keeps the problem's clearance from all regions; after that from the
///   permanent ones, which hold for ever ([`Region::is_permanent`]). Clearance before `ends_s` is the
///   business of [`verify_trajectory`](crate::verify_trajectory).
/// - It lasts for `lasts_s` after `ends_s`, and ends in a state that can be kept: see [`EndState`].
///
/// A vehicle that can hover, and is to go on under way, rests where the trajectory ends before that time;
/// the rest is checked as a part of the trajectory. A closed loop is checked once: a current or a region that
/// changes after `lasts_s` is not.
///
/// ```
/// use auv_planning::{PathProblem, Vehicle};
/// use auv_types::Point3;
/// use auv_verify::{EndState, WayOn, WayOnViolation, verify_way_on};
///
/// let (start, target) = (Point3::new(0.0, 0.0, 20.0), Point3::new(300.0, 0.0, 20.0));
/// let hovers = Vehicle { min_speed_mps: 0.0, ..Vehicle::default() };
/// for (vehicle, safe) in [(hovers, true), (Vehicle::default(), false)] {
///     let problem = PathProblem::new(start, target, &vehicle);
///     let path = problem.timed(&[start, target])?;
///     let asked = WayOn { ends_s: path.end().time_s, lasts_s: 120.0, end: EndState::UnderWay };
///     let report = verify_way_on(&problem, &path, &asked);
///     assert_eq!(report.is_valid(), safe);
///     let too_short = WayOnViolation::TooShort { lasts_s: 0.0, required_s: 120.0 };
///     assert_eq!(report.violations.contains(&too_short), !safe);
/// }
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
///
/// Complexity: that of [`verify_trajectory`](crate::verify_trajectory).
#[must_use]
pub fn verify_way_on(problem: &PathProblem<'_>, whole: &Trajectory, asked: &WayOn) -> WayOnReport {
    let (start_s, end_s) = (whole.start().time_s, whole.end().time_s);
    let until_s = asked.ends_s + asked.lasts_s;
    let rests = asked.end == EndState::UnderWay && problem.vehicle.can_hover();
    let extended = rests.then(|| resting(whole, until_s));
    let whole = extended.as_ref().unwrap_or(whole);
    let open = PathProblem {
        regions: &[],
        ..*problem
    };
    let mut report = WayOnReport {
        path: verify_motion(&open, whole),
        lasts_s: whole.end().time_s - asked.ends_s,
        kept: None,
        violations: Vec::new(),
    };
    let is_within =
        asked.ends_s >= start_s - TIME_TOLERANCE_S && asked.ends_s <= end_s + TIME_TOLERANCE_S;
    if !is_within || !(asked.lasts_s >= 0.0) {
        report.violations.push(WayOnViolation::NotWithin {
            ends_s: asked.ends_s,
            start_s,
            end_s,
        });
    } else {
        let way = whole.after(asked.ends_s);
        // Where nothing is flown, as at the dock, the path to there has kept its clearance.
        if way.duration_s() > 0.0 {
            check_clearance(problem, &way, until_s, &mut report);
        }
        match kept_end(problem, way.points(), asked.end) {
            Ok(kept) => report.kept = Some(kept),
            Err(violation) => report.violations.push(violation),
        }
        let goes_on = asked.end == EndState::UnderWay;
        if goes_on && !(report.lasts_s >= asked.lasts_s - TIME_TOLERANCE_S) {
            report.violations.push(WayOnViolation::TooShort {
                lasts_s: report.lasts_s,
                required_s: asked.lasts_s,
            });
        }
    }
    let flown = report.path.violations.iter().copied();
    report.violations.extend(flown.map(WayOnViolation::Path));
    report
}

/// The trajectory with a rest at its end until a time; as it is where it ends later, or the time is not finite.
fn resting(whole: &Trajectory, until_s: f64) -> Trajectory {
    let mut points = whole.points().to_vec();
    points.push(TimedPoint::new(whole.end().position, until_s));
    Trajectory::new(points).unwrap_or_else(|_| whole.clone())
}

/// Checks the way on against all regions until a time, and against the permanent ones after it.
fn check_clearance(
    problem: &PathProblem<'_>,
    way: &Trajectory,
    until_s: f64,
    report: &mut WayOnReport,
) {
    let charted = |region: &&Region| region.is_permanent();
    let (asked, later) = (way.until(until_s), way.after(until_s));
    see_regions(problem, &asked, problem.regions, &mut report.path);
    if way.end().time_s > until_s {
        let permanent: Vec<Region> = problem.regions.iter().filter(charted).copied().collect();
        see_regions(problem, &later, &permanent, &mut report.path);
    }
}

fn see_regions(
    problem: &PathProblem<'_>,
    part: &Trajectory,
    regions: &[Region],
    path: &mut PathReport,
) {
    let required_m = problem.clearance_m - DISTANCE_TOLERANCE_M;
    let violations = &mut path.violations;
    let nearest = closest_approach(part.points(), regions, required_m, |approach| {
        violations.push(PathViolation::TooClose {
            approach,
            required_m: problem.clearance_m,
        });
    });
    let is_nearer = |new_m: f64| path.closest.is_none_or(|old| new_m < old.clearance_m);
    if nearest.is_some_and(|new| is_nearer(new.clearance_m)) {
        path.closest = nearest;
    }
}

/// How the end of a way on can be kept.
fn kept_end(
    problem: &PathProblem<'_>,
    way: &[TimedPoint],
    asked: EndState,
) -> Result<KeptEnd, WayOnViolation> {
    let end = way[way.len() - 1].position;
    match asked {
        EndState::Docked => {
            let distance_m = (end - problem.target).norm();
            if distance_m <= END_TOLERANCE_M {
                Ok(KeptEnd::Docked)
            } else {
                Err(WayOnViolation::NotDocked { distance_m })
            }
        }
        EndState::Drifting => {
            let top_m = problem.bounds.map_or(0.0, |bounds| bounds.low.z.max(0.0));
            let depth_m = end.z - top_m;
            if depth_m <= AT_SURFACE_M {
                Ok(KeptEnd::Drifting)
            } else {
                Err(WayOnViolation::NotAtSurface { depth_m })
            }
        }
        EndState::UnderWay if problem.vehicle.can_hover() => Ok(KeptEnd::Resting),
        EndState::UnderWay => match last_loop(way, problem.vehicle) {
            Err(nearest_m) => Err(WayOnViolation::NotClosed { nearest_m }),
            Ok(found) if found.height_m > LEVEL_M => Err(WayOnViolation::NotLevel {
                height_m: found.height_m,
            }),
            Ok(found) => Ok(KeptEnd::Circling {
                from_s: found.from_s,
                period_s: found.period_s,
            }),
        },
    }
}
