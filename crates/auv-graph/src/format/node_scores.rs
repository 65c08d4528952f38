//! Orienteering with scores on the nodes, as a network with weights on the edges.

use super::error::FormatError;
use crate::ids::NodeId;
use crate::instance::RouteInstance;
use crate::network::Network;
use crate::waypoint::{Edge, Task, Waypoint};
use auv_types::{Point3, Violations};

/// A node of an orienteering file with its score.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct ScoredPlace {
    pub(super) x: f64,
    pub(super) y: f64,
    pub(super) score: f64,
}

/// Number of edges of the complete graph of `n` nodes.
const fn num_pairs(n: usize) -> usize {
    n.saturating_mul(n.saturating_sub(1)) / 2
}

/// How many edges to near neighbours each of `n` nodes keeps at most in a file of coordinates or distances;
/// `None` if it keeps all.
///
/// A network holds at most [`Network::MAX_EDGES`] edges: the complete graph of 1,414 nodes. In a larger one
/// each node has edges to its nearest neighbours in all directions, up to 133 of them among 7,398 nodes, and
/// to start and destination. A route over other edges is not found; good routes hardly have any.
#[must_use]
pub fn nearest_kept(n: usize) -> Option<usize> {
    (num_pairs(n) > Network::MAX_EDGES).then(|| Network::MAX_EDGES / n - 2)
}

/// Whether a network can hold `n` nodes; if not, a violation that names the limit.
pub(super) fn require_size(n: usize, place: &str, violations: &mut Violations) -> bool {
    let most = Network::MAX_NODES;
    violations.require(n <= most, place, || {
        format!("makes a network of {n} nodes; at most {most} are allowed (Network::MAX_NODES)")
    });
    n <= most
}

/// The pairs of nodes that get an edge, in order: all, or those that [`nearest_kept`] says. Half of these
/// are to the nearest nodes and up to an eighth to the next in each quadrant, so that nodes in a dense
/// cluster have ways out of it.
fn pairs(
    places: &[ScoredPlace],
    ends: (usize, usize),
    distance: impl Fn(usize, usize) -> f64,
) -> Vec<(usize, usize)> {
    let n = places.len();
    let Some(kept) = nearest_kept(n) else {
        return (0..n)
            .flat_map(|i| (i + 1..n).map(move |j| (i, j)))
            .collect();
    };
    let mut pairs = Vec::new();
    let mut others = Vec::with_capacity(n);
    for i in 0..n {
        let ordered = |j: usize| (i.min(j), i.max(j));
        others.clear();
        let with_distance = |j: usize| {
            let (first, second) = ordered(j);
            (distance(first, second), j)
        };
        others.extend((0..n).filter(|&j| j != i).map(with_distance));
        nearest_first(&mut others, kept / 2);
        pairs.extend(others.drain(..kept / 2).map(|(_, j)| ordered(j)));
        let quadrant = |j: usize| (places[j].x > places[i].x, places[j].y > places[i].y);
        for side in [(false, false), (false, true), (true, false), (true, true)] {
            let mut beside: Vec<_> = others
                .extract_if(.., |&mut (_, j)| quadrant(j) == side)
                .collect();
            let most = beside.len().min(kept / 8);
            nearest_first(&mut beside, most);
            pairs.extend(beside[..most].iter().map(|&(_, j)| ordered(j)));
        }
        pairs.extend(
            [ends.0, ends.1]
                .into_iter()
                .filter(|&end| end != i)
                .map(ordered),
        );
    }
    pairs.sort_unstable();
    pairs.dedup();
    pairs
}

/// Moves the `count` nearest to the front. Distances are by node, and the lower node is the nearer of two.
fn nearest_first(others: &mut [(f64, usize)], count: usize) {
    if count < others.len() {
        others.select_nth_unstable_by(count, |a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
    }
}

/// The graph in which every simple route earns the scores of the nodes it visits: complete, or of nearest
/// neighbours where [`nearest_kept`] says so. An edge is
/// worth half the score of each of its nodes, but the whole score of a start or destination.
///
/// The speed is 1 m/s, so the file's limit of the distance is the budget in seconds.
pub(super) fn complete_instance(
    name: &str,
    places: &[ScoredPlace],
    ends: (usize, usize),
    limit: f64,
    distance: impl Fn(usize, usize) -> f64,
) -> Result<RouteInstance, FormatError> {
    let n = places.len();
    let mut violations = Violations::new();
    require_size(n, "the file", &mut violations);
    violations.into_result()?;
    let share = |i: usize| match i {
        _ if i == ends.0 || i == ends.1 => places[i].score,
        _ => places[i].score / 2.0,
    };
    let edge = |(i, j): (usize, usize)| {
        let task = Task {
            priority: share(i) + share(j),
            ..Task::TRANSIT
        };
        Edge {
            distance_m: Some(distance(i, j)),
            ..Edge::undirected(i as u32, j as u32, task)
        }
    };
    let edges: Vec<_> = pairs(places, ends, &distance)
        .into_iter()
        .map(edge)
        .collect();
    let waypoints: Vec<_> = places
        .iter()
        .map(|place| Waypoint::at(Point3::new(place.x, place.y, 0.0)))
        .collect();
    let network = Network::new(&waypoints, &edges, 1.0)?;
    let ends = (NodeId(ends.0 as u32), NodeId(ends.1 as u32));
    Ok(RouteInstance::new(name, network, ends, limit)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_large_file_keeps_the_nearest_neighbours_and_the_ends_of_all_nodes() {
        let n = 1_500;
        let kept = nearest_kept(n).unwrap();
        let place = |i: usize| ScoredPlace {
            x: ((i * 37) % n) as f64,
            y: 0.0,
            score: 1.0,
        };
        let places: Vec<_> = (0..n).map(place).collect();
        let distance = |i: usize, j: usize| (places[i].x - places[j].x).abs();
        let instance = complete_instance("line", &places, (3, 7), 9.0, distance).unwrap();
        let network = &instance.network;
        assert!(network.num_edges() <= Network::MAX_EDGES && network.num_edges() > 300_000);
        let has = |i: usize, j: usize| {
            let arc = network.arc_between(NodeId(i as u32), NodeId(j as u32));
            arc.is_some()
        };
        for i in (0..n).filter(|i| ![3, 7].contains(i)) {
            assert!(has(i, 3) && has(7, i));
            for j in (0..n).filter(|&j| j != i && distance(i, j) < (kept / 4) as f64) {
                assert!(has(i, j), "{i} {j}");
            }
        }
        assert_eq!(nearest_kept(1_414), None);
        assert_eq!(nearest_kept(7_398), Some(133));
    }
}
