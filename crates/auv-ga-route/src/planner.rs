//! The planner: which algorithm runs, and what it is worth.

use crate::evolution::Evolution;
use crate::memetic::{Goal, Memetic};
use crate::{EvolutionSettings, GaSettings};
use auv_graph::Route;
use auv_planning::{PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason};
use auv_population::route::{Candidate, Legs, answer, standard};
use auv_population::{Workers, search};

/// Plans routes by a genetic algorithm.
#[derive(Clone, Debug, Default)]
pub struct GaRoute {
    settings: GaSettings,
    workers: Workers,
}

impl GaRoute {
    /// A planner on the calling thread alone.
    #[must_use]
    pub fn new(settings: GaSettings) -> Self {
        Self {
            settings,
            workers: Workers::one(),
        }
    }

    /// Computes on `workers`; the answer stays the same.
    #[must_use]
    pub fn with_workers(mut self, workers: Workers) -> Self {
        self.workers = workers;
        self
    }
}

impl RoutePlanner for GaRoute {
    fn name(&self) -> &str {
        "ga"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        self.settings.validate().into_result()?;
        let known = standard(problem)?;
        if known.settled {
            run.end_generation((known.best.cost, known.best.violation), &[], &[]);
            let route = known.best.route();
            let stats = run.stats(StopReason::Optimal);
            return Ok(answer(problem, known.best, route, stats));
        }
        let threads = self.workers.threads();
        let goal = Goal::new(problem);
        let stand_in = EvolutionSettings::paper();
        match (&self.settings, goal) {
            (GaSettings::Memetic(settings), Some(goal)) => {
                let best = &known.best;
                let mut memetic =
                    Memetic::new(settings, goal, problem, &known.home, run, best, threads);
                let stop = search(run, &self.workers, &mut memetic);
                Ok(answer(
                    problem,
                    known.best,
                    memetic.finish(),
                    run.stats(stop),
                ))
            }
            (GaSettings::Evolution(settings), _) => self.evolve(settings, run, problem, known.best),
            (GaSettings::Memetic(_), None) => self.evolve(&stand_in, run, problem, known.best),
        }
    }
}

impl GaRoute {
    fn evolve(
        &self,
        settings: &EvolutionSettings,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
        known: Candidate,
    ) -> Result<Planned<Route>, PlanError> {
        let legs = Legs::new(problem);
        let threads = self.workers.threads();
        let mut evolution = Evolution::new(settings, &legs, run.seed(), &known, threads);
        let stop = search(run, &self.workers, &mut evolution);
        Ok(answer(
            problem,
            known,
            evolution.best().route(),
            run.stats(stop),
        ))
    }
}
