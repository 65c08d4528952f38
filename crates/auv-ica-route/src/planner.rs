//! The planner.

use crate::imperialism::Imperialism;
use crate::settings::IcaSettings;
use auv_graph::Route;
use auv_planning::{PlanError, Planned, RoutePlanner, RouteProblem, Run};
use auv_population::{Workers, search};
use auv_route_encoding::{UsableArcs, plan_from_known};

/// Plans routes by the Imperialist Competitive Algorithm.
#[derive(Clone, Debug, Default)]
pub struct IcaRoute {
    settings: IcaSettings,
    workers: Workers,
}

impl IcaRoute {
    /// A planner that computes on the calling thread alone.
    #[must_use]
    pub fn new(settings: IcaSettings) -> Self {
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

impl RoutePlanner for IcaRoute {
    fn name(&self) -> &str {
        "ica"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        self.settings.validate().into_result()?;
        plan_from_known(run, problem, |run, known| {
            let arcs = UsableArcs::new(problem, run.deadline());
            let given = (run.seed(), run.deadline());
            let mut imperialism = Imperialism::new(&self.settings, &arcs, known, given);
            let stop = search(run, &self.workers, &mut imperialism);
            let best = imperialism.best().route();
            known.offer_greedy_if_cut_short(problem, stop);
            (best, stop)
        })
    }
}
