//! A model check of the synchroniser: a walk over every state that a small world can bring it to.
//!
//! The world has three waypoints. At every state the walk tries each event that can come next: ticks
//! at and off the trajectory, among obstacles that cover the target, block the way or surround the
//! vehicle; answers of planners that are good, failed, false or late; a silent sonar, a near bed, a
//! low battery. States that differ by less than the time step and not in mode, leg, question or any
//! fact count as one. `AUV_MODEL_STATES` sets the number of states after which the walk stops.

#![cfg(test)]

use crate::beliefs::Altimeter;
use crate::decide::Situation;
use crate::facts::Facts;
use crate::mode::{LegMode, Mode};
use crate::trigger::{Payload, Trigger};
use crate::{
    Battery, Command, Event, Mission, Observation, ReplanPolicy, SyncSettings, Synchroniser,
    WithoutSonar,
};
use auv_graph::{Edge, Network, NodeId, Route, Task, Waypoint};
use auv_obstacles::{Region, TimedPoint};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, Run, Stats, Trajectory, Vehicle,
};
use auv_types::{Bounds, Point3, Seed, Vector3};
use auv_verify::{EndState, WayOn};
use std::collections::{BTreeMap, BTreeSet, VecDeque};
use std::sync::Arc;

/// States after which the walk stops in the test suite.
const STATES: usize = 2_500;
/// The sea bed of the fourth world as charted and as it is found, metres.
const CHARTED_M: f64 = 60.0;
const SHALLOW_M: f64 = 35.0;
/// Time between two ticks, seconds.
const STEP_S: f64 = 40.0;

/// What can come next.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Next {
    /// A tick at the end of the trajectory in force or after a step.
    Tick(Sea, Place),
    Answer(Answer),
    SonarSilent,
    FarBed,
    /// Over the sea bed of the fourth world: shallower than charted.
    ShallowBed,
    NearBed,
    LowBattery,
    LostPosition,
    StoppedClock,
}

/// The obstacles predicted at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Sea {
    Empty,
    OverTarget,
    Ahead,
    AllRound,
}

/// Where the vehicle is at a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Place {
    OnTrack,
    Off,
}

/// How the planner asked answers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Answer {
    Good,
    /// A good path that makes a detour; a good route.
    Detour,
    Failed,
    /// A good answer to a question that is not open.
    Stale,
    /// A plan that is called feasible and is not.
    False,
    Unreachable,
}

const NEXT: [Next; 19] = [
    Next::Tick(Sea::Empty, Place::OnTrack),
    Next::Tick(Sea::OverTarget, Place::OnTrack),
    Next::Tick(Sea::Ahead, Place::OnTrack),
    Next::Tick(Sea::AllRound, Place::OnTrack),
    Next::Tick(Sea::Empty, Place::Off),
    Next::Tick(Sea::Ahead, Place::Off),
    Next::Answer(Answer::Good),
    Next::Answer(Answer::Detour),
    Next::Answer(Answer::Failed),
    Next::Answer(Answer::Stale),
    Next::Answer(Answer::False),
    Next::Answer(Answer::Unreachable),
    Next::SonarSilent,
    Next::FarBed,
    Next::ShallowBed,
    Next::NearBed,
    Next::LowBattery,
    Next::LostPosition,
    Next::StoppedClock,
];

fn place(x: f64, y: f64) -> Point3<f64> {
    Point3::new(x, y, 30.0)
}

fn mission(vehicle: Vehicle) -> Mission {
    let far = 60.0 * vehicle.speed_mps;
    let waypoints = [place(0.0, 0.0), place(far, 0.0), place(2.0 * far, 0.0)];
    let task = Task {
        priority: 6.0,
        risk: 2.0,
        completion_time_s: 30.0,
    };
    let edges = [
        Edge::undirected(0, 1, task),
        Edge::undirected(1, 2, task),
        Edge::undirected(0, 2, Task::TRANSIT),
    ];
    let waypoints = waypoints.map(Waypoint::at);
    let network = Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap();
    let mut mission = Mission::new(Arc::new(network), NodeId(0), NodeId(2), 400.0, vehicle);
    mission.clearance_m = 5.0;
    mission.min_altitude_m = 4.0;
    mission.bounds = Some(Bounds::new(
        Point3::new(-600.0, -600.0, 0.0),
        Point3::new(2.0 * far + 600.0, 600.0, 100.0),
    ));
    mission.battery = Some(Battery {
        usable_j: 1e6,
        hotel_w: 10.0,
        propulsion_j_per_m: 10.0,
    });
    mission
}

