//! The planner: chooses the algorithm and runs it.

use crate::corridor_route::corridor_route;
use crate::evolution::Evolution;
use crate::in_time::search_in_time;
use crate::memetic::{MemeticSearch, TourObjective};
use crate::{EvolutionSettings, GaSettings, MemeticSettings};
use auv_graph::Route;
use auv_planning::baseline::greedy;
use auv_planning::timed::plan_in_time;
use auv_planning::{PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason};
use auv_population::{Workers, search};
use auv_route_encoding::{KnownRoute, UsableArcs, plan_from_known};

/// Plans routes by a genetic algorithm.
#[derive(Clone, Debug, Default)]
pub struct GaRoute {
    settings: GaSettings,
    workers: Workers,
}

impl GaRoute {
    /// A planner that computes on the calling thread alone.
    #[must_use]
    pub fn new(settings: GaSettings) -> Self {
        Self {
            settings,
            workers: Workers::one(),
        }
    }

    /// Computes on `workers`. The answer does not depend on them.
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
        if let (Some(model), GaSettings::Memetic(_)) = (problem.time_model, &self.settings) {
            return plan_in_time(run, problem, model, self.name(), search_in_time);
        }
        plan_from_known(run, problem, |run, known| {
            match (&self.settings, TourObjective::new(problem)) {
                (GaSettings::Memetic(settings), Some(objective)) => {
                    self.search_memetic(settings, objective, run, problem, known)
                }
                (GaSettings::Memetic(_), None) => {
                    self.search_evolution(&EvolutionSettings::paper(), run, problem, known)
                }
                (GaSettings::Evolution(settings), _) => {
                    self.search_evolution(settings, run, problem, known)
                }
            }
        })
    }
}

impl GaRoute {
    /// Answers with the greedy route at once, then with better ones as long as the run lasts.
    fn search_memetic(
        &self,
        settings: &MemeticSettings,
        objective: TourObjective,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
        known: &mut KnownRoute,
    ) -> (Route, StopReason) {
        let mut first = vec![known.best.route(), greedy(problem, &known.home)];
        first.extend(corridor_route(problem, &first[0]));
        for route in &first[1..] {
            known.offer(problem, route);
        }
        run.end_generation(known.best.score, &[], &[]);
        match MemeticSearch::new(settings, objective, problem, &known.home, run, &first) {
            Some(memetic) if memetic.is_large() => memetic.anneal(run),
            Some(mut memetic) => {
                let stop = search(run, &self.workers, &mut memetic);
                (memetic.finish(), stop)
            }
            None => (known.best.route(), StopReason::Finished),
        }
    }

    fn search_evolution(
        &self,
        settings: &EvolutionSettings,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
        known: &mut KnownRoute,
    ) -> (Route, StopReason) {
        let arcs = UsableArcs::new(problem, run.deadline());
        let given = (run.seed(), run.deadline());
        let mut evolution = Evolution::new(settings, &arcs, known, given);
        let stop = search(run, &self.workers, &mut evolution);
        let best = evolution.best().route();
        known.offer_greedy_if_cut_short(problem, stop);
        (best, stop)
    }
}
