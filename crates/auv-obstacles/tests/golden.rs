//! Goldens of the truth, the sonar and the tracker at fixed seeds.
#![allow(clippy::unwrap_used, reason = "a test that fails should say where")]

use auv_obstacles::truth::{AfterLastFix, MissionObstacles, ObstacleField, ShipFix, TrackedShip};
use auv_obstacles::{ObstaclePredictor, Region, RegionShape, Sonar, Tracker, TrackerSettings};
use auv_types::{Bounds, Point3, Seed, Vector3, libm};
use serde_json::{Value, json};

/// The numbers of a region: times, centre, velocity, radius, growth, upper and lower end.
fn numbers(region: &Region) -> Value {
    let (top_m, bottom_m) = match region.shape {
        RegionShape::Ball => (f64::NAN, f64::NAN),
        RegionShape::Cylinder { top_m, bottom_m } => (top_m, bottom_m),
    };
    let (c, v) = (region.centre, region.velocity_mps);
    let times = [region.at_s, region.from_s, region.until_s];
    let place = [c.x, c.y, c.z, v.x, v.y, v.z];
    let size = [region.radius_m, region.growth_mps, top_m, bottom_m];
    let shown = times.iter().chain(&place).chain(&size).map(|x| {
        if x.is_finite() {
            json!(x)
        } else {
            json!(x.to_string())
        }
    });
    json!({ "id": region.obstacle.0, "is": shown.collect::<Vec<_>>() })
}

/// FNV-1a over the bits of all regions.
fn hash(regions: &[Region]) -> String {
    let text: String = regions.iter().map(|r| numbers(r).to_string()).collect();
    let hash = text.bytes().fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
}

fn field() -> ObstacleField {
    let layer = Bounds::new(Point3::origin(), Point3::new(3000.0, 3000.0, 100.0));
    let [start, dock] = [
        Point3::new(50.0, 50.0, 30.0),
        Point3::new(2950.0, 2950.0, 60.0),
    ];
    let spread = MissionObstacles::campaign(16, layer, vec![start, dock], start, dock);
    let fix = |time_s, north_m, east_m| ShipFix {
        time_s,
        north_m,
        east_m,
    };
    let fixes = vec![
        fix(0.0, 0.0, 500.0),
        fix(100.0, 500.0, 600.0),
        fix(210.0, 900.0, 1500.0),
    ];
    let ship = TrackedShip::new(fixes, 120.0, 7.0, AfterLastFix::Repeat).unwrap();
    spread.build(Seed(11)).unwrap().with_ships(vec![ship])
}

fn water(place: &Point3<f64>, time_s: f64) -> Vector3<f64> {
    Vector3::new(0.2 + 1e-5 * place.y, 1e-4 * time_s, 0.0)
}

#[test]
fn the_truth_of_every_class_and_of_ships() {
    let mut field = field();
    let mut times = Vec::new();
    for step in 0..60_u32 {
        // Steps of the paper and shorter ones: the scaling of both is covered.
        field.step(if step % 3 == 0 { 10.0 } else { 3.5 }, &water);
        if step % 15 == 14 {
            times.push(json!({
                "time_s": field.time_s(),
                "first": field.now().iter().take(4).map(numbers).collect::<Vec<_>>(),
                "now": hash(field.now()),
                "covered": hash(field.regions()),
            }));
        }
    }
    let class = |region: &Region| format!("{:?}", field.class(region.obstacle));
    let classes: Vec<String> = field.now().iter().map(class).collect();
    let found = json!({ "classes": classes, "times": times });
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "truth", &found).unwrap();
}

/// What is tracked and predicted while a vehicle passes the obstacles.
fn tracked(sonar: &Sonar, settings: TrackerSettings, period_s: f64, scans: u32) -> Value {
    let mut field = field();
    let mut tracker = Tracker::new(settings).unwrap();
    tracker.charted(field.charted());
    let mut random = Seed(4).stream(0);
    let mut samples = Vec::new();
    for scan in 0..scans {
        field.step(period_s, &water);
        let gone_m = 1.5 * field.time_s();
        let from = Point3::new(50.0 + 0.8 * gone_m, 50.0 + 0.6 * gone_m, 40.0);
        let time_s = field.time_s();
        // The sonar looks at the centre of an obstacle, a few degrees to either side of it.
        let aim = field.now()[2].centre - from;
        let heading_rad = libm::atan2(aim.y, aim.x) + 0.02 * f64::from(scan % 7);
        tracker.observe(&sonar.scan(field.now(), &from, heading_rad, time_s, &mut random));
        if (scan + 1) % (scans / 6) == 0 {
            let regions = tracker.contacts(time_s + 2.0);
            samples.push(json!({
                "time_s": time_s,
                "tracks": tracker.tracks().len(),
                "count": regions.len(),
                "first": regions.iter().take(3).map(numbers).collect::<Vec<_>>(),
                "regions": hash(&regions),
            }));
        }
    }
    let rejected = tracker.rejected();
    let counts = [
        rejected.stale_scans,
        rejected.blind_scans,
        rejected.malformed,
        rejected.implausible,
        rejected.beyond_capacity,
    ];
    json!({ "samples": samples, "rejected": counts })
}

#[test]
fn the_tracker_over_a_run_with_the_paper_s_sonar() {
    let found = tracked(&Sonar::paper(), TrackerSettings::campaign(), 10.0, 60);
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "tracker_paper", &found).unwrap();
}

#[test]
fn the_tracker_over_a_run_with_a_forward_looking_sonar() {
    let sonar = Sonar {
        range_m: 900.0,
        sure_range_m: 600.0,
        ..Sonar::default()
    };
    let settings = TrackerSettings {
        sonar: sonar.clone(),
        ..TrackerSettings::default()
    };
    let found = tracked(&sonar, settings, 0.5, 900);
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), "tracker_forward", &found).unwrap();
}
