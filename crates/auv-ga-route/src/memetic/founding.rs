//! First routes: greedy ones, each with its own noise, dense ones in parts of the field, and ones
//! scattered all over it.

use super::field::{END, Field, START};
use super::tour::Tour;
use auv_planning::Deadline;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// Makes a first route, given the noise of its choices as a share of the profit; a short one where
/// the deadline passes.
pub(crate) type Founder = fn(&Field, f64, &mut ChaCha8Rng, Deadline<'_>) -> Tour;

/// The two kinds of first routes, in turn, that suit a field in which the greedy route has so many
/// legs: where routes are long, what matters first is which part of the field they serve; inserting
/// takes arcs between most nodes.
pub(crate) fn founders(field: &Field, legs: usize) -> [Founder; 2] {
    const LONG: usize = 40;
    match legs > LONG {
        _ if field.is_small() => [grow, grow],
        true if field.is_dense => [gather, scatter],
        true => [gather, grow],
        false => [scatter, grow],
    }
}

/// Appends the arc of best noisy profit per time as long as the quickest way to the destination
/// stays affordable and free; in larger fields an arc to a near neighbour where any is left.
fn grow(field: &Field, noise: f64, random: &mut ChaCha8Rng, _: Deadline<'_>) -> Tour {
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
/// route all over the field. Stretches of little profit are left to the
/// local search.
///
/// Complexity: O(k^2) for a route of k nodes.
fn scatter(field: &Field, _: f64, random: &mut ChaCha8Rng, deadline: Deadline<'_>) -> Tour {
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
    while !order.is_empty() && !deadline.passed() {
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

/// Leads the quickest route by a few random nodes, then inserts the node of best noisy profit per
/// second of detour again and again as long as one is in time: a dense route in some part of the
/// field, where greedy ones crowd round the start.
///
/// Complexity: O(k n) for a route of k nodes.
fn gather(field: &Field, noise: f64, random: &mut ChaCha8Rng, deadline: Deadline<'_>) -> Tour {
    /// Most nodes that tell which part of the field.
    const LURES: u32 = 3;
    let quickest = field.quickest();
    let mut offers: Vec<_> = (0..field.len())
        .map(|_| Offer::new(1.0 + noise * random.random_range(-1.0..1.0)))
        .collect();
    let mut next = vec![START; field.len()];
    for pair in quickest.nodes.windows(2) {
        next[pair[0] as usize] = pair[1];
        offers[pair[0] as usize].is_taken = true;
    }
    offers[END as usize].is_taken = true;
    let mut left_s = quickest.time_left_s(field);
    let mut best = best_offer(field, &quickest.nodes, left_s, &mut offers);
    let mut lures = random.random_range(1..=LURES);
    while let Some(favourite) = best
        && !deadline.passed()
    {
        let lure = random.random_range(0..field.len() as u32);
        let is_lure = lures > 0 && offers[lure as usize].fits(left_s);
        lures = lures.saturating_sub(1);
        let node = if is_lure { lure } else { favourite };
        let offer = &mut offers[node as usize];
        offer.is_taken = true;
        left_s -= offer.detour_s;
        let after = offer.after;
        let before = std::mem::replace(&mut next[after as usize], node);
        next[node as usize] = before;
        best = best_offer(field, &[after, node, before], left_s, &mut offers);
    }
    let mut nodes = vec![START];
    while nodes[nodes.len() - 1] != END {
        nodes.push(next[nodes[nodes.len() - 1] as usize]);
    }
    Tour::new(nodes, field)
}

/// The place where a node would best come.
struct Offer {
    is_taken: bool,
    after: u32,
    detour_s: f64,
    /// Noisy profit per second of the detour.
    rate: f64,
    /// Factor of the node's profit.
    taste: f64,
}

impl Offer {
    fn new(taste: f64) -> Self {
        Self {
            is_taken: false,
            after: START,
            detour_s: f64::INFINITY,
            rate: f64::NEG_INFINITY,
            taste,
        }
    }

    fn fits(&self, left_s: f64) -> bool {
        !self.is_taken && self.detour_s <= left_s
    }
}

/// Offers every node the places along a new stretch of the route, which takes the place of any after
/// its first node; returns the node of the best offer in time.
fn best_offer(field: &Field, stretch: &[u32], left_s: f64, offers: &mut [Offer]) -> Option<u32> {
    let mut best = (f64::NEG_INFINITY, None);
    for (node, offer) in (0..).zip(offers).filter(|(_, offer)| !offer.is_taken) {
        if offer.after == stretch[0] {
            offer.rate = f64::NEG_INFINITY;
        }
        for place in stretch.windows(2) {
            let [after, before] = [place[0], place[1]];
            let detour =
                field.arc(after, node) + field.arc_to(before, node) - field.arc(after, before);
            let rate = (detour.profit * offer.taste + 1e-9) / detour.time_s.max(1e-9);
            if rate > offer.rate {
                (offer.rate, offer.after, offer.detour_s) = (rate, after, detour.time_s);
            }
        }
        if offer.rate > best.0 && offer.detour_s <= left_s {
            best = (offer.rate, Some(node));
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    //! First routes of every kind.
    use super::*;
    use auv_graph::{Network, NodeId, Terrain, Topology};
    use auv_planning::{Budget, RouteProblem, Run};
    use auv_types::Seed;

    fn field(network: &Network, time_s: f64) -> Field {
        let problem = RouteProblem::new(network, NodeId(0), NodeId(1), time_s);
        let home = network.quickest_to(problem.destination, problem.removed, problem.times);
        let run = Run::new(Seed(0), Budget::evaluations(1));
        let mut field = Field::new(&problem, &home, run.deadline()).unwrap();
        field.rank_neighbours(6, run.deadline());
        field
    }

    #[test]
    fn first_routes_of_every_kind_are_simple_and_in_time() {
        for (edges, topology) in [
            (2_800, Topology::Undirected),
            (400, Topology::Undirected),
            (2_500, Topology::Directed),
        ] {
            let terrain = Terrain {
                topology,
                ..Terrain::benchmark(80, edges)
            };
            let network = terrain.draw(Seed(1)).unwrap().network;
            let field = field(&network, 20_000.0);
            let run = Run::new(Seed(0), Budget::evaluations(1));
            for (kind, founder) in [grow as Founder, gather, scatter].into_iter().enumerate() {
                let mut lengths = Vec::new();
                for stream in 0..20 {
                    let mut tour =
                        founder(&field, 0.5, &mut Seed(2).stream(stream), run.deadline());
                    let time_s = tour.time_s;
                    assert!(time_s <= field.time_available_s, "{kind}: {time_s}");
                    let ends = (tour.nodes.first(), tour.nodes.last());
                    assert_eq!(ends, (Some(&START), Some(&END)), "{kind}");
                    lengths.push(tour.nodes.len());
                    tour.nodes.sort_unstable();
                    tour.nodes.dedup();
                    assert_eq!(tour.nodes.len(), lengths[stream as usize], "{kind}");
                }
                // A scattered one ends at the first node that does not fit.
                if field.is_dense && kind < 2 {
                    assert!(*lengths.iter().min().unwrap() > 8, "{kind}: {lengths:?}");
                }
            }
        }
    }
}