fn settings(policy: ReplanPolicy, planning_s: f64) -> SyncSettings {
    let mut settings = SyncSettings::default();
    settings.replan.policy = policy;
    settings.replan.improve_s = 40.0;
    settings.planning.planning_s = planning_s;
    settings.waiting.max_path_calls = 6;
    settings.waiting.max_wait_s = 60.0;
    settings.waiting.max_shut_in_s = 160.0;
    settings.watchdogs.timeout_factor = 1.5;
    settings.watchdogs.clock_stalls = 1;
    settings.watchdogs.altitude_silence_s = 60.0;
    settings.margins.lookahead_s = 120.0;
    settings
}

/// The event that comes next, where it can.
fn event(synchroniser: &Synchroniser, next: Next) -> Option<Event> {
    let view = synchroniser.view();
    let now_s = view.now_s();
    match next {
        Next::Tick(sea, at) => Some(Event::Tick(tick(synchroniser, sea, at))),
        Next::Answer(answer) => answered(&synchroniser.outstanding()?, answer),
        Next::SonarSilent => Some(Event::SonarSilent { age_s: 300.0 }),
        Next::FarBed => Some(Event::AltitudeMeasured { altitude_m: 40.0 }),
        Next::ShallowBed => {
            let altitude_m = SHALLOW_M - view.beliefs().position.z;
            let told = Event::AltitudeMeasured { altitude_m };
            view.mission.sea_bed.is_some().then_some(told)
        }
        Next::NearBed => Some(Event::AltitudeMeasured { altitude_m: 1.0 }),
        Next::LowBattery => Some(Event::BatteryMeasured { left_j: 900.0 }),
        Next::LostPosition => {
            let mut seen = tick(synchroniser, Sea::Empty, Place::OnTrack);
            seen.time_s = now_s + 2.0 * STEP_S;
            seen.position.x = f64::NAN;
            Some(Event::Tick(seen))
        }
        Next::StoppedClock => {
            let mut seen = tick(synchroniser, Sea::Empty, Place::OnTrack);
            seen.time_s = now_s;
            Some(Event::Tick(seen))
        }
    }
}

fn tick(synchroniser: &Synchroniser, sea: Sea, at: Place) -> Observation {
    let view = synchroniser.view();
    let due_s = view.due_s();
    let step_s = view.now_s() + STEP_S;
    let time_s = if due_s > view.now_s() && due_s < step_s {
        due_s
    } else {
        step_s
    };
    let start = (view.beliefs().position, Vector3::zeros());
    let in_force = view.in_force();
    let (mut position, velocity) = in_force.map_or(start, |way| way.at(time_s));
    if at == Place::Off {
        position.y += 20.0;
    }
    let target = view.leg().map_or(NodeId(1), |leg| leg.to);
    let ball = |centre: Point3<f64>, radius_m: f64| Region {
        from_s: time_s,
        ..Region::ball(centre, radius_m)
    };
    let regions = match sea {
        Sea::Empty => vec![],
        Sea::OverTarget => vec![ball(view.mission.position_of(target), 30.0)],
        Sea::Ahead => vec![ball(position + Vector3::x() * 60.0, 30.0)],
        Sea::AllRound => vec![ball(position, 50.0)],
    };
    Observation {
        position_sigma_m: 0.0,
        time_s,
        position,
        velocity,
        regions: regions.into(),
    }
}

/// The number an answer carries: that of the question before for a stale one.
fn id_of(id: u64, answer: Answer) -> u64 {
    if answer == Answer::Stale {
        id.wrapping_sub(1)
    } else {
        id
    }
}

fn failed(planner: &str) -> PlanError {
    PlanError::Failed {
        planner: planner.into(),
        reason: "as asked by the walk".into(),
    }
}

