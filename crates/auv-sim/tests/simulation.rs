//! A simulation that its caller steps, with parts of the caller's own.
#![allow(
    clippy::unwrap_used,
    clippy::panic,
    reason = "a test that fails should say where"
)]

use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_mission::driver::{Driver, Orders, Prepared, Stepped};
use auv_mission::{Command, Event, Mission, Synchroniser};
use auv_obstacles::truth::{Obstacle, ObstacleClass};
use auv_obstacles::{Detection, Frozen, ObstaclePredictor, Region, Scan, TimedPoint};
use auv_planning::Trajectory;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::{
    Guidance, MissionOutcome, Preset, Scenario, SimulatedSonar, SimulatedVehicle, Simulation,
    Summary, simulate,
};
use auv_types::{ChaCha8Rng, Point3, Seed, Vector3};
use std::cell::RefCell;
use std::rc::Rc;

/// Three waypoints in a line, a net adrift beside the first leg and a charted rock on the second.
fn scenario() -> Scenario {
    let values = Preset::Default.values();
    let ends = [0.0, 900.0, 1_800.0].map(|x| Waypoint::at(Point3::new(x, 0.0, 20.0)));
    let edges = [0, 1].map(|k| Edge::undirected(k, k + 1, Task::TRANSIT));
    let network = Network::new(&ends, &edges, values.vehicle.speed_mps).unwrap();
    let mission = Mission::new(
        network.into(),
        NodeId(0),
        NodeId(2),
        3_000.0,
        values.vehicle,
    );
    let mut net = Obstacle::new(
        ObstacleClass::Drifting,
        Point3::new(450.0, 60.0, 20.0),
        15.0,
    );
    net.velocity_mps = Vector3::new(0.0, -0.05, 0.0);
    let rock = Obstacle::new(ObstacleClass::Static, Point3::new(1_350.0, 0.0, 20.0), 25.0);
    Scenario::new(mission, vec![rock, net], Seed(5)).unwrap()
}

fn flown(mut simulation: Simulation<'_>, driver: &mut dyn Driver) -> Summary {
    loop {
        if let Some(summary) = simulation.step(driver, &mut ()).unwrap() {
            return summary;
        }
    }
}

#[test]
fn a_destination_inside_a_charted_obstacle_is_refused_by_name() {
    let mission = scenario().mission;
    let refusal = |class, docks: Vec<NodeId>| {
        let obstacle = Obstacle::new(class, Point3::new(1_790.0, 0.0, 20.0), 25.0);
        let mission = Mission {
            docks,
            ..Mission::clone(&mission)
        };
        let scenario = Scenario::new(mission, vec![obstacle], Seed(5)).unwrap();
        scenario.validate().to_string()
    };
    let told = refusal(ObstacleClass::Static, Vec::new());
    let said = "destination (waypoint 2) lies 15.0 m inside obstacles[0], which is charted and stays; move";
    assert!(told.contains(said), "{told}");
    // Another dock is free, and what drifts may go away.
    let with_another = refusal(ObstacleClass::Static, vec![NodeId(1)]);
    assert!(!with_another.contains("lies"), "{with_another}");
    assert_eq!(refusal(ObstacleClass::Drifting, Vec::new()), "");
}

#[test]
fn steps_lead_to_what_simulate_flies() {
    let scenario = scenario();
    let paths = PsoPath::new(PathSearch::default());
    let mut stepped = Stepped::new(&GreedyRoute, &paths);
    let whole = simulate(&scenario, &stepped, &mut ()).unwrap();
    assert_eq!(whole.outcome, MissionOutcome::Docked, "{whole}");

    let mut simulation = Simulation::new(&scenario).unwrap();
    let (mut steps, mut before_s) = (0, -1.0);
    let summary = loop {
        let over = simulation.step(&mut stepped, &mut ()).unwrap();
        assert!(simulation.time_s() > before_s, "time passes in every step");
        before_s = simulation.time_s();
        steps += 1;
        if let Some(summary) = over {
            break summary;
        }
        // Everything can be seen between two steps.
        assert!(simulation.position().x > -1.0 && simulation.velocity().norm() < 3.0);
        assert_eq!(simulation.truth().len(), 2);
        let followed = simulation.trajectory().map(|t| t.end().time_s);
        let in_force = simulation
            .synchroniser()
            .trajectory()
            .map(|t| t.end().time_s);
        assert_eq!(followed, in_force);
        assert!(!simulation.predicted().is_empty(), "the rock is charted");
    };
    assert_eq!(summary, whole);
    assert!(steps > 100);
    let again = simulation.step(&mut stepped, &mut ()).unwrap();
    assert_eq!(again, Some(whole), "steps after the end change nothing");
    assert!((simulation.time_s() - before_s).abs() <= 0.0);
}

