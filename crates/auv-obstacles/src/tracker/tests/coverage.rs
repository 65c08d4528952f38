//! Claims about predicted regions: they bound the truth with the nominal probability.

use super::*;

/// Share of `draws` single obstacles of a class whose truth `ahead_s` after the last of `scans`
/// scans satisfies `holds(region, centre, radius, track)`.
fn share(
    class: ObstacleClass,
    draws: u64,
    scans: usize,
    ahead_s: f64,
    settings: &TrackerSettings,
    holds: &dyn Fn(&Region, &Region, &Track, f64) -> bool,
) -> f64 {
    let sonar = Sonar::paper();
    let mut held = 0_u64;
    for draw in 0..draws {
        let mut random = Seed(draw).stream(99);
        let radius_m = (100.0 * normal(&mut random).abs()).clamp(10.0, 250.0);
        let speed = random.random_range(0.0..0.5);
        let direction = normal_vector(&mut random).normalize();
        let moves = matches!(class, ObstacleClass::Moving | ObstacleClass::Drifting);
        let obstacle = Obstacle::new(class, Point3::new(300.0, 0.0, 50.0), radius_m)
            .with_velocity(direction * if moves { speed } else { 0.0 });
        let water = Vector3::new(0.3 * normal(&mut random), 0.0, 0.0);
        let current = |_: &Point3<f64>, _: f64| water;
        let mut field =
            ObstacleField::new(vec![obstacle], FieldSettings::campaign(), Seed(draw)).unwrap();
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        for _ in 0..scans {
            field.step(10.0, &current);
            let from = field.now()[0].centre + Vector3::new(300.0, 0.0, 0.0);
            tracker.observe(&sonar.scan(field.now(), &from, 0.0, field.time_s(), &mut random));
        }
        let regions = tracker.at(field.time_s());
        let track = tracker
            .tracks()
            .iter()
            .max_by(|a, b| a.seen_s().total_cmp(&b.seen_s()).then(b.id().cmp(&a.id())))
            .unwrap();
        let until_s = field.time_s() + ahead_s;
        while field.time_s() < until_s {
            field.step(10.0, &current);
        }
        let truth = field.now()[0];
        let here = |r: &&Region| r.obstacle == track.id() && r.exists_at(until_s);
        let region = regions.iter().rev().find(here).unwrap();
        held += u64::from(holds(region, &truth, track, until_s));
    }
    held as f64 / draws as f64
}

/// Settings whose position model is exactly the class's, with one region that ends at `ahead_s`.
fn matched(class: ObstacleClass, sigmas: f64, ahead_s: f64) -> TrackerSettings {
    let moves = matches!(class, ObstacleClass::Moving | ObstacleClass::Drifting);
    TrackerSettings {
        jitter_m2ps: if moves { 0.1 * 0.1 * 10.0 / 3.0 } else { 0.0 },
        gate_probability: 0.999_999,
        position_sigmas: sigmas,
        radius_sigmas: 0.0,
        fluctuation_sigmas: 0.0,
        horizon_s: ahead_s,
        max_spans: 1,
        ..TrackerSettings::campaign()
    }
}

/// The position of every class is Gaussian (jitter: a sum of uniforms), so k standard deviations
/// hold it as often as the chi-square distribution says.
#[test]
fn positions_lie_in_their_region_with_the_nominal_probability() {
    let wide = sigmas_in_space(0.99);
    for class in ObstacleClass::ALL {
        let settings = matched(class, wide, 100.0);
        let within_two = std::cell::Cell::new(0_u32);
        let within_wide = share(
            class,
            10_000,
            12,
            100.0,
            &settings,
            &|region, truth, track, at_s| {
                let radius_m = track.size.bound(false, &settings).at(100.0).min(250.0);
                let sigma_m = (region.radius_at(at_s) - radius_m) / wide;
                let error_m = (region.centre_at(at_s) - truth.centre_at(at_s)).norm();
                within_two.set(within_two.get() + u32::from(error_m <= 2.0 * sigma_m));
                error_m <= wide * sigma_m
            },
        );
        let within_two = f64::from(within_two.get()) / 10_000.0;
        assert!(
            (within_two - 0.7385).abs() < 0.01,
            "{class:?}: {within_two} for k = 2"
        );
        assert!(
            (within_wide - 0.99).abs() < 0.01,
            "{class:?}: {within_wide} for k = {wide}"
        );
    }
}

/// Regions contain whole obstacles with a probability above 99 %: the bounds of position and radius, 99 %
/// each, add up, class 2 counts with its clip bound, and growth counts until it is disproved.
#[test]
fn campaign_regions_bound_the_truth_of_every_class() {
    for class in ObstacleClass::ALL {
        for (scans, ahead_s, draws) in [
            (1, 30.0, 4000),
            (10, 100.0, 2000),
            (30, 300.0, 2000),
            (30, 1000.0, 500),
        ] {
            let settings = TrackerSettings::campaign();
            let found = share(
                class,
                draws,
                scans,
                ahead_s,
                &settings,
                &|region, truth, _, at_s| {
                    let offset_m = (region.centre_at(at_s) - truth.centre_at(at_s)).norm();
                    offset_m + truth.radius_m <= region.radius_at(at_s)
                },
            );
            assert!(
                found >= 0.99,
                "{class:?} after {scans} scans, {ahead_s} s ahead: {found}"
            );
        }
    }
}

#[test]
fn regions_stay_of_moderate_size() {
    for (class, most_m) in [
        (ObstacleClass::Static, 35.0),
        (ObstacleClass::Moving, 35.0),
        (ObstacleClass::Uncertain, 110.0),
        (ObstacleClass::Drifting, 70.0),
    ] {
        let excess = std::cell::Cell::new(0.0);
        let settings = TrackerSettings::campaign();
        share(
            class,
            300,
            30,
            100.0,
            &settings,
            &|region, truth, _, at_s| {
                excess.set(excess.get() + (region.radius_at(at_s) - truth.radius_m) / 300.0);
                true
            },
        );
        assert!(
            excess.get() < most_m,
            "{class:?}: {} m on average",
            excess.get()
        );
    }
}
