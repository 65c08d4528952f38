//! Claims about the tracker: consistency, coverage of the regions, association, robustness.

use super::*;
use crate::random::{normal, normal_vector};
use crate::truth::{Class, FieldSettings, Obstacle, ObstacleField};
use crate::{Sonar, TimedPoint};
use auv_types::rand::RngExt;
use auv_types::{Seed, Vector3, libm};

fn still(_: &Point3<f64>, _: f64) -> Vector3<f64> {
    Vector3::zeros()
}

fn echo(position: Point3<f64>, radius_m: f64) -> Detection {
    Detection {
        position,
        velocity: None,
        radius_m,
        position_sigma_m: 1.0,
        velocity_sigma_mps: 0.0,
        radius_sigma_m: 1.0,
    }
}

fn scan(time_s: f64, detections: Vec<Detection>) -> Scan {
    Scan {
        time_s,
        from: Point3::origin(),
        heading_rad: 0.0,
        detections,
    }
}

/// Share of `draws` single obstacles of a class whose truth `ahead_s` after the last of `scans`
/// scans satisfies `holds(region, centre, radius, track)`.
fn share(
    class: Class,
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
        let moves = matches!(class, Class::Moving | Class::Drifting);
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
fn matched(class: Class, sigmas: f64, ahead_s: f64) -> TrackerSettings {
    let moves = matches!(class, Class::Moving | Class::Drifting);
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
fn positions_lie_in_their_region_as_often_as_nominal() {
    let wide = sigmas_in_space(0.99);
    for class in Class::ALL {
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

/// Whole regions hold whole obstacles more often than 99 %: position and radius are bounded each at
/// 99 % and added up, class 2 stands at its clip bound, and growth counts until it is disproved.
#[test]
fn campaign_regions_bound_the_truth_of_every_class() {
    for class in Class::ALL {
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
fn regions_do_not_swallow_the_sea() {
    for (class, most_m) in [
        (Class::Static, 35.0),
        (Class::Moving, 35.0),
        (Class::Uncertain, 110.0),
        (Class::Drifting, 70.0),
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

/// Mean normalised estimation error and innovation squared over runs with misses and clutter.
fn consistency(settings: &TrackerSettings, accelerate: bool) -> (f64, f64, f64) {
    let (mut nees, mut nis, mut count, mut lost) = (0.0, 0.0, 0.0, 0.0);
    let runs = 300;
    for run in 0..runs {
        let mut random = Seed(run).stream(7);
        let mut position = Point3::new(60.0, 0.0, 20.0);
        let mut velocity = normal_vector(&mut random) * 0.4;
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let q = settings.acceleration_density();
        let mut id = None;
        for step in 0..120 {
            let dt_s = 0.5;
            // Exact draw of the white-acceleration model.
            let (a, b) = (normal_vector(&mut random), normal_vector(&mut random));
            let push = if accelerate {
                a * (q * dt_s).sqrt()
            } else {
                Vector3::zeros()
            };
            let wander = if accelerate {
                b * (q * dt_s * dt_s * dt_s / 12.0).sqrt()
            } else {
                Vector3::zeros()
            };
            position += velocity * dt_s + push * (0.5 * dt_s) + wander;
            velocity += push;
            let mut echoes = Vec::new();
            let hit = random.random::<f64>() < 0.9 || step < 3;
            if hit {
                echoes.push(echo(position + normal_vector(&mut random), 5.0));
            }
            for _ in 0..2 {
                let far = Vector3::new(
                    random.random_range(-90.0..90.0),
                    random.random_range(-90.0..90.0),
                    0.0,
                );
                echoes.push(echo(Point3::from(far), 1.0));
            }
            let time_s = f64::from(step) * dt_s;
            let mut sweep = scan(time_s, echoes);
            sweep.from = position;
            let before = id
                .and_then(|id| tracker.tracks().iter().find(|t| t.id() == id))
                .cloned();
            tracker.observe(&sweep);
            if step == 0 {
                id = tracker.tracks().first().map(Track::id);
            }
            let Some(track) = tracker.tracks().iter().find(|t| Some(t.id()) == id) else {
                continue;
            };
            if step < 30 || track.seen_s() < time_s || !hit {
                continue;
            }
            if let Some(mut before) = before {
                before.predict(time_s, settings);
                nis += before.distance_squared(&sweep.detections[0]).0;
            }
            let [pp, pv, vv] = track.covariance();
            let (dp, dv) = (position - track.position(), velocity - track.velocity());
            let det = pp * vv - pv * pv;
            nees +=
                (vv * dp.norm_squared() - 2.0 * pv * dp.dot(&dv) + pp * dv.norm_squared()) / det;
            count += 1.0;
        }
        let kept = tracker
            .tracks()
            .iter()
            .any(|t| Some(t.id()) == id && t.is_confirmed());
        lost += f64::from(u8::from(!kept));
    }
    (nees / count, nis / count, lost / runs as f64)
}

#[test]
fn errors_are_as_large_as_the_filter_says_on_straight_and_manoeuvring_targets() {
    // 300 runs of 90 scans. Innovations are white: the 95 % band of their mean square (3 degrees of
    // freedom, some 24,000 samples) is 3 +- 0.031. Estimation errors are correlated over some ten
    // scans: the band of theirs (6 degrees) is 6 +- 0.14, and +- 0.4 without acceleration, where
    // a run's errors never renew themselves.
    let wide = TrackerSettings {
        gate_probability: 0.9999,
        rest_hypothesis: false,
        ..TrackerSettings::default()
    };
    let (nees, nis, lost) = consistency(&wide, true);
    assert!((nees - 6.0).abs() < 0.14, "NEES {nees}");
    assert!((nis - 3.0).abs() < 0.031, "NIS {nis}");
    assert_eq!(lost, 0.0, "share of runs that lost their target");
    let steady = TrackerSettings {
        acceleration_mps2: 0.0,
        ..wide
    };
    let (nees, nis, lost) = consistency(&steady, false);
    assert!((nees - 6.0).abs() < 0.4, "NEES {nees}");
    assert!((nis - 3.0).abs() < 0.031, "NIS {nis}");
    assert_eq!(lost, 0.0, "share of runs that lost their target");
}

#[test]
fn a_sharp_turn_is_followed_and_bounded_again_within_four_scans() {
    let mut field_position = Point3::new(200.0, 0.0, 50.0);
    let mut velocity = Vector3::new(0.5, 0.0, 0.0);
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let sonar = Sonar::paper();
    let mut random = Seed(3).stream(0);
    let mut bounded = Vec::new();
    for step in 0..60 {
        if step == 40 {
            velocity = -velocity;
        }
        field_position += velocity * 10.0;
        let mut truth = Region::ball(field_position, 30.0);
        truth.velocity_mps = velocity;
        truth.at_s = f64::from(step) * 10.0;
        let scan = sonar.scan(&[truth], &Point3::origin(), 0.0, truth.at_s, &mut random);
        tracker.observe(&scan);
        let ahead_s = truth.at_s + 100.0;
        let holds = tracker.at(truth.at_s).iter().any(|r| {
            r.exists_at(ahead_s)
                && (r.centre_at(ahead_s) - truth.centre_at(ahead_s)).norm() + 30.0
                    <= r.radius_at(ahead_s)
        });
        bounded.push(holds);
    }
    assert!(bounded[..40].iter().all(|b| *b));
    assert!(bounded[44..].iter().all(|b| *b), "{bounded:?}");
    assert!(tracker.tracks().len() <= 2);
}

#[test]
fn two_contacts_that_pass_each_other_keep_their_names() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let (sonar, mut random) = (Sonar::paper(), Seed(11).stream(0));
    let mut names = Vec::new();
    for step in 0..80 {
        let t = f64::from(step) * 10.0;
        let mut truth = [
            Region::ball(Point3::new(300.0, -160.0 + 0.4 * t, 50.0), 20.0),
            Region::ball(Point3::new(330.0, 160.0 - 0.4 * t, 50.0), 20.0),
        ];
        truth[0].velocity_mps.y = 0.4;
        truth[1].velocity_mps.y = -0.4;
        for region in &mut truth {
            region.at_s = t;
        }
        tracker.observe(&sonar.scan(&truth, &Point3::origin(), 0.0, t, &mut random));
        let nearest = |r: &Region| {
            let gap = |track: &Track| (track.position() - r.centre).norm();
            tracker
                .tracks()
                .iter()
                .min_by(|a, b| gap(a).total_cmp(&gap(b)))
                .unwrap()
                .id()
        };
        names.push([nearest(&truth[0]), nearest(&truth[1])]);
    }
    assert_ne!(names[5][0], names[5][1]);
    assert_eq!(names[5], names[79]);
}

#[test]
fn three_of_five_echoes_confirm_and_two_do_not() {
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let here = |dx: f64| echo(Point3::new(50.0 + dx, 0.0, 0.0), 2.0);
    let pattern = [true, false, true, false, true];
    for (k, hit) in pattern.into_iter().enumerate() {
        assert!(
            tracker.at(0.5 * k as f64).is_empty(),
            "confirmed before scan {k}"
        );
        let echoes = if hit {
            vec![here(0.1 * k as f64)]
        } else {
            Vec::new()
        };
        tracker.observe(&scan(0.5 * k as f64, echoes));
    }
    assert!(!tracker.at(2.0).is_empty());
    let mut ghost = Tracker::new(TrackerSettings::default()).unwrap();
    for k in 0..8 {
        let echoes = if k < 2 {
            vec![here(0.1 * f64::from(k))]
        } else {
            Vec::new()
        };
        ghost.observe(&scan(0.5 * f64::from(k), echoes));
        assert!(ghost.at(4.0).is_empty());
    }
    assert!(
        ghost.tracks().is_empty(),
        "a ghost is gone after its window"
    );
}

#[test]
fn an_unseen_track_coasts_with_a_growing_region_and_is_forgotten_at_last() {
    let settings = TrackerSettings::campaign();
    let mut tracker = Tracker::new(settings.clone()).unwrap();
    for k in 0..20 {
        let t = f64::from(k) * 10.0;
        let mut seen = echo(
            Point3::new(400.0 + 0.3 * t + 0.01 * libm::sin(t), 0.0, 0.0),
            20.0,
        );
        seen.velocity = Some(Vector3::new(0.3, 0.0, 0.0));
        seen.velocity_sigma_mps = 0.05;
        tracker.observe(&scan(t, vec![seen]));
    }
    let radius = |tracker: &Tracker, t: f64| tracker.at(t).first().map(|r| r.radius_at(t));
    let mut last = 0.0;
    for k in 20..70 {
        let t = f64::from(k) * 10.0;
        tracker.observe(&scan(t, Vec::new()));
        let now = radius(&tracker, t).unwrap();
        assert!(now > last, "at {t} s: {now} after {last}");
        last = now;
    }
    let centre = tracker.at(690.0)[0].centre_at(690.0);
    assert!((centre.x - 607.0).abs() < 10.0, "{centre}");
    for k in 70..90 {
        tracker.observe(&scan(f64::from(k) * 10.0, Vec::new()));
    }
    assert!(
        tracker.tracks().is_empty(),
        "forgotten after {} s",
        settings.forget_after_s
    );
}

#[test]
fn a_track_in_plain_sight_that_is_missed_is_dropped_but_not_at_once() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let at = |t: f64| echo(Point3::new(200.0, 0.001 * t, 0.0), 20.0);
    let elsewhere = |t: f64| echo(Point3::new(-400.0, 0.001 * t, 0.0), 20.0);
    for k in 0..10 {
        let t = f64::from(k) * 10.0;
        tracker.observe(&scan(t, vec![at(t), elsewhere(t)]));
    }
    let mut left = Vec::new();
    for k in 10..20 {
        let t = f64::from(k) * 10.0;
        tracker.observe(&scan(t, vec![elsewhere(t)]));
        left.push(tracker.tracks().len());
    }
    assert_eq!(left[0], 2, "one miss is not the end");
    assert_eq!(left[9], 1);
}

#[test]
fn useless_data_is_rejected_counted_and_changes_nothing() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    for k in 0..5 {
        let t = f64::from(k) * 10.0;
        tracker.observe(&scan(
            t,
            vec![echo(Point3::new(200.0, 0.01 * t, 0.0), 20.0)],
        ));
    }
    let before = tracker.clone();
    tracker.observe(&scan(40.0, vec![echo(Point3::new(1.0, 0.0, 0.0), 9.0)]));
    tracker.observe(&scan(25.0, vec![echo(Point3::new(1.0, 0.0, 0.0), 9.0)]));
    tracker.observe(&scan(f64::NAN, Vec::new()));
    assert_eq!(tracker.rejected().stale_scans, 3);
    tracker.observe(&scan(50.0, vec![echo(Point3::new(200.0, 0.4, 0.0), 20.0)]));
    assert_eq!(tracker.rejected().stuck_scans, 1);
    assert_eq!(
        (tracker.tracks(), tracker.at(40.0)),
        (before.tracks(), before.at(40.0))
    );

    let good = echo(Point3::new(200.0, 0.5, 0.0), 20.0);
    let bad = [
        Detection {
            position: Point3::new(f64::NAN, 0.0, 0.0),
            ..good
        },
        Detection {
            radius_m: f64::INFINITY,
            ..good
        },
        Detection {
            radius_m: -1.0,
            ..good
        },
        Detection {
            position_sigma_m: 0.0,
            ..good
        },
        Detection {
            position_sigma_m: -1.0,
            ..good
        },
        Detection {
            velocity: Some(Vector3::new(f64::NAN, 0.0, 0.0)),
            ..good
        },
        Detection {
            position: Point3::new(1e6, 0.0, 0.0),
            ..good
        },
    ];
    tracker.observe(&scan(60.0, bad.to_vec()));
    assert_eq!(
        (tracker.rejected().malformed, tracker.rejected().implausible),
        (6, 1)
    );
    assert_eq!(tracker.tracks().len(), 1);
    assert!(
        tracker
            .at(60.0)
            .iter()
            .all(|r| r.radius_m.is_finite() && r.centre.x.is_finite())
    );
}

#[test]
fn a_storm_of_echoes_leaves_the_nearest() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let storm = (0..10_000).map(|i| {
        let angle = f64::from(i) * 0.618;
        let range = 50.0 + 0.09 * f64::from(i);
        echo(
            Point3::new(range * libm::cos(angle), range * libm::sin(angle), 0.0),
            5.0,
        )
    });
    tracker.observe(&scan(0.0, storm.collect()));
    assert_eq!(tracker.tracks().len(), 100);
    assert_eq!(tracker.rejected().beyond_capacity, 9000 + 900);
    let farthest = tracker
        .tracks()
        .iter()
        .map(|t| t.position().coords.norm())
        .fold(0.0, f64::max);
    assert!(farthest < 60.0, "{farthest}");
}

#[test]
fn echoes_of_charted_obstacles_found_no_tracks() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    let rock = Region::ball(Point3::new(300.0, 0.0, 50.0), 60.0);
    tracker.charted(vec![rock]);
    let (sonar, mut random) = (Sonar::paper(), Seed(2).stream(0));
    for k in 0..500 {
        tracker.observe(&sonar.scan(
            &[rock],
            &Point3::origin(),
            0.0,
            f64::from(k) * 10.0,
            &mut random,
        ));
    }
    assert!(tracker.tracks().is_empty());
    assert_eq!(tracker.at(0.0), vec![rock]);
    let near = Region::ball(Point3::new(300.0, 90.0, 50.0), 30.0);
    tracker.observe(&sonar.scan(&[rock, near], &Point3::origin(), 0.0, 6000.0, &mut random));
    assert_eq!(
        tracker.tracks().len(),
        1,
        "what stands beside it is tracked"
    );
}

#[test]
fn gear_at_rest_seen_by_the_forward_sonar_is_recognised_bounded_and_kept() {
    let (sonar, settings) = (Sonar::default(), TrackerSettings::default());
    let mut wrong = 0;
    for seed in 0..40 {
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let mut random = Seed(seed).stream(0);
        let gear = Region::cylinder(Point3::new(95.0, 6.0, 0.0), 5.0, 0.0, 60.0);
        let mut from = Point3::new(0.0, 0.0, 20.0);
        for k in 0..140 {
            from.x = 0.75 * f64::from(k);
            tracker.observe(&sonar.scan(&[gear], &from, 0.0, 0.5 * f64::from(k), &mut random));
            if k == 80 {
                let holds = tracker.at(40.0).iter().any(|r| {
                    r.exists_at(70.0)
                        && (r.centre_at(70.0).xy() - gear.centre.xy()).norm() + 5.0
                            <= r.radius_at(70.0)
                        && r.radius_at(70.0) < 25.0
                });
                wrong += usize::from(!holds);
            }
        }
        // Long past: out of sight, still on the map, no wider.
        for k in 140..600 {
            from.x = 0.75 * f64::from(k);
            tracker.observe(&sonar.scan(&[], &from, 0.0, 0.5 * f64::from(k), &mut random));
        }
        let kept = tracker.at(300.0).iter().any(|r| {
            let offset_m = (r.centre.xy() - gear.centre.xy()).norm();
            offset_m + 5.0 <= r.radius_at(1e5) && r.exists_at(1e5) && r.radius_at(1e5) < 20.0
        });
        wrong += usize::from(!kept);
    }
    assert!(wrong <= 1, "{wrong} of 80");
}

#[test]
fn the_near_face_of_a_farm_too_large_to_be_seen_whole_is_bounded() {
    let (sonar, settings) = (Sonar::default(), TrackerSettings::default());
    let farm = Region::cylinder(Point3::new(260.0, 20.0, 0.0), 150.0, 0.0, 40.0);
    let (mut open, mut looks) = (0, 0);
    for seed in 0..40 {
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let mut random = Seed(seed).stream(0);
        for k in 0..100 {
            let (time_s, from) = (
                0.5 * f64::from(k),
                Point3::new(0.75 * f64::from(k), 0.0, 20.0),
            );
            tracker.observe(&sonar.scan(&[farm], &from, 0.0, time_s, &mut random));
            let gap_m = farm.distance_m(&TimedPoint::new(from, time_s));
            if gap_m > 60.0 {
                continue;
            }
            // A metre behind the face, straight ahead.
            let towards = (farm.centre.xy() - from.xy()).normalize() * (gap_m + 1.0);
            let face =
                TimedPoint::new(from + Vector3::new(towards.x, towards.y, 0.0), time_s + 5.0);
            looks += 1;
            open += usize::from(
                !tracker
                    .at(time_s)
                    .iter()
                    .any(|r| r.distance_m(&face) <= 0.0),
            );
        }
    }
    assert!(
        looks > 1000 && open * 100 < looks,
        "open in {open} of {looks} looks"
    );
}

/// Share of predictions that hold a contact which the forward sonar follows at 1.5 m/s.
#[test]
fn moving_contacts_ahead_of_the_forward_sonar_are_bounded() {
    let (sonar, settings) = (Sonar::default(), TrackerSettings::default());
    let (mut held, mut looks, mut radius) = (0.0, 0.0, 0.0);
    for seed in 0..200 {
        let mut tracker = Tracker::new(settings.clone()).unwrap();
        let mut random = Seed(seed).stream(0);
        let mut boat = Region::ball(Point3::new(80.0, 0.0, 20.0), 3.0);
        boat.velocity_mps = normal_vector(&mut random) * 0.3;
        boat.velocity_mps.z = 0.0;
        for k in 0..60 {
            boat.at_s = 0.5 * f64::from(k);
            let from = Point3::new(0.5 * boat.at_s, 0.0, 20.0);
            tracker.observe(&sonar.scan(&[boat], &from, 0.0, boat.at_s, &mut random));
            if k >= 20 {
                let at_s = boat.at_s + 15.0;
                let bound = tracker.at(boat.at_s).into_iter().find(|r| {
                    let offset = (r.centre_at(at_s) - boat.centre_at(at_s)).xy().norm();
                    r.exists_at(at_s) && offset + 3.0 <= r.radius_at(at_s)
                });
                looks += 1.0;
                held += f64::from(u8::from(bound.is_some()));
                radius += bound.map_or(0.0, |r| r.radius_at(at_s));
            }
            boat.centre += boat.velocity_mps * 0.5;
        }
    }
    assert!(held / looks > 0.99, "{} of {looks}", held / looks);
    assert!(
        radius / held < 20.0,
        "regions of {} m on average",
        radius / held
    );
}

#[test]
fn equal_scans_give_equal_bits() {
    let run = || {
        let mut random = Seed(5).stream(0);
        let obstacles = (0..12).map(|i| {
            let place = Point3::new(
                random.random_range(-800.0..800.0),
                random.random_range(-800.0..800.0),
                50.0,
            );
            Obstacle::new(Class::ALL[i % 4], place, 30.0)
        });
        let mut field =
            ObstacleField::new(obstacles.collect(), FieldSettings::campaign(), Seed(6)).unwrap();
        let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
        for _ in 0..60 {
            field.step(10.0, &still);
            tracker.observe(&Sonar::paper().scan(
                field.now(),
                &Point3::origin(),
                0.0,
                field.time_s(),
                &mut random,
            ));
        }
        tracker
    };
    assert_eq!(run(), run());
}

#[cfg(feature = "serde")]
#[test]
fn a_checkpointed_tracker_goes_on_bit_for_bit() {
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    tracker.charted(vec![Region::cylinder(
        Point3::new(80.0, 0.0, 0.0),
        5.0,
        f64::NEG_INFINITY,
        30.0,
    )]);
    let mut random = Seed(1).stream(0);
    let gear = Region::cylinder(Point3::new(60.0, 6.0, 0.0), 5.0, 0.0, 60.0);
    let mut sweep =
        |t: f64| Sonar::default().scan(&[gear], &Point3::new(0.0, 0.0, 20.0), 0.0, t, &mut random);
    for k in 0..20 {
        tracker.observe(&sweep(f64::from(k) * 0.5));
    }
    let text = serde_json::to_string(&tracker).unwrap();
    let mut restored: Tracker = serde_json::from_str(&text).unwrap();
    assert_eq!(restored, tracker);
    let next = sweep(10.0);
    tracker.observe(&next);
    restored.observe(&next);
    assert_eq!(restored.at(10.0), tracker.at(10.0));
}
