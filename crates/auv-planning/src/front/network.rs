//! The times and ways of a network's arcs in a moving sea, from one front for each waypoint and departure.

use super::lattice::{Depths, Frame, Lattice};
use super::shortened::shortened;
use super::spread::{Front, Spread};
use super::stencil::Stencil;
use super::tide::Tide;
use crate::motion::Floor;
use crate::{Deadline, LegTime, Vehicle};
use auv_graph::{ArcId, Network, NetworkArc, NodeId, Profiles};
use auv_types::{Bounds, Point3, Vector3, Violations, libm};
use std::collections::{BTreeMap, BTreeSet};

/// Least nodes of the lattice over all waypoints, and nodes for each waypoint.
const NODES: f64 = 2_500.0;
const NODES_EACH: f64 = 25.0;
/// How far the lattice reaches beyond the outermost waypoints, in lengths of the longest arc.
const BEYOND: f64 = 0.5;
/// Cells that a step of a front spans.
const REACH: isize = 3;
/// Times at which the current is tabulated where it changes, and by what it then changes at least, m/s.
const TIMES: usize = 37;
const STEADY_MPS: f64 = 1e-6;
/// A front goes on for so many times what the lattice's diagonal takes in still water.
const PATIENCE: f64 = 4.0;
/// Metres kept above the floor.
const FLOOR_MARGIN_M: f64 = 0.05;
/// Travel time of an arc that cannot be flown after the last departure of its profile, seconds.
const NEVER_S: f64 = 1e9;

/// The sea between the waypoints of a network, as far as it is known.
#[derive(Clone, Copy, Debug)]
pub struct NetworkSea<'a> {
    /// The vehicle and the forecast current.
    pub leg_time: LegTime<'a>,
    /// The box that it stays in.
    pub bounds: Option<Bounds>,
    /// The floor that it stays above.
    pub floor: Option<Floor<'a>>,
}

/// How an arc is flown from one departure.
#[derive(Clone, Debug, PartialEq)]
struct Flight {
    /// Infinite where no way is made.
    travel_s: f64,
    /// Ends included.
    way: Vec<Point3<f64>>,
}

/// Travel times and ways of a network's arcs by departure, in the forecast current.
///
/// One front for each waypoint and departure gives the ways to all its neighbours; [`LegTime`] says how long
/// each takes. The way given (the guide of the arc, or the straight line) stays where it is as quick.
#[derive(Clone, Debug, PartialEq)]
pub struct NetworkFronts {
    departures_s: Vec<f64>,
    /// For each arc, a flight for each departure.
    flights: Vec<Vec<Flight>>,
}

impl NetworkFronts {
    /// The times and ways of all arcs from the given departures, ascending mission times in seconds. In a
    /// current that does not change the first stands for all. `guides` has the ways of arcs whose straight
    /// line leads over land.
    ///
    /// # Determinism
    /// Equal arguments give equal bits.
    #[must_use]
    pub fn new(
        network: &Network,
        sea: &NetworkSea<'_>,
        guides: &BTreeMap<ArcId, Vec<Point3<f64>>>,
        departures_s: &[f64],
    ) -> Self {
        let waters = Waters::new(network, sea, departures_s);
        let departures_s = match &waters {
            Some(waters) if !waters.steady => departures_s.to_vec(),
            _ => departures_s[..departures_s.len().min(1)].to_vec(),
        };
        let given = |arc: usize| {
            let [tail, head] = [network.arcs()[arc].tail, network.arcs()[arc].head]
                .map(|node| network.waypoints()[node.index()].position);
            let guide = guides.get(&ArcId(arc as u32)).cloned();
            guide.unwrap_or_else(|| vec![tail, head])
        };
        let mut flights = vec![Vec::new(); network.arcs().len()];
        for &departure_s in &departures_s {
            for node in 0..network.num_nodes() as u32 {
                let front = waters.as_ref().map(|waters| {
                    waters.spread(network, NodeId(node), departure_s, sea.leg_time.vehicle)
                });
                for arc in network.range_from(NodeId(node)) {
                    let mut best = flight(&sea.leg_time, given(arc), departure_s, f64::INFINITY);
                    if let (Some(waters), Some(front)) = (&waters, &front)
                        && let Some(way) = waters.way(sea, network, front, arc, departure_s)
                    {
                        let other = flight(&sea.leg_time, way, departure_s, waters.cell_m);
                        if other.travel_s < best.travel_s {
                            best = other;
                        }
                    }
                    flights[arc].push(best);
                }
            }
        }
        Self {
            departures_s,
            flights,
        }
    }

