//! What the mission has used and done: time, energy, waypoints, tasks, and the two tables.

use crate::{Mission, PathCall, RouteCall};
use auv_graph::{EdgeId, EdgeSet, NodeId};
use auv_obstacles::TimedPoint;

/// A leg that waited for at least this share of its time made no progress.
const NO_PROGRESS: f64 = 0.9;

/// What the mission has used and done. The tables have one row for each call, oldest first.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(crate) struct Ledger {
    pub(crate) started_s: f64,
    /// Computing time charged to the mission.
    pub(crate) charged_s: f64,
    pub(crate) used_j: f64,
    /// Waypoints reached, in order, the start included.
    pub(crate) visited: Vec<NodeId>,
    /// Edges taken out of the network: passed, or given up.
    pub(crate) removed: EdgeSet,
    pub(crate) weight: f64,
    pub(crate) tasks: usize,
    pub(crate) route_calls: Vec<RouteCall>,
    pub(crate) path_calls: Vec<PathCall>,
}

impl Ledger {
    pub(crate) fn new(mission: &Mission) -> Self {
        Self {
            started_s: 0.0,
            charged_s: 0.0,
            used_j: 0.0,
            visited: vec![mission.start],
            removed: EdgeSet::empty(),
            weight: 0.0,
            tasks: 0,
            route_calls: Vec::new(),
            path_calls: Vec::new(),
        }
    }

    /// The last waypoint reached.
    pub(crate) fn at(&self, mission: &Mission) -> NodeId {
        self.visited.last().copied().unwrap_or(mission.start)
    }

    /// Mission time left of the budget at a time, seconds, or how long the battery lasts if that is
    /// less.
    pub(crate) fn available_s(&self, mission: &Mission, now_s: f64) -> f64 {
        let spent_s = now_s - self.started_s;
        let left_s = mission.budget_s - spent_s - self.charged_s;
        mission.available_s(left_s, self.used_j)
    }

    /// Books the energy of a move: hotel load, and propulsion over the distance through the water in the
    /// current as forecast.
    pub(crate) fn book_energy(&mut self, mission: &Mission, from: TimedPoint, to: TimedPoint) {
        let Some(battery) = &mission.battery else {
            return;
        };
        let time_s = to.time_s - from.time_s;
        let mut way = to.position - from.position;
        if let Some(current) = &mission.current {
            way -= current.velocity_at(&from.position, from.time_s) * time_s;
        }
        self.used_j += battery.used_j(time_s, way.norm());
    }

    /// Books a task done; the edges that share it are taken out with it.
    pub(crate) fn book_task(&mut self, mission: &Mission, edge: EdgeId) {
        for done in mission.done_with(edge) {
            self.removed.insert(done);
        }
        let task = mission.network.task(edge);
        self.weight += task.weight();
        self.tasks += usize::from(task.weight() > 0.0);
    }

    /// Route answers in a row that were not valid.
    pub(crate) fn invalid_routes(&self) -> usize {
        let calls = self.route_calls.iter().rev();
        calls.take_while(|call| !call.valid).count()
    }

    /// How long the vehicle has made no progress, seconds: it waited in the leg being flown
    /// (`waited_s` of `leg_s`) and in the legs given up right before it.
    pub(crate) fn shut_in_s(&self, waited_s: f64, leg_s: f64) -> f64 {
        let before = self.path_calls.iter().rev();
        let before = before.map(|call| (call.completed, call.waited_s, call.leg_s));
        let mut sum_s = 0.0;
        for (completed, waited_s, leg_s) in std::iter::once((false, waited_s, leg_s)).chain(before)
        {
            if completed {
                break;
            }
            sum_s += waited_s;
            if waited_s < NO_PROGRESS * leg_s {
                break;
            }
        }
        sum_s
    }
}
