//! What goes into the synchroniser and what comes out.

use crate::{Mission, Outcome};
use auv_graph::{EdgeSet, Network, NodeId, Route};
use auv_obstacles::Region;
use auv_planning::{Budget, Objective, PathProblem, PlanError, Planned, RouteProblem, Trajectory};
use auv_types::{Bounds, Point3, Seed, Vector3};
use std::sync::Arc;

/// What the vehicle knows at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Mission time in seconds.
    pub time_s: f64,
    /// Where the vehicle is, metres.
    pub position: Point3<f64>,
    /// Its velocity over ground, m/s.
    pub velocity: Vector3<f64>,
    /// What obstacles are predicted to cover from now on.
    pub regions: Arc<[Region]>,
}

/// Something happened.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Time passed. The first one starts the mission; from then on one is due whenever the sonar
    /// has news, and at the end of the trajectory in force.
    Tick(Observation),
    /// The battery was measured; between measurements the mission's model counts on.
    BatteryMeasured {
        /// Usable energy left, joules.
        left_j: f64,
    },
    /// The sonar has given no fresh scan for so long; to be told again while it lasts. Predictions
    /// widen meanwhile; after [`crate::WatchdogSettings::sonar_silence_s`] the vehicle gives up or goes home.
    SonarSilent {
        /// Age of the last fresh scan, seconds; what is not a number counts as for ever.
        age_s: f64,
    },
    /// The altitude above the sea bed was measured. Once it has been, it is missed: without a number
    /// for [`crate::WatchdogSettings::altitude_silence_s`], or nearer to the bed than half the least
    /// altitude, the mission is given up along its ladder of contingencies.
    AltitudeMeasured {
        /// Altitude, metres; what is not a number or negative counts as not measured.
        altitude_m: f64,
    },
    /// A route request was answered.
    RoutePlanned {
        /// The request's number.
        request: u64,
        /// The planner's answer.
        result: Result<Planned<Route>, PlanError>,
        /// Computing time as measured, seconds (0 when not measured).
        compute_s: f64,
    },
    /// A path request was answered.
    PathPlanned {
        /// The request's number.
        request: u64,
        /// The planner's answer.
        result: Result<Planned<Trajectory>, PlanError>,
        /// Computing time as measured, seconds (0 when not measured).
        compute_s: f64,
    },
}

/// What is to be done.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub enum Command {
    /// Ask the route planner.
    PlanRoute(RouteRequest),
    /// Ask the path planner.
    PlanPath(PathRequest),
    /// Follow this trajectory from now on.
    Follow(Arc<Trajectory>),
    /// The mission is over.
    Finished(Outcome),
}

/// A question to the route planner that owns its data.
#[derive(Clone, Debug)]
pub struct RouteRequest {
    /// Its number; the answer carries it.
    pub id: u64,
    /// The network: the mission's, or that with the vehicle's place added as the last node.
    pub network: Arc<Network>,
    /// Edges taken out.
    pub removed: EdgeSet,
    /// Times of all arcs, where they differ from the network's.
    pub times: Option<Vec<f64>>,
    /// Where the route begins.
    pub start: NodeId,
    /// Where it ends.
    pub destination: NodeId,
    /// Time available, reserve taken off, seconds.
    pub time_available_s: f64,
    /// The rest of the route in force.
    pub incumbent: Option<Route>,
    /// Seed of the call.
    pub seed: Seed,
    /// Budget of the call.
    pub budget: Budget,
}

impl RouteRequest {
    /// The problem as planners take it.
    #[must_use]
    pub fn problem(&self) -> RouteProblem<'_> {
        RouteProblem {
            network: &self.network,
            removed: &self.removed,
            times: self.times.as_deref(),
            start: self.start,
            destination: self.destination,
            time_available_s: self.time_available_s,
            objective: Objective::default(),
            incumbent: self.incumbent.as_ref(),
        }
    }
}

/// A question to the path planner that owns its data.
#[derive(Clone, Debug)]
pub struct PathRequest {
    /// Its number; the answer carries it.
    pub id: u64,
    /// The mission: vehicle, sea bed and current.
    pub mission: Arc<Mission>,
    /// The mission's box, grown as far as a vehicle that was carried out of it and is to come back.
    pub bounds: Option<Bounds>,
    /// Least altitude above the bed and standard deviations of its depth added to that: the mission's, or
    /// what is left of them where a vehicle departs that is lower already.
    pub min_altitude_m: f64,
    /// See [`PathRequest::min_altitude_m`].
    pub altitude_sigmas: f64,
    /// Where and with what velocity the vehicle departs.
    pub start: Point3<f64>,
    /// Its velocity over ground; `None` when it may leave in any direction.
    pub start_velocity: Option<Vector3<f64>>,
    /// Where it goes.
    pub target: Point3<f64>,
    /// When it departs, seconds.
    pub departure_s: f64,
    /// What obstacles are predicted to cover.
    pub regions: Arc<[Region]>,
    /// Distance to keep from them, metres.
    pub clearance_m: f64,
    /// A trajectory to start the search from.
    pub warm_start: Option<Arc<Trajectory>>,
    /// Seed of the call.
    pub seed: Seed,
    /// Budget of the call.
    pub budget: Budget,
}

impl PathRequest {
    /// The problem as planners take it.
    #[must_use]
    pub fn problem(&self) -> PathProblem<'_> {
        PathProblem {
            start: self.start,
            start_velocity: self.start_velocity,
            target: self.target,
            departure_s: self.departure_s,
            vehicle: &self.mission.vehicle,
            bounds: self.bounds,
            sea_bed: self.mission.sea_bed.as_deref(),
            min_altitude_m: self.min_altitude_m,
            altitude_sigmas: self.altitude_sigmas,
            current: self.mission.current.as_deref(),
            regions: &self.regions,
            clearance_m: self.clearance_m,
            warm_start: self.warm_start.as_deref(),
        }
    }
}
