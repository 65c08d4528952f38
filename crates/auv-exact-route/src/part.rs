//! The bound of a part of the routes: those that keep some decisions.

use crate::cut::Cut;
use crate::decision::{Decision, Fractional};
use crate::incumbent::Incumbent;
use crate::relaxation::Relaxation;
use crate::separation::violated_at_once;
use crate::simplex::Solution;
use crate::support::{Support, SupportLink};
use auv_planning::Run;

/// What is known of a part.
pub(crate) enum Part {
    /// It holds no better route.
    Closed,
    /// Rounding errors, or the end of the run, keep it from being closed or divided.
    Unclosed,
    /// Its bound, and what it can be divided by.
    Fractional(f64, Vec<Fractional>),
}

/// Rounds of cuts within which the gap of a part has to shrink by [`LEAST_PROGRESS`].
const PATIENCE: usize = 3;
const LEAST_PROGRESS: f64 = 0.03;
/// Steps along a row without a feasible point.
const STEPS: [f64; 8] = [1.0, 10.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7];
/// Cuts that are added before slack ones are removed.
const NEW_CUTS: usize = 25;
/// Most cuts of a round: those violated most.
const MOST_CUTS: usize = 20;

/// The relaxation of parts, one after the other.
pub(crate) struct PartBound<'a> {
    pub(crate) relaxation: &'a mut Relaxation,
    decisions: Vec<Decision>,
    /// Bounds of links by these decisions, by ascending link.
    decided: Vec<(u32, (f64, f64))>,
    most_rows: usize,
}

impl<'a> PartBound<'a> {
    pub(crate) fn new(relaxation: &'a mut Relaxation) -> Self {
        relaxation.remove_closed_columns();
        for link in relaxation.open.clone() {
            relaxation.add_column(link);
        }
        Self {
            most_rows: relaxation.program.num_rows() + NEW_CUTS,
            relaxation,
            decisions: Vec::new(),
            decided: Vec::new(),
        }
    }

    /// Bounds the routes that keep some decisions. Their bound is at most `known`.
    pub(crate) fn solve(
        &mut self,
        run: &mut Run<'_>,
        incumbent: &mut Incumbent<'_>,
        decisions: &[Decision],
        known: f64,
    ) -> Part {
        self.decide(decisions);
        let mut bound = known;
        // Of the program's own solutions, which may be weaker than what is known: cuts that held may be gone.
        let mut bounds = Vec::new();
        let mut is_fresh = false;
        loop {
            let solution = self.relaxation.program.solve(|| run.grant(1) == 1);
            let wanted = incumbent.weight + incumbent.gain;
            let own = self.bound(solution, wanted);
            bound = bound.min(own);
            if bound < wanted {
                return Part::Closed;
            }
            if run.should_stop() {
                return Part::Unclosed;
            }
            if solution != Solution::Optimal {
                if is_fresh || !self.relaxation.program.invert() {
                    return Part::Unclosed;
                }
                is_fresh = true;
                continue;
            }
            bounds.push(own);
            let before = bounds.len().checked_sub(PATIENCE + 1).map(|at| bounds[at]);
            let least = LEAST_PROGRESS * (own - incumbent.weight);
            let has_stalled = before.is_some_and(|before| before - own < least);
            let links = self.relaxation.solution();
            let cuts = if has_stalled {
                Vec::new()
            } else {
                self.violated(&links)
            };
            if cuts.is_empty() {
                return self.fractional(incumbent, &links, bound);
            }
            if self.relaxation.program.num_rows() > self.most_rows {
                self.relaxation.remove_slack_cuts();
                self.most_rows = self.relaxation.program.num_rows() + NEW_CUTS;
            }
            cuts.into_iter()
                .for_each(|cut| self.relaxation.add_cut(cut));
        }
    }

    /// Sets the bounds of the variables by decisions.
    fn decide(&mut self, decisions: &[Decision]) {
        let relaxation = &mut *self.relaxation;
        let mut decided = Vec::new();
        for decision in decisions {
            match *decision {
                Decision::Visit(_) => {}
                Decision::Skip(v) => {
                    decided.extend(relaxation.links_at(v).map(|link| (link, (0.0, 0.0))))
                }
                Decision::Use(link) => decided.push((link, (1.0, 1.0))),
                Decision::Avoid(link) => decided.push((link, (0.0, 0.0))),
            }
        }
        decided.sort_by_key(|&(link, _)| link);
        decided.dedup_by_key(|&mut (link, _)| link);
        for &(link, _) in &self.decided {
            if decided
                .binary_search_by_key(&link, |&(link, _)| link)
                .is_err()
            {
                relaxation.set_bounds(link, (0.0, 1.0));
            }
        }
        for &(link, bounds) in decided
            .iter()
            .filter(|&decided| !self.decided.contains(decided))
        {
            relaxation.set_bounds(link, bounds);
        }
        for (before, after, slack) in [
            (&self.decisions[..], decisions, 2.0),
            (decisions, &self.decisions[..], 0.0),
        ] {
            for decision in before.iter().filter(|decision| !after.contains(decision)) {
                if let Decision::Visit(v) = *decision {
                    relaxation.program.set_slack(v, slack);
                }
            }
        }
        self.decided = decided;
        self.decisions = decisions.to_vec();
    }

