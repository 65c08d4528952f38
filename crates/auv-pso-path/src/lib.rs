//! Particle swarm path planning with B-splines among moving obstacles.

#![cfg_attr(
    test,
    allow(clippy::float_cmp, reason = "tests compare exact values on purpose")
)]