fn answered(question: &Command, answer: Answer) -> Option<Event> {
    match question {
        Command::PlanRoute(request) => {
            let mut run = Run::new(request.seed, request.budget);
            let result = match answer {
                Answer::Good | Answer::Detour | Answer::Stale => {
                    GreedyRoute.plan_route(&mut run, &request.problem())
                }
                Answer::Failed => Err(failed("route")),
                Answer::False => {
                    let nowhere = Route::new(vec![request.start]);
                    Ok(Planned::new(nowhere, -9.0, 0.0, Stats::default()))
                }
                Answer::Unreachable => Err(PlanError::Unreachable {
                    start: request.start.0,
                    destination: request.destination.0,
                }),
            };
            Some(Event::RoutePlanned {
                request: id_of(request.id, answer),
                result,
                compute_s: 0.0,
            })
        }
        Command::PlanPath(request) => {
            let mut run = Run::new(request.seed, request.budget);
            let result = match answer {
                Answer::Good | Answer::Stale => {
                    StraightPath.plan_path(&mut run, &request.problem())
                }
                Answer::Detour => detour(&request.problem()),
                Answer::Failed => Err(failed("path")),
                Answer::False => Ok(false_path(&request.problem())),
                Answer::Unreachable => return None,
            };
            Some(Event::PathPlanned {
                request: id_of(request.id, answer),
                result,
                compute_s: 0.0,
            })
        }
        Command::Follow(_) | Command::Finished(_) => None,
    }
}

/// To the target by a place far to the side.
fn detour(problem: &PathProblem<'_>) -> Result<Planned<Trajectory>, PlanError> {
    let aside =
        Point3::from(problem.start.coords.lerp(&problem.target.coords, 0.5)) + Vector3::y() * 120.0;
    let path = problem
        .timed(&[problem.start, aside, problem.target])
        .map_err(|_| failed("path"))?;
    let takes_s = path.duration_s();
    Ok(Planned::new(path, takes_s, 0.0, Stats::default()))
}

/// The target at ten times the vehicle's greatest speed.
fn false_path(problem: &PathProblem<'_>) -> Planned<Trajectory> {
    let distance_m = (problem.target - problem.start).norm();
    let takes_s = 0.1 * distance_m / problem.vehicle.max_speed_mps + 0.1;
    let points = vec![
        TimedPoint::new(problem.start, problem.departure_s),
        TimedPoint::new(problem.target, problem.departure_s + takes_s),
    ];
    Planned::new(
        Trajectory::new(points).unwrap(),
        takes_s,
        0.0,
        Stats::default(),
    )
}

/// What makes two states different for the walk. Of an aborted mission only the manoeuvre counts.
fn key(synchroniser: &Synchroniser) -> String {
    let view = synchroniser.view();
    let ledger = &view.state.ledger;
    let facts = Facts::at(view, Trigger::Tick, &Payload::None);
    let situation = Situation::of(&view.state.mode);
    match &view.state.mode {
        Mode::Contingency(state) => format!(
            "{situation:?} {:?} {:?} {facts:?}",
            state.reason, state.flown
        ),
        Mode::Finished { outcome, .. } => format!("{situation:?} {outcome:?}"),
        mode => {
            let leg = view.leg().map(|leg| {
                let mode = std::mem::discriminant(&leg.mode);
                (leg.from, leg.to, mode, leg.failures.min(2))
            });
            let time = (view.now_s() / STEP_S).round();
            let invalid = matches!(mode, Mode::AwaitRoute(_)) as usize * ledger.invalid_routes();
            let route = &view.state.route;
            let deaf = view.beliefs().altimeter == Altimeter::Silent;
            let bed = view.mission.sea_bed.is_some();
            let told = bed.then(|| (view.beliefs().altimeter, &view.state.soundings));
            format!(
                "{situation:?} {leg:?} {facts:?} {time} {route:?} {:?} {invalid} {deaf} {told:?}",
                ledger.removed
            )
        }
    }
}

/// What the walk found.
#[derive(Debug, Default)]
struct Found {
    states: usize,
    steps: usize,
    /// States found whose next events were not tried, because the walk was stopped.
    unexplored: usize,
    situations: BTreeSet<Situation>,
    legs: BTreeSet<&'static str>,
    outcomes: BTreeMap<String, usize>,
    /// States from which no end was reached.
    endless: usize,
}

fn leg_mode(mode: LegMode) -> &'static str {
    match mode {
        LegMode::AwaitFirstPath => "AwaitFirstPath",
        LegMode::Holding => "Holding",
        LegMode::Underway { .. } => "Underway",
        LegMode::AtTarget { .. } => "AtTarget",
        LegMode::ToStandOff { .. } => "ToStandOff",
        LegMode::AtStandOff { .. } => "AtStandOff",
        LegMode::Evading => "Evading",
        LegMode::Climbing => "Climbing",
        LegMode::Surfacing => "Surfacing",
    }
}

