//! What a mission knows before it starts.

use crate::{
    AbortReason, Battery, Contingency, Courses, Docking, Emergency, Manner, Navigation, Surfacing,
};
use auv_graph::{ArcId, EdgeId, Network, NodeId, TimeModel};
use auv_ocean::{CurrentField, SeaBed};
use auv_planning::front::NetworkFronts;
use auv_planning::motion::Floor;
use auv_planning::{LegTime, Vehicle};
use auv_types::{Bounds, Point3};
use std::collections::{BTreeMap, BTreeSet};
use std::sync::Arc;

/// A mission as given to the synchroniser: network, time, vehicle, and what is known of the sea. It
/// never changes; all requests to planners share it.
#[derive(Clone, Debug)]
pub struct Mission {
    /// Waypoints and tasks.
    pub network: Arc<Network>,
    /// Where the mission starts.
    pub start: NodeId,
    /// Where the vehicle docks.
    pub destination: NodeId,
    /// Other waypoints where it may dock as well. Routes that may end anywhere are planned in time: they take a
    /// [`Mission::time_model`].
    pub docks: Vec<NodeId>,
    /// Time from start to docking, seconds.
    pub budget_s: f64,
    /// Planned time of the launch, mission time in seconds. The forecast of the current is checked for
    /// this time. 0 if the vehicle's clock starts with the mission.
    pub launch_s: f64,
    /// Part of the budget that no route may plan to use, seconds.
    pub reserve_s: f64,
    /// The vehicle.
    pub vehicle: Vehicle,
    /// Its battery (`None`: energy never limits the mission).
    pub battery: Option<Battery>,
    /// How its belief about its place errs (`None`: it always knows its place).
    pub navigation: Option<Navigation>,
    /// How often it surfaces for a fix at least (`None`: as its error asks for).
    pub surfacing: Option<Surfacing>,
    /// Waypoints near which those fixes are taken (empty: anywhere).
    pub fix_places: Vec<NodeId>,
    /// When it counts as docked.
    pub docking: Docking,
    /// The box that the vehicle must stay in but to surface (`None`: anywhere below the surface).
    pub bounds: Option<Bounds>,
    /// The sea bed.
    pub sea_bed: Option<Arc<dyn SeaBed>>,
    /// Least altitude above the bed, metres.
    pub min_altitude_m: f64,
    /// Standard deviations of the bed's depth added to the least altitude.
    pub altitude_sigmas: f64,
    /// The forecast of the current that moves the vehicle (`None`: still water).
    pub current: Option<Arc<dyn CurrentField>>,
    /// Distance kept from every predicted region, metres.
    pub clearance_m: f64,
    /// Whether no land lies between: the vehicle may go straight from anywhere to any waypoint.
    pub open_water: bool,
    /// What is asked of legs beyond their ends.
    pub courses: Courses,
    /// Polylines to follow where the straight line of an arc leads over land, by arc, ends included.
    pub guides: BTreeMap<ArcId, Vec<Point3<f64>>>,
    /// The quickest ways along arcs in the forecast current, by departure (`None`: the guides): see
    /// [`Mission::find_fronts`].
    pub fronts: Option<Arc<NetworkFronts>>,
    /// Arcs that no route uses: the vehicle has no room to fly them, see
    /// [`Mission::close_arcs_without_room`].
    pub closed: BTreeSet<ArcId>,
    /// Groups of edges that carry the same task, for instance all edges to one station. When the task
    /// of one edge is done, all edges of its group are taken out of the network.
    pub shared_tasks: Vec<Vec<EdgeId>>,
    /// Tasks with windows, in mission time, order and duty (`None`: the edges' own tasks). With a model the edges
    /// carry no tasks of their own; of the model only tasks are used, without chains.
    pub time_model: Option<Arc<TimeModel>>,
    /// How tasks of the model are done at their waypoints, by index. Their completion times count what is flown, in
    /// still water.
    pub manners: BTreeMap<usize, Manner>,
    /// What the vehicle does when the mission is aborted, in order of preference. The first that can
    /// be flown is flown.
    pub contingencies: Vec<Contingency>,
    /// Other ladders, by cause and place: the first that holds is used instead of `contingencies`.
    pub emergencies: Vec<Emergency>,
}

