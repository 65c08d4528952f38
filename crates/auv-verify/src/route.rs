//! The five criteria of Fig. 6, from the network's waypoints and edges.

use crate::sum::Sum;
use auv_graph::{Edge, EdgeId, Network, NodeId, Route};
use auv_planning::RouteProblem;
use auv_types::libm;
use std::collections::BTreeMap;
use thiserror::Error;

/// One criterion of Fig. 6 that a route breaks.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum RouteViolation {
    /// It has no nodes.
    #[error("the route is empty")]
    Empty,
    /// It has a node that is not in the network.
    #[error("node {node} is not in the network", node = node.0)]
    UnknownNode {
        /// The node.
        node: NodeId,
    },
    /// It does not start at the start node.
    #[error("begins at node {actual}, not at the start {expected}", actual = actual.0, expected = expected.0)]
    WrongStart {
        /// Its first node.
        actual: NodeId,
        /// The start asked for.
        expected: NodeId,
    },
    /// It does not end at the destination.
    #[error("ends at node {actual}, not at the destination {expected}", actual = actual.0, expected = expected.0)]
    WrongEnd {
        /// Its last node.
        actual: NodeId,
        /// The destination asked for.
        expected: NodeId,
    },
    /// It uses an edge that is not in the network.
    #[error("there is no edge from node {from} to node {to}", from = from.0, to = to.0)]
    MissingEdge {
        /// Where the edge would start.
        from: NodeId,
        /// Where it would end.
        to: NodeId,
    },
    /// It uses an edge that is removed.
    #[error("the edge from node {from} to node {to} was taken out", from = from.0, to = to.0)]
    RemovedEdge {
        /// Where the edge starts.
        from: NodeId,
        /// Where it ends.
        to: NodeId,
    },
    /// It visits a node again.
    #[error("visits node {node} again", node = node.0)]
    RepeatedNode {
        /// The node.
        node: NodeId,
    },
    /// It passes an edge again, in either direction.
    #[error("passes the edge from node {from} to node {to} again", from = from.0, to = to.0)]
    RepeatedEdge {
        /// Where this leg starts.
        from: NodeId,
        /// Where it ends.
        to: NodeId,
    },
    /// It takes longer than the time available (equal is feasible).
    #[error("takes {time_s} s of {available_s} s available")]
    TooLong {
        /// Time of the route in seconds.
        time_s: f64,
        /// Time available in seconds.
        available_s: f64,
    },
}

/// The sums over a route, and every criterion that it breaks.
#[derive(Clone, Debug, Default, PartialEq)]
#[non_exhaustive]
pub struct RouteReport {
    /// Sum of the weights of the tasks done, each once (Eq. 9).
    pub weight: f64,
    /// Sum of travel and task times in seconds (Eq. 8).
    pub time_s: f64,
    /// Sum of lengths in metres.
    pub distance_m: f64,
    /// Number of tasks done. A transit, whose priority is 0, is not counted.
    pub tasks: usize,
    /// Everything wrong, in the order met along the route.
    pub violations: Vec<RouteViolation>,
}

impl RouteReport {
    /// Whether the route satisfies all five criteria.
    #[must_use]
    pub fn is_valid(&self) -> bool {
        self.violations.is_empty()
    }
}

/// Checks a route against the problem it was planned for and adds it up again.
///
/// Nothing of the planners' own bookkeeping is used: lengths come from waypoints (Eq. 6), times
/// from length, speed and task (Eq. 7) or from the problem's times, weights from priority and risk
/// (Eq. 9); sums are compensated. Legs whose edge is missing add nothing. The problem itself is
/// taken to be valid.
///
/// Complexity: O(m log k) for m edges and k legs.
#[must_use]
pub fn verify_route(problem: &RouteProblem<'_>, route: &Route) -> RouteReport {
    let mut report = RouteReport::default();
    check_nodes(problem, route.nodes(), &mut report.violations);
    check_legs(problem, route.nodes(), &mut report);
    let available_s = problem.time_available_s;
    // Written so that a NaN is too long.
    if !(report.time_s <= available_s) {
        report.violations.push(RouteViolation::TooLong {
            time_s: report.time_s,
            available_s,
        });
    }
    report
}

