//! Each fact against a hand-made state, at its limit.

use super::*;
use crate::fixture::{Fixture, path_row, place, way};
use crate::mode::{ContingencyState, LegMode};
use crate::path_question::Accepted;
use crate::question::RouteFrom;
use crate::route_question::{self, JudgedRoute};
use crate::state::RouteInForce;
use crate::{AbortReason, Battery, Contingency, RouteReason};
use auv_graph::NodeId;
use auv_obstacles::Region;
use auv_types::Bounds;

fn told(fixture: &Fixture, trigger: Trigger, payload: &Payload, fact: Fact) -> bool {
    fixture.view(|view| Facts::at(view, trigger, payload).holds(fact))
}

/// Whether a fact holds at a tick after a change of the fixture.
fn holds(fact: Fact, change: impl FnOnce(&mut Fixture)) -> bool {
    let mut fixture = Fixture::new();
    change(&mut fixture);
    told(&fixture, Trigger::Tick, &Payload::None, fact)
}

fn clock(time_s: f64) -> impl FnOnce(&mut Fixture) {
    move |fixture| fixture.state.beliefs.now_s = time_s
}

#[test]
fn facts_of_the_mission() {
    use crate::beliefs::Altimeter;
    assert!(!holds(Fact::TimedOut, clock(4_000.0)));
    assert!(holds(Fact::TimedOut, clock(4_000.1)));
    assert!(!holds(Fact::TimedOut, |fixture| {
        (fixture.state.ledger.started_s, fixture.state.beliefs.now_s) = (1.0, 4_000.1);
    }));
    let silent = |last: Altimeter, now_s| {
        holds(Fact::AltitudeLost, |fixture| {
            (fixture.state.beliefs.altimeter, fixture.state.beliefs.now_s) = (last, now_s);
        })
    };
    assert!(!silent(Altimeter::At(10.0), 40.0) && silent(Altimeter::At(10.0), 40.1));
    assert!(!silent(Altimeter::Silent, 1e6));
    assert!(holds(Fact::InTime, clock(2_000.0)));
    assert!(!holds(Fact::InTime, clock(2_000.1)));
    assert!(!holds(Fact::Homeward, |_| {}));
    assert!(holds(Fact::Homeward, |fixture| {
        fixture.state.route = RouteInForce::QuickestHome(vec![NodeId(0), NodeId(2)]);
    }));
    assert!(!holds(Fact::HomeWithoutSonar, |_| {}));
    assert!(holds(Fact::HomeWithoutSonar, |fixture| {
        fixture.settings.watchdogs.without_sonar = WithoutSonar::GoHome;
    }));
    assert!(!holds(Fact::StartIsDestination, |_| {}));
    assert!(holds(Fact::StartIsDestination, |fixture| {
        fixture.mission.destination = NodeId(0);
    }));
}

#[test]
fn facts_of_the_trajectory_in_force() {
    for (time_s, x, over, on_track) in [
        (0.0, 0.0, false, true),
        (100.0, 305.0, false, true),
        (100.0, 305.1, false, false),
        (359.9, 900.0, false, true),
        (360.0 - 1e-10, 900.0, true, true),
        (360.0, 900.0, true, true),
    ] {
        let fixture = Fixture::new().at(time_s, x);
        let fact = |fact| told(&fixture, Trigger::Tick, &Payload::None, fact);
        let found = (fact(Fact::Over), fact(Fact::OnTrack), fact(Fact::InForce));
        assert_eq!(found, (over, on_track, true), "{time_s} s, {x} m");
    }
    let none = |fact| holds(fact, |fixture| fixture.state.in_force = None);
    assert!(!none(Fact::InForce) && none(Fact::Over) && !none(Fact::OnTrack));
    assert!(!none(Fact::Clear));
}

#[test]
fn a_trajectory_is_clear_by_the_clearance_and_what_the_vehicle_lags() {
    // The ball passes the line at 5 m, or a little less; the vehicle is 0, 4 or 6 m off it.
    for (gap_m, off_m, clear) in [
        (5.001, 0.0, true),
        (4.999, 0.0, false),
        (5.001, 4.0, true),
        (5.001, 6.0, false),
        (11.001, 6.0, true),
    ] {
        let mut centre = place(450.0);
        centre.y = 30.0 + gap_m;
        let mut fixture = Fixture::new().among(&[Region::ball(centre, 30.0)]);
        fixture.state.beliefs.position.y = -off_m;
        let found = told(&fixture, Trigger::Tick, &Payload::None, Fact::Clear);
        assert_eq!(found, clear, "{gap_m} m, {off_m} m");
    }
    // Beyond the look-ahead time nothing counts.
    let beyond = |lookahead_s| {
        let mut fixture = Fixture::new().among(&[Region::ball(place(600.0), 30.0)]);
        fixture.settings.margins.lookahead_s = lookahead_s;
        told(&fixture, Trigger::Tick, &Payload::None, Fact::Clear)
    };
    assert!(beyond(185.0) && !beyond(190.0));
}

