//! Where a piece fits into a tour, judged in O(1) for each place.

use super::timed_network::{Step, TimedNetwork};
use super::tour::TimedTour;
use auv_graph::TIME_TOLERANCE_S;

/// A place for a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Insertion {
    /// The piece follows this step.
    pub after: usize,
    /// By how much the next step begins later, in seconds.
    pub delay_s: f64,
    /// What the own weights of the edges change by.
    pub own_weight: f64,
}

impl TimedTour {
    /// Judges a piece between step `after` and the next. What this refuses cannot go there; what it grants
    /// still has to keep the rules, which [`TimedTour::splice`] checks.
    #[must_use]
    pub fn insertion(
        &self,
        tables: &TimedNetwork<'_>,
        piece: &[Step],
        after: usize,
    ) -> Option<Insertion> {
        let before = self.steps()[after];
        let next = self.steps().get(after + 1).copied();
        if tables.has_profiles() && self.is_surely_late(tables, piece, after) {
            return None;
        }
        let at = piece.last().map_or(before.node, |step| step.node);
        let ready_s = tables.ready_along_s(piece, before.node, self.ready_s[after]);
        if ready_s == f64::INFINITY {
            return None;
        }
        let Some(next) = next else {
            let is_in_time = ready_s <= tables.problem.time_available_s + TIME_TOLERANCE_S;
            let delay_s = ready_s - self.ready_s[after];
            return (at == before.node && is_in_time).then_some(Insertion {
                after,
                delay_s,
                own_weight: 0.0,
            });
        };
        let arrival_s = tables.arrival_s(at, next.node, ready_s);
        let is_late = arrival_s > self.latest_s[after + 1] + TIME_TOLERANCE_S;
        if is_late && !(arrival_s < f64::INFINITY && self.turns_back(tables, piece)) {
            return None;
        }
        let old_s = tables.arrival_s(before.node, next.node, self.ready_s[after]);
        let mut own_weight = 0.0;
        if tables.has_own_weights {
            let mut at = before.node;
            for step in piece.iter().chain([&next]) {
                if step.node != at {
                    own_weight += tables.own_weight(at, step.node);
                }
                at = step.node;
            }
            if before.node != next.node {
                own_weight -= tables.own_weight(before.node, next.node);
            }
        }
        Some(Insertion {
            after,
            delay_s: arrival_s - old_s,
            own_weight,
        })
    }

    /// Whether a piece behind step `after` makes the next one late at any travel times.
    fn is_surely_late(&self, tables: &TimedNetwork<'_>, piece: &[Step], after: usize) -> bool {
        let mut at = self.steps()[after].node;
        let mut ready_s = self.ready_s[after];
        for step in piece {
            if at != step.node {
                ready_s += tables.least_s(at, step.node);
            }
            if step.works() {
                ready_s += tables.works[step.task as usize].delta_s;
            }
            at = step.node;
        }
        let Some(next) = self.steps().get(after + 1) else {
            return ready_s > tables.problem.time_available_s + 2.0 * TIME_TOLERANCE_S;
        };
        if at != next.node {
            ready_s += tables.least_s(at, next.node);
        }
        // With room for the rounding of the sums.
        ready_s > self.latest_s[after + 1] * (1.0 + 1e-12) + 2.0 * TIME_TOLERANCE_S
            && !(ready_s < f64::INFINITY && self.turns_back(tables, piece))
    }

    /// How many of the steps behind step `after` have to go for a piece to fit there, `most` at most.
    #[must_use]
    pub fn ejection(
        &self,
        tables: &TimedNetwork<'_>,
        piece: &[Step],
        after: usize,
        most: usize,
    ) -> Option<usize> {
        let before = self.steps()[after].node;
        let at = piece.last().map_or(before, |step| step.node);
        let ready_s = tables.ready_along_s(piece, before, self.ready_s[after]);
        let last = self.steps().len().checked_sub(after + 2)?;
        (0..=most.min(last)).find(|&gone| {
            let next = after + 1 + gone;
            let arrival_s = tables.arrival_s(at, self.steps()[next].node, ready_s);
            arrival_s <= self.latest_s[next] + TIME_TOLERANCE_S
        })
    }

    /// Judges one step between step `after` and the next, where edges have no weights of their own: by how
    /// much the next step begins later, in seconds; infinite where it does not fit.
    #[inline]
    #[must_use]
    pub fn delay_s(&self, tables: &TimedNetwork<'_>, step: Step, after: usize) -> f64 {
        let (before, next) = (self.steps()[after].node, self.steps()[after + 1].node);
        let leave_s = self.ready_s[after];
        let ready_s = tables.ready_s(step.task, tables.arrival_s(before, step.node, leave_s));
        let arrival_s = tables.arrival_s(step.node, next, ready_s);
        if arrival_s <= self.latest_s[after + 1] + TIME_TOLERANCE_S {
            arrival_s - tables.arrival_s(before, next, leave_s)
        } else {
            f64::INFINITY
        }
    }

    /// Whether the tour with a piece goes to one node and back: then the way back does not do the edge's
    /// own task again, which the times of a judgement do not know.
    fn turns_back(&self, tables: &TimedNetwork<'_>, piece: &[Step]) -> bool {
        let start = tables.problem.start.0;
        let closes = self.steps().last().is_some_and(|step| step.node == start);
        let mut others = self.steps().iter().chain(piece).map(|step| step.node);
        let other = others.find(|&node| node != start);
        closes && others.all(|node| node == start || Some(node) == other)
    }

    /// Whether a piece may stand between step `after` and the next as far as nodes are concerned: new
    /// nodes, or a further task at a node beside it.
    #[must_use]
    pub fn has_room(&self, piece: &[Step], after: usize) -> bool {
        let beside = |node: u32| {
            self.steps()[after].node == node
                || self
                    .steps()
                    .get(after + 1)
                    .is_some_and(|next| next.node == node)
        };
        piece
            .iter()
            .all(|step| !self.visits(step.node) || beside(step.node))
            && piece
                .iter()
                .all(|step| !step.works() || !self.does(step.task))
    }
}
