//! Claims about real files; each test is skipped where the data are absent.
#![cfg(feature = "netcdf")]
#![allow(clippy::print_stderr, reason = "a skipped test says so")]
#![allow(clippy::unwrap_used, reason = "tests may")]

use auv_ocean::netcdf::{NetcdfError, read_bathymetry, read_currents};
use auv_ocean::{CurrentField, Geodetic, GriddedBed, LocalFrame, SeaBed, WaterMap};
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed, libm};

fn file(name: &str) -> Option<Vec<u8>> {
    let Ok(folder) = std::env::var("AUV_DATA_DIR") else {
        eprintln!("skipped: set AUV_DATA_DIR");
        return None;
    };
    Some(std::fs::read(format!("{folder}/ocean/{name}")).unwrap())
}

const BAYNES: &str = "bathymetry_201702_BS.nc";
const NORDIC: &str = "Nordic_subset.nc";

fn in_the_box(place: &Geodetic) -> bool {
    (49.575..=49.665).contains(&place.latitude_deg)
        && (-124.91..=-124.77).contains(&place.longitude_deg)
}

fn baynes_bed(bytes: &[u8], cell_m: f64) -> (LocalFrame, GriddedBed) {
    let chart = read_bathymetry(bytes).unwrap().0;
    let datum = Geodetic {
        latitude_deg: 49.62,
        longitude_deg: -124.84,
        depth_m: 0.0,
    };
    let frame = LocalFrame::new(datum).unwrap();
    let bed = chart.to_bed(&frame, cell_m).unwrap();
    (frame, bed)
}

#[test]
fn baynes_sound_is_what_its_makers_say() {
    let Some(bytes) = file(BAYNES) else { return };
    let chart = read_bathymetry(&bytes).unwrap().0;
    assert_eq!(chart.shape(), (394, 139));
    let sea =
        |depths: &[f64]| depths.iter().filter(|d| **d > 0.0).count() as f64 / depths.len() as f64;
    let deepest = chart.depths_m().iter().copied().fold(0.0, f64::max);
    assert!((350.5..=351.5).contains(&deepest), "{deepest}");
    assert!((sea(chart.depths_m()) - 0.57).abs() < 0.005);
    let mut boxed: Vec<f64> = chart
        .soundings()
        .filter(in_the_box)
        .map(|s| s.depth_m)
        .collect();
    assert!((sea(&boxed) - 0.86).abs() < 0.01, "{}", sea(&boxed));
    boxed.retain(|d| *d > 0.0);
    boxed.sort_by(f64::total_cmp);
    let median = boxed[boxed.len() / 2];
    assert!((median - 37.0).abs() < 1.0, "{median}");
}

#[test]
fn the_resampled_bed_is_nowhere_deeper_than_charted_and_seldom_much_shallower() {
    let Some(bytes) = file(BAYNES) else { return };
    let chart = read_bathymetry(&bytes).unwrap().0;
    let (frame, bed) = baynes_bed(&bytes, 50.0);
    let mut shallower: Vec<f64> = Vec::new();
    for sounding in chart.soundings().filter(in_the_box) {
        let point = frame.to_local(&sounding);
        let bed_m = bed.depth_at(point.x, point.y);
        assert!(bed_m <= sounding.depth_m.max(0.0) + 1e-9);
        if sounding.depth_m > 0.0 {
            shallower.push(sounding.depth_m - bed_m);
        }
    }
    shallower.sort_by(f64::total_cmp);
    assert!(shallower[shallower.len() / 2] < 0.5);
    assert!(shallower[shallower.len() * 95 / 100] < 4.0);
}

#[test]
fn water_paths_in_baynes_sound_stay_deep() {
    let Some(bytes) = file(BAYNES) else { return };
    let (_, bed) = baynes_bed(&bytes, 50.0);
    let water = WaterMap::new(&bed, [-5_000.0; 2], [5_000.0; 2], 50.0, 5.0).unwrap();
    let mut random = Seed(1).stream(0);
    let mut draw = || {
        [
            random.random_range(-5_000.0..5_000.0),
            random.random_range(-5_000.0..5_000.0),
        ]
    };
    let (mut found, mut turned) = (0, 0);
    while found < 200 {
        let (from, to) = (draw(), draw());
        let Some(path) = water.path(from, to) else {
            continue;
        };
        found += 1;
        turned += usize::from(path.points.len() > 2);
        for ends in path.points.windows(2) {
            for i in 0..=200 {
                let share = f64::from(i) / 200.0;
                let place = [0, 1].map(|k| ends[0][k] + share * (ends[1][k] - ends[0][k]));
                assert!(bed.depth_at(place[0], place[1]) >= 5.0 - 1e-9);
            }
        }
    }
    assert!(turned > 50, "{turned}");
}

