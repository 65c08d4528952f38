//! Random networks: the paper's terrain (section 3.1) and the families of its experiments.

use crate::edge_set::EdgeSet;
use crate::ids::NodeId;
use crate::instance::RouteInstance;
use crate::network::Network;
use crate::waypoint::{Edge, Task, Waypoint};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed, Violations, libm};
use std::f64::consts::TAU;
use thiserror::Error;

/// Whether an edge can be passed both ways.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Topology {
    /// One way. The way back, if there is one, is another edge with a task of its own.
    Directed,
    /// Both ways, with one task.
    #[default]
    Undirected,
}

/// How waypoints spread over the area.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[non_exhaustive]
pub enum Positions {
    /// Evenly (the paper's section 3.1).
    #[default]
    Uniform,
    /// Normally around the middle of the area, cut off at its border (the paper's Fig. 12 says
    /// "Gaussian").
    Normal {
        /// Standard deviation in metres.
        deviation_m: f64,
    },
}

/// A uniform distribution on `low..=high`.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct UniformRange {
    /// Least value.
    pub low: f64,
    /// Greatest value.
    pub high: f64,
    /// Number of values in a unit (1: integers, 100: two decimals); 0: any value.
    pub per_unit: u32,
}

impl UniformRange {
    /// Any value from `low` to `high`.
    #[must_use]
    pub const fn continuous(low: f64, high: f64) -> Self {
        Self {
            low,
            high,
            per_unit: 0,
        }
    }

    /// The values from `low` to `high` in steps of `1 / per_unit`.
    #[must_use]
    pub const fn stepped(low: f64, high: f64, per_unit: u32) -> Self {
        Self {
            low,
            high,
            per_unit,
        }
    }

    fn draw(&self, random: &mut ChaCha8Rng) -> f64 {
        if self.per_unit == 0 {
            return random.random_range(self.low..=self.high);
        }
        let per_unit = f64::from(self.per_unit);
        let [first, last] = [self.low, self.high].map(|end| (end * per_unit).round() as i64);
        // Divided, not multiplied by a step: 33 / 25 is 1.32, 33 * 0.04 is not.
        random.random_range(first..=last) as f64 / per_unit
    }

    fn check(&self, least: f64, place: &str, violations: &mut Violations) {
        let ok = self.low >= least && self.low <= self.high && self.high <= 1e7;
        violations.require(ok, place, || {
            format!(
                "is {} to {}; give an ascending range from {least} to 1e7",
                self.low, self.high
            )
        });
    }
}

/// Settings of a random instance. Start is node 0, destination the last node.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct Terrain {
    /// Number of waypoints.
    pub nodes: usize,
    /// Number of edges, drawn without replacement from all pairs.
    pub edges: usize,
    /// Directed or not. The paper's Table 2 needs directed edges: 1470 exceed the 1225 pairs of 50
    /// nodes. Its Table 1 comes near the published weights only with undirected ones.
    pub topology: Topology,
    /// Extent to north and to east in metres. The paper's "10 km^2" is read as 10 km x 10 km, since its
    /// legs are longer than the diagonal of a square of 10 km^2.
    pub extent_m: f64,
    /// Depth of waypoints in metres (paper: 0 to 100).
    pub depth_m: UniformRange,
    /// Steps per metre of north and east; 0: any value.
    pub positions_per_metre: u32,
    /// How waypoints spread.
    pub positions: Positions,
    /// Priority rho (not given by the paper; 1 to 10).
    pub priority: UniformRange,
    /// Risk xi in percent points (not given by the paper; 1 to 10, which gives its weights).
    pub risk: UniformRange,
    /// Completion time delta in seconds (not given by the paper; 50 to 300 agrees with what its tables
    /// leave for each task after the travel time at 3 m/s).
    pub completion_time_s: UniformRange,
    /// Speed in m/s (paper: 3).
    pub speed_mps: f64,
    /// Time available in seconds.
    pub budget_s: f64,
    /// Most draws until the destination is reachable within the budget.
    pub attempts: u32,
}

