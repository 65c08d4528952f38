//! Tasks with windows, order and duty, and several tasks at one place.

use super::document::{MissionFile, TaskEntry};
use super::no_room::{LeftOut, NoRoom};
use super::surveys::entry::SurveyEntry;
use super::works::{Work, WorkPlace};
use auv_graph::{ArcId, Chain, NodeId, Task, TaskName, TaskPlace, TimeModel, TimedTask};
use auv_mission::{Manner, Mission, Room};
use auv_types::{Point3, Violations};
use std::collections::BTreeMap;

impl MissionFile {
    /// Whether its tasks are planned in time: one has windows, order, duty or a manner of its own, a place lists several, or there are
    /// several docks.
    pub(super) fn is_timed(&self) -> bool {
        let timed = |task: &TaskEntry| {
            task.mandatory
                || !task.after.is_empty()
                || !task.windows.is_empty()
                || task.manner(0.0).is_some()
        };
        self.docks.as_ref().is_some_and(|docks| docks.len() > 1)
            || self.tasks.values().any(timed)
            || self.waypoints.iter().any(|entry| entry.tasks.is_some())
            || self.edges.iter().any(|entry| entry.tasks.is_some())
    }

    /// Whether a task must be done.
    #[must_use]
    pub fn has_mandatory_tasks(&self) -> bool {
        self.tasks.values().any(|task| task.mandatory)
    }

    /// What is wrong with windows, order and lists of tasks.
    pub(super) fn check_timed(&self, violations: &mut Violations) {
        for (name, task) in &self.tasks {
            Self::check_windows(&task.windows, &format!("tasks.{name}"), violations);
            for (i, before) in task.after.iter().enumerate() {
                let place = format!("tasks.{name}.after");
                violations.require(!task.after[..i].contains(before), &place, || {
                    format!("names {before} twice; give it once")
                });
                let known = self.tasks.keys().any(|name| self.is_called(name, before));
                violations.require(known, &place, || {
                    format!("names the task \"{before}\", which [tasks] does not have; add it or correct the name")
                });
                let works = self.work_places();
                let placed = works.iter().any(|work| self.is_called(&work.name, before));
                violations.require(!known || placed, &place, || {
                    format!("names {before}, which no waypoint or edge has; give it a place or leave it out")
                });
            }
        }
        for (i, entry) in self.waypoints.iter().enumerate() {
            let place = format!("waypoints[{i}] ({})", entry.name);
            self.check_list(&place, (&entry.task, &entry.tasks), violations);
        }
        for (i, entry) in self.edges.iter().enumerate() {
            let place = format!("edges[{i}] ({} - {})", entry.from, entry.to);
            self.check_list(&place, (&entry.task, &entry.tasks), violations);
        }
    }

    /// What is wrong with windows.
    pub(super) fn check_windows(windows: &[[f64; 2]], of: &str, violations: &mut Violations) {
        for (i, [from, until]) in windows.iter().enumerate() {
            if from.is_nan() || until.is_nan() {
                violations.require(false, &format!("{of}.windows[{i}]"), || {
                    format!("is [{from}, {until}]; give [from, until] in seconds or UTC, ascending")
                });
                continue;
            }
            violations.require(from <= until, &format!("{of}.windows[{i}]"), || {
                format!(
                    "ends {} s before it begins; give [from, until] in seconds or UTC, ascending",
                    from - until
                )
            });
            violations.require(
                from > until || *until >= 0.0,
                &format!("{of}.windows[{i}]"),
                || {
                    format!(
                        "ends {} s before the launch; give a later window or an earlier launch",
                        -until
                    )
                },
            );
        }
    }

    /// What is wrong with the tasks of one place.
    fn check_list(
        &self,
        place: &str,
        (one, list): (&Option<String>, &Option<Vec<String>>),
        violations: &mut Violations,
    ) {
        violations.require(one.is_none() || list.is_none(), place, || {
            "has both task and tasks; keep one".into()
        });
        let list = list.as_deref().unwrap_or_default();
        for (i, name) in list.iter().enumerate() {
            let key = format!("{place}.tasks[{i}]");
            violations.require(self.tasks.contains_key(name), &key, || {
                format!(
                    "names the task {name}, which [tasks] does not have; add it or correct the name"
                )
            });
            violations.require(!list[..i].contains(name), &key, || {
                format!("names {name} twice; give it once")
            });
        }
    }

