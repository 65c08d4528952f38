//! Legs by departure, where the current changes so much with time that it matters.

use crate::{Mission, times};
use auv_graph::{ArcId, Network, NodeId, Profiles, TimeModel};
use auv_ocean::{CurrentField, ForecastError, Perturbed};
use auv_planning::motion::travel_time_s;
use auv_types::Point3;
use std::collections::BTreeMap;

/// Legs depend on the departure where the current somewhere on their way changes by this share of the cruising
/// speed or more during the mission. Below, the margins of the legs cover the change.
const MATTERS: f64 = 0.75;
/// A vehicle holds a place against a current of this share of its cruising speed.
const HOLDS: f64 = 0.9;
/// Departures are sampled over this many times the mission's budget, in so many steps, but not more often
/// than every [`LEAST_STEP_S`].
const HORIZON: f64 = 1.5;
const STEPS: f64 = 64.0;
const LEAST_STEP_S: f64 = 120.0;
/// The vehicle waits where that brings it to the end of the leg earlier by this, seconds.
const LEAST_GAIN_S: f64 = 1.0;
/// The time of a leg that is not flown at a departure or any later one, seconds.
const NEVER_S: f64 = 1e9;

/// Share and seconds that are added to the travel time of each leg.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) share: f64,
    pub(crate) each_s: f64,
}

/// How long legs take by departure, and the way home from each waypoint.
///
/// Each leg takes as long as in the worst of the currents that may be met. It is flown where the vehicle makes
/// way all along it and can hold its place at its end, for the stay too. A vehicle that cannot depart yet waits
/// at the start of the leg as long as it can hold its place there.
/// So who leaves later never arrives earlier.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Tide {
    /// Departures, mission time in seconds, ascending.
    times_s: Vec<f64>,
    stretch: Stretch,
    /// By arc; empty where it is never flown.
    legs: Vec<TidalLeg>,
    /// By waypoint: time of the quickest way home at each departure, without tasks; infinite where there is
    /// none.
    home_s: Vec<Vec<f64>>,
}

#[derive(Clone, Debug, Default, PartialEq)]
struct TidalLeg {
    /// From each departure to the arrival, the wait included, seconds.
    travel_s: Vec<f64>,
    /// Whether a vehicle that could depart then waits.
    waits: Vec<bool>,
    /// Stay at the end, seconds.
    stay_s: f64,
}

impl Tide {
    /// `None` where the current does not change enough to matter.
    pub(crate) fn of(mission: &Mission, stretch: Stretch) -> Option<Self> {
        if !matters(mission) {
            return None;
        }
        let network = &mission.network;
        let mut tide = Self {
            times_s: departures_s(mission),
            stretch,
            legs: Vec::new(),
            home_s: Vec::new(),
        };
        let mut places_hold: Vec<Vec<bool>> = network
            .waypoints()
            .iter()
            .map(|waypoint| tide.holds(mission, waypoint.position))
            .collect();
        // There it is at launch, whether it can stay or not.
        places_hold[mission.start.index()][0] = true;
        let outlines = times::tidal_outlines(mission);
        for ((i, arc), outline) in network.arcs().iter().enumerate().zip(outlines) {
            let leg = outline.map(|(guide, more_s, stay_s)| {
                let mut raw_s = tide.sampled_s(mission, &guide, Some(ArcId(i as u32)), more_s);
                tide.end_where_it_holds(&mut raw_s, &places_hold[arc.head.index()], stay_s);
                tide.leg(raw_s, &places_hold[arc.tail.index()], stay_s)
            });
            tide.legs.push(leg.unwrap_or_default());
        }
        tide.home_s = tide.ways_home(mission, &places_hold);
        Some(tide)
    }

    /// Whether the vehicle can hold a place at each departure.
    fn holds(&self, mission: &Mission, place: Point3<f64>) -> Vec<bool> {
        let most_mps = HOLDS * mission.vehicle.speed_mps;
        let speed_mps = |time_s: f64| {
            let speeds = possible(mission).map(|water| water.velocity_at(&place, time_s).norm());
            speeds.fold(0.0, f64::max)
        };
        self.times_s
            .iter()
            .map(|&t| speed_mps(t) <= most_mps)
            .collect()
    }

