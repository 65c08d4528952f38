//! Every planner at extreme values: an error, or a plan that holds what it claims.

use crate::cases::each_case;
use crate::mutation::odd;
use auv_exact_route::{ExactRoute, ExactSettings};
use auv_ga_route::{GaRoute, GaSettings};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_ica_route::{IcaRoute, IcaSettings};
use auv_obstacles::{Region, RegionShape};
use auv_ocean::{FlatBed, UniformCurrent};
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_planning::{Budget, PathPlanner, PathProblem, RoutePlanner, RouteProblem, Run, Vehicle};
use auv_pso_path::{PathSearch, PsoPath};
use auv_types::rand::RngExt;
use auv_types::{Bounds, ChaCha8Rng, Point3, Seed, Vector3};
use auv_verify::{verify_route, verify_trajectory};

/// `usual`, or in one case of eight an extreme number.
fn drawn(random: &mut ChaCha8Rng, usual: std::ops::Range<f64>) -> f64 {
    if random.random_range(0..8) == 0 {
        odd(random)
    } else {
        random.random_range(usual)
    }
}

fn place(random: &mut ChaCha8Rng) -> Point3<f64> {
    Point3::new(
        drawn(random, -900.0..900.0),
        drawn(random, -900.0..900.0),
        drawn(random, 5.0..80.0),
    )
}

fn vehicle(random: &mut ChaCha8Rng) -> Vehicle {
    let usual = Vehicle::default();
    match random.random_range(0..4) {
        0 => Vehicle::paper(),
        1 => usual,
        _ => Vehicle {
            speed_mps: drawn(random, 0.5..2.0),
            max_speed_mps: drawn(random, 2.0..3.0),
            min_speed_mps: drawn(random, 0.0..0.5),
            turn_radius_m: drawn(random, 0.0..60.0),
            max_pitch_rad: drawn(random, 0.05..1.0),
        },
    }
}

fn region(random: &mut ChaCha8Rng) -> Region {
    let shape = match random.random_range(0..3) {
        0 => RegionShape::Cylinder {
            top_m: drawn(random, 0.0..10.0),
            bottom_m: drawn(random, 10.0..50.0),
        },
        _ => RegionShape::Ball,
    };
    let velocity = Vector3::new(drawn(random, -1.0..1.0), drawn(random, -1.0..1.0), 0.0);
    Region {
        shape,
        velocity_mps: velocity,
        growth_mps: drawn(random, 0.0..0.1),
        from_s: drawn(random, -100.0..100.0),
        until_s: drawn(random, 100.0..2_000.0),
        ..Region::ball(place(random), drawn(random, 5.0..80.0))
    }
}

#[test]
fn paths_at_extremes() {
    let planners: [Box<dyn PathPlanner>; 3] = [
        Box::new(StraightPath),
        Box::new(PsoPath::new(PathSearch::default())),
        Box::new(PsoPath::new(PathSearch::paper())),
    ];
    each_case(250, |random| {
        let vehicle = vehicle(random);
        let count = random.random_range(0..5);
        let regions: Vec<Region> = (0..count).map(|_| region(random)).collect();
        let (bed_m, water) = (drawn(random, 30.0..200.0), drawn(random, -0.8..0.8));
        let current = UniformCurrent::new(Vector3::new(water, -0.5 * water, 0.0));
        let bed = FlatBed::new(bed_m);
        let corners = [place(random), place(random)];
        let low = corners[0].inf(&corners[1]);
        let mut problem = PathProblem {
            departure_s: drawn(random, 0.0..500.0),
            regions: &regions,
            clearance_m: drawn(random, 0.0..15.0),
            ..PathProblem::new(place(random), place(random), &vehicle)
        };
        if random.random() {
            problem.start_velocity = Some(Vector3::new(
                drawn(random, -1.5..1.5),
                drawn(random, -1.5..1.5),
                0.0,
            ));
        }
        if random.random() {
            problem.bounds = Some(Bounds::new(low, corners[0].sup(&corners[1])));
        }
        if random.random() {
            problem.sea_bed = Some(&bed);
            problem.min_altitude_m = drawn(random, 0.0..10.0);
        }
        if random.random() {
            problem.current = Some(&current);
        }
        for planner in &planners {
            let mut run = Run::new(Seed(1), Budget::evaluations(60));
            let Ok(planned) = planner.plan_path(&mut run, &problem) else {
                continue;
            };
            let name = planner.name();
            assert!(
                !planned.cost.is_nan() && !planned.violation.is_nan(),
                "{name}: {planned}"
            );
            let points = planned.best.points();
            assert!(
                points
                    .iter()
                    .all(|p| p.position.iter().all(|x| x.is_finite())),
                "{name}: {planned}"
            );
            let report = verify_trajectory(&problem, &planned.best);
            assert!(
                planned.violation > 0.0 || report.is_valid(),
                "{name}: {report} {problem:?}"
            );
        }
    });
}

#[test]
fn routes_at_extremes() {
    let planners: [Box<dyn RoutePlanner>; 5] = [
        Box::new(GreedyRoute),
        Box::new(GaRoute::new(GaSettings::default())),
        Box::new(GaRoute::new(GaSettings::paper())),
        Box::new(IcaRoute::new(IcaSettings::default())),
        Box::new(ExactRoute::new(ExactSettings::default())),
    ];
    each_case(400, |random| {
        let nodes = random.random_range(2..9_u32);
        let waypoints: Vec<Waypoint> = (0..nodes).map(|_| Waypoint::at(place(random))).collect();
        let mut edges = Vec::new();
        for _ in 0..random.random_range(1..20) {
            let ends = (random.random_range(0..nodes), random.random_range(0..nodes));
            let task = Task {
                priority: drawn(random, 0.0..10.0),
                risk: drawn(random, 1.0..5.0),
                completion_time_s: drawn(random, 0.0..300.0),
            };
            edges.push(if random.random() {
                Edge::undirected(ends.0, ends.1, task)
            } else {
                Edge::directed(ends.0, ends.1, task)
            });
        }
        let Ok(network) = Network::new(&waypoints, &edges, drawn(random, 0.5..2.0)) else {
            return;
        };
        let times: Vec<f64> = (0..network.arcs().len())
            .map(|_| drawn(random, 1.0..900.0))
            .collect();
        let mut problem = RouteProblem::new(
            &network,
            NodeId(random.random_range(0..nodes)),
            NodeId(random.random_range(0..nodes)),
            drawn(random, 100.0..4_000.0),
        );
        if random.random() {
            problem.times = Some(&times);
        }
        for planner in &planners {
            let mut run = Run::new(Seed(1), Budget::evaluations(200));
            let Ok(planned) = planner.plan_route(&mut run, &problem) else {
                continue;
            };
            let name = planner.name();
            assert!(
                !planned.cost.is_nan() && !planned.violation.is_nan(),
                "{name}: {planned}"
            );
            let report = verify_route(&problem, &planned.best);
            assert!(
                planned.violation > 0.0 || report.is_valid(),
                "{name}: {report} {problem:?}"
            );
        }
    });
}
