//! Whether work can be done at all.

use crate::mission_file::works::Work;
use auv_graph::{ArcId, NodeId};
use auv_mission::{Earliest, Mission, Outlook};

/// Whether work can be done, all other work left out as far as possible.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Possible {
    /// In so many seconds from the launch until home.
    Yes {
        takes_s: f64,
    },
    /// It is done too late to be home in time, by this many seconds.
    TooLong {
        by_s: f64,
    },
    /// Its windows are over when the vehicle can be there.
    WindowOver,
    /// The quickest way there and home passes a waypoint twice, and no other is quick enough.
    NotAlone,
    NoWay,
}

impl Possible {
    /// Why it cannot be done, with the remedy.
    pub(super) fn text(self, work: &Work) -> Option<String> {
        let at = &work.at;
        match self {
            Self::Yes { .. } => None,
            Self::TooLong { by_s } => Some(format!(
                "the vehicle is home {by_s:.0} s too late if it does nothing else; give a longer budget_s or a shorter reserve_s"
            )),
            Self::WindowOver => Some("its windows are over before the vehicle can be there; give a later one, or launch earlier".into()),
            Self::NotAlone => Some(format!(
                "no way found goes to {at} and home in time without passing a waypoint twice; add an edge that leads on from there"
            )),
            Self::NoWay => Some(format!(
                "no way leads to {at} and from there home; add edges, or launch when the current lets the vehicle through"
            )),
        }
    }
}

/// What can be done from the launch on.
pub(super) struct Prospects<'a> {
    mission: &'a Mission,
    outlook: &'a Outlook<'a>,
    /// The quickest ways from the start.
    there: Earliest,
}

impl<'a> Prospects<'a> {
    pub(super) fn new(mission: &'a Mission, outlook: &'a Outlook<'a>) -> Self {
        Self {
            mission,
            outlook,
            there: outlook.earliest_from(mission.start, mission.launch_s, &[]),
        }
    }

    /// Whether work that the route leaves out can be done alone.
    pub(super) fn of(&self, work: &Work) -> Possible {
        let mission = self.mission;
        let by = |arc: &ArcId| Quickest::by(self, work, *arc);
        let ways: Vec<Quickest> = work.arcs.iter().map(by).collect();
        let home_s = ways
            .iter()
            .map(|way| way.home_s)
            .fold(f64::INFINITY, f64::min);
        if home_s.is_infinite() {
            let is_over = |way: &Quickest| way.arrives_s.is_finite() && way.done_s.is_infinite();
            return match ways.iter().any(is_over) {
                true => Possible::WindowOver,
                false => Possible::NoWay,
            };
        }
        let quickest = self.home_at(home_s);
        if matches!(quickest, Possible::TooLong { .. }) {
            return quickest;
        }
        let at_home_s = |way: &Quickest| {
            let edge = mission.network.arcs()[way.arc.index()];
            let dock = way.home.first_of(mission.all_docks());
            let home = dock.into_iter().flat_map(|(dock, _)| way.home.way_to(dock));
            let keep_off = home.filter(|&node| node != edge.tail).collect();
            let ways = [vec![edge.head], keep_off].into_iter();
            let home_s = ways.map(|avoid| self.home_s(work, way.arc, &avoid));
            home_s.fold(f64::INFINITY, f64::min)
        };
        let home_s = ways.iter().map(at_home_s).fold(f64::INFINITY, f64::min);
        match self.home_at(home_s) {
            Possible::TooLong { .. } => Possible::NotAlone,
            yes => yes,
        }
    }

    /// The answer for work that the vehicle is home from at a mission time.
    pub(super) fn home_at(&self, home_s: f64) -> Possible {
        let due_s = self.due_s();
        if home_s > due_s {
            return Possible::TooLong {
                by_s: home_s - due_s,
            };
        }
        Possible::Yes {
            takes_s: home_s - self.mission.launch_s,
        }
    }

    /// When the vehicle must be home, the reserve kept and the battery not used up, seconds.
    fn due_s(&self) -> f64 {
        let mission = self.mission;
        mission.launch_s + mission.available_s(mission.budget_s, 0.0) - mission.reserve_s
    }

    /// When the vehicle is home from waypoints passed one after the other, seconds.
    pub(super) fn home_along_s(&self, nodes: &[NodeId]) -> f64 {
        let [Some(&first), Some(&last)] = [nodes.first(), nodes.last()] else {
            return f64::INFINITY;
        };
        let mut at_s = self.there.at_s(first);
        for pair in nodes.windows(2) {
            let arc = self.mission.network.arc_between(pair[0], pair[1]);
            at_s = arc.map_or(f64::INFINITY, |arc| self.outlook.arc_done_s(arc, at_s));
        }
        let home = self.outlook.earliest_from(last, at_s, &[]);
        self.outlook.home_s(&home)
    }

    /// When an arc that is left at a mission time is flown and the work at its end done, seconds.
    fn done_s(&self, work: &Work, arc: ArcId, departure_s: f64) -> f64 {
        let arrives_s = self.outlook.arc_done_s(arc, departure_s);
        match work.timed {
            Some(task) if arrives_s.is_finite() => self.outlook.timed_done_s(task, arrives_s),
            _ => arrives_s,
        }
    }

    /// When a route through an arc is home that passes no waypoint twice and goes there past none of those to
    /// avoid.
    fn home_s(&self, work: &Work, arc: ArcId, avoid: &[NodeId]) -> f64 {
        let (mission, outlook) = (self.mission, self.outlook);
        let edge = mission.network.arcs()[arc.index()];
        let mut avoid = avoid.to_vec();
        avoid.extend(mission.all_docks());
        let there = outlook.earliest_from(mission.start, mission.launch_s, &avoid);
        let done_s = self.done_s(work, arc, there.at_s(edge.tail));
        let passed: Vec<NodeId> = there.way_to(edge.tail).collect();
        let home = outlook.earliest_from(edge.head, done_s, &passed);
        outlook.home_s(&home)
    }
}

/// The quickest way to work along an arc, and home from there.
struct Quickest {
    arc: ArcId,
    arrives_s: f64,
    done_s: f64,
    home: Earliest,
    home_s: f64,
}

impl Quickest {
    fn by(prospects: &Prospects<'_>, work: &Work, arc: ArcId) -> Self {
        let outlook = prospects.outlook;
        let edge = prospects.mission.network.arcs()[arc.index()];
        let departs_s = prospects.there.at_s(edge.tail);
        let done_s = prospects.done_s(work, arc, departs_s);
        let home = outlook.earliest_from(edge.head, done_s, &[]);
        Self {
            arc,
            arrives_s: outlook.arc_done_s(arc, departs_s),
            done_s,
            home_s: outlook.home_s(&home),
            home,
        }
    }
}
