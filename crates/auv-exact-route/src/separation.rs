//! The choice of violated inequalities.

use crate::connectivity::{disconnected, loosely_connected};
use crate::cut::Cut;
use crate::parity::{broken_parity, loosely_even};
use crate::support::{LEAST_VIOLATION, Support, SupportLink};

/// What a new solution adds to the mean of all.
const SHARE: f64 = 0.1;
/// Values of the mean below this are left out.
const LEAST_VALUE: f64 = 1e-3;

/// With so many inequalities from the quick searches, those by minimum cuts wait.
const ENOUGH: usize = 10;

/// Searches at points between the mean of all solutions and the present one: what is violated there cuts deeper
/// (in-out separation, Ben-Ameur and Neto 2007).
#[derive(Debug)]
pub(crate) struct Separation {
    /// The mean value by link; empty before the first solution.
    mean: Vec<f64>,
}

impl Separation {
    pub(crate) fn new() -> Self {
        Self { mean: Vec::new() }
    }

    /// Inequalities that a solution violates. `ends` gives the nodes of each link.
    pub(crate) fn violated(
        &mut self,
        (nodes, route_ends): (usize, (usize, usize)),
        ends: &[(usize, usize)],
        solution: &[(u32, f64)],
    ) -> Vec<Cut> {
        let links: Vec<_> = support_links(ends, solution.iter().copied());
        let violated = |links: &[SupportLink]| {
            let ends = route_ends;
            violated(&Support { nodes, ends, links })
        };
        if self.mean.is_empty() {
            self.mean = vec![0.0; ends.len()];
            solution
                .iter()
                .for_each(|&(link, value)| self.mean[link as usize] = value);
            return violated(&links);
        }
        self.mean.iter_mut().for_each(|mean| *mean *= 1.0 - SHARE);
        solution
            .iter()
            .for_each(|&(link, value)| self.mean[link as usize] += SHARE * value);
        let mut middle: Vec<_> = self.mean.iter().map(|mean| 0.5 * mean).collect();
        solution
            .iter()
            .for_each(|&(link, value)| middle[link as usize] += 0.5 * value);
        let between = (0..).zip(middle).filter(|(_, value)| *value > LEAST_VALUE);
        let mut cuts = violated(&support_links(ends, between));
        cuts.retain(|cut| {
            let terms = links
                .iter()
                .map(|link| link.value * cut.coefficient(link.ends));
            terms.sum::<f64>() > cut.right() + LEAST_VIOLATION
        });
        if cuts.is_empty() {
            violated(&links)
        } else {
            cuts
        }
    }
}

fn support_links(
    ends: &[(usize, usize)],
    values: impl Iterator<Item = (u32, f64)>,
) -> Vec<SupportLink> {
    let links = values.map(|(link, value)| SupportLink {
        ends: ends[link as usize],
        value,
    });
    links.collect()
}

/// Inequalities that a fractional route violates, the most violated first, at most one for each node.
pub(crate) fn violated(support: &Support<'_>) -> Vec<Cut> {
    let mut cuts = loosely_connected(support);
    cuts.extend(loosely_even(support));
    cuts.extend(disconnected(support));
    cuts.extend(broken_parity(support));
    ranked(cuts, support.nodes)
}

/// The same from the quick searches alone, where they find enough.
pub(crate) fn violated_at_once(support: &Support<'_>) -> Vec<Cut> {
    let mut cuts = loosely_connected(support);
    cuts.extend(loosely_even(support));
    if cuts.len() < ENOUGH {
        return violated(support);
    }
    ranked(cuts, support.nodes)
}

fn ranked(mut cuts: Vec<(f64, Cut)>, most: usize) -> Vec<Cut> {
    cuts.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.cmp(&b.1)));
    cuts.dedup_by(|a, b| a.1 == b.1);
    cuts.truncate(most);
    cuts.into_iter().map(|(_, cut)| cut).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::{digraph, routes};
    use auv_types::{Seed, rand::RngExt};

    #[test]
    fn no_route_violates_a_cut_and_every_cut_is_violated() {
        let mut found = 0;
        for seed in 0..60 {
            let graph = digraph(8, 50, seed, 9_000.0);
            let random = &mut Seed(seed).stream(1);
            // The mean of some closed walks and routes: often in pieces.
            let mut links = Vec::new();
            for u in 0..8_usize {
                for v in u + 1..8 {
                    if random.random_bool(0.35) {
                        let value = f64::from(random.random_range(1..5_u8)) / 4.0;
                        links.push(SupportLink {
                            ends: (u, v),
                            value,
                        });
                    }
                }
            }
            let support = Support {
                nodes: 8,
                ends: (graph.start, graph.destination),
                links: &links,
            };
            for cut in violated(&support) {
                found += 1;
                let at = links
                    .iter()
                    .map(|link| link.value * cut.coefficient(link.ends));
                assert!(at.sum::<f64>() > cut.right());
                for arcs in routes(&graph, 9_000.0) {
                    let mut tail = graph.start;
                    let mut used = 0.0;
                    for arc in arcs {
                        let head = graph.head[arc];
                        used += cut.coefficient((tail.min(head), tail.max(head)));
                        tail = head;
                    }
                    assert!(used <= cut.right(), "{cut:?}");
                    assert!(used >= -cut.most_crossings());
                }
            }
        }
        assert!(found > 100, "{found}");
    }

    #[test]
    fn a_circle_apart_from_the_route_and_an_odd_comb_are_found() {
        let link = |u: usize, v: usize, value: f64| SupportLink {
            ends: (u, v),
            value,
        };
        let circle = [
            link(0, 1, 1.0),
            link(1, 5, 1.0),
            link(2, 3, 1.0),
            link(3, 4, 1.0),
            link(2, 4, 1.0),
        ];
        let cuts = violated(&Support {
            nodes: 6,
            ends: (0, 5),
            links: &circle,
        });
        assert!(
            cuts.iter()
                .any(|cut| cut.node().is_some() && [2, 3, 4].iter().all(|&v| cut.has(v)))
        );
        // Three links into a triangle of halves: two or none of them are in a route.
        let comb = [
            link(0, 1, 1.0),
            link(1, 2, 0.5),
            link(1, 3, 0.5),
            link(2, 3, 0.5),
            link(2, 4, 1.0),
            link(3, 5, 1.0),
            link(4, 5, 0.5),
            link(4, 6, 0.5),
            link(5, 6, 0.5),
        ];
        let cuts = violated(&Support {
            nodes: 7,
            ends: (0, 6),
            links: &comb,
        });
        assert!(cuts.iter().any(|cut| !cut.teeth().is_empty()), "{cuts:?}");
    }
}