#[test]
fn the_nordic_currents_are_masked_turned_and_in_range() {
    let Some(bytes) = file(NORDIC) else { return };
    let roms = read_currents(&bytes).unwrap().0;
    assert_eq!(roms.bathymetry().unwrap().shape(), (21, 31));
    assert_eq!(
        roms.times_unix_s(),
        [1_454_414_400.0, 1_454_500_800.0, 1_454_587_200.0]
    );
    assert!(roms.velocity_mps(0, 0, 0, 0).is_none(), "land");
    // True north and east worked out by hand from the packed u, v and angle around two points.
    let wet = roms.velocity_mps(0, 34, 15, 10).unwrap();
    assert!((wet[0] - 0.138_955_4).abs() < 1e-6 && (wet[1] + 0.089_266_3).abs() < 1e-6);
    let deep = roms.velocity_mps(0, 0, 10, 5).unwrap();
    assert!((deep[0] - 0.088_749_1).abs() < 1e-6 && (deep[1] - 0.124_350_6).abs() < 1e-6);
    let frame = LocalFrame::new(roms.bathymetry().unwrap().centre().unwrap()).unwrap();
    let levels = [0.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
    let current = roms
        .to_current(&frame, 2_000.0, &levels, 1_454_414_400.0)
        .unwrap();
    assert!(current.max_speed_mps() > 0.2 && current.max_speed_mps() < 0.9);
    // At a model point the local current is the model's, turned by the frame's lean.
    let place = roms
        .bathymetry()
        .unwrap()
        .soundings()
        .nth(15 * 31 + 10)
        .unwrap();
    let point = frame.to_local(&place);
    let met = current.velocity_at(&Point3::new(point.x, point.y, 0.0), 0.0);
    let lean = frame.bearing_of_true_north(&place);
    let (sin, cos) = libm::sincos(lean);
    let [n, e] = wet.map(f64::from);
    let expected = [n * cos - e * sin, n * sin + e * cos];
    assert!((met.x - expected[0]).abs() < 0.02 && (met.y - expected[1]).abs() < 0.02);
    let bed = roms.bathymetry().unwrap().to_bed(&frame, 2_000.0).unwrap();
    assert!(bed.depth_at(point.x, point.y) > 50.0);
}

#[test]
fn damaged_files_are_errors_and_never_panics() {
    for name in [BAYNES, NORDIC] {
        let Some(bytes) = file(name) else { return };
        let mut random = Seed(6).stream(0);
        for case in 0..150 {
            let mut damaged = bytes.clone();
            if case % 2 == 0 {
                damaged.truncate(random.random_range(0..bytes.len()));
            } else {
                for _ in 0..20 {
                    let place = random.random_range(0..20_000);
                    damaged[place] = random.random_range(0..=255);
                }
            }
            let chart = read_bathymetry(&damaged);
            let roms = read_currents(&damaged);
            if case % 2 == 0 {
                assert!(chart.is_err() && roms.is_err());
            }
        }
    }
}

#[test]
fn a_missing_variable_is_named_with_its_remedy() {
    let Some(bytes) = file(BAYNES) else { return };
    let error = read_currents(&bytes).unwrap_err();
    assert!(matches!(
        error,
        NetcdfError::Missing {
            variable: "current",
            ..
        }
    ));
    assert!(error.to_string().contains("eastward_sea_water_velocity"));
    assert!(matches!(
        read_bathymetry(b"no file"),
        Err(NetcdfError::NotNetcdf { .. })
    ));
}

fn mixed(bits: u64, x: f64) -> u64 {
    (bits ^ x.to_bits()).wrapping_mul(0x0100_0000_01b3)
}

/// The bits are those of the readers of version 0.1 before attributes decided.
#[test]
fn the_real_files_give_the_bits_they_always_gave() {
    const START: u64 = 0xcbf2_9ce4_8422_2325;
    let Some(bytes) = file(BAYNES) else { return };
    let (_, bed) = baynes_bed(&bytes, 50.0);
    let bits = bed
        .node_depths_m()
        .iter()
        .fold(START, |bits, x| mixed(bits, *x));
    assert_eq!(bits, 0xba4b_2650_7aa2_4138);
    let Some(bytes) = file(NORDIC) else { return };
    let roms = read_currents(&bytes).unwrap().0;
    let chart = roms.bathymetry().unwrap();
    let frame = LocalFrame::new(chart.centre().unwrap()).unwrap();
    let levels = [0.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0];
    let current = roms
        .to_current(&frame, 2_000.0, &levels, 1_454_414_400.0)
        .unwrap();
    let grid = *current.grid();
    let mut bits = START;
    for time_s in [0.0, 40_000.0, 172_800.0] {
        for z in [0.0, 7.0, 60.0, 300.0] {
            for node in 0..grid.nodes() {
                let [n, e] = grid.place(node / grid.columns, node % grid.columns);
                let met = current.velocity_at(&Point3::new(n, e, z), time_s);
                bits = mixed(mixed(bits, met.x), met.y);
            }
        }
    }
    assert_eq!(bits, 0xa156_ec45_149c_ba6c);
    let bed = chart.to_bed(&frame, 2_000.0).unwrap();
    let bits = bed
        .node_depths_m()
        .iter()
        .fold(START, |bits, x| mixed(bits, *x));
    assert_eq!(bits, 0x6631_ffbb_3793_8a98);
}