    /// The bound by the present multipliers; without a feasible point, by those far enough along the row
    /// that has none for a bound below `wanted`.
    fn bound(&self, solution: Solution, wanted: f64) -> f64 {
        let program = &self.relaxation.program;
        let mut bound = self.bound_by(&program.multipliers());
        if let Solution::Infeasible { position, sign } = solution {
            for step in STEPS {
                if bound < wanted {
                    break;
                }
                let multipliers = program.multipliers_along(position, sign * step);
                bound = bound.min(self.bound_by(&multipliers));
            }
        }
        bound
    }

    fn bound_by(&self, of_rows: &[f64]) -> f64 {
        let multipliers = self.relaxation.named(of_rows);
        let (mut visited, mut used) = (Vec::new(), Vec::new());
        for decision in &self.decisions {
            match *decision {
                Decision::Visit(v) => visited.push(v),
                Decision::Use(link) => used.push(link),
                Decision::Skip(_) | Decision::Avoid(_) => {}
            }
        }
        let is_avoided = |link: &u32| {
            let found = self.decided.binary_search_by_key(link, |&(link, _)| link);
            found.is_ok_and(|at| self.decided[at].1 == (0.0, 0.0))
        };
        let links = self
            .relaxation
            .open
            .iter()
            .copied()
            .filter(|link| !is_avoided(link));
        let priced = self.relaxation.priced(&multipliers, links);
        multipliers.bound(
            &self.relaxation.links,
            &priced,
            &self.relaxation.scope(&visited, &used),
        )
    }

    fn violated(&mut self, solution: &[(u32, f64)]) -> Vec<Cut> {
        let known = self.relaxation.take_violated(solution, MOST_CUTS);
        if !known.is_empty() {
            return known;
        }
        let ends = |link: u32| self.relaxation.links.all[link as usize].ends;
        let links = solution.iter().map(|&(link, value)| SupportLink {
            ends: ends(link),
            value,
        });
        let links: Vec<_> = links.collect();
        let mut cuts = violated_at_once(&Support {
            nodes: self.relaxation.nodes,
            ends: self.relaxation.ends,
            links: &links,
        });
        cuts.truncate(MOST_CUTS);
        cuts
    }

    /// The nodes that are visited in part, or else the links that are used in part. A solution without either
    /// is offered as a route.
    fn fractional(
        &self,
        incumbent: &mut Incumbent<'_>,
        solution: &[(u32, f64)],
        bound: f64,
    ) -> Part {
        let mut visits = vec![0.0; self.relaxation.nodes];
        for &(link, value) in solution {
            let (u, v) = self.relaxation.links.all[link as usize].ends;
            visits[u] += 0.5 * value;
            visits[v] += 0.5 * value;
        }
        let (start, destination) = self.relaxation.ends;
        (visits[start], visits[destination]) = (1.0, 1.0);
        let is_fractional = |value: f64| (value - 0.5).abs() < 0.5 - 1e-5;
        let nodes = visits
            .iter()
            .enumerate()
            .filter(|(_, visits)| is_fractional(**visits));
        let nodes: Vec<_> = nodes
            .map(|(v, &visits)| Fractional::Node(v, visits))
            .collect();
        if !nodes.is_empty() {
            return Part::Fractional(bound, nodes);
        }
        let links = solution.iter().filter(|(_, value)| is_fractional(*value));
        let links: Vec<_> = links
            .map(|&(link, value)| Fractional::Link(link, value))
            .collect();
        if !links.is_empty() {
            return Part::Fractional(bound, links);
        }
        self.offer(incumbent, solution);
        if bound < incumbent.weight + incumbent.gain {
            return Part::Closed;
        }
        // It is not in time by a rounding error, or not the only route of its weight.
        let is_undecided =
            |(link, _): &&(u32, f64)| !self.decisions.contains(&Decision::Use(*link));
        match solution.iter().find(is_undecided) {
            Some(&(link, _)) => Part::Fractional(bound, vec![Fractional::Link(link, 1.0)]),
            None => Part::Closed,
        }
    }

    /// Offers the route along the links of a solution.
    fn offer(&self, incumbent: &mut Incumbent<'_>, solution: &[(u32, f64)]) {
        let ends = solution
            .iter()
            .map(|&(link, _)| self.relaxation.links.all[link as usize].ends);
        let mut left: Vec<_> = ends.collect();
        let mut at = self.relaxation.ends.0;
        let mut nodes = vec![at];
        while let Some(next) = left.iter().position(|&(u, v)| u == at || v == at) {
            let (u, v) = left.swap_remove(next);
            at = u + v - at;
            nodes.push(at);
        }
        incumbent.offer_nodes(nodes);
    }

    /// By how much a decision lowers the bound of the part within some pivots; infinite if nothing is left.
    pub(crate) fn trial(
        &self,
        decision: Decision,
        pivots: usize,
        may_pivot: &mut impl FnMut() -> bool,
    ) -> f64 {
        let mut program = self.relaxation.program.clone();
        let before = program.objective();
        match decision {
            Decision::Visit(v) => program.set_slack(v, 0.0),
            Decision::Skip(v) => {
                for link in self.relaxation.links_at(v) {
                    if let Some(id) = self.relaxation.variable(link) {
                        program.set_bounds(id, (0.0, 0.0));
                    }
                }
            }
            Decision::Use(_) | Decision::Avoid(_) => return 0.0,
        }
        let mut left = pivots;
        let solution = program.solve(|| {
            let is_left = left > 0;
            left = left.saturating_sub(1);
            is_left && may_pivot()
        });
        match solution {
            Solution::Infeasible { .. } => f64::INFINITY,
            Solution::Optimal | Solution::Stopped => before - program.objective(),
        }
    }
}
