//! Whether the vehicle's turns and pitch have room along the arcs of its network.

use crate::leads::directions;
use crate::way_on::way_on;
use crate::{Mission, Room, check};
use auv_graph::{ArcId, NodeId};
use auv_planning::motion::{Pose, connections, tightest_circle_m};
use auv_planning::{PathProblem, Trajectory};
use auv_types::{Bounds, Point3, Vector3};
use std::collections::BTreeMap;

/// Where the nearest side of the box is farther than so many radii of the circle, every turn has room.
const ROOMY_RADII: f64 = 2.1;

impl Mission {
    /// Closes the arcs that the vehicle cannot fly: their work takes a stay where no circle fits, no way leads on
    /// from their end, or no way between their ends with its turns and its pitch stays within the box. Routes do
    /// not use closed arcs. Returns each with a text: its name, why, and the remedy.
    ///
    /// The ways tried between the ends are shortest curves in still water, with changes of depth on circles. What
    /// the bed leaves of them is not asked here: a path round a rise of the bed is the path planner's to find.
    ///
    /// # Determinism
    /// The result depends on the mission's network, vehicle, box and bed.
    pub fn close_arcs_without_room(&mut self) -> Vec<(ArcId, String)> {
        let anywhere = self.bounds.is_none() && self.sea_bed.is_none();
        if anywhere || self.vehicle.turn_radius_m <= 0.0 {
            return Vec::new();
        }
        let mut passages = Passages {
            mission: self,
            rooms: BTreeMap::new(),
        };
        let arcs = (0..self.network.arcs().len() as u32).map(ArcId);
        let open = arcs.filter(|arc| !self.closed.contains(arc));
        let shut: Vec<(ArcId, String)> = open
            .filter_map(|arc| Some((arc, passages.obstruction(arc)?)))
            .collect();
        self.closed.extend(shut.iter().map(|(arc, _)| *arc));
        shut
    }

    /// Whether every turn at a place stays in the box.
    fn is_roomy(&self, place: &Point3<f64>) -> bool {
        let Bounds { low, high } = self.limits();
        let room_m = ROOMY_RADII * tightest_circle_m(&self.vehicle);
        let north_m = (place.x - low.x).min(high.x - place.x);
        let east_m = (place.y - low.y).min(high.y - place.y);
        north_m.min(east_m) >= room_m
    }
}

/// The arcs of a mission, and the room at their ends.
struct Passages<'m> {
    mission: &'m Mission,
    rooms: BTreeMap<NodeId, Room>,
}

impl Passages<'_> {
    /// What keeps the vehicle from flying an arc, with the remedy.
    fn obstruction(&mut self, arc: ArcId) -> Option<String> {
        let mission = self.mission;
        let edge = mission.network.arcs()[arc.index()];
        let ends = [edge.tail, edge.head].map(|node| mission.position_of(node));
        let [from, to] = [edge.tail, edge.head].map(|node| mission.name_of(node));
        let name = format!("edges[{}] ({from} - {to})", edge.edge.index());
        let stays = mission.network.task(edge.edge).completion_time_s > 0.0;
        let docks = mission.is_dock(edge.head) && !stays;
        let room = self.rooms.entry(edge.head);
        let room = room.or_insert_with(|| mission.room_at(&ends[1]));
        match room {
            Room::LeadsOn(shortage) if stays => {
                return Some(format!("{name}: the stay at {to} has no room: {shortage}"));
            }
            Room::None(shortage) if !docks => {
                return Some(format!("{name}: no way leads on from {to}: {shortage}"));
            }
            _ => {}
        }
        let open = PathProblem {
            sea_bed: None,
            ..mission.open_problem(ends[0], ends[1])
        };
        let roomy = ends.iter().all(|end| mission.is_roomy(end));
        (!roomy && !has_way(&open, docks)).then(|| format!("{name}: {}", shortage(&open)))
    }
}

/// Whether one of the shortest curves between the ends of a problem stays within its box, and can be left at its
/// end unless it docks there.
fn has_way(problem: &PathProblem<'_>, docks: bool) -> bool {
    let leads_on =
        |end: &Trajectory| docks || way_on(problem, end.end(), end.end_velocity(), 0.0).is_some();
    let flies = |points: &[Point3<f64>]| {
        let way = problem.timed(points);
        way.is_ok_and(|way| check::path_is_valid(problem, &way) && leads_on(&way))
    };
    let level = || directions().filter(|direction| direction.z == 0.0);
    let pairs = || level().flat_map(|start| level().map(move |end| (start, end)));
    let pose = |place: Point3<f64>, direction: Vector3<f64>| Pose { place, direction };
    flies(&[problem.start, problem.target])
        || pairs().any(|(start, end)| {
            let (from, to) = (pose(problem.start, start), pose(problem.target, end));
            let ways = connections(problem.vehicle, from, to);
            ways.iter().any(|way| flies(way))
        })
}

/// Why there is no way between the ends of a problem, and the remedy.
fn shortage(problem: &PathProblem<'_>) -> String {
    let (start, target, vehicle) = (problem.start, problem.target, problem.vehicle);
    format!(
        "no way from {:.1} m to {:.1} m depth over {:.0} m, with turns of {:.0} m radius and a pitch of {:.0} degrees at most, stays within the box; widen the box or move the ends apart",
        start.z,
        target.z,
        (target - start).xy().norm(),
        vehicle.turn_radius_m,
        vehicle.max_pitch_rad.to_degrees(),
    )
}