    /// The departures, mission times in seconds: one where the current does not change.
    #[must_use]
    pub fn departures_s(&self) -> &[f64] {
        &self.departures_s
    }

    /// How long an arc takes from a departure, seconds: linear between departures, constant outside. Infinite
    /// where no way is made.
    #[must_use]
    pub fn travel_s(&self, arc: ArcId, departure_s: f64) -> f64 {
        let flights = &self.flights[arc.index()];
        let after = self.departures_s.partition_point(|&t| t < departure_s);
        if after == 0 || after == flights.len() {
            let nearest = after.min(flights.len().saturating_sub(1));
            return flights.get(nearest).map_or(f64::INFINITY, |f| f.travel_s);
        }
        let (early_s, late_s) = (self.departures_s[after - 1], self.departures_s[after]);
        let (early, late) = (flights[after - 1].travel_s, flights[after].travel_s);
        let share = (departure_s - early_s) / (late_s - early_s);
        if share >= 1.0 {
            return late;
        }
        early + (late - early) * share
    }

    /// The way of an arc from the latest departure that is not after this one, ends included.
    #[must_use]
    pub fn way(&self, arc: ArcId, departure_s: f64) -> &[Point3<f64>] {
        let after = self.departures_s.partition_point(|&t| t <= departure_s);
        let flights = self.flights.get(arc.index());
        let flight = flights.and_then(|flights| flights.get(after.saturating_sub(1)));
        flight.map_or(&[], |f| &f.way)
    }

    /// The arcs along which no way is made from any departure.
    #[must_use]
    pub fn blocked(&self) -> BTreeSet<ArcId> {
        let arcs = self.flights.iter().enumerate();
        let blocked = arcs.filter(|(_, flights)| flights.iter().all(|f| f.travel_s.is_infinite()));
        blocked.map(|(arc, _)| ArcId(arc as u32)).collect()
    }

    /// The travel times as profiles. Where a later departure arrives earlier, or no way is made yet, the time
    /// includes the wait until then. Blocked arcs have none.
    ///
    /// # Errors
    /// Departures that are not ascending.
    pub fn profiles(&self, name: impl Fn(ArcId) -> String) -> Result<Profiles, Violations> {
        let blocked = self.blocked();
        let arcs = (0..self.flights.len()).map(|arc| ArcId(arc as u32));
        let profile = |arc: ArcId| {
            let flights = &self.flights[arc.index()];
            let mut travel_s: Vec<f64> = flights.iter().map(|f| f.travel_s.min(NEVER_S)).collect();
            for k in (1..travel_s.len()).rev() {
                let wait_s = self.departures_s[k] - self.departures_s[k - 1];
                travel_s[k - 1] = travel_s[k - 1].min(wait_s + travel_s[k]);
            }
            (arc, travel_s)
        };
        let profiles = arcs.filter(|arc| !blocked.contains(arc)).map(profile);
        Profiles::new(self.departures_s.clone(), profiles.collect(), name)
    }
}

/// A way with its travel time, in pieces of at most `piece_m`.
fn flight(leg_time: &LegTime<'_>, way: Vec<Point3<f64>>, departure_s: f64, piece_m: f64) -> Flight {
    let mut fine = vec![way[0]];
    for pair in way.windows(2) {
        let pieces = libm::ceil((pair[1] - pair[0]).norm() / piece_m).max(1.0);
        let along =
            (1..=pieces as usize).map(|k| pair[0] + (pair[1] - pair[0]) * (k as f64 / pieces));
        fine.extend(along);
    }
    let travel_s = leg_time.travel_s(&fine, departure_s);
    Flight {
        travel_s: travel_s.unwrap_or(f64::INFINITY),
        way,
    }
}

/// The lattice over all waypoints, with the current.
struct Waters {
    lattice: Lattice,
    tide: Tide,
    stencil: Stencil,
    cell_m: f64,
    steady: bool,
    longest_s: f64,
    /// The lattice's node of each waypoint.
    nodes: Vec<usize>,
}

