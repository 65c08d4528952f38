//! A vehicle with a turn radius and a pitch limit leaves with a velocity for targets near and far, level and
//! deep: against a bound that no path beats.

use crate::plan;
use auv_planning::{Budget, PathProblem, Vehicle};
use auv_pso_path::PathSearch;
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed, Vector3, libm};
use auv_verify::verify_trajectory;
use std::f64::consts::{FRAC_PI_2, TAU};

/// The length of the shortest level curve to a place from the origin, that is left to the north: a turn
/// and a straight, or two turns.
fn level_bound_m(radius_m: f64, north_m: f64, east_m: f64) -> f64 {
    let turn = |side: f64, angle: f64| {
        let turn = (side * angle).rem_euclid(TAU);
        radius_m * if turn > TAU - 1e-9 { 0.0 } else { turn }
    };
    let mut best_m = f64::INFINITY;
    for side in [1.0, -1.0] {
        let (x, y) = (north_m, east_m - side * radius_m);
        let (apart_m, bearing) = (libm::hypot(x, y), libm::atan2(y, x));
        if apart_m >= radius_m {
            let straight_m = (apart_m * apart_m - radius_m * radius_m).sqrt();
            let heading = bearing + side * libm::atan2(radius_m, straight_m);
            best_m = best_m.min(turn(side, heading) + straight_m);
        }
        let cosine = (3.0 * radius_m * radius_m + apart_m * apart_m) / (4.0 * radius_m * apart_m);
        for bend in [1.0, -1.0].into_iter().filter(|_| cosine <= 1.0) {
            let (sin, cos) = libm::sincos(bearing + bend * libm::acos(cosine));
            let swap = libm::atan2(sin, cos) + side * FRAC_PI_2;
            let (x, y) = (x - 2.0 * radius_m * cos, y - 2.0 * radius_m * sin);
            let end = libm::atan2(y, x) - side * FRAC_PI_2;
            best_m = best_m.min(turn(side, swap) + turn(-side, end - swap));
        }
    }
    best_m
}

#[test]
fn turns_and_climbs_are_near_their_bound() {
    let vehicle = Vehicle::default();
    let (mut level, mut deep) = (Vec::new(), Vec::new());
    for round in 0..120 {
        let mut random = Seed(31).stream(round);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let across_m = 40.0 * libm::exp(draw(0.0, 2.4));
        let (bearing, heading) = (draw(0.0, TAU), draw(0.0, TAU));
        let deep_m = across_m * draw(0.0, 0.25).max(draw(-0.3, 0.8));
        let dive_m = if round % 2 == 0 {
            0.0
        } else {
            deep_m.min(100.0)
        };
        let (east, north) = libm::sincos(bearing + heading);
        let (east_mps, north_mps) = libm::sincos(heading);
        let problem = PathProblem {
            start_velocity: Some(Vector3::new(north_mps, east_mps, 0.0) * 1.5),
            bounds: Some(Bounds::new(
                Point3::new(-1_500.0, -1_500.0, 2.0),
                Point3::new(1_500.0, 1_500.0, 120.0),
            )),
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 10.0),
                Point3::new(across_m * north, across_m * east, 10.0 + dive_m),
                &vehicle,
            )
        };
        let planned = plan(PathSearch::default(), &problem, Budget::evaluations(200));
        assert_eq!(planned.violation, 0.0, "round {round}");
        assert!(verify_trajectory(&problem, &planned.best).is_valid());
        let (y, x) = libm::sincos(bearing);
        let level_m = level_bound_m(vehicle.turn_radius_m, across_m * x, across_m * y);
        let steep_m = dive_m / libm::sin(vehicle.max_pitch_rad);
        let bound_m = libm::hypot(level_m, dive_m).max(steep_m);
        let gap = planned.best.length_m() / bound_m - 1.0;
        if round % 2 == 0 {
            &mut level
        } else {
            &mut deep
        }
        .push(gap);
    }
    level.sort_by(f64::total_cmp);
    deep.sort_by(f64::total_cmp);
    let (middle, worst) = (level[30], level[59]);
    assert!(middle < 5e-4 && worst < 3e-3, "level {middle} {worst}");
    // A few dives are too steep for a straight way and too flat for a turn.
    let (middle, most) = (deep[30], deep[57]);
    assert!(middle < 0.02 && most < 0.2, "deep {middle} {most}");
}
