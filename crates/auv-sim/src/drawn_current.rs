//! The paper's current.

use auv_ocean::{CurrentField, UniformCurrent};
use auv_types::rand::RngExt;
use auv_types::{Seed, Vector3, libm};
use std::sync::Arc;

/// The paper's current (section 8.3): speed |N(0, sigma)| in a uniformly drawn direction, constant over a
/// mission.
pub(crate) fn drawn_current(speed_sigma_mps: f64, seed: Seed) -> Arc<dyn CurrentField> {
    let mut random = seed.stream(0);
    let (u, v): (f64, f64) = (1.0 - random.random::<f64>(), random.random());
    let normal = libm::sqrt(-2.0 * libm::log(u)) * libm::cos(std::f64::consts::TAU * v);
    let heading_rad = random.random_range(0.0..std::f64::consts::TAU);
    let (sin, cos) = libm::sincos(heading_rad);
    let speed_mps = speed_sigma_mps * normal.abs();
    Arc::new(UniformCurrent::new(Vector3::new(cos, sin, 0.0) * speed_mps))
}
