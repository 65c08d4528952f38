//! A network written down waypoint by waypoint, by name.

use crate::network::Network;
use crate::waypoint::{Edge, Task, Waypoint};
use auv_types::{Point3, Violations};
use std::collections::{BTreeMap, BTreeSet};

/// Collects waypoints, tasks and connections by name; [`NetworkBuilder::build`] checks all of it at once.
///
/// ```
/// use auv_graph::{Network, Task};
///
/// let survey = Task { priority: 6.0, risk: 2.0, completion_time_s: 60.0 };
/// let network = Network::builder(1.5)
///     .waypoint("ramp", [0.0, 0.0, 10.0])
///     .waypoint("wreck", [900.0, 200.0, 25.0])
///     .waypoint("dock", [1_800.0, 0.0, 10.0])
///     .task("ramp", "wreck", survey)
///     .connect_nearest(2)
///     .build()?;
/// assert_eq!(network.num_edges(), 3);
/// assert_eq!(network.name_of(network.waypoint("dock")?), "dock");
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Clone, Debug)]
pub struct NetworkBuilder {
    speed_mps: f64,
    waypoints: Vec<Waypoint>,
    edges: Vec<NamedEdge>,
    nearest: usize,
}

#[derive(Clone, Debug)]
struct NamedEdge {
    from: String,
    to: String,
    task: Task,
    directed: bool,
}

impl Network {
    /// Begins a network for a vehicle that travels at `speed_mps`.
    #[must_use]
    pub const fn builder(speed_mps: f64) -> NetworkBuilder {
        NetworkBuilder {
            speed_mps,
            waypoints: Vec::new(),
            edges: Vec::new(),
            nearest: 0,
        }
    }
}

impl NetworkBuilder {
    /// Adds a waypoint: north, east and down in metres.
    #[must_use]
    pub fn waypoint(mut self, name: impl Into<String>, north_east_down: [f64; 3]) -> Self {
        let position = Point3::from(north_east_down);
        self.waypoints.push(Waypoint::named(name, position));
        self
    }

    /// Connects two waypoints both ways, with a task that is done once.
    #[must_use]
    pub fn task(self, from: impl Into<String>, to: impl Into<String>, task: Task) -> Self {
        self.edge(from.into(), to.into(), task, false)
    }

    /// Connects two waypoints one way, with a task.
    #[must_use]
    pub fn task_one_way(self, from: impl Into<String>, to: impl Into<String>, task: Task) -> Self {
        self.edge(from.into(), to.into(), task, true)
    }

    /// Connects two waypoints both ways, without a task.
    #[must_use]
    pub fn transit(self, from: impl Into<String>, to: impl Into<String>) -> Self {
        self.edge(from.into(), to.into(), Task::TRANSIT, false)
    }

    /// Connects every waypoint with its `count` nearest by straight line, both ways and without a task.
    /// Pairs that are connected already, in any direction, stay as they are; equal distances: the waypoint that was
    /// added first.
    #[must_use]
    pub const fn connect_nearest(mut self, count: usize) -> Self {
        self.nearest = count;
        self
    }

    fn edge(mut self, from: String, to: String, task: Task, directed: bool) -> Self {
        self.edges.push(NamedEdge {
            from,
            to,
            task,
            directed,
        });
        self
    }

    /// Builds the network. Waypoints keep their order, edges too; those of `connect_nearest` come last.
    ///
    /// Complexity: O(n^2 log n) with `connect_nearest`, else that of [`Network::new`].
    ///
    /// # Errors
    /// All of: names used twice or unknown, and what [`Network::new`] refuses.
    pub fn build(&self) -> Result<Network, Violations> {
        let mut violations = Violations::new();
        let mut index_of = BTreeMap::new();
        for (i, waypoint) in self.waypoints.iter().enumerate() {
            let earlier = index_of.insert(waypoint.name.as_str(), i as u32);
            let place = format!("waypoint `{}`", waypoint.name);
            violations.require(earlier.is_none(), &place, || {
                "has the name of another; give each its own name".into()
            });
        }
        let mut edges = Vec::with_capacity(self.edges.len());
        for edge in &self.edges {
            let place = format!("edge `{}` - `{}`", edge.from, edge.to);
            let ends = [&edge.from, &edge.to].map(|name| {
                let known = index_of.get(name.as_str()).copied();
                violations.require(known.is_some(), &place, || {
                    format!(
                        "leads to waypoint `{name}`, which is not there; add it with `waypoint`"
                    )
                });
                known
            });
            if let [Some(from), Some(to)] = ends {
                edges.push(Edge {
                    directed: edge.directed,
                    ..Edge::undirected(from, to, edge.task)
                });
            }
        }
        violations.into_result()?;
        self.connect(&mut edges);
        Network::new(&self.waypoints, &edges, self.speed_mps)
    }

    /// Adds the transits of `connect_nearest`.
    fn connect(&self, edges: &mut Vec<Edge>) {
        let pair = |a: u32, b: u32| (a.min(b), a.max(b));
        let mut connected: BTreeSet<_> = edges.iter().map(|e| pair(e.from, e.to)).collect();
        for (i, waypoint) in (0_u32..).zip(&self.waypoints) {
            let mut others: Vec<(f64, u32)> = (0_u32..)
                .zip(&self.waypoints)
                .filter(|(j, _)| *j != i)
                .map(|(j, other)| ((other.position - waypoint.position).norm(), j))
                .collect();
            others.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            for &(_, j) in others.iter().take(self.nearest) {
                if connected.insert(pair(i, j)) {
                    edges.push(Edge::undirected(i, j, Task::TRANSIT));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn three() -> NetworkBuilder {
        Network::builder(2.0)
            .waypoint("a", [0.0, 0.0, 5.0])
            .waypoint("b", [100.0, 0.0, 5.0])
            .waypoint("c", [250.0, 0.0, 5.0])
    }

    #[test]
    fn the_nearest_are_connected_once_and_tasks_stay() {
        let task = Task {
            priority: 3.0,
            risk: 1.0,
            completion_time_s: 10.0,
        };
        let network = three()
            .task_one_way("a", "b", task)
            .connect_nearest(1)
            .build()
            .expect("sound");
        let edges = network.edges();
        assert_eq!(edges.len(), 2, "a-b with its task, c-b as a transit");
        assert!(edges[0].directed && edges[0].task == task);
        assert_eq!((edges[1].from, edges[1].to), (2, 1));
        assert_eq!(edges[1].task, Task::TRANSIT);
    }

    #[test]
    fn every_wrong_name_is_named() {
        let error = three()
            .waypoint("b", [0.0, 0.0, 9.0])
            .transit("a", "quay")
            .transit("pier", "c")
            .build()
            .expect_err("three wrong names");
        assert_eq!(error.total(), 3);
        let text = error.to_string();
        assert!(
            text.contains("`b`") && text.contains("`quay`") && text.contains("`pier`"),
            "{text}"
        );
    }
}
