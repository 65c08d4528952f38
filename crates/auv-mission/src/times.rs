//! Arc times as given to route planners.

use crate::forecast::FieldForecast;
use crate::{Mission, SyncSettings};
use auv_graph::{ArcId, Network, NetworkArc, NodeId};
use auv_planning::{LegDuration, LegOutline, LegTime, NotFlyable, UnderWay};
use auv_types::Point3;

/// How long the leg along an arc of the mission's network takes, with its task, for a vehicle that starts it
/// at a mission time under way (`None`: free to leave in any direction).
///
/// # Errors
/// The arc cannot be flown against the current.
pub(crate) fn leg(
    mission: &Mission,
    arc: ArcId,
    time_s: f64,
    from: Option<UnderWay>,
) -> Result<LegDuration, NotFlyable> {
    let network = &mission.network;
    let straight = ends(network, &network.arcs()[arc.index()]);
    let leg = outline(mission, network, arc, time_s, &straight);
    mission.leg_time().of(&LegOutline { from, ..leg })
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

/// Times in seconds of all arcs of the mission's network in still water, with their tasks.
pub(crate) fn still_times_s(mission: &Mission) -> Vec<f64> {
    let still = Mission {
        current: None,
        ..mission.clone()
    };
    let legs = leg_durations(&still, &mission.network, mission.launch_s);
    legs.map(|leg| leg.map_or(f64::INFINITY, |leg| leg.total_s()))
        .collect()
}

/// How long the leg along each arc of `network` takes, with its task, when it starts at a mission time. Where
/// the vehicle comes from is not known yet: it arrives along the arc that leads on most nearly straight.
fn leg_durations(
    mission: &Mission,
    network: &Network,
    time_s: f64,
) -> impl Iterator<Item = Result<LegDuration, NotFlyable>> {
    let arrivals = Arrivals::new(mission, network);
    let arcs = 0..network.arcs().len() as u32;
    arcs.map(move |arc| leg_duration(mission, network, &arrivals, ArcId(arc), time_s))
}

pub(crate) fn leg_duration(
    mission: &Mission,
    network: &Network,
    arrivals: &Arrivals,
    arc: ArcId,
    departure_s: f64,
) -> Result<LegDuration, NotFlyable> {
    let straight = ends(network, &network.arcs()[arc.index()]);
    if mission.is_closed(arc) {
        let [place, _] = straight;
        return Err(NotFlyable { place });
    }
    let leg = outline(mission, network, arc, departure_s, &straight);
    mission.leg_time().of(&LegOutline {
        from: arrivals.straightest(network, arc, leg.guide),
        ..leg
    })
}

/// For each arc of the mission's network the guide given, what its turns and climbs take beyond the guide, and the
/// stay at its end, seconds; `None` where it is closed.
pub(crate) fn tidal_outlines(
    mission: &Mission,
) -> impl Iterator<Item = Option<(Vec<Point3<f64>>, f64, f64)>> {
    let network = &mission.network;
    let still = LegTime::in_still_water(&mission.vehicle);
    let arrivals = Arrivals::new(mission, network);
    network.arcs().iter().enumerate().map(move |(i, edge)| {
        let arc = ArcId(i as u32);
        let straight = ends(network, edge);
        let leg = outline(mission, network, arc, mission.launch_s, &straight);
        let leg = LegOutline {
            from: arrivals.straightest(network, arc, leg.guide),
            ..leg
        };
        let duration = still.of(&leg).ok().filter(|_| !mission.is_closed(arc))?;
        let more_s = duration.turns_s + duration.climbs_s;
        let given = mission
            .guides
            .get(&arc)
            .map_or(&straight[..], Vec::as_slice);
        Some((given.to_vec(), more_s, duration.stay_s))
    })
}

/// The leg along an arc, with its task, departing in any direction.
pub(crate) fn outline<'a>(
    mission: &'a Mission,
    network: &Network,
    arc: ArcId,
    departure_s: f64,
    straight: &'a [Point3<f64>; 2],
) -> LegOutline<'a> {
    let edge = &network.arcs()[arc.index()];
    let known = arc.index() < mission.network.arcs().len();
    let fronts = mission
        .fronts
        .as_deref()
        .filter(|_| mission.current.is_some());
    let is_line = known && mission.courses.lines.contains(&arc);
    let guide = match fronts {
        Some(fronts) if !is_line => Some(fronts.way(arc, departure_s)),
        _ => mission.guides.get(&arc).map(Vec::as_slice),
    };
    LegOutline {
        guide: guide
            .filter(|way| known && !way.is_empty())
            .unwrap_or(straight),
        length_m: edge.distance_m,
        departure_s,
        stay_s: network.task(edge.edge).completion_time_s,
        from: None,
        arrives: mission.arrival(known.then_some(arc), edge.head),
        speed_mps: mission.courses.speeds_mps.get(&arc).copied(),
    }
}

