//! With the policy `projected`, the route is replanned during a leg that will be late.

use crate::world::{Detours, Routes, World};
use auv_mission::driver::Stepped;
use auv_mission::{Outcome, ReplanPolicy, RouteReason};

#[test]
fn routes_are_replanned_during_late_legs_and_missions_dock() {
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
