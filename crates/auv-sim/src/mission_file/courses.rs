//! Legs that are flown along lines, arrive on a course, or have a speed of their own.

use super::document::{EdgeEntry, MissionFile};
use super::heights::Height;
use auv_graph::{ArcId, NodeId};
use auv_mission::{Courses, Mission};
use auv_planning::Arrival;
use auv_planning::motion::level_heading;
use auv_types::Violations;

/// The straight way on which a line is entered, in turn radii.
const LEAD_RADII: f64 = 1.5;

impl MissionFile {
    /// How the lines of a mission whose network stands are flown.
    pub(super) fn courses(&self, mission: &Mission) -> Courses {
        let mut courses = Courses::default();
        let lead_m = LEAD_RADII * mission.vehicle.turn_radius_m;
        for line in &self.lines {
            let ends = line.ends.map(|i| NodeId(i as u32));
            for (k, from) in ends.into_iter().enumerate() {
                let Some(arc) = mission.network.arc_between(from, ends[1 - k]) else {
                    continue;
                };
                courses.lines.insert(arc);
                let (points, last) = (line.points(), line.points().len() - 1);
                let step = match k {
                    0 => points[1] - points[0],
                    _ => points[last - 1] - points[last],
                };
                if let Some(direction) = level_heading(&step) {
                    courses.arrivals.insert(from, Arrival { direction, lead_m });
                }
            }
        }
        for entry in &self.edges {
            let (height, speed_mps) = self.kept(entry);
            let arcs = arcs_of(mission, entry);
            if height != Height::Ends {
                courses.lines.extend(arcs.clone());
            }
            let speeds = speed_mps
                .into_iter()
                .flat_map(|mps| arcs.iter().map(move |&arc| (arc, mps)));
            courses.speeds_mps.extend(speeds);
        }
        courses
    }

    /// The height and the speed that an edge is flown with: its own, or those of its tasks.
    pub(super) fn kept(&self, entry: &EdgeEntry) -> (Height, Option<f64>) {
        let names = entry.task.iter().chain(entry.tasks.iter().flatten());
        let tasks = || names.clone().filter_map(|name| self.tasks.get(name));
        let own = Height::given(entry.depth_m, entry.altitude_m);
        let mut heights = tasks().map(|task| Height::given(task.depth_m, task.altitude_m));
        let height = match own {
            Height::Ends => heights
                .find(|height| *height != Height::Ends)
                .unwrap_or(own),
            _ => own,
        };
        let speed_mps = tasks().find_map(|task| task.speed_mps);
        (height, entry.speed_mps.or(speed_mps))
    }

    /// What is wrong with the speeds, depths and altitudes of tasks and edges, for a vehicle of these speeds.
    pub(super) fn check_kept(&self, speeds_mps: (f64, f64), violations: &mut Violations) {
        let tasks = self.tasks.iter().map(|(name, task)| {
            let place = format!("tasks.{name}");
            (place, task.speed_mps, task.depth_m, task.altitude_m)
        });
        let edges = self.edges.iter().enumerate().map(|(i, edge)| {
            let place = format!("edges[{i}] ({} - {})", edge.from, edge.to);
            (place, edge.speed_mps, edge.depth_m, edge.altitude_m)
        });
        let (least_mps, most_mps) = speeds_mps;
        for (place, speed_mps, depth_m, altitude_m) in tasks.chain(edges) {
            let both = depth_m.is_some() && altitude_m.is_some();
            violations.require(!both, &place, || {
                "has both depth_m and altitude_m; keep one".into()
            });
            let mut within = |value: Option<f64>, (least, most): (f64, f64), key: &str| {
                let ok = value.is_none_or(|value| (least..=most).contains(&value));
                violations.require(ok, &format!("{place}.{key}"), || {
                    let value = value.unwrap_or_default();
                    format!("is {value}; give {least} to {most}")
                });
            };
            within(speed_mps, (least_mps.max(0.05), most_mps), "speed_mps");
            within(depth_m, (0.0, 11_000.0), "depth_m");
            within(altitude_m, (0.1, 11_000.0), "altitude_m");
            let over = altitude_m.is_none() || self.sea_bed.is_some();
            violations.require(over, &format!("{place}.altitude_m"), || {
                "needs a bed to be over; give a [sea_bed] or depth_m".into()
            });
        }
    }
}

/// The arcs of an edge of the file.
fn arcs_of(mission: &Mission, entry: &EdgeEntry) -> Vec<ArcId> {
    let ends = [&entry.from, &entry.to].map(|name| mission.network.find(name));
    let [Some(from), Some(to)] = ends else {
        return Vec::new();
    };
    let there = mission.network.arc_between(from, to);
    let back = mission
        .network
        .arc_between(to, from)
        .filter(|_| !entry.directed);
    there.into_iter().chain(back).collect()
}
