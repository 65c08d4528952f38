//! What the planner promises, on scenes made here.

#![allow(
    clippy::float_cmp,
    clippy::unwrap_used,
    reason = "tests compare exact bits, and may panic"
)]

mod golden;
mod impossible;
mod random_problems;
mod turns;
mod zermelo;

use auv_obstacles::{ObstacleId, Region, TimedPoint};
use auv_ocean::{FlatBed, UniformCurrent};
use auv_planning::polyline::turn_radius_m;
use auv_planning::{
    Budget, PathPlanner, PathProblem, PlanError, Planned, Run, StopReason, Trajectory, Vehicle,
};
use auv_population::Workers;
use auv_pso_path::{PathSearch, PsoPath, SwarmSettings};
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed, Vector3, libm};

fn plan(search: PathSearch, problem: &PathProblem<'_>, budget: Budget) -> Planned<Trajectory> {
    let mut run = Run::new(Seed(1), budget);
    PsoPath::new(search).plan_path(&mut run, problem).unwrap()
}

/// A leg of 2.5 km with balls and cylinders near the straight line, some of them moving.
fn scene(seed: u64, count: usize) -> (Point3<f64>, Point3<f64>, Vec<Region>) {
    let mut random = Seed(seed).stream(0);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    let (start, target) = (
        Point3::new(0.0, 0.0, 250.0),
        Point3::new(2_000.0, 1_500.0, 300.0),
    );
    let mut regions = Vec::new();
    while regions.len() < count {
        let share = draw(0.05, 0.95);
        let middle = start + (target - start) * share;
        let offset = Vector3::new(
            draw(-200.0, 200.0),
            draw(-200.0, 200.0),
            draw(-100.0, 100.0),
        );
        let radius_m = draw(10.0, 120.0);
        let mut region = if regions.len() % 5 == 4 {
            Region::cylinder(middle + offset, radius_m, 0.0, draw(200.0, 400.0))
        } else {
            Region::ball(middle + offset, radius_m)
        };
        region.obstacle = ObstacleId(regions.len() as u32);
        if regions.len() % 2 == 1 {
            region.velocity_mps = Vector3::new(draw(-0.6, 0.6), draw(-0.6, 0.6), draw(-0.1, 0.1));
            region.growth_mps = draw(0.0, 0.05);
        }
        if regions.len() % 7 == 6 {
            region.until_s = draw(100.0, 900.0);
        }
        let clear = [(start, 0.0), (target, 835.0)]
            .iter()
            .all(|&(place, time_s)| {
                (-1..=4).all(|k| {
                    let time_s = time_s + 20.0 * f64::from(k);
                    region.distance_m(&TimedPoint::new(place, time_s)) > 30.0
                })
            });
        if clear {
            regions.push(region);
        }
    }
    (start, target, regions)
}

fn least_clearance_m(problem: &PathProblem<'_>, trajectory: &Trajectory) -> f64 {
    let regions = problem.regions.iter();
    let each = regions.flat_map(|region| {
        let segments = trajectory.segments();
        segments.map(move |(a, b)| region.clearance(a, b).clearance_m)
    });
    each.fold(f64::INFINITY, f64::min)
}

#[test]
fn a_clear_path_is_clear_between_its_vertices() {
    let vehicle = Vehicle::paper();
    let mut clear = 0;
    for seed in 0..30 {
        let (start, target, regions) = scene(seed, 5 + 2 * seed as usize);
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 5.0,
            bounds: Some(Bounds::new(
                Point3::new(-500.0, -500.0, 0.0),
                Point3::new(3_000.0, 3_000.0, 600.0),
            )),
            ..PathProblem::new(start, target, &vehicle)
        };
        let planned = plan(PathSearch::default(), &problem, Budget::evaluations(400));
        let ends = (planned.best.start().position, planned.best.end().position);
        assert_eq!(ends, (start, target));
        let clearance_m = least_clearance_m(&problem, &planned.best);
        let bounds = problem.bounds.unwrap();
        let inside = planned
            .best
            .points()
            .iter()
            .all(|p| bounds.contains(&p.position));
        assert_eq!(
            planned.violation == 0.0,
            clearance_m >= 5.0 - 1e-6 && inside,
            "scene {seed}: violation {}, clearance {clearance_m}",
            planned.violation
        );
        assert_eq!(planned.violation > 0.0, planned.blocked_by.is_some());
        clear += usize::from(planned.violation == 0.0);
    }
    assert!(clear >= 29, "only {clear} of 30 solved");
}

