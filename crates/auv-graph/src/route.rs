//! Routes and the five criteria of Fig. 6.

use crate::edge_set::EdgeSet;
use crate::ids::NodeId;
use crate::network::{Network, NetworkArc};
use crate::waypoint::Task;
use std::fmt;
use thiserror::Error;

/// A sequence of waypoints.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(transparent)
)]
pub struct Route {
    nodes: Vec<NodeId>,
}

/// The totals of a route.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct RouteTotals {
    /// Sum of the tasks' weights (Eq. 9).
    pub weight: f64,
    /// Sum of travel and task times in seconds (Eq. 8).
    pub time_s: f64,
    /// Sum of lengths in metres.
    pub distance_m: f64,
    /// Number of tasks done. A transit, whose priority is 0, is not counted.
    pub tasks: usize,
    /// Sum of the tasks' priorities rho.
    pub priority: f64,
    /// Sum of the tasks' risks xi in percent points.
    pub risk: f64,
    /// Sum of the tasks' `xi / rho` (Eq. 20 as printed).
    pub risk_per_priority: f64,
}

impl RouteTotals {
    /// Adds one leg: an arc, the task of its edge, and the time it takes.
    pub fn add(&mut self, arc: &NetworkArc, task: Task, time_s: f64) {
        self.weight += arc.weight;
        self.time_s += time_s;
        self.distance_m += arc.distance_m;
        if task.priority > 0.0 {
            self.tasks += 1;
            self.priority += task.priority;
            self.risk += task.risk;
            self.risk_per_priority += task.risk / task.priority;
        }
    }
}

/// The criterion of Fig. 6 that a route breaks.
#[derive(Clone, Copy, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum Infeasible {
    /// It has no waypoint.
    #[error("the route is empty")]
    Empty,
    /// It does not start at the start.
    #[error("starts at node {actual}, not at the start {expected}", actual = actual.0, expected = expected.0)]
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
    /// It uses an edge that was removed.
    #[error("the edge from node {from} to node {to} was removed", from = from.0, to = to.0)]
    RemovedEdge {
        /// Where it starts.
        from: NodeId,
        /// Where it ends.
        to: NodeId,
    },
    /// It visits a node twice. A route that passes an edge twice does so too.
    #[error("visits node {node} twice", node = node.0)]
    RepeatedNode {
        /// The node.
        node: NodeId,
    },
    /// It takes longer than the time available.
    #[error("takes {time_s} s, {excess_s} s longer than available")]
    TooLong {
        /// Time of the route in seconds.
        time_s: f64,
        /// Excess over the available time in seconds.
        excess_s: f64,
    },
}

impl fmt::Display for Route {
    /// The nodes' numbers with arrows between them: `0 -> 3 -> 7`. [`Network::describe`] gives names.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (i, node) in self.nodes.iter().enumerate() {
            let arrow = if i == 0 { "" } else { " -> " };
            write!(f, "{arrow}{}", node.0)?;
        }
        Ok(())
    }
}

impl fmt::Display for RouteTotals {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "weight {:.2}, {} edges, {:.0} m in {:.0} s",
            self.weight, self.tasks, self.distance_m, self.time_s
        )
    }
}

impl Route {
    /// A route through the given nodes.
    #[must_use]
    pub const fn new(nodes: Vec<NodeId>) -> Self {
        Self { nodes }
    }

    /// The nodes in order.
    #[must_use]
    pub fn nodes(&self) -> &[NodeId] {
        &self.nodes
    }