    /// Time along a guide, or the way along an arc that a front finds, at each departure, with the margins; infinite where
    /// neither is flown.
    fn sampled_s(
        &self,
        mission: &Mission,
        guide: &[Point3<f64>],
        arc: Option<ArcId>,
        more_s: f64,
    ) -> Vec<f64> {
        let fronts = mission.fronts.as_deref().zip(arc);
        let at = |&time_s: &f64| {
            let way = fronts.map(|(fronts, arc)| fronts.way(arc, time_s));
            let ways = std::iter::once(guide).chain(way);
            let quickest_s = ways
                .map(|way| self.along_s(mission, way, time_s))
                .fold(f64::INFINITY, f64::min);
            quickest_s + self.stretched(more_s)
        };
        self.times_s.iter().map(at).collect()
    }

    fn along_s(&self, mission: &Mission, guide: &[Point3<f64>], time_s: f64) -> f64 {
        let speed_mps = mission.vehicle.speed_mps;
        let each = possible(mission).map(|water| {
            let travel_s = travel_time_s(guide, &water, speed_mps, time_s);
            travel_s.unwrap_or(f64::INFINITY)
        });
        self.stretched(each.fold(0.0, f64::max)) + self.stretch.each_s
    }

    fn stretched(&self, travel_s: f64) -> f64 {
        travel_s * (1.0 + self.stretch.share)
    }

    /// Takes out the departures after which the vehicle could not hold its place at the end.
    fn end_where_it_holds(&self, travel_s: &mut [f64], head_holds: &[bool], stay_s: f64) {
        let last = self.times_s.len() - 1;
        let holds = |time_s: f64| {
            let after = self.times_s.partition_point(|&t| t < time_s);
            head_holds[after.saturating_sub(1)] && head_holds[after.min(last)]
        };
        for (departure_s, travel_s) in self.times_s.iter().zip(travel_s) {
            let arrival_s = departure_s + *travel_s;
            if travel_s.is_finite() && !(holds(arrival_s) && holds(arrival_s + stay_s)) {
                *travel_s = f64::INFINITY;
            }
        }
    }

    /// A leg from its times without waiting.
    fn leg(&self, mut travel_s: Vec<f64>, tail_holds: &[bool], stay_s: f64) -> TidalLeg {
        let mut waits = vec![false; travel_s.len()];
        for k in (0..travel_s.len().saturating_sub(1)).rev() {
            let waiting_s = travel_s[k + 1] + self.times_s[k + 1] - self.times_s[k];
            // Nowhere is the vehicle where it cannot hold its place.
            let loses_hold = tail_holds[k] && !tail_holds[k + 1];
            if !loses_hold && waiting_s < travel_s[k] - LEAST_GAIN_S {
                (travel_s[k], waits[k]) = (waiting_s, true);
            }
        }
        if travel_s.iter().all(|s| s.is_infinite()) {
            return TidalLeg::default();
        }
        // First in, first out: where waiting is not possible, a later departure counts as no better.
        for k in 1..travel_s.len() {
            let before_s = travel_s[k - 1] + self.times_s[k - 1] - self.times_s[k];
            travel_s[k] = travel_s[k].max(before_s);
        }
        for s in travel_s.iter_mut().filter(|s| s.is_infinite()) {
            *s = NEVER_S;
        }
        TidalLeg {
            travel_s,
            waits,
            stay_s,
        }
    }

    /// The quickest ways home by departure: those of the heads are improved until no leg gains.
    fn ways_home(&self, mission: &Mission, places_hold: &[Vec<bool>]) -> Vec<Vec<f64>> {
        let network = &mission.network;
        let steps = self.times_s.len();
        let mut home_s = vec![vec![f64::INFINITY; steps]; network.num_nodes()];
        if mission.open_water {
            for (node, home_s) in home_s.iter_mut().enumerate() {
                for dock in mission.all_docks() {
                    let guide = [node, dock.index()].map(|end| network.waypoints()[end].position);
                    let leg = self.leg(
                        self.sampled_s(mission, &guide, None, 0.0),
                        &places_hold[node],
                        0.0,
                    );
                    let reached = leg.travel_s.into_iter().zip(home_s.iter_mut());
                    reached.for_each(|(travel_s, home_s)| *home_s = home_s.min(known(travel_s)));
                }
            }
        }
        for dock in mission.all_docks() {
            home_s[dock.index()] = vec![0.0; steps];
        }
        if mission.open_water {
            return home_s;
        }
        for _ in 0..network.num_nodes() {
            let mut gained = false;
            for (leg, arc) in self.legs.iter().zip(network.arcs()) {
                for k in 0..leg.travel_s.len() {
                    let there_s = self.times_s[k] + leg.travel_s[k];
                    let onward_s = self.at(&home_s[arc.head.index()], there_s);
                    let way_s = known(leg.travel_s[k]) + onward_s;
                    let best_s = &mut home_s[arc.tail.index()][k];
                    if way_s < *best_s {
                        (*best_s, gained) = (way_s, true);
                    }
                }
            }
            if !gained {
                break;
            }
        }
        home_s
    }

