//! Short lists of promising neighbours: the local search tries no others.

use super::profit_time::ProfitTime;

/// A neighbour of a node, and the arc to it or from it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Neighbour {
    pub(crate) node: u32,
    pub(crate) arc: ProfitTime,
}

/// Bounds over all arcs out of a node, or over all arcs into it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ArcBounds {
    /// Least time.
    pub(crate) time_s: f64,
    /// Greatest worth at the price at which neighbours were ranked.
    pub(crate) worth: f64,
}

/// Up to `width` neighbours of each node, the best first.
#[derive(Default)]
pub(super) struct NeighbourLists {
    width: usize,
    counts: Vec<u32>,
    neighbours: Vec<Neighbour>,
    bounds: Vec<ArcBounds>,
}

impl NeighbourLists {
    /// Empty lists.
    pub(super) fn new(nodes: usize, width: usize) -> Self {
        let no_neighbour = Neighbour {
            node: 0,
            arc: ProfitTime::MISSING,
        };
        let no_arc = ArcBounds {
            time_s: f64::INFINITY,
            worth: f64::NEG_INFINITY,
        };
        Self {
            width,
            counts: vec![0; nodes],
            neighbours: vec![no_neighbour; nodes * width],
            bounds: vec![no_arc; nodes],
        }
    }

    pub(super) fn of(&self, node: u32) -> &[Neighbour] {
        let first = node as usize * self.width;
        &self.neighbours[first..first + self.counts[node as usize] as usize]
    }

    pub(super) fn bounds(&self, node: u32) -> ArcBounds {
        self.bounds[node as usize]
    }

    /// Fills the list of a node: its best inner neighbours and, at its rank among them, `end`, an end
    /// of the route. `arc` gives the arc between the node and another.
    pub(super) fn fill(
        &mut self,
        node: u32,
        best: &BestNeighbours,
        end: u32,
        arc: impl Fn(u32) -> ProfitTime,
    ) {
        let at = node as usize;
        let neighbour = |node: u32| Neighbour {
            node,
            arc: arc(node),
        };
        let last = neighbour(end);
        let worth = last.arc.worth(best.price);
        let rank = best.worths.partition_point(|&other| other > worth);
        let better = best.nodes[..rank].iter().map(|&node| neighbour(node));
        let worse = best.nodes[rank..].iter().map(|&node| neighbour(node));
        let own = (worth > f64::NEG_INFINITY).then_some(last);
        let list = &mut self.neighbours[at * self.width..][..self.width];
        for (slot, neighbour) in list.iter_mut().zip(better.chain(own).chain(worse)) {
            *slot = neighbour;
            self.counts[at] += 1;
        }
        let best_worth = best.worths.first().copied().unwrap_or(f64::NEG_INFINITY);
        self.bounds[at] = ArcBounds {
            time_s: best.least_s.min(last.arc.time_s),
            worth: best_worth.max(worth),
        };
    }
}

/// The best inner neighbours of one node.
pub(super) struct BestNeighbours {
    width: usize,
    price: f64,
    /// The best first; among equal ones the lower node first.
    nodes: Vec<u32>,
    worths: Vec<f64>,
    /// Least time of any arc, also of those not among the best.
    least_s: f64,
}

impl BestNeighbours {
    pub(super) fn new(width: usize, price: f64) -> Self {
        Self {
            width,
            price,
            nodes: Vec::with_capacity(width + 1),
            worths: Vec::with_capacity(width + 1),
            least_s: f64::INFINITY,
        }
    }

