//! What a part of the routes is divided by: the node or link whose two decisions lower the bound most.

use crate::decision::{Decision, Fractional};
use crate::part::PartBound;

/// Candidates compared at a part.
const CANDIDATES: usize = 12;
/// How often a decision is tried before what it did elsewhere is trusted.
const TRIALS: u32 = 2;
/// Trials end after so many in a row without a better candidate.
const MISSES: usize = 4;
/// Pivots of a trial.
const PIVOTS: usize = 20;

/// By how much decisions lowered the bound for each unit that they moved a value.
#[derive(Debug)]
pub(crate) struct Experience {
    /// By node: skipped and visited; sum and number.
    nodes: Vec<[(f64, u32); 2]>,
    all: (f64, u32),
}

impl Experience {
    pub(crate) fn new(nodes: usize) -> Self {
        Self {
            nodes: vec![[(0.0, 0); 2]; nodes],
            all: (0.0, 0),
        }
    }

    fn expected(&self, node: usize, direction: usize) -> f64 {
        let (sum, count) = match self.nodes[node][direction] {
            (_, 0) => self.all,
            known => known,
        };
        if count == 0 {
            1.0
        } else {
            sum / f64::from(count)
        }
    }

    fn record(&mut self, node: usize, direction: usize, per_unit: f64) {
        for (sum, count) in [&mut self.nodes[node][direction], &mut self.all] {
            *sum += per_unit;
            *count += 1;
        }
    }

    /// Whether both decisions of a node have been tried.
    fn is_known(&self, node: usize) -> bool {
        self.nodes[node].iter().all(|&(_, count)| count >= TRIALS)
    }

    /// The candidate that promises most, of at least one. A gain of `gap` closes a part. `may_pivot` is asked
    /// before every pivot of a trial.
    pub(crate) fn choose(
        &mut self,
        part: &PartBound<'_>,
        candidates: &[Fractional],
        gap: f64,
        mut may_pivot: impl FnMut() -> bool,
    ) -> Fractional {
        let mut ranked: Vec<_> = candidates
            .iter()
            .map(|&candidate| (self.promise(candidate, gap), candidate))
            .collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        ranked.truncate(CANDIDATES);
        let mut best = (f64::NEG_INFINITY, candidates[0]);
        // Trials in a row without a better candidate.
        let mut misses = 0;
        for (mut promise, candidate) in ranked {
            if let Fractional::Node(v, value) = candidate
                && !self.is_known(v)
                && misses < MISSES
            {
                let gains = [Decision::Skip(v), Decision::Visit(v)]
                    .map(|decision| part.trial(decision, PIVOTS, &mut may_pivot).min(gap));
                self.record(v, 0, gains[0] / value);
                self.record(v, 1, gains[1] / (1.0 - value));
                promise = score(gains, gap);
                misses += 1;
            }
            if promise > best.0 {
                best = (promise, candidate);
                misses = 0;
            }
        }
        best.1
    }

    fn promise(&self, candidate: Fractional, gap: f64) -> f64 {
        match candidate {
            Fractional::Node(v, value) => {
                let gains = [
                    value * self.expected(v, 0),
                    (1.0 - value) * self.expected(v, 1),
                ];
                score(gains.map(|gain| gain.min(gap)), gap)
            }
            // Links are divided by where no node is left.
            Fractional::Link(_, value) => -1.0 - (value - 0.5).abs(),
        }
    }
}

/// The product of both gains, which prefers two middling ones to a large and a small one.
fn score(gains: [f64; 2], gap: f64) -> f64 {
    let [a, b] = gains.map(|gain| gain.max(1e-4 * gap));
    a * b
}