    /// A value at a departure: linear between those given, constant outside.
    fn at(&self, values: &[f64], time_s: f64) -> f64 {
        let times = &self.times_s;
        let after = times.partition_point(|&t| t < time_s);
        if after == 0 || after == times.len() {
            return values[after.min(times.len() - 1)];
        }
        let (first, last) = (values[after - 1], values[after]);
        if first.is_infinite() || last.is_infinite() {
            return f64::INFINITY;
        }
        let share = (time_s - times[after - 1]) / (times[after] - times[after - 1]);
        first + (last - first) * share
    }

    /// From a departure along an arc of the mission to the arrival, a wait before included, seconds; infinite
    /// where it is not flown from then on.
    pub(crate) fn travel_s(&self, arc: ArcId, departure_s: f64) -> f64 {
        match self.legs.get(arc.index()) {
            Some(leg) if !leg.travel_s.is_empty() => known(self.at(&leg.travel_s, departure_s)),
            _ => f64::INFINITY,
        }
    }

    /// When a vehicle at the start of an arc departs that could at `time_s`.
    pub(crate) fn leaves_s(&self, arc: ArcId, time_s: f64) -> f64 {
        let after = self.times_s.partition_point(|&t| t < time_s);
        let leg = self.legs.get(arc.index());
        let Some(leg) = leg.filter(|leg| after < leg.waits.len()) else {
            return time_s;
        };
        let before = if self.times_s[after] > time_s {
            after.saturating_sub(1)
        } else {
            after
        };
        if !leg.waits[before] {
            return time_s;
        }
        let open = (after..leg.waits.len()).find(|&k| !leg.waits[k]);
        open.map_or(time_s, |k| self.times_s[k])
    }

    /// Time of the quickest way home from a waypoint, tasks left undone, seconds; infinite where there is none.
    pub(crate) fn home_s(&self, node: NodeId, departure_s: f64) -> f64 {
        self.at(&self.home_s[node.index()], departure_s)
    }

    /// The quickest way home over `network`: the mission's, or one with the vehicle's place added.
    pub(crate) fn way_home(
        &self,
        mission: &Mission,
        network: &Network,
        from: NodeId,
        departure_s: f64,
    ) -> Option<Vec<NodeId>> {
        let (mut nodes, mut at, mut time_s) = (vec![from], from, departure_s);
        while !mission.is_dock(at) {
            let next = network.range_from(at).filter_map(|arc| {
                let head = network.heads()[arc];
                let arrival_s = time_s + self.any_travel_s(mission, network, arc, time_s);
                let home_s = arrival_s + self.home_s(head, arrival_s);
                (home_s.is_finite() && !nodes.contains(&head)).then_some((home_s, arrival_s, head))
            });
            let (_, arrival_s, head) = next.min_by(|a, b| a.0.total_cmp(&b.0))?;
            nodes.push(head);
            (at, time_s) = (head, arrival_s);
        }
        Some(nodes)
    }

    /// Travel time along an arc of the mission, or straight along one from the vehicle's place.
    fn any_travel_s(&self, mission: &Mission, network: &Network, arc: usize, time_s: f64) -> f64 {
        if arc < self.legs.len() {
            return self.travel_s(ArcId(arc as u32), time_s);
        }
        self.straight_s(mission, times::ends(network, &network.arcs()[arc]), time_s)
    }

    /// Time straight from a place to another, seconds: the earliest departure that arrives counts, the wait
    /// before included. Infinite where there is none.
    pub(crate) fn straight_s(
        &self,
        mission: &Mission,
        guide: [Point3<f64>; 2],
        time_s: f64,
    ) -> f64 {
        let later = self.times_s.iter().copied().filter(|&t| t > time_s);
        let mut departures = std::iter::once(time_s).chain(later);
        let arrives = departures.find_map(|t| {
            let travel_s = self.along_s(mission, &guide, t);
            travel_s.is_finite().then_some(t - time_s + travel_s)
        });
        arrives.unwrap_or(f64::INFINITY)
    }