    /// Finds the best of consecutive nodes, the first of which is `first`, given the arcs to them.
    pub(super) fn find(&mut self, first: u32, arcs: &[ProfitTime]) {
        /// Arcs tested together: most blocks contain none that matters.
        const BLOCK: usize = 8;
        self.nodes.clear();
        self.worths.clear();
        self.least_s = f64::INFINITY;
        let mut least = f64::NEG_INFINITY;
        for (block, arcs) in arcs.chunks(BLOCK).enumerate() {
            let matters =
                |arc: &ProfitTime| (arc.time_s < self.least_s) | (arc.worth(self.price) > least);
            if !arcs.iter().fold(false, |any, arc| any | matters(arc)) {
                continue;
            }
            for (i, &arc) in arcs.iter().enumerate() {
                self.least_s = self.least_s.min(arc.time_s);
                let worth = arc.worth(self.price);
                if worth > least {
                    let below = self.worths.iter().rev().take_while(|&&other| worth > other);
                    let rank = self.worths.len() - below.count();
                    self.worths.insert(rank, worth);
                    self.nodes.insert(rank, first + (block * BLOCK + i) as u32);
                    self.worths.truncate(self.width);
                    self.nodes.truncate(self.width);
                    if self.worths.len() == self.width {
                        least = self.worths[self.width - 1];
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Seed, rand::RngExt};

    /// Arcs of random profit and time, some of them missing, some equal.
    fn arcs(seed: u64, count: usize) -> Vec<ProfitTime> {
        let random = &mut Seed(seed).stream(0);
        let draw = |_| match random.random_range(0..5_u32) {
            0 => ProfitTime::MISSING,
            _ => ProfitTime {
                profit: f64::from(random.random_range(0..6_u32)),
                time_s: f64::from(random.random_range(1..9_u32)),
            },
        };
        (0..count).map(draw).collect()
    }

    #[test]
    fn the_best_neighbours_are_those_of_a_full_sort() {
        for seed in 0..200 {
            let arcs = arcs(seed, 37);
            let (price, width) = (0.3, 6);
            let mut best = BestNeighbours::new(width, price);
            best.find(2, &arcs);
            let mut sorted: Vec<u32> = (0..arcs.len() as u32).collect();
            let worth = |i: u32| arcs[i as usize].worth(price);
            sorted.sort_by(|&a, &b| worth(b).total_cmp(&worth(a)).then(a.cmp(&b)));
            sorted.retain(|&i| worth(i) > f64::NEG_INFINITY);
            let expected: Vec<u32> = sorted.iter().take(width).map(|i| i + 2).collect();
            assert_eq!(best.nodes, expected, "seed {seed}");
            let least_s = arcs
                .iter()
                .map(|arc| arc.time_s)
                .fold(f64::INFINITY, f64::min);
            assert_eq!(best.least_s, least_s);
        }
    }

    #[test]
    fn the_end_of_the_route_takes_its_rank_in_the_list() {
        let arc = |profit| ProfitTime {
            profit,
            time_s: 1.0,
        };
        // Profits of nodes 1 (the end) to 4.
        let profits = [0.0, 5.0, 7.0, 6.0, 1.0];
        let inner: Vec<_> = profits[2..].iter().map(|&profit| arc(profit)).collect();
        let mut best = BestNeighbours::new(3, 1.0);
        best.find(2, &inner);
        let mut lists = NeighbourLists::new(5, 3);
        lists.fill(0, &best, 1, |node| arc(profits[node as usize]));
        let nodes: Vec<u32> = lists.of(0).iter().map(|near| near.node).collect();
        assert_eq!(nodes, [2, 3, 1]);
        let bounds = ArcBounds {
            time_s: 1.0,
            worth: 6.0,
        };
        assert_eq!(lists.bounds(0), bounds);
        assert!(lists.of(3).is_empty());
    }

    #[test]
    fn a_missing_arc_to_the_end_is_not_listed() {
        let mut best = BestNeighbours::new(3, 1.0);
        best.find(2, &[ProfitTime::MISSING]);
        let mut lists = NeighbourLists::new(3, 3);
        lists.fill(0, &best, 1, |_| ProfitTime::MISSING);
        assert!(lists.of(0).is_empty() && lists.bounds(0).time_s.is_infinite());
    }
}
