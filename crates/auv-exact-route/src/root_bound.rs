//! The bound of all routes: columns by pricing, cuts by separation, and links closed by reduced costs.

use crate::incumbent::Incumbent;
use crate::relaxation::Relaxation;
use crate::separation::Separation;
use crate::simplex::Solution;
use auv_planning::{Run, Score};

/// Rounds within which the gap has to shrink by [`LEAST_PROGRESS`].
const PATIENCE: usize = 10;
const LEAST_PROGRESS: f64 = 0.02;
/// Rounds between removals of slack cuts.
const ROUNDS_OF_A_CUT: usize = 5;
/// Links priced after the run has to stop: a few milliseconds.
const MOST_LATE_LINKS: usize = 50_000;

/// Lowers the bound until it stalls or meets the best weight. `None` if the run has to stop.
pub(crate) fn lower_bound(
    run: &mut Run<'_>,
    relaxation: &mut Relaxation,
    incumbent: &mut Incumbent<'_>,
) -> Option<()> {
    let ends: Vec<_> = relaxation.links.all.iter().map(|link| link.ends).collect();
    let route = (relaxation.nodes, relaxation.ends);
    let mut separation = Separation::new();
    let mut gaps = Vec::new();
    for round in 1.. {
        let solution = relaxation.program.solve(|| run.grant(1) == 1);
        if run.should_stop() && relaxation.open.len() > MOST_LATE_LINKS {
            return None;
        }
        let priced = relaxation.price(incumbent);
        run.end_generation(Score::feasible(-incumbent.weight), &[], &[]);
        if run.should_stop() {
            return None;
        }
        if incumbent.is_proven() || solution != Solution::Optimal {
            break;
        }
        let cuts = separation.violated(route, &ends, &relaxation.solution());
        let gap = incumbent.bound - incumbent.weight;
        gaps.push(gap);
        let before = gaps.len().checked_sub(PATIENCE + 1).map(|at| gaps[at]);
        let has_stalled = before.is_some_and(|before| gap > (1.0 - LEAST_PROGRESS) * before);
        if has_stalled || (priced.is_empty() && cuts.is_empty()) {
            break;
        }
        if round % ROUNDS_OF_A_CUT == 0 {
            relaxation.remove_slack_cuts();
        }
        priced
            .into_iter()
            .for_each(|link| relaxation.add_column(link));
        cuts.into_iter().for_each(|cut| relaxation.add_cut(cut));
    }
    Some(())
}

impl Relaxation {
    /// Lowers the bound by the present multipliers, closes links that cannot belong to a better route, and
    /// returns those that should be columns, the best first.
    fn price(&mut self, incumbent: &mut Incumbent<'_>) -> Vec<u32> {
        let multipliers = self.named(&self.program.multipliers());
        let priced = self.priced(&multipliers, self.open.iter().copied());
        let bound = multipliers.bound(&self.links, &priced, &self.scope(&[], &[]));
        incumbent.bound = incumbent.bound.min(bound.max(incumbent.weight));
        let wanted = incumbent.weight + incumbent.gain;
        let stays = |&&(_, reduced): &&(u32, f64)| bound + f64::min(reduced, 0.0) >= wanted;
        self.open = priced.iter().filter(stays).map(|&(link, _)| link).collect();
        for (link, _) in priced.iter().filter(|link| !stays(link)) {
            self.set_bounds(*link, (0.0, 0.0));
        }
        let is_missing =
            |&&(link, reduced): &&(u32, f64)| reduced > 1e-7 && self.variable(link).is_none();
        let mut missing: Vec<_> = priced.iter().filter(is_missing).copied().collect();
        missing.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        missing.truncate(2 * self.nodes);
        missing.into_iter().map(|(link, _)| link).collect()
    }
}
