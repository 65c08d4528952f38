//! A route planner that starts another again.

use crate::{PlanError, Planned, RoutePlanner, RouteProblem, Run, StopReason};
use auv_graph::Route;

/// Calls a planner again, each time with another seed, and gives the best of its routes.
///
/// A population search ends when it stalls ([`StopReason::Stalled`]), which may be before the run has to end, and
/// not always at the best route. Each start is on its own: it does not know what those before it found.
///
/// The first call gets the run itself, so the answer is never worse than that of the planner alone. The others get
/// seeds split from the run's, and their generations count as one.
///
/// # Determinism
/// That of the planner.
///
/// ```
/// use auv_planning::{Restarts, baseline::GreedyRoute};
///
/// // Ends after three starts in a row that find nothing better, or with the run.
/// let planner = Restarts::new(GreedyRoute, 3);
/// # let _ = planner;
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Restarts<P> {
    planner: P,
    patience: u32,
}

impl<P> Restarts<P> {
    /// Ends after `patience` starts in a row without a better route. 0: only the first call.
    pub const fn new(planner: P, patience: u32) -> Self {
        Self { planner, patience }
    }
}

impl<P: RoutePlanner> RoutePlanner for Restarts<P> {
    fn name(&self) -> &str {
        self.planner.name()
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        let mut best = self.planner.plan_route(run, problem)?;
        let (mut fruitless, mut index) = (0, 0);
        while best.stats.stop == StopReason::Stalled
            && fruitless < self.patience
            && !run.should_stop()
        {
            let next = run.stage(index, None, |part| self.planner.plan_route(part, problem))?;
            (fruitless, index) = (fruitless + 1, index + 1);
            if next.score() < best.score() {
                let stop = best.stats.stop;
                best = next;
                // A start that the end of the run cut short has not stalled; the loop ends all the same.
                best.stats.stop = stop;
                fruitless = 0;
            }
            run.end_generation(best.score(), &[], &[]);
        }
        best.stats = run.stats(best.stats.stop);
        Ok(best)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Budget, Score};
    use auv_graph::{NodeId, Terrain};
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    /// Each call draws a cost and takes ten evaluations.
    struct Drawn(StopReason);

    impl RoutePlanner for Drawn {
        fn name(&self) -> &str {
            "drawn"
        }

        fn plan_route(
            &self,
            run: &mut Run<'_>,
            problem: &RouteProblem<'_>,
        ) -> Result<Planned<Route>, PlanError> {
            run.grant(10);
            let cost = run.seed().stream(0).random_range(0.0..1.0);
            run.end_generation(Score::feasible(cost), &[], &[]);
            let route = Route::new(vec![problem.start, problem.destination]);
            Ok(Planned::new(route, cost, 0.0, run.stats(self.0)))
        }
    }

    fn plan(planner: &dyn RoutePlanner, budget: Budget) -> Planned<Route> {
        let instance = Terrain::paper(10, 40).draw(Seed(1)).unwrap();
        let ends = (NodeId(0), NodeId(9));
        let problem = RouteProblem::new(&instance.network, ends.0, ends.1, 9_000.0);
        let mut run = Run::new(Seed(7), budget);
        planner.plan_route(&mut run, &problem).unwrap()
    }

    #[test]
    fn the_best_of_all_starts_is_given_until_some_in_a_row_are_fruitless() {
        let stalled = || Drawn(StopReason::Stalled);
        let once = plan(&stalled(), Budget::to_the_cap());
        let costs: Vec<f64> = [0, 3, 30]
            .map(|patience| {
                let planned = plan(&Restarts::new(stalled(), patience), Budget::to_the_cap());
                assert_eq!(planned.stats.stop, StopReason::Stalled);
                assert!(planned.stats.evaluations >= 10 + 10 * u64::from(patience));
                planned.cost
            })
            .to_vec();
        assert_eq!(costs[0], once.cost);
        assert!(costs[2] < costs[0] && costs[2] <= costs[1] && costs[1] <= costs[0]);
    }

    #[test]
    fn the_run_ends_the_starts() {
        let planner = Restarts::new(Drawn(StopReason::Stalled), 1_000);
        let planned = plan(&planner, Budget::evaluations(45));
        assert_eq!(planned.stats.evaluations, 45);
        assert_eq!(planned.stats.stop, StopReason::EvaluationsSpent);
        assert_eq!(planned, plan(&planner, Budget::evaluations(45)));
    }

    #[test]
    fn a_planner_that_did_not_stall_is_called_once() {
        for stop in [StopReason::Optimal, StopReason::Finished] {
            let planned = plan(&Restarts::new(Drawn(stop), 5), Budget::to_the_cap());
            assert_eq!((planned.stats.evaluations, planned.stats.stop), (10, stop));
        }
    }
}