/// Whether the vehicle can fly a trajectory, by the verifier. A vehicle beside its trajectory, by no
/// more than `off_track_m`, catches up until the departure.
fn assert_flyable(synchroniser: &Synchroniser, trajectory: &Trajectory, next: Next) {
    let view = synchroniser.view();
    let request = crate::path_question::own_problem(view);
    let planning_s = view.settings.planning.planning_s;
    let mut vehicle = view.mission.vehicle;
    if planning_s > 0.0 {
        vehicle.max_speed_mps += view.settings.margins.off_track_m / planning_s;
    }
    let motion = PathProblem {
        regions: &[],
        vehicle: &vehicle,
        ..request.problem()
    };
    let report = auv_verify::verify_motion(&motion, trajectory);
    let mode = &synchroniser.view().state.mode;
    assert!(report.is_valid(), "{next:?} {mode:?}: {report:?}");
}

/// Whether the trajectory of an accepted path leaves a safe end in hand, by the verifier.
fn assert_safe_end(synchroniser: &Synchroniser, next: Next) {
    let view = synchroniser.view();
    let in_force = view.state.in_force.as_ref().unwrap();
    let request = crate::path_question::own_problem(view);
    let destination = view.raised(view.mission.destination);
    let problem = PathProblem {
        target: destination,
        ..request.problem()
    };
    let docks = (in_force.whole.end().position - destination).norm() < 1e-3
        && in_force.whole.end().time_s <= in_force.ends_s;
    let asked = WayOn {
        ends_s: in_force.ends_s,
        lasts_s: view.way_on_s(),
        end: if docks {
            EndState::Docked
        } else {
            EndState::UnderWay
        },
    };
    // The way to the path's start is no part of what was accepted: see `assert_flyable`.
    let arrives_s = view.leg().and_then(|leg| leg.mode.arrives_s()).unwrap();
    let rest = in_force.whole.after(arrives_s);
    let report = auv_verify::verify_way_on(&problem, &rest, &asked);
    assert!(report.is_valid(), "{next:?}: {report:?}");
}

/// One step from a state, with what must hold at every step.
fn step(from: &Synchroniser, next: Next) -> Option<Synchroniser> {
    let event = event(from, next)?;
    let mut to = from.clone();
    let commands = to.step(event.clone());
    for command in &commands {
        if let Command::Follow(trajectory) = command {
            assert_flyable(&to, trajectory, next);
        }
    }
    if matches!(next, Next::Answer(_)) {
        let follows = commands.iter().any(|c| matches!(c, Command::Follow(_)));
        let leads_on = to
            .view()
            .leg()
            .is_some_and(|leg| leg.mode.arrives_s().is_some());
        assert!(
            !(follows && leads_on) || to.view().in_force_is_clear(),
            "{next:?}"
        );
        if follows && leads_on {
            assert_safe_end(&to, next);
        }
        // Told twice, an answer changes nothing.
        let mut again = to.clone();
        assert!(again.step(event).is_empty(), "{next:?}");
        assert_eq!(again.view().state, to.view().state, "{next:?}");
    }
    if next == Next::Answer(Answer::Stale) {
        assert!(commands.is_empty());
        assert_eq!(from.view().state, to.view().state);
    }
    #[cfg(feature = "serde")]
    {
        let text = to.save().to_text().unwrap();
        let checkpoint = crate::Checkpoint::from_text(&text).unwrap();
        let resumed = Synchroniser::resume(Arc::clone(to.mission()), checkpoint);
        let resumed = resumed.unwrap_or_else(|e| panic!("{next:?}: {e}\n{text}"));
        assert_eq!(resumed.view().state, to.view().state, "{next:?}");
        if to.view().leg().is_some() {
            assert_eq!(resumed.view().home_s, to.view().home_s, "{next:?}");
        }
    }
    Some(to)
}