#[test]
fn facts_of_a_leg_and_its_target() {
    let done = |mode, time_s, x| {
        let mut fixture = Fixture::new().at(time_s, x);
        fixture.leg_mut().mode = mode;
        told(&fixture, Trigger::Tick, &Payload::None, Fact::Arrived)
    };
    let there = LegMode::AtTarget { booked_s: 359.0 };
    assert!(done(there, 360.0, 900.0) && !done(there, 359.0, 900.0));
    assert!(!done(there, 360.0, 890.0) && !done(LegMode::Evading, 360.0, 900.0));
    assert!(holds(Fact::LeadsOn, |_| {}));
    let evading = |fixture: &mut Fixture| fixture.leg_mut().mode = LegMode::Evading;
    assert!(!holds(Fact::LeadsOn, evading));
    assert!(!holds(Fact::ToDestination, |_| {}));
    assert!(holds(Fact::ToDestination, |fixture| {
        fixture.leg_mut().to = NodeId(2);
    }));
    assert!(!holds(Fact::Late, clock(360.0)) && holds(Fact::Late, clock(368.0)));
    let wanted = |policy, time_s| {
        holds(Fact::RouteWanted, |fixture| {
            fixture.settings.replan.policy = policy;
            fixture.state.beliefs.now_s = time_s;
        })
    };
    assert!(wanted(ReplanPolicy::EveryWaypoint, 300.0));
    assert!(!wanted(ReplanPolicy::Late, 300.0) && wanted(ReplanPolicy::Late, 368.0));
    assert!(!holds(Fact::RouteWanted, |fixture| {
        fixture.state.route = RouteInForce::QuickestHome(vec![]);
    }));
    // The vehicle can be at the target at 300 s; the ball leaves it before, or after.
    for (until_s, covered) in [(299.0, false), (301.0, true)] {
        let mut ball = Region::ball(place(900.0), 50.0);
        ball.until_s = until_s;
        let fixture = Fixture::new().among(&[ball]);
        let found = told(&fixture, Trigger::Tick, &Payload::None, Fact::Covered);
        assert_eq!(found, covered, "{until_s} s");
    }
    assert!(!holds(Fact::ShortOfTime, |_| {}));
    assert!(holds(Fact::ShortOfTime, |f| f.mission.budget_s = 650.0));
}

#[test]
fn waiting_and_calls_are_counted_to_their_limits() {
    let waited = |waited_s| move |fixture: &mut Fixture| fixture.leg_mut().waited_s = waited_s;
    assert!(!holds(Fact::WaitedTooLong, waited(600.0)));
    assert!(holds(Fact::WaitedTooLong, waited(600.1)));
    assert!(!holds(Fact::ShutIn, waited(1_800.0)) && holds(Fact::ShutIn, waited(1_800.1)));
    assert!(holds(Fact::ShutIn, |fixture| {
        fixture.leg_mut().waited_s = 100.0;
        fixture.state.ledger.path_calls = vec![path_row(false, 1_701.0, 1_701.0)];
    }));
    for (fact, due_s) in [(Fact::ReactDue, 3.0), (Fact::RetryDue, 20.0)] {
        assert!(holds(fact, clock(due_s)) && !holds(fact, clock(due_s - 0.1)));
        let asked = |fixture: &mut Fixture| {
            (fixture.leg_mut().asked_s, fixture.state.beliefs.now_s) = (5.0, due_s);
        };
        assert!(!holds(fact, asked));
    }
    let calls = |calls| move |fixture: &mut Fixture| fixture.leg_mut().calls = calls;
    assert!(!holds(Fact::CallsSpent, calls(199)) && holds(Fact::CallsSpent, calls(200)));
    for (failures, first) in [(0, true), (1, false), (2, false)] {
        let failed = |fixture: &mut Fixture| fixture.leg_mut().failures = failures;
        assert_eq!(holds(Fact::FirstFailure, failed), first, "{failures}");
    }
    let improve = |time_s, calls, arrives_s| {
        holds(Fact::ImproveDue, |fixture| {
            fixture.state.beliefs.now_s = time_s;
            fixture.leg_mut().calls = calls;
            fixture.leg_mut().mode = LegMode::Underway { arrives_s };
        })
    };
    assert!(improve(60.0, 199, 400.0) && !improve(59.9, 199, 400.0));
    assert!(!improve(60.0, 200, 400.0) && !improve(60.0, 199, 376.0));
}

