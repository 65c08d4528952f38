//! Random survey vehicles.

use crate::dice::{Dice, hundredth};
use auv_planning::Vehicle;

/// The preset's vehicle, or one of another speed, turn radius and pitch.
pub(crate) fn vehicle(dice: &mut Dice) -> Vehicle {
    let mut vehicle = Vehicle::default();
    if dice.chance(dice.by_hardness(0.6, 0.2)) {
        return vehicle;
    }
    vehicle.speed_mps = dice.hundredth(1.0, 2.2);
    vehicle.max_speed_mps = hundredth(vehicle.speed_mps * dice.between(1.15, 1.5));
    vehicle.min_speed_mps = if dice.chance(0.15) {
        0.0
    } else {
        hundredth(vehicle.speed_mps * dice.between(0.3, 0.6))
    };
    vehicle.turn_radius_m = dice.whole(8.0, dice.by_hardness(30.0, 45.0));
    vehicle.max_pitch_rad = dice.hundredth(dice.by_hardness(0.2, 0.12), 0.5);
    vehicle
}
