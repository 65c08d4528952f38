//! The network of a mission file: tasks, listed edges, and edges found automatically.

use super::document::{Connect, MissionFile, TaskEntry};
use super::guides::{Guide, GuideFinder};
use super::heights::Height;
use super::no_room::{self, NoRoom};
use super::surveys::line::Drawn;
use auv_graph::{ArcId, Edge, EdgeId, Network, NodeId, Task, Waypoint};
use auv_mission::{Mission, Room};
use auv_types::{Point3, Violations, libm};
use std::collections::{BTreeMap, BTreeSet};

/// A line over a bed uses this share of the pitch that the vehicle has: it needs the rest to follow.
const LINE_PITCH: f64 = 0.9;
/// A pitch limit above this is none, radians.
const STEEPEST_RAD: f64 = 1.5;

/// A network with the guides of its arcs.
pub(super) struct Charted {
    pub(super) network: Network,
    pub(super) guides: BTreeMap<ArcId, Vec<Point3<f64>>>,
    /// Groups of edges with the same task: the edges to a waypoint that has one.
    pub(super) shared_tasks: Vec<Vec<EdgeId>>,
    /// What is left out of the network, and why.
    pub(super) no_room: Vec<NoRoom>,
}

/// An edge with its guide.
struct EdgeDraft {
    edge: Edge,
    guide: Guide,
    /// The waypoint whose task the edge carries.
    visits: Option<usize>,
}

/// What an edge that leads to a waypoint carries.
#[derive(Clone, Copy, Debug, PartialEq)]
struct ArcDraft {
    task: Option<Task>,
    /// The waypoint whose task it is.
    visits: Option<usize>,
}

/// A network under construction.
struct Draft<'a> {
    file: &'a MissionFile,
    mission: &'a Mission,
    /// By how much the mission's bed is raised over the charted one, metres.
    bed_raised_m: f64,
    places: &'a [Point3<f64>],
    finder: &'a GuideFinder<'a>,
    /// The room at each waypoint.
    rooms: Vec<Room>,
    /// Indices of start and destination.
    ends: [usize; 2],
    /// The waypoints' tasks.
    tasks: Vec<Option<Task>>,
    drafts: Vec<EdgeDraft>,
    /// Pairs of waypoints (from, to) that an edge connects.
    joined: BTreeSet<(usize, usize)>,
    /// Waypoints that no edge leads to, and waypoints without work, for lack of room.
    left_out: BTreeMap<usize, LeftOut>,
}

/// What is left out of the network for lack of room at a waypoint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum LeftOut {
    /// Work that takes time: no circle fits.
    Work,
    /// Every edge to it: no way leads on either.
    Waypoint,
}

/// The index of the waypoint with a name.
pub(super) fn node_of(file: &MissionFile, name: &str) -> Option<usize> {
    file.waypoints
        .iter()
        .position(|waypoint| waypoint.name == name)
}

/// Builds the network of a mission whose waypoints are placed. `None` if anything is invalid; the reasons are
/// added to `violations`, or to `shut` where no way leads through the water. Edges to waypoints where the vehicle can neither stay nor go on, and work where it
/// cannot stay, are left out with a warning.
pub(super) fn network(
    file: &MissionFile,
    (places, bed_raised_m): (&[Point3<f64>], f64),
    finder: &GuideFinder<'_>,
    mission: &Mission,
    (violations, shut): (&mut Violations, &mut Violations),
) -> Option<Charted> {
    let mut tasks = waypoint_tasks(file, violations);
    file.check_timed(violations);
    let vehicle = &mission.vehicle;
    file.check_kept((vehicle.min_speed_mps, vehicle.max_speed_mps), violations);
    if file.is_timed() {
        tasks.fill(None);
    }
    let mut draft = Draft {
        file,
        mission,
        bed_raised_m,
        places,
        finder,
        rooms: places.iter().map(|place| mission.room_at(place)).collect(),
        ends: [mission.start, mission.destination].map(NodeId::index),
        tasks,
        drafts: Vec::new(),
        joined: BTreeSet::new(),
        left_out: BTreeMap::new(),
    };
    draft.list(violations, shut);
    if let Some(connect) = &file.connect {
        draft.connect(connect, violations);
    }
    if !violations.is_empty() || !shut.is_empty() {
        return None;
    }
    let waypoints: Vec<Waypoint> = file
        .waypoints
        .iter()
        .zip(places)
        .map(|(entry, position)| Waypoint {
            position: *position,
            name: entry.name.clone(),
        })
        .collect();
    let edges: Vec<Edge> = draft.drafts.iter().map(|draft| draft.edge).collect();
    match Network::new(&waypoints, &edges, mission.vehicle.speed_mps) {
        Ok(network) => Some(draft.charted(network)),
        Err(wrong) => {
            violations.absorb("", wrong);
            None
        }
    }
}