fn walk(start: Synchroniser, most: usize) -> Found {
    let mut found = Found::default();
    let mut ids = BTreeMap::from([(key(&start), 0_usize)]);
    let mut before: Vec<Vec<usize>> = vec![vec![]];
    let mut ended = Vec::new();
    let mut open = VecDeque::from([(0, start)]);
    // From both ends: near the start and far from it.
    while let Some((id, state)) = if found.states.is_multiple_of(2) {
        open.pop_front()
    } else {
        open.pop_back()
    } {
        found.states += 1;
        found
            .situations
            .insert(Situation::of(&state.view().state.mode));
        if let Mode::Leg(leg) = &state.view().state.mode {
            found.legs.insert(leg_mode(leg.mode));
        }
        if let Some(outcome) = state.outcome() {
            *found.outcomes.entry(format!("{outcome:?}")).or_default() += 1;
            ended.push(id);
            continue;
        }
        if found.states > most {
            found.unexplored += 1;
            ended.extend(ends_well(&state).then_some(id));
            continue;
        }
        for next in NEXT {
            let Some(to) = step(&state, next) else {
                continue;
            };
            found.steps += 1;
            let fresh = ids.len();
            let to_id = *ids.entry(key(&to)).or_insert(fresh);
            if to_id == fresh {
                before.push(vec![]);
                open.push_back((to_id, to));
            }
            before[to_id].push(id);
        }
    }
    found.endless = before.len() - reached(&before, ended);
    found
}

/// How many states lead to one of these.
fn reached(before: &[Vec<usize>], mut todo: Vec<usize>) -> usize {
    let mut seen = vec![false; before.len()];
    while let Some(id) = todo.pop() {
        if !std::mem::replace(&mut seen[id], true) {
            todo.extend(&before[id]);
        }
    }
    seen.into_iter().filter(|&seen| seen).count()
}

/// Whether a mission ends when planners answer, and when they never do.
fn ends_well(state: &Synchroniser) -> bool {
    [true, false].into_iter().all(|answers| {
        let mut state = state.clone();
        for _ in 0..400 {
            if state.outcome().is_some() {
                return true;
            }
            let answer = Next::Answer(Answer::Good);
            let next = if answers && state.outstanding().is_some() {
                answer
            } else {
                Next::Tick(Sea::Empty, Place::OnTrack)
            };
            if let Some(event) = event(&state, next) {
                state.step(event);
            }
        }
        false
    })
}

#[test]
#[allow(clippy::print_stdout, reason = "a walk by hand tells its size")]
fn every_mode_is_reached_every_run_ends_and_nothing_unverified_is_followed() {
    let most = std::env::var("AUV_MODEL_STATES")
        .ok()
        .and_then(|text| text.parse().ok())
        .unwrap_or(STATES);
    let worlds = [
        (ReplanPolicy::EveryWaypoint, 0.0, WithoutSonar::GiveUp),
        (ReplanPolicy::Projected, 10.0, WithoutSonar::GiveUp),
        (ReplanPolicy::Late, 0.0, WithoutSonar::GoHome),
        (ReplanPolicy::Late, 0.0, WithoutSonar::GiveUp),
    ];
    let mut situations = BTreeSet::new();
    let mut legs = BTreeSet::new();
    let mut outcomes = BTreeMap::new();
    for (k, (policy, planning_s, without_sonar)) in worlds.into_iter().enumerate() {
        let mut settings = settings(policy, planning_s);
        settings.watchdogs.without_sonar = without_sonar;
        let mut mission = mission(Vehicle::paper());
        // In the third world legs follow the edges of the network only.
        mission.open_water = without_sonar == WithoutSonar::GiveUp;
        // In the fourth there is a sea bed.
        if k == 3 {
            mission.sea_bed = Some(Arc::new(auv_ocean::FlatBed::new(CHARTED_M)));
        }
        let start = Synchroniser::new(Arc::new(mission), settings, Seed(1)).unwrap();
        let found = walk(start, most);
        println!("{found:#?}");
        assert_eq!(found.endless, 0);
        situations.extend(found.situations);
        legs.extend(found.legs);
        for (outcome, count) in found.outcomes {
            *outcomes.entry(outcome).or_insert(0) += count;
        }
    }
    println!("{situations:?} {legs:?} {outcomes:#?}");
    assert_eq!(legs.len(), 7, "{legs:?}");
    // `AwaitFirstPath` with nothing asked lasts for an instant only: a decision leaves it at once.
    assert_eq!(situations.len(), 13, "{situations:?}");
    assert!(outcomes.len() >= 8, "{outcomes:?}");
}