impl Mission {
    /// A mission in open, still, deep water.
    #[must_use]
    pub fn new(
        network: Arc<Network>,
        start: NodeId,
        destination: NodeId,
        budget_s: f64,
        vehicle: Vehicle,
    ) -> Self {
        Self {
            network,
            start,
            destination,
            docks: Vec::new(),
            budget_s,
            launch_s: 0.0,
            reserve_s: 0.0,
            vehicle,
            battery: None,
            navigation: None,
            surfacing: None,
            fix_places: Vec::new(),
            docking: Docking::default(),
            bounds: None,
            sea_bed: None,
            min_altitude_m: 0.0,
            altitude_sigmas: 0.0,
            current: None,
            clearance_m: 0.0,
            open_water: true,
            courses: Courses::default(),
            guides: BTreeMap::new(),
            fronts: None,
            closed: BTreeSet::new(),
            shared_tasks: Vec::new(),
            time_model: None,
            manners: BTreeMap::new(),
            contingencies: Contingency::LADDER.to_vec(),
            emergencies: Vec::new(),
        }
    }

    /// The ladder of contingencies for a reason at a place: that of the first emergency that holds, else
    /// [`Mission::contingencies`].
    #[must_use]
    pub fn ladder(&self, reason: AbortReason, here: &Point3<f64>) -> &[Contingency] {
        let mut emergencies = self.emergencies.iter();
        let found = emergencies.find(|emergency| emergency.holds(reason, here));
        found.map_or(&self.contingencies, |emergency| &emergency.ladder)
    }

    /// Time available, seconds: `left_s` of the budget, or less if the energy left after `used_j` does
    /// not last so long at cruising speed.
    #[must_use]
    pub fn available_s(&self, left_s: f64, used_j: f64) -> f64 {
        self.battery.as_ref().map_or(left_s, |battery| {
            left_s.min(battery.lasts_s(battery.usable_j - used_j, &self.vehicle))
        })
    }

    /// Whether the vehicle may dock at a waypoint.
    #[must_use]
    pub fn is_dock(&self, node: NodeId) -> bool {
        node == self.destination || self.docks.contains(&node)
    }

    /// Whether no route uses an arc: it is [`Mission::closed`], or it leads on from one of several docks, where a
    /// mission ends.
    #[must_use]
    pub fn is_closed(&self, arc: ArcId) -> bool {
        let leads_on =
            |tail: NodeId| !self.docks.is_empty() && tail != self.start && self.is_dock(tail);
        let arcs = self.network.arcs();
        let tail = arcs.get(arc.index()).map(|arc| arc.tail);
        self.closed.contains(&arc) || tail.is_some_and(leads_on)
    }

