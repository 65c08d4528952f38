//! Whatever happens, what is saved is resumed, and as it was.

use crate::{
    Battery, Checkpoint, Command, ComputeCharge, Event, Mission, Observation, ReplanPolicy,
    SyncSettings, Synchroniser,
};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_obstacles::{ObstacleId, Region};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{PathPlanner, PlanError, RoutePlanner, Run, Vehicle};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed, Vector3};
use std::sync::Arc;

fn mission(vehicle: Vehicle) -> Arc<Mission> {
    let places = [[0.0, 0.0], [400.0, 100.0], [700.0, -100.0], [1000.0, 0.0]];
    let waypoints = places.map(|[x, y]| Waypoint::at(Point3::new(x, y, 20.0)));
    let task = Task {
        priority: 6.0,
        risk: 2.0,
        completion_time_s: 60.0,
    };
    let edges = [(0, 1), (1, 2), (2, 3), (0, 3), (1, 3)].map(|(a, b)| {
        let task = if b == 3 { Task::TRANSIT } else { task };
        Edge::undirected(a, b, task)
    });
    let network = Arc::new(Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap());
    let mut mission = Mission::new(network, NodeId(0), NodeId(3), 3_000.0, vehicle);
    mission.min_altitude_m = 4.0;
    mission.battery = Some(Battery {
        usable_j: 1e6,
        hotel_w: 10.0,
        propulsion_j_per_m: 20.0,
    });
    Arc::new(mission)
}

/// A number from a list of ordinary and extreme ones.
fn odd(random: &mut ChaCha8Rng, from: &[f64]) -> f64 {
    from[random.random_range(0..from.len())]
}

fn settings(random: &mut ChaCha8Rng) -> SyncSettings {
    let mut settings = SyncSettings::default();
    settings.waiting.max_path_calls = if random.random() { 1 } else { 200 };
    settings.margins.lookahead_s = odd(random, &[600.0, 600.0, 1e7, 1e308]);
    settings.planning.planning_s = odd(random, &[0.0, 0.0, 10.0, 100.0]);
    settings.planning.compute = match random.random_range(0..3) {
        0 => ComputeCharge::None,
        1 => ComputeCharge::Measured,
        _ => ComputeCharge::Fixed {
            route_s: odd(random, &[1.0, 2e9, 1.5e308]),
            path_s: odd(random, &[1.0, 2e9, 1.5e308]),
        },
    };
    if random.random() {
        settings.replan.policy = ReplanPolicy::Projected;
    }
    settings
}

fn region(random: &mut ChaCha8Rng, near: Point3<f64>) -> Region {
    let mut draw = |span: f64| random.random_range(-span..span);
    let offset = Vector3::new(draw(200.0), draw(200.0), draw(20.0));
    let mut region = Region::ball(near + offset, 60.0 + draw(59.0));
    region.velocity_mps = Vector3::new(draw(2.0), draw(2.0), 0.0);
    region.growth_mps = draw(0.2);
    region.obstacle = ObstacleId(random.random_range(0..3));
    region.at_s = odd(random, &[0.0, 0.0, 1e9, -1e9, f64::NAN]);
    region
}

fn tick(random: &mut ChaCha8Rng, synchroniser: &Synchroniser, now_s: f64) -> Event {
    let on_track = synchroniser.trajectory().map(|way| way.at(now_s));
    let (mut position, velocity) = on_track.unwrap_or((Point3::new(0.0, 0.0, 20.0), Vector3::x()));
    match random.random_range(0..12) {
        0 => position.x += random.random_range(-100.0..100.0),
        1 => position.y = odd(random, &[f64::NAN, 1e7, 1e300]),
        // Carried away again and again: a drift.
        2..6 => position.y += 30.0,
        _ => {}
    }
    let count = random.random_range(0..4);
    let regions = (0..count).map(|_| region(random, position)).collect();
    Event::Tick(Observation {
        position_sigma_m: 0.0,
        time_s: now_s,
        position,
        velocity: velocity * odd(random, &[1.0, 1.0, 1.0, 1e12, f64::NAN]),
        regions,
    })
}