/// Checks the edges passed and adds them up.
fn check_legs(problem: &RouteProblem<'_>, nodes: &[NodeId], report: &mut RouteReport) {
    let network = problem.network;
    let edges = edges_of_legs(network, nodes);
    let (mut weight, mut time_s, mut distance_m) = Default::default();
    let mut tasks = 0;
    let mut passed = Vec::new();
    let violations = &mut report.violations;
    for leg in nodes.windows(2) {
        let (from, to) = (leg[0], leg[1]);
        let Some(&Some(id)) = edges.get(&(from, to)) else {
            violations.push(RouteViolation::MissingEdge { from, to });
            continue;
        };
        let edge = &network.edges()[id.index()];
        if problem.removed.contains(id) {
            violations.push(RouteViolation::RemovedEdge { from, to });
        }
        if passed.contains(&id) {
            violations.push(RouteViolation::RepeatedEdge { from, to });
        } else {
            passed.push(id);
            Sum::add(&mut weight, edge.task.priority / edge.task.risk);
            tasks += usize::from(edge.task.priority > 0.0);
        }
        let length_m = length_m(network, edge);
        Sum::add(&mut distance_m, length_m);
        let given_s = given_time_s(problem, from, to);
        Sum::add(
            &mut time_s,
            given_s.unwrap_or(length_m / network.speed_mps() + edge.task.completion_time_s),
        );
    }
    report.tasks = tasks;
    report.weight = weight.total();
    report.time_s = time_s.total();
    report.distance_m = distance_m.total();
}

fn check_nodes(problem: &RouteProblem<'_>, nodes: &[NodeId], found: &mut Vec<RouteViolation>) {
    let (Some(&first), Some(&last)) = (nodes.first(), nodes.last()) else {
        found.push(RouteViolation::Empty);
        return;
    };
    if first != problem.start {
        found.push(RouteViolation::WrongStart {
            actual: first,
            expected: problem.start,
        });
    }
    if last != problem.destination {
        found.push(RouteViolation::WrongEnd {
            actual: last,
            expected: problem.destination,
        });
    }
    let mut visited = std::collections::BTreeSet::new();
    for &node in nodes {
        if node.index() >= problem.network.waypoints().len() {
            found.push(RouteViolation::UnknownNode { node });
        } else if !visited.insert(node) {
            found.push(RouteViolation::RepeatedNode { node });
        }
    }
}

/// For each leg of the route the edge that it passes, found in the list that the network was made
/// from.
pub(crate) fn edges_of_legs(
    network: &Network,
    nodes: &[NodeId],
) -> BTreeMap<(NodeId, NodeId), Option<EdgeId>> {
    let mut legs: BTreeMap<_, _> = nodes
        .windows(2)
        .map(|leg| ((leg[0], leg[1]), None))
        .collect();
    for (i, edge) in network.edges().iter().enumerate() {
        let id = EdgeId(i as u32);
        let (from, to) = (NodeId(edge.from), NodeId(edge.to));
        if let Some(found) = legs.get_mut(&(from, to)) {
            *found = Some(id);
        }
        if !edge.directed
            && let Some(found) = legs.get_mut(&(to, from))
        {
            *found = Some(id);
        }
    }
    legs
}

pub(crate) fn length_m(network: &Network, edge: &Edge) -> f64 {
    let place = |node: u32| network.waypoints()[node as usize].position;
    let (a, b) = (place(edge.from), place(edge.to));
    let (x, y, z) = (b.x - a.x, b.y - a.y, b.z - a.z);
    edge.distance_m
        .unwrap_or_else(|| libm::sqrt(x * x + y * y + z * z))
}