    /// Where it may dock: the destination first.
    pub fn all_docks(&self) -> impl Iterator<Item = NodeId> + '_ {
        std::iter::once(self.destination).chain(self.docks.iter().copied())
    }

    /// The name of a waypoint, or its number.
    #[must_use]
    pub fn name_of(&self, node: NodeId) -> String {
        self.network.name_of(node)
    }

    /// The position of a waypoint (the start's for an unknown one).
    #[must_use]
    pub fn position_of(&self, node: NodeId) -> Point3<f64> {
        let waypoints = self.network.waypoints();
        waypoints
            .get(node.index())
            .unwrap_or(&waypoints[self.start.index()])
            .position
    }

    /// The deepest the vehicle may be at a place, metres.
    #[must_use]
    pub fn deepest_at(&self, north_m: f64, east_m: f64) -> f64 {
        let floor = self.floor();
        floor.map_or(f64::INFINITY, |floor| floor.deepest_at(north_m, east_m))
    }

    /// The deepest the vehicle may be over the bed, if there is one.
    pub(crate) fn floor(&self) -> Option<Floor<'_>> {
        self.sea_bed.as_deref().map(|bed| Floor {
            bed,
            min_altitude_m: self.min_altitude_m,
            altitude_sigmas: self.altitude_sigmas,
        })
    }

    /// The box; without one, everywhere below the surface.
    #[must_use]
    pub fn limits(&self) -> Bounds {
        self.bounds.unwrap_or(Bounds::BELOW_SURFACE)
    }

    /// How long legs take in the current as forecast.
    pub(crate) fn leg_time(&self) -> LegTime<'_> {
        LegTime {
            vehicle: &self.vehicle,
            current: self.current.as_deref(),
        }
    }

    /// Least altitude in metres, and standard deviations added to it, to ask of a path that starts at a
    /// place: the mission's, or what is left of them there, because no path can start higher than the
    /// vehicle is. The altitude is negative for a vehicle below the charted bed.
    pub(crate) fn altitude_to_ask(&self, start: &Point3<f64>) -> (f64, f64) {
        let missing_m = start.z - self.deepest_at(start.x, start.y);
        let left_m = self.min_altitude_m - missing_m.max(0.0);
        match &self.sea_bed {
            Some(bed) if left_m < 0.0 => {
                let altitude_m = bed.depth_at(start.x, start.y) - start.z;
                (altitude_m.min(self.min_altitude_m), 0.0)
            }
            _ => (left_m, self.altitude_sigmas),
        }
    }

    /// Whether a place lies in the box and above what altitude allows.
    pub(crate) fn is_open(&self, place: &Point3<f64>) -> bool {
        self.limits().contains(place) && place.z <= self.deepest_at(place.x, place.y)
    }

    /// The edges whose task is done with that of `edge`: itself, and those that share it.
    pub(crate) fn done_with(&self, edge: EdgeId) -> impl Iterator<Item = EdgeId> + '_ {
        let sharing = self
            .shared_tasks
            .iter()
            .filter(move |group| group.contains(&edge));
        std::iter::once(edge).chain(sharing.flatten().copied())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::Fixture;
    use auv_ocean::FlatBed;

    /// Over a bed at 40 m, with a least altitude of 10 m.
    fn mission() -> Mission {
        let mut mission = Fixture::new().mission;
        mission.sea_bed = Some(Arc::new(FlatBed::new(40.0)));
        (mission.min_altitude_m, mission.altitude_sigmas) = (10.0, 0.5);
        mission
    }

    #[test]
    fn a_path_is_asked_for_with_the_altitude_that_its_start_has() {
        for (depth_m, asked) in [
            (20.0, (10.0, 0.5)),
            (30.0, (10.0, 0.5)),
            (33.0, (7.0, 0.5)),
            (40.0, (0.0, 0.5)),
            // Below the charted bed its errors are left out too.
            (42.0, (-2.0, 0.0)),
        ] {
            let start = Point3::new(0.0, 0.0, depth_m);
            assert_eq!(mission().altitude_to_ask(&start), asked, "{depth_m} m");
        }
    }

    #[test]
    fn a_place_is_open_in_the_box_and_with_the_least_altitude() {
        let mut mission = mission();
        let open = |mission: &Mission, x, depth_m| mission.is_open(&Point3::new(x, 0.0, depth_m));
        assert!(open(&mission, 0.0, 30.0) && !open(&mission, 0.0, 30.1));
        let (low, high) = ([-10.0, -10.0, 0.0], [10.0, 10.0, 99.0]);
        mission.bounds = Some(Bounds::new(low.into(), high.into()));
        assert!(open(&mission, 10.0, 30.0) && !open(&mission, 10.1, 30.0));
    }
}
