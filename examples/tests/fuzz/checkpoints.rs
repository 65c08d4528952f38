//! Checkpoints: damaged texts, and data changed and sealed again.

use crate::cases::each_case;
use crate::mutation::{damaged, odd};
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_mission::driver::Stepped;
use auv_mission::{Checkpoint, Mission, Observation, SyncSettings, Synchroniser};
use auv_obstacles::Region;
use auv_planning::Vehicle;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed, Vector3};
use serde_json::{Value, json};
use std::sync::Arc;

fn mission() -> Arc<Mission> {
    let vehicle = Vehicle::default();
    let places = [[0.0, 0.0], [400.0, 100.0], [700.0, -100.0], [1_000.0, 0.0]];
    let waypoints = places.map(|[x, y]| Waypoint::at(Point3::new(x, y, 20.0)));
    let task = Task {
        priority: 6.0,
        risk: 2.0,
        completion_time_s: 60.0,
    };
    let edges = [(0, 1), (1, 2), (2, 3), (0, 3), (1, 3)].map(|(a, b)| Edge::undirected(a, b, task));
    let network = Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap();
    Mission::new(network.into(), NodeId(0), NodeId(3), 3_000.0, vehicle).into()
}

/// Checkpoints along one mission.
fn saved(mission: &Arc<Mission>) -> Vec<(Value, f64)> {
    let settings = SyncSettings::default();
    let mut synchroniser = Synchroniser::new(Arc::clone(mission), settings, Seed(1)).unwrap();
    let driver = Stepped::new(&GreedyRoute, &StraightPath);
    let mut all = Vec::new();
    for k in 0..60 {
        let time_s = 10.0 * f64::from(k);
        let observation = seen(&synchroniser, time_s);
        driver.tick(&mut synchroniser, observation);
        if k % 6 == 0 {
            let data = serde_json::to_value(synchroniser.save()).unwrap();
            all.push((data, time_s));
        }
    }
    all
}

fn seen(synchroniser: &Synchroniser, time_s: f64) -> Observation {
    let start = (Point3::new(0.0, 0.0, 20.0), Vector3::x());
    let (position, velocity) = synchroniser
        .trajectory()
        .map_or(start, |way| way.at(time_s));
    let ahead = Region::ball(position + Vector3::new(150.0, 20.0, 0.0), 30.0);
    Observation {
        time_s,
        position,
        position_sigma_m: 0.0,
        velocity,
        regions: [ahead].into(),
    }
}

#[test]
fn damaged_texts() {
    let mission = mission();
    let texts: Vec<String> = saved(&mission)
        .into_iter()
        .map(|(data, _)| {
            serde_json::from_value::<Checkpoint>(data)
                .unwrap()
                .to_text()
                .unwrap()
        })
        .collect();
    each_case(3_000, |random| {
        let whole = &texts[random.random_range(0..texts.len())];
        let text = damaged(whole, random);
        assert!(
            text == *whole || Checkpoint::from_text(&text).is_err(),
            "{text}"
        );
    });
}

/// Changes one value somewhere in the data.
fn change(value: &mut Value, random: &mut ChaCha8Rng) {
    let leaf = |random: &mut ChaCha8Rng| match random.random_range(0..6) {
        0 => Value::Null,
        1 => json!(random.random::<u64>()),
        2 => json!("x"),
        3 => json!([]),
        _ => json!(odd(random)),
    };
    match value {
        Value::Object(map) if !map.is_empty() => {
            let k = random.random_range(0..map.len());
            if let Some((_, inner)) = map.iter_mut().nth(k) {
                change(inner, random);
            }
        }
        Value::Array(list) if !list.is_empty() => {
            let k = random.random_range(0..list.len());
            match random.random_range(0..6) {
                0 => drop(list.remove(k)),
                1 => list.push(list[k].clone()),
                _ => change(&mut list[k], random),
            }
        }
        other => *other = leaf(random),
    }
}

/// What is changed and sealed again is refused, or flies on.
#[test]
fn changed_data() {
    let mission = mission();
    let whole = saved(&mission);
    let driver = Stepped::new(&GreedyRoute, &StraightPath);
    each_case(1_500, |random| {
        let (mut data, time_s) = whole[random.random_range(0..whole.len())].clone();
        for _ in 0..random.random_range(1..4) {
            change(&mut data, random);
        }
        let Ok(checkpoint) = serde_json::from_value::<Checkpoint>(data) else {
            return;
        };
        let Ok(mut synchroniser) = Synchroniser::resume(Arc::clone(&mission), checkpoint) else {
            return;
        };
        driver.carry_on(&mut synchroniser);
        for k in 1..12 {
            let observation = seen(&synchroniser, time_s + 20.0 * f64::from(k));
            driver.tick(&mut synchroniser, observation);
        }
        let again = Checkpoint::from_text(&synchroniser.save().to_text().unwrap()).unwrap();
        Synchroniser::resume(Arc::clone(&mission), again).unwrap();
    });
}
