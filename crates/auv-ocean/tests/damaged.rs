//! Damaged files are errors, or give a field; never a panic, never a hang.
#![cfg(feature = "netcdf")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests may")]

mod written;

use auv_ocean::netcdf::{read_bathymetry, read_currents};
use auv_types::Seed;
use auv_types::rand::RngExt;
use std::time::Instant;

/// Flips and truncations of each of the two files.
const CASES: usize = 50_000;

#[test]
#[expect(
    clippy::disallowed_methods,
    reason = "the test measures how long reading takes"
)]
fn a_hundred_thousand_damaged_files_end_in_time() {
    let mut random = Seed(22).stream(0);
    let whole = [written::chart().bytes(), written::currents().bytes()];
    for case in 0..2 * CASES {
        let mut bytes = whole[case % 2].clone();
        if case % 5 == 0 {
            bytes.truncate(random.random_range(0..bytes.len()));
        }
        // The header of a classic file is within its first 1,200 bytes.
        for _ in 0..random.random_range(1..8) {
            let head = bytes
                .len()
                .min(if case % 3 == 0 { usize::MAX } else { 1_200 });
            if head > 0 {
                let place = random.random_range(0..head);
                bytes[place] = random.random_range(0..=255);
            }
        }
        let began = Instant::now();
        if case % 2 == 0 {
            let _ = read_bathymetry(&bytes);
        } else {
            let _ = read_currents(&bytes);
        }
        assert!(began.elapsed().as_secs() < 5, "case {case}");
    }
}
