//! Files with one thing that is easily read wrongly: each is read rightly, or refused by what is odd.
#![cfg(feature = "netcdf")]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests may"
)]

mod written;

use auv_ocean::netcdf::{read_bathymetry, read_currents};
use auv_ocean::{ChartedDepths, FileReport, ModelCurrents};
use written::{File, Stored, Variable, chart, currents};

fn read_chart(file: &File) -> (ChartedDepths, FileReport) {
    read_bathymetry(&file.bytes()).unwrap_or_else(|error| panic!("{error}"))
}

fn read_model(file: &File) -> (ModelCurrents, FileReport) {
    read_currents(&file.bytes()).unwrap_or_else(|error| panic!("{error}"))
}

fn refused(file: &File) -> String {
    let chart = read_bathymetry(&file.bytes()).err().map(|e| e.to_string());
    let model = read_currents(&file.bytes()).err().map(|e| e.to_string());
    match file
        .variables
        .iter()
        .any(|v| v.name == "uo" || v.name == "u")
    {
        true => model,
        false => chart,
    }
    .expect("a refusal")
}

fn same(a: &ModelCurrents, b: &ModelCurrents) {
    assert_eq!(a.shape(), b.shape());
    let (rows, columns) = a.shape();
    for i in 0..a.times_unix_s().len() * a.layers() * rows * columns {
        let (point, layer) = (i % (rows * columns), i / (rows * columns));
        let of = |m: &ModelCurrents| {
            m.velocity_mps(
                layer / m.layers(),
                layer % m.layers(),
                point / columns,
                point % columns,
            )
        };
        assert_eq!(of(a), of(b), "{i}");
    }
}

#[test]
fn integers_that_are_unsigned_by_attribute_are_large() {
    let mut file = chart();
    let depths = file.var("deptho");
    // Millimetres up to some 60,000; stored as signed, those above 32,767 are negative.
    for x in &mut depths.values {
        let millimetres = if *x > 0.0 { *x * 350.0 } else { 65_535.0 };
        *x = if millimetres >= 32_768.0 {
            millimetres - 65_536.0
        } else {
            millimetres
        };
    }
    depths.stored = Stored::Short;
    depths.set("units", "mm");
    depths.set("_Unsigned", "true");
    let file = with_numbers(file, "deptho", "_FillValue", &[-1.0]);
    let (sound, _) = read_chart(&chart());
    for (read, sound_m) in read_chart(&file).0.depths_m().iter().zip(sound.depths_m()) {
        match *sound_m > 0.0 {
            true => assert!((read - 0.35 * sound_m).abs() < 1e-3, "{read} {sound_m}"),
            false => assert!(read.is_nan()),
        }
    }
}

fn with_numbers(mut file: File, variable: &str, name: &str, numbers: &[f64]) -> File {
    let found = file.var(variable);
    found.drop_attribute(name);
    let whole = found.clone().with_numbers(name, numbers);
    *found = whole;
    file
}

#[test]
fn values_outside_of_their_valid_range_are_missing_with_a_word() {
    let mut file = chart();
    // Land is 500 m deep by no attribute but the range.
    file.var("deptho")
        .values
        .iter_mut()
        .filter(|x| **x <= 0.0)
        .for_each(|x| *x = 500.0);
    let ranged = with_numbers(file.clone(), "deptho", "valid_range", &[0.0, 400.0]);
    let (found, report) = read_chart(&ranged);
    assert!(found.depths_m().iter().all(|x| x.is_nan() || *x <= 400.0));
    assert!(
        report.dropped[0].contains("12 values like 500"),
        "{:?}",
        report.dropped
    );
    let ends = with_numbers(file.clone(), "deptho", "valid_max", &[400.0]);
    assert_eq!(read_chart(&ends).1.dropped.len(), 1);
    let against = with_numbers(file, "deptho", "valid_range", &[0.0, 1.0]);
    let refusal = refused(&against);
    assert!(
        refusal.contains("valid range, 0 to 1") && refusal.contains("ncatted"),
        "{refusal}"
    );
    // Of packed values the range is packed too, unless it is of the scale's type: tests write doubles alone.
    let packed = currents();
    let mut packed = with_numbers(packed, "uo", "scale_factor", &[1.0 / 64.0]);
    packed.var("uo").stored = Stored::Short;
    packed
        .var("uo")
        .values
        .iter_mut()
        .for_each(|x| *x = if x.is_nan() { -700.0 } else { *x * 64.0 });
    let packed = with_numbers(packed, "uo", "valid_min", &[-10.0]);
    let (found, report) = read_model(&packed);
    same(&found, &read_model(&currents()).0);
    assert!(
        report.dropped[0].contains("like -10.9"),
        "{:?}",
        report.dropped
    );
}

