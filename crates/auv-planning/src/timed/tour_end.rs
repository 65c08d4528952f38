//! A tour that ends elsewhere.

use super::earliest::quickest_way;
use super::timed_network::{Step, TimedNetwork};
use super::tour::TimedTour;

impl TimedTour {
    /// Ends at a destination by the quickest way from one of the first `kept` steps, the last one from
    /// which the tour is feasible; whether there is one. Else nothing changes.
    pub fn end_at(&mut self, tables: &TimedNetwork<'_>, end: u32, kept: usize) -> bool {
        (1..=kept)
            .rev()
            .any(|kept| self.leads_to(tables, end, kept))
    }

    /// Goes from its first `kept` steps to a destination, if the tour stays feasible.
    fn leads_to(&mut self, tables: &TimedNetwork<'_>, end: u32, kept: usize) -> bool {
        let start = self.steps()[0].node;
        let stays = |step: &Step| step.node != end || end == start;
        let mut steps: Vec<_> = self.steps()[..kept].iter().copied().filter(stays).collect();
        // A node passed does its tasks, for which there may be no time.
        let does_nothing =
            |node: u32| !tables.passing_works() || tables.at_node[node as usize].is_empty();
        let is_free = |node: u32| {
            node == end || (does_nothing(node) && steps.iter().all(|step| step.node != node))
        };
        let from = steps.last().map_or(start, |step| step.node);
        let Some((_, way)) = quickest_way(tables, from, end, self.ready_s[kept - 1], is_free)
        else {
            return false;
        };
        steps.extend(way.into_iter().map(Step::pass));
        self.splice(tables, (0, self.steps().len()), &steps)
    }
}
