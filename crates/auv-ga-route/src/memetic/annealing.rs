//! The search in a large space: small parts of one tour are ruined and rebuilt, and the change is kept by
//! simulated annealing. A change costs the same on a tour of any length.
//!
//! # References
//! Christiaens and Vanden Berghe, "Slack Induction by String Removals for Vehicle Routing Problems",
//! Transportation Science 54(2), 2020.

use super::descent::Descent;
use super::ejection::Ejection;
use super::linked_tour::LinkedTour;
use super::objective::TourObjective;
use super::profit_time::ProfitTime;
use super::search_space::{END, START, SearchSpace};
use super::tour::Tour;
use auv_planning::{Deadline, Run, Score, StopReason};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, libm};

/// Most nodes removed in a row.
const LONGEST_STRING: u32 = 10;
/// Share of insertions that are passed over.
const BLINK: f64 = 0.02;
/// First and last temperature, as shares of the mean profit of a leg.
const HOT: f64 = 0.3;
const COLD: f64 = 0.01;
/// Changes of the first annealing for each node of the space; each one after it has twice as many.
const FIRST_CYCLE: u64 = 20;
/// Annealings of a run without a deadline.
const MOST_CYCLES: u32 = 4;
/// Changes between two looks at the clock.
const BATCH: u64 = 64;
/// By how much the price of a second changes while the tour changes once all over, as a share; and its
/// least and greatest factors.
const PRICE_STEP: f64 = 0.3;
const PRICES: [f64; 2] = [0.01, 2.0];
/// Neighbours over which the first tour spreads, and those that are tried later.
const WIDE: usize = 40;
const NARROW: usize = 10;
/// Stages in which the first tour is brought into time.
const EJECTIONS: u32 = 32;
/// First price of a second, as a share of the best tour's profit per second.
const PRICE: f64 = 0.7;
/// Most descent steps for each node of the tour.
const STEPS: u64 = 2;

/// The state of the search.
pub(crate) struct Annealing<'a, 's> {
    space: &'s mut SearchSpace,
    objective: TourObjective,
    deadline: Deadline<'a>,
    random: ChaCha8Rng,
    current: LinkedTour,
    /// Without nodes if it is that of the list.
    best: Tour,
    best_list: LinkedTour,
    /// Profit and mean time of a leg of the best tour.
    leg: ProfitTime,
    /// Nodes to insert, with the order in which they are tried.
    candidates: Vec<(f64, u32)>,
    removed: Vec<u32>,
    /// Inserted first, even at a loss: other nodes may follow.
    forced: Option<u32>,
    /// The last change in which each node was a candidate.
    tried_at: Vec<u64>,
    changes: u64,
    descent: Descent,
    ejection: Ejection,
}

impl<'a, 's> Annealing<'a, 's> {
    /// Starts from a tour in time.
    pub(crate) fn new(
        space: &'s mut SearchSpace,
        objective: TourObjective,
        run: &Run<'a>,
        first: Tour,
    ) -> Self {
        let current = LinkedTour::new(&first.nodes, space);
        Self {
            best_list: current.clone(),
            current,
            objective,
            deadline: run.deadline(),
            random: run.seed().stream(0),
            leg: ProfitTime::default(),
            candidates: Vec::new(),
            removed: Vec::new(),
            forced: None,
            tried_at: vec![0; space.len()],
            changes: 0,
            descent: Descent::default(),
            ejection: Ejection::default(),
            best: first,
            space,
        }
    }

    /// Anneals again and again until the run ends; the best tour.
    pub(crate) fn run(mut self, run: &mut Run<'_>) -> (Tour, StopReason) {
        let mut cycle = FIRST_CYCLE * self.space.len() as u64;
        self.spread();
        for turn in 0.. {
            self.read_best();
            self.descend();
            if !self.anneal(run, cycle) || (!run.has_deadline() && turn + 1 == MOST_CYCLES) {
                break;
            }
            cycle *= 2;
        }
        self.read_best();
        self.descend();
        (self.best, run.stats(StopReason::Finished).stop)
    }

    /// Goes on from a tour all over the space: every node that can be is inserted, and stretches of little
    /// profit are ejected until the tour is in time. A greedy tour stays near the start.
    fn spread(&mut self) {
        self.space.rank_neighbours(WIDE, self.deadline);
        let available_s = std::mem::replace(&mut self.space.time_available_s, f64::INFINITY);
        let mut open = self.best.nodes.clone();
        let mut next = 0;
        while next < open.len() && !self.deadline.passed() {
            for k in 0..self.space.near::<true>(open[next]).len() {
                let node = self.space.near::<true>(open[next])[k].node;
                if !self.current.visits(node)
                    && let Some((_, after, detour)) = self.best_place(node, 0.0)
                {
                    self.current.insert(node, after, detour);
                    open.push(node);
                }
            }
            next += 1;
        }
        let mut tour = Tour::new(self.current.nodes(), self.space);
        let over_s = (tour.time_s - available_s).max(0.0);
        // In stages, to keep the deadline.
        for stage in (0..EJECTIONS).rev().take_while(|_| !self.deadline.passed()) {
            self.space.time_available_s =
                available_s + over_s * f64::from(stage) / f64::from(EJECTIONS);
            self.ejection
                .eject(self.space, &mut tour, &mut self.removed);
        }
        self.space.time_available_s = available_s;
        let is_in_time = !tour.nodes.is_empty() && tour.time_s <= available_s;
        if is_in_time && self.objective.prefers(&tour, &self.best) {
            self.best = tour;
        }
        self.space.price = PRICE * self.best.profit_per_second();
        self.space.rank_neighbours(NARROW, self.deadline);
    }

