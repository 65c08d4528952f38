//! The search for violated inequalities of parity.

use crate::cut::{Cut, Kind};
use crate::support::{LEAST_VIOLATION, Support, SupportLink};

/// Violated inequalities of parity for the sets that grow when links are merged that are used in part, with their
/// violations.
pub(crate) fn broken_parity(support: &Support<'_>) -> Vec<(f64, Cut)> {
    let sets = support.merged_sets(|link| (0.01..0.99).contains(&link.value));
    sets.iter().filter_map(|set| of_set(support, set)).collect()
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
