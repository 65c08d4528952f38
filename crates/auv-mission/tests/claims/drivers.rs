//! A driver of one's own and the library's answer alike, also after a resumption, behind a reference and with a clock.

use crate::world::{Detours, Routes, World};
use auv_mission::driver::{Driver, Orders, Stepped};
use auv_mission::{Command, Outcome, Synchroniser};
use std::cell::Cell;
use std::sync::Arc;

/// Flies a mission to its end; every so many ticks the question just asked is put off and asked again.
fn fly(world: &World, driver: &mut impl Driver, resumes_every: usize) -> Synchroniser {
    let mut synchroniser = world.synchroniser();
    let mut time_s = 0.0;
    for tick in 1..3_000 {
        let seen = world.observe(&synchroniser, time_s);
        if tick % resumes_every == 0 {
            // What a vehicle's computer knows after a restart: the answers are not there yet.
            synchroniser.step(auv_mission::Event::Tick(seen));
            let orders = driver.carry_on(&mut synchroniser);
            assert!(synchroniser.outstanding().is_none());
            if let Some(follow) = orders.follow {
                assert_eq!(Some(&*follow), synchroniser.trajectory());
            }
            let again = driver.carry_on(&mut synchroniser);
            assert!(
                again.follow.is_none() && again.finished.is_none(),
                "nothing is left to ask"
            );
        } else {
            driver.tick(&mut synchroniser, seen);
        }
        if synchroniser.outcome().is_some() {
            return synchroniser;
        }
        time_s = world.next_s(&synchroniser, time_s);
    }
    panic!("the mission never ended");
}

fn end(synchroniser: &Synchroniser) -> String {
    let calls = (synchroniser.route_calls(), synchroniser.path_calls());
    format!(
        "{calls:?} {:?} {:?}",
        synchroniser.outcome(),
        synchroniser.trajectory()
    )
}

#[test]
fn questions_answered_later_or_behind_a_reference_lead_to_the_same_mission() {
    for seed in 0..8 {
        let world = World::new(seed);
        let mut driver = Stepped::new(&Routes, &Detours);
        assert_eq!(format!("{driver:?}"), "Stepped(routes, detours)");
        let direct = end(&fly(&world, &mut driver, usize::MAX));
        let mut borrowed = &driver;
        assert_eq!(
            end(&fly(&world, &mut borrowed, usize::MAX)),
            direct,
            "mission {seed}"
        );
        assert_eq!(
            end(&fly(&world, &mut borrowed, 3)),
            direct,
            "mission {seed}"
        );
        let behind: &mut dyn Driver = &mut driver;
        assert_eq!(
            end(&fly(&world, &mut { behind }, 5)),
            direct,
            "mission {seed}"
        );
    }
}

#[test]
fn a_stopwatch_times_every_call_and_changes_no_decision() {
    let world = World::new(2);
    let now_s = Cell::new(0.0);
    // Two seconds go by from one look at the clock to the next.
    let clock = || {
        now_s.set(now_s.get() + 2.0);
        now_s.get()
    };
    let plain = fly(&world, &mut Stepped::new(&Routes, &Detours), usize::MAX);
    let timed = fly(
        &world,
        &mut Stepped::new(&Routes, &Detours).with_stopwatch(&clock),
        usize::MAX,
    );
    for call in timed.route_calls() {
        assert_eq!(call.compute_s, 2.0);
    }
    assert_eq!(plain.visited(), timed.visited());
    assert_eq!(plain.outcome(), timed.outcome());
}

#[test]
fn later_orders_replace_earlier_ones() {
    let world = World::new(0);
    let synchroniser = fly(&world, &mut Stepped::new(&Routes, &Detours), usize::MAX);
    let way = Arc::new(synchroniser.trajectory().unwrap().clone());
    let mut orders = Orders::default();
    orders.take(Command::Follow(Arc::clone(&way)));
    orders.then(Orders::default());
    assert_eq!(
        orders.follow.as_deref(),
        Some(&*way),
        "no order changes nothing"
    );
    let mut later = Orders::default();
    let cut = Arc::new(way.until(way.start().time_s + 1.0));
    later.take(Command::Follow(Arc::clone(&cut)));
    later.take(Command::Finished(Outcome::Docked));
    orders.then(later);
    assert_eq!(orders.follow.as_deref(), Some(&*cut));
    assert_eq!(orders.finished, Some(Outcome::Docked));
    orders.then(Orders::default());
    assert_eq!(orders.finished, Some(Outcome::Docked));
}
