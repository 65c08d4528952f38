//! The planner: swarm or taut string behind the common trait.

use crate::certify::{Verdict, examine};
use crate::cost::Costing;
use crate::settings::PsoSettings;
use crate::swarm::Swarm;
use crate::taut;
use crate::windows::windows;
use auv_bspline::BSpline;
use auv_planning::{
    NotFlyable, PathPlanner, PathProblem, PlanError, Planned, Run, StopReason, Trajectory,
};
use auv_population::{Workers, search};
use auv_types::Point3;

/// Plans one leg's trajectory among predicted regions.
///
/// # Determinism
/// Equal settings, seed, problem and evaluation budget give equal bits at any number of workers.
#[derive(Clone, Debug, Default)]
pub struct PsoPath {
    settings: PsoSettings,
    workers: Workers,
}

impl PsoPath {
    /// A planner on one thread.
    #[must_use]
    pub fn new(settings: PsoSettings) -> Self {
        Self {
            settings,
            workers: Workers::one(),
        }
    }

    /// The same planner on these threads; several planners may share them.
    #[must_use]
    pub fn with_workers(mut self, workers: Workers) -> Self {
        self.workers = workers;
        self
    }

    /// The settings.
    #[must_use]
    pub fn settings(&self) -> &PsoSettings {
        &self.settings
    }
}

impl PathPlanner for PsoPath {
    fn name(&self) -> &str {
        "pso"
    }

    /// Plans one trajectory.
    ///
    /// With `taut` the result's cost is the duration in seconds and its violation the metres it
    /// falls short; without, both are the paper's: `L / L_ref (1 + beta violation)` and the sum over
    /// regions of the mean relative penetration. Either way a violation of 0 means that the returned
    /// polyline passed the exact check.
    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let mut violations = problem.validate();
        violations.absorb("settings.", self.settings.validate());
        violations.into_result()?;
        if (problem.target - problem.start).norm() <= 1e-9 {
            return Ok(self.stay(run, problem));
        }
        if self.settings.taut {
            self.fly_taut(run, problem)
        } else {
            self.fly_swarm(run, problem)
        }
    }
}

/// A trajectory with its verdict.
struct Examined {
    trajectory: Trajectory,
    verdict: Verdict,
}

impl PsoPath {
    /// The time-optimal planner: a taut string, and a flock of them where it is not alone.
    fn fly_taut(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let Some(found) = taut::plan(run, problem, &self.settings, &self.workers) else {
            // Against a current too strong: the straight line says where.
            self.straight(problem)?;
            return Err(PlanError::Failed {
                planner: self.name().into(),
                reason: "the current is too strong on every way tried".into(),
            });
        };
        let blocked_by = found.verdict.blocked_by(problem);
        let duration_s = found.trajectory.duration_s();
        let mut planned = Planned::new(
            found.trajectory,
            duration_s,
            found.verdict.short_m,
            run.stats(found.reason),
        );
        planned.bound = found.bound_s;
        planned.blocked_by = blocked_by;
        Ok(planned)
    }

    /// The paper's planner: the best curve of a swarm.
    fn fly_swarm(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let settings = &self.settings;
        let costing = Costing::new(problem, settings)?;
        let boxes = windows(settings.windows, problem, settings.control_points - 2);
        let (seed, workers) = (run.seed(), &self.workers);
        let mut swarm = Swarm::new(&costing, settings, &boxes, &problem.start, seed);
        let reason = search(run, workers, &mut swarm);
        let mut chosen: Option<Examined> = None;
        for best in swarm.history.iter().rev() {
            let Ok(examined) = self.curve(problem, &best.position) else {
                continue;
            };
            let clear = examined.verdict.short_m <= 0.0;
            if clear || chosen.is_none() {
                chosen = Some(examined);
            }
            if clear {
                break;
            }
        }
        let examined = match chosen {
            Some(examined) => examined,
            None => self.straight(problem)?,
        };
        Ok(self.report(run, problem, examined, reason))
    }

