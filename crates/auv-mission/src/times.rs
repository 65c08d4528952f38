//! Arc times as given to route planners.

use crate::forecast::FieldForecast;
use crate::{Mission, SyncSettings};
use auv_graph::{ArcId, Network, NetworkArc, NodeId};
use auv_planning::{LegDuration, LegOutline, NotFlyable};
use auv_types::Point3;

/// Travel time of an arc in seconds in the current as forecast for a mission time; `None` where the arc
/// cannot be flown against the current.
pub(crate) fn travel_s(mission: &Mission, arc: ArcId, time_s: f64) -> Option<f64> {
    let leg = leg_duration(mission, &mission.network, arc, time_s);
    leg.ok().map(|leg| leg.under_way_s())
}

/// Travel times in seconds of all arcs of `network` (the mission's, or one with the vehicle's place
/// added) at a mission time; `INFINITY` where an arc cannot be flown against the current.
pub(crate) fn travel_times_s(
    mission: &Mission,
    network: &Network,
    time_s: f64,
) -> impl Iterator<Item = f64> {
    leg_durations(mission, network, time_s)
        .map(|leg| leg.map_or(f64::INFINITY, |leg| leg.under_way_s()))
}

/// How long the leg along each arc of `network` takes, with its task, when it starts at a mission time.
fn leg_durations(
    mission: &Mission,
    network: &Network,
    time_s: f64,
) -> impl Iterator<Item = Result<LegDuration, NotFlyable>> {
    let arcs = 0..network.arcs().len() as u32;
    arcs.map(move |arc| leg_duration(mission, network, ArcId(arc), time_s))
}

fn leg_duration(
    mission: &Mission,
    network: &Network,
    arc: ArcId,
    departure_s: f64,
) -> Result<LegDuration, NotFlyable> {
    let edge = &network.arcs()[arc.index()];
    let straight = ends(network, edge);
    let guide = mission
        .guides
        .get(&arc)
        .filter(|_| arc.index() < mission.network.arcs().len());
    let leg = LegOutline {
        guide: guide.map_or(&straight[..], Vec::as_slice),
        length_m: edge.distance_m,
        departure_s,
        stay_s: network.task(edge.edge).completion_time_s,
    };
    mission.leg_time().of(&leg)
}

fn ends(network: &Network, arc: &NetworkArc) -> [Point3<f64>; 2] {
    [arc.tail, arc.head].map(|node| network.waypoints()[node.index()].position)
}

/// Times in seconds of all arcs of `network` (the mission's, or one with the vehicle's place added) for
/// a route that starts at `time_s`. Each is the travel time stretched by the detour margins, the planning
/// time and the task time; arcs that leave the route's start also have the delay that the obstacles are
/// forecast to cause. `None` if they are the network's own times.
pub(crate) fn arc_times_s(
    mission: &Mission,
    settings: &SyncSettings,
    network: &Network,
    time_s: f64,
    (start, forecast): (NodeId, &FieldForecast<'_>),
) -> Option<Vec<f64>> {
    let each_s = settings.margins.detour_margin_s + settings.planning.planning_s;
    let stretched = settings.margins.detour_margin > 0.0 || each_s > 0.0;
    if !stretched && mission.current.is_none() && forecast.is_empty() {
        return None;
    }
    let legs = leg_durations(mission, network, time_s);
    let times = network.arcs().iter().zip(legs).map(|(arc, leg)| {
        let Ok(leg) = leg else {
            return f64::INFINITY;
        };
        let travel_s = leg.under_way_s();
        let delay_s = if arc.tail == start {
            forecast.delay_s(ends(network, arc), time_s, travel_s)
        } else {
            0.0
        };
        travel_s * (1.0 + settings.margins.detour_margin) + each_s + delay_s + leg.stay_s
    });
    Some(times.collect())
}