    /// The tasks of a mission whose network stands, as route planners take them. Work at the start, and work
    /// that takes time where the vehicle has no room to stay, is left out with a warning.
    pub(super) fn time_model(
        &self,
        mission: &Mission,
        no_room: &mut Vec<NoRoom>,
        violations: &mut Violations,
    ) -> Option<TimeModel> {
        if !self.is_timed() {
            return None;
        }
        for (name, pattern) in self.tasks.iter().filter_map(|(n, t)| Some((n, t.pattern?))) {
            let place = format!("tasks.{name}.pattern.");
            violations.absorb(&place, pattern.validate(&mission.vehicle));
        }
        if !violations.is_empty() {
            return None;
        }
        let mut tasks = Vec::new();
        for work in self.work_places() {
            let Some(entry) = self.tasks.get(&work.name) else {
                continue;
            };
            match self.timed_task(mission, &work, entry) {
                Ok(task) => tasks.extend(task),
                Err(left_out) => no_room.push(left_out),
            }
        }
        self.leave_out_after(&mut tasks, no_room);
        self.put_in_order(&mut tasks);
        let chain = |survey: &SurveyEntry| Chain {
            name: survey.name().into(),
            may_split: survey.may_split(),
        };
        let model = TimeModel {
            tasks,
            chains: self.surveys.iter().map(chain).collect(),
            ..TimeModel::default()
        };
        violations.absorb("", model.validate(&mission.network));
        Some(model)
    }

    /// One task of a model, still without its order; none where no edge is.
    fn timed_task(
        &self,
        mission: &Mission,
        work: &Work,
        entry: &TaskEntry,
    ) -> Result<Option<TimedTask>, NoRoom> {
        let stays = entry.task().completion_time_s > 0.0 || !entry.windows.is_empty();
        let (places, place) = self.places_of(mission, work);
        let spots = || places.iter().map(|&node| mission.position_of(node));
        let manner = self.manner(mission, work);
        let unfit =
            || manner.and_then(|manner| spots().find_map(|at| mission.keeps_out(&manner, &at)));
        // What is flown begins again after a fix in its middle, and would never end.
        let too_long = || {
            let at = spots().next()?;
            let takes_s = timed(entry.task(), Some(manner?), mission, Some(at)).completion_time_s;
            let free_s = mission.between_fixes_s(at.z)?;
            (takes_s > free_s).then(|| {
                format!("it takes {takes_s:.0} s, more than the {free_s:.0} s there from one fix at the surface to the next; make it shorter, or every_s of [surface] longer")
            })
        };
        let why = keeps_out(mission, &places, stays)
            .or_else(unfit)
            .or_else(too_long);
        if let Some(why) = why {
            return Err(NoRoom {
                what: LeftOut::Work(work.title()),
                text: format!("{}: its work is left out: {why}", work.title()),
            });
        }
        let mut windows = entry.windows.clone();
        windows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        Ok(place.map(|place| TimedTask {
            name: TaskName::Text(work.title()),
            place,
            task: timed(entry.task(), manner, mission, spots().next()),
            windows: joined(windows),
            mandatory: entry.mandatory,
            after: Vec::new(),
            chain: self.line_of(&work.name).map(|line| line.survey),
        }))
    }

    /// How the tasks of a model are done at waypoints, by index.
    pub(super) fn manners(&self, mission: &Mission, model: &TimeModel) -> BTreeMap<usize, Manner> {
        let works = self.work_places();
        let manner = |task: &TimedTask| {
            let title = task.name.to_string();
            let work = works.iter().find(|work| work.title() == title)?;
            self.manner(mission, work)
        };
        let tasks = model.tasks.iter().enumerate();
        tasks
            .filter_map(|(i, task)| Some((i, manner(task)?)))
            .collect()
    }

    /// How work at a waypoint is done. On an edge it is the edge that is flown so, but for a pattern at its end.
    fn manner(&self, mission: &Mission, work: &Work) -> Option<Manner> {
        let (places, _) = self.places_of(mission, work);
        let place = mission.position_of(*places.first()?);
        let bed = mission.sea_bed.as_deref();
        let bed_m = bed.map_or(f64::INFINITY, |bed| bed.depth_at(place.x, place.y));
        let entry = self.tasks.get(&work.name)?;
        match work.place {
            WorkPlace::Waypoint(_) => entry.manner(bed_m),
            WorkPlace::Edge(_) => entry.pattern.map(|pattern| Manner {
                pattern: Some(pattern),
                ..Manner::default()
            }),
        }
    }

