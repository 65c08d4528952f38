//! Claims about the true obstacles: moments, continuity, reflections, determinism.

use super::birth::truncated_normal;
use super::*;
use crate::{ObstacleId, Region, RegionShape, TimedPoint};
use auv_types::rand::RngExt;
use auv_types::{Bounds, Point3, Seed, Vector3, libm};

fn still(_: &Point3<f64>, _: f64) -> Vector3<f64> {
    Vector3::zeros()
}

fn phi(z: f64) -> f64 {
    0.5 * libm::erfc(-z / std::f64::consts::SQRT_2)
}

/// `count` equal obstacles, each with its own stream.
fn crowd(class: ObstacleClass, count: usize, radius_m: f64) -> ObstacleField {
    let one = Obstacle::new(class, Point3::origin(), radius_m);
    ObstacleField::new(vec![one; count], FieldSettings::paper(), Seed(5)).unwrap()
}

fn moments(values: &[f64]) -> (f64, f64) {
    let n = values.len() as f64;
    let mean = values.iter().sum::<f64>() / n;
    let variance = values.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / n;
    (mean, variance)
}

#[test]
fn truncated_normal_follows_its_distribution() {
    // Kolmogorov-Smirnov at 0.1 %: 1.95 / sqrt(n); both sampling branches.
    for (case, sigma) in [0.3, 0.9, 1.1, 8.0].into_iter().enumerate() {
        let mut random = Seed(3).stream(case as u64);
        let n = 20_000;
        let mut draws: Vec<f64> = (0..n)
            .map(|_| truncated_normal(sigma, 4.0, 6.0, &mut random))
            .collect();
        draws.sort_by(f64::total_cmp);
        let (low, high) = (phi(-1.0 / sigma), phi(1.0 / sigma));
        let worst = draws
            .iter()
            .enumerate()
            .map(|(i, x)| {
                let expected = (phi((x - 5.0) / sigma) - low) / (high - low);
                (expected - (i as f64 + 0.5) / f64::from(n)).abs()
            })
            .fold(0.0, f64::max);
        assert!(worst < 1.95 / f64::from(n).sqrt(), "sigma {sigma}: {worst}");
    }
}

#[test]
fn jitter_has_the_paper_s_variance_and_does_not_depend_on_the_step() {
    for dt_s in [10.0, 0.5, 2.5] {
        let mut field = crowd(ObstacleClass::Moving, 3000, 20.0);
        for _ in 0..(40.0 / dt_s) as usize {
            field.step(dt_s, &still);
        }
        let north: Vec<f64> = field.now().iter().map(|r| r.centre.x).collect();
        let (mean, variance) = moments(&north);
        // Four steps of U(-1 m, 1 m): variance 4/3.
        assert!(
            mean.abs() < 4.0 * (4.0_f64 / 3.0 / 3000.0).sqrt(),
            "dt {dt_s}: mean {mean}"
        );
        assert!(
            (variance - 4.0 / 3.0).abs() < 0.14,
            "dt {dt_s}: variance {variance}"
        );
    }
}

#[test]
fn drifters_grow_as_equation_5_says_whatever_the_step() {
    let current = |_: &Point3<f64>, _: f64| Vector3::new(0.0, 0.2, 0.0);
    for dt_s in [10.0, 0.5] {
        let mut field = crowd(ObstacleClass::Drifting, 3000, 100.0);
        for _ in 0..(100.0 / dt_s) as usize {
            field.step(dt_s, &current);
        }
        let radii: Vec<f64> = field.now().iter().map(|r| r.radius_m).collect();
        let (mean, variance) = moments(&radii);
        // r = 100 + 0.2 integral of g, g a walk of variance 0.01 a step from 1; |h| has mean 2 and
        // the final walk's variance 0.1, correlated with the integral.
        assert!((mean - 122.0).abs() < 0.6, "dt {dt_s}: mean {mean}");
        let (walk, integral, cross) = (
            0.1,
            0.04 * 100.0 * 100.0 * 0.1 / 3.0,
            0.2 * 100.0 * 0.1 / 2.0,
        );
        let expected = walk + integral + 2.0 * cross;
        assert!(
            (variance / expected - 1.0).abs() < 0.25,
            "dt {dt_s}: {variance} for {expected}"
        );
        let east: Vec<f64> = field.now().iter().map(|r| r.centre.y).collect();
        assert!(
            (moments(&east).0 - 20.0).abs() < 0.2,
            "it drifts with the current"
        );
    }
}

