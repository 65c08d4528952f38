//! From a problem to the swarm's answer: the best exactly clear curve that it found.

use crate::error::not_flyable;
use crate::examine::{Examined, straight};
use crate::swarm::cost::Costing;
use crate::swarm::particles::Swarm;
use crate::swarm::settings::SwarmSettings;
use crate::swarm::windows::windows;
use auv_bspline::BSpline;
use auv_obstacles::TimedPoint;
use auv_planning::{PathProblem, PlanError, Planned, Run, StopReason, Trajectory};
use auv_population::{Workers, search};
use auv_types::Point3;

/// Plans one leg.
///
/// The swarm costs samples of a curve. Its best curves are examined exactly, the last one first; the
/// first that is clear is the answer. Without a clear one the answer is the swarm's last best, or
/// the straight line where the current stops every curve.
pub(crate) fn plan(
    run: &mut Run<'_>,
    problem: &PathProblem<'_>,
    settings: &SwarmSettings,
    workers: &Workers,
) -> Result<Planned<Trajectory>, PlanError> {
    let costing = Costing::new(problem, settings)?;
    let boxes = windows(settings.windows, problem, settings.control_points - 2);
    let mut swarm = Swarm::new(&costing, settings, &boxes, &problem.start, run.seed());
    let reason = search(run, workers, &mut swarm);
    let mut chosen: Option<Examined> = None;
    for best in swarm.history.iter().rev() {
        let Ok(examined) = curve(problem, settings, &best.position) else {
            continue;
        };
        let clear = examined.is_clear();
        if clear || chosen.is_none() {
            chosen = Some(examined);
        }
        if clear {
            break;
        }
    }
    let examined = match chosen {
        Some(examined) => examined,
        None => straight(problem)?,
    };
    Ok(answer(run, problem, settings, examined, reason))
}

/// The exact trajectory of one position of the swarm.
fn curve(
    problem: &PathProblem<'_>,
    settings: &SwarmSettings,
    position: &[f32],
) -> Result<Examined, PlanError> {
    let mut control = vec![problem.start];
    control.extend(position.chunks_exact(3).map(|offset| {
        let at = |k: usize| problem.start[k] + f64::from(offset[k]);
        let point = Point3::new(at(0), at(1), at(2));
        problem.bounds.map_or(point, |bounds| bounds.clamp(&point))
    }));
    control.push(problem.target);
    let curve = BSpline::new(settings.order, control)?;
    let points = curve.polyline(Trajectory::CHORD_ERROR_M)?;
    let trajectory = problem.timed(&points).map_err(not_flyable)?;
    Ok(Examined::new(problem, trajectory.with_curve(curve)))
}

/// The answer with the paper's cost, `L / L_ref (1 + beta penetration)`.
fn answer(
    run: &Run<'_>,
    problem: &PathProblem<'_>,
    settings: &SwarmSettings,
    examined: Examined,
    reason: StopReason,
) -> Planned<Trajectory> {
    let penetration = if examined.is_clear() {
        0.0
    } else {
        penetration(problem, &examined, settings.samples)
    };
    let length_m = problem.vehicle.speed_mps * examined.trajectory.duration_s();
    let cost = length_m / settings.reference_length_m * (1.0 + settings.penalty * penetration);
    examined.planned(problem, cost, run.stats(reason))
}

/// Weight of the worst exact shortfall beside the mean penetrations. It is small: it only ranks what
/// penetrates no region.
const OTHER_SHORTFALL_WEIGHT: f64 = 1e-3;
/// Least radius that a penetration is divided by, metres.
const LEAST_RADIUS_M: f64 = 1e-9;

/// The paper's violation, which its cost is penalised with: the sum over regions of the mean of `max(0, 1 - distance / radius)` at `samples` equally spaced
/// times (Eq. 18), plus a small share of the worst exact shortfall over the length.
fn penetration(problem: &PathProblem<'_>, examined: &Examined, samples: usize) -> f64 {
    let trajectory = &examined.trajectory;
    let (start_s, duration_s) = (trajectory.start().time_s, trajectory.duration_s());
    let mut sum = 0.0;
    for j in 0..samples {
        let time_s = start_s + duration_s * (j as f64 / (samples - 1) as f64);
        let point = TimedPoint::new(trajectory.at(time_s).0, time_s);
        for region in problem.regions {
            let short_m = problem.clearance_m - region.distance_m(&point);
            if short_m > 0.0 {
                let radius_m = region.radius_at(time_s) + problem.clearance_m;
                sum += (short_m / radius_m.max(LEAST_RADIUS_M)).min(1.0);
            }
        }
    }
    let scale_m = trajectory.length_m().max(1.0);
    sum / samples as f64 + examined.shortfall.metres / scale_m * OTHER_SHORTFALL_WEIGHT
}
