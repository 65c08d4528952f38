//! How a mission is expected to go: its stops, and what is done at them.

use super::answer::StopCheck;
use crate::mission_file::works::Work;
use auv_graph::ArcId;
use auv_mission::{Mission, Stop};

/// How a mission is expected to go.
#[derive(Debug, Default)]
pub(super) struct Expected {
    /// The waypoints in order, the start first.
    pub(super) stops: Vec<Stop>,
    /// The arc by which each is reached; `None` for the start, and where the leg follows none.
    pub(super) arcs: Vec<Option<ArcId>>,
}

impl Expected {
    /// A route as timed before the launch.
    pub(super) fn route(mission: &Mission, stops: Vec<Stop>) -> Self {
        let legs = stops.windows(2);
        let arcs = legs.map(|leg| mission.network.arc_between(leg[0].node, leg[1].node));
        Self {
            arcs: std::iter::once(None).chain(arcs).collect(),
            stops,
        }
    }

    /// The stop at which work is done.
    pub(super) fn done_at(&self, work: &Work) -> Option<usize> {
        if let Some(task) = work.timed {
            let does = |stop: &Stop| stop.timed.iter().any(|done| done.task == task);
            return self.stops.iter().position(does);
        }
        let does = |arc: &Option<ArcId>| arc.is_some_and(|arc| work.arcs.contains(&arc));
        self.arcs.iter().position(does)
    }

    /// Whether each work is done.
    pub(super) fn done(&self, works: &[Work]) -> Vec<bool> {
        let done = works.iter().map(|work| self.done_at(work).is_some());
        done.collect()
    }

    /// The stops with their work.
    pub(super) fn told(&self, works: &[Work], mission: &Mission) -> Vec<StopCheck> {
        let told = |(i, stop): (usize, &Stop)| {
            let here = works.iter().filter(|work| self.done_at(work) == Some(i));
            StopCheck {
                place: mission.name_of(stop.node),
                arrive_s: stop.arrive_s,
                leave_s: stop.leave_s,
                tasks: here.map(|work| work.name.clone()).collect(),
                fixes_s: stop.fixes_s,
                waits_s: stop.waits_s,
            }
        };
        self.stops.iter().enumerate().map(told).collect()
    }
}
