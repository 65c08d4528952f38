//! A perfect vehicle: it is where the trajectory says and looks up every `tick_s`.

use auv_mission::driver::Stepped;
use auv_mission::{Observation, Outcome, Synchroniser};
use auv_obstacles::Region;
use auv_types::Vector3;
use std::sync::Arc;

pub(crate) fn fly(
    driver: &Stepped<'_>,
    synchroniser: &mut Synchroniser,
    tick_s: f64,
    regions_at: impl Fn(f64) -> Vec<Region>,
) -> Outcome {
    let mission = Arc::clone(synchroniser.mission());
    let mut time_s = 0.0;
    for _ in 0..1_000_000 {
        let (position, velocity) = synchroniser.trajectory().map_or(
            (mission.position_of(mission.start), Vector3::zeros()),
            |t| t.at(time_s),
        );
        let regions = regions_at(time_s).into();
        driver.tick(
            synchroniser,
            Observation {
                time_s,
                position,
                velocity,
                regions,
            },
        );
        if let Some(outcome) = synchroniser.outcome() {
            return outcome;
        }
        let due_s = synchroniser.due_s();
        time_s = if due_s > time_s {
            due_s.min(time_s + tick_s)
        } else {
            time_s + tick_s
        };
    }
    panic!("the mission never ended");
}