#[test]
fn a_fluctuating_radius_is_clipped_and_constant_within_a_step() {
    let mut field = crowd(ObstacleClass::Uncertain, 5000, 100.0);
    let mut fine = crowd(ObstacleClass::Uncertain, 5000, 100.0);
    field.step(10.0, &still);
    field.step(10.0, &still);
    for step in 0..40 {
        fine.step(0.5, &still);
        assert!(fine.regions().iter().all(|r| r.growth_mps == 0.0));
        if step >= 20 {
            assert_eq!(fine.now()[17].radius_m, field.now()[17].radius_m);
        }
    }
    let radii: Vec<f64> = field.now().iter().map(|r| r.radius_m).collect();
    let (mean, variance) = moments(&radii);
    assert!(
        (mean - 100.0).abs() < 1.2 && (variance - 395.0).abs() < 40.0,
        "{mean} {variance}"
    );
    assert!(radii.iter().all(|r| (10.0..=160.0).contains(r)));
}

#[test]
fn regions_of_consecutive_steps_are_continuous_and_end_at_the_present() {
    let mut field = mission(40).build(Seed(9)).unwrap();
    let current = |_: &Point3<f64>, _: f64| Vector3::new(0.3, 0.1, 0.0);
    for _ in 0..50 {
        let before = field.now().to_vec();
        field.step(10.0, &current);
        let t = field.time_s();
        for ((was, over), is) in before.iter().zip(field.regions()).zip(field.now()) {
            assert_eq!((over.from_s, over.until_s), (t - 10.0, t));
            assert!((over.centre_at(t - 10.0) - was.centre).norm() < 1e-9);
            assert!((over.centre_at(t) - is.centre).norm() < 1e-9);
            assert!((over.radius_at(t) - is.radius_m).abs() < 1e-9);
        }
    }
}

fn mission(count: usize) -> MissionObstacles {
    let mut random = Seed(77).stream(0);
    let mut place = || {
        Point3::new(
            random.random_range(0.0..10_000.0),
            random.random_range(0.0..10_000.0),
            random.random_range(0.0..100.0),
        )
    };
    let waypoints: Vec<Point3<f64>> = (0..50).map(|_| place()).collect();
    let layer = Bounds::new(Point3::origin(), Point3::new(10_000.0, 10_000.0, 100.0));
    let (start, dock) = (waypoints[0], waypoints[49]);
    MissionObstacles::campaign(count, layer, waypoints, start, dock)
}

#[test]
fn a_mission_s_obstacles_keep_start_destination_and_waypoints_free() {
    let mission = mission(200);
    let mut field = mission.build(Seed(4)).unwrap();
    assert_eq!(field.now().len(), 200, "all found a place");
    for place in &mission.waypoints {
        assert!(field.distance_m(place) >= 300.0 - 1e-9);
    }
    assert!(field.distance_m(&mission.start) >= 1000.0 - 1e-9);
    let shares = ObstacleClass::ALL.map(|class| {
        (0..200)
            .filter(|&i| field.class(ObstacleId(i)) == Some(class))
            .count()
    });
    assert_eq!(shares, [50; 4]);
    let current = |_: &Point3<f64>, _: f64| Vector3::new(0.4, 0.3, 0.0);
    let mut pushed = false;
    for _ in 0..1100 {
        field.step(10.0, &current);
        for place in [&mission.start, &mission.dock] {
            let (from, to) = (
                TimedPoint::new(*place, field.time_s() - 10.0),
                TimedPoint::new(*place, field.time_s()),
            );
            let least = |r: &Region| r.clearance(&from, &to).clearance_m;
            let nearest = field
                .regions()
                .iter()
                .map(least)
                .fold(f64::INFINITY, f64::min);
            assert!(nearest > 299.9, "{nearest} m at {} s", field.time_s());
            pushed |= nearest < 300.0 + 1e-6;
        }
    }
    assert!(pushed, "the run never tried the keep-out balls");
}

