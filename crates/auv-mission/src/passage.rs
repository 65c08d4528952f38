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

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, Task, Waypoint};
    use auv_ocean::FlatBed;
    use auv_planning::Vehicle;
    use std::sync::Arc;

    /// A vehicle of 20 m turn radius in a box, with an edge from the middle of a basin to a place.
    fn mission(to: [f64; 3], stays_s: f64) -> Mission {
        let vehicle = Vehicle::default();
        let places = [[500.0, 500.0, 20.0], to, [500.0, 900.0, 20.0]];
        let waypoints = places.map(|place| Waypoint::at(Point3::from(place)));
        let task = Task {
            priority: 1.0,
            risk: 1.0,
            completion_time_s: stays_s,
        };
        let edges = [
            Edge::directed(0, 1, task),
            Edge::directed(0, 2, Task::TRANSIT),
        ];
        let network = Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap();
        let mut mission = Mission::new(Arc::new(network), NodeId(0), NodeId(2), 4e3, vehicle);
        let (low, high) = ([0.0, 0.0, 2.0], [1e3, 1e3, 60.0]);
        mission.bounds = Some(Bounds::new(low.into(), high.into()));
        mission
    }

    /// What is told of the edge to the place; the other edge stays open.
    fn told(mission: &Mission) -> Option<String> {
        let mut mission = mission.clone();
        let shut = mission.close_arcs_without_room();
        let closed: Vec<ArcId> = mission.closed.iter().copied().collect();
        assert!(shut.iter().map(|(arc, _)| *arc).eq(closed), "{shut:?}");
        assert!(
            mission.close_arcs_without_room().is_empty(),
            "each is told once"
        );
        let mut told = shut.into_iter().map(|(_, text)| text);
        let first = told.next();
        assert_eq!(told.next(), None);
        if let Some(text) = &first {
            assert!(text.starts_with("edges[0] ("), "{text}");
        }
        first
    }

    #[test]
    fn an_arc_with_room_stays_open() {
        for stays_s in [0.0, 60.0] {
            assert_eq!(told(&mission([700.0, 500.0, 30.0], stays_s)), None);
            // At the wall of the box, level, a circle fits inside.
            assert_eq!(told(&mission([999.0, 500.0, 20.0], stays_s)), None);
        }
    }

    #[test]
    fn an_arc_whose_stay_has_no_room_is_closed() {
        // In a corner a vehicle can come and go, but a circle does not fit.
        let corner = [997.0, 997.0, 20.0];
        let text = told(&mission(corner, 60.0)).unwrap();
        assert!(
            text.contains("the stay at") && text.contains("leaves the box by"),
            "{text}"
        );
        let none = told(&mission(corner, 0.0));
        assert!(none.is_none_or(|text| !text.contains("the stay at")));
    }

    #[test]
    fn an_arc_to_a_place_without_a_way_on_is_closed_unless_the_vehicle_docks_there() {
        // 0.5 m below what the bed allows no circle fits; no way leads on without one.
        let mut deep = mission([700.0, 500.0, 40.5], 0.0);
        deep.sea_bed = Some(Arc::new(FlatBed::new(45.0)));
        deep.min_altitude_m = 5.0;
        let text = told(&deep).unwrap();
        assert!(text.contains("no way leads on from"), "{text}");
        assert!(
            text.contains("below what the altitude over the bed allows"),
            "{text}"
        );
        deep.docks = vec![NodeId(1)];
        assert_eq!(told(&deep), None);
    }

    #[test]
    fn an_arc_too_steep_between_the_sides_of_its_box_is_closed() {
        // Between walls 38 m apart it cannot turn by 180 degrees: over 27 m it gets 7 m down at 15 degrees.
        let narrow = |depth_m: f64| {
            let mut mission = mission([510.0, 525.0, depth_m], 0.0);
            let (low, high) = ([482.0, 482.0, 2.0], [520.0, 905.0, 60.0]);
            mission.bounds = Some(Bounds::new(low.into(), high.into()));
            mission.docks = vec![NodeId(1)];
            mission
        };
        assert_eq!(told(&narrow(25.0)), None);
        let text = told(&narrow(50.0)).unwrap();
        assert!(
            text.contains("no way from 20.0 m to 50.0 m depth over 27 m"),
            "{text}"
        );
        assert!(
            text.contains("20 m radius and a pitch of 15 degrees"),
            "{text}"
        );
    }

    #[test]
    fn where_a_vehicle_has_room_everywhere_nothing_is_closed() {
        let mut hovers = mission([999.9, 999.9, 20.0], 60.0);
        hovers.vehicle = Vehicle::paper();
        assert_eq!(told(&hovers), None);
        let mut open = mission([999.9, 999.9, 20.0], 60.0);
        open.bounds = None;
        assert_eq!(told(&open), None);
    }
}
