//! What the mission has used and done: time, energy, waypoints, tasks, and the two tables.

use crate::{Mission, PathCall, RouteCall};
use auv_graph::{EdgeId, EdgeSet, NodeId};
use auv_obstacles::TimedPoint;
use auv_planning::TaskDone;

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
    /// The tasks done of those with windows and order.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) done: Vec<TaskDone>,
    /// How often the vehicle climbed because it was too low over the bed as measured.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) climbs: u32,
    /// Waypoints reached higher than given, and by how much, metres.
    #[cfg_attr(feature = "serde", serde(default))]
    pub(crate) raised: Vec<(NodeId, f64)>,
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
            done: Vec::new(),
            climbs: 0,
            raised: Vec::new(),
            route_calls: Vec::new(),
            path_calls: Vec::new(),
        }
    }

    /// More computing time is not charged, seconds: no mission lasts as long.
    pub(crate) const MOST_CHARGED_S: f64 = 1e9;

    /// Charges computing time to the mission.
    pub(crate) fn charge(&mut self, charge_s: f64) {
        self.charged_s = (self.charged_s + charge_s).min(Self::MOST_CHARGED_S);
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

    /// Books a task with windows and order done.
    pub(crate) fn book_timed(&mut self, mission: &Mission, done: TaskDone) {
        let model = mission.time_model.as_ref();
        let weight = model.map_or(0.0, |model| model.tasks[done.task].task.weight());
        self.weight += weight;
        self.tasks += usize::from(weight > 0.0);
        self.done.push(done);
    }

    /// Whether a task with windows and order is done.
    pub(crate) fn has_done(&self, task: usize) -> bool {
        self.done.iter().any(|done| done.task == task)
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fixture::{Fixture, path_row, place};
    use crate::{Battery, RouteReason, route_question};
    use auv_graph::Task;
    use auv_ocean::UniformCurrent;
    use auv_types::Vector3;
    use std::sync::Arc;

    #[test]
    fn time_left_counts_from_the_start_and_deducts_what_is_charged() {
        let mut fixture = Fixture::new();
        let ledger = &mut fixture.state.ledger;
        (ledger.started_s, ledger.charged_s) = (100.0, 30.0);
        assert_eq!(ledger.available_s(&fixture.mission, 400.0), 1670.0);
        assert_eq!(ledger.available_s(&fixture.mission, 2_100.0), -30.0);
        fixture.mission.battery = Some(Battery {
            usable_j: 1_000.0,
            hotel_w: 1.0,
            propulsion_j_per_m: 0.0,
        });
        ledger.used_j = 400.0;
        assert_eq!(ledger.available_s(&fixture.mission, 400.0), 600.0);
        assert_eq!(ledger.available_s(&fixture.mission, 1_600.0), 470.0);
    }

    #[test]
    fn computing_time_is_charged_up_to_a_limit() {
        let mut fixture = Fixture::new();
        let ledger = &mut fixture.state.ledger;
        ledger.charge(3.0);
        ledger.charge(4.5);
        assert_eq!(ledger.charged_s, 7.5);
        ledger.charge(f64::INFINITY);
        assert_eq!(ledger.charged_s, Ledger::MOST_CHARGED_S);
    }

    #[test]
    fn the_vehicle_is_at_the_last_waypoint_reached() {
        let mut fixture = Fixture::new();
        let (ledger, mission) = (&mut fixture.state.ledger, &fixture.mission);
        assert_eq!(ledger.at(mission), mission.start);
        ledger.visited.extend([NodeId(1), NodeId(2)]);
        assert_eq!(ledger.at(mission), NodeId(2));
        ledger.visited.clear();
        assert_eq!(ledger.at(mission), mission.start);
    }

    #[test]
    fn energy_is_booked_for_time_and_for_the_distance_through_the_water() {
        let mut fixture = Fixture::new();
        let (from, to) = (
            TimedPoint::new(place(0.0), 10.0),
            TimedPoint::new(place(30.0), 20.0),
        );
        fixture.mission.battery = Some(Battery {
            usable_j: 1e6,
            hotel_w: 5.0,
            propulsion_j_per_m: 2.0,
        });
        fixture.state.ledger.book_energy(&fixture.mission, from, to);
        assert_eq!(fixture.state.ledger.used_j, 50.0 + 60.0);
        // The current carries the vehicle 10 m of the 30 m.
        fixture.mission.current = Some(Arc::new(UniformCurrent::new(Vector3::x())));
        fixture.state.ledger.book_energy(&fixture.mission, from, to);
        assert_eq!(fixture.state.ledger.used_j, 110.0 + 50.0 + 40.0);
    }

    #[test]
    fn a_task_is_booked_with_all_edges_that_share_it_and_a_transit_is_none() {
        let mut fixture = Fixture::new();
        fixture.mission.shared_tasks = vec![vec![EdgeId(0), EdgeId(1)]];
        let ledger = &mut fixture.state.ledger;
        ledger.book_task(&fixture.mission, EdgeId(0));
        assert_eq!((ledger.tasks, ledger.weight), (1, 3.0));
        let removed: Vec<EdgeId> = ledger.removed.iter().collect();
        assert_eq!(removed, [EdgeId(0), EdgeId(1)]);
        ledger.book_task(&fixture.mission, EdgeId(2));
        assert_eq!((ledger.tasks, ledger.weight), (1, 3.0));
    }

    #[test]
    fn a_task_with_windows_is_booked_with_its_weight_and_known_as_done() {
        let mut fixture = Fixture::with_timed_tasks();
        let mut model = (**fixture.mission.time_model.as_ref().unwrap()).clone();
        model.tasks[2].task = Task::TRANSIT;
        fixture.mission.time_model = Some(Arc::new(model));
        let ledger = &mut fixture.state.ledger;
        let done = |task| TaskDone {
            task,
            start_s: 10.0,
        };
        let mut booked = Vec::new();
        // Priority 4 by risk 2 each; what weighs nothing is no task.
        for (task, tasks, weight) in [(1, 1, 2.0), (0, 2, 4.0), (2, 2, 4.0)] {
            assert!(!ledger.has_done(task));
            ledger.book_timed(&fixture.mission, done(task));
            booked.push(done(task));
            assert!(ledger.has_done(task));
            assert_eq!((ledger.tasks, ledger.weight), (tasks, weight));
        }
        assert_eq!(ledger.done, booked);
    }

    #[test]
    fn invalid_routes_are_counted_back_to_the_last_valid_one() {
        let mut fixture = Fixture::new();
        for (valid, count) in [(false, 1), (false, 2), (true, 0), (false, 1)] {
            let mut row = fixture.view(|view| {
                let question = route_question::ask(
                    view,
                    RouteReason::Start,
                    crate::question::RouteFrom::Waypoint,
                );
                let asked = question.request(view.mission, view.tide, view.seed);
                route_question::row(view, &asked, RouteReason::Start, 0.0)
            });
            row.valid = valid;
            fixture.state.ledger.route_calls.push(row);
            assert_eq!(fixture.state.ledger.invalid_routes(), count);
        }
    }

    #[test]
    fn waiting_adds_up_over_legs_given_up_until_one_made_progress() {
        let shut_in_s = |rows: &[(bool, f64, f64)], waited_s, leg_s| {
            let mut fixture = Fixture::new();
            let rows = rows
                .iter()
                .map(|&(done, waited, leg)| path_row(done, waited, leg));
            fixture.state.ledger.path_calls = rows.collect();
            fixture.state.ledger.shut_in_s(waited_s, leg_s)
        };
        assert_eq!(shut_in_s(&[], 90.0, 100.0), 90.0);
        assert_eq!(shut_in_s(&[(false, 50.0, 50.0)], 90.0, 100.0), 140.0);
        // The leg being flown made progress: what was waited before does not count.
        assert_eq!(shut_in_s(&[(false, 50.0, 50.0)], 89.0, 100.0), 89.0);
        // A completed leg is progress, a leg given up that was mostly flown ends the sum.
        assert_eq!(shut_in_s(&[(true, 50.0, 50.0)], 90.0, 100.0), 90.0);
        let rows = [(false, 500.0, 500.0), (false, 40.0, 50.0)];
        assert_eq!(shut_in_s(&rows, 90.0, 100.0), 130.0);
    }
}