    /// Times of all arcs of `network` for a route that leaves `start` at a time, with their tasks; arcs that
    /// leave the start also have the delay that `delay_s` tells.
    pub(crate) fn arc_times_s(
        &self,
        mission: &Mission,
        network: &Network,
        (start, time_s): (NodeId, f64),
        delay_s: impl Fn([Point3<f64>; 2], f64) -> f64,
    ) -> Vec<f64> {
        let times = network.arcs().iter().enumerate().map(|(i, arc)| {
            let leg = self.legs.get(i);
            let travel_s = self.any_travel_s(mission, network, i, time_s);
            // An arc that is flown later only stays in the network.
            let flown = leg.is_some_and(|leg| !leg.travel_s.is_empty());
            let travel_s = if flown {
                travel_s.min(NEVER_S)
            } else {
                travel_s
            };
            let waits_s = if arc.tail == start && travel_s < NEVER_S {
                delay_s(times::ends(network, arc), travel_s)
            } else {
                0.0
            };
            travel_s + waits_s + leg.map_or(0.0, |leg| leg.stay_s)
        });
        times.collect()
    }

    /// The model of a route that leaves `start` at a time, and whose arcs take `arcs_s` if they are left then.
    pub(crate) fn model(
        &self,
        network: &Network,
        (start, time_s): (NodeId, f64),
        arcs_s: &[f64],
    ) -> TimeModel {
        let first = self
            .times_s
            .partition_point(|&t| t <= time_s)
            .saturating_sub(1);
        let from_start_s = |t: &f64| t - time_s;
        let times_s: Vec<f64> = self.times_s[first..].iter().map(from_start_s).collect();
        let mut travel = BTreeMap::new();
        for (i, leg) in self
            .legs
            .iter()
            .enumerate()
            .filter(|(_, leg)| !leg.travel_s.is_empty())
        {
            let arc = &network.arcs()[i];
            let own_s = network.task(arc.edge).completion_time_s;
            let known_s = self.travel_s(ArcId(i as u32), time_s).min(NEVER_S) + leg.stay_s;
            let delay_s = if arc.tail == start {
                (arcs_s[i] - known_s).max(0.0)
            } else {
                0.0
            };
            let more_s = leg.stay_s - own_s + delay_s;
            let travel_s = leg.travel_s[first..].iter().map(|s| (s + more_s).max(0.0));
            travel.insert(ArcId(i as u32), travel_s.collect());
        }
        let name = |arc: ArcId| format!("arc {}", arc.0);
        TimeModel {
            // Sampled first in, first out.
            profiles: Profiles::new(times_s, travel, name).unwrap_or_default(),
            ..TimeModel::default()
        }
    }
}

/// The currents that may be met: the forecast with the largest typical errors.
fn possible(mission: &Mission) -> impl Iterator<Item = Perturbed<&dyn CurrentField>> {
    let forecast = mission.current.as_deref().into_iter();
    forecast
        .flat_map(|forecast| ForecastError::largest().map(|error| Perturbed::new(forecast, error)))
}

/// A time, infinite where it stands for never.
fn known(time_s: f64) -> f64 {
    if time_s >= 0.5 * NEVER_S {
        f64::INFINITY
    } else {
        time_s
    }
}

/// Departures of a mission, mission time in seconds.
fn departures_s(mission: &Mission) -> Vec<f64> {
    let horizon_s = HORIZON * mission.budget_s;
    let step_s = (horizon_s / STEPS).max(LEAST_STEP_S);
    let steps = (horizon_s / step_s).ceil().max(1.0) as usize;
    let times = (0..=steps).map(|k| mission.launch_s + step_s * k as f64);
    times.collect()
}

/// Whether the current at a waypoint or on the way of a leg changes so much during the mission that it matters.
fn matters(mission: &Mission) -> bool {
    let Some(current) = &mission.current else {
        return false;
    };
    let least_mps = MATTERS * mission.vehicle.speed_mps;
    if 2.0 * current.max_speed_mps() < least_mps {
        return false;
    }
    let end_s = mission.launch_s + mission.budget_s;
    let times_s = departures_s(mission);
    let changes = |place: &Point3<f64>| {
        let at_launch = current.velocity_at(place, mission.launch_s);
        let mut later = times_s.iter().filter(|&&t| t <= end_s);
        later.any(|&t| (current.velocity_at(place, t) - at_launch).norm() >= least_mps)
    };
    let network = &mission.network;
    let halfway = network.arcs().iter().map(|arc| {
        let [tail, head] = times::ends(network, arc);
        tail + (head - tail) * 0.5
    });
    let waypoints = network.waypoints().iter().map(|waypoint| waypoint.position);
    let mut places = waypoints.chain(halfway);
    places.any(|place| changes(&place)) || mission.guides.values().flatten().any(changes)
}

#[cfg(test)]
mod tests;
