//! A hash of a mission in 64 bits, to tell missions apart.

use crate::{Contingency, Courses, Manner, Mission, Pattern};
use auv_graph::{TaskPlace, TimedTask};
use auv_types::Point3;

/// FNV-1a, 64 bits. Two texts of equal length that differ in a single byte never have the same hash.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fnv(u64);

impl Fnv {
    pub(crate) const fn new() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }

    pub(crate) fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }

    fn count(&mut self, value: usize) {
        self.bytes(&(value as u64).to_le_bytes());
    }

    /// Numbers of nodes, arcs or edges. How many is written too: lists in a row have one hash only if
    /// they are the same lists.
    fn ids(&mut self, ids: impl ExactSizeIterator<Item = u32>) {
        self.count(ids.len());
        for id in ids {
            self.bytes(&id.to_le_bytes());
        }
    }

    /// Whether something that may be left out is there.
    fn is_there<T>(&mut self, value: Option<T>) -> Option<T> {
        self.bytes(&[u8::from(value.is_some())]);
        value
    }

    /// A fixed number of values; a list is written after its length.
    fn numbers(&mut self, values: &[f64]) {
        for value in values {
            self.bytes(&value.to_bits().to_le_bytes());
        }
    }

    fn points<'a>(&mut self, points: impl ExactSizeIterator<Item = &'a Point3<f64>>) {
        self.count(points.len());
        for point in points {
            self.numbers(point.coords.as_slice());
        }
    }

    pub(crate) const fn finish(self) -> u64 {
        self.0
    }
}

/// Hash of everything that the synchroniser uses of a mission. Sea bed and current are functions: they
/// are hashed by their values at the waypoints, the current at the launch and at the end of the budget.
pub(crate) fn of(mission: &Mission) -> u64 {
    let mut hash = Fnv::new();
    take_network(&mut hash, mission);
    take_limits(&mut hash, mission);
    take_choices(&mut hash, mission);
    take_sea(&mut hash, mission);
    hash.finish()
}

fn take_network(hash: &mut Fnv, mission: &Mission) {
    let network = &mission.network;
    hash.points(network.waypoints().iter().map(|w| &w.position));
    hash.count(network.num_edges());
    for edge in network.edges() {
        hash.bytes(&edge.from.to_le_bytes());
        hash.bytes(&edge.to.to_le_bytes());
        hash.bytes(&[u8::from(edge.directed)]);
        let task = edge.task;
        hash.numbers(&[task.priority, task.risk, task.completion_time_s]);
        hash.numbers(&[edge.distance_m.unwrap_or(-1.0)]);
    }
    if let Some(model) = hash.is_there(mission.time_model.as_ref()) {
        hash.count(model.tasks.len());
        for task in &model.tasks {
            take_timed_task(hash, task);
        }
    }
    hash.ids(mission.closed.iter().map(|arc| arc.0));
    hash.bytes(&mission.start.0.to_le_bytes());
    hash.bytes(&mission.destination.0.to_le_bytes());
    hash.ids(mission.docks.iter().map(|dock| dock.0));
    take_courses(hash, &mission.courses);
}

fn take_timed_task(hash: &mut Fnv, task: &TimedTask) {
    let known = &task.task;
    hash.numbers(&[known.priority, known.risk, known.completion_time_s]);
    hash.bytes(&[u8::from(task.mandatory)]);
    hash.count(task.windows.len());
    hash.numbers(task.windows.as_flattened());
    hash.count(task.after.len());
    for &before in &task.after {
        hash.count(before);
    }
    match task.place {
        TaskPlace::Node(node) => hash.bytes(&node.0.to_le_bytes()),
        TaskPlace::Edge(edge) => hash.bytes(&(edge.0 | 1 << 31).to_le_bytes()),
    }
}

fn take_courses(hash: &mut Fnv, courses: &Courses) {
    hash.ids(courses.arrivals.keys().map(|node| node.0));
    for arrival in courses.arrivals.values() {
        hash.numbers(arrival.direction.as_slice());
        hash.numbers(&[arrival.lead_m]);
    }
    hash.ids(courses.speeds_mps.keys().map(|arc| arc.0));
    for &speed_mps in courses.speeds_mps.values() {
        hash.numbers(&[speed_mps]);
    }
    hash.ids(courses.lines.iter().map(|arc| arc.0));
}

