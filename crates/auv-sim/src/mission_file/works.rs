//! The work that a mission file asks for, place by place.

use super::document::{MissionFile, TaskEntry};
use super::network::node_of;
use crate::Summary;
use auv_graph::{ArcId, Task};
use auv_mission::Mission;
use std::collections::BTreeMap;

/// A task at a place, done once in a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Work {
    /// The task's name.
    pub name: String,
    /// The waypoint where it is done, or both ends of the edge.
    pub at: String,
    /// The arcs that it is done along; none where there is no way or no room.
    pub arcs: Vec<ArcId>,
    pub(super) place: WorkPlace,
}

/// Where work is done, by its entry in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WorkPlace {
    Waypoint(usize),
    Edge(usize),
}

impl MissionFile {
    /// Every task of the file's waypoints and edges, in the order of the file, with the arcs of the mission
    /// built from it.
    #[must_use]
    pub fn works(&self, mission: &Mission) -> Vec<Work> {
        let mut works = self.work_places();
        let edges = self.edges_with_tasks();
        for (i, arc) in mission.network.arcs().iter().enumerate() {
            let id = ArcId(i as u32);
            let ends = (arc.tail.index(), arc.head.index());
            let edge = edges.get(&ends).copied().map(WorkPlace::Edge);
            let place = edge.unwrap_or(WorkPlace::Waypoint(arc.head.index()));
            let done = works.iter_mut().find(|work| work.place == place);
            let Some(work) = done.filter(|_| !mission.closed.contains(&id)) else {
                continue;
            };
            // Work that has no room is taken off its arcs.
            if self.task(&work.name) == Some(mission.network.task(arc.edge)) {
                work.arcs.push(id);
            }
        }
        works
    }

    /// Every task of the file's waypoints and edges, in the order of the file, without arcs.
    pub(super) fn work_places(&self) -> Vec<Work> {
        let at_waypoints = self.waypoints.iter().enumerate().filter_map(|(i, entry)| {
            let name = entry.task.clone()?;
            Some((name, entry.name.clone(), WorkPlace::Waypoint(i)))
        });
        let on_edges = self.edges.iter().enumerate().filter_map(|(k, entry)| {
            let at = format!("{} - {}", entry.from, entry.to);
            Some((entry.task.clone()?, at, WorkPlace::Edge(k)))
        });
        let works = at_waypoints.chain(on_edges).map(|(name, at, place)| Work {
            name,
            at,
            arcs: Vec::new(),
            place,
        });
        works.collect()
    }

    /// Which of the works a flown mission has done, in their order.
    #[must_use]
    pub fn works_done(&self, mission: &Mission, summary: &Summary) -> Vec<bool> {
        let legs = summary.path_calls.iter().filter(|leg| leg.completed);
        let flown: Vec<ArcId> = legs
            .filter_map(|leg| mission.network.arc_between(leg.from, leg.to))
            .collect();
        let works = self.works(mission);
        let is_done = |work: &Work| work.arcs.iter().any(|arc| flown.contains(arc));
        works.iter().map(is_done).collect()
    }

    fn task(&self, name: &str) -> Option<Task> {
        self.tasks.get(name).map(TaskEntry::task)
    }

    /// The edges of the file that have a task of their own, by the waypoints they join, in both directions
    /// unless they are directed.
    fn edges_with_tasks(&self) -> BTreeMap<(usize, usize), usize> {
        let mut found = BTreeMap::new();
        for (k, entry) in self.edges.iter().enumerate() {
            let ends = (node_of(self, &entry.from), node_of(self, &entry.to));
            if let (Some(_), (Some(from), Some(to))) = (&entry.task, ends) {
                found.insert((from, to), k);
                if !entry.directed {
                    found.insert((to, from), k);
                }
            }
        }
        found
    }
}