/// The arc's entry in the problem's times, which are in the order of the network's arcs.
fn given_time_s(problem: &RouteProblem<'_>, from: NodeId, to: NodeId) -> Option<f64> {
    let times = problem.times?;
    let arcs = problem.network.arcs();
    let at = arcs.binary_search_by_key(&(from, to), |arc| (arc.tail, arc.head));
    Some(
        at.ok()
            .and_then(|i| times.get(i).copied())
            .unwrap_or(f64::NAN),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{EdgeSet, Task, Waypoint};
    use auv_types::Point3;

    fn network() -> Network {
        let waypoints = [0.0, 300.0, 600.0, 900.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
        let task = Task {
            priority: 4.0,
            risk: 2.0,
            completion_time_s: 50.0,
        };
        let edges = [
            Edge::undirected(0, 1, task),
            Edge::undirected(1, 2, task),
            Edge::directed(2, 3, task),
        ];
        Network::new(&waypoints, &edges, 3.0).unwrap()
    }

    fn route(nodes: &[u32]) -> Route {
        Route::new(nodes.iter().copied().map(NodeId).collect())
    }

    #[test]
    fn adds_up_a_valid_route() {
        let network = network();
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(3), 450.0);
        let report = verify_route(&problem, &route(&[0, 1, 2, 3]));
        assert!(report.is_valid(), "{:?}", report.violations);
        assert_eq!(
            (
                report.weight,
                report.time_s,
                report.distance_m,
                report.tasks
            ),
            (6.0, 450.0, 900.0, 3)
        );
    }

    #[test]
    fn a_transit_is_no_task_for_planners_and_verifier() {
        let waypoints = [0.0, 300.0, 600.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
        let work = Task {
            priority: 4.0,
            risk: 2.0,
            completion_time_s: 50.0,
        };
        let edges = [
            Edge::undirected(0, 1, work),
            Edge::undirected(1, 2, Task::TRANSIT),
        ];
        let network = Network::new(&waypoints, &edges, 3.0).unwrap();
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(2), 450.0);
        let there = route(&[0, 1, 2]);
        let report = verify_route(&problem, &there);
        let totals = network.evaluate(&there, &EdgeSet::empty(), None).unwrap();
        assert_eq!((report.tasks, totals.tasks), (1, 1));
    }

    #[test]
    fn lists_everything_wrong_at_once() {
        let network = network();
        let removed: EdgeSet = [EdgeId(1)].into_iter().collect();
        let problem = RouteProblem {
            removed: &removed,
            ..RouteProblem::new(&network, NodeId(0), NodeId(3), 1.0)
        };
        let report = verify_route(&problem, &route(&[1, 2, 1, 0, 3, 9]));
        let (one, two) = (NodeId(1), NodeId(2));
        let expected = [
            RouteViolation::WrongStart {
                actual: one,
                expected: NodeId(0),
            },
            RouteViolation::WrongEnd {
                actual: NodeId(9),
                expected: NodeId(3),
            },
            RouteViolation::RepeatedNode { node: one },
            RouteViolation::UnknownNode { node: NodeId(9) },
            RouteViolation::RemovedEdge { from: one, to: two },
            RouteViolation::RemovedEdge { from: two, to: one },
            RouteViolation::RepeatedEdge { from: two, to: one },
            RouteViolation::MissingEdge {
                from: NodeId(0),
                to: NodeId(3),
            },
            RouteViolation::MissingEdge {
                from: NodeId(3),
                to: NodeId(9),
            },
            RouteViolation::TooLong {
                time_s: 450.0,
                available_s: 1.0,
            },
        ];
        assert_eq!(report.violations, expected);
        assert_eq!((report.tasks, report.weight), (2, 4.0));
        let empty = verify_route(&problem, &route(&[]));
        assert_eq!(empty.violations, [RouteViolation::Empty]);
    }

    #[test]
    fn a_one_way_edge_is_not_passed_backwards() {
        let network = network();
        let problem = RouteProblem::new(&network, NodeId(3), NodeId(2), 1e9);
        let report = verify_route(&problem, &route(&[3, 2]));
        assert!(matches!(
            report.violations[..],
            [RouteViolation::MissingEdge { .. }]
        ));
    }

    #[test]
    fn uses_the_times_of_the_problem() {
        let network = network();
        let times: Vec<_> = (0..network.arcs().len()).map(|i| 10.0 + i as f64).collect();
        let problem = RouteProblem {
            times: Some(&times),
            ..RouteProblem::new(&network, NodeId(0), NodeId(2), 1e9)
        };
        let report = verify_route(&problem, &route(&[0, 1, 2]));
        let totals = problem.check(&route(&[0, 1, 2])).unwrap();
        assert_eq!(report.time_s, totals.time_s);
    }
}