/// The tasks of all waypoints, `None` for a waypoint without one. Unknown names and malformed tasks are
/// violations.
fn waypoint_tasks(file: &MissionFile, violations: &mut Violations) -> Vec<Option<Task>> {
    for (name, task) in &file.tasks {
        let place = |key: &str| format!("tasks.{name}.{key}");
        violations.require_not_negative(task.priority, &place("priority"));
        violations.require_positive(task.risk, &place("risk"));
        let told = task.time_s.is_some() || task.pattern.is_some();
        violations.require(told, &place("time_s"), || "is missing; give seconds".into());
        violations.require_not_negative(task.task().completion_time_s, &place("time_s"));
    }
    let of = |(i, waypoint): (usize, &super::document::WaypointEntry)| {
        let name = waypoint.task.as_deref()?;
        let place = format!("waypoints[{i}] ({}).task", waypoint.name);
        task_called(file, name, &place, violations)
    };
    file.waypoints.iter().enumerate().map(of).collect()
}

fn task_called(
    file: &MissionFile,
    name: &str,
    place: &str,
    violations: &mut Violations,
) -> Option<Task> {
    let task = file.tasks.get(name);
    violations.require(task.is_some(), place, || {
        format!("names the task {name}, which [tasks] does not have; add it or correct the name")
    });
    task.map(TaskEntry::task)
}