#[test]
fn a_moving_obstacle_is_reflected_by_a_keep_out_ball() {
    let mut settings = FieldSettings::paper();
    settings.jitter_mps = 0.0;
    settings.keep_out.push(KeepOut {
        centre: Point3::origin(),
        radius_m: 300.0,
    });
    let mover = Obstacle::new(ObstacleClass::Moving, Point3::new(400.0, 0.0, 0.0), 50.0)
        .with_velocity(Vector3::new(-0.5, 0.2, 0.0));
    let mut field = ObstacleField::new(vec![mover], settings, Seed(1)).unwrap();
    for _ in 0..60 {
        field.step(10.0, &still);
    }
    let after = field.now()[0];
    assert!(after.velocity_mps.x > 0.0 && after.centre.coords.norm() > 350.0);
    assert!((after.velocity_mps.norm() - mover.velocity_mps.norm()).abs() < 1e-12);
}

#[test]
fn a_drifting_obstacle_at_a_keep_out_ball_reports_its_actual_velocity() {
    let mut settings = FieldSettings::paper();
    settings.jitter_mps = 0.0;
    settings.keep_out.push(KeepOut {
        centre: Point3::origin(),
        radius_m: 300.0,
    });
    let drifter = Obstacle::new(ObstacleClass::Drifting, Point3::new(420.0, 30.0, 0.0), 50.0);
    let water = Vector3::new(-0.5, 0.0, 0.0);
    let mut field = ObstacleField::new(vec![drifter], settings, Seed(1)).unwrap();
    let mut held = 0;
    for _ in 0..100 {
        let before = field.now()[0].centre;
        field.step(10.0, &|_, _| water);
        let now = field.now()[0];
        let moved_mps = (now.centre - before) / 10.0;
        // A step that ends at the ball may begin in free water, and the ball is curved.
        if now.velocity_mps != water && moved_mps.norm() < 0.45 {
            held += 1;
            let tangential_mps = moved_mps.dot(&now.velocity_mps.normalize());
            assert!((tangential_mps - now.velocity_mps.norm()).abs() < 0.03);
        }
    }
    assert!(held > 20, "{held}");
}

#[test]
fn count_for_density_gives_that_density() {
    let mut mission = mission(0);
    let legs: Vec<_> = mission.waypoints.windows(2).map(|w| (w[0], w[1])).collect();
    mission.count = mission.count_for_density(&legs, 4.5, 500.0, Seed(1));
    assert!((20..400).contains(&mission.count), "{}", mission.count);
    let mut near = 0_usize;
    for seed in 0..20 {
        let obstacles = mission.generate(Seed(seed));
        for (from, to) in &legs {
            let (begin, end) = (TimedPoint::new(*from, 0.0), TimedPoint::new(*to, 1.0));
            near += obstacles
                .iter()
                .filter(|o| {
                    Region::ball(o.centre, o.radius_m)
                        .clearance(&begin, &end)
                        .clearance_m
                        <= 500.0
                })
                .count();
        }
    }
    let mean = near as f64 / (20 * legs.len()) as f64;
    assert!((mean - 4.5).abs() < 0.5, "{mean} a leg");
}

#[test]
fn a_leg_s_obstacles_leave_its_waypoints_free() {
    let (from, to) = (
        Point3::new(0.0, 0.0, 20.0),
        Point3::new(3000.0, 1500.0, 60.0),
    );
    for scenario in [
        LegScenario::Fixed,
        LegScenario::Moving,
        LegScenario::Drifting,
        LegScenario::Mixed,
    ] {
        for seed in 0..20 {
            let leg = LegObstacles {
                scenario,
                count: 6,
                from,
                to,
                speed_mps: 3.0,
                current_mps: Vector3::new(0.1, -0.1, 0.0),
                birth: Birth::single_leg(),
            };
            let obstacles = leg.generate(Seed(seed));
            assert_eq!(obstacles.len(), 6, "{scenario:?} {seed}");
            for o in &obstacles {
                let gap = (o.centre - from).norm().min((o.centre - to).norm()) - o.radius_m;
                assert!(gap >= 10.0 && o.radius_m >= 10.0);
            }
            let late = obstacles.iter().filter(|o| o.appears_s > 0.0).count();
            assert_eq!(
                late,
                if scenario == LegScenario::Moving {
                    3
                } else {
                    0
                }
            );
        }
    }
}

#[test]
fn equal_seeds_give_equal_bits_and_different_seeds_do_not() {
    let run = |seed| {
        let mut field = mission(40).build(Seed(seed)).unwrap();
        for _ in 0..30 {
            field.step(10.0, &|_, _| Vector3::new(0.2, 0.0, 0.0));
        }
        field.regions().to_vec()
    };
    assert_eq!(run(1), run(1));
    assert_ne!(run(1), run(2));
}

