//! Legs without a clear path: the plan that falls short least, by how much, and the region that
//! blocks it.

use crate::plan;
use auv_obstacles::{ObstacleId, Region};
use auv_ocean::FlatBed;
use auv_planning::{Budget, PathProblem, StopReason, Vehicle};
use auv_pso_path::{PathSearch, SwarmSettings};
use auv_types::{Bounds, Point3, Vector3};

const START: Point3<f64> = Point3::new(0.0, 0.0, 50.0);
const TARGET: Point3<f64> = Point3::new(1_000.0, 0.0, 50.0);

fn both(problem: &PathProblem<'_>) -> [(f64, Option<ObstacleId>); 2] {
    let paper = PathSearch::Swarm(SwarmSettings {
        particles: 24,
        iterations: 10,
        ..SwarmSettings::paper()
    });
    [PathSearch::default(), paper].map(|search| {
        let planned = plan(search, problem, Budget::evaluations(300));
        assert!(planned.stats.evaluations <= 300 && planned.violation.is_finite());
        (planned.violation, planned.blocked_by)
    })
}

#[test]
fn regions_that_block_every_path_are_named() {
    let vehicle = Vehicle::paper();
    let wall: Vec<_> = (-10..=10)
        .map(|k| Region {
            obstacle: ObstacleId(7),
            ..Region::cylinder(
                Point3::new(500.0, 50.0 * f64::from(k), 0.0),
                60.0,
                -10.0,
                300.0,
            )
        })
        .collect();
    let problem = PathProblem {
        regions: &wall,
        bounds: Some(Bounds::new(
            Point3::new(-100.0, -400.0, 0.0),
            Point3::new(1_100.0, 400.0, 200.0),
        )),
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    for (violation, blocked_by) in both(&problem) {
        assert!(violation > 0.0);
        assert_eq!(blocked_by, Some(ObstacleId(7)));
    }
}

#[test]
fn ends_below_the_bed_or_outside_the_box_are_violations_without_a_region() {
    let vehicle = Vehicle::paper();
    let bed = FlatBed::new(80.0);
    let below = Point3::new(1_000.0, 0.0, 85.0);
    let bounds = Bounds::new(
        Point3::new(-100.0, -100.0, 0.0),
        Point3::new(900.0, 100.0, 200.0),
    );
    let plain = PathProblem::new(START, TARGET, &vehicle);
    let problems = [
        (
            5.0,
            PathProblem {
                sea_bed: Some(&bed),
                target: below,
                ..plain
            },
        ),
        (
            5.0,
            PathProblem {
                sea_bed: Some(&bed),
                start: below,
                ..plain
            },
        ),
        (
            100.0,
            PathProblem {
                bounds: Some(bounds),
                ..plain
            },
        ),
        (
            100.0,
            PathProblem {
                bounds: Some(bounds),
                start: TARGET,
                target: START,
                ..plain
            },
        ),
    ];
    for (short_m, problem) in problems {
        let [(violation, blocked_by), (papers, _)] = both(&problem);
        assert!((violation - short_m).abs() < 1e-6, "{violation}");
        assert!(blocked_by.is_none() && papers >= short_m - 1e-6);
    }
}

#[test]
fn a_covered_start_lacks_the_same_metres_however_near_the_target() {
    let vehicle = Vehicle::paper();
    let regions = [Region::ball(START, 60.0)];
    for north_m in [0.0, 0.001, 1.0] {
        let problem = PathProblem {
            regions: &regions,
            ..PathProblem::new(START, START + Vector3::x() * north_m, &vehicle)
        };
        for search in [PathSearch::default(), PathSearch::paper()] {
            let planned = plan(search, &problem, Budget::evaluations(300));
            let off_m = (planned.violation - 60.0).abs();
            assert!(off_m < 1e-6, "{north_m}: {}", planned.violation);
            assert_ne!(planned.stats.stop, StopReason::Optimal);
        }
    }
}

#[test]
fn a_stay_below_the_bed_lacks_the_metres_of_a_short_leg_there() {
    let vehicle = Vehicle::paper();
    let bed = FlatBed::new(60.0);
    let start = Point3::new(0.0, 0.0, 82.0);
    for north_m in [0.0, 1e-9, 1e-6, 1.0] {
        let problem = PathProblem {
            sea_bed: Some(&bed),
            min_altitude_m: 5.0,
            ..PathProblem::new(start, start + Vector3::x() * north_m, &vehicle)
        };
        for search in [PathSearch::default(), PathSearch::paper()] {
            let planned = plan(search, &problem, Budget::evaluations(300));
            // A curve of the swarm may dip a little deeper.
            let right = (27.0 - 1e-6..27.1).contains(&planned.violation);
            assert!(right, "{north_m}: {}", planned.violation);
            assert!(!auv_verify::verify_trajectory(&problem, &planned.best).is_valid());
        }
    }
}

#[test]
fn ten_thousand_regions_are_answered_within_the_budget() {
    let vehicle = Vehicle::paper();
    let regions: Vec<_> = (0..10_000)
        .map(|k: u32| {
            let (x, y) = (f64::from(k % 997) + 1.0, f64::from(k * 7 % 401) - 200.0);
            let mut region = Region::ball(Point3::new(x, y, 50.0), 80.0);
            region.obstacle = ObstacleId(k);
            region
        })
        .collect();
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(START, TARGET, &vehicle)
    };
    let planned = plan(PathSearch::default(), &problem, Budget::evaluations(4));
    assert!(planned.violation > 0.0 && planned.stats.evaluations <= 4);
    assert!(planned.blocked_by.is_some());
}

#[test]
fn the_least_intrusion_into_growing_balls_is_found() {
    // Four balls round the start grow together: the gaps between them close while the vehicle leaves.
    let around = [(0.0, 320.0), (0.0, -320.0), (320.0, 0.0), (-320.0, 0.0)];
    let regions = around.map(|(x, y)| {
        let mut ball = Region::ball(Point3::new(x, y, 100.0), 270.0);
        ball.growth_mps = 0.5;
        ball
    });
    let vehicle = Vehicle {
        speed_mps: 1.0,
        max_speed_mps: 1.0,
        ..Vehicle::paper()
    };
    let problem = PathProblem {
        regions: &regions,
        bounds: Some(Bounds::new(
            Point3::new(-500.0, -500.0, 0.0),
            Point3::new(1_500.0, 500.0, 200.0),
        )),
        ..PathProblem::new(
            Point3::new(0.0, 0.0, 100.0),
            Point3::new(1_000.0, 0.0, 100.0),
            &vehicle,
        )
    };
    let planned = plan(PathSearch::default(), &problem, Budget::evaluations(20_000));
    // The best of a long search with two and three corners intrudes by some 200 m.
    assert!(
        (100.0..230.0).contains(&planned.violation),
        "{}",
        planned.violation
    );
}