#[test]
fn eastward_components_are_not_turned_whatever_the_grid() {
    // The grid leans by 30 degrees, and an angle says so.
    let (rows, columns) = (5, 4);
    let place = |i: usize, k: usize| {
        let (row, column) = ((i / columns) as f64, (i % columns) as f64);
        0.01 * [
            row * 0.866 + column * 0.5,
            2.0 * (column * 0.866 - row * 0.5),
        ][k]
    };
    let all = |value: &dyn Fn(usize) -> f64| (0..rows * columns).map(value).collect::<Vec<_>>();
    let made = |names: [&str; 2], standard: Option<[&str; 2]>| {
        let mut file = File::new(&[("eta", rows), ("xi", columns)])
            .with(
                Variable::new("lat", &["eta", "xi"], all(&|i| 60.0 + place(i, 0)))
                    .with("units", "degrees_north"),
            )
            .with(
                Variable::new("lon", &["eta", "xi"], all(&|i| 5.0 + place(i, 1)))
                    .with("units", "degrees_east"),
            )
            .with(
                Variable::new(
                    "angle",
                    &["eta", "xi"],
                    vec![std::f64::consts::FRAC_PI_6; rows * columns],
                )
                .with("units", "radians"),
            )
            .with(
                Variable::new("u", &["eta", "xi"], vec![0.5; rows * columns])
                    .with("units", "m s-1"),
            )
            .with(
                Variable::new("v", &["eta", "xi"], vec![0.25; rows * columns])
                    .with("units", "m s-1"),
            );
        for (k, old) in ["u", "v"].into_iter().enumerate() {
            if let Some(standard) = standard {
                file.var(old).set("standard_name", standard[k]);
            }
            file.rename(old, names[k]);
        }
        read_model(&file).0.velocity_mps(0, 0, 2, 2)
    };
    let east = [
        "eastward_sea_water_velocity",
        "northward_sea_water_velocity",
    ];
    assert_eq!(made(["u", "v"], Some(east)), Some([0.25, 0.5]));
    assert_eq!(made(["u_eastward", "v_northward"], None), Some([0.25, 0.5]));
    assert_eq!(made(["ssu", "ssv"], Some(east)), Some([0.25, 0.5]));
    let turned = made(
        ["u", "v"],
        Some(["sea_water_x_velocity", "sea_water_y_velocity"]),
    )
    .unwrap();
    assert!(
        (turned[0] - (0.25 * 0.866 + 0.25)).abs() < 1e-3
            && (turned[1] - (0.433 - 0.125)).abs() < 1e-3
    );
}

#[test]
fn parts_of_the_current_and_the_current_at_the_bottom_are_not_the_current() {
    let mut file = currents();
    let mut bottom = file.var("uo").clone();
    bottom.name = "water_u_bottom".into();
    bottom.set("standard_name", "eastward_sea_water_velocity_at_bottom");
    let mut tide = file.var("vo").clone();
    tide.name = "vtide".into();
    tide.set("standard_name", "northward_sea_water_velocity_due_to_tides");
    file.variables.extend([bottom, tide]);
    same(&read_model(&file).0, &read_model(&currents()).0);
    file.take_out("vo");
    assert!(refused(&file).contains("`uo`: has no partner"));
}

#[test]
fn levels_and_times_of_the_second_component_are_those_of_the_first() {
    let own = |dimension: &str, change: fn(&mut Variable)| {
        let mut file = currents();
        let size = file.size(dimension);
        let mut axis = file.var(dimension).clone();
        let name = format!("{dimension}v");
        file.dimensions.push((name.clone(), size));
        axis.name.clone_from(&name);
        axis.dimensions = vec![name.clone()];
        if dimension == "depth" {
            axis.set("standard_name", "depth");
        }
        change(&mut axis);
        file.variables.push(axis);
        for d in &mut file.var("vo").dimensions {
            if d == dimension {
                d.clone_from(&name);
            }
        }
        if dimension == "depth" {
            file.var("depth").set("standard_name", "depth");
        }
        file
    };
    let sound = read_model(&currents()).0;
    for dimension in ["depth", "time"] {
        same(&read_model(&own(dimension, |_| {})).0, &sound);
        for change in [
            (|axis| axis.values.reverse()) as fn(&mut Variable),
            |axis| axis.values.iter_mut().for_each(|x| *x += 1.0),
        ] {
            let refusal = refused(&own(dimension, change));
            assert!(
                refusal.contains("`vo`") && refusal.contains("`uo`"),
                "{refusal}"
            );
            assert!(refusal.contains("interpolate"), "{refusal}");
        }
    }
}

