//! Multipliers of the rows of the linear relaxation, and the bound that they prove.

use crate::cut::Cut;
use crate::links::{Link, Links};

/// What the rows of the linear relaxation are worth. Any values give a bound, so it does not depend on
/// how precisely they were computed.
#[derive(Clone, Debug)]
pub(crate) struct Multipliers {
    pub(crate) per_second: f64,
    /// Of a link at each node: two of them at most, one at start and destination.
    pub(crate) touch: Vec<f64>,
    /// Of an arrival less a departure, by node; empty for links that are alike both ways.
    pub(crate) balance: Vec<f64>,
    /// What cuts charge for a link at each node.
    toll: Vec<f64>,
    /// The values of the cuts in use.
    rim: Vec<f64>,
    /// What cuts charge for their teeth, by link.
    tooth: Vec<((usize, usize), f64)>,
    /// What cuts pay at most.
    paid: f64,
    /// By node, the cuts in use whose sets have it, as bits in words.
    inside: Vec<u64>,
    words: usize,
}

impl Multipliers {
    pub(crate) fn new(
        per_second: f64,
        touch: Vec<f64>,
        balance: Vec<f64>,
        cuts: &[(f64, &Cut)],
    ) -> Self {
        let nodes = touch.len();
        let words = cuts.len().div_ceil(64);
        let mut toll = vec![0.0; nodes];
        let mut tooth = Vec::new();
        let mut paid = 0.0;
        let mut inside = vec![0; nodes * words];
        for (i, &(value, cut)) in cuts.iter().enumerate() {
            if let Some(node) = cut.node() {
                toll[node] += value;
            }
            tooth.extend(cut.teeth().iter().map(|&ends| (ends, 2.0 * value)));
            let side = if value > 0.0 {
                cut.right()
            } else {
                -cut.most_crossings()
            };
            paid += value * side;
            for v in (0..nodes).filter(|&v| cut.has(v)) {
                inside[v * words + i / 64] |= 1 << (i % 64);
            }
        }
        tooth.sort_by_key(|&(ends, _)| ends);
        Self {
            per_second,
            touch,
            balance,
            toll,
            rim: cuts.iter().map(|&(value, _)| value).collect(),
            tooth,
            paid,
            inside,
            words,
        }
    }

    /// What the cuts charge for a link: negative if they pay for it.
    pub(crate) fn toll(&self, (u, v): (usize, usize)) -> f64 {
        let mut toll = self.toll[u] + self.toll[v];
        for word in 0..self.words {
            let mut crossed =
                self.inside[u * self.words + word] ^ self.inside[v * self.words + word];
            while crossed != 0 {
                toll -= self.rim[64 * word + crossed.trailing_zeros() as usize];
                crossed &= crossed - 1;
            }
        }
        let first = self.tooth.partition_point(|&(ends, _)| ends < (u, v));
        let own = self.tooth[first..]
            .iter()
            .take_while(|&&(ends, _)| ends == (u, v));
        toll + own.map(|&(_, value)| value).sum::<f64>()
    }

    /// The weight of a link less what all rows charge for it.
    pub(crate) fn reduced(&self, link: &Link) -> f64 {
        let (u, v) = link.ends;
        let balance = match self.balance.is_empty() {
            true => 0.0,
            false => self.balance[u] - self.balance[v],
        };
        link.weight
            - self.per_second * link.time_s
            - (self.touch[u] + self.touch[v])
            - self.toll(link.ends)
            - balance
    }

    /// A bound of the weight of every route over some links, whose reduced weights are given.
    ///
    /// The sum of positive reduced weights over a route is at most that over all links, and at most half
    /// of that over the two best links of each node.
    pub(crate) fn bound(&self, links: &Links, priced: &[(u32, f64)], scope: &Scope<'_>) -> f64 {
        let mut sum = 0.0;
        let mut forced = 0.0;
        let mut best = vec![[0.0_f64; 2]; self.touch.len()];
        for &(link, reduced) in priced {
            if scope.is_used(link) {
                forced += reduced;
                continue;
            }
            if reduced <= 0.0 {
                continue;
            }
            sum += reduced;
            let (u, v) = links.all[link as usize].ends;
            for node in [u, v] {
                let [first, second] = &mut best[node];
                if reduced > *first {
                    (*first, *second) = (reduced, *first);
                } else if reduced > *second {
                    *second = reduced;
                }
            }
        }
        (best[scope.ends.0][1], best[scope.ends.1][1]) = (0.0, 0.0);
        let halves = 0.5 * best.iter().map(|[a, b]| a + b).sum::<f64>();
        let (credit, size) = self.credit(scope);
        let all = credit + forced + sum.min(halves);
        // More than all rounding errors.
        all + 1e-12 * (size + forced.abs() + sum)
    }

