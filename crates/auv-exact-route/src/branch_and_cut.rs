//! Branch and cut: the routes that the relaxation leaves open are divided by whether a node is visited or a
//! link used, until every part is a route or cannot hold a better one.

use crate::branching::Experience;
use crate::decision::Decision;
use crate::incumbent::Incumbent;
use crate::part::{Part, PartBound};
use crate::relaxation::Relaxation;
use auv_planning::{Run, Score};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// The routes that keep some decisions.
#[derive(Debug)]
struct OpenPart {
    /// No route of the part weighs more.
    bound: f64,
    /// Number of parts made before: the younger of two of equal bounds comes first.
    serial: u64,
    decisions: Vec<Decision>,
}

impl Ord for OpenPart {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_bound = self.bound.total_cmp(&other.bound);
        by_bound.then(self.serial.cmp(&other.serial))
    }
}

impl PartialOrd for OpenPart {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl PartialEq for OpenPart {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for OpenPart {}

/// Divides until nothing better is left, more than `most_parts` are open or the run has to stop. The bound
/// falls as it goes.
///
/// The part of the highest bound comes first, and of its two parts at once the one nearer to the fractional
/// route, then that of this one, until one is closed.
pub(crate) fn branch_and_cut(
    run: &mut Run<'_>,
    relaxation: &mut Relaxation,
    incumbent: &mut Incumbent<'_>,
    most_parts: usize,
) {
    let mut experience = Experience::new(relaxation.nodes);
    let mut solver = PartBound::new(relaxation);
    let mut open = BinaryHeap::new();
    let mut serial = 0;
    let mut next = Some(OpenPart {
        bound: incumbent.bound,
        serial,
        decisions: Vec::new(),
    });
    // The most that parts may hold which could not be closed.
    let mut unclosed = f64::NEG_INFINITY;
    while let Some(part) = next.take().or_else(|| open.pop()) {
        let others = open
            .peek()
            .map_or(f64::NEG_INFINITY, |other: &OpenPart| other.bound);
        let most = part.bound.max(others).max(unclosed);
        incumbent.bound = incumbent.bound.min(most.max(incumbent.weight));
        if incumbent.is_proven() || run.should_stop() || open.len() > most_parts {
            return;
        }
        if part.bound < incumbent.weight + incumbent.gain {
            continue;
        }
        let (bound, fractional) = match solver.solve(run, incumbent, &part.decisions, part.bound) {
            Part::Closed => continue,
            Part::Unclosed => {
                unclosed = unclosed.max(part.bound);
                continue;
            }
            Part::Fractional(bound, fractional) => (bound, fractional),
        };
        let gap = bound - incumbent.weight;
        let chosen = experience.choose(&solver, &fractional, gap, || run.grant(1) == 1);
        let [first, second] = chosen.decisions().map(|decision| {
            serial += 1;
            let mut decisions = part.decisions.clone();
            decisions.push(decision);
            OpenPart {
                bound,
                serial,
                decisions,
            }
        });
        open.push(second);
        next = Some(first);
        run.end_generation(Score::feasible(-incumbent.weight), &[], &[]);
    }
    incumbent.bound = incumbent.bound.min(unclosed.max(incumbent.weight));
}