#[test]
fn round_one_ball_the_path_is_the_geodesic() {
    let vehicle = Vehicle::paper();
    let (distance_m, radius_m, aside_m) = (500.0, 100.0, 30.0);
    let regions = [Region::ball(
        Point3::new(distance_m, aside_m, 50.0),
        radius_m,
    )];
    let (start, target) = (
        Point3::new(0.0, 0.0, 50.0),
        Point3::new(2.0 * distance_m, 0.0, 50.0),
    );
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(start, target, &vehicle)
    };
    let planned = plan(PathSearch::default(), &problem, Budget::evaluations(100));
    let to_centre_m = libm::hypot(distance_m, aside_m);
    let tangent_m = (to_centre_m * to_centre_m - radius_m * radius_m).sqrt();
    let wrap = std::f64::consts::PI
        - 2.0 * libm::acos(radius_m / to_centre_m)
        - 2.0 * libm::atan(aside_m / distance_m);
    let geodesic_m = 2.0 * tangent_m + radius_m * wrap;
    let excess = planned.best.length_m() / geodesic_m - 1.0;
    assert!(
        planned.violation == 0.0 && (0.0..3e-5).contains(&excess),
        "{excess} {:?}",
        planned.best
    );
    assert!(planned.stats.evaluations < 30, "{:?}", planned.stats);
}

#[test]
fn same_bits_at_one_two_and_eight_threads() {
    let vehicle = Vehicle::paper();
    let (start, target, regions) = scene(3, 25);
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(start, target, &vehicle)
    };
    let paper = PathSearch::Swarm(SwarmSettings {
        iterations: 15,
        ..SwarmSettings::paper()
    });
    for (search, evaluations) in [(PathSearch::default(), 700), (paper, 2_111)] {
        let answers: Vec<_> = [1, 2, 8]
            .map(|threads| {
                let planner = PsoPath::new(search).with_workers(Workers::new(threads).unwrap());
                let mut run = Run::new(Seed(9), Budget::evaluations(evaluations));
                planner.plan_path(&mut run, &problem).unwrap()
            })
            .into();
        assert_eq!(answers[0], answers[1]);
        assert_eq!(answers[0], answers[2]);
    }
}

#[test]
fn budgets_hold_exactly() {
    let vehicle = Vehicle::paper();
    let (start, target, regions) = scene(5, 30);
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(start, target, &vehicle)
    };
    for evaluations in [1, 2, 7, 50, 149, 151, 333] {
        for search in [PathSearch::default(), PathSearch::paper()] {
            let planned = plan(search, &problem, Budget::evaluations(evaluations));
            assert!(planned.stats.evaluations <= evaluations);
            if matches!(search, PathSearch::Swarm(_)) {
                assert_eq!(planned.stats.evaluations, evaluations);
            }
        }
    }
}

#[test]
fn an_open_leg_is_flown_straight() {
    let vehicle = Vehicle::paper();
    let regions = [Region::ball(Point3::new(500.0, 300.0, 50.0), 100.0)];
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(Point3::origin(), Point3::new(1_000.0, 0.0, 0.0), &vehicle)
    };
    let planned = plan(PathSearch::default(), &problem, Budget::to_the_cap());
    assert_eq!(planned.stats.stop, StopReason::Optimal);
    assert!(planned.stats.evaluations <= 2 && planned.bound == Some(planned.cost));
}

#[test]
fn a_covered_end_gives_the_least_penetration_and_names_the_region() {
    let vehicle = Vehicle::paper();
    let mut cover = Region::ball(Point3::new(990.0, 5.0, 50.0), 60.0);
    cover.obstacle = ObstacleId(4);
    let other = Region::ball(Point3::new(500.0, 0.0, 50.0), 60.0);
    for regions in [[cover, other], [other, cover]] {
        for (start, target) in [(0.0, 1_000.0), (1_000.0, 0.0)] {
            let at = |x: f64| Point3::new(x, 0.0, 50.0);
            let problem = PathProblem {
                regions: &regions,
                ..PathProblem::new(at(start), at(target), &vehicle)
            };
            let planned = plan(PathSearch::default(), &problem, Budget::evaluations(500));
            let depth_m = 60.0 - libm::hypot(10.0, 5.0);
            assert_eq!(planned.blocked_by, Some(ObstacleId(4)));
            assert!(
                (planned.violation - depth_m).abs() < 0.5,
                "{}",
                planned.violation
            );
            assert!(
                other
                    .clearance(&planned.best.start(), &planned.best.points()[1])
                    .clearance_m
                    > -1e-6
            );
        }
    }
}

