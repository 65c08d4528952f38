//! Fixed-seed missions, to the bit: what the synchroniser decides, commands and records.

use crate::world::{Detours, Routes, World};
use auv_mission::driver::Stepped;
use auv_mission::{
    ComputeCharge, Event, Observation, ReplanPolicy, SyncSettings, Synchroniser, WithoutSonar,
};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed, Vector3};
use serde_json::{Value, json};

/// FNV-1a of numbers, by their bits.
struct Hash(u64);

impl Hash {
    fn take(&mut self, values: impl IntoIterator<Item = f64>) {
        for byte in values
            .into_iter()
            .flat_map(|value| value.to_bits().to_le_bytes())
        {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01B3);
        }
    }
}

/// What happens to a mission besides time.
#[derive(Clone, Copy, Debug)]
enum Trouble {
    None,
    /// The vehicle is found off its trajectory now and then.
    CarriedOff,
    /// Now and then the sonar is silent for long; the vehicle goes home.
    Deaf,
    /// Late in the mission the bed is near.
    Shallow,
    /// Legs are projected late, computing is charged.
    Projected,
}

const TROUBLES: [Trouble; 5] = [
    Trouble::None,
    Trouble::CarriedOff,
    Trouble::Deaf,
    Trouble::Shallow,
    Trouble::Projected,
];

fn settings(world: &World, trouble: Trouble) -> SyncSettings {
    let mut settings = world.settings.clone();
    match trouble {
        Trouble::Deaf => settings.watchdogs.without_sonar = WithoutSonar::GoHome,
        Trouble::Projected => {
            settings.replan.policy = ReplanPolicy::Projected;
            settings.planning.compute = ComputeCharge::Fixed {
                route_s: 3.0,
                path_s: 1.0,
            };
        }
        Trouble::None | Trouble::CarriedOff | Trouble::Shallow => {}
    }
    settings
}

fn disturb(trouble: Trouble, random: &mut ChaCha8Rng, seen: &mut Observation) -> Option<Event> {
    match trouble {
        Trouble::CarriedOff if random.random_bool(0.15) => {
            let mut off = || random.random_range(-30.0..30.0);
            seen.position += Vector3::new(off(), off(), 0.0);
            None
        }
        Trouble::Deaf if random.random_bool(0.02) => Some(Event::SonarSilent { age_s: 300.0 }),
        Trouble::Shallow if seen.time_s > 400.0 => Some(Event::AltitudeMeasured {
            altitude_m: random.random_range(0.0..60.0),
        }),
        _ => None,
    }
}

fn fly(seed: u64, trouble: Trouble) -> Value {
    let mut world = World::new(seed);
    if matches!(trouble, Trouble::Shallow) {
        let mut mission = (*world.mission).clone();
        mission.min_altitude_m = 2.0;
        world.mission = mission.into();
    }
    world.settings = settings(&world, trouble);
    let mut synchroniser = world.synchroniser();
    let driver = Stepped::new(&Routes, &Detours);
    let mut random = Seed(seed).stream(3);
    let mut followed = Hash(0xCBF2_9CE4_8422_2325);
    let mut time_s = 0.0;
    while synchroniser.outcome().is_none() && time_s < 50_000.0 {
        let mut seen = world.observe(&synchroniser, time_s);
        let event = disturb(trouble, &mut random, &mut seen);
        let events = event.into_iter().chain([Event::Tick(seen)]);
        for event in events {
            let orders = driver.tell(&mut synchroniser, event);
            let points = orders.follow.iter().flat_map(|way| way.points());
            for point in points {
                followed.take(point.position.iter().copied().chain([point.time_s]));
            }
        }
        time_s = world.next_s(&synchroniser, time_s);
    }
    summary(&synchroniser, followed)
}

fn summary(synchroniser: &Synchroniser, followed: Hash) -> Value {
    let mut rows = Hash(0xCBF2_9CE4_8422_2325);
    for call in synchroniser.route_calls() {
        rows.take([call.at_s, call.route_weight, call.mission_weight, call.cost]);
        rows.take([call.available_s, call.route_s, call.reason as u8 as f64]);
        rows.take([f64::from(call.valid), f64::from(call.adopted)]);
        rows.take(call.route.iter().map(|node| f64::from(node.0)));
    }
    for call in synchroniser.path_calls() {
        rows.take([call.at_s, call.violation, call.cost, call.leg_s]);
        rows.take([call.expected_s, call.available_s, call.waited_s]);
        rows.take([call.replan, call.next_leg, call.completed].map(f64::from));
        rows.take([call.from.0, call.to.0, call.replanned_paths].map(f64::from));
    }
    json!({
        "outcome": format!("{:?}", synchroniser.outcome()),
        "contingency": format!("{:?}", synchroniser.contingency()),
        "visited": synchroniser.visited().iter().map(|node| node.0).collect::<Vec<_>>(),
        "tasks": synchroniser.tasks(),
        "weight": synchroniser.weight(),
        "available_s": synchroniser.available_s(),
        "rows": format!("{:016x}", rows.0),
        "followed": format!("{:016x}", followed.0),
        "calls": [synchroniser.route_calls().len(), synchroniser.path_calls().len()],
    })
}

#[test]
fn fixed_seed_missions_are_flown_as_recorded() {
    for trouble in TROUBLES {
        let missions: Vec<Value> = (0..40).map(|seed| fly(seed, trouble)).collect();
        let name = format!("missions_{trouble:?}").to_lowercase();
        auv_golden::check(env!("CARGO_MANIFEST_DIR"), &name, &json!(missions)).unwrap();
    }
}
