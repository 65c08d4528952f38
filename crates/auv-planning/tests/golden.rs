//! Fixed-seed answers of the baseline planners and travel times, compared with committed files.

#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_obstacles::{ObstacleId, Region};
use auv_ocean::{
    AnalyticBed, AnalyticCurrent, BedFeature, Footprint, LambVortex, TidalConstituent,
};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{
    Budget, PathPlanner, PathProblem, RoutePlanner, RouteProblem, Run, Trajectory, Vehicle,
};
use auv_types::ChaCha8Rng;
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed, Vector3};
use serde_json::{Value, json};

type Random = ChaCha8Rng;

fn check(name: &str, found: Vec<Value>) {
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), name, &Value::Array(found)).unwrap();
}

/// Hash (FNV-1a) of the bits of all places and times.
fn hash(trajectory: &Trajectory) -> String {
    let numbers = trajectory
        .points()
        .iter()
        .flat_map(|p| [p.position.x, p.position.y, p.position.z, p.time_s]);
    let hash = numbers
        .flat_map(|x| x.to_bits().to_le_bytes())
        .fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
            (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
        });
    format!("{hash:016x}")
}

fn place(random: &mut Random, depth_m: f64) -> Point3<f64> {
    Point3::new(
        random.random_range(0.0..3e3),
        random.random_range(0.0..3e3),
        random.random_range(0.0..depth_m),
    )
}

fn network(random: &mut Random) -> Network {
    let waypoints: Vec<_> = (0..20).map(|_| Waypoint::at(place(random, 80.0))).collect();
    let mut edges = Vec::new();
    for i in 0..20 {
        for j in i + 1..20 {
            if j == i + 1 || random.random_range(0.0..1.0) < 0.3 {
                let task = Task {
                    priority: random.random_range(1.0..10.0),
                    risk: random.random_range(1.0..4.0),
                    completion_time_s: random.random_range(0.0..200.0),
                };
                edges.push(Edge::undirected(i, j, task));
            }
        }
    }
    Network::new(&waypoints, &edges, 3.0).unwrap()
}

#[test]
fn greedy_routes() {
    let mut random = Seed(21).stream(0);
    let plans = [200.0, 3e3, 6e3, 9e3, 20e3, 80e3].map(|budget_s| {
        let network = network(&mut random);
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(19), budget_s);
        let mut run = Run::new(Seed(0), Budget::evaluations(1));
        let planned = GreedyRoute.plan_route(&mut run, &problem).unwrap();
        let nodes: Vec<u32> = planned.best.nodes().iter().map(|node| node.0).collect();
        json!({ "cost": planned.cost, "violation": planned.violation, "nodes": nodes })
    });
    check("greedy", plans.to_vec());
}

fn current(random: &mut Random) -> AnalyticCurrent {
    let mut draw = |most: f64| random.random_range(-most..most);
    AnalyticCurrent {
        mean_mps: [draw(1.0), draw(1.0)],
        tide: vec![TidalConstituent::turning_at(
            draw(9e3),
            [draw(0.6), draw(0.6)],
        )],
        gains: Vec::new(),
        vortices: vec![LambVortex {
            centre: [1.5e3 + draw(500.0), 1.5e3 + draw(500.0)],
            circulation_m2ps: draw(3e3),
            core_radius_m: 400.0,
        }],
    }
}

fn bed(random: &mut Random) -> AnalyticBed {
    let centre = [
        random.random_range(500.0..2.5e3),
        random.random_range(500.0..2.5e3),
    ];
    let bank = Footprint::Disc {
        centre,
        radius_m: 300.0,
    };
    AnalyticBed::new(95.0).with(BedFeature::new("bank", bank, 30.0, 400.0))
}

fn regions(random: &mut Random) -> Vec<Region> {
    (0..8)
        .map(|i| {
            let centre = place(random, 80.0);
            let radius_m = random.random_range(20.0..150.0);
            let mut region = if i % 3 == 0 {
                Region::cylinder(centre, radius_m, 0.0, 70.0)
            } else {
                Region::ball(centre, radius_m)
            };
            region.obstacle = ObstacleId(i);
            region.velocity_mps = Vector3::new(random.random_range(-0.5..0.5), 0.2, 0.0);
            region.growth_mps = random.random_range(-0.01..0.02);
            region
        })
        .collect()
}

#[test]
fn straight_paths() {
    let mut random = Seed(22).stream(0);
    let plans = (0..24).map(|i| {
        let vehicle = if i % 2 == 0 {
            Vehicle::paper()
        } else {
            Vehicle::default()
        };
        let (bed, current) = (bed(&mut random), current(&mut random));
        let regions = regions(&mut random);
        let (start, target) = (place(&mut random, 80.0), place(&mut random, 80.0));
        let problem = PathProblem {
            start_velocity: (i % 3 == 0).then(|| Vector3::new(1.0, 0.5, 0.0)),
            departure_s: random.random_range(0.0..5e3),
            bounds: Some(Bounds::new(
                Point3::new(100.0, 100.0, 2.0),
                Point3::new(2.9e3, 2.9e3, 75.0),
            )),
            sea_bed: (i % 4 != 1).then_some(&bed as _),
            min_altitude_m: 5.0,
            current: (i % 4 != 2).then_some(&current as _),
            regions: &regions,
            clearance_m: 10.0,
            ..PathProblem::new(start, target, &vehicle)
        };
        let mut run = Run::new(Seed(0), Budget::evaluations(1));
        let planned = StraightPath.plan_path(&mut run, &problem).unwrap();
        json!({
            "cost": planned.cost,
            "violation": planned.violation,
            "blocked_by": planned.blocked_by.map(|id| id.0),
            "path": hash(&planned.best),
        })
    });
    check("straight", plans.collect());
}

#[test]
fn travel_times() {
    let mut random = Seed(23).stream(0);
    let times = (0..24).map(|i| {
        let vehicle = Vehicle {
            max_speed_mps: if i % 2 == 0 { 1.5 } else { 2.5 },
            ..Vehicle::default()
        };
        let current = current(&mut random);
        let points: Vec<_> = (0..6).map(|_| place(&mut random, 80.0)).collect();
        let problem = PathProblem {
            current: Some(&current),
            departure_s: random.random_range(0.0..20e3),
            ..PathProblem::new(points[0], points[5], &vehicle)
        };
        match problem.timed(&points) {
            Ok(path) => json!({ "duration_s": path.duration_s(), "path": hash(&path) }),
            Err(stuck) => json!({ "no_way_at": stuck.place.coords.as_slice() }),
        }
    });
    check("travel", times.collect());
}