/// What the parts of the caller's own were asked.
#[derive(Debug, Default)]
struct Seen {
    moved: usize,
    scans: usize,
    prepared: usize,
}

/// Goes straight for the place of the moment ahead, a quarter of the error a second.
#[derive(Debug)]
struct Lagging {
    position: Point3<f64>,
    velocity: Vector3<f64>,
    seen: Rc<RefCell<Seen>>,
}

impl SimulatedVehicle for Lagging {
    fn position(&self) -> Point3<f64> {
        self.position
    }

    fn velocity(&self) -> Vector3<f64> {
        self.velocity
    }

    fn advance(&mut self, guidance: &Guidance<'_>, track: &mut Vec<TimedPoint>) {
        self.seen.borrow_mut().moved += 1;
        let steps = ((guidance.until_s - guidance.from_s) / 0.5).ceil().max(1.0);
        let step_s = (guidance.until_s - guidance.from_s) / steps;
        for k in 1..=steps as usize {
            let time_s = guidance.from_s + step_s * k as f64;
            let (wanted, asked) = guidance.trajectory.at(time_s);
            let through = asked + (wanted - self.position) * 0.25;
            let most_mps = guidance.mission.vehicle.max_speed_mps;
            self.velocity = through * (most_mps / through.norm().max(most_mps));
            self.position += self.velocity * step_s;
            track.push(TimedPoint::new(self.position, time_s));
        }
    }
}

/// Hears everything within 200 m, exactly.
#[derive(Debug)]
struct Exact(Rc<RefCell<Seen>>);

impl SimulatedSonar for Exact {
    fn scan(
        &mut self,
        truth: &[Region],
        from: &Point3<f64>,
        heading_rad: f64,
        time_s: f64,
        _random: &mut ChaCha8Rng,
    ) -> Scan {
        self.0.borrow_mut().scans += 1;
        let echo = |region: &Region| Detection {
            position: region.centre_at(time_s),
            velocity: Some(region.velocity_mps),
            radius_m: region.radius_at(time_s),
            position_sigma_m: 0.1,
            velocity_sigma_mps: 0.01,
            radius_sigma_m: 0.1,
        };
        let detections = truth
            .iter()
            .filter(|region| (region.centre_at(time_s) - from).norm() < 200.0)
            .map(echo);
        Scan {
            time_s,
            from: *from,
            heading_rad,
            background: None,
            detections: detections.collect(),
        }
    }
}

/// Answers with planners of its own, and prepares the next waypoint a minute ahead.
struct Ahead<'a> {
    planners: Stepped<'a>,
    prepared: Option<(usize, Prepared)>,
    seen: Rc<RefCell<Seen>>,
}

impl Ahead<'_> {
    fn carry_out(&mut self, synchroniser: &mut Synchroniser, commands: Vec<Command>) -> Orders {
        let mut orders = Orders::default();
        let mut open = commands;
        while let Some(command) = open.pop() {
            let reached = synchroniser.visited().len();
            let ready = self
                .prepared
                .as_mut()
                .filter(|(visited, _)| visited + 1 == reached);
            let ready = ready.and_then(|(_, prepared)| prepared.answer(&command));
            self.seen.borrow_mut().prepared += usize::from(ready.is_some());
            let answer = ready.or_else(|| self.planners.answer(&command));
            orders.take(command);
            if let Some(answer) = answer {
                open.extend(synchroniser.step(answer));
            }
        }
        orders
    }
}

impl Driver for Ahead<'_> {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        let commands = synchroniser.step(event);
        let orders = self.carry_out(synchroniser, commands);
        let visited = synchroniser.visited().len();
        if let Some(arrival) = Prepared::arrival(synchroniser, 60.0) {
            let holds = self
                .prepared
                .as_ref()
                .is_some_and(|(for_visited, prepared)| {
                    *for_visited == visited && prepared.still_holds(synchroniser, &arrival)
                });
            if !holds {
                let answer = |command: &Command| self.planners.answer(command);
                let prepared = Prepared::new(synchroniser.clone(), arrival, &answer);
                self.prepared = Some((visited, prepared));
            }
        }
        orders
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        let open = synchroniser.outstanding().into_iter().collect();
        self.carry_out(synchroniser, open)
    }
}

#[test]
fn every_part_can_be_the_callers_own() {
    let scenario = scenario();
    let seen = Rc::new(RefCell::new(Seen::default()));
    let vehicle = Lagging {
        position: Point3::new(0.0, 0.0, 20.0),
        velocity: Vector3::zeros(),
        seen: Rc::clone(&seen),
    };
    let mut tracker = Frozen::default();
    tracker.charted = scenario.field.charted();
    assert_eq!(tracker.at(0.0).len(), 1);
    let simulation = Simulation::new(&scenario)
        .unwrap()
        .with_vehicle(vehicle)
        .with_sonar(Exact(Rc::clone(&seen)))
        .with_tracker(tracker);
    let paths = PsoPath::new(PathSearch::default());
    let mut driver = Ahead {
        planners: Stepped::new(&GreedyRoute, &paths),
        prepared: None,
        seen: Rc::clone(&seen),
    };
    let summary = flown(simulation, &mut driver);
    assert_eq!(summary.outcome, MissionOutcome::Docked, "{summary}");
    assert_eq!(summary.judgement.collisions, 0, "{summary}");
    let seen = seen.borrow();
    assert!(seen.moved > 100 && seen.scans > 100, "{seen:?}");
    assert!(seen.prepared > 0, "the second leg was prepared: {seen:?}");
}

