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
