//! A mission can be stopped after any event, saved, resumed, and continues with the same decisions.

use crate::world::{Detours, Routes, World};
use auv_mission::{Checkpoint, Command, Event, ResumeError, Synchroniser};
use auv_planning::{PathPlanner, RoutePlanner, Run};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed};
use serde_json::Value;
use std::sync::Arc;

fn answer(command: &Command) -> Option<Event> {
    match command {
        Command::PlanRoute(request) => {
            let mut run = Run::new(request.seed, request.budget);
            Some(Event::RoutePlanned {
                request: request.id,
                result: Routes.plan_route(&mut run, &request.problem()),
                compute_s: 0.0,
            })
        }
        Command::PlanPath(request) => {
            let mut run = Run::new(request.seed, request.budget);
            Some(Event::PathPlanned {
                request: request.id,
                result: Detours.plan_path(&mut run, &request.problem()),
                compute_s: 0.0,
            })
        }
        _ => None,
    }
}

/// Flies on to the end (at most `ticks`); after each event `after` may exchange the synchroniser.
fn fly(
    world: &World,
    synchroniser: &mut Synchroniser,
    ticks: usize,
    mut after: impl FnMut(&mut Synchroniser) -> bool,
) {
    let mut time_s = 0.0;
    for _ in 0..ticks {
        let mut event = Some(Event::Tick(world.observe(synchroniser, time_s)));
        while let Some(next) = event {
            let mut commands = synchroniser.step(next);
            if after(synchroniser) {
                commands = synchroniser.outstanding().into_iter().collect();
            }
            event = commands.iter().find_map(answer);
        }
        if synchroniser.outcome().is_some() {
            return;
        }
        time_s = world.next_s(synchroniser, time_s);
    }
}

fn reload(synchroniser: &Synchroniser) -> Synchroniser {
    let text = synchroniser.save().to_text().unwrap();
    let checkpoint = Checkpoint::from_text(&text).unwrap();
    Synchroniser::resume(Arc::clone(synchroniser.mission()), checkpoint).unwrap()
}

#[test]
fn resumes_after_any_event_with_the_same_decisions() {
    let mut cuts = 0;
    for seed in 0..50 {
        let world = World::new(seed);
        let mut whole = world.synchroniser();
        let mut events = 0;
        fly(&world, &mut whole, 2_000, |_| {
            events += 1;
            false
        });
        assert!(whole.outcome().is_some(), "mission {seed}");
        let whole = whole.save().to_text().unwrap();
        let mut random = Seed(seed).stream(1);
        for _ in 0..10 {
            let cut_after = random.random_range(0..events);
            let mut part = world.synchroniser();
            let mut event = 0;
            fly(&world, &mut part, 2_000, |synchroniser| {
                let now = event == cut_after;
                event += 1;
                if now {
                    *synchroniser = reload(synchroniser);
                }
                now
            });
            assert_eq!(
                part.save().to_text().unwrap(),
                whole,
                "mission {seed}, event {cut_after}"
            );
            cuts += 1;
        }
    }
    assert_eq!(cuts, 500);
}

/// A checkpoint from the middle of each of a few missions.
fn in_the_middle(seed: u64) -> (World, Synchroniser) {
    let world = World::new(seed);
    let mut synchroniser = world.synchroniser();
    fly(&world, &mut synchroniser, 12, |_| false);
    assert_eq!(synchroniser.outcome(), None);
    (world, synchroniser)
}