    /// Improves the best tour by descent and goes on from it.
    fn descend(&mut self) {
        let legs = (self.best.nodes.len() - 1).max(1) as f64;
        let mut tour = self.best.clone();
        let steps = STEPS * tour.nodes.len() as u64;
        let price = self.space.price;
        if !self.deadline.passed() {
            self.descent
                .improve(self.space, &mut tour, price, None, steps, self.deadline);
        }
        if self.objective.prefers(&tour, &self.best) {
            self.best.clone_from(&tour);
        }
        self.current = LinkedTour::new(&tour.nodes, self.space);
        self.leg = ProfitTime {
            profit: (tour.profit / legs).max(1e-9),
            time_s: tour.time_s / legs,
        };
    }

    /// One annealing; whether the run goes on.
    fn anneal(&mut self, run: &mut Run<'_>, changes: u64) -> bool {
        let cooling = libm::pow(COLD / HOT, BATCH as f64 / changes as f64);
        let mut temperature = HOT * self.leg.profit;
        let mut left = changes;
        while left > 0 {
            let granted = run.grant(BATCH);
            if granted == 0 {
                return false;
            }
            (0..granted).for_each(|_| self.try_change(temperature));
            self.set_price();
            run.end_generation(Score::feasible(self.objective.cost(&self.best)), &[], &[]);
            temperature *= cooling;
            left = left.saturating_sub(BATCH);
        }
        true
    }

    /// Time is dear as long as there is none left.
    fn set_price(&mut self) {
        let left_s = self.space.time_available_s - self.current.sum().time_s;
        let step = PRICE_STEP * BATCH as f64 / self.space.len() as f64;
        let factor = if left_s > self.leg.time_s {
            1.0 - step
        } else {
            1.0 + step
        };
        let mean = self.leg.profit / self.leg.time_s.max(1e-9);
        let [least, most] = PRICES.map(|factor| factor * mean);
        self.space.price = (self.space.price * factor).clamp(least, most);
    }

    fn try_change(&mut self, temperature: f64) {
        self.changes += 1;
        if !self.ruin() {
            self.current.undo();
            return;
        }
        self.rebuild();
        let change = self.current.sum() - self.current.committed();
        let gain = change.worth(self.space.price);
        let uniform: f64 = self.random.random();
        if gain < temperature * libm::log(uniform.max(1e-300)) {
            self.current.undo();
            return;
        }
        self.current.commit();
        self.keep_best();
    }

    fn keep_best(&mut self) {
        let ProfitTime { profit, time_s } = self.current.sum();
        let nodes = Vec::new();
        let now = Tour {
            nodes,
            profit,
            time_s,
        };
        if self.objective.prefers(&now, &self.best) {
            // Its nodes are read from the list when the annealing ends.
            self.best = now;
            self.best_list.clone_from(&self.current);
        }
    }

    /// Reads the nodes of the best tour. The sums of many changes differ from its own by rounding.
    fn read_best(&mut self) {
        if self.best.nodes.is_empty() {
            let mut tour = Tour::new(self.best_list.nodes(), self.space);
            self.ejection
                .eject(self.space, &mut tour, &mut self.removed);
            if tour.nodes.is_empty() {
                tour = Tour::new(self.space.quickest(), self.space);
            }
            self.best = tour;
        }
    }

    /// Takes a string of nodes out around a random node, and often a second one beside it. Whether any
    /// place is open.
    fn ruin(&mut self) -> bool {
        self.removed.clear();
        let centre = self.random.random_range(END + 1..self.space.len() as u32);
        let Some(seed) = self.on_tour_near(centre, true) else {
            return false;
        };
        let is_new = !self.current.visits(centre);
        self.forced = is_new.then_some(centre);
        if !is_new || self.random.random_range(0..2_u32) == 0 {
            self.take_string(seed);
        }
        if self.random.random_range(0..2_u32) == 0
            && let Some(seed) = self.on_tour_near(centre, false)
        {
            self.take_string(seed);
        }
        self.candidates.clear();
        self.consider(centre);
        for k in 0..self.removed.len() {
            let node = self.removed[k];
            self.consider(node);
            for near in 0..self.space.near::<true>(node).len() {
                self.consider(self.space.near::<true>(node)[near].node);
            }
        }
        for near in 0..self.space.near::<true>(centre).len() {
            self.consider(self.space.near::<true>(centre)[near].node);
        }
        true
    }

