//! Short lists of promising neighbours.

use super::field::{MISSING, ProfitTime};

/// A promising neighbour and the arc to it or from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    pub(crate) node: u32,
    pub(crate) leg: ProfitTime,
}

/// Bounds of all arcs out of a node, or of all into it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Least time.
    pub(crate) time_s: f64,
    /// Greatest worth at the price at which neighbours were ranked.
    pub(crate) worth: f64,
}

/// Up to `width` neighbours of each node, best first.
#[derive(Default)]
pub(super) struct Lists {
    width: usize,
    counts: Vec<u32>,
    near: Vec<Near>,
    pub(super) reach: Vec<Reach>,
}

impl Lists {
    pub(super) fn new(nodes: usize, width: usize) -> Self {
        let nobody = Near {
            node: 0,
            leg: MISSING,
        };
        let nowhere = Reach {
            time_s: f64::INFINITY,
            worth: f64::NEG_INFINITY,
        };
        Self {
            width,
            counts: vec![0; nodes],
            near: vec![nobody; nodes * width],
            reach: vec![nowhere; nodes],
        }
    }

    pub(super) fn of(&self, node: u32) -> &[Near] {
        let begin = node as usize * self.width;
        &self.near[begin..begin + self.counts[node as usize] as usize]
    }

    /// Lists a node's best inner neighbours and, in its place, an end of the route.
    pub(super) fn list(
        &mut self,
        node: u32,
        best: &Best,
        end: u32,
        leg: impl Fn(u32) -> ProfitTime,
    ) {
        let at = node as usize;
        let near = |node: u32| Near {
            node,
            leg: leg(node),
        };
        let last = near(end);
        let worth = best.worth(last.leg);
        let place = best.worths.partition_point(|&other| other > worth);
        let ahead = best.nodes[..place].iter().map(|&node| near(node));
        let after = best.nodes[place..].iter().map(|&node| near(node));
        let own = (worth > f64::NEG_INFINITY).then_some(last);
        let listed = &mut self.near[at * self.width..][..self.width];
        for (slot, near) in listed.iter_mut().zip(ahead.chain(own).chain(after)) {
            *slot = near;
            self.counts[at] += 1;
        }
        self.reach[at] = Reach {
            time_s: best.least_s.min(last.leg.time_s),
            worth: best
                .worths
                .first()
                .copied()
                .unwrap_or(f64::NEG_INFINITY)
                .max(worth),
        };
    }
}

/// The best inner neighbours of one node.
pub(super) struct Best {
    width: usize,
    price: f64,
    /// Best first; of equal ones the lower.
    nodes: Vec<u32>,
    worths: Vec<f64>,
    /// Least time to any.
    least_s: f64,
}

impl Best {
    pub(super) fn new(width: usize, price: f64) -> Self {
        Self {
            width,
            price,
            nodes: Vec::with_capacity(width + 1),
            worths: Vec::with_capacity(width + 1),
            least_s: f64::INFINITY,
        }
    }

    fn worth(&self, leg: ProfitTime) -> f64 {
        leg.profit - self.price * leg.time_s
    }

    /// Finds the best of the nodes from `first` on, given the legs to them.
    pub(super) fn find(&mut self, first: u32, legs: &[ProfitTime]) {
        /// Legs looked at together: few of them are news.
        const BLOCK: usize = 8;
        self.nodes.clear();
        self.worths.clear();
        self.least_s = f64::INFINITY;
        let mut least = f64::NEG_INFINITY;
        for (block, legs) in legs.chunks(BLOCK).enumerate() {
            let is_news =
                |leg: &ProfitTime| (leg.time_s < self.least_s) | (self.worth(*leg) > least);
            if !legs.iter().fold(false, |any, leg| any | is_news(leg)) {
                continue;
            }
            for (i, &leg) in legs.iter().enumerate() {
                self.least_s = self.least_s.min(leg.time_s);
                let worth = self.worth(leg);
                if worth > least {
                    let before = self.worths.iter().rev().take_while(|&&other| worth > other);
                    let place = self.worths.len() - before.count();
                    self.worths.insert(place, worth);
                    self.nodes.insert(place, first + (block * BLOCK + i) as u32);
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
