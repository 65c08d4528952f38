//! First routes: greedy ones, each with its own noise.

use super::field::{END, Field, START};
use super::tour::Tour;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// Most nodes of a field in which every greedy choice is among all of them.
const SMALL: usize = 64;

/// Appends the arc of best noisy profit per time as long as the quickest way to the destination
/// stays affordable and free; in larger fields an arc to a near neighbour where any is left.
/// `noise` 0 is the plain greedy route.
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
        if noise > 0.0 && n > SMALL {
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