#[test]
fn an_obstacle_s_motion_does_not_depend_on_the_others() {
    let a = Obstacle::new(ObstacleClass::Drifting, Point3::origin(), 30.0);
    let others = [ObstacleClass::Moving, ObstacleClass::Uncertain]
        .map(|c| Obstacle::new(c, Point3::origin(), 60.0));
    let mut alone = ObstacleField::new(vec![a], FieldSettings::paper(), Seed(8)).unwrap();
    let mut among = ObstacleField::new(
        vec![a, others[0], others[1]],
        FieldSettings::paper(),
        Seed(8),
    )
    .unwrap();
    for _ in 0..20 {
        alone.step(10.0, &|_, _| Vector3::new(0.2, 0.0, 0.0));
        among.step(10.0, &|_, _| Vector3::new(0.2, 0.0, 0.0));
    }
    assert_eq!(alone.now()[0], among.now()[0]);
}

#[test]
fn invalid_steps_and_currents_change_nothing() {
    let mut field = crowd(ObstacleClass::Drifting, 2, 20.0);
    for dt_s in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        field.step(dt_s, &still);
    }
    assert_eq!(field.time_s(), 0.0);
    field.step(10.0, &|_, _| Vector3::new(f64::NAN, 0.0, 0.0));
    assert!(
        field
            .now()
            .iter()
            .all(|r| r.centre.iter().all(|x| x.is_finite()))
    );
    assert!(
        ObstacleField::new(
            vec![Obstacle::new(
                ObstacleClass::Static,
                Point3::new(f64::NAN, 0.0, 0.0),
                -1.0
            )],
            FieldSettings::paper(),
            Seed(0)
        )
        .is_err()
    );
}

fn ship(after: AfterLastFix) -> TrackedShip {
    let fix = |time_s, north_m, east_m| ShipFix {
        time_s,
        north_m,
        east_m,
    };
    TrackedShip::new(
        vec![
            fix(60.0, 0.0, 0.0),
            fix(160.0, 500.0, 0.0),
            fix(220.0, 500.0, 300.0),
        ],
        90.0,
        6.8,
        after,
    )
    .unwrap()
}

#[test]
fn ships_never_jump_and_their_regions_cover_every_time() {
    for after in [
        AfterLastFix::Repeat,
        AfterLastFix::HoldCourse,
        AfterLastFix::Leave,
    ] {
        let ship = ship(after);
        let place = |t: f64| ship.region_at(ObstacleId(0), t).map(|r| r.centre_at(t));
        let mut last = place(0.0);
        for step in 1..4000 {
            let t = f64::from(step) * 0.25;
            let here = place(t);
            if let (Some(a), Some(b)) = (last, here) {
                assert!(
                    (b - a).norm() <= 5.0 * 0.25 + 1e-9,
                    "{after:?} jumps at {t}"
                );
            } else {
                assert_eq!(after, AfterLastFix::Leave);
                assert!(here.is_none() && t >= 220.0);
            }
            last = here;
        }
        let mut regions = Vec::new();
        ship.regions_into(ObstacleId(0), 0.0, 900.0, &mut regions);
        for step in 0..3600 {
            let t = f64::from(step) * 0.25;
            let Some(here) = place(t) else { continue };
            let covering = regions.iter().find(|r| r.exists_at(t)).unwrap();
            assert!(
                (covering.centre_at(t) - here).norm() < 1e-6,
                "{after:?} at {t}"
            );
            assert_eq!(covering.radius_m, 45.0);
            assert!(
                matches!(covering.shape, RegionShape::Cylinder { bottom_m, .. } if bottom_m == 6.8)
            );
        }
    }
    let held = ship(AfterLastFix::HoldCourse)
        .region_at(ObstacleId(0), 1000.0)
        .unwrap();
    assert!((held.centre.y - (300.0 + 5.0 * 780.0)).abs() < 1e-6);
    let mut field =
        crowd(ObstacleClass::Static, 1, 10.0).with_ships(vec![ship(AfterLastFix::Repeat)]);
    for _ in 0..200 {
        field.step(10.0, &still);
        assert!(field.regions().iter().any(|r| r.obstacle == ObstacleId(1)));
    }
}
