//! A leg that is going to be late has its route replanned on the way, not only at its end.

use crate::world::{Detours, Routes, World};
use auv_mission::driver::Stepped;
use auv_mission::{Outcome, ReplanPolicy, RouteReason};

#[test]
fn late_legs_are_seen_before_they_end_and_the_mission_goes_on() {
    let mut projected = 0;
    for seed in 0..30 {
        let mut world = World::new(seed);
        world.settings.replan.policy = ReplanPolicy::Projected;
        let mut synchroniser = world.synchroniser();
        let driver = Stepped::new(&Routes, &Detours);
        let mut time_s = 0.0;
        while synchroniser.outcome().is_none() {
            let observation = world.observe(&synchroniser, time_s);
            driver.tick(&mut synchroniser, observation);
            time_s = world.next_s(&synchroniser, time_s);
        }
        assert_eq!(
            synchroniser.outcome(),
            Some(Outcome::Docked),
            "mission {seed}"
        );
        let legs = synchroniser.path_calls();
        for call in synchroniser.route_calls() {
            if call.reason == RouteReason::Projected {
                projected += 1;
                let leg = legs
                    .iter()
                    .find(|leg| leg.at_s <= call.at_s && call.at_s < leg.at_s + leg.leg_s);
                let leg = leg.unwrap_or_else(|| panic!("mission {seed}: {call:?}"));
                assert_eq!(leg.to, call.start, "mission {seed}");
            }
        }
    }
    assert!(projected >= 5, "{projected}");
}
