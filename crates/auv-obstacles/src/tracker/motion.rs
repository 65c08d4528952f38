//! The Kalman filter of a contact that moves straight on.

use super::settings::TrackerSettings;
use crate::Detection;
use auv_types::{Point3, Vector3, libm};

/// Position and velocity with their variances and covariance, which are equal on all axes.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub(super) struct Motion {
    pub(super) position: Point3<f64>,
    pub(super) velocity: Vector3<f64>,
    pub(super) pp: f64,
    pub(super) pv: f64,
    pub(super) vv: f64,
}

impl Motion {
    /// After the first echo of a contact whose speed has a standard deviation per axis.
    pub(super) fn new(echo: &Detection, speed_sigma_mps: f64) -> Self {
        let first = speed_sigma_mps * speed_sigma_mps;
        let mut motion = Self {
            position: echo.position,
            velocity: Vector3::zeros(),
            pp: echo.position_sigma_m * echo.position_sigma_m,
            pv: 0.0,
            vv: first,
        };
        if let Some(velocity) = echo.velocity {
            let rv = echo.velocity_sigma_mps * echo.velocity_sigma_mps;
            let gain = first / (first + rv);
            motion.velocity = velocity * gain;
            motion.vv = first - gain * first;
        }
        motion
    }

    /// Moves on by a time.
    pub(super) fn predict(&mut self, dt_s: f64, settings: &TrackerSettings) {
        let q = settings.acceleration_density();
        let jitter = settings.jitter_m2ps * dt_s;
        self.position += self.velocity * dt_s;
        self.pp +=
            2.0 * dt_s * self.pv + dt_s * dt_s * self.vv + q * dt_s * dt_s * dt_s / 3.0 + jitter;
        self.pv += dt_s * self.vv + 0.5 * q * dt_s * dt_s;
        self.vv += q * dt_s;
    }

    /// Takes in an echo.
    pub(super) fn update(&mut self, echo: &Detection) {
        let r = echo.position_sigma_m * echo.position_sigma_m;
        let (s, offset) = (self.pp + r, echo.position - self.position);
        let (gain_p, gain_v) = (self.pp / s, self.pv / s);
        self.position += offset * gain_p;
        self.velocity += offset * gain_v;
        self.vv -= gain_v * self.pv;
        self.pv -= gain_p * self.pv;
        self.pp -= gain_p * self.pp;
        if let Some(velocity) = echo.velocity {
            let rv = echo.velocity_sigma_mps * echo.velocity_sigma_mps;
            let (s, offset) = (self.vv + rv, velocity - self.velocity);
            let (gain_p, gain_v) = (self.pv / s, self.vv / s);
            self.position += offset * gain_p;
            self.velocity += offset * gain_v;
            self.pp -= gain_p * self.pv;
            self.pv -= gain_v * self.pv;
            self.vv -= gain_v * self.vv;
        }
    }

    /// The normalised innovation squared of an echo, and its degrees of freedom.
    pub(super) fn distance_squared(&self, echo: &Detection) -> (f64, usize) {
        let s = self.pp + echo.position_sigma_m * echo.position_sigma_m;
        let offset = echo.position - self.position;
        let square = offset.norm_squared() / s;
        let Some(velocity) = echo.velocity else {
            return (square, 3);
        };
        let gain_v = self.pv / s;
        let vv = self.vv - gain_v * self.pv;
        let rv = echo.velocity_sigma_mps * echo.velocity_sigma_mps;
        let rest = velocity - (self.velocity + offset * gain_v);
        (square + rest.norm_squared() / (vv + rv), 6)
    }
}

/// The log likelihood, but for a constant, of an echo of a contact at a place known with a variance.
pub(super) fn log_likelihood(echo: &Detection, place: &Point3<f64>, variance: f64) -> f64 {
    let s = variance + echo.position_sigma_m * echo.position_sigma_m;
    -0.5 * ((echo.position - place).norm_squared() / s + 3.0 * libm::log(s))
}
