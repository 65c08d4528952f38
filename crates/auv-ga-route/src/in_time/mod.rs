//! The search for routes in time: one tour is ruined and rebuilt again and again, and the change is kept
//! by simulated annealing.
//!
//! # References
//! Christiaens and Vanden Berghe, "Slack Induction by String Removals for Vehicle Routing Problems",
//! Transportation Science 54(2), 2020. Vansteenwegen et al., "Iterated local search for the team
//! orienteering problem with time windows", Computers and Operations Research 36(12), 2009 (the O(1)
//! judgement of an insertion).

mod labelling;
mod rebuild;
mod ruin;
mod timed_search;

use auv_planning::timed::{TimedNetwork, TimedTour, fill, pieces};
use auv_planning::{Run, StopReason};
use timed_search::TimedSearch;

/// Improves a tour as long as the run lasts.
pub(crate) fn search_in_time(
    run: &mut Run<'_>,
    tables: &TimedNetwork<'_>,
    tour: &mut TimedTour,
) -> StopReason {
    let pieces = pieces(tables);
    run.grant(1);
    let start = tour.clone();
    fill(tables, tour, &pieces);
    let mut search = TimedSearch::new(tables, &pieces, start, tour.clone(), run.seed());
    let reason = search.run(run);
    tour.copy_from(search.best());
    reason
}
