//! Random draws that are equal on every platform: transcendental functions come from `libm`.

use auv_types::rand::{Rng, RngExt};
use auv_types::{Vector3, libm};
use std::f64::consts::TAU;

/// Two independent standard normal draws (Box-Muller).
pub(crate) fn normal_pair(random: &mut impl Rng) -> (f64, f64) {
    normal_pair_from(random.random(), random.random())
}

/// The Box-Muller transform of two uniform draws from `[0, 1)`.
pub(crate) fn normal_pair_from(first: f64, second: f64) -> (f64, f64) {
    let length = libm::sqrt(-2.0 * libm::log(1.0 - first));
    let (sin, cos) = libm::sincos(TAU * second);
    (length * cos, length * sin)
}

/// One standard normal draw.
pub(crate) fn normal(random: &mut impl Rng) -> f64 {
    normal_pair(random).0
}

/// Three independent standard normal draws.
pub(crate) fn normal_vector(random: &mut impl Rng) -> Vector3<f64> {
    let (x, y) = normal_pair(random);
    Vector3::new(x, y, normal(random))
}

/// Uniform in the cube `[-half, half]^3`.
pub(crate) fn in_cube(half: f64, random: &mut impl Rng) -> Vector3<f64> {
    let mut axis = || half * (2.0 * random.random::<f64>() - 1.0);
    Vector3::new(axis(), axis(), axis())
}

/// A Poisson draw; a mean above 100 counts as 100.
pub(crate) fn poisson(mean: f64, random: &mut impl Rng) -> usize {
    let floor = libm::exp(-mean.clamp(0.0, 100.0));
    let mut product = random.random::<f64>();
    let mut count = 0;
    while product > floor {
        product *= random.random::<f64>();
        count += 1;
    }
    count
}