impl Waters {
    /// `None` in still water, and where the waypoints span no area.
    fn new(network: &Network, sea: &NetworkSea<'_>, departures_s: &[f64]) -> Option<Self> {
        let field = sea.leg_time.current?;
        let (first_s, last_s) = (*departures_s.first()?, *departures_s.last()?);
        let frame = frame(network, sea)?;
        let deadline = Deadline::default();
        let depths = Depths::ByRow(vec![frame.anchor.z; frame.counts[0]]);
        let mut lattice = Lattice::new(&frame, &depths, sea.bounds.as_ref(), sea.floor, deadline)?;
        let nodes = pinned(network, &frame, &mut lattice);
        let diagonal_m = frame.cell_m * libm::hypot(frame.counts[0] as f64, frame.counts[1] as f64);
        let crossing_s = diagonal_m / sea.leg_time.vehicle.speed_mps;
        let step_s = (last_s - first_s + 2.0 * crossing_s) / (TIMES - 1) as f64;
        let places = || nodes.iter().filter_map(|&node| lattice.place(node));
        let steady = places().all(|place| {
            let then = field.velocity_at(&place, first_s);
            (1..TIMES).all(|k| {
                let later = field.velocity_at(&place, first_s + step_s * k as f64);
                (later - then).norm() < STEADY_MPS
            })
        });
        let times = if steady { 1 } else { TIMES };
        let tide = Tide::new(field, &lattice, (first_s, step_s, times), deadline)?;
        Some(Self {
            stencil: Stencil::new(&lattice, REACH),
            lattice,
            tide,
            cell_m: frame.cell_m,
            steady,
            longest_s: PATIENCE * crossing_s,
            nodes,
        })
    }

    /// The front from a waypoint to the heads of its arcs.
    fn spread(
        &self,
        network: &Network,
        from: NodeId,
        departure_s: f64,
        vehicle: &Vehicle,
    ) -> Front<'_> {
        let mut front = Front::new(vehicle, &self.lattice, &self.tide);
        let arcs = &network.arcs()[network.range_from(from)];
        let goals: Vec<usize> = arcs
            .iter()
            .map(|arc| self.nodes[arc.head.index()])
            .collect();
        let spread = Spread {
            from: self.nodes[from.index()],
            goals: &goals,
            departure_s,
            latest_s: departure_s + self.longest_s,
            deadline: Deadline::default(),
        };
        if !goals.is_empty() {
            front.spread(&self.stencil, &spread, |_, _| true);
        }
        front
    }

    /// The way of an arc as a front found it; `None` if the front did not reach its head.
    fn way(
        &self,
        sea: &NetworkSea<'_>,
        network: &Network,
        front: &Front<'_>,
        arc: usize,
        departure_s: f64,
    ) -> Option<Vec<Point3<f64>>> {
        let arc = &network.arcs()[arc];
        let goal = self.nodes[arc.head.index()];
        if !front.time_s(goal).is_finite() {
            return None;
        }
        let flight = (sea.leg_time.vehicle.speed_mps, departure_s);
        let nodes = shortened(&self.lattice, &self.tide, flight, front.way_to(goal));
        let places = nodes.iter().filter_map(|&node| self.lattice.place(node));
        let mut way: Vec<Point3<f64>> = places.collect();
        let ends = [arc.tail, arc.head].map(|node| network.waypoints()[node.index()].position);
        let length_m: f64 = way.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        let mut gone_m = 0.0;
        for i in 0..way.len() {
            if i > 0 {
                gone_m += (way[i].xy() - way[i - 1].xy()).norm();
            }
            let depth_m = ends[0].z + (ends[1].z - ends[0].z) * (gone_m / length_m.max(1e-9));
            let floor_m = sea.floor.map_or(f64::INFINITY, |floor| {
                floor.deepest_at(way[i].x, way[i].y) - FLOOR_MARGIN_M
            });
            way[i].z = depth_m.min(floor_m);
        }
        let last = way.len() - 1;
        (way[0], way[last]) = (ends[0], ends[1]);
        Some(way)
    }
}