/// Predicts nothing, and says whether it is urgent.
#[derive(Debug)]
struct Hasty(bool);

impl ObstaclePredictor for Hasty {
    fn observe(&mut self, _scan: &Scan) {}

    fn charted_regions(&self) -> &[Region] {
        &[]
    }

    fn contacts(&self, _time_s: f64) -> Vec<Region> {
        Vec::new()
    }

    fn fresh_s(&self) -> Option<f64> {
        Some(f64::INFINITY)
    }

    fn horizon_s(&self) -> f64 {
        f64::INFINITY
    }

    fn is_urgent(&self) -> bool {
        self.0
    }
}

/// Counts the ticks of the synchroniser.
struct Counting<'a>(Stepped<'a>, u32);

impl Driver for Counting<'_> {
    fn tell(&mut self, synchroniser: &mut Synchroniser, event: Event) -> Orders {
        self.1 += u32::from(matches!(event, Event::Tick(_)));
        self.0.tell(synchroniser, event)
    }

    fn carry_on(&mut self, synchroniser: &mut Synchroniser) -> Orders {
        self.0.carry_on(synchroniser)
    }
}

#[test]
fn what_closes_in_is_decided_on_at_every_scan() {
    let scenario = scenario();
    assert_eq!((scenario.tick_s, scenario.sonar.period_s), (1.0, 0.5));
    let ticks = |urgent| {
        let mut simulation = Simulation::new(&scenario)
            .unwrap()
            .with_tracker(Hasty(urgent));
        let mut driver = Counting(Stepped::new(&GreedyRoute, &StraightPath), 0);
        while simulation.time_s() < 100.0 {
            assert_eq!(simulation.step(&mut driver, &mut ()).unwrap(), None);
        }
        driver.1
    };
    assert_eq!((ticks(false), ticks(true)), (101, 201));
}

/// Does not move as it is told to.
#[derive(Debug)]
struct Broken(fn(f64) -> Vec<TimedPoint>);

impl SimulatedVehicle for Broken {
    fn position(&self) -> Point3<f64> {
        Point3::new(0.0, 0.0, 20.0)
    }

    fn velocity(&self) -> Vector3<f64> {
        Vector3::zeros()
    }

    fn take(&mut self, _trajectory: &Trajectory, _time_s: f64) {}

    fn advance(&mut self, guidance: &Guidance<'_>, track: &mut Vec<TimedPoint>) {
        track.extend((self.0)(guidance.until_s));
    }
}

#[test]
fn a_vehicle_that_does_not_move_as_told_is_named() {
    let scenario = scenario();
    let broken: [fn(f64) -> Vec<TimedPoint>; 5] = [
        |_| Vec::new(),
        |until_s| vec![TimedPoint::new(Point3::new(f64::NAN, 0.0, 20.0), until_s)],
        |until_s| vec![TimedPoint::new(Point3::new(0.0, 0.0, 20.0), until_s - 0.5)],
        |until_s| vec![TimedPoint::new(Point3::new(9.0, 0.0, 20.0), until_s)],
        |until_s| {
            let at = |time_s| TimedPoint::new(Point3::new(0.0, 0.0, 20.0), time_s);
            vec![at(until_s + 1.0), at(until_s)]
        },
    ];
    for (k, broken) in broken.into_iter().enumerate() {
        let mut simulation = Simulation::new(&scenario)
            .unwrap()
            .with_vehicle(Broken(broken));
        let mut driver = Stepped::new(&GreedyRoute, &StraightPath);
        let error = (0..50).find_map(|_| simulation.step(&mut driver, &mut ()).err());
        let error = error
            .unwrap_or_else(|| panic!("fault {k} was not seen"))
            .to_string();
        assert!(
            error.contains("vehicle") && error.contains("in the order of time"),
            "{error}"
        );
    }
    // One that stays where it is does what it says.
    let stays = |until_s| vec![TimedPoint::new(Point3::new(0.0, 0.0, 20.0), until_s)];
    let simulation = Simulation::new(&scenario)
        .unwrap()
        .with_vehicle(Broken(stays));
    let summary = flown(simulation, &mut Stepped::new(&GreedyRoute, &StraightPath));
    assert_ne!(summary.outcome, MissionOutcome::Docked);
}
