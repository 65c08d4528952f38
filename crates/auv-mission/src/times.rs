//! How long edges take, as the route planner is told.

use crate::forecast::FieldForecast;
use crate::{Mission, SyncSettings};
use auv_graph::{ArcId, Network, NetworkArc, NodeId};
use auv_types::Point3;

/// Travel time of an arc in seconds at a mission time, with the forecast current where it moves the
/// vehicle; `None` where the arc cannot be made good against it.
pub(crate) fn travel_s(mission: &Mission, arc: ArcId, time_s: f64) -> Option<f64> {
    let edge = mission.network.arcs()[arc.index()];
    let straight = [
        mission.position_of(edge.tail),
        mission.position_of(edge.head),
    ];
    let way = mission
        .guides
        .get(&arc)
        .map_or(&straight[..], Vec::as_slice);
    way_s(mission, way, edge.distance_m, time_s)
}

/// Travel times in seconds of all arcs of `network` (the mission's, or one with the vehicle's place
/// added) at a mission time; `INFINITY` where an arc cannot be made good.
pub(crate) fn travel_times_s(
    mission: &Mission,
    network: &Network,
    time_s: f64,
) -> impl Iterator<Item = f64> {
    let known = mission.network.arcs().len();
    network.arcs().iter().enumerate().map(move |(i, arc)| {
        let travel_s = if i < known {
            travel_s(mission, ArcId(i as u32), time_s)
        } else {
            way_s(mission, &ends(network, arc), arc.distance_m, time_s)
        };
        travel_s.unwrap_or(f64::INFINITY)
    })
}

fn ends(network: &Network, arc: &NetworkArc) -> [Point3<f64>; 2] {
    [arc.tail, arc.head].map(|node| network.waypoints()[node.index()].position)
}

fn way_s(mission: &Mission, way: &[Point3<f64>], distance_m: f64, time_s: f64) -> Option<f64> {
    let Some(current) = &mission.current else {
        return Some(distance_m / mission.vehicle.speed_mps);
    };
    let speed_mps = mission.vehicle.speed_mps;
    let mut sum_s = 0.0;
    for pair in way.windows(2) {
        let length_m = (pair[1] - pair[0]).norm();
        if length_m <= 0.0 {
            continue;
        }
        let direction = (pair[1] - pair[0]) / length_m;
        let pieces = (length_m / 500.0).ceil().max(1.0);
        for k in 0..pieces as usize {
            let place = pair[0] + direction * (length_m * (k as f64 + 0.5) / pieces);
            let water = current.velocity_at(&place, time_s + sum_s);
            let along = water.dot(&direction);
            let left = speed_mps * speed_mps - (water - direction * along).norm_squared();
            let ground = along + left.max(0.0).sqrt();
            if left <= 0.0 || ground <= 0.05 * speed_mps {
                return None;
            }
            sum_s += length_m / pieces / ground;
        }
    }
    Some(sum_s)
}

/// Times of all arcs of `network` (the mission's, or one with the vehicle's place added) for a route
/// that starts at `time_s`: travel stretched by the detour margins, the planning, and the task; on the arcs that
/// leave the route's start, the delay that the forecast of the obstacles gives. `None` when they are
/// the network's own.
pub(crate) fn arc_times_s(
    mission: &Mission,
    settings: &SyncSettings,
    network: &Network,
    time_s: f64,
    (start, forecast): (NodeId, &FieldForecast<'_>),
) -> Option<Vec<f64>> {
    let each_s = settings.detour_margin_s + settings.planning_s;
    let stretched = settings.detour_margin > 0.0 || each_s > 0.0;
    if !stretched && mission.current.is_none() && forecast.is_empty() {
        return None;
    }
    let travel = travel_times_s(mission, network, time_s);
    let times = network.arcs().iter().zip(travel).map(|(arc, travel_s)| {
        if travel_s.is_infinite() {
            return travel_s;
        }
        let delay_s = if arc.tail == start {
            forecast.delay_s(ends(network, arc), time_s, travel_s)
        } else {
            0.0
        };
        travel_s * (1.0 + settings.detour_margin)
            + each_s
            + delay_s
            + network.task(arc.edge).completion_time_s
    });
    Some(times.collect())
}