    /// The exact trajectory of one position of the swarm.
    fn curve(&self, problem: &PathProblem<'_>, position: &[f32]) -> Result<Examined, PlanError> {
        let mut control = vec![problem.start];
        control.extend(position.chunks_exact(3).map(|offset| {
            let at = |k: usize| problem.start[k] + f64::from(offset[k]);
            let point = Point3::new(at(0), at(1), at(2));
            problem.bounds.map_or(point, |bounds| bounds.clamp(&point))
        }));
        control.push(problem.target);
        let curve = BSpline::new(self.settings.order, control)?;
        let points = curve.polyline(Trajectory::CHORD_ERROR_M)?;
        let trajectory = problem.timed(&points).map_err(|e| self.not_flyable(&e))?;
        Ok(examined(problem, trajectory.with_curve(curve)))
    }

    fn straight(&self, problem: &PathProblem<'_>) -> Result<Examined, PlanError> {
        let ends = [problem.start, problem.target];
        let trajectory = problem.timed(&ends).map_err(|e| self.not_flyable(&e))?;
        Ok(examined(problem, trajectory))
    }

    fn not_flyable(&self, error: &NotFlyable) -> PlanError {
        PlanError::Failed {
            planner: self.name().into(),
            reason: error.to_string(),
        }
    }

    /// Start and target agree: there is nothing to fly.
    fn stay(&self, run: &mut Run<'_>, problem: &PathProblem<'_>) -> Planned<Trajectory> {
        run.grant(1);
        let place = auv_obstacles::TimedPoint::new(problem.start, problem.departure_s);
        let examined = examined(problem, Trajectory::hover(place, 0.0));
        self.report(run, problem, examined, StopReason::Optimal)
    }

    /// The paper's cost and violation of a finished trajectory.
    fn report(
        &self,
        run: &Run<'_>,
        problem: &PathProblem<'_>,
        examined: Examined,
        reason: StopReason,
    ) -> Planned<Trajectory> {
        let Examined {
            trajectory,
            verdict,
        } = examined;
        let violation = if verdict.short_m > 0.0 {
            papers_violation(problem, &trajectory, self.settings.samples).max(f64::MIN_POSITIVE)
        } else {
            0.0
        };
        let cost = problem.vehicle.speed_mps * trajectory.duration_s()
            / self.settings.reference_length_m
            * (1.0 + self.settings.penalty * violation);
        let blocked_by = verdict.blocked_by(problem);
        let mut planned = Planned::new(trajectory, cost, violation, run.stats(reason));
        planned.blocked_by = blocked_by;
        planned
    }
}

fn examined(problem: &PathProblem<'_>, trajectory: Trajectory) -> Examined {
    Examined {
        verdict: examine(problem, &trajectory),
        trajectory,
    }
}

/// Sum over regions of the mean of `max(0, 1 - distance / radius)` at `samples` even times, plus
/// the worst shortfall from everything that is no region, as a share of the leg.
fn papers_violation(problem: &PathProblem<'_>, trajectory: &Trajectory, samples: usize) -> f64 {
    let (begin_s, duration_s) = (trajectory.start().time_s, trajectory.duration_s());
    let mut sum = 0.0;
    for j in 0..samples {
        let time_s = begin_s + duration_s * (j as f64 / (samples - 1) as f64);
        let point = auv_obstacles::TimedPoint::new(trajectory.at(time_s).0, time_s);
        for region in problem.regions {
            let short_m = problem.clearance_m - region.distance_m(&point);
            if short_m > 0.0 {
                let radius_m = region.radius_at(time_s) + problem.clearance_m;
                sum += (short_m / radius_m.max(1e-9)).min(1.0);
            }
        }
    }
    let verdict = examine(problem, trajectory);
    let scale_m = trajectory.length_m().max(1.0);
    sum / samples as f64 + verdict.short_m / scale_m * 1e-3
}
