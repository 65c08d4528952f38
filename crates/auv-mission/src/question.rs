//! Questions to planners, as they are kept until they are answered.
//!
//! An answer is judged against the question that was asked, not against later observations.

use crate::tide::Tide;
use crate::{Mission, PathRequest, RouteReason, RouteRequest, agenda, route_from_vehicle};
use auv_graph::{EdgeSet, Network, NodeId, Route, TimeModel};
use auv_obstacles::Region;
use auv_planning::{Budget, Trajectory};
use auv_types::{Bounds, Point3, Seed, Vector3};
use std::sync::Arc;

/// A question to the route planner.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct RouteQuestion {
    pub(crate) id: u64,
    pub(crate) reason: RouteReason,
    pub(crate) from: RouteFrom,
    /// The waypoint where the route starts; for a route from the vehicle's own place, the last waypoint.
    pub(crate) waypoint: NodeId,
    pub(crate) removed: EdgeSet,
    /// Times of all arcs, seconds; empty if they are the network's.
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number::list"))]
    pub(crate) times_s: Vec<f64>,
    /// When the route starts, mission time in seconds.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) departs_s: f64,
    #[cfg_attr(feature = "serde", serde(with = "crate::any_number"))]
    pub(crate) time_available_s: f64,
    pub(crate) incumbent: Option<Route>,
    pub(crate) budget: Budget,
    /// The tasks of the mission's model that it may do.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) open: Vec<usize>,
}

/// Where a route starts.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) enum RouteFrom {
    /// At the last waypoint reached.
    Waypoint,
    /// At the vehicle's own place, in the middle of a leg given up.
    Vehicle(DroppedLeg, Point3<f64>),
    /// At the target of the leg being flown, when it is reached.
    Target,
}

/// What is kept of a leg given up, for a route from the vehicle's own place.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct DroppedLeg {
    /// Waypoints that the route may lead to first.
    pub(crate) anchors: Vec<NodeId>,
    /// The leg's target and when the trajectory in force would have reached it.
    pub(crate) known_arrival: Option<(NodeId, f64)>,
}

impl RouteQuestion {
    /// The network that the route is asked on, and where it starts there.
    pub(crate) fn network(&self, mission: &Mission) -> (Arc<Network>, NodeId) {
        match &self.from {
            RouteFrom::Vehicle(dropped, place) => {
                route_from_vehicle::network(mission, *place, &dropped.anchors, self.waypoint)
            }
            RouteFrom::Waypoint | RouteFrom::Target => {
                (Arc::clone(&mission.network), self.waypoint)
            }
        }
    }

    /// Travel times by departure where they matter, and the tasks that are planned in time.
    fn time_model(
        &self,
        mission: &Mission,
        tide: Option<&Tide>,
        (network, start): (&Network, NodeId),
    ) -> Option<TimeModel> {
        let departs = (start, self.departs_s);
        let tidal = tide.map(|tide| tide.model(network, departs, &self.times_s));
        let Some(whole) = &mission.time_model else {
            return tidal;
        };
        let docks = mission.all_docks().filter(|_| !mission.docks.is_empty());
        Some(TimeModel {
            tasks: agenda::tasks(whole, &self.open, self.departs_s),
            chains: whole.chains.clone(),
            destinations: docks.collect(),
            ..tidal.unwrap_or_default()
        })
    }

    /// The request as a planner takes it.
    pub(crate) fn request(
        &self,
        mission: &Mission,
        tide: Option<&Tide>,
        seed: Seed,
    ) -> RouteRequest {
        let (network, start) = self.network(mission);
        RouteRequest {
            id: self.id,
            removed: self.removed.clone(),
            times: Some(self.times_s.clone()),
            time_model: self
                .time_model(mission, tide, (&network, start))
                .map(Arc::new),
            network,
            start,
            destination: mission.destination,
            time_available_s: self.time_available_s,
            incumbent: self.incumbent.clone(),
            seed: seed.split(self.id),
            budget: self.budget,
        }
    }
}

/// A question to the path planner.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct PathQuestion {
    pub(crate) id: u64,
    /// The place near the covered target to which the path leads; `None` for the target itself.
    pub(crate) stand_off: Option<Point3<f64>>,
    pub(crate) bounds: Option<Bounds>,
    pub(crate) min_altitude_m: f64,
    pub(crate) altitude_sigmas: f64,
    pub(crate) start: Point3<f64>,
    pub(crate) start_velocity: Option<Vector3<f64>>,
    pub(crate) target: Point3<f64>,
    pub(crate) departure_s: f64,
    pub(crate) regions: Arc<[Region]>,
    pub(crate) clearance_m: f64,
    pub(crate) warm_start: Option<Arc<Trajectory>>,
    pub(crate) budget: Budget,
    /// Speed through the water, m/s; `None`: cruising speed.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) speed_mps: Option<f64>,
}

impl PathQuestion {
    /// The request as a planner takes it.
    pub(crate) fn request(&self, mission: &Arc<Mission>, seed: Seed) -> PathRequest {
        let mut mission = Arc::clone(mission);
        if let Some(speed_mps) = self.speed_mps {
            Arc::make_mut(&mut mission).vehicle.speed_mps = speed_mps;
        }
        PathRequest {
            id: self.id,
            mission,
            bounds: self.bounds,
            min_altitude_m: self.min_altitude_m,
            altitude_sigmas: self.altitude_sigmas,
            start: self.start,
            start_velocity: self.start_velocity,
            target: self.target,
            departure_s: self.departure_s,
            regions: Arc::clone(&self.regions),
            clearance_m: self.clearance_m,
            warm_start: self.warm_start.clone(),
            seed: seed.split(self.id),
            budget: self.budget,
        }
    }
}