#[test]
fn components_before_their_points_are_refused() {
    // Columns, rows and their sides: `u` lies to the west of its point, or to the east.
    let made = |shift: f64| {
        let axis = |name: &str, start: f64| {
            let values = (0..6).map(|i| start + 0.01 * f64::from(i)).collect();
            let units = if name.starts_with('Y') {
                "degrees_north"
            } else {
                "degrees_east"
            };
            Variable::new(name, &[name], values).with("units", units)
        };
        let over = |name: &str, dimensions: &[&str]| {
            Variable::new(name, dimensions, vec![0.25; 36]).with("units", "m s-1")
        };
        let mut depth = over("h", &["YC", "XC"])
            .with("units", "m")
            .with("positive", "down");
        depth.values.fill(30.0);
        File::new(&[("YC", 6), ("XC", 6), ("YG", 6), ("XG", 6)])
            .with(axis("YC", 58.0))
            .with(axis("XC", 11.0))
            .with(axis("YG", 58.0 + shift))
            .with(axis("XG", 11.0 + shift))
            .with(depth)
            .with(over("u", &["YC", "XG"]))
            .with(over("v", &["YG", "XC"]))
    };
    let (found, _) = read_model(&made(0.005));
    assert_eq!(found.velocity_mps(0, 0, 2, 2), Some([0.25, 0.25]));
    let refusal = refused(&made(-0.005));
    assert!(
        refusal.contains("`u`") && refusal.contains("before the points"),
        "{refusal}"
    );
    let mut without = made(0.005);
    without.take_out("h");
    let refusal = refused(&without);
    assert!(
        refusal.contains("lies elsewhere than `v`") && refusal.contains("interpolate"),
        "{refusal}"
    );
}

#[test]
fn times_in_old_epochs_and_other_calendars_are_the_same_times() {
    let (sound, _) = read_model(&currents());
    // 2024-05-01 06:00 is 739,008 days after 0001-01-01 in the standard (mixed) calendar.
    for (units, calendar, shift) in [
        ("days since 1-1-1", "standard", 739_008.0),
        (
            "days since 0001-01-01 00:00:00",
            "proleptic_gregorian",
            739_006.0,
        ),
        ("days since 2024-01-01", "360_day", 120.0),
        ("days since 2024-01-01", "noleap", 120.0),
    ] {
        let mut file = currents();
        let time = file.var("time");
        time.values.iter_mut().for_each(|x| *x = *x / 24.0 + shift);
        time.set("units", units);
        time.set("calendar", calendar);
        let (found, _) = read_model(&file);
        for (a, b) in found.times_unix_s().iter().zip(sound.times_unix_s()) {
            assert!((a - b).abs() < 1e-3, "{units} {calendar}: {a} {b}");
        }
    }
}

#[test]
fn packed_coordinates_and_coordinates_from_greenwich_are_degrees() {
    let mut file = chart();
    for (name, offset) in [("lat", 58.0), ("lon", 10.0)] {
        let found = file.var(name);
        found
            .values
            .iter_mut()
            .for_each(|x| *x = ((*x - offset) * 1_000.0).round());
        found.stored = Stored::Short;
        let whole = found
            .clone()
            .with_numbers("scale_factor", &[0.001])
            .with_numbers("add_offset", &[offset]);
        *found = whole;
    }
    let (sound, found) = (read_chart(&chart()).0, read_chart(&file).0);
    for (a, b) in sound.soundings().zip(found.soundings()) {
        assert!((a.latitude_deg - b.latitude_deg).abs() < 1e-9);
        assert!((a.longitude_deg - b.longitude_deg).abs() < 1e-9);
    }
}

#[test]
fn grids_that_no_memory_holds_are_refused_before_they_are_laid() {
    // Two short axes, and a variable whose values are not in the file.
    let axis = |name: &str, units: &str| {
        let values = (0..40_000).map(|i| f64::from(i) * 0.002).collect();
        Variable::new(name, &[name], values).with("units", units)
    };
    let file = File::new(&[("lat", 40_000), ("lon", 40_000)])
        .with(axis("lat", "degrees_north"))
        .with(axis("lon", "degrees_east"))
        .with(Variable::new("elevation", &["lat", "lon"], Vec::new()).with("units", "m"));
    let refusal = refused(&file);
    assert!(
        refusal.contains("elevation") && refusal.contains("more than 50000000 values"),
        "{refusal}"
    );
}

#[test]
fn positions_of_another_unit_are_named() {
    let mut file = chart();
    for (name, units) in [("lat", "arcmin"), ("lon", "arcmin")] {
        file.var(name).drop_attribute("standard_name");
        file.var(name).set("units", units);
    }
    let refusal = refused(&file);
    assert!(
        refusal.contains("`lat`: has units `arcmin`; give degrees_north"),
        "{refusal}"
    );
}
