//! What goes into the synchroniser and what comes out.

use crate::{Mission, Outcome};
use auv_graph::{EdgeSet, Network, NodeId, Route, TimeModel};
use auv_obstacles::Region;
use auv_planning::{Budget, Objective, PathProblem, PlanError, Planned, RouteProblem, Trajectory};
use auv_types::{Bounds, Point3, Seed, Vector3};
use std::sync::Arc;

/// What the vehicle knows at a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Observation {
    /// Mission time in seconds.
    pub time_s: f64,
    /// Position of the vehicle, metres.
    pub position: Point3<f64>,
    /// Standard deviation of the position's horizontal error, metres: that of the distance between the believed and
    /// the true place. 0 where the position is exact. Regions of what is charted and of ships are to be grown by
    /// twice this ([`auv_obstacles::ClearancePolicy::predicted`]); the bed is taken care of.
    pub position_sigma_m: f64,
    /// Its velocity over ground, m/s.
    pub velocity: Vector3<f64>,
    /// Predicted regions of the obstacles, from now on.
    pub regions: Arc<[Region]>,
}

/// What the synchroniser is told.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Event {
    /// Time passed. The first tick starts the mission. From then on a tick is due at every new scan of
    /// the sonar and at the end of the trajectory in force.
    Tick(Observation),
    /// The battery was measured. Between measurements the mission's battery model is used.
    BatteryMeasured {
        /// Usable energy left, joules.
        left_j: f64,
    },
    /// The sonar has given no fresh scan for `age_s`. Send this event again while the silence lasts.
    /// When it exceeds [`crate::WatchdogSettings::sonar_silence_s`], the mission is aborted, or the
    /// vehicle goes home ([`crate::WithoutSonar`]).
    SonarSilent {
        /// Age of the last fresh scan, seconds. NaN counts as infinite.
        age_s: f64,
    },
    /// The altitude above the sea bed was measured. Where two altitudes in a row leave less room than plans
    /// over the chart allow for, the vehicle plans over the bed as measured, and climbs if it is too low: see
    /// [`crate::Synchroniser::shoals`]. The mission is aborted when the altitude is below half the least
    /// altitude. After the first altitude, a silence longer than
    /// [`crate::WatchdogSettings::altitude_silence_s`] also aborts it.
    AltitudeMeasured {
        /// Altitude, metres; `+inf` where the bed is farther than the altimeter reaches. NaN and negative
        /// values count as not measured.
        altitude_m: f64,
    },
    /// The vehicle cannot follow trajectories any more, by its own judgement: a fin is stuck, the drive failed. The
    /// mission is aborted. It is too when the vehicle leaves one trajectory after the other without coming nearer to
    /// its target for longer than [`crate::WatchdogSettings::cannot_follow_s`].
    CannotFollow,
    /// There is water in the vehicle. The mission is aborted: [`crate::EmergencyCause::Leak`].
    Leak,
    /// Whether the vehicle is in contact with the dock that it is to reach, sent before the tick: where it has arrived
    /// by its own belief without contact it missed the dock. It then tries again while [`crate::Docking::tries`]
    /// lasts. A vehicle that is told nothing believes its position.
    DockContact {
        /// Whether it is.
        docked: bool,
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

/// What the driver is to do.
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
    /// Times of all arcs in seconds; `None` if they are the network's.
    pub times: Option<Vec<f64>>,
    /// Travel times by departure, where the current changes so much with time that it matters (`times` are
    /// then those of a departure at once), and tasks with windows and order, in seconds from the departure.
    pub time_model: Option<Arc<TimeModel>>,
    /// Where the route starts.
    pub start: NodeId,
    /// Where it ends.
    pub destination: NodeId,
    /// Time available, reserve taken off, seconds; negative once the mission is late.
    pub time_available_s: f64,
    /// The rest of the route in force.
    pub incumbent: Option<Route>,
    /// Seed of the call.
    pub seed: Seed,
    /// Budget of the call.
    pub budget: Budget,
}

impl RouteRequest {
    /// The problem as planners take it. A mission that is late asks with no time: the answer is the
    /// quickest route then.
    #[must_use]
    pub fn problem(&self) -> RouteProblem<'_> {
        RouteProblem {
            network: &self.network,
            removed: &self.removed,
            times: self.times.as_deref(),
            time_model: self.time_model.as_deref(),
            start: self.start,
            destination: self.destination,
            time_available_s: self.time_available_s.max(0.0),
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
    /// The mission's box, grown to contain a vehicle that was carried out of it.
    pub bounds: Option<Bounds>,
    /// Least altitude above the bed, metres: the mission's, or less for a vehicle that departs from
    /// below it.
    pub min_altitude_m: f64,
    /// Standard deviations of the bed's depth added to the least altitude: the mission's, or 0 for a
    /// vehicle that departs too low even without a least altitude.
    pub altitude_sigmas: f64,
    /// Where and with what velocity the vehicle departs.
    pub start: Point3<f64>,
    /// Its velocity over ground; `None` when it may leave in any direction.
    pub start_velocity: Option<Vector3<f64>>,
    /// Where the path ends.
    pub target: Point3<f64>,
    /// When it departs, seconds.
    pub departure_s: f64,
    /// Predicted regions of the obstacles.
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
