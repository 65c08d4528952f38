//! What the battery has left at the destination, and what it keeps from being done.

use super::answer::{LaunchCheck, WhyLeftOut};
use auv_mission::{Mission, Stop};

/// Fills in the energy left at the destination, and names it as the reason where the battery, not the budget of
/// time, keeps tasks out. `reserve_percent` is the part of the battery that is never planned to be used.
pub(super) fn fill_in(
    check: &mut LaunchCheck,
    mission: &Mission,
    reserve_percent: f64,
    stops: &[Stop],
) {
    let Some(battery) = &mission.battery else {
        return;
    };
    let vehicle = &mission.vehicle;
    if let Some(last) = stops.last() {
        let takes_s = last.arrive_s - mission.launch_s;
        let used_j = battery.used_j(takes_s, takes_s * vehicle.speed_mps);
        let whole_j = battery.usable_j / (1.0 - 0.01 * reserve_percent);
        check.energy_left_percent = Some(100.0 * (1.0 - used_j / whole_j));
    }
    let lasts_s = battery.lasts_s(battery.usable_j, vehicle);
    if lasts_s >= mission.budget_s {
        return;
    }
    let of_time = check
        .left_out
        .iter_mut()
        .filter(|l| l.reason == WhyLeftOut::Time);
    for left in of_time {
        left.reason = WhyLeftOut::Energy;
        left.text += &format!(
            ": the battery lasts {lasts_s:.0} s at the cruising speed, without its reserve"
        );
    }
}
