//! What single decisions change in a hand-made state.

use super::*;
use crate::ExpectedTime;
use crate::fixture::{Fixture, place, way};
use crate::soundings::Soundings;
use auv_graph::NodeId;
use auv_obstacles::Region;
use auv_planning::TaskDone;

impl Fixture {
    /// A synchroniser in this state, which expects of each leg what its path takes, its work and 5 s of planning.
    fn synchroniser(mut self) -> Synchroniser {
        self.settings.replan.expected_time = ExpectedTime::Strict;
        self.settings.planning.planning_s = 5.0;
        self.into_synchroniser()
    }
}

impl Synchroniser {
    fn leg(&self) -> &Leg {
        self.view().leg().unwrap()
    }

    /// Carries out a decision; returns the commands given.
    fn carry_out(&mut self, decision: Decision, payload: Payload) -> Vec<Command> {
        let mut commands = Vec::new();
        self.apply(decision, payload, &mut commands);
        commands
    }
}

fn accepted(arrives_s: f64, stand_off: Option<Point3<f64>>) -> Payload {
    let path = way(&[(0.0, 0.0), (900.0, arrives_s), (900.0, arrives_s + 60.0)]);
    Payload::Path(Some(Box::new(Accepted {
        in_force: path.into(),
        arrives_s,
        stand_off,
    })))
}

#[test]
fn a_leg_starts_with_its_duty_and_the_time_expected_of_it() {
    let nodes = || [0, 1, 2].map(NodeId).to_vec();
    let started = |route, removed: Option<EdgeId>| {
        let mut fixture = Fixture::new().at(100.0, 0.0);
        fixture.state.route = route;
        removed.map(|edge| fixture.state.ledger.removed.insert(edge));
        let mut synchroniser = fixture.synchroniser();
        assert_eq!(synchroniser.start_leg(), Some(Trigger::PathWanted));
        let leg = synchroniser.leg();
        assert_eq!((leg.started_s, leg.departs_s), (100.0, 100.0));
        (leg.duty, leg.task_left_s, leg.expected_s)
    };
    // 300 s under way, 5 s of planning, and 60 s of work where the task is done.
    let edge = EdgeId(0);
    let planned = started(RouteInForce::Planned(nodes()), None);
    assert_eq!(planned, (Duty::Task(edge), 60.0, 365.0));
    let done = started(RouteInForce::Planned(nodes()), Some(edge));
    assert_eq!(done, (Duty::Pass(edge), 0.0, 305.0));
    let home = started(RouteInForce::QuickestHome(nodes()), None);
    assert_eq!(home, (Duty::Pass(edge), 0.0, 305.0));
}

#[test]
fn a_leg_to_work_with_windows_lasts_until_the_work_is_done() {
    let mut fixture = Fixture::with_timed_tasks();
    fixture.state.due = vec![0, 1, 2];
    let mut synchroniser = fixture.synchroniser();
    synchroniser.start_leg();
    // There at 305 s; the window opens at 500 s; twice 30 s of work.
    let leg = synchroniser.leg();
    assert_eq!((leg.task_left_s, leg.expected_s), (255.0, 560.0));
}

#[test]
fn a_path_to_work_with_windows_sets_when_it_is_done_once() {
    let follow = |mode, timed, stand_off| {
        let mut fixture = if timed {
            Fixture::with_timed_tasks()
        } else {
            Fixture::new()
        };
        fixture.state.due = if timed { vec![0, 1, 2] } else { Vec::new() };
        fixture.leg_mut().mode = mode;
        let mut synchroniser = fixture.synchroniser();
        synchroniser.carry_out(Decision::Follow, accepted(320.0, stand_off));
        let leg = synchroniser.leg();
        (leg.mode, leg.task_left_s, leg.works.clone())
    };
    let evading = LegMode::Evading;
    let underway = LegMode::Underway { arrives_s: 320.0 };
    let at_target = LegMode::AtTarget { booked_s: 300.0 };
    let works = [(0, 500.0), (1, 530.0)].map(|(task, start_s)| TaskDone { task, start_s });
    let of_windows = (underway, 240.0, works.to_vec());
    assert_eq!(follow(evading, true, None), of_windows);
    // Begun work, a place to wait and work without windows leave it as it is.
    assert_eq!(follow(at_target, true, None), (underway, 60.0, vec![]));
    assert_eq!(follow(evading, false, None), (underway, 60.0, vec![]));
    let waiting = LegMode::ToStandOff { arrives_s: 320.0 };
    let beside = Some(place(880.0));
    assert_eq!(follow(evading, true, beside), (waiting, 60.0, vec![]));
}

