//! First routes: greedy ones, each with its own noise, and scattered ones.

use super::field::{END, Field, START};
use super::tour::Tour;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// Appends the arc of best noisy profit per time as long as the quickest way to the destination
/// stays affordable and free; in larger fields an arc to a near neighbour where any is left.
pub(crate) fn grow(field: &Field, noise: f64, random: &mut ChaCha8Rng) -> Tour {
    let (n, home) = (field.len(), &field.home);
    let mut visited = vec![false; n];
    let mut nodes = vec![START];
    visited[START as usize] = true;
    let (mut at, mut time_s) = (START, 0.0);
    let is_free = |node: u32, visited: &[bool]| {
        let mut at = node;
        while at != END && !visited[at as usize] {
            at = home[at as usize].1;
        }
        at == END
    };
    while at != END {
        let mut best: Option<(f64, u32)> = None;
        let consider = |head: u32, random: &mut ChaCha8Rng, best: &mut Option<(f64, u32)>| {
            let arc = field.arc(at, head);
            if visited[head as usize]
                || head == END
                || time_s + arc.time_s + home[head as usize].0 > field.time_available_s
            {
                return;
            }
            let factor = 1.0 + noise * random.random_range(-1.0..1.0);
            let score = (arc.profit * factor + 1e-9) / arc.time_s.max(1e-9);
            if best.is_none_or(|(most, _)| score > most) && is_free(head, &visited) {
                *best = Some((score, head));
            }
        };
        if !field.is_small() {
            let near = field.near::<true>(at).iter();
            near.for_each(|near| consider(near.node, random, &mut best));
        }
        if best.is_none() {
            (2..n as u32).for_each(|head| consider(head, random, &mut best));
        }
        let next = best.map_or(home[at as usize].1, |(_, head)| head);
        time_s += field.arc(at, next).time_s;
        visited[next as usize] = true;
        nodes.push(next);
        at = next;
        if best.is_none() {
            while at != END {
                at = home[at as usize].1;
                nodes.push(at);
            }
        }
    }
    Tour::new(nodes, field)
}

/// Inserts nodes in a random order, each where that takes least time, until one is not in time: a
/// route all over the field, where greedy ones crowd. Stretches of little profit are left to the
/// local search.
///
/// Complexity: O(k^2) for a route of k nodes.
pub(crate) fn scatter(field: &Field, random: &mut ChaCha8Rng) -> Tour {
    /// Share of the time available that is used.
    const SHARE: f64 = 0.95;
    let Tour {
        mut nodes, time_s, ..
    } = field.quickest();
    let mut left_s = SHARE * field.time_available_s - time_s;
    let mut is_on = vec![false; field.len()];
    nodes.iter().for_each(|&node| is_on[node as usize] = true);
    let mut order: Vec<u32> = (0..field.len() as u32)
        .filter(|&node| !is_on[node as usize])
        .collect();
    while !order.is_empty() {
        let node = order.swap_remove(random.random_range(0..order.len() as u64) as usize);
        let detour_s = |pair: &[u32]| {
            let way = field.arc_to(node, pair[0]) + field.arc(node, pair[1]);
            way.time_s - field.arc(pair[0], pair[1]).time_s
        };
        let detours = nodes.windows(2).map(detour_s).enumerate();
        let Some((after, least_s)) = detours.min_by(|a, b| a.1.total_cmp(&b.1)) else {
            break;
        };
        if least_s > left_s {
            break;
        }
        left_s -= least_s;
        nodes.insert(after + 1, node);
    }
    Tour::new(nodes, field)
}
