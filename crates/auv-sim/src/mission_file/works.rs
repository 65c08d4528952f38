//! The work that a mission file asks for, place by place.

use super::document::{MissionFile, TaskEntry};
use super::network::node_of;
use super::no_room::{LeftOut, NoRoom};
use crate::Summary;
use auv_graph::{ArcId, NodeId, Task, TaskName, TimeModel};
use auv_mission::Mission;
use std::collections::BTreeMap;
use std::sync::Arc;

/// A task at a place, done once in a mission.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Work {
    /// The task's name.
    pub name: String,
    /// The waypoint where it is done, or both ends of the edge.
    pub at: String,
    /// The arcs that it is done along; none where there is no way or no room.
    pub arcs: Vec<ArcId>,
    /// Its index in the mission's time model, if it has one.
    pub timed: Option<usize>,
    pub(super) place: WorkPlace,
}

/// Where work is done, by its entry in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum WorkPlace {
    Waypoint(usize),
    Edge(usize),
}

impl Work {
    /// Its name with its place, which no other work has.
    pub(super) fn title(&self) -> String {
        format!("{} at {}", self.name, self.at)
    }
}

impl MissionFile {
    /// Every task of the file's waypoints and edges, in the order of the file, with the arcs of the mission
    /// built from it.
    #[must_use]
    pub fn works(&self, mission: &Mission) -> Vec<Work> {
        let mut works = self.work_places();
        let edges = self.edges_with_tasks();
        let timed = mission.time_model.as_ref();
        for work in &mut works {
            let title = TaskName::Text(work.title());
            let index = |model: &Arc<TimeModel>| model.tasks.iter().position(|t| t.name == title);
            work.timed = timed.and_then(index);
        }
        for (i, arc) in mission.network.arcs().iter().enumerate() {
            let id = ArcId(i as u32);
            if mission.is_closed(id) {
                continue;
            }
            let ends = (arc.tail.index(), arc.head.index());
            let edge = edges.get(&ends).copied().map(WorkPlace::Edge);
            let at_head = WorkPlace::Waypoint(arc.head.index());
            for work in &mut works {
                // The task of an edge is done instead of the waypoint's, unless tasks are planned in time.
                let is_here = edge.unwrap_or(at_head) == work.place;
                let does = match timed {
                    // Work that has no room is taken off its arcs.
                    None => {
                        is_here && self.task(&work.name) == Some(mission.network.task(arc.edge))
                    }
                    Some(_) => work.timed.is_some() && (is_here || at_head == work.place),
                };
                if does {
                    work.arcs.push(id);
                }
            }
        }
        works
    }

    /// Every task of the file's waypoints and edges, in the order of the file, without arcs.
    pub(super) fn work_places(&self) -> Vec<Work> {
        let names = |one: &Option<String>, list: &Option<Vec<String>>| {
            let list = list.clone().unwrap_or_default();
            one.clone().into_iter().chain(list).collect::<Vec<String>>()
        };
        let mut works = Vec::new();
        let mut add = |names: Vec<String>, at: &str, place| {
            works.extend(names.into_iter().map(|name| Work {
                name,
                at: at.into(),
                arcs: Vec::new(),
                timed: None,
                place,
            }));
        };
        for (i, entry) in self.waypoints.iter().enumerate() {
            let place = WorkPlace::Waypoint(i);
            add(names(&entry.task, &entry.tasks), &entry.name, place);
        }
        for (k, entry) in self.edges.iter().enumerate() {
            let at = format!("{} - {}", entry.from, entry.to);
            add(names(&entry.task, &entry.tasks), &at, WorkPlace::Edge(k));
        }
        works
    }

    /// Which of the works a flown mission has done, in their order.
    #[must_use]
    pub fn works_done(&self, mission: &Mission, summary: &Summary) -> Vec<bool> {
        let legs = summary.path_calls.iter().filter(|leg| leg.completed);
        let flown: Vec<ArcId> = legs
            .filter_map(|leg| mission.network.arc_between(leg.from, leg.to))
            .collect();
        let works = self.works(mission);
        let is_done = |work: &Work| match work.timed {
            Some(task) => summary.timed_done.iter().any(|done| done.task == task),
            None => work.arcs.iter().any(|arc| flown.contains(arc)),
        };
        works.iter().map(is_done).collect()
    }

    /// Whether something that is left out keeps work from being done.
    pub(super) fn concerns(&self, known: &NoRoom, work: &Work, mission: &Mission) -> bool {
        let ends = self.ends_of(work, mission);
        match (&known.what, work.place) {
            (LeftOut::Work(title), _) => *title == work.title(),
            (LeftOut::Waypoint(i), WorkPlace::Waypoint(at)) => *i == at,
            (LeftOut::Waypoint(i), WorkPlace::Edge(_)) => {
                ends.is_some_and(|ends| ends.contains(&NodeId(*i as u32)))
            }
            (LeftOut::Arc(arc), WorkPlace::Waypoint(at)) => {
                mission.network.arcs()[arc.index()].head.index() == at
            }
            (LeftOut::Arc(arc), WorkPlace::Edge(_)) => {
                let arc = mission.network.arcs()[arc.index()];
                ends.is_some_and(|ends| ends.contains(&arc.tail) && ends.contains(&arc.head))
            }
        }
    }

    /// The ends of the edge that work is done on.
    fn ends_of(&self, work: &Work, mission: &Mission) -> Option<[NodeId; 2]> {
        let WorkPlace::Edge(k) = work.place else {
            return None;
        };
        let entry = &self.edges[k];
        let [from, to] = [&entry.from, &entry.to].map(|name| mission.network.find(name));
        Some([from?, to?])
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
            let works = entry.task.is_some() || entry.tasks.is_some();
            if let (true, (Some(from), Some(to))) = (works, ends) {
                found.insert((from, to), k);
                if !entry.directed {
                    found.insert((to, from), k);
                }
            }
        }
        found
    }
}
