//! The path planner: curves costed a second against obstacles and threads, and whole calls.

use auv_obstacles::{ObstacleId, Region};
use auv_planning::{Budget, PathPlanner, PathProblem, Run, Vehicle};
use auv_population::Workers;
use auv_pso_path::{PathSearch, PsoPath};
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed, Vector3};
use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use std::hint::black_box;

const START: Point3<f64> = Point3::new(0.0, 0.0, 400.0);
const TARGET: Point3<f64> = Point3::new(2_400.0, 1_800.0, 450.0);

/// Balls along a leg of 3 km; every second one moves and grows.
fn regions(count: u32, moving: bool) -> Vec<Region> {
    let mut random = Seed(count.into()).stream(0);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    (0..count)
        .map(|i| {
            let middle = START + (TARGET - START) * draw(0.1, 0.9);
            let aside = Vector3::new(
                draw(-250.0, 250.0),
                draw(-250.0, 250.0),
                draw(-150.0, 150.0),
            );
            let mut region = Region::ball(middle + aside, draw(10.0, 110.0));
            region.obstacle = ObstacleId(i);
            if moving && i % 2 == 1 {
                region.velocity_mps = Vector3::new(draw(-0.5, 0.5), draw(-0.5, 0.5), 0.0);
                region.growth_mps = draw(0.0, 0.05);
            }
            region
        })
        .collect()
}

/// 150 particles x 100 iterations: 15,000 curves a call.
fn swarm(criterion: &mut Criterion) {
    let vehicle = Vehicle::paper();
    let mut group = criterion.benchmark_group("paper_swarm");
    group
        .throughput(Throughput::Elements(15_000))
        .sample_size(20);
    for (count, moving) in [(6, false), (6, true), (60, false), (200, true)] {
        let regions = regions(count, moving);
        let problem = PathProblem {
            regions: &regions,
            ..PathProblem::new(START, TARGET, &vehicle)
        };
        for threads in [1, 2] {
            let Ok(workers) = Workers::new(threads) else {
                continue;
            };
            let planner = PsoPath::new(PathSearch::paper()).with_workers(workers);
            let kind = if moving { "moving" } else { "static" };
            let name = BenchmarkId::new(format!("{kind}_{count}"), format!("{threads}_threads"));
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    let mut run = Run::new(Seed(1), Budget::to_the_cap());
                    black_box(planner.plan_path(&mut run, &problem))
                });
            });
        }
    }
    group.finish();
}

/// The time-optimal planner: an easy leg, a first answer, and a search to its end.
fn calls(criterion: &mut Criterion) {
    let vehicle = Vehicle::paper();
    let planner = PsoPath::new(PathSearch::default());
    let mut group = criterion.benchmark_group("default_call");
    group.sample_size(20);
    for count in [0, 6, 20, 60, 200] {
        let regions = regions(count, true);
        let problem = PathProblem {
            regions: &regions,
            ..PathProblem::new(START, TARGET, &vehicle)
        };
        for evaluations in [60, 600] {
            let name = BenchmarkId::new(format!("{count}_obstacles"), evaluations);
            group.bench_function(name, |bencher| {
                bencher.iter(|| {
                    let mut run = Run::new(Seed(1), Budget::evaluations(evaluations));
                    black_box(planner.plan_path(&mut run, &problem))
                });
            });
        }
    }
    group.finish();
}

criterion_group!(benches, swarm, calls);
criterion_main!(benches);