impl Draft<'_> {
    /// Adds the edges the file lists.
    fn list(&mut self, violations: &mut Violations, shut: &mut Violations) {
        for (i, entry) in self.file.edges.iter().enumerate() {
            let place = format!("edges[{i}] ({} - {})", entry.from, entry.to);
            let ends = [&entry.from, &entry.to].map(|name| {
                let node = node_of(self.file, name);
                violations.require(node.is_some(), &place, || {
                    format!("names the waypoint {name}, which does not exist; correct the name")
                });
                node
            });
            let [Some(from), Some(to)] = ends else {
                continue;
            };
            let own = entry
                .task
                .as_deref()
                .map(|name| task_called(self.file, name, &place, violations));
            if from == to {
                violations.push(place, "leads from a waypoint to itself; remove it");
                continue;
            }
            let fresh = !self.joined.contains(&(from, to))
                && (entry.directed || !self.joined.contains(&(to, from)));
            violations.require(fresh || entry.drawn.is_some(), &place, || {
                "connects the same waypoints as an earlier edge; keep one".into()
            });
            let guide = match entry.drawn {
                Some(Drawn::Line(line)) => Some(self.line(line)),
                _ => self.between([from, to], self.file.kept(entry).0),
            };
            let Some(guide) = guide.filter(|_| fresh || entry.drawn.is_none()) else {
                if entry.drawn.is_some() {
                    continue;
                }
                shut.push(
                    place,
                    "has no path through water that is deep enough; remove it or move its ends",
                );
                continue;
            };
            if fresh {
                let own = own.flatten().filter(|_| !self.file.is_timed());
                self.join(from, to, entry.directed, own, guide);
            }
        }
    }

    /// The way between two waypoints, at a height.
    fn between(&self, ends: [usize; 2], height: Height) -> Option<Guide> {
        let [from, to] = ends.map(|i| &self.places[i]);
        let guide = self.finder.between(from, to)?;
        match height {
            Height::Ends => Some(guide),
            height => Some(self.at_height(height, &guide.points, ends)),
        }
    }

    /// The guide of a line of a survey.
    fn line(&self, line: usize) -> Guide {
        let line = &self.file.lines[line];
        self.at_height(line.height, line.points(), line.ends)
    }

    /// A guide, seen from above, at a height.
    fn at_height(&self, height: Height, points: &[Point3<f64>], ends: [usize; 2]) -> Guide {
        let bed = |p: &Point3<f64>| {
            let bed = self.mission.sea_bed.as_deref();
            let bed_m = bed.map_or(f64::INFINITY, |bed| bed.depth_at(p.x, p.y));
            (bed_m + self.bed_raised_m, self.mission.deepest_at(p.x, p.y))
        };
        let vehicle = &self.mission.vehicle;
        let steepest = libm::tan(LINE_PITCH * vehicle.max_pitch_rad.min(STEEPEST_RAD));
        let ends = ends.map(|i| self.places[i]);
        Guide::along(height.shaped(points, ends, bed, (steepest, vehicle.turn_radius_m)))
    }

    /// Connects two waypoints. The edge carries the given task, otherwise the task of the waypoint it
    /// leads to. An undirected edge between waypoints with tasks becomes two directed edges. Left out is what
    /// the vehicle has no room for.
    fn join(&mut self, from: usize, to: usize, directed: bool, own: Option<Task>, guide: Guide) {
        let there = self.arc_to(to, own);
        let back = if directed {
            None
        } else {
            self.arc_to(from, own)
        };
        self.joined.insert((from, to));
        if !directed {
            self.joined.insert((to, from));
        }
        let same = there == back;
        if let Some(arc) = there {
            self.draw(from, to, !same, arc, guide.clone());
        }
        if let Some(arc) = back.filter(|_| !same) {
            let mut reversed = guide;
            reversed.points.reverse();
            self.draw(to, from, true, arc, reversed);
        }
    }

    fn draw(&mut self, from: usize, to: usize, directed: bool, arc: ArcDraft, guide: Guide) {
        let length_m = (!guide.is_straight()).then_some(guide.length_m);
        self.drafts.push(EdgeDraft {
            edge: Edge {
                from: from as u32,
                to: to as u32,
                directed,
                task: arc.task.unwrap_or(Task::TRANSIT),
                distance_m: length_m,
            },
            guide,
            visits: arc.visits,
        });
    }

    /// The task of an edge that leads to a waypoint; `None` if no edge can lead there.
    fn arc_to(&mut self, to: usize, own: Option<Task>) -> Option<ArcDraft> {
        let visits = (own.is_none() && self.tasks[to].is_some()).then_some(to);
        let arc = ArcDraft {
            task: own.or(self.tasks[to]),
            visits,
        };
        let stays = arc.task.is_some_and(|task| task.completion_time_s > 0.0);
        let docks = to == self.ends[1];
        let (enters, works) = match self.rooms[to] {
            Room::Stays => (true, true),
            Room::LeadsOn(_) => (true, !stays),
            Room::None(_) => (docks, docks && !stays),
        };
        if !enters {
            self.left_out.insert(to, LeftOut::Waypoint);
            return None;
        }
        if works {
            return Some(arc);
        }
        self.left_out.entry(to).or_insert(LeftOut::Work);
        Some(ArcDraft {
            task: None,
            visits: None,
        })
    }

    /// What is left out, by waypoint, with the remedy.
    fn no_room(&self) -> Vec<NoRoom> {
        let text = |(&i, &left_out): (&usize, &LeftOut)| {
            let (Room::LeadsOn(shortage) | Room::None(shortage)) = self.rooms[i] else {
                return None;
            };
            let name = &self.file.waypoints[i].name;
            let what = match left_out {
                LeftOut::Work => "its work is left out",
                LeftOut::Waypoint => "no edge leads there, because no way leads on from it",
            };
            Some(NoRoom {
                what: no_room::LeftOut::Waypoint(i),
                text: format!("waypoints[{i}] ({name}): {what}: {shortage}"),
            })
        };
        self.left_out.iter().filter_map(text).collect()
    }

    /// Connects every waypoint with its nearest waypoints by guide length.
    fn connect(&mut self, connect: &Connect, violations: &mut Violations) {
        self.check_connect(connect, violations);
        if !violations.is_empty() {
            return;
        }
        let listed = |i: usize| {
            let entry = &self.file.waypoints[i];
            entry.line.is_some() || connect.except.contains(&entry.name)
        };
        let shut = |i: usize| matches!(self.rooms[i], Room::None(_)) && !self.ends.contains(&i);
        let (shut, free): (Vec<usize>, Vec<usize>) = (0..self.places.len())
            .filter(|&i| !listed(i))
            .partition(|&i| shut(i));
        self.left_out
            .extend(shut.into_iter().map(|i| (i, LeftOut::Waypoint)));
        let mut found = BTreeMap::new();
        let mut pairs = BTreeSet::new();
        for &i in &free {
            let near = self.nearest(i, &free, connect, &mut found);
            pairs.extend(near.into_iter().map(|j| (i.min(j), i.max(j))));
        }
        for pair in pairs {
            let listed = self.joined.contains(&pair) || self.joined.contains(&(pair.1, pair.0));
            if let (false, Some(Some(guide))) = (listed, found.remove(&pair)) {
                self.join(pair.0, pair.1, false, None, guide);
            }
        }
    }

    fn check_connect(&self, connect: &Connect, violations: &mut Violations) {
        let n = self.places.len();
        violations.require(
            (1..=1_000).contains(&connect.nearest),
            "connect.nearest",
            || format!("is {}; give 1 to 1000", connect.nearest),
        );
        let limited = connect.within_m.is_none_or(|m| m > 0.0 && m.is_finite());
        violations.require(limited, "connect.within_m", || {
            let within_m = connect.within_m.unwrap_or(f64::INFINITY);
            format!("is {within_m}; give metres above 0")
        });
        violations.require(n <= 2_000, "connect", || {
            format!("is for at most 2000 waypoints; list the edges of {n}")
        });
        for name in &connect.except {
            violations.require(node_of(self.file, name).is_some(), "connect.except", || {
                format!("names the waypoint {name}, which does not exist; correct the name")
            });
        }
    }

    /// The waypoints nearest to waypoint `i` by guide length. `found` keeps the guides of all pairs
    /// (lower index first) searched so far.
    fn nearest(
        &self,
        i: usize,
        free: &[usize],
        connect: &Connect,
        found: &mut BTreeMap<(usize, usize), Option<Guide>>,
    ) -> Vec<usize> {
        let within_m = connect.within_m.unwrap_or(f64::INFINITY);
        let distance_m = |j: usize| (self.places[j] - self.places[i]).norm();
        let mut near: Vec<usize> = free.iter().copied().filter(|&j| j != i).collect();
        near.sort_by(|&a, &b| distance_m(a).total_cmp(&distance_m(b)).then(a.cmp(&b)));
        let mut by_length: Vec<(f64, usize)> = Vec::new();
        let keep_nearest = |by_length: &mut Vec<(f64, usize)>| {
            by_length.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
            by_length.truncate(connect.nearest);
        };
        for j in near {
            keep_nearest(&mut by_length);
            let full = by_length.len() == connect.nearest;
            let worst_m = by_length.last().map_or(f64::INFINITY, |(m, _)| *m);
            // A guide is never shorter than the straight line: the waypoints that follow are farther.
            if distance_m(j) > within_m || (full && distance_m(j) >= worst_m) {
                break;
            }
            let (low, high) = (i.min(j), i.max(j));
            let search = || self.finder.between(&self.places[low], &self.places[high]);
            let guide = found.entry((low, high)).or_insert_with(search);
            if let Some(guide) = guide.as_ref().filter(|guide| guide.length_m <= within_m) {
                by_length.push((guide.length_m, j));
            }
        }
        keep_nearest(&mut by_length);
        by_length.into_iter().map(|(_, j)| j).collect()
    }

    /// The network with its guides in both directions.
    fn charted(self, network: Network) -> Charted {
        let no_room = self.no_room();
        let mut guides = BTreeMap::new();
        let mut visits: BTreeMap<usize, Vec<EdgeId>> = BTreeMap::new();
        for (i, draft) in self.drafts.into_iter().enumerate() {
            if let Some(node) = draft.visits {
                visits.entry(node).or_default().push(EdgeId(i as u32));
            }
            if draft.guide.is_straight() {
                continue;
            }
            let (from, to) = (NodeId(draft.edge.from), NodeId(draft.edge.to));
            let mut points = draft.guide.points;
            if let Some(arc) = network.arc_between(from, to) {
                guides.insert(arc, points.clone());
            }
            if let (false, Some(arc)) = (draft.edge.directed, network.arc_between(to, from)) {
                points.reverse();
                guides.insert(arc, points);
            }
        }
        Charted {
            network,
            guides,
            shared_tasks: visits.into_values().collect(),
            no_room,
        }
    }
}
