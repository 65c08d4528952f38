//! Damaged tables of ship positions are errors or ships; never a panic, never a hang.
#![cfg(feature = "ais")]

use auv_obstacles::ais::parse;
use auv_types::Seed;
use auv_types::rand::RngExt;
use std::fmt::Write;
use std::time::{Duration, Instant};

/// A day's table of three ships.
fn table(rows: u32) -> String {
    let mut text =
        "MMSI,BaseDateTime,LAT,LON,SOG,COG,Heading,VesselName,Status,Length,Width,Draft\n"
            .to_owned();
    for k in 0..rows {
        let (ship, step) = (k % 3, k / 3);
        let _ = writeln!(
            text,
            "{},2024-05-01T{:02}:{:02}:00,{:.5},11.{:05},{}.5,90,91,\"A, {ship}\",{},{},20,6.5",
            219_000_001 + ship,
            step / 60 % 24,
            step % 60,
            58.0 + 0.1 * f64::from(ship),
            step * 300 % 100_000,
            9 * (ship % 2),
            5 * (1 - ship % 2),
            80 + 40 * ship,
        );
    }
    text
}

#[expect(
    clippy::disallowed_methods,
    reason = "the test measures how long reading takes"
)]
fn read_in(text: &str) -> Duration {
    let began = Instant::now();
    let _ = parse(text);
    began.elapsed()
}

#[test]
fn damaged_tables_end_in_time() {
    let cases: usize =
        std::env::var("AUV_DAMAGED_FILES").map_or(5_000, |n| n.parse().unwrap_or(5_000));
    let whole = table(60).into_bytes();
    let mut random = Seed(23).stream(0);
    let mut longest = Duration::ZERO;
    for case in 0..cases {
        let mut bytes = whole.clone();
        if case % 4 == 0 {
            bytes.truncate(random.random_range(0..bytes.len()));
        }
        for _ in 0..random.random_range(1..8) {
            let reach = if case % 3 == 0 {
                bytes.len()
            } else {
                bytes.len().min(160)
            };
            if reach > 0 {
                let place = random.random_range(0..reach);
                bytes[place] = random.random_range(0..=255);
            }
        }
        longest = longest.max(read_in(&String::from_utf8_lossy(&bytes)));
    }
    assert!(longest < Duration::from_secs(5), "{longest:?}");
}

#[test]
fn large_tables_of_nothing_but_faults_end_in_time() {
    let header = "MMSI,BaseDateTime,LAT,LON\n";
    // No row can be used; every fix is elsewhere; all are one fix.
    let faults = header.to_owned() + &"1,never,58.0,11.0\n".repeat(100_000);
    let one = header.to_owned() + &"1,2024-05-01T00:00:00,58.0,11.0\n".repeat(100_000);
    let mut scattered = header.to_owned();
    for k in 0..100_000_u64 {
        let (latitude, longitude) = (k * 7_919 % 160, k * 104_729 % 359);
        let _ = writeln!(
            scattered,
            "1,2024-05-01T00:{:02}:{:02},{}.0,{}.0",
            k / 3_000 % 60,
            k / 50 % 60,
            latitude as i64 - 80,
            longitude as i64 - 179
        );
    }
    for text in [&faults, &one, &scattered] {
        let took = read_in(text);
        assert!(took < Duration::from_secs(5), "{took:?}");
    }
    let refusal = parse(&scattered).map_err(|error| error.to_string());
    assert!(refusal.is_err_and(|text| text.contains("vessel 1 is at hundreds of places")));
}
