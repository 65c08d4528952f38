//! Planning while the vehicle moves, with planners that fail in every way.

use crate::world::{Detours, Routes, World};
use auv_graph::Route;
use auv_mission::driver::{Driver, Stepped, Threaded, ThreadedSettings};
use auv_mission::{Event, Outcome, Synchroniser};
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, Trajectory,
};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};
use std::time::Duration;

/// Nothing is prepared ahead, and nothing overruns.
const PATIENT: ThreadedSettings = ThreadedSettings {
    route_deadline: Duration::MAX,
    path_deadline: Duration::MAX,
    anticipation: Duration::ZERO,
};

fn fly_threaded(world: &World, driver: &mut Threaded) -> Synchroniser {
    let mut synchroniser = world.synchroniser();
    let mut time_s = 0.0;
    for _ in 0..3_000 {
        let observation = world.observe(&synchroniser, time_s);
        driver.tick(&mut synchroniser, observation);
        driver.wait(&mut synchroniser);
        if synchroniser.outcome().is_some() {
            return synchroniser;
        }
        time_s = world.next_s(&synchroniser, time_s);
    }
    panic!("the mission never ended");
}

fn fly_stepped(world: &World, driver: &Stepped<'_>) -> Synchroniser {
    let mut synchroniser = world.synchroniser();
    let mut time_s = 0.0;
    for _ in 0..3_000 {
        let observation = world.observe(&synchroniser, time_s);
        driver.tick(&mut synchroniser, observation);
        if synchroniser.outcome().is_some() {
            return synchroniser;
        }
        time_s = world.next_s(&synchroniser, time_s);
    }
    panic!("the mission never ended");
}

/// The tables without the computing times.
fn decisions(synchroniser: &Synchroniser) -> String {
    let mut routes = synchroniser.route_calls().to_vec();
    let mut paths = synchroniser.path_calls().to_vec();
    routes.iter_mut().for_each(|call| call.compute_s = 0.0);
    paths.iter_mut().for_each(|call| call.compute_s = 0.0);
    let end = (synchroniser.outcome(), synchroniser.trajectory());
    format!("{routes:?} {paths:?} {end:?}")
}

#[test]
fn decides_as_the_stepped_driver_when_planning_takes_no_time() {
    for seed in 0..12 {
        let world = World::new(seed);
        let mut threaded = Threaded::new(Arc::new(Routes), Arc::new(Detours), PATIENT);
        let ours = fly_threaded(&world, &mut threaded);
        let theirs = fly_stepped(&world, &Stepped::new(&Routes, &Detours));
        assert_eq!(decisions(&ours), decisions(&theirs), "mission {seed}");
    }
}

#[test]
fn questions_left_open_by_another_driver_are_answered() {
    for seed in 0..6 {
        let world = World::new(seed);
        let mut driver = Threaded::new(Arc::new(Routes), Arc::new(Detours), PATIENT);
        let mut synchroniser = world.synchroniser();
        let mut time_s = 0.0;
        for tick in 0..3_000 {
            let seen = world.observe(&synchroniser, time_s);
            let behind: &mut dyn Driver = &mut driver;
            match tick % 3 {
                0 => {
                    // As after a restart: the questions are asked, and nobody answers.
                    synchroniser.step(Event::Tick(seen));
                    behind.carry_on(&mut synchroniser);
                    let asks = synchroniser.outstanding().is_some();
                    assert_eq!(driver.is_waiting(), asks);
                    assert!(format!("{driver:?}").contains(&format!("waiting: {asks}")));
                }
                1 => drop(behind.tick(&mut synchroniser, seen)),
                _ => drop(behind.tell(&mut synchroniser, Event::Tick(seen))),
            }
            driver.wait(&mut synchroniser);
            if synchroniser.outcome().is_some() {
                break;
            }
            time_s = world.next_s(&synchroniser, time_s);
        }
        let stepped = fly_stepped(&world, &Stepped::new(&Routes, &Detours));
        assert_eq!(
            decisions(&synchroniser),
            decisions(&stepped),
            "mission {seed}"
        );
    }
}

/// Returns one plan for each signal; once the sender is dropped it never waits.
struct Gated {
    calls: AtomicUsize,
    gate: Mutex<Receiver<()>>,
}

impl Gated {
    fn new() -> (Arc<Self>, Sender<()>) {
        let (open, gate) = channel();
        let gate = Mutex::new(gate);
        let calls = AtomicUsize::new(0);
        (Arc::new(Self { calls, gate }), open)
    }
}

impl PathPlanner for Gated {
    fn name(&self) -> &str {
        "gated"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        self.calls.fetch_add(1, Ordering::SeqCst);
        let _ = self.gate.lock().unwrap().recv();
        Detours.plan_path(run, problem)
    }
}

