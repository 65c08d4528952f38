//! The planner behind the common trait.

use crate::error::{NAME, failed};
use crate::examine::{Examined, straight};
use crate::path_search::PathSearch;
use crate::swarm;
use crate::taut::{self, TautSettings};
use auv_obstacles::TimedPoint;
use auv_planning::{PathPlanner, PathProblem, PlanError, Planned, Run, StopReason, Trajectory};
use auv_population::Workers;

/// Start and target closer than this are one place, metres.
const SAME_PLACE_M: f64 = 1e-9;

/// Plans one leg's trajectory among predicted regions.
///
/// # Determinism
/// Equal settings, seed, problem and evaluation budget give equal bits at any number of workers.
#[derive(Clone, Debug, Default)]
pub struct PsoPath {
    search: PathSearch,
    workers: Workers,
}

impl PsoPath {
    /// A planner on one thread.
    #[must_use]
    pub fn new(search: PathSearch) -> Self {
        Self {
            search,
            workers: Workers::one(),
        }
    }

    /// The same planner on these threads; several planners may share them.
    #[must_use]
    pub fn with_workers(mut self, workers: Workers) -> Self {
        self.workers = workers;
        self
    }

    /// The search and its settings.
    #[must_use]
    pub fn search(&self) -> &PathSearch {
        &self.search
    }
}

impl PathPlanner for PsoPath {
    fn name(&self) -> &str {
        NAME
    }

    /// Plans one trajectory.
    ///
    /// The taut string's cost is the duration in seconds, the swarm's is the paper's:
    /// `L / L_ref (1 + beta penetration)`. The violation of every answer is the metres by which the
    /// trajectory falls short; 0 means that the returned polyline passed the exact check.
    ///
    /// While the swarm runs, its generations report the paper's relative violation of the sampled
    /// curves, which its cost is penalised with.
    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let mut violations = problem.validate();
        violations.absorb("settings.", self.search.validate());
        violations.into_result()?;
        if (problem.target - problem.start).norm() <= SAME_PLACE_M {
            return Ok(self.stay(run, problem));
        }
        match &self.search {
            PathSearch::Swarm(settings) => swarm::plan(run, problem, settings, &self.workers),
            PathSearch::TautString(settings) => self.tighten(run, problem, settings),
        }
    }
}

impl PsoPath {
    fn tighten(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
        settings: &TautSettings,
    ) -> Result<Planned<Trajectory>, PlanError> {
        if let Some(planned) = taut::plan(run, problem, settings, &self.workers) {
            return Ok(planned);
        }
        // The straight line says where the current is too strong.
        straight(problem)?;
        let reason = "the current is too strong on every path tried";
        Err(failed(reason.into()))
    }

    /// Start and target are one place: there is nothing to fly, and only one answer.
    fn stay(&self, run: &mut Run<'_>, problem: &PathProblem<'_>) -> Planned<Trajectory> {
        run.grant(1);
        let place = TimedPoint::new(problem.start, problem.departure_s);
        let hover = Examined::new(problem, Trajectory::hover(place, 0.0));
        let reason = if hover.is_clear() {
            StopReason::Optimal
        } else {
            StopReason::Finished
        };
        hover.planned(problem, 0.0, run.stats(reason))
    }
}