    /// The most that the rows pay for a route, and the sum of the sizes of its terms.
    fn credit(&self, scope: &Scope<'_>) -> (f64, f64) {
        let time = (self.per_second * scope.limit_s).max(0.0);
        let of_node = |(v, &touch): (usize, &f64)| {
            if v == scope.ends.0 || v == scope.ends.1 {
                touch
            } else if scope.is_visited(v) {
                2.0 * touch
            } else {
                (2.0 * touch).max(0.0)
            }
        };
        let nodes = self.touch.iter().enumerate().map(of_node);
        let terms = nodes.chain([time, self.paid]);
        terms.fold((0.0, 0.0), |(credit, size), term| {
            (credit + term, size + f64::abs(term))
        })
    }
}

/// The routes that a bound is for.
pub(crate) struct Scope<'a> {
    pub(crate) ends: (usize, usize),
    pub(crate) limit_s: f64,
    /// Nodes and links that all these routes visit and use.
    pub(crate) visited: &'a [usize],
    pub(crate) used: &'a [u32],
}

impl Scope<'_> {
    fn is_visited(&self, node: usize) -> bool {
        self.visited.contains(&node)
    }

    fn is_used(&self, link: u32) -> bool {
        self.used.contains(&link)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::Kind;
    use crate::digraph::Digraph;
    use crate::testing::{digraph, routes};
    use auv_types::{Seed, rand::RngExt};

    fn random(graph: &Digraph, seed: u64, is_balanced: bool) -> Multipliers {
        let random = &mut Seed(seed).stream(2);
        let n = graph.num_nodes();
        let cuts: Vec<_> = (0..4)
            .map(|_| {
                let members: Vec<usize> = (1..n - 1).filter(|_| random.random_bool(0.5)).collect();
                (random.random_range(-0.5..1.5), members)
            })
            .filter(|(_, members)| !members.is_empty())
            .map(|(value, members): (f64, Vec<usize>)| {
                (value, Cut::new(n, &members, Kind::Node(members[0])))
            })
            .collect();
        let cuts: Vec<_> = cuts.iter().map(|(value, cut)| (*value, cut)).collect();
        let touch = (0..n).map(|_| random.random_range(-0.3..1.0)).collect();
        let mut balance: Vec<f64> = (0..n).map(|_| random.random_range(-0.5..0.5)).collect();
        (balance[0], balance[n - 1]) = (0.0, 0.0);
        if !is_balanced {
            balance.clear();
        }
        Multipliers::new(random.random_range(-1e-4..1e-3), touch, balance, &cuts)
    }

    #[test]
    fn no_route_weighs_more_than_the_bound_of_any_multipliers() {
        for seed in 0..60 {
            let limit_s = 8_000.0;
            let graph = digraph(7, 34, seed, limit_s);
            let links = Links::new(&graph);
            let multipliers = random(&graph, seed, !seed.is_multiple_of(3));
            let all = (0..).zip(&links.all);
            let priced: Vec<_> = all
                .map(|(i, link)| (i, multipliers.reduced(link)))
                .collect();
            let ends = (graph.start, graph.destination);
            let whole = Scope {
                ends,
                limit_s,
                visited: &[],
                used: &[],
            };
            let bound = multipliers.bound(&links, &priced, &whole);
            for arcs in routes(&graph, limit_s) {
                let weight: f64 = arcs.iter().map(|&arc| graph.weight[arc]).sum();
                assert!(weight <= bound, "seed {seed}: {weight} {bound}");
                // So does that of the routes that visit its nodes, or use its first link.
                let visited: Vec<_> = arcs
                    .iter()
                    .map(|&arc| graph.head[arc])
                    .filter(|&v| v != ends.1)
                    .collect();
                let used = [links.of_arc[arcs[0]]];
                for (visited, used) in [(&visited[..], &[][..]), (&[][..], &used[..])] {
                    let part = Scope {
                        ends,
                        limit_s,
                        visited,
                        used,
                    };
                    assert!(weight <= multipliers.bound(&links, &priced, &part));
                }
            }
        }
    }
}