fn take_limits(hash: &mut Fnv, mission: &Mission) {
    let vehicle = &mission.vehicle;
    hash.numbers(&[
        mission.network.speed_mps(),
        mission.budget_s,
        mission.reserve_s,
        mission.min_altitude_m,
        mission.altitude_sigmas,
        mission.clearance_m,
        vehicle.speed_mps,
        vehicle.min_speed_mps,
        vehicle.max_speed_mps,
        vehicle.turn_radius_m,
        vehicle.max_pitch_rad,
    ]);
    if let Some(battery) = hash.is_there(mission.battery.as_ref()) {
        hash.numbers(&[
            battery.usable_j,
            battery.hotel_w,
            battery.propulsion_j_per_m,
        ]);
    }
    if let Some(navigation) = hash.is_there(mission.navigation.as_ref()) {
        hash.numbers(&[
            navigation.drift_percent,
            navigation.compass_deg,
            navigation.fix_at_surface_s,
            navigation.most_error_m.unwrap_or(-1.0),
            mission.docking.tolerance_m,
        ]);
    }
    if let Some(surfacing) = hash.is_there(mission.surfacing.as_ref()) {
        hash.numbers(&[surfacing.every_s, surfacing.at_most_s]);
        hash.ids(mission.fix_places.iter().map(|place| place.0));
    }
    hash.bytes(&mission.docking.tries.to_le_bytes());
    if let Some(heading_deg) = hash.is_there(mission.docking.heading_deg) {
        hash.numbers(&[heading_deg, mission.docking.lead_in_m]);
    }
    let box_corners = mission.bounds.iter().flat_map(|b| [b.low, b.high]);
    hash.points(box_corners.collect::<Vec<_>>().iter());
    hash.bytes(&[u8::from(mission.open_water)]);
}

fn take_ladder(hash: &mut Fnv, ladder: &[Contingency]) {
    hash.count(ladder.len());
    for contingency in ladder {
        match contingency {
            Contingency::Surface => hash.bytes(&[0]),
            Contingency::ReturnAlongTrack => hash.bytes(&[1]),
            Contingency::Loiter { for_s } => {
                hash.bytes(&[2]);
                hash.numbers(&[*for_s]);
            }
        }
    }
}

fn take_manner(hash: &mut Fnv, manner: &Manner) {
    hash.numbers(&[
        manner.speed_mps.unwrap_or(-1.0),
        manner.depth_m.unwrap_or(-1.0),
    ]);
    match manner.pattern {
        None => hash.bytes(&[0]),
        Some(Pattern::Profile { from_m, to_m }) => {
            hash.bytes(&[1]);
            hash.numbers(&[from_m, to_m]);
        }
        Some(Pattern::Yoyo {
            top_m,
            bottom_m,
            length_m,
            heading_deg,
        }) => {
            hash.bytes(&[2]);
            hash.numbers(&[top_m, bottom_m, length_m, heading_deg]);
        }
        Some(Pattern::Circle { radius_m, turns }) => {
            hash.bytes(&[3]);
            hash.numbers(&[radius_m, turns]);
        }
    }
}

fn take_choices(hash: &mut Fnv, mission: &Mission) {
    hash.count(mission.shared_tasks.len());
    for group in &mission.shared_tasks {
        hash.ids(group.iter().map(|edge| edge.0));
    }
    hash.count(mission.manners.len());
    for (&task, manner) in &mission.manners {
        hash.count(task);
        take_manner(hash, manner);
    }
    take_ladder(hash, &mission.contingencies);
    hash.count(mission.emergencies.len());
    for emergency in &mission.emergencies {
        hash.bytes(&[emergency.when as u8]);
        if let Some(corners) = hash.is_there(emergency.within.as_ref()) {
            hash.count(corners.len());
            hash.numbers(corners.as_flattened());
        }
        take_ladder(hash, &emergency.ladder);
    }
    hash.ids(mission.guides.keys().map(|arc| arc.0));
    for way in mission.guides.values() {
        hash.points(way.iter());
    }
}

fn take_sea(hash: &mut Fnv, mission: &Mission) {
    let bed = hash.is_there(mission.sea_bed.as_ref());
    let current = hash.is_there(mission.current.as_ref());
    for place in mission.network.waypoints().iter().map(|w| &w.position) {
        if let Some(bed) = bed {
            hash.numbers(&[
                bed.depth_at(place.x, place.y),
                bed.depth_sigma_m(place.x, place.y),
            ]);
        }
        if let Some(current) = current {
            for time_s in [mission.launch_s, mission.launch_s + mission.budget_s] {
                hash.numbers(current.velocity_at(place, time_s).as_slice());
            }
        }
    }
}

#[cfg(test)]
mod tests;