/// An answer to a question: a baseline's, none, or one with NaN.
fn answer(random: &mut ChaCha8Rng, command: &Command) -> Option<Event> {
    let compute_s = odd(
        random,
        &[0.0, 1.0, 2e9, 1.5e308, -1e308, f64::NAN, f64::INFINITY],
    );
    let fails = random.random_range(0..3) == 0;
    let number = odd(random, &[1.0, 1.0, 1.0, f64::NAN, f64::INFINITY]);
    let failed = || PlanError::Failed {
        planner: "asked".into(),
        reason: "drawn".into(),
    };
    match command {
        Command::PlanRoute(request) => {
            let mut run = Run::new(request.seed, request.budget);
            let mut result = GreedyRoute.plan_route(&mut run, &request.problem());
            if let Ok(planned) = &mut result {
                planned.cost *= number;
            }
            Some(Event::RoutePlanned {
                request: request.id,
                result: if fails { Err(failed()) } else { result },
                compute_s,
            })
        }
        Command::PlanPath(request) => {
            let mut run = Run::new(request.seed, request.budget);
            let mut result = StraightPath.plan_path(&mut run, &request.problem());
            if let Ok(planned) = &mut result {
                planned.cost *= number;
            }
            Some(Event::PathPlanned {
                request: request.id,
                result: if fails { Err(failed()) } else { result },
                compute_s,
            })
        }
        Command::Follow(_) | Command::Finished(_) => None,
    }
}

fn other(random: &mut ChaCha8Rng) -> Event {
    match random.random_range(0..3) {
        0 => Event::AltitudeMeasured {
            altitude_m: odd(random, &[30.0, 8.0, f64::NAN, 1e300]),
        },
        1 => Event::BatteryMeasured {
            left_j: odd(random, &[9e5, 1e300, -1e308, f64::NAN]),
        },
        _ => Event::SonarSilent {
            age_s: odd(random, &[1.0, 20.0, f64::NAN]),
        },
    }
}

fn check(synchroniser: &Synchroniser, what: &str) {
    let saved = synchroniser.save();
    let text = saved.to_text().unwrap();
    let read = Checkpoint::from_text(&text).unwrap_or_else(|error| panic!("{what}: {error}"));
    let mission = Arc::clone(synchroniser.mission());
    let resumed = Synchroniser::resume(mission, read);
    let resumed = resumed.unwrap_or_else(|error| panic!("{what}: {error}"));
    assert_eq!(resumed.save().to_text().unwrap(), text, "{what}");
}

#[test]
fn what_save_writes_resume_takes() {
    let missions = [mission(Vehicle::paper()), mission(Vehicle::default())];
    for seed in 0..60_u64 {
        let mut random = Seed(seed).stream(0);
        let settings = settings(&mut random);
        let mission = Arc::clone(&missions[(seed % 2) as usize]);
        let mut synchroniser = Synchroniser::new(mission, settings, Seed(seed)).unwrap();
        let mut now_s = odd(&mut random, &[0.0, 0.0, 9e8, 9.999e8]);
        for step in 0..40 {
            let asked = synchroniser.outstanding();
            let answers = random.random_range(0..4) > 0;
            let answered = asked.filter(|_| answers);
            let event = match answered.and_then(|command| answer(&mut random, &command)) {
                Some(event) => event,
                None if step > 0 && random.random_range(0..8) == 0 => other(&mut random),
                None => {
                    now_s += odd(&mut random, &[1.0, 1.0, 10.0, 60.0]);
                    tick(&mut random, &synchroniser, now_s)
                }
            };
            let what = format!("seed {seed}, step {step}, {event:?}");
            synchroniser.step(event);
            check(&synchroniser, &what);
        }
    }
}