    /// The waypoints where work may end, and its place in the network; no place where no edge is.
    fn places_of(&self, mission: &Mission, work: &Work) -> (Vec<NodeId>, Option<TaskPlace>) {
        match work.place {
            WorkPlace::Waypoint(i) => {
                let node = NodeId(i as u32);
                (vec![node], Some(TaskPlace::Node(node)))
            }
            WorkPlace::Edge(k) => {
                let entry = &self.edges[k];
                let ends = [&entry.from, &entry.to].map(|name| mission.network.find(name));
                let [Some(from), Some(to)] = ends else {
                    return (Vec::new(), None);
                };
                let arc: Option<ArcId> = mission.network.arc_between(from, to);
                let edge = arc.map(|arc| mission.network.arcs()[arc.index()].edge);
                let ends = if entry.directed {
                    vec![to]
                } else {
                    vec![from, to]
                };
                (ends, edge.map(TaskPlace::Edge))
            }
        }
    }

    /// Leaves out what comes after work that is left out, with a warning each.
    fn leave_out_after(&self, tasks: &mut Vec<TimedTask>, no_room: &mut Vec<NoRoom>) {
        loop {
            let names = self.names_of(tasks);
            let missing = |name: &String| {
                let mut before = self.tasks.get(name)?.after.iter();
                let is_left =
                    |before: &&String| names.iter().any(|name| self.is_called(name, before));
                before.find(|before| !is_left(before)).cloned()
            };
            let found = names.iter().position(|name| missing(name).is_some());
            let Some(i) = found else {
                return;
            };
            let before = missing(&names[i]).unwrap_or_default();
            let title = tasks.remove(i).name.to_string();
            no_room.push(NoRoom {
                text: format!(
                    "{title}: its work is left out: it comes after {before}, which is left out"
                ),
                what: LeftOut::Work(title),
            });
        }
    }

    /// The names that tasks have in the file.
    fn names_of(&self, tasks: &[TimedTask]) -> Vec<String> {
        let places = self.work_places().into_iter();
        let works: BTreeMap<String, String> =
            places.map(|work| (work.title(), work.name)).collect();
        let name = |task: &TimedTask| works.get(&task.name.to_string()).cloned();
        let names = tasks.iter().map(|task| name(task).unwrap_or_default());
        names.collect()
    }

    /// Sets what each task comes after.
    fn put_in_order(&self, tasks: &mut [TimedTask]) {
        let names = self.names_of(tasks);
        for (name, task) in names.iter().zip(tasks) {
            let before = self.tasks.get(name).map_or(&[][..], |entry| &entry.after);
            let comes_before = |&k: &usize| {
                before
                    .iter()
                    .any(|before| self.is_called(&names[k], before))
            };
            task.after = (0..names.len()).filter(comes_before).collect();
        }
    }
}

/// A task with what is flown for it in still water.
fn timed(
    task: Task,
    manner: Option<Manner>,
    mission: &Mission,
    place: Option<Point3<f64>>,
) -> Task {
    let flown = manner.zip(place);
    let flown_s = flown.map_or(0.0, |(manner, at)| manner.takes_s(&mission.vehicle, at));
    Task {
        completion_time_s: task.completion_time_s + flown_s,
        ..task
    }
}

/// What keeps work out of a mission.
fn keeps_out(mission: &Mission, places: &[NodeId], stays: bool) -> Option<String> {
    if places == [mission.start] {
        return Some("the start is never arrived at; put it on another waypoint".into());
    }
    let rooms = places
        .iter()
        .filter(|_| stays)
        .map(|&node| mission.room_at(&mission.position_of(node)));
    let mut short = rooms.filter_map(|room| match room {
        Room::Stays => None,
        Room::LeadsOn(shortage) | Room::None(shortage) => Some(shortage.to_string()),
    });
    short.next()
}

/// Windows in order, with those that overlap made one.
fn joined(windows: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut apart: Vec<[f64; 2]> = Vec::new();
    for window in windows {
        match apart.last_mut() {
            Some(last) if window[0] <= last[1] => last[1] = last[1].max(window[1]),
            _ => apart.push(window),
        }
    }
    apart
}
