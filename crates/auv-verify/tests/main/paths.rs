//! Valid and faulty trajectories.

use auv_obstacles::{ObstacleId, Region, RegionShape, TimedPoint};
use auv_ocean::{FlatBed, UniformCurrent};
use auv_planning::{PathProblem, Trajectory, Vehicle, polyline};
use auv_types::{Bounds, Point3, Vector3};
use auv_verify::{PathViolation, RequiredEnds, verify_part, verify_trajectory};
use proptest::prelude::*;

fn at(x: f64, y: f64, z: f64) -> Point3<f64> {
    Point3::new(x, y, z)
}

prop_compose! {
    fn regions()(
        centre in [-60.0..60.0, -60.0..60.0, 0.0..60.0_f64],
        velocity in [-2.0..2.0, -2.0..2.0, -1.0..1.0_f64],
        radius_m in 0.0..40.0_f64, growth_mps in -0.3..3.0_f64, at_s in -20.0..20.0_f64,
        window in (-10.0..40.0_f64, 0.0..60.0_f64), slab in prop::option::of((0.0..30.0_f64, 1.0..30.0_f64)),
    ) -> Region {
        Region {
            obstacle: ObstacleId(4),
            shape: slab.map_or(RegionShape::Ball, |(top_m, height_m)| RegionShape::Cylinder { top_m, bottom_m: top_m + height_m }),
            at_s, from_s: window.0, until_s: window.0 + window.1,
            centre: Point3::from(centre), velocity_mps: Vector3::from(velocity), radius_m, growth_mps,
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 3_000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn clearance_equals_the_planners_closed_form(
        region in regions(), from in [-90.0..0.0, -90.0..0.0, 0.0..60.0_f64], to in [0.0..90.0, -90.0..90.0, 0.0..60.0_f64],
        begin_s in 0.0..5.0_f64, elapsed_s in 1.0..60.0_f64, stays in prop::bool::weighted(0.1),
    ) {
        let from = TimedPoint::new(Point3::from(from), begin_s);
        let end = if stays { from.position } else { Point3::from(to) };
        let to = TimedPoint::new(end, begin_s + elapsed_s);
        let vehicle = Vehicle::paper();
        let regions = [region];
        let problem = PathProblem { regions: &regions, ..PathProblem::new(from.position, end, &vehicle) };
        let line = Trajectory::new(vec![from, to]).unwrap();
        let report = verify_part(&problem, &RequiredEnds::free(), &line);
        let planners_m = region.clearance(&from, &to).clearance_m;
        let ours_m = report.min_clearance_m();
        prop_assert!(ours_m == planners_m || (ours_m - planners_m).abs() < 1e-9, "{} {}", ours_m, planners_m);
        if let Some(closest) = report.closest {
            let there_m = region.distance_m(&TimedPoint::new(closest.place, closest.time_s));
            prop_assert!((there_m - closest.clearance_m).abs() < 1e-9);
        }
    }
}

/// The kinds of violations of a trajectory.
fn kinds(problem: &PathProblem<'_>, points: &[(f64, f64, f64, f64)]) -> Vec<PathViolation> {
    let timed = points
        .iter()
        .map(|&(x, y, z, t)| TimedPoint::new(at(x, y, z), t));
    verify_trajectory(problem, &Trajectory::new(timed.collect()).unwrap()).violations
}

#[test]
fn ends_speed_and_box_are_checked() {
    let vehicle = Vehicle::paper();
    let problem = PathProblem {
        bounds: Some(Bounds::new(at(0.0, -10.0, 0.0), at(300.0, 10.0, 50.0))),
        departure_s: 50.0,
        ..PathProblem::new(at(0.0, 0.0, 5.0), at(300.0, 0.0, 5.0), &vehicle)
    };
    let good = [(0.0, 0.0, 5.0, 50.0), (300.0, 0.0, 5.0, 150.0)];
    assert_eq!(kinds(&problem, &good), []);
    let hover = [
        (0.0, 0.0, 5.0, 50.0),
        (0.0, 0.0, 5.0, 80.0),
        (300.0, 0.0, 5.0, 180.0),
    ];
    assert_eq!(kinds(&problem, &hover), []);
    use PathViolation as V;
    let late = [(0.0, 0.0, 5.0, 51.0), (300.0, 0.0, 5.0, 151.0)];
    assert!(matches!(
        kinds(&problem, &late)[..],
        [V::WrongDeparture { .. }]
    ));
    let short = [(0.0, 0.1, 5.0, 50.0), (299.0, 0.0, 5.0, 150.0)];
    assert!(matches!(
        kinds(&problem, &short)[..],
        [V::WrongStart { .. }, V::WrongTarget { .. }]
    ));
    let fast = [(0.0, 0.0, 5.0, 50.0), (300.0, 0.0, 5.0, 149.9)];
    assert!(matches!(
        kinds(&problem, &fast)[..],
        [V::TooFast { segment: 0, .. }]
    ));
    let wide = [
        (0.0, 0.0, 5.0, 50.0),
        (150.0, 11.0, 5.0, 101.0),
        (300.0, 0.0, 5.0, 152.0),
    ];
    assert!(
        matches!(kinds(&problem, &wide)[..], [V::OutsideBox { point: 1, excess_m }] if excess_m == 1.0)
    );
    assert!(
        verify_part(
            &problem,
            &RequiredEnds::free(),
            &Trajectory::new(vec![TimedPoint::new(at(1.0, 1.0, 1.0), 0.0)]).unwrap()
        )
        .is_valid()
    );
}

#[test]
fn speed_turn_and_pitch_limits_are_checked() {
    let vehicle = Vehicle::default();
    let problem = PathProblem::new(at(0.0, 0.0, 5.0), at(300.0, 0.0, 5.0), &vehicle);
    use PathViolation as V;
    let stop = [
        (0.0, 0.0, 5.0, 0.0),
        (0.0, 0.0, 5.0, 9.0),
        (300.0, 0.0, 5.0, 209.0),
    ];
    assert!(matches!(
        kinds(&problem, &stop)[..],
        [V::TooSlow { segment: 0, .. }]
    ));
    let steep = [(0.0, 0.0, 5.0, 0.0), (300.0, 0.0, 5.0, 200.0)];
    assert_eq!(kinds(&problem, &steep), []);
    let dive = PathProblem {
        target: at(300.0, 0.0, 95.0),
        ..problem
    };
    let steep = [(0.0, 0.0, 5.0, 0.0), (300.0, 0.0, 95.0, 200.0)];
    assert!(matches!(
        kinds(&dive, &steep)[..],
        [V::TooSteep { segment: 0, .. }]
    ));
    let corner = [
        at(0.0, 0.0, 5.0),
        at(150.0, 100.0, 5.0),
        at(300.0, 0.0, 5.0),
    ];
    let sharp = verify_trajectory(&problem, &problem.timed(&corner).unwrap());
    let rounded = problem.timed(&polyline::rounded(&corner, 20.0)).unwrap();
    let report = verify_trajectory(&problem, &rounded);
    assert!(report.is_valid(), "{:?}", report.violations);
    // A corner between long segments has room for a wide arc; between short ones it has none.
    assert!(sharp.is_valid());
    let short = [
        at(0.0, 0.0, 5.0),
        at(8.0, 8.0, 5.0),
        at(16.0, 0.0, 5.0),
        at(300.0, 0.0, 5.0),
    ];
    let report = verify_trajectory(&problem, &problem.timed(&short).unwrap());
    assert!(
        matches!(report.violations[..], [V::TurnsTooTight { .. }]),
        "{report:?}"
    );
    // The rest of a valid trajectory is valid, wherever it is cut.
    for k in 0..400 {
        let rest = rounded.after(f64::from(k) * 0.6137);
        let report = verify_part(
            &problem,
            &RequiredEnds {
                target: Some(problem.target),
                ..RequiredEnds::free()
            },
            &rest,
        );
        assert!(report.is_valid(), "{k} {:?}", report.violations);
    }
}

#[test]
fn the_velocity_at_the_start_must_be_continued() {
    let vehicle = Vehicle::default();
    let problem = PathProblem {
        start_velocity: Some(Vector3::new(0.0, 1.5, 0.0)),
        ..PathProblem::new(at(0.0, 0.0, 5.0), at(30.0, 0.0, 5.0), &vehicle)
    };
    let straight = [(0.0, 0.0, 5.0, 0.0), (30.0, 0.0, 5.0, 20.0)];
    assert!(matches!(
        kinds(&problem, &straight)[..],
        [PathViolation::TurnsTooTight { point: 0, .. }]
    ));
    let ahead = PathProblem {
        start_velocity: Some(Vector3::new(1.4, 0.0, 0.0)),
        ..problem
    };
    assert_eq!(kinds(&ahead, &straight), []);
}

#[test]
fn speed_is_measured_through_the_water() {
    let vehicle = Vehicle::paper();
    let current = UniformCurrent::new(Vector3::new(1.0, 0.0, 0.0));
    let problem = PathProblem {
        current: Some(&current),
        ..PathProblem::new(at(0.0, 0.0, 5.0), at(400.0, 0.0, 5.0), &vehicle)
    };
    let line = problem.timed(&[problem.start, problem.target]).unwrap();
    let report = verify_trajectory(&problem, &line);
    assert!(report.is_valid() && (report.duration_s - 100.0).abs() < 1e-9);
    assert!((report.max_speed_mps - 3.0).abs() < 1e-9 && (report.min_speed_mps - 3.0).abs() < 1e-9);
    let still = PathProblem {
        current: None,
        ..problem
    };
    assert!(!verify_trajectory(&still, &line).is_valid());
}

#[test]
fn altitude_and_obstacles_are_reported_with_place_and_time() {
    let vehicle = Vehicle::paper();
    let bed = FlatBed::new(40.0);
    let mut region = Region::ball(at(150.0, 0.0, 30.0), 10.0);
    region.obstacle = ObstacleId(7);
    let regions = [Region::ball(at(0.0, 500.0, 0.0), 1.0), region];
    let problem = PathProblem {
        sea_bed: Some(&bed),
        min_altitude_m: 12.0,
        regions: &regions,
        ..PathProblem::new(at(0.0, 0.0, 5.0), at(300.0, 0.0, 35.0), &vehicle)
    };
    let line = problem.timed(&[problem.start, problem.target]).unwrap();
    let report = verify_trajectory(&problem, &line);
    let [
        PathViolation::TooLow { altitude_m, .. },
        PathViolation::TooClose { approach, .. },
    ] = report.violations[..]
    else {
        panic!("{:?}", report.violations);
    };
    assert!(altitude_m < 5.5 && report.min_altitude_m == 5.0);
    assert_eq!((approach.obstacle, approach.region), (ObstacleId(7), 1));
    assert!(
        (approach.clearance_m - region.clearance(&line.start(), &line.end()).clearance_m).abs()
            < 1e-9
    );
    assert!(
        report
            .to_owned()
            .violations
            .iter()
            .all(|v| !v.to_string().is_empty())
    );
}