/// Why no instance was drawn.
#[derive(Clone, Debug, PartialEq, Error)]
#[non_exhaustive]
pub enum NoInstance {
    /// The settings are invalid.
    #[error("the terrain's settings are invalid: {0}")]
    Settings(#[from] Violations),
    /// None of [`Terrain::attempts`] networks had a way to the destination within the budget.
    #[error(
        "none of {attempts} random networks led to the destination within {budget_s} s; \
         give more edges or time"
    )]
    NeverReachable {
        /// Number of networks drawn.
        attempts: u32,
        /// The time available in seconds.
        budget_s: f64,
    },
}

impl Terrain {
    /// The paper's terrain with `nodes` waypoints and `edges` undirected edges; 7 hours.
    #[must_use]
    pub const fn paper(nodes: usize, edges: usize) -> Self {
        Self {
            nodes,
            edges,
            topology: Topology::Undirected,
            extent_m: 10_000.0,
            depth_m: UniformRange::continuous(0.0, 100.0),
            positions_per_metre: 0,
            positions: Positions::Uniform,
            priority: UniformRange::continuous(1.0, 10.0),
            risk: UniformRange::continuous(1.0, 10.0),
            completion_time_s: UniformRange::continuous(50.0, 300.0),
            speed_mps: 3.0,
            budget_s: 25_200.0,
            attempts: 1000,
        }
    }

    /// Table 1, the smaller graph: 50 nodes, 1197 edges, 25,200 s.
    #[must_use]
    pub const fn table1_50() -> Self {
        Self::paper(50, 1197)
    }

    /// Table 1, the larger graph: 100 nodes, 4886 edges, 25,200 s.
    #[must_use]
    pub const fn table1_100() -> Self {
        Self::paper(100, 4886)
    }

    /// Table 2: 50 nodes, 1470 directed edges, 10,800 s.
    #[must_use]
    pub const fn table2() -> Self {
        Self {
            topology: Topology::Directed,
            budget_s: 10_800.0,
            ..Self::paper(50, 1470)
        }
    }

    /// Fig. 12: 20 nodes, four fifths of the edges, 25,200 s.
    #[must_use]
    pub const fn figure12() -> Self {
        Self::paper(20, 152)
    }

    /// The family used to compare planners: integer priorities, risks of 1.04 to 5 percent points, tasks
    /// of whole seconds, up to 600, and positions to a decimetre. A text file holds these values
    /// exactly.
    #[must_use]
    pub const fn benchmark(nodes: usize, edges: usize) -> Self {
        Self {
            depth_m: UniformRange::stepped(0.0, 100.0, 10),
            positions_per_metre: 10,
            priority: UniformRange::stepped(1.0, 10.0, 1),
            risk: UniformRange::stepped(1.04, 5.0, 25),
            completion_time_s: UniformRange::stepped(60.0, 600.0, 1),
            ..Self::paper(nodes, edges)
        }
    }

    /// Everything wrong with the settings.
    #[must_use]
    pub fn validate(&self) -> Violations {
        let mut violations = Violations::new();
        let most = Network::MAX_NODES;
        violations.require((2..=most).contains(&self.nodes), "nodes", || {
            format!("is {}; give 2 to {most}", self.nodes)
        });
        let most = self.num_pairs().min(Network::MAX_EDGES as u64);
        violations.require((1..=most).contains(&(self.edges as u64)), "edges", || {
            format!(
                "is {}; give 1 to {most} for {} nodes",
                self.edges, self.nodes
            )
        });
        violations.require_positive(self.extent_m, "extent_m");
        violations.require(self.extent_m <= 1e7, "extent_m", || {
            format!("is {}; give at most 1e7", self.extent_m)
        });
        if let Positions::Normal { deviation_m } = self.positions {
            violations.require_positive(deviation_m, "positions.deviation_m");
        }
        self.depth_m.check(0.0, "depth_m", &mut violations);
        self.priority.check(0.0, "priority", &mut violations);
        self.risk.check(1e-6, "risk", &mut violations);
        self.completion_time_s
            .check(0.0, "completion_time_s", &mut violations);
        violations.require_positive(self.speed_mps, "speed_mps");
        violations.require_not_negative(self.budget_s, "budget_s");
        violations.require(self.attempts > 0, "attempts", || {
            "is 0; give at least 1".into()
        });
        violations
    }

