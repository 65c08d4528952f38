//! An autopilot for the REMUS 100. It knows set-points alone: no trajectory, no plan.

use super::remus100::{Actuators, Remus100};
use auv_mission::SetPoint;
use auv_types::libm;

/// Revolutions a minute for 1 m/s through the water, on a straight course.
const RPM_PER_MPS: f64 = 598.0;
/// Rudder by heading error and by yaw rate.
const RUDDER: [f64; 2] = [5.0, 3.0];
/// Stern planes by pitch error and by pitch rate.
const STERN: [f64; 2] = [2.0, 1.5];
/// Pitch by depth error (rad/m), and its most (rad).
const PITCH_BY_DEPTH: f64 = 0.1;
const MOST_PITCH_BY_DEPTH_RAD: f64 = 0.25;
/// Gains of the error that stays: of speed (rpm for a metre), of pitch (for a rad s), of depth (rad for a m s).
const SPEED_INTEGRAL: f64 = 40.0;
const DEPTH_INTEGRAL: f64 = 0.005;
const MOST_TRIM_RAD: f64 = 0.15;
const MOST_TRIM_RPM: f64 = 500.0;

/// Heading, speed and depth loops.
#[derive(Clone, Debug, Default)]
pub(crate) struct Autopilot {
    /// Pitch that holds the depth on a level course, radians.
    trim_rad: f64,
    trim_rpm: f64,
}

impl Autopilot {
    /// What the actuators are asked, one step after the last. `speed_mps` is through the water.
    pub(crate) fn steer(&mut self, body: &Remus100, speed_mps: f64, told: &SetPoint) -> Actuators {
        let h = Remus100::STEP_S;
        let rates = body.rates();
        let yaw = told.heading_rad.unwrap_or(body.attitude.z);
        let turn = libm::remainder(yaw - body.attitude.z, std::f64::consts::TAU);
        let deep_m = body.position.z - told.depth_m;
        let most = MOST_TRIM_RAD;
        self.trim_rad = (self.trim_rad + DEPTH_INTEGRAL * deep_m * h).clamp(-most, most);
        let by_depth =
            (PITCH_BY_DEPTH * deep_m).clamp(-MOST_PITCH_BY_DEPTH_RAD, MOST_PITCH_BY_DEPTH_RAD);
        let pitch = told.pitch_rad + by_depth + self.trim_rad;
        let slow_mps = told.speed_mps - speed_mps;
        self.trim_rpm =
            (self.trim_rpm + SPEED_INTEGRAL * slow_mps * h).clamp(-MOST_TRIM_RPM, MOST_TRIM_RPM);
        Actuators {
            rudder_rad: RUDDER[0] * turn - RUDDER[1] * rates.z,
            stern_rad: STERN[0] * (body.attitude.y - pitch) + STERN[1] * rates.y,
            rpm: RPM_PER_MPS * (told.speed_mps + slow_mps) + self.trim_rpm,
        }
    }
}
