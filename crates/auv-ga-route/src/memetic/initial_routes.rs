//! Initial routes of a population, constructed with random choices in three ways: greedily, by
//! insertion around a few attractors, and by insertion all over the search space.

use super::search_space::{END, START, SearchSpace};
use super::tour::Tour;
use auv_planning::Deadline;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// Constructs a route in time. The number is the noise of its choices as a share of the profit. At
/// the deadline it ends with a shorter route.
pub(crate) type Construction = fn(&SearchSpace, f64, &mut ChaCha8Rng, Deadline<'_>) -> Tour;

/// The two constructions, used in turn, that suit a space in which the greedy route has `legs` legs.
///
/// Where routes are long, the part of the space that they serve matters first, so attractors choose
/// it. Insertion needs arcs between most nodes.
pub(crate) fn constructions(space: &SearchSpace, legs: usize) -> [Construction; 2] {
    const LONG: usize = 40;
    match legs > LONG {
        _ if space.is_small() => [greedy, greedy],
        // Insertion all over a large space would take as long as the whole search.
        _ if space.has_lists() => [greedy_elsewhere, greedy],
        true if space.is_dense => [attracted, scattered],
        true => [attracted, greedy],
        false => [scattered, greedy],
    }
}

/// Appends the arc of most noisy profit per second, as long as the quickest way from there to the
/// destination is in time and free, then follows that way. In larger spaces it prefers the listed
/// neighbours.
fn greedy(space: &SearchSpace, noise: f64, random: &mut ChaCha8Rng, _: Deadline<'_>) -> Tour {
    greedy_after(vec![START], space, noise, random)
}

/// The greedy route after a leg to a random node, where one is in time: the part of the space that it
/// serves may be worth a long way.
fn greedy_elsewhere(
    space: &SearchSpace,
    noise: f64,
    random: &mut ChaCha8Rng,
    _: Deadline<'_>,
) -> Tour {
    const ATTEMPTS: usize = 20;
    let is_in_time = |node: &u32| {
        let there_s = space.arc(START, *node).time_s;
        there_s + space.home[*node as usize].0 <= space.time_available_s
    };
    let mut nodes = (0..ATTEMPTS).map(|_| random.random_range(END + 1..space.len() as u32));
    let first = nodes.find(is_in_time);
    greedy_after(
        [START].into_iter().chain(first).collect(),
        space,
        noise,
        random,
    )
}

/// Goes on greedily after the first nodes of a route, from which the quickest way to the destination is free
/// and in time.
fn greedy_after(
    mut nodes: Vec<u32>,
    space: &SearchSpace,
    noise: f64,
    random: &mut ChaCha8Rng,
) -> Tour {
    let mut visited = vec![false; space.len()];
    nodes.iter().for_each(|&node| visited[node as usize] = true);
    let (mut at, mut time_s) = (nodes[nodes.len() - 1], space.sum(&nodes).time_s);
    while let Some(next) = greedy_step(space, (at, time_s), &visited, noise, random) {
        time_s += space.arc(at, next).time_s;
        visited[next as usize] = true;
        nodes.push(next);
        at = next;
    }
    while at != END {
        at = space.home[at as usize].1;
        nodes.push(at);
    }
    Tour::new(nodes, space)
}

/// The node of most noisy profit per second after `at`, reached at `time_s`.
fn greedy_step(
    space: &SearchSpace,
    (at, time_s): (u32, f64),
    visited: &[bool],
    noise: f64,
    random: &mut ChaCha8Rng,
) -> Option<u32> {
    let mut best = None;
    let mut consider = |best: &mut Option<(f64, u32)>, head: u32| {
        let arc = space.arc(at, head);
        if visited[head as usize]
            || head == END
            || time_s + arc.time_s + space.home[head as usize].0 > space.time_available_s
        {
            return;
        }
        let factor = 1.0 + noise * random.random_range(-1.0..1.0);
        let rate = (arc.profit * factor + 1e-9) / arc.time_s.max(1e-9);
        if best.is_none_or(|(most, _)| rate > most) && is_way_home_free(space, head, visited) {
            *best = Some((rate, head));
        }
    };
    if !space.is_small() {
        let near = space.near::<true>(at).iter();
        near.for_each(|near| consider(&mut best, near.node));
    }
    if best.is_none() {
        let all = END + 1..space.len() as u32;
        all.for_each(|head| consider(&mut best, head));
    }
    best.map(|(_, head)| head)
}

fn is_way_home_free(space: &SearchSpace, node: u32, visited: &[bool]) -> bool {
    let mut at = node;
    while at != END && !visited[at as usize] {
        at = space.home[at as usize].1;
    }
    at == END
}

/// Inserts nodes in random order, each where it takes least time, until one is not in time: a route
/// all over the space. Parts of little profit are left to the local search.
///
/// Complexity: O(k^2) for a route of k nodes.
fn scattered(space: &SearchSpace, _: f64, random: &mut ChaCha8Rng, deadline: Deadline<'_>) -> Tour {
    /// Share of the time available that is used.
    const SHARE: f64 = 0.95;
    let Tour {
        mut nodes, time_s, ..
    } = Tour::new(space.quickest(), space);
    let mut left_s = SHARE * space.time_available_s - time_s;
    let mut is_on = vec![false; space.len()];
    nodes.iter().for_each(|&node| is_on[node as usize] = true);
    let mut order: Vec<u32> = (0..space.len() as u32)
        .filter(|&node| !is_on[node as usize])
        .collect();
    while !order.is_empty() && !deadline.passed() {
        let node = order.swap_remove(random.random_range(0..order.len() as u64) as usize);
        let detour_s = |pair: &[u32]| {
            let way = space.arc_to(node, pair[0]) + space.arc(node, pair[1]);
            way.time_s - space.arc(pair[0], pair[1]).time_s
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
    Tour::new(nodes, space)
}

/// Inserts a few random nodes, the attractors, into the quickest route, then the node of most noisy
/// profit per second of detour again and again, as long as one is in time. The route is dense in the
/// part of the space that the attractors chose; greedy routes stay near the start.
///
/// Complexity: O(k n) for a route of k nodes.
fn attracted(
    space: &SearchSpace,
    noise: f64,
    random: &mut ChaCha8Rng,
    deadline: Deadline<'_>,
) -> Tour {
    const MOST_ATTRACTORS: u32 = 3;
    let quickest = Tour::new(space.quickest(), space);
    let mut insertions: Vec<_> = (0..space.len())
        .map(|_| Insertion::new(1.0 + noise * random.random_range(-1.0..1.0)))
        .collect();
    let mut next = vec![START; space.len()];
    for pair in quickest.nodes.windows(2) {
        next[pair[0] as usize] = pair[1];
        insertions[pair[0] as usize].is_on_route = true;
    }
    insertions[END as usize].is_on_route = true;
    let mut left_s = quickest.time_left_s(space);
    let mut best = update_insertions(space, &quickest.nodes, left_s, &mut insertions);
    let mut attractors = random.random_range(1..=MOST_ATTRACTORS);
    while let Some(best_node) = best
        && !deadline.passed()
    {
        let attractor = random.random_range(0..space.len() as u32);
        let is_chosen = attractors > 0 && insertions[attractor as usize].fits(left_s);
        attractors = attractors.saturating_sub(1);
        let node = if is_chosen { attractor } else { best_node };
        let insertion = &mut insertions[node as usize];
        insertion.is_on_route = true;
        left_s -= insertion.detour_s;
        let after = insertion.after;
        let before = std::mem::replace(&mut next[after as usize], node);
        next[node as usize] = before;
        best = update_insertions(space, &[after, node, before], left_s, &mut insertions);
    }
    let mut nodes = vec![START];
    while nodes[nodes.len() - 1] != END {
        nodes.push(next[nodes[nodes.len() - 1] as usize]);
    }
    Tour::new(nodes, space)
}

/// The best insertion of one node into a route.
struct Insertion {
    is_on_route: bool,
    after: u32,
    detour_s: f64,
    /// Noisy profit per second of the detour.
    rate: f64,
    /// Factor of the node's profit.
    noise_factor: f64,
}

impl Insertion {
    fn new(noise_factor: f64) -> Self {
        Self {
            is_on_route: false,
            after: START,
            detour_s: f64::INFINITY,
            rate: f64::NEG_INFINITY,
            noise_factor,
        }
    }

    fn fits(&self, left_s: f64) -> bool {
        !self.is_on_route && self.detour_s <= left_s
    }
}

/// Updates the best insertion of every node after a stretch of the route is new: it replaces
/// whatever followed its first node. Returns the node of the best insertion in time.
fn update_insertions(
    space: &SearchSpace,
    stretch: &[u32],
    left_s: f64,
    insertions: &mut [Insertion],
) -> Option<u32> {
    let mut best = (f64::NEG_INFINITY, None);
    let open = (0..).zip(insertions).filter(|(_, each)| !each.is_on_route);
    for (node, insertion) in open {
        if insertion.after == stretch[0] {
            insertion.rate = f64::NEG_INFINITY;
        }
        for leg in stretch.windows(2) {
            let [after, before] = [leg[0], leg[1]];
            let detour =
                space.arc(after, node) + space.arc_to(before, node) - space.arc(after, before);
            let rate = (detour.profit * insertion.noise_factor + 1e-9) / detour.time_s.max(1e-9);
            if rate > insertion.rate {
                (insertion.rate, insertion.after, insertion.detour_s) =
                    (rate, after, detour.time_s);
            }
        }
        if insertion.rate > best.0 && insertion.detour_s <= left_s {
            best = (insertion.rate, Some(node));
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::space;
    use auv_graph::{Terrain, Topology};
    use auv_types::Seed;

    #[test]
    fn constructed_routes_are_simple_and_in_time() {
        for (edges, topology) in [
            (2_800, Topology::Undirected),
            (400, Topology::Undirected),
            (2_500, Topology::Directed),
        ] {
            let terrain = Terrain {
                topology,
                ..Terrain::benchmark(80, edges)
            };
            let space = space(&terrain, 1, 20_000.0);
            for (kind, construct) in [
                greedy as Construction,
                greedy_elsewhere,
                attracted,
                scattered,
            ]
            .into_iter()
            .enumerate()
            {
                let mut lengths = Vec::new();
                for stream in 0..20 {
                    let random = &mut Seed(2).stream(stream);
                    let mut tour = construct(&space, 0.5, random, Deadline::default());
                    let time_s = tour.time_s;
                    assert!(time_s <= space.time_available_s, "{kind}: {time_s}");
                    let ends = (tour.nodes.first(), tour.nodes.last());
                    assert_eq!(ends, (Some(&START), Some(&END)), "{kind}");
                    lengths.push(tour.nodes.len());
                    tour.nodes.sort_unstable();
                    tour.nodes.dedup();
                    assert_eq!(tour.nodes.len(), lengths[stream as usize], "{kind}");
                }
                // The scattered construction ends at the first node that does not fit.
                if space.is_dense && kind < 2 {
                    assert!(*lengths.iter().min().unwrap() > 8, "{kind}: {lengths:?}");
                }
            }
        }
    }

    #[test]
    fn every_insertion_kept_is_one_into_the_current_route() {
        let space = space(&Terrain::benchmark(25, 280), 4, 1e9);
        let mut nodes = space.quickest();
        let mut insertions: Vec<_> = (0..25).map(|_| Insertion::new(1.0)).collect();
        nodes
            .iter()
            .for_each(|&node| insertions[node as usize].is_on_route = true);
        let mut stretch = nodes.clone();
        while let Some(best) = update_insertions(&space, &stretch, 1e9, &mut insertions) {
            let open = (0..).zip(&insertions).filter(|(_, each)| !each.is_on_route);
            for (node, insertion) in open.clone() {
                let Some(at) = nodes.iter().position(|&other| other == insertion.after) else {
                    panic!("node {node} comes after a node that is not on the route");
                };
                let mut longer = nodes.clone();
                longer.insert(at + 1, node);
                let detour = space.sum(&longer) - space.sum(&nodes);
                let is_missing = insertion.detour_s.is_infinite() && detour.time_s.is_infinite();
                assert!(is_missing || (insertion.detour_s - detour.time_s).abs() < 1e-6);
            }
            let most = open
                .map(|(_, each)| each.rate)
                .fold(f64::NEG_INFINITY, f64::max);
            assert_eq!(insertions[best as usize].rate, most);
            insertions[best as usize].is_on_route = true;
            let after = insertions[best as usize].after;
            let at = nodes.iter().position(|&other| other == after).unwrap();
            stretch = vec![after, best, nodes[at + 1]];
            nodes.insert(at + 1, best);
        }
        assert!(nodes.len() > 10);
    }
}
