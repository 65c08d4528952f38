//! Damaged files are errors, or give a field; never a panic, never a hang, never memory without end.
//!
//! The number of files of each kind is 20,000, or that of `AUV_DAMAGED_FILES`.
#![cfg(all(feature = "netcdf", feature = "geotiff"))]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests may")]
#![allow(clippy::print_stderr, reason = "a skipped test says so")]

mod written;

use auv_ocean::{read_chart, read_model};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed};
use std::io::Cursor;
use std::time::{Duration, Instant};
use tiff::encoder::{TiffEncoder, colortype::Gray32Float};
use tiff::tags::Tag;

fn cases() -> usize {
    std::env::var("AUV_DAMAGED_FILES").map_or(20_000, |count| count.parse().unwrap())
}

/// A chart of 30 x 20 cells in degrees.
fn geotiff() -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let mut encoder = TiffEncoder::new(&mut bytes).unwrap();
    let mut image = encoder.new_image::<Gray32Float>(30, 20).unwrap();
    let tags = image.encoder();
    let keys = [1_u16, 1, 0, 2, 1024, 0, 1, 2, 2048, 0, 1, 4326];
    tags.write_tag(Tag::GeoKeyDirectoryTag, &keys[..]).unwrap();
    tags.write_tag(Tag::ModelPixelScaleTag, &[0.01, 0.01, 0.0][..])
        .unwrap();
    tags.write_tag(Tag::ModelTiepointTag, &[0.0, 0.0, 0.0, 10.0, 58.0, 0.0][..])
        .unwrap();
    image.write_data(&[-40.0_f32; 600]).unwrap();
    bytes.into_inner()
}

/// One to seven bytes changed, most of them where the file says what it is; one file in five cut short.
fn damaged(whole: &[u8], case: usize, random: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    if case.is_multiple_of(5) {
        bytes.truncate(random.random_range(0..bytes.len()));
    }
    for _ in 0..random.random_range(1..8) {
        let places = match (case % 3, bytes.len()) {
            (_, 0) => break,
            (0, length) => 0..length,
            // The header of a classic file, or the tags of a TIFF.
            (1, length) => 0..length.min(1_200),
            (_, length) => length.saturating_sub(400)..length,
        };
        let place = random.random_range(places);
        bytes[place] = random.random_range(0..=255);
    }
    bytes
}

/// The most memory that the process has reserved so far, bytes, where the system tells.
fn reserved() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status
        .lines()
        .find_map(|line| line.strip_prefix("VmPeak:"))?;
    let kilobytes: u64 = line.trim().trim_end_matches(" kB").parse().ok()?;
    Some(1024 * kilobytes)
}

#[expect(
    clippy::disallowed_methods,
    reason = "the test measures how long reading takes"
)]
fn end_in_time(whole: &[u8], stream: u64, read: fn(&[u8])) {
    let mut random = Seed(22).stream(stream);
    let mut longest = Duration::ZERO;
    for case in 0..cases() {
        let bytes = damaged(whole, case, &mut random);
        let began = Instant::now();
        read(&bytes);
        longest = longest.max(began.elapsed());
    }
    assert!(longest < Duration::from_secs(5), "{longest:?}");
    assert!(
        reserved().is_none_or(|bytes| bytes < 2 << 30),
        "{:?}",
        reserved()
    );
}

#[test]
fn damaged_charts_end_in_time_and_memory() {
    end_in_time(&written::chart().bytes(), 0, |bytes| {
        drop(read_chart(bytes))
    });
}

#[test]
fn damaged_models_end_in_time_and_memory() {
    end_in_time(&written::currents().bytes(), 1, |bytes| {
        drop(read_model(bytes))
    });
}

#[test]
fn damaged_geotiffs_end_in_time_and_memory() {
    end_in_time(&geotiff(), 2, |bytes| drop(read_chart(bytes)));
}

/// NetCDF-4, where the data are at hand.
#[test]
fn damaged_hdf5_files_end_in_time_and_memory() {
    let Some(folder) = std::env::var_os("AUV_DATA_DIR") else {
        eprintln!("skipped: set AUV_DATA_DIR");
        return;
    };
    let name = std::path::Path::new(&folder).join("ocean/bathymetry_201702_BS.nc");
    let whole = std::fs::read(name).unwrap();
    let mut random = Seed(22).stream(3);
    for case in 0..cases() / 20 {
        drop(read_chart(&damaged(&whole, case, &mut random)));
    }
    assert!(
        reserved().is_none_or(|bytes| bytes < 2 << 30),
        "{:?}",
        reserved()
    );
}
