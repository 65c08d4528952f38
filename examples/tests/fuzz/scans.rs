//! The tracker at extreme scans: its predictions stay finite, and few.

use crate::cases::each_case;
use crate::mutation::odd;
use auv_obstacles::{Detection, ObstaclePredictor, Scan, Tracker, TrackerSettings};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Vector3};

fn number(random: &mut ChaCha8Rng, usual: std::ops::Range<f64>) -> f64 {
    if random.random_range(0..10) == 0 {
        odd(random)
    } else {
        random.random_range(usual)
    }
}

fn vector(random: &mut ChaCha8Rng, span: f64) -> Vector3<f64> {
    Vector3::new(
        number(random, -span..span),
        number(random, -span..span),
        number(random, -span..span),
    )
}

fn scan(random: &mut ChaCha8Rng, time_s: f64) -> Scan {
    let count = if random.random_range(0..40) == 0 {
        300
    } else {
        4
    };
    let detections = (0..random.random_range(0..=count)).map(|_| Detection {
        position: Point3::from(vector(random, 150.0)),
        velocity: random.random::<bool>().then(|| vector(random, 1.0)),
        radius_m: number(random, 1.0..30.0),
        position_sigma_m: number(random, 0.1..5.0),
        velocity_sigma_mps: number(random, 0.01..0.5),
        radius_sigma_m: number(random, 0.1..3.0),
    });
    Scan {
        detections: detections.collect(),
        time_s,
        from: Point3::from(vector(random, 5.0)),
        heading_rad: number(random, -3.0..3.0),
        background: random.random::<bool>().then(|| random.random()),
    }
}

#[test]
fn extreme_scans() {
    each_case(800, |random| {
        let mut tracker = Tracker::new(TrackerSettings::default()).unwrap();
        let mut time_s = 0.0;
        for _ in 0..30 {
            time_s += number(random, 1.0..10.0);
            if !time_s.is_finite() || time_s.abs() > 1e9 {
                time_s = 0.0;
            }
            tracker.unsure_of_place(number(random, 0.0..20.0));
            tracker.observe(&scan(random, time_s));
            if random.random_range(0..10) == 0 {
                tracker.moved(&vector(random, 30.0));
            }
            let predicted = tracker.at(time_s);
            assert!(predicted.len() < 20_000, "{}", predicted.len());
            for region in &predicted {
                let mut violations = auv_types::Violations::new();
                region.validate_into("predicted.", &mut violations);
                assert!(violations.is_empty(), "{violations} {region:?}");
            }
        }
    });
}