    /// Draws an instance.
    ///
    /// # Determinism
    /// Equal settings and seeds give equal instances. Attempt `k` draws from stream `k` of the seed.
    ///
    /// # Errors
    /// [`NoInstance`]: the settings are invalid or never lead to the destination in time.
    pub fn draw(&self, seed: Seed) -> Result<RouteInstance, NoInstance> {
        self.validate().into_result()?;
        let ends = (NodeId(0), NodeId(self.nodes as u32 - 1));
        for attempt in 0..self.attempts {
            let network = self.draw_network(&mut seed.stream(u64::from(attempt)))?;
            let home = network.quickest_to(ends.1, &EdgeSet::empty(), None);
            if home.time_from_s(ends.0) <= self.budget_s {
                let mut instance =
                    RouteInstance::new(self.name(seed), network, ends, self.budget_s)?;
                instance.seed = Some(seed.0);
                return Ok(instance);
            }
        }
        Err(NoInstance::NeverReachable {
            attempts: self.attempts,
            budget_s: self.budget_s,
        })
    }

    fn name(&self, seed: Seed) -> String {
        let kind = match self.topology {
            Topology::Directed => 'd',
            Topology::Undirected => 'u',
        };
        format!(
            "terrain-{}-{}{kind}-T{}-s{}",
            self.nodes, self.edges, self.budget_s, seed.0
        )
    }

    fn draw_network(&self, random: &mut ChaCha8Rng) -> Result<Network, Violations> {
        let waypoints: Vec<_> = (0..self.nodes)
            .map(|_| {
                let (north_m, east_m) =
                    (self.draw_coordinate(random), self.draw_coordinate(random));
                Waypoint::at(Point3::new(north_m, east_m, self.depth_m.draw(random)))
            })
            .collect();
        let directed = self.topology == Topology::Directed;
        let mut edges = Vec::with_capacity(self.edges);
        let mut pairs_left = self.num_pairs();
        for from in 0..self.nodes as u32 {
            let lowest = if directed { 0 } else { from + 1 };
            for to in (lowest..self.nodes as u32).filter(|&to| to != from) {
                // Selection sampling: a pair is taken with the share of edges still wanted.
                let wanted = (self.edges - edges.len()) as u64;
                if random.random_range(0..pairs_left) < wanted {
                    let task = Task {
                        priority: self.priority.draw(random),
                        risk: self.risk.draw(random),
                        completion_time_s: self.completion_time_s.draw(random),
                    };
                    edges.push(Edge {
                        directed,
                        ..Edge::undirected(from, to, task)
                    });
                }
                pairs_left -= 1;
            }
        }
        Network::new(&waypoints, &edges, self.speed_mps)
    }

    fn draw_coordinate(&self, random: &mut ChaCha8Rng) -> f64 {
        let whole = UniformRange::stepped(0.0, self.extent_m, self.positions_per_metre);
        let Positions::Normal { deviation_m } = self.positions else {
            return whole.draw(random);
        };
        // Box and Muller, drawn again if outside the area. A thousand draws all miss it only if the
        // deviation is many times the area.
        for _ in 0..1000 {
            let (radius, angle) = (1.0 - random.random::<f64>(), random.random::<f64>());
            let normal = (-2.0 * libm::log(radius)).sqrt() * libm::cos(TAU * angle);
            let at_m = self.extent_m / 2.0 + deviation_m * normal;
            if (0.0..=self.extent_m).contains(&at_m) {
                return match f64::from(self.positions_per_metre) {
                    0.0 => at_m,
                    steps => (at_m * steps).round() / steps,
                };
            }
        }
        whole.draw(random)
    }