#[test]
fn energy_is_low_when_it_lasts_for_surfacing_twice() {
    // 20 m up at 3 m/s: 200 J of hotel load and 200 J of propulsion, wherever the box begins.
    let low = |usable_j, top_m: Option<f64>| {
        holds(Fact::EnergyLow, |fixture| {
            fixture.state.ledger.used_j = 5_000.0;
            fixture.mission.battery = Some(Battery {
                usable_j: 5_000.0 + usable_j,
                hotel_w: 30.0,
                propulsion_j_per_m: 10.0,
            });
            fixture.mission.bounds =
                top_m.map(|z| Bounds::new([-1e4, -1e4, z].into(), [1e4, 1e4, 99.0].into()));
        })
    };
    assert!(low(799.9, None) && !low(800.1, None));
    assert!(low(799.9, Some(10.0)) && !low(800.1, Some(10.0)));
    assert!(!holds(Fact::EnergyLow, |_| {}));
    // At a pitch of 30 degrees the way up is twice as long.
    let slowly = |usable_j| {
        holds(Fact::EnergyLow, |fixture| {
            fixture.mission.vehicle.max_pitch_rad = std::f64::consts::FRAC_PI_6;
            fixture.mission.battery = Some(Battery {
                usable_j,
                hotel_w: 30.0,
                propulsion_j_per_m: 10.0,
            });
        })
    };
    assert!(slowly(1_599.9) && !slowly(1_600.1));
}

#[test]
fn a_leg_is_too_early_until_a_moment_before_it_departs() {
    let early = |now_s| {
        holds(Fact::TooEarly, |fixture| {
            fixture.leg_mut().departs_s = 100.0;
            fixture.state.beliefs.now_s = now_s;
        })
    };
    assert!(early(99.9) && !early(100.0 - MOMENT_S) && !early(100.0));
}

#[test]
fn a_fact_told_twice_holds() {
    let told = Facts::default().with(Fact::Clear, true);
    assert!(told.with(Fact::Clear, true).holds(Fact::Clear));
    assert!(!told.holds(Fact::Over));
}

#[test]
fn facts_of_what_was_answered() {
    let fixture = Fixture::new();
    let reach = |reach| {
        let payload = Payload::Reach(reach);
        told(&fixture, Trigger::PathWanted, &payload, Fact::StandOffFree)
    };
    assert!(reach(Reach::StandOff(place(800.0))));
    assert!(!reach(Reach::Nowhere) && !reach(Reach::Target));
    // The path in force arrives at 300 s.
    for (arrives_s, earlier) in [(299.0, true), (299.1, false)] {
        let payload = Payload::Path(Some(Box::new(Accepted {
            in_force: way(&[(0.0, 0.0), (900.0, arrives_s)]).into(),
            arrives_s,
            stand_off: None,
        })));
        let fact = |fact| told(&fixture, Trigger::PathAnswered, &payload, fact);
        assert_eq!((fact(Fact::Accepted), fact(Fact::Earlier)), (true, earlier));
    }
    let none = Payload::Path(None);
    for fact in [Fact::Accepted, Fact::Earlier] {
        assert!(!told(&fixture, Trigger::PathAnswered, &none, fact));
    }
}

#[test]
fn facts_of_a_route_that_was_answered() {
    let mut fixture = Fixture::new();
    for (invalid, tries_left) in [(0, true), (2, true), (3, false)] {
        let judged = |chosen: Option<Vec<NodeId>>, failed| {
            fixture.view(|view| {
                let question = route_question::ask(view, RouteReason::Start, RouteFrom::Waypoint);
                let asked = question.request(view.mission, view.tide, view.seed);
                let row = route_question::row(view, &asked, RouteReason::Start, 0.0);
                JudgedRoute {
                    question,
                    asked,
                    row,
                    chosen,
                    due: Vec::new(),
                    failed,
                }
            })
        };
        let found = judged(Some(vec![NodeId(0), NodeId(2)]), false);
        let row = found.row.clone();
        let (found, failed) = (
            Payload::Route(Box::new(found)),
            Payload::Route(Box::new(judged(None, true))),
        );
        fixture.state.ledger.route_calls = vec![row; invalid];
        let fact = |payload, fact| told(&fixture, Trigger::RouteAnswered, payload, fact);
        assert!(fact(&found, Fact::RouteThere) && !fact(&found, Fact::PlannerFailed));
        assert!(!fact(&failed, Fact::RouteThere) && fact(&failed, Fact::PlannerFailed));
        assert_eq!(fact(&failed, Fact::TriesLeft), tries_left, "{invalid}");
    }
}

#[test]
fn facts_of_a_contingency() {
    for (flown, sought, may) in [(None, 49, true), (Some(Contingency::Surface), 50, false)] {
        let mut fixture = Fixture::new();
        fixture.state.mode = Mode::Contingency(ContingencyState {
            reason: AbortReason::TooLow,
            flown,
            sought,
        });
        let fact = |fact| told(&fixture, Trigger::Tick, &Payload::None, fact);
        let found = (fact(Fact::ContingencyFlown), fact(Fact::MaySeek));
        assert_eq!(found, (flown.is_some(), may));
    }
}
