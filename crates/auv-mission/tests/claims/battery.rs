//! Energy limits a mission as time does.

use crate::world::{Detours, Routes, World};
use auv_mission::driver::Stepped;
use auv_mission::{Battery, Event, Outcome, Synchroniser};
use std::sync::Arc;

/// 50 W of hotel load and, at cruising speed, 50 W of propulsion.
fn battery(world: &World, usable_j: f64) -> Battery {
    Battery {
        usable_j,
        hotel_w: 50.0,
        propulsion_j_per_m: 50.0 / world.mission.vehicle.speed_mps,
    }
}

/// Flies a mission; returns it and the energy a meter shows at the end. At the first tick from
/// `drop_s` on, half of what is left is lost.
fn fly(world: &World, drop_s: Option<f64>) -> (Synchroniser, f64) {
    let mut synchroniser = world.synchroniser();
    let driver = Stepped::new(&Routes, &Detours);
    let meter = battery(world, 1.0);
    let (mut time_s, mut used_j, mut lost) = (0.0, 0.0, false);
    loop {
        let observation = world.observe(&synchroniser, time_s);
        let at = observation.position;
        driver.tick(&mut synchroniser, observation);
        if synchroniser.outcome().is_some() {
            return (synchroniser, used_j);
        }
        if drop_s.is_some_and(|drop_s| time_s >= drop_s && !lost) {
            lost = true;
            let usable_j = world.mission.battery.unwrap().usable_j;
            used_j += (usable_j - used_j) / 2.0;
            synchroniser.step(Event::BatteryMeasured {
                left_j: usable_j - used_j,
            });
        }
        let next_s = world.next_s(&synchroniser, time_s);
        let next = world.observe(&synchroniser, next_s).position;
        used_j += meter.used_j(next_s - time_s, (next - at).norm());
        time_s = next_s;
    }
}

#[test]
fn docks_before_the_battery_is_empty_and_leaves_tasks_undone_for_it() {
    let mut tasks = [0; 3];
    let mut missions = 0;
    for seed in (0..60).step_by(2) {
        let mut world = World::new(seed);
        let (rich, all_j) = fly(&world, None);
        let usable_j = 0.85 * all_j;
        let battery = battery(&world, usable_j);
        Arc::make_mut(&mut world.mission).battery = Some(battery);
        if !world.mission.validate().is_empty() {
            // Not even the quickest way home can be flown.
            continue;
        }
        missions += 1;
        let (poor, used_j) = fly(&world, None);
        assert_eq!(poor.outcome(), Some(Outcome::Docked), "mission {seed}");
        assert!(
            used_j <= usable_j,
            "mission {seed}: {used_j} J of {usable_j} J"
        );
        let (poorer, _) = fly(&world, Some(100.0));
        assert!(
            poorer.tasks() <= poor.tasks() && poor.tasks() <= rich.tasks(),
            "mission {seed}"
        );
        for (sum, mission) in tasks.iter_mut().zip([&rich, &poor, &poorer]) {
            *sum += mission.tasks();
        }
    }
    assert!(tasks[0] > tasks[1] && tasks[1] > tasks[2], "{tasks:?}");
    assert!(missions >= 4, "{missions}");
}

#[test]
fn an_empty_battery_keeps_a_mission_from_starting() {
    let mut world = World::new(0);
    let little = battery(&world, 100.0 * 60.0);
    Arc::make_mut(&mut world.mission).battery = Some(little);
    let violations = world.mission.validate();
    assert!(violations.to_string().contains("battery"), "{violations}");
}