/// How a vehicle leaves the heads of all arcs, if it cannot turn on the spot.
#[derive(Debug)]
pub(crate) struct Arrivals {
    start: NodeId,
    /// By arc.
    leaves: Vec<Option<UnderWay>>,
    /// The arcs into each node.
    into: Vec<Vec<usize>>,
}

impl Arrivals {
    pub(crate) fn new(mission: &Mission, network: &Network) -> Self {
        let mut arrivals = Self {
            start: mission.start,
            leaves: Vec::new(),
            into: vec![Vec::new(); network.num_nodes()],
        };
        if mission.vehicle.turn_radius_m <= 0.0 {
            return arrivals;
        }
        for (i, arc) in network.arcs().iter().enumerate() {
            let straight = ends(network, arc);
            let leg = outline(
                mission,
                network,
                ArcId(i as u32),
                mission.launch_s,
                &straight,
            );
            arrivals.leaves.push(mission.leg_time().leaves(&leg));
            arrivals.into[arc.head.index()].push(i);
        }
        arrivals
    }

    /// How the vehicle begins an arc if it came along the arc that leads on most nearly straight; not back
    /// the way it came, unless nothing else leads there. `None` at the mission's start.
    fn straightest(
        &self,
        network: &Network,
        arc: ArcId,
        guide: &[Point3<f64>],
    ) -> Option<UnderWay> {
        let edge = &network.arcs()[arc.index()];
        if self.leaves.is_empty() || edge.tail == self.start {
            return None;
        }
        let ahead = guide.windows(2).next().map(|pair| pair[1] - pair[0])?;
        let reverses = |i: usize| network.arcs()[i].tail == edge.head;
        let along = |i: usize| self.leaves[i].map(|leaves| (i, leaves.velocity.dot(&ahead)));
        let into = &self.into[edge.tail.index()];
        let onwards = into.iter().filter_map(|&i| along(i));
        let best = onwards.max_by(|a, b| {
            reverses(b.0)
                .cmp(&reverses(a.0))
                .then(a.1.total_cmp(&b.1))
                .then(b.0.cmp(&a.0))
        });
        best.and_then(|(i, _)| self.leaves[i])
    }
}

/// What a route takes longer than its arc times say, seconds: its turns are those from leg to leg, beginning
/// `from` where and as the vehicle is under way.
pub(crate) fn turns_between_s(
    mission: &Mission,
    settings: &SyncSettings,
    network: &Network,
    nodes: &[NodeId],
    mut from: Option<UnderWay>,
) -> f64 {
    if mission.vehicle.turn_radius_m <= 0.0 {
        return 0.0;
    }
    let arrivals = Arrivals::new(mission, network);
    let mut more_s = 0.0;
    for pair in nodes.windows(2) {
        let Some(arc) = network.arc_between(pair[0], pair[1]) else {
            continue;
        };
        let straight = ends(network, &network.arcs()[arc.index()]);
        let leg = outline(mission, network, arc, mission.launch_s, &straight);
        let in_sequence = LegOutline { from, ..leg };
        let alone = LegOutline {
            from: arrivals.straightest(network, arc, leg.guide),
            ..leg
        };
        // The current changes both alike.
        let still = LegTime::in_still_water(&mission.vehicle);
        if let (Ok(in_sequence), Ok(alone)) = (still.of(&in_sequence), still.of(&alone)) {
            let under_way_s = in_sequence.under_way_s() - alone.under_way_s();
            more_s += under_way_s * (1.0 + settings.margins.detour_margin);
            more_s += in_sequence.stay_s - alone.stay_s;
        }
        from = still.leaves(&in_sequence);
    }
    more_s
}

pub(crate) fn ends(network: &Network, arc: &NetworkArc) -> [Point3<f64>; 2] {
    [arc.tail, arc.head].map(|node| network.waypoints()[node.index()].position)
}