    fn num_pairs(&self) -> u64 {
        let n = self.nodes as u64;
        match self.topology {
            Topology::Directed => n * n.saturating_sub(1),
            Topology::Undirected => n * n.saturating_sub(1) / 2,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn presets_have_the_published_sizes_and_a_way_in_time() {
        let published = [
            (Terrain::table1_50(), 50, 1197, 2394),
            (Terrain::table1_100(), 100, 4886, 9772),
            (Terrain::table2(), 50, 1470, 1470),
            (Terrain::figure12(), 20, 152, 304),
        ];
        for (terrain, nodes, edges, arcs) in published {
            let instance = terrain.draw(Seed(3)).unwrap();
            let network = &instance.network;
            assert_eq!((network.num_nodes(), network.num_edges()), (nodes, edges));
            assert_eq!(network.arcs().len(), arcs);
            let home = network.quickest_to(instance.destination, &EdgeSet::empty(), None);
            assert!(home.time_from_s(instance.start) <= instance.budget_s);
        }
    }

    #[test]
    fn only_equal_seeds_give_equal_instances() {
        let draw = |seed| Terrain::table2().draw(Seed(seed)).unwrap();
        assert_eq!(draw(1), draw(1));
        assert_ne!(draw(1).network, draw(2).network);
    }

    #[test]
    fn every_pair_is_equally_likely() {
        let terrain = Terrain {
            attempts: 1,
            budget_s: 1e9,
            ..Terrain::paper(6, 5)
        };
        let mut count = [[0_u32; 6]; 6];
        let mut random = Seed(9).stream(0);
        for _ in 0..6000 {
            for edge in terrain.draw_network(&mut random).unwrap().edges() {
                count[edge.from as usize][edge.to as usize] += 1;
            }
        }
        // Each of 15 pairs is drawn with probability 1/3: 2000 times, deviation 37.
        for (i, row) in count.iter().enumerate() {
            assert!(
                row[i + 1..].iter().all(|&c| c.abs_diff(2000) < 180),
                "{count:?}"
            );
        }
    }

    #[test]
    fn values_keep_their_ranges_and_steps() {
        let terrain = Terrain {
            positions: Positions::Normal {
                deviation_m: 2500.0,
            },
            ..Terrain::benchmark(60, 1700)
        };
        let network = terrain.draw(Seed(5)).unwrap().network;
        let inside = |w: &Waypoint| (0..2).all(|k| (0.0..=10_000.0).contains(&w.position[k]));
        assert!(network.waypoints().iter().all(inside));
        for edge in network.edges() {
            let Task {
                priority,
                risk,
                completion_time_s,
            } = edge.task;
            assert!((1.0..=10.0).contains(&priority) && priority.fract() == 0.0);
            assert!((1.04..=5.0).contains(&risk) && risk == (risk * 25.0).round() / 25.0);
            assert!((60.0..=600.0).contains(&completion_time_s));
        }
    }

    #[test]
    fn invalid_and_hopeless_settings_are_refused() {
        let wrong = Terrain {
            risk: UniformRange::continuous(0.0, 1.0),
            ..Terrain::paper(4, 7)
        };
        assert_eq!(wrong.validate().total(), 2);
        let hopeless = Terrain {
            budget_s: 1.0,
            attempts: 3,
            ..Terrain::paper(10, 20)
        };
        assert!(matches!(
            hopeless.draw(Seed(0)),
            Err(NoInstance::NeverReachable { attempts: 3, .. })
        ));
    }
}