#[test]
fn ticks_go_on_while_a_path_is_planned() {
    let mut world = World::new(4);
    world.settings.planning.planning_s = 5.0;
    let (planner, open) = Gated::new();
    let mut driver = Threaded::new(Arc::new(Routes), planner.clone(), PATIENT);
    let mut synchroniser = world.synchroniser();
    let observation = world.observe(&synchroniser, 0.0);
    driver.tick(&mut synchroniser, observation);
    while planner.calls.load(Ordering::SeqCst) == 0 {
        // The route arrives on its own thread.
        driver.poll(&mut synchroniser);
        std::thread::yield_now();
    }
    for tick in 1..4 {
        let observation = world.observe(&synchroniser, f64::from(tick));
        let orders = driver.tick(&mut synchroniser, observation);
        assert!(orders.follow.is_none() && driver.is_waiting());
    }
    open.send(()).unwrap();
    let orders = driver.wait(&mut synchroniser);
    let follow = orders.follow.unwrap();
    // The trajectory starts now and leads into the path, which departs at the time asked for.
    assert_eq!(follow.start().time_s, 3.0);
    assert!(follow.points().iter().any(|p| p.time_s == 5.0));
    drop(open);
    assert_eq!(
        fly_threaded(&world, &mut driver).outcome(),
        Some(Outcome::Docked)
    );
}

#[test]
fn a_planner_that_never_returns_is_abandoned_and_its_late_results_are_dropped() {
    let world = World::new(4);
    let (planner, open) = Gated::new();
    let hasty = ThreadedSettings {
        path_deadline: Duration::from_millis(250),
        ..PATIENT
    };
    let mut driver = Threaded::new(Arc::new(Routes), planner.clone(), hasty);
    let synchroniser = fly_threaded(&world, &mut driver);
    assert!(matches!(
        synchroniser.outcome(),
        Some(Outcome::Docked | Outcome::Late)
    ));
    // Two calls hang; a baseline flew the mission.
    assert_eq!(planner.calls.load(Ordering::SeqCst), 2);
    drop(open);
}

struct Panics(AtomicUsize);

impl PathPlanner for Panics {
    fn name(&self) -> &str {
        "panics"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let call = self.0.fetch_add(1, Ordering::SeqCst);
        assert!(call % 2 == 1, "every other call panics on purpose");
        Detours.plan_path(run, problem)
    }
}

impl RoutePlanner for Panics {
    fn name(&self) -> &str {
        "panics"
    }

    fn plan_route(
        &self,
        _run: &mut Run<'_>,
        _problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        self.0.fetch_add(1, Ordering::SeqCst);
        panic!("always, on purpose")
    }
}

#[test]
fn both_drivers_catch_panics_and_replace_the_planner() {
    let world = World::new(4);
    let count = || Panics(AtomicUsize::new(0));
    let (routes, paths) = (Arc::new(count()), Arc::new(count()));
    let mut driver = Threaded::new(routes.clone(), paths.clone(), PATIENT);
    let threaded = fly_threaded(&world, &mut driver);
    let (own_routes, own_paths) = (count(), count());
    let stepped = fly_stepped(&world, &Stepped::new(&own_routes, &own_paths));
    assert_eq!(decisions(&threaded), decisions(&stepped));
    assert_eq!(threaded.outcome(), Some(Outcome::Docked));
    for calls in [&routes.0, &own_routes.0] {
        assert!(calls.load(Ordering::SeqCst) <= 3);
    }
}

/// Returns the target at the wrong time, from the wrong place.
struct Nonsense;

impl PathPlanner for Nonsense {
    fn name(&self) -> &str {
        "nonsense"
    }

    fn plan_path(
        &self,
        _run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let place = auv_obstacles::TimedPoint::new(problem.target, -1e9);
        let stats = auv_planning::Stats::default();
        Ok(Planned::new(
            Trajectory::hover(place, 1.0),
            f64::NAN,
            0.0,
            stats,
        ))
    }
}

#[test]
fn a_nonsensical_path_is_never_followed_and_a_baseline_answers() {
    let world = World::new(4);
    let mut driver = Threaded::new(Arc::new(Routes), Arc::new(Nonsense), PATIENT);
    let synchroniser = fly_threaded(&world, &mut driver);
    assert!(matches!(
        synchroniser.outcome(),
        Some(Outcome::Docked | Outcome::Late)
    ));
}

struct Counted(AtomicUsize);

impl PathPlanner for Counted {
    fn name(&self) -> &str {
        "counted"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        self.0.fetch_add(1, Ordering::SeqCst);
        Detours.plan_path(run, problem)
    }
}

#[test]
fn plans_are_ready_when_a_waypoint_is_reached() {
    let mut at_once = 0;
    let mut waypoints = 0;
    for seed in 0..10 {
        let world = World::new(seed);
        let counted = Arc::new(Counted(AtomicUsize::new(0)));
        let early = ThreadedSettings {
            anticipation: Duration::from_secs(3_600),
            ..PATIENT
        };
        let mut driver = Threaded::new(Arc::new(Routes), counted.clone(), early);
        let mut synchroniser = world.synchroniser();
        let mut time_s = 0.0;
        while synchroniser.outcome().is_none() {
            let (visited, calls) = (
                synchroniser.visited().len(),
                counted.0.load(Ordering::SeqCst),
            );
            let observation = world.observe(&synchroniser, time_s);
            let orders = driver.tick(&mut synchroniser, observation);
            if synchroniser.visited().len() > visited && synchroniser.outcome().is_none() {
                waypoints += 1;
                let ready = orders.follow.is_some() && !driver.is_waiting();
                at_once += usize::from(ready && counted.0.load(Ordering::SeqCst) <= calls + 1);
            }
            driver.wait(&mut synchroniser);
            time_s = world.next_s(&synchroniser, time_s);
        }
    }
    assert!(at_once * 10 >= waypoints * 9, "{at_once} of {waypoints}");
}