/// The frame over all waypoints at their mean depth, within the box. `None` where they span no area.
fn frame(network: &Network, sea: &NetworkSea<'_>) -> Option<Frame> {
    let places = || network.waypoints().iter().map(|waypoint| waypoint.position);
    let mut low = places().reduce(|a, b| a.inf(&b))?;
    let mut high = places().reduce(|a, b| a.sup(&b))?;
    let length_m = |arc: &NetworkArc| {
        let ends = [arc.tail, arc.head].map(|node| network.waypoints()[node.index()].position);
        (ends[1] - ends[0]).xy().norm()
    };
    let longest_m = network.arcs().iter().map(length_m).fold(0.0, f64::max);
    let beyond_m = BEYOND * longest_m;
    let mean_m = places().map(|place| place.z).sum::<f64>() / network.num_nodes() as f64;
    for k in 0..2 {
        (low[k], high[k]) = (low[k] - beyond_m, high[k] + beyond_m);
        if let Some(bounds) = &sea.bounds {
            (low[k], high[k]) = (low[k].max(bounds.low[k]), high[k].min(bounds.high[k]));
        }
    }
    let (north_m, east_m) = (high.x - low.x, high.y - low.y);
    let nodes = NODES.max(NODES_EACH * network.num_nodes() as f64);
    let cell_m = libm::sqrt(north_m * east_m / nodes).max(north_m.max(east_m) / nodes);
    (cell_m > 0.0).then(|| Frame {
        anchor: Point3::new(low.x, low.y, mean_m),
        anchor_node: [0, 0],
        ahead: Vector3::x(),
        side: Vector3::y(),
        cell_m,
        counts: [north_m, east_m].map(|m| (m / cell_m) as usize + 1),
    })
}