#[test]
fn a_limited_vehicle_turns_and_pitches_within_its_limits() {
    let vehicle = Vehicle::default();
    let regions = [
        Region::ball(Point3::new(300.0, 10.0, 40.0), 60.0),
        Region::ball(Point3::new(600.0, -30.0, 45.0), 2.0),
        Region::cylinder(Point3::new(800.0, 20.0, 0.0), 40.0, 0.0, 70.0),
    ];
    for heading in [0.0, 1.0, 2.5, 3.1, -1.6] {
        let velocity = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0) * 1.5;
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 15.0,
            start_velocity: Some(velocity),
            sea_bed: Some(&FlatBed::new(120.0)),
            min_altitude_m: 5.0,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 30.0),
                Point3::new(1_200.0, 0.0, 60.0),
                &vehicle,
            )
        };
        let planned = plan(PathSearch::default(), &problem, Budget::evaluations(3_000));
        assert_eq!(planned.violation, 0.0, "heading {heading}");
        let points = planned.best.points();
        for triple in points.windows(3) {
            let at = |i: usize| &triple[i].position;
            assert!(turn_radius_m(at(0), at(1), at(2)) > 0.99 * 20.0);
        }
        for pair in points.windows(2) {
            let step = pair[1].position - pair[0].position;
            let pitch = libm::atan2(step.z.abs(), step.xy().norm());
            assert!(pitch <= vehicle.max_pitch_rad + 1e-6);
        }
        let ahead = (points[1].position - points[0].position).normalize();
        assert!(ahead.dot(&velocity) > 1.5 * 0.99, "heading {heading}");
        assert!(planned.best.length_m() < 1_200.0 * 1.2);
    }
}

#[test]
fn a_target_too_steep_is_reached_by_circuits() {
    let vehicle = Vehicle::default();
    let start = Point3::new(0.0, 0.0, 10.0);
    for (north_m, east_m, depth_m) in [(0.0, 0.0, 80.0), (60.0, 30.0, 90.0), (-150.0, 0.0, 120.0)] {
        for velocity in [None, Some(Vector3::new(0.0, 1.5, 0.0))] {
            let target = Point3::new(north_m, east_m, depth_m);
            for (from, to) in [(start, target), (target, start)] {
                let problem = PathProblem {
                    start_velocity: velocity,
                    ..PathProblem::new(from, to, &vehicle)
                };
                let planned = plan(PathSearch::default(), &problem, Budget::evaluations(1_000));
                assert_eq!(planned.violation, 0.0, "{from} to {to}, {velocity:?}");
                assert!(auv_verify::verify_trajectory(&problem, &planned.best).is_valid());
                let shortest_m = (to.z - from.z).abs() / libm::sin(vehicle.max_pitch_rad);
                assert!(planned.best.length_m() < 2.0 * shortest_m + 400.0);
            }
        }
    }
}

#[test]
fn times_follow_the_current() {
    let vehicle = Vehicle::paper();
    let current = UniformCurrent::new(Vector3::new(-1.0, 0.5, 0.0));
    let regions = [Region::ball(Point3::new(500.0, 0.0, 50.0), 80.0)];
    let problem = PathProblem {
        regions: &regions,
        current: Some(&current),
        ..PathProblem::new(
            Point3::new(0.0, 0.0, 50.0),
            Point3::new(1_000.0, 0.0, 50.0),
            &vehicle,
        )
    };
    let planned = plan(PathSearch::default(), &problem, Budget::evaluations(300));
    assert_eq!(planned.violation, 0.0);
    assert!(planned.cost > 1_000.0 / 2.0, "{}", planned.cost);
    let strong = UniformCurrent::new(Vector3::new(-4.0, 0.0, 0.0));
    let hopeless = PathProblem {
        current: Some(&strong),
        ..problem
    };
    for search in [PathSearch::default(), PathSearch::paper()] {
        let mut run = Run::new(Seed(1), Budget::evaluations(300));
        let answer = PsoPath::new(search).plan_path(&mut run, &hopeless);
        assert!(matches!(answer, Err(PlanError::Failed { .. })));
    }
}

