//! Claims about the tracker: consistency, coverage of the regions, association, robustness.

mod association;
mod consistency;
mod coverage;
mod fast;
mod forward_sonar;

use super::*;
use crate::random::{normal, normal_vector};
use crate::truth::{FieldSettings, Obstacle, ObstacleClass, ObstacleField};
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
        background: None,
        detections,
    }
}

#[test]
fn invalid_data_are_rejected_counted_and_change_nothing() {
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
            position: Point3::new(1e6, 0.0, 0.0),
            ..good
        },
    ];
    let before = tracker.clone();
    tracker.observe(&scan(60.0, bad.to_vec()));
    let rejected = tracker.rejected();
    assert_eq!((rejected.malformed, rejected.implausible), (3, 1));
    assert_eq!(rejected.blind_scans, 1);
    // A scan without a usable echo is not a fresh scan.
    assert_eq!(tracker.fresh_s(), before.fresh_s());
    assert_eq!(tracker.tracks(), before.tracks());
    assert!(
        tracker
            .at(60.0)
            .iter()
            .all(|r| r.radius_m.is_finite() && r.centre.x.is_finite())
    );
}

#[test]
fn mad_echoes_are_counted_and_not_used() {
    let nominal = Detection {
        position_sigma_m: 1.0,
        radius_sigma_m: 0.5,
        ..echo(Point3::new(60.0, 0.0, 20.0), 5.0)
    };
    let sizes = [1e4, 1e5, 1e7].map(|radius_m| Detection {
        radius_m,
        ..nominal
    });
    let sigmas = [50.0, 1e3, 1e6].map(|sigma_m| Detection {
        position_sigma_m: sigma_m,
        ..nominal
    });
    let vague = [50.0, 1e6].map(|sigma_m| Detection {
        radius_sigma_m: sigma_m,
        ..nominal
    });
    let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
    let mut count = 0_u32;
    for mad in sizes.iter().chain(&sigmas).chain(&vague) {
        for k in 0..10 {
            let offset = Vector3::new(0.01 * f64::from(k), 0.0, 0.0);
            let mad = Detection {
                position: mad.position + offset,
                ..*mad
            };
            tracker.observe(&scan(f64::from(count), vec![mad]));
            count += 1;
        }
    }
    assert_eq!(tracker.rejected().implausible, u64::from(count));
    assert!(tracker.tracks().is_empty());
}

#[test]
fn a_valid_position_is_used_with_any_errors() {
    let good = echo(Point3::new(200.0, 0.0, 0.0), 20.0);
    let odd = [
        Detection {
            position_sigma_m: 0.0,
            ..good
        },
        Detection {
            position_sigma_m: f64::NAN,
            ..good
        },
        Detection {
            radius_sigma_m: f64::NEG_INFINITY,
            ..good
        },
        Detection {
            velocity: Some(Vector3::new(f64::NAN, 0.0, 0.0)),
            ..good
        },
    ];
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    for k in 0..8_u32 {
        tracker.observe(&scan(f64::from(k), vec![odd[k as usize % 4]]));
    }
    assert_eq!(tracker.rejected().mended, 8);
    assert_eq!(tracker.tracks().len(), 1);
    for region in tracker.at(8.0) {
        assert!(region.centre.iter().all(|x| x.is_finite()) && region.radius_m.is_finite());
        assert!((region.centre_at(8.0) - good.position).norm() < 10.0);
    }
}

#[test]
fn a_repeated_background_reveals_a_frozen_sonar_in_an_empty_sea() {
    let mut tracker = Tracker::new(TrackerSettings::campaign()).unwrap();
    for (k, background) in [None, None, Some(0.3), Some(0.4), Some(0.4), Some(0.4)]
        .into_iter()
        .enumerate()
    {
        let time_s = 10.0 * k as f64;
        tracker.observe(&Scan {
            background,
            ..scan(time_s, Vec::new())
        });
    }
    assert_eq!(tracker.rejected().stuck_scans, 2);
    assert_eq!(tracker.fresh_s(), Some(30.0));
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
            Obstacle::new(ObstacleClass::ALL[i % 4], place, 30.0)
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
fn a_checkpointed_tracker_continues_bit_for_bit() {
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