    /// The legs in order.
    pub fn legs(
        &self,
    ) -> impl ExactSizeIterator<Item = (NodeId, NodeId)> + DoubleEndedIterator + '_ {
        self.nodes.windows(2).map(|pair| (pair[0], pair[1]))
    }

    /// Checks all five criteria of Fig. 6 and sums the route.
    ///
    /// Complexity: O(k log n + n/64) for k legs.
    ///
    /// # Errors
    /// The first criterion broken: start, end, repeated node, missing or removed edge, time.
    pub fn check(
        &self,
        network: &Network,
        removed: &EdgeSet,
        times: Option<&[f64]>,
        ends: (NodeId, NodeId),
        time_available_s: f64,
    ) -> Result<RouteTotals, Infeasible> {
        let (Some(&first), Some(&last)) = (self.nodes.first(), self.nodes.last()) else {
            return Err(Infeasible::Empty);
        };
        if first != ends.0 {
            return Err(Infeasible::WrongStart {
                actual: first,
                expected: ends.0,
            });
        }
        if last != ends.1 {
            return Err(Infeasible::WrongEnd {
                actual: last,
                expected: ends.1,
            });
        }
        let totals = self.totals(network, removed, times)?;
        if totals.time_s <= time_available_s {
            Ok(totals)
        } else {
            let excess_s = totals.time_s - time_available_s;
            Err(Infeasible::TooLong {
                time_s: totals.time_s,
                excess_s,
            })
        }
    }

    fn totals(
        &self,
        network: &Network,
        removed: &EdgeSet,
        times: Option<&[f64]>,
    ) -> Result<RouteTotals, Infeasible> {
        let mut visited = vec![false; network.num_nodes()];
        for &node in &self.nodes {
            match visited.get_mut(node.index()) {
                Some(seen) if !*seen => *seen = true,
                Some(_) => return Err(Infeasible::RepeatedNode { node }),
                None => {
                    return Err(Infeasible::MissingEdge {
                        from: node,
                        to: node,
                    });
                }
            }
        }
        let mut totals = RouteTotals::default();
        for (from, to) in self.legs() {
            let arc = network
                .arc_between(from, to)
                .ok_or(Infeasible::MissingEdge { from, to })?;
            let edge = &network.arcs()[arc.index()];
            if removed.contains(edge.edge) {
                return Err(Infeasible::RemovedEdge { from, to });
            }
            totals.add(
                edge,
                network.task(edge.edge),
                network.arc_time_s(arc, times),
            );
        }
        Ok(totals)
    }
}

impl Network {
    /// Sums a route's time, weight, tasks and distance (Eq. 8 and 9).
    ///
    /// `times`, by [`ArcId`](crate::ArcId), replace the arcs' times. The number of tasks is the number
    /// of edges passed.
    ///
    /// # Errors
    /// The first criterion that the route breaks, of those of Fig. 6 that concern nodes and edges. Ends
    /// and time are tested by [`Route::check`].
    pub fn evaluate(
        &self,
        route: &Route,
        removed: &EdgeSet,
        times: Option<&[f64]>,
    ) -> Result<RouteTotals, Infeasible> {
        route.totals(self, removed, times)
    }

    /// A route by the names of its waypoints: `ramp -> wreck -> 7 -> dock`.
    #[must_use]
    pub fn describe(&self, route: &Route) -> String {
        let names: Vec<String> = route.nodes().iter().map(|&n| self.name_of(n)).collect();
        names.join(" -> ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Edge, Task, Waypoint};
    use auv_types::Point3;

    #[test]
    fn each_broken_criterion_is_reported() {
        let waypoints = [0.0, 300.0, 600.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 0.0)));
        let task = Task {
            priority: 4.0,
            risk: 2.0,
            completion_time_s: 50.0,
        };
        let edges = [Edge::undirected(0, 1, task), Edge::undirected(1, 2, task)];
        let network = Network::new(&waypoints, &edges, 3.0).unwrap();
        let check = |nodes: &[u32], removed: &EdgeSet, available_s| {
            Route::new(nodes.iter().copied().map(NodeId).collect())
                .check(&network, removed, None, (NodeId(0), NodeId(2)), available_s)
                .map(|totals| totals.time_s)
        };
        let none = EdgeSet::empty();
        assert_eq!(check(&[0, 1, 2], &none, 300.0), Ok(300.0));
        assert!(matches!(check(&[], &none, 1e9), Err(Infeasible::Empty)));
        assert!(matches!(
            check(&[1, 2], &none, 1e9),
            Err(Infeasible::WrongStart { .. })
        ));
        assert!(matches!(
            check(&[0, 1], &none, 1e9),
            Err(Infeasible::WrongEnd { .. })
        ));
        assert!(matches!(
            check(&[0, 2], &none, 1e9),
            Err(Infeasible::MissingEdge { .. })
        ));
        assert!(matches!(
            check(&[0, 1, 0, 1, 2], &none, 1e9),
            Err(Infeasible::RepeatedNode { .. })
        ));
        assert!(matches!(
            check(&[0, 9, 2], &none, 1e9),
            Err(Infeasible::MissingEdge { .. })
        ));
        let passed = [crate::EdgeId(1)].into_iter().collect();
        assert!(matches!(
            check(&[0, 1, 2], &passed, 1e9),
            Err(Infeasible::RemovedEdge { .. })
        ));
        let late = check(&[0, 1, 2], &none, 299.0);
        assert!(matches!(late, Err(Infeasible::TooLong { excess_s, .. }) if excess_s == 1.0));
    }
}
