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

/// Whether a network can hold the complete graph of `n` nodes; if not, a violation that names the limit.
pub(super) fn require_size(n: usize, place: &str, violations: &mut Violations) -> bool {
    let (most_nodes, most_edges) = (Network::MAX_NODES, Network::MAX_EDGES);
    if n > most_nodes {
        violations.push(
            place,
            format!(
                "makes a network of {n} nodes; at most {most_nodes} are allowed \
                 (Network::MAX_NODES)"
            ),
        );
        return false;
    }
    let edges = num_pairs(n);
    violations.require(edges <= most_edges, place, || {
        format!(
            "makes a network of {n} nodes with {edges} edges; at most {most_edges} edges are \
             allowed (Network::MAX_EDGES)"
        )
    });
    edges <= most_edges
}

/// The complete graph in which every simple route earns the scores of the nodes it visits. An edge is
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
    let mut edges = Vec::with_capacity(num_pairs(n));
    for i in 0..n {
        for j in i + 1..n {
            let task = Task {
                priority: share(i) + share(j),
                ..Task::TRANSIT
            };
            edges.push(Edge {
                distance_m: Some(distance(i, j)),
                ..Edge::undirected(i as u32, j as u32, task)
            });
        }
    }
    let waypoints: Vec<_> = places
        .iter()
        .map(|place| Waypoint::at(Point3::new(place.x, place.y, 0.0)))
        .collect();
    let network = Network::new(&waypoints, &edges, 1.0)?;
    let ends = (NodeId(ends.0 as u32), NodeId(ends.1 as u32));
    Ok(RouteInstance::new(name, network, ends, limit)?)
}