#[test]
fn a_damaged_text_is_refused() {
    let (_, synchroniser) = in_the_middle(1);
    let text = synchroniser.save().to_text().unwrap();
    let mut random = Seed(3).stream(0);
    for _ in 0..10_000 {
        let mut bytes = text.clone().into_bytes();
        for _ in 0..random.random_range(1..4) {
            let at = random.random_range(0..bytes.len());
            match random.random_range(0..4) {
                0 | 1 => bytes[at] ^= 1 << random.random_range(0..8),
                2 => bytes.truncate(at.max(1)),
                _ => {
                    bytes.remove(at);
                }
            }
            if bytes.len() < 2 {
                break;
            }
        }
        let Ok(damaged) = String::from_utf8(bytes) else {
            continue;
        };
        match Checkpoint::from_text(&damaged) {
            Ok(checkpoint) => assert_eq!(checkpoint, synchroniser.save()),
            Err(error) => assert!(!error.to_string().is_empty()),
        }
    }
}

/// Changes one number somewhere below a value, each branch as likely as its siblings.
fn change(value: &mut Value, random: &mut ChaCha8Rng) {
    match value {
        Value::Array(list) if !list.is_empty() => {
            let at = random.random_range(0..list.len());
            change(&mut list[at], random);
        }
        Value::Object(fields) if !fields.is_empty() => {
            let at = random.random_range(0..fields.len());
            fields
                .values_mut()
                .nth(at)
                .into_iter()
                .for_each(|v| change(v, random));
        }
        Value::Number(number) => {
            let others = [-1.0, 0.5, 1e9, 1e300, number.as_f64().unwrap() * 1.01];
            let whole = [0_u64, 1, 8, 9, 10, 63, u64::from(u32::MAX)];
            *value = if random.random() {
                others[random.random_range(0..others.len())].into()
            } else {
                whole[random.random_range(0..whole.len())].into()
            };
        }
        _ => {}
    }
}

/// Without the checksum: what passes the checks flies on without a panic.
#[test]
fn a_changed_state_is_refused_or_flown() {
    let (mut refused, mut flown) = (0, 0);
    for seed in 0..4 {
        let (world, synchroniser) = in_the_middle(seed);
        let whole = serde_json::to_value(synchroniser.save()).unwrap();
        let mut random = Seed(seed).stream(9);
        for _ in 0..500 {
            let mut changed = whole.clone();
            change(&mut changed["state"], &mut random);
            let Ok(checkpoint) = serde_json::from_value::<Checkpoint>(changed) else {
                continue;
            };
            match Synchroniser::resume(Arc::clone(&world.mission), checkpoint) {
                Err(_) => refused += 1,
                Ok(mut resumed) => {
                    flown += 1;
                    let mut time_s = synchroniser.due_s();
                    let mut event = resumed.outstanding().as_ref().and_then(answer);
                    for _ in 0..15 {
                        while let Some(next) = event {
                            event = resumed.step(next).iter().find_map(answer);
                        }
                        event = Some(Event::Tick(world.observe(&resumed, time_s)));
                        time_s += 30.0;
                    }
                }
            }
        }
    }
    assert!(
        refused > 200 && flown > 200,
        "{refused} refused, {flown} flown"
    );
}

#[test]
fn another_mission_or_version_is_refused() {
    let (world, synchroniser) = in_the_middle(2);
    let resume = |mission| Synchroniser::resume(Arc::new(mission), synchroniser.save());
    let same = (*world.mission).clone();
    assert!(resume(same.clone()).is_ok());
    let mut others = vec![same.clone(), same.clone(), same.clone(), same];
    others[0].budget_s += 1e-9 * others[0].budget_s;
    others[1].vehicle.turn_radius_m += 1.0;
    others[2].current = Some(Arc::new(auv_ocean::UniformCurrent::new(
        auv_types::Vector3::x() * 0.1,
    )));
    others[3].network = Arc::clone(&World::new(5).mission.network);
    for other in others {
        let error = resume(other).unwrap_err();
        assert!(matches!(error, ResumeError::WrongMission { .. }), "{error}");
    }
    let text = synchroniser.save().to_text().unwrap();
    for found in [1, 3] {
        let other = text.replacen(" 2 ", &format!(" {found} "), 1);
        let refused = Err(ResumeError::Version { found });
        assert_eq!(Checkpoint::from_text(&other), refused);
    }
}