/// Times in seconds of all arcs of `network` (the mission's, or one with the vehicle's place added) for
/// a route that starts at `time_s`. Each is the travel time stretched by the detour margins, the planning
/// time and the task time; arcs that leave the route's start also have the delay that the obstacles are
/// forecast to cause. `INFINITY` where an arc cannot be made good.
pub(crate) fn arc_times_s(
    mission: &Mission,
    settings: &SyncSettings,
    network: &Network,
    time_s: f64,
    (start, forecast): (NodeId, &FieldForecast<'_>),
) -> Vec<f64> {
    let each_s = settings.margins.detour_margin_s + settings.planning.planning_s;
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
    times.collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Fixture, place};
    use auv_obstacles::Region;
    use auv_ocean::UniformCurrent;
    use auv_types::Vector3;
    use std::sync::Arc;

    fn times_s(fixture: &Fixture, start: u32, regions: &[Region]) -> Vec<f64> {
        let (mission, settings) = (&fixture.mission, &fixture.settings);
        let forecast = FieldForecast::new(mission, settings, regions);
        let start = (NodeId(start), &forecast);
        arc_times_s(mission, settings, &mission.network, 50.0, start)
    }

    /// The time of the arc between two waypoints.
    fn between_s(fixture: &Fixture, times_s: &[f64], from: u32, to: u32) -> f64 {
        let arc = fixture
            .mission
            .network
            .arc_between(NodeId(from), NodeId(to));
        times_s[arc.unwrap().index()]
    }

    #[test]
    fn in_still_water_without_margins_arcs_take_the_network_s_own_times() {
        let fixture = Fixture::new();
        let network = &fixture.mission.network;
        let own = network.arcs().iter().map(|arc| arc.time_s);
        assert_eq!(times_s(&fixture, 0, &[]), own.collect::<Vec<f64>>());
    }

    #[test]
    fn an_arc_takes_travel_with_margins_planning_and_its_task() {
        let mut fixture = Fixture::new();
        fixture.settings.margins.detour_margin = 0.1;
        fixture.settings.margins.detour_margin_s = 2.0;
        fixture.settings.planning.planning_s = 4.0;
        let times_s = times_s(&fixture, 0, &[]);
        let between_s = |from, to| between_s(&fixture, &times_s, from, to);
        assert!((between_s(0, 1) - (330.0 + 2.0 + 4.0 + 60.0)).abs() < 1e-9);
        assert!((between_s(0, 2) - (660.0 + 2.0 + 4.0)).abs() < 1e-9);
    }

    #[test]
    fn obstacles_delay_only_arcs_that_leave_the_start() {
        let fixture = Fixture::new();
        let over_1 = [Region::ball(place(900.0), 50.0)];
        let found = times_s(&fixture, 0, &over_1);
        // The longest wait for a covered target is 600 s.
        assert_eq!(between_s(&fixture, &found, 0, 1), 300.0 + 60.0 + 600.0);
        assert_eq!(between_s(&fixture, &found, 2, 1), 300.0 + 60.0);
        let found = times_s(&fixture, 2, &over_1);
        assert_eq!(between_s(&fixture, &found, 0, 1), 300.0 + 60.0);
    }

    #[test]
    fn the_current_and_the_guide_change_the_travel_time() {
        let mut fixture = Fixture::new();
        let there = fixture.mission.network.arc_between(NodeId(0), NodeId(1));
        let back = fixture.mission.network.arc_between(NodeId(1), NodeId(0));
        let (there, back) = (there.unwrap(), back.unwrap());
        let travel_s = |mission: &Mission, arc, time_s| {
            let leg = leg(mission, arc, time_s, None);
            leg.ok().map(|leg| leg.under_way_s())
        };
        assert_eq!(travel_s(&fixture.mission, there, 0.0), Some(300.0));
        let flows = |mps: f64| Some(Arc::new(UniformCurrent::new(Vector3::x() * mps)) as _);
        fixture.mission.current = flows(1.5);
        assert_eq!(travel_s(&fixture.mission, there, 0.0), Some(200.0));
        assert_eq!(travel_s(&fixture.mission, back, 0.0), Some(600.0));
        fixture.mission.current = flows(3.5);
        assert_eq!(travel_s(&fixture.mission, back, 0.0), None);
        let all: Vec<f64> =
            travel_times_s(&fixture.mission, &fixture.mission.network, 0.0).collect();
        assert!(all[there.index()].is_finite() && all[back.index()].is_infinite());
        let times_s = times_s(&fixture, 0, &[]);
        assert!(times_s[back.index()].is_infinite());
        // Round a corner 1200 m east, across a current that carries the vehicle.
        fixture.mission.current = flows(1.8);
        let mut corner = place(450.0);
        corner.y = 1_200.0;
        let guide = vec![place(0.0), corner, place(900.0)];
        fixture.mission.guides.insert(there, guide);
        let guided_s = travel_s(&fixture.mission, there, 0.0).unwrap();
        assert!(guided_s > 400.0, "{guided_s} s");
    }
}
