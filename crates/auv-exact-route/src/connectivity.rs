//! The search for violated inequalities of connectivity.
//!
//! A route that visits node `k` crosses the rim of every set of nodes with `k`, but neither start nor
//! destination, as often as it touches `k` (generalised subtour elimination: Fischetti, Salazar and Toth,
//! INFORMS Journal on Computing 10(2), 1998).

use crate::cut::{Cut, Kind};
use crate::flow::Flows;
use crate::support::{LEAST_VIOLATION, Support, SupportLink};

/// Violated inequalities with their violations, of the ends of a link and of the sets that grow when links are
/// merged: quick, but not all are found.
pub(crate) fn loosely_connected(support: &Support<'_>) -> Vec<(f64, Cut)> {
    let touch = support.touch();
    let has_no_end = |(u, v): (usize, usize)| !support.is_end(u) && !support.is_end(v);
    let mut sets = support.merged_sets(|link| has_no_end(link.ends));
    for link in support.links.iter().filter(|link| has_no_end(link.ends)) {
        let (u, v) = link.ends;
        if link.value > 0.5 * touch[u].min(touch[v]) + 0.5 * LEAST_VIOLATION {
            sets.push(vec![u, v]);
        }
    }
    of_sets(support, &sets, &touch)
}

/// Violated inequalities with their violations, of minimum cuts, which find one for every node that has one.
pub(crate) fn disconnected(support: &Support<'_>) -> Vec<(f64, Cut)> {
    let touch = support.touch();
    // Start and destination count as one node.
    let sink = support.ends.0;
    let merged = |v: usize| if v == support.ends.1 { sink } else { v };
    let links = support.links.iter().map(|link| SupportLink {
        ends: (merged(link.ends.0), merged(link.ends.1)),
        value: link.value,
    });
    let flows = Flows::new(support.nodes, links);
    let nodes = (0..support.nodes).filter(|&v| touch[v] > 0.01 && !support.is_end(v));
    let sets = nodes.filter_map(|node| flows.cut(node, sink, touch[node] - LEAST_VIOLATION));
    of_sets(support, &sets.collect::<Vec<_>>(), &touch)
}

fn of_sets(support: &Support<'_>, sets: &[Vec<usize>], touch: &[f64]) -> Vec<(f64, Cut)> {
    let cuts = sets.iter().filter_map(|set| of_set(support, set, touch));
    cuts.collect()
}

/// The inequality of a set and its node that is touched most, if violated.
fn of_set(support: &Support<'_>, members: &[usize], touch: &[f64]) -> Option<(f64, Cut)> {
    let most = |a: &&usize, b: &&usize| touch[**a].total_cmp(&touch[**b]).then(b.cmp(a));
    let &node = members.iter().max_by(most)?;
    let cut = Cut::new(support.nodes, members, Kind::Node(node));
    let rim = support.links.iter().filter(|link| cut.crosses(link.ends));
    let violation = touch[node] - rim.map(|link| link.value).sum::<f64>();
    (violation > LEAST_VIOLATION).then_some((violation, cut))
}