#[test]
fn the_trajectory_in_force_is_kept_unless_another_is_much_quicker() {
    let vehicle = Vehicle::paper();
    let regions = [Region::ball(Point3::new(500.0, 0.0, 50.0), 80.0)];
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(
            Point3::new(0.0, 0.0, 50.0),
            Point3::new(1_000.0, 0.0, 50.0),
            &vehicle,
        )
    };
    let aside = [
        problem.start,
        Point3::new(500.0, -90.0, 50.0),
        problem.target,
    ];
    let warm = problem.timed(&aside).unwrap();
    let again = PathProblem {
        warm_start: Some(&warm),
        ..problem
    };
    let planned = plan(PathSearch::default(), &again, Budget::evaluations(200));
    let passes_at_m = planned.best.at(0.5 * planned.cost).0.y;
    assert!(
        planned.violation == 0.0 && passes_at_m < -79.0,
        "{passes_at_m}"
    );
}

#[test]
fn the_papers_swarm_finds_a_clear_path_and_reports_every_iteration() {
    let vehicle = Vehicle::paper();
    let (start, target, regions) = scene(1, 6);
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(start, target, &vehicle)
    };
    let mut history = Vec::new();
    let mut observer = |generation: &auv_planning::Generation<'_>| {
        history.push((
            generation.costs.len(),
            generation.best.violation,
            generation.best.cost,
        ));
    };
    let mut run = Run::new(Seed(4), Budget::to_the_cap()).with_observer(&mut observer);
    let planned = PsoPath::new(PathSearch::paper())
        .plan_path(&mut run, &problem)
        .unwrap();
    assert_eq!(
        (planned.stats.evaluations, planned.stats.generations),
        (15_000, 100)
    );
    assert_eq!(planned.violation, 0.0);
    assert!(least_clearance_m(&problem, &planned.best) >= 0.0);
    let expected = planned.best.length_m() / 10_000.0;
    assert!((planned.cost - expected).abs() < 1e-9);
    assert!(history.len() == 100 && history.iter().all(|entry| entry.0 == 150));
    for pair in history.windows(2) {
        assert!((pair[1].1, pair[1].2) <= (pair[0].1, pair[0].2));
    }
    assert!(
        planned
            .best
            .curve()
            .is_some_and(|curve| curve.control_points().len() == 8)
    );
}

#[test]
fn everything_malformed_is_named() {
    let vehicle = Vehicle {
        speed_mps: 0.0,
        ..Vehicle::paper()
    };
    let regions = [Region::ball(Point3::new(f64::NAN, 0.0, 0.0), -1.0)];
    let problem = PathProblem {
        regions: &regions,
        ..PathProblem::new(Point3::origin(), Point3::new(1e300, 0.0, 0.0), &vehicle)
    };
    let search = PathSearch::Swarm(SwarmSettings {
        samples: 1,
        ..SwarmSettings::paper()
    });
    let mut run = Run::new(Seed(1), Budget::to_the_cap());
    let Err(PlanError::Invalid(violations)) = PsoPath::new(search).plan_path(&mut run, &problem)
    else {
        panic!("accepted")
    };
    let text = violations.to_string();
    for place in [
        "target",
        "vehicle.speed_mps",
        "regions[0]",
        "settings.samples",
    ] {
        assert!(text.contains(place), "{place} missing in {text}");
    }
}

#[test]
fn from_the_target_to_itself_is_a_point() {
    let vehicle = Vehicle::paper();
    let mut region = Region::ball(Point3::origin(), 10.0);
    region.obstacle = ObstacleId(3);
    let regions = [region];
    let problem = PathProblem::new(Point3::origin(), Point3::origin(), &vehicle);
    let planned = plan(PathSearch::default(), &problem, Budget::to_the_cap());
    assert_eq!((planned.best.duration_s(), planned.violation), (0.0, 0.0));
    let covered = PathProblem {
        regions: &regions,
        ..problem
    };
    let planned = plan(PathSearch::default(), &covered, Budget::to_the_cap());
    assert!(planned.violation > 0.0 && planned.blocked_by == Some(ObstacleId(3)));
}

#[test]
fn passes_the_conformance_kit() {
    let quick_paper = PathSearch::Swarm(SwarmSettings {
        particles: 24,
        iterations: 25,
        ..SwarmSettings::paper()
    });
    for search in [PathSearch::default(), quick_paper] {
        let on = |threads| PsoPath::new(search).with_workers(Workers::new(threads).unwrap());
        if let Err(failures) = auv_verify::conformance::path_planner(&on(1)) {
            panic!("{failures}");
        }
        auv_verify::conformance::paths_on_threads(&[&on(1), &on(2), &on(8)]).unwrap();
    }
}