    /// The node itself if it is on the tour and `itself`, or else a neighbour that is.
    fn on_tour_near(&mut self, node: u32, itself: bool) -> Option<u32> {
        if itself && self.current.visits(node) {
            return Some(node);
        }
        let near = self.space.near::<true>(node);
        let first = self.random.random_range(0..near.len().max(1));
        let mut turned = near[first.min(near.len())..].iter().chain(near);
        let found = turned.find(|near| near.node > END && self.current.visits(near.node))?;
        Some(found.node)
    }

    /// Removes some nodes in a row of which one is `seed`.
    fn take_string(&mut self, seed: u32) {
        let length = self.random.random_range(1..=LONGEST_STRING);
        let back = self.random.random_range(0..length);
        let mut at = seed;
        for _ in 0..back {
            match self.current.before(at) {
                Some(before) if before != START => at = before,
                _ => break,
            }
        }
        for _ in 0..length {
            let Some(next) = self.current.after(at).filter(|_| at != END) else {
                return;
            };
            if self.current.remove(at, self.space) {
                self.removed.push(at);
            }
            at = next;
        }
    }

    /// Makes a node that is not on the tour a candidate.
    fn consider(&mut self, node: u32) {
        let is_new = self.tried_at[node as usize] != self.changes;
        if is_new && node > END && !self.current.visits(node) {
            self.tried_at[node as usize] = self.changes;
            self.candidates.push((0.0, node));
        }
    }

    /// Inserts candidates where they gain most, in random order or those of most worth first.
    fn rebuild(&mut self) {
        let is_random = self.random.random_range(0..2_u32) == 0;
        let mut candidates = std::mem::take(&mut self.candidates);
        for (key, node) in &mut candidates {
            let draw: f64 = self.random.random();
            *key = if is_random {
                draw
            } else {
                let worth = self
                    .best_place(*node, 0.0)
                    .map_or(f64::MIN, |(worth, ..)| worth);
                -worth * (0.5 + draw)
            };
        }
        candidates.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let forced = self.forced.map(|node| (0.0, node));
        for &(_, node) in forced.iter().chain(&candidates) {
            if !self.current.visits(node)
                && let Some((worth, after, detour)) = self.best_place(node, BLINK)
                && (worth > 0.0 || self.forced == Some(node))
            {
                self.current.insert(node, after, detour);
            }
        }
        self.candidates = candidates;
    }

    /// The place of most worth beside the neighbours of a node: the worth, the node before, and what the
    /// insertion adds. A share of places is passed over.
    fn best_place(&mut self, node: u32, blink: f64) -> Option<(f64, u32, ProfitTime)> {
        let space = &*self.space;
        let left_s = space.time_available_s - self.current.sum().time_s;
        let mut best: Option<(f64, u32, ProfitTime)> = None;
        let mut offer = |before: u32, after: u32, legs: ProfitTime| {
            let detour = legs - space.arc(before, after);
            let worth = detour.worth(space.price);
            if detour.time_s <= left_s && best.is_none_or(|(most, ..)| worth > most) {
                best = Some((worth, before, detour));
            }
        };
        for near in space.near::<true>(node) {
            if blink > 0.0 && self.random.random::<f64>() < blink {
                continue;
            }
            if self.current.visits(near.node)
                && let Some(before) = self.current.before(near.node)
            {
                offer(before, near.node, space.arc(before, node) + near.arc);
            }
        }
        for near in space.near::<false>(node) {
            if blink > 0.0 && self.random.random::<f64>() < blink {
                continue;
            }
            if self.current.visits(near.node)
                && let Some(after) = self.current.after(near.node)
            {
                offer(near.node, after, near.arc + space.arc(node, after));
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, spaces};
    use auv_graph::{NodeId, Terrain};
    use auv_planning::{Budget, RouteProblem};
    use auv_types::Seed;

    #[test]
    fn the_best_tour_gains_stays_in_time_and_visits_no_node_twice() {
        let network = Terrain::figure12().draw(Seed(1)).unwrap().network;
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), 9_000.0);
        let objective = TourObjective::new(&problem).unwrap();
        for mut space in spaces() {
            let first = random_tour(&space, 3);
            let mut run = Run::new(Seed(4), Budget::evaluations(3_000));
            let annealing = Annealing::new(&mut space, objective, &run, first.clone());
            let (best, stop) = annealing.run(&mut run);
            assert_eq!(stop, StopReason::EvaluationsSpent);
            assert!(
                best.profit > 1.05 * first.profit,
                "{} {}",
                best.profit,
                first.profit
            );
            assert!(best.time_s <= space.time_available_s);
            assert_eq!(best, Tour::new(best.nodes.clone(), &space));
            assert_eq!(
                (best.nodes.first(), best.nodes.last()),
                (Some(&START), Some(&END))
            );
            let mut once = best.nodes.clone();
            once.sort_unstable();
            once.dedup();
            assert_eq!(once.len(), best.nodes.len());
        }
    }
}