#[test]
fn legs_are_recorded_with_their_number_and_what_follows() {
    let mut synchroniser = Fixture::new().on_track(360.0).synchroniser();
    let next = Decision::CompleteLeg(AfterLeg::NextLeg);
    synchroniser.carry_out(next, Payload::None);
    assert_eq!(synchroniser.visited(), [0, 1].map(NodeId));
    assert_eq!(synchroniser.route(), [1, 2].map(NodeId));
    // No waypoint was too low.
    assert_eq!(synchroniser.raised(), []);
    let mut given_up = synchroniser.clone();
    given_up.carry_out(Decision::DropLeg, Payload::None);
    let asks = Decision::CompleteLeg(AfterLeg::AskRoute(RouteReason::Waypoint));
    synchroniser.carry_out(asks, Payload::None);
    let rows = |synchroniser: &Synchroniser| {
        let rows = synchroniser.path_calls().iter();
        rows.map(|row| (row.call, row.completed, row.next_leg, row.replan))
            .collect::<Vec<_>>()
    };
    let first = (1, true, true, false);
    assert_eq!(rows(&synchroniser), [first, (2, true, false, true)]);
    assert_eq!(rows(&given_up), [first, (2, false, false, true)]);
}

#[test]
fn each_question_has_its_own_number_and_leads_where_it_may() {
    let mut synchroniser = Fixture::new().synchroniser();
    let beside = place(880.0);
    for (id, reach, target) in [
        (2, Reach::Target, place(900.0)),
        (3, Reach::StandOff(beside), beside),
    ] {
        let commands = synchroniser.carry_out(Decision::AskPath, Payload::Reach(reach));
        let [Command::PlanPath(request)] = &commands[..] else {
            panic!("{commands:?}");
        };
        assert_eq!((request.id, request.target), (id, target));
    }
    let commands = synchroniser.carry_out(Decision::AskNextRoute, Payload::None);
    let [Command::PlanRoute(request)] = &commands[..] else {
        panic!("{commands:?}");
    };
    assert_eq!(request.id, 4);
    assert_eq!(synchroniser.state.next_question, 5);
}

#[test]
fn paths_are_planned_over_the_bed_within_the_error_of_the_place_at_their_end() {
    let mut fixture = Fixture::new();
    fixture.mission.navigation = Some(Navigation {
        drift_percent: 1.0,
        ..Navigation::default()
    });
    fixture.state.beliefs.sigma_m = 4.0;
    let mut synchroniser = fixture.synchroniser();
    synchroniser.look_around();
    // Two sigmas: 8 m now, and 1 % of 900 m twice on the way.
    let mut within = Soundings::default();
    within.look_within(26.0);
    assert_eq!(synchroniser.state.soundings, within);
}

#[test]
fn only_a_path_that_was_needed_and_did_not_come_is_a_failure() {
    let mut synchroniser = Fixture::new().at(100.0, 0.0).synchroniser();
    synchroniser.carry_out(Decision::AskShorterPath, Payload::None);
    synchroniser.carry_out(Decision::Continue, Payload::Path(None));
    assert_eq!(synchroniser.leg().awaited, Awaited::Nothing);
    assert_eq!(synchroniser.leg().failures, 0);
    synchroniser.carry_out(Decision::AskPath, Payload::Reach(Reach::Target));
    synchroniser.carry_out(Decision::Wait, Payload::Path(None));
    assert_eq!(synchroniser.leg().failures, 1);
    synchroniser.carry_out(Decision::Wait, Payload::Reach(Reach::Nowhere));
    assert_eq!(synchroniser.leg().failures, 2);
}

#[test]
fn without_a_free_way_to_the_surface_the_vehicle_goes_on_until_its_trajectory_ends() {
    let everywhere = Region::ball(place(450.0), 5_000.0);
    for (now_s, mode) in [
        (100.0, LegMode::Underway { arrives_s: 300.0 }),
        (360.0, LegMode::Evading),
    ] {
        let fixture = Fixture::new().on_track(now_s).among(&[everywhere]);
        let mut synchroniser = fixture.synchroniser();
        synchroniser.carry_out(Decision::Surface, Payload::None);
        let leg = synchroniser.leg();
        assert_eq!((leg.mode, leg.fixes, leg.fix_asked_s), (mode, 1, now_s));
    }
}
