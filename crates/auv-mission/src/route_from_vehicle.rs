//! Routes that start at the vehicle's own place, in the middle of a leg.

use crate::{Mission, times};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_planning::{LegOutline, LegTime};
use auv_types::{Point3, Violations};
use std::sync::Arc;

/// The network with the vehicle's place as one more node, the last, and where a route from there
/// starts. Transit arcs lead from it to the anchors; ids of the mission's nodes, edges and arcs keep
/// their meaning. Where no such network can be made: the mission's own and the waypoint given.
pub(crate) fn network(
    mission: &Mission,
    place: Point3<f64>,
    anchors: &[NodeId],
    waypoint: NodeId,
) -> (Arc<Network>, NodeId) {
    match extended(&mission.network, place, anchors) {
        Ok(network) => {
            let here = NodeId(network.num_nodes() as u32 - 1);
            (Arc::new(network), here)
        }
        Err(_) => (Arc::clone(&mission.network), waypoint),
    }
}

fn extended(
    network: &Network,
    place: Point3<f64>,
    anchors: &[NodeId],
) -> Result<Network, Violations> {
    let here = network.num_nodes() as u32;
    let mut waypoints = network.waypoints().to_vec();
    waypoints.push(Waypoint {
        position: place,
        name: "here".into(),
    });
    let mut edges = network.edges().to_vec();
    edges.extend(
        anchors
            .iter()
            .map(|anchor| Edge::directed(here, anchor.0, Task::TRANSIT)),
    );
    Network::new(&waypoints, &edges, network.speed_mps())
}

/// Least travel time home in seconds by node, doing no tasks, in the current forecast for a time;
/// straight from everywhere in open water.
pub(crate) fn home_times_s(mission: &Mission, time_s: f64) -> Vec<f64> {
    let network = &mission.network;
    if mission.open_water {
        let docks = || mission.all_docks().map(|dock| mission.position_of(dock));
        let still = LegTime::in_still_water(&mission.vehicle);
        let home = network.waypoints().iter().map(|waypoint| {
            let each = docks().map(|dock| {
                let guide = [waypoint.position, dock];
                let leg = still.of(&LegOutline::straight(&guide, time_s));
                leg.map_or(f64::INFINITY, |leg| leg.under_way_s())
            });
            each.fold(f64::INFINITY, f64::min)
        });
        return home.collect();
    }
    let travel_s: Vec<f64> = times::travel_times_s(mission, network, time_s).collect();
    let nothing = auv_graph::EdgeSet::empty();
    let to = |dock| network.quickest_to(dock, &nothing, Some(&travel_s));
    let mut home_s = to(mission.destination).times_s().to_vec();
    for &dock in &mission.docks {
        for (home_s, other_s) in home_s.iter_mut().zip(to(dock).times_s()) {
            *home_s = home_s.min(*other_s);
        }
    }
    home_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_graph::ArcId;

    #[test]
    fn home_is_the_dock_that_is_reached_first() {
        let mut mission = Fixture::with_timed_tasks().mission;
        for open_water in [true, false] {
            mission.open_water = open_water;
            let of = |mission: &Mission, dock, docks: &[u32]| {
                let mut mission = mission.clone();
                mission.destination = NodeId(dock);
                mission.docks = docks.iter().copied().map(NodeId).collect();
                home_times_s(&mission, 0.0)
            };
            // No route leads on from a dock; the arcs between the two are left out for each alone as well.
            for (i, arc) in mission.network.arcs().iter().enumerate() {
                if !open_water && arc.tail != NodeId(0) {
                    mission.closed.insert(ArcId(i as u32));
                }
            }
            let each = [of(&mission, 1, &[]), of(&mission, 2, &[])];
            let both = of(&mission, 1, &[2]);
            let least: Vec<f64> = (0..3).map(|i| each[0][i].min(each[1][i])).collect();
            assert_eq!(both, least, "open water: {open_water}");
            assert_eq!(both, of(&mission, 2, &[1]));
            assert!(both[0] >= 300.0 && both[1] == 0.0 && both[2] == 0.0);
        }
    }

    #[test]
    fn the_place_of_the_vehicle_is_one_more_node_with_arcs_to_its_anchors() {
        let mission = Fixture::new().mission;
        let place = Point3::new(300.0, 40.0, 20.0);
        let (with, here) = network(&mission, place, &[NodeId(0), NodeId(1)], NodeId(0));
        assert_eq!((here, with.num_nodes()), (NodeId(3), 4));
        assert_eq!(with.waypoints()[3].position, place);
        let heads: Vec<NodeId> = with.arcs_from(here).map(|(_, arc)| arc.head).collect();
        assert_eq!(heads, [0, 1].map(NodeId));
        // Ids keep their meaning.
        let old = &mission.network;
        assert_eq!(with.edges()[..old.num_edges()], *old.edges());
        for (i, arc) in old.arcs().iter().enumerate() {
            assert_eq!(with.arc_between(arc.tail, arc.head), Some(ArcId(i as u32)));
        }
        // A place that no network can hold leaves the mission's own.
        let nowhere = Point3::new(f64::NAN, 0.0, 0.0);
        let (same, start) = network(&mission, nowhere, &[NodeId(0)], NodeId(1));
        assert!(Arc::ptr_eq(&same, old) && start == NodeId(1));
    }
}
