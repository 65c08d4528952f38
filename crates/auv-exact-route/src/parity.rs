//! The search for violated inequalities of parity.

use crate::cut::{Cut, Kind};
use crate::flow::Flows;
use crate::support::{LEAST_VIOLATION, Support, SupportLink};

/// Violated inequalities of parity with their violations, for the sets that grow when links are merged that are used
/// in part: quick, but not all are found.
pub(crate) fn loosely_even(support: &Support<'_>) -> Vec<(f64, Cut)> {
    let sets = support.merged_sets(|link| (0.01..0.99).contains(&link.value));
    sets.iter().filter_map(|set| of_set(support, set)).collect()
}

/// Violated inequalities of parity with their violations, for minimum cuts of the distances of links from whole
/// numbers: a set with a violated inequality has a rim shorter than 1 (Letchford, Reinelt and Theis, SIAM Journal on
/// Discrete Mathematics 22(4), 2008). The cuts between all nodes come from one less than there are nodes (Gusfield,
/// SIAM Journal on Computing 19(1), 1990).
pub(crate) fn broken_parity(support: &Support<'_>) -> Vec<(f64, Cut)> {
    let distance = |link: &SupportLink| SupportLink {
        ends: link.ends,
        value: link.value.min(1.0 - link.value),
    };
    let links = support.links.iter().map(distance);
    let links: Vec<_> = links.filter(|link| link.value > LEAST_VIOLATION).collect();
    let mut nodes: Vec<_> = links
        .iter()
        .flat_map(|link| [link.ends.0, link.ends.1])
        .collect();
    nodes.sort_unstable();
    nodes.dedup();
    let Some(&first) = nodes.first() else {
        return Vec::new();
    };
    let flows = Flows::new(support.nodes, links.into_iter());
    // The node from which each is yet to be cut.
    let mut from = vec![first; support.nodes];
    let mut found = Vec::new();
    for (i, &node) in nodes.iter().enumerate().skip(1) {
        let Some(set) = flows.cut(node, from[node], 1.0) else {
            continue;
        };
        let other = from[node];
        for &v in &nodes[i + 1..] {
            if from[v] == other && set.contains(&v) {
                from[v] = node;
            }
        }
        found.extend(of_set(support, &set));
    }
    found
}

/// The inequality of a set that is violated most, if one is.
fn of_set(support: &Support<'_>, members: &[usize]) -> Option<(f64, Cut)> {
    let mut cut = Cut::new(support.nodes, members, Kind::Teeth(Vec::new()));
    let rim: Vec<_> = support
        .links
        .iter()
        .filter(|link| cut.crosses(link.ends))
        .collect();
    let teeth = rim.iter().filter(|link| link.value > 0.5);
    let mut teeth: Vec<_> = teeth.map(|link| link.ends).collect();
    // How far the links are from all teeth and nothing else: less than 1 is a violation.
    let mut away: f64 = rim
        .iter()
        .map(|link| link.value.min(1.0 - link.value))
        .sum();
    let has_one_end = cut.has(support.ends.0) != cut.has(support.ends.1);
    if (teeth.len() % 2 == 1) == has_one_end {
        let from_half = |link: &SupportLink| (link.value - 0.5).abs();
        let link = rim
            .iter()
            .min_by(|a, b| from_half(a).total_cmp(&from_half(b)))?;
        away += 2.0 * from_half(link);
        match teeth.iter().position(|&ends| ends == link.ends) {
            Some(at) => {
                teeth.swap_remove(at);
            }
            None => teeth.push(link.ends),
        }
    }
    teeth.sort_unstable();
    let is_violated = !teeth.is_empty() && away < 1.0 - 10.0 * LEAST_VIOLATION;
    cut.kind = Kind::Teeth(teeth);
    is_violated.then_some((1.0 - away, cut))
}
