//! The verifier's reports on drawn trajectories and routes, compared with committed files.

#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_graph::{Edge, EdgeId, EdgeSet, Network, NodeId, Route, Task, Waypoint};
use auv_obstacles::{ObstacleId, Region, TimedPoint};
use auv_ocean::{
    AnalyticBed, AnalyticCurrent, BedFeature, Footprint, SeaBed, TidalConstituent, Undulation,
};
use auv_planning::{PathProblem, RouteProblem, Trajectory, Vehicle};
use auv_types::rand::RngExt;
use auv_types::{Bounds, ChaCha8Rng, Point3, Seed, Vector3};
use auv_verify::{PathReport, verify_motion, verify_route, verify_trajectory};
use serde_json::{Value, json};

fn check(name: &str, found: Vec<Value>) {
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), name, &Value::Array(found)).unwrap();
}

fn place(random: &mut ChaCha8Rng) -> Point3<f64> {
    let [x, y] = [0, 1].map(|_| random.random_range(0.0..2e3));
    Point3::new(x, y, random.random_range(5.0..70.0))
}

fn region(random: &mut ChaCha8Rng, i: u32) -> Region {
    let (centre, radius_m) = (place(random), random.random_range(10.0..120.0));
    let mut region = if i.is_multiple_of(3) {
        Region::cylinder(centre, radius_m, 0.0, 40.0)
    } else {
        Region::ball(centre, radius_m)
    };
    region.obstacle = ObstacleId(i);
    region.velocity_mps = Vector3::new(random.random_range(-0.8..0.8), 0.3, 0.0);
    region.growth_mps = random.random_range(-0.02..0.04);
    if i % 4 == 1 {
        region.from_s = random.random_range(0.0..900.0);
        region.until_s = region.from_s + 400.0;
    }
    region
}

fn bed(random: &mut ChaCha8Rng) -> AnalyticBed {
    let bank = Footprint::Disc {
        centre: [random.random_range(0.0..2e3), random.random_range(0.0..2e3)],
        radius_m: 150.0,
    };
    let mut bed = AnalyticBed::new(85.0).with(BedFeature::new("bank", bank, 30.0, 300.0));
    bed.undulations.push(Undulation {
        amplitude_m: 4.0,
        wavelength: [300.0, 150.0],
    });
    bed
}

/// A trajectory that wanders, hovers now and then and changes speed.
fn trajectory(random: &mut ChaCha8Rng) -> Trajectory {
    let mut points = vec![TimedPoint::new(
        place(random),
        random.random_range(0.0..500.0),
    )];
    for k in 0..12 {
        let last = points[k];
        let target = place(random);
        let step = (target - last.position).cap_magnitude(random.random_range(20.0..200.0));
        let speed_mps = random.random_range(0.5..2.2);
        points.push(TimedPoint::new(
            last.position + step,
            last.time_s + step.norm() / speed_mps,
        ));
    }
    Trajectory::new(points).unwrap()
}

fn told(report: &PathReport) -> Value {
    let violations = report.violations.iter().map(ToString::to_string);
    json!({
        "length_m": report.length_m,
        "duration_s": report.duration_s,
        "speeds_mps": [report.min_speed_mps, report.max_speed_mps],
        "min_turn_radius_m": report.min_turn_radius_m,
        "max_pitch_rad": report.max_pitch_rad,
        "min_altitude_m": report.min_altitude_m.to_string(),
        "closest": report.closest.map(|c| json!([c.region, c.clearance_m, c.time_s])),
        "violations": violations.collect::<Vec<_>>(),
    })
}

#[test]
fn trajectories() {
    let mut random = Seed(31).stream(0);
    let vehicle = Vehicle::default();
    let reports = (0..16).map(|i| {
        let bed = bed(&mut random);
        let tide = AnalyticCurrent {
            mean_mps: [0.1, -0.2],
            tide: vec![TidalConstituent::turning_at(600.0, [0.3, 0.2])],
            ..AnalyticCurrent::default()
        };
        let regions: Vec<_> = (0..6).map(|k| region(&mut random, k)).collect();
        let trajectory = trajectory(&mut random);
        let problem = PathProblem {
            start_velocity: (i % 2 == 0).then(|| Vector3::new(1.0, 0.0, 0.0)),
            departure_s: trajectory.start().time_s,
            bounds: Some(Bounds::new(
                Point3::new(50.0, 50.0, 2.0),
                Point3::new(1.9e3, 1.9e3, 65.0),
            )),
            sea_bed: (i % 4 > 0).then_some(&bed as &dyn SeaBed),
            min_altitude_m: 5.0,
            altitude_sigmas: 1.0,
            current: (i % 3 > 0).then_some(&tide as _),
            regions: &regions,
            clearance_m: 10.0,
            ..PathProblem::new(trajectory.start().position, place(&mut random), &vehicle)
        };
        told(&if i % 5 == 4 {
            verify_motion(&problem, &trajectory)
        } else {
            verify_trajectory(&problem, &trajectory)
        })
    });
    check("trajectories", reports.collect());
}

#[test]
fn routes() {
    let mut random = Seed(32).stream(0);
    let waypoints: Vec<_> = (0..12).map(|_| Waypoint::at(place(&mut random))).collect();
    let mut edges = Vec::new();
    for a in 0..12 {
        for b in a + 1..12 {
            let task = Task {
                priority: random.random_range(1.0..10.0),
                risk: random.random_range(1.0..5.0),
                completion_time_s: random.random_range(0.0..200.0),
            };
            if random.random_bool(0.7) {
                edges.push(Edge::undirected(a, b, task));
            }
        }
    }
    let network = Network::new(&waypoints, &edges, 1.5).unwrap();
    let removed: EdgeSet = [EdgeId(2), EdgeId(7)].into_iter().collect();
    let reports = (0..12).map(|_| {
        let problem = RouteProblem {
            removed: &removed,
            ..RouteProblem::new(&network, NodeId(0), NodeId(11), 5e3)
        };
        let mut nodes = vec![NodeId(0)];
        nodes.extend((0..5).map(|_| NodeId(random.random_range(0..12))));
        nodes.push(NodeId(11));
        let report = verify_route(&problem, &Route::new(nodes));
        let violations = report.violations.iter().map(ToString::to_string);
        json!({
            "weight": report.weight,
            "time_s": report.time_s,
            "distance_m": report.distance_m,
            "tasks": report.tasks,
            "violations": violations.collect::<Vec<_>>(),
        })
    });
    check("routes", reports.collect());
}