/// Moves to each waypoint the nearest node that is still free, and returns these nodes.
fn pinned(network: &Network, frame: &Frame, lattice: &mut Lattice) -> Vec<usize> {
    let mut taken = BTreeSet::new();
    let mut nodes = Vec::new();
    for waypoint in network.waypoints() {
        let at = frame.coordinates(&waypoint.position);
        let far = |&node: &usize| {
            let [row, column, _] = lattice.node(node);
            libm::hypot(row as f64 - at[0], column as f64 - at[1])
        };
        let free = (0..lattice.nodes()).filter(|node| !taken.contains(node));
        let node = free.min_by(|a, b| far(a).total_cmp(&far(b))).unwrap_or(0);
        taken.insert(node);
        let place = waypoint.position;
        lattice.pin(node, Point3::new(place.x, place.y, frame.anchor.z));
        nodes.push(node);
    }
    nodes
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Task, Waypoint};
    use auv_ocean::{AnalyticCurrent, CurrentField, TidalConstituent};

    /// Two waypoints 3 km apart to the north, both ways.
    fn pair() -> Network {
        let places = [0.0, 3_000.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
        let edge = Edge::undirected(0, 1, Task::TRANSIT);
        Network::new(&places, &[edge], 1.5).unwrap()
    }

    fn sea<'a>(vehicle: &'a Vehicle, current: &'a dyn CurrentField) -> NetworkSea<'a> {
        NetworkSea {
            leg_time: LegTime {
                vehicle,
                current: Some(current),
            },
            bounds: Some(Bounds::new(
                Point3::new(-1e3, -2e3, 0.0),
                Point3::new(4e3, 2e3, 60.0),
            )),
            floor: None,
        }
    }

    /// A southward jet of 2 m/s, 1 km wide, along the line between the waypoints.
    #[derive(Debug)]
    struct Jet;

    impl CurrentField for Jet {
        fn velocity_at(&self, place: &Point3<f64>, _: f64) -> Vector3<f64> {
            let share = libm::exp(-(place.y / 500.0) * (place.y / 500.0));
            Vector3::new(-2.0 * share, 0.0, 0.0)
        }

        fn max_speed_mps(&self) -> f64 {
            2.0
        }
    }

    #[test]
    fn the_way_leads_round_a_jet_that_is_stronger_than_the_vehicle() {
        let vehicle = Vehicle {
            speed_mps: 1.5,
            ..Vehicle::paper()
        };
        let network = pair();
        let fronts = NetworkFronts::new(
            &network,
            &sea(&vehicle, &Jet),
            &BTreeMap::new(),
            &[0.0, 600.0],
        );
        let [up, down] =
            [(0, 1), (1, 0)].map(|(a, b)| network.arc_between(NodeId(a), NodeId(b)).unwrap());
        assert_eq!(
            (fronts.departures_s(), fronts.blocked().len()),
            (&[0.0][..], 0)
        );
        // Round the jet, and with it. The path planner finds a way up of 3,562 s.
        let (up_s, down_s) = (fronts.travel_s(up, 0.0), fronts.travel_s(down, 500.0));
        assert!((3_500.0..3_650.0).contains(&up_s), "{up_s}");
        assert!((857.0..880.0).contains(&down_s), "{down_s}");
        let aside_m = fronts
            .way(up, 0.0)
            .iter()
            .map(|p| p.y.abs())
            .fold(0.0, f64::max);
        assert!(aside_m > 500.0, "{aside_m}");
        let profiles = fronts.profiles(|arc| arc.0.to_string()).unwrap();
        assert_eq!(profiles.of(up).unwrap().travel_s(9e9), up_s);
    }

    #[test]
    fn profiles_wait_for_a_tide_that_turns() {
        let vehicle = Vehicle {
            speed_mps: 1.5,
            ..Vehicle::paper()
        };
        // Against the way there at first, stronger than the vehicle.
        let tide = AnalyticCurrent {
            tide: vec![TidalConstituent {
                strongest_s: 0.0,
                ..TidalConstituent::turning_at(11_178.0, [-2.0, 0.0])
            }],
            ..AnalyticCurrent::default()
        };
        let network = pair();
        let times_s: Vec<f64> = (0..13).map(|k| 1_800.0 * f64::from(k)).collect();
        let fronts =
            NetworkFronts::new(&network, &sea(&vehicle, &tide), &BTreeMap::new(), &times_s);
        let arc = network.arc_between(NodeId(0), NodeId(1)).unwrap();
        assert_eq!(fronts.departures_s(), times_s);
        assert!(fronts.travel_s(arc, 0.0).is_infinite());
        let profiles = fronts.profiles(|arc| arc.0.to_string()).unwrap();
        let profile = profiles.of(arc).unwrap();
        // The vehicle gets there soon after slack.
        let arrives_s = profile.travel_s(0.0);
        assert!((8_000.0..12_500.0).contains(&arrives_s), "{arrives_s}");
        for pair in times_s.windows(2) {
            let arrival = |t: f64| t + profile.travel_s(t);
            assert!(arrival(pair[1]) >= arrival(pair[0]) - 1e-9);
        }
    }

    #[test]
    fn land_between_is_passed_on_either_side() {
        use auv_ocean::{AnalyticBed, BedFeature, Footprint, UniformCurrent};
        let vehicle = Vehicle::paper();
        let current = UniformCurrent::new(Vector3::new(0.2, 0.1, 0.0));
        let disc = Footprint::Disc {
            centre: [1_500.0, 0.0],
            radius_m: 400.0,
        };
        let bed = AnalyticBed::new(60.0).with(BedFeature::new("island", disc, -5.0, 100.0));
        let floor = Floor {
            bed: &bed,
            min_altitude_m: 3.0,
            altitude_sigmas: 0.0,
        };
        let sea = NetworkSea {
            floor: Some(floor),
            ..sea(&vehicle, &current)
        };
        let network = pair();
        let arc = network.arc_between(NodeId(0), NodeId(1)).unwrap();
        // A guide that leads far round.
        let corner = Point3::new(1_500.0, 1_900.0, 20.0);
        let places = network.waypoints();
        let guide = vec![places[0].position, corner, places[1].position];
        let fronts = NetworkFronts::new(&network, &sea, &[(arc, guide)].into(), &[0.0]);
        let way = fronts.way(arc, 0.0);
        let length_m: f64 = way.windows(2).map(|pair| (pair[1] - pair[0]).norm()).sum();
        assert!((3_100.0..3_400.0).contains(&length_m), "{length_m}");
        let sampled = way.windows(2).flat_map(|pair| {
            (0..=50).map(|k| pair[0] + (pair[1] - pair[0]) * (f64::from(k) / 50.0))
        });
        assert!(
            sampled
                .into_iter()
                .all(|p| floor.deepest_at(p.x, p.y) > 0.0)
        );
    }
}
