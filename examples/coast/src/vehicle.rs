//! Random survey vehicles.

use crate::dice::{Dice, hundredth};
use auv_planning::Vehicle;
use auv_sim::Body;

/// A REMUS 100 makes 2.5 m/s, steers from 0.5 m/s on, and turns with 20 m before the margin of its turns is added.
const REMUS_MPS: [f64; 2] = [0.5, 2.5];
const REMUS_RADIUS_M: f64 = 20.0;

/// The preset's vehicle, or one of another speed, turn radius and pitch, within what its body can do.
pub(crate) fn vehicle(body: Body, dice: &mut Dice) -> Vehicle {
    let mut vehicle = drawn(dice);
    if body == Body::Remus100 {
        let [least_mps, most_mps] = REMUS_MPS;
        vehicle.min_speed_mps = vehicle.min_speed_mps.max(least_mps);
        vehicle.max_speed_mps = vehicle.max_speed_mps.min(most_mps);
        vehicle.turn_radius_m = vehicle.turn_radius_m.max(REMUS_RADIUS_M);
    }
    vehicle
}

fn drawn(dice: &mut Dice) -> Vehicle {
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
