//! Files in the manner of those who publish charts and currents: each is read to the right field.
#![cfg(feature = "netcdf")]
#![allow(clippy::unwrap_used, clippy::expect_used, reason = "tests may")]

mod written;

use auv_ocean::netcdf::{read_bathymetry, read_currents};
use auv_ocean::{ChartedDepths, FileReport, ModelCurrents};
use auv_types::libm;
use written::{File, Stored, Variable};

// Of every file.
const ROWS: usize = 6;
const COLUMNS: usize = 5;
const LEVELS: usize = 3;
const RECORDS: usize = 2;
/// North and east of the current at level `k` from the surface and record `t`, exact in packed numbers.
fn current(t: usize, k: usize) -> [f64; 2] {
    [0.25 - 0.0625 * k as f64, 0.125 + 0.5 * t as f64]
}
const DEPTHS_M: [f64; LEVELS] = [0.0, 10.0, 50.0];

fn latitude(row: usize) -> f64 {
    58.0 + 0.25 * row as f64
}

fn longitude(column: usize) -> f64 {
    10.5 + 0.5 * column as f64
}

/// Metres of water; land in the north-eastern corner.
fn depth_m(row: usize, column: usize) -> f64 {
    if row + column == ROWS + COLUMNS - 2 {
        0.0
    } else {
        40.0 + 10.0 * row as f64 + column as f64
    }
}

fn over(sizes: &[usize], value: impl Fn(&[usize]) -> f64) -> Vec<f64> {
    let count = sizes.iter().product();
    let index = |i: usize| {
        let mut rest = i;
        let mut index = vec![0; sizes.len()];
        for k in (0..sizes.len()).rev() {
            index[k] = rest % sizes[k];
            rest /= sizes[k];
        }
        index
    };
    (0..count).map(|i| value(&index(i))).collect()
}

fn axis(name: &str, count: usize, value: impl Fn(usize) -> f64) -> Variable {
    Variable::new(name, &[name], (0..count).map(value).collect())
}

/// Checks every sounding against the depths above.
fn right_chart((chart, report): &(ChartedDepths, FileReport), told: &str) {
    assert_eq!(chart.shape(), (ROWS, COLUMNS), "{told}");
    for (i, sounding) in chart.soundings().enumerate() {
        let (row, column) = (i / COLUMNS, i % COLUMNS);
        let place = [
            sounding.latitude_deg - latitude(row),
            libm::remainder(sounding.longitude_deg - longitude(column), 360.0),
        ];
        assert!(place.iter().all(|x| x.abs() < 1e-6), "{told}: {sounding:?}");
        let expected = depth_m(row, column);
        match expected > 0.0 {
            true => assert!((sounding.depth_m - expected).abs() < 1e-4, "{told} {i}"),
            false => assert!(
                sounding.depth_m.is_nan() || sounding.depth_m <= 0.0,
                "{told}"
            ),
        }
    }
    assert_eq!(
        report
            .variables
            .last()
            .map(|v| v.role.contains("depth") || v.role.contains("mask")),
        Some(true)
    );
}

/// Checks every velocity in the water against the current above.
fn right_currents(currents: &ModelCurrents, first_unix_s: f64, told: &str) {
    assert_eq!(
        (currents.shape(), currents.layers()),
        ((ROWS, COLUMNS), LEVELS),
        "{told}"
    );
    let times = currents.times_unix_s();
    assert_eq!(times.len(), RECORDS, "{told}");
    for (t, time_s) in times.iter().enumerate() {
        let expected_s = first_unix_s + 3_600.0 * t as f64;
        assert!(
            (time_s - expected_s).abs() < 1.0,
            "{told}: {time_s} {expected_s}"
        );
    }
    let mut wet = 0;
    for (t, k) in (0..RECORDS * LEVELS).map(|i| (i / LEVELS, i % LEVELS)) {
        for point in 0..ROWS * COLUMNS {
            // Layers count from the deepest.
            let met = currents.velocity_mps(t, LEVELS - 1 - k, point / COLUMNS, point % COLUMNS);
            let Some(met) = met else { continue };
            let expected = current(t, k);
            let near = (0..2).all(|i| (f64::from(met[i]) - expected[i]).abs() < 1e-5);
            assert!(near, "{told}: {met:?} {expected:?}");
            wet += 1;
        }
    }
    assert!(
        wet >= RECORDS * LEVELS * (ROWS * COLUMNS - 3),
        "{told}: {wet}"
    );
}

fn surface(name: &str, [y, x]: [&str; 2], sign: f64) -> Variable {
    let depths = over(&[ROWS, COLUMNS], |i| sign * depth_m(i[0], i[1]));
    Variable::new(name, &[y, x], depths)
}

fn degrees([lat, lon]: [&str; 2], [north, east]: [&str; 2]) -> File {
    let mut file = File::new(&[(lat, ROWS), (lon, COLUMNS)]);
    for (variable, units) in [
        (axis(lat, ROWS, latitude), north),
        (axis(lon, COLUMNS, longitude), east),
    ] {
        file.variables.push(match units {
            "" => variable,
            units => variable.with("units", units),
        });
    }
    file
}

/// Latitudes and longitudes of two dimensions.
fn curvilinear(file: File, names: [&str; 2], [y, x]: [&str; 2]) -> File {
    file.with(
        Variable::new(
            names[0],
            &[y, x],
            over(&[ROWS, COLUMNS], |i| latitude(i[0])),
        )
        .with("units", "degrees_north"),
    )
    .with(
        Variable::new(
            names[1],
            &[y, x],
            over(&[ROWS, COLUMNS], |i| longitude(i[1])),
        )
        .with("units", "degrees_east"),
    )
}

#[test]
fn charts_of_many_publishers_are_read() {
    const CF: [&str; 2] = ["degrees_north", "degrees_east"];
    let lat_lon = || degrees(["lat", "lon"], CF);
    let short = |v: Variable| v.stored(Stored::Short);
    let charts = [
        (
            "GEBCO",
            lat_lon().with(
                short(surface("elevation", ["lat", "lon"], -1.0))
                    .with("standard_name", "height_above_mean_sea_level")
                    .with("units", "m"),
            ),
        ),
        (
            "GEBCO with source grid",
            lat_lon()
                .with(
                    short(surface("tid", ["lat", "lon"], 0.0)).with("long_name", "Type Identifier"),
                )
                .with(
                    short(surface("elevation", ["lat", "lon"], -1.0))
                        .with("standard_name", "height_above_reference_ellipsoid")
                        .with("units", "m"),
                ),
        ),
        (
            "EMODnet",
            lat_lon()
                .with(
                    surface("elevation", ["lat", "lon"], -1.0)
                        .with("units", "m")
                        .with("long_name", "Average elevation")
                        .with("standard_name", "sea_floor_altitude")
                        .stored(Stored::Float),
                )
                .with(
                    surface("value_count", ["lat", "lon"], 0.0)
                        .with("long_name", "number of values"),
                )
                .with(
                    surface("stdev", ["lat", "lon"], 0.0)
                        .with("long_name", "standard deviation of the water depth")
                        .with("units", "m"),
                ),
        ),
        (
            "ETOPO",
            degrees(["y", "x"], ["", ""])
                .with(surface("z", ["y", "x"], -1.0).with("long_name", "z")),
        ),
        (
            "ETOPO 2022",
            lat_lon().with(
                surface("z", ["lat", "lon"], -1.0)
                    .with("units", "meters")
                    .with("standard_name", "height")
                    .with("positive", "up"),
            ),
        ),
        (
            "NOAA CUDEM by ERDDAP",
            degrees(["latitude", "longitude"], CF).with(
                short(surface("altitude", ["latitude", "longitude"], -1.0))
                    .with("units", "m")
                    .with("standard_name", "altitude")
                    .with("positive", "up"),
            ),
        ),
        (
            "CMEMS",
            degrees(["latitude", "longitude"], CF)
                .with(
                    surface("deptho_lev", ["latitude", "longitude"], 0.0)
                        .with("standard_name", "model_level_number_at_sea_floor")
                        .with("units", "1"),
                )
                .with(
                    surface("deptho", ["latitude", "longitude"], 1.0)
                        .with("units", "m")
                        .with("standard_name", "sea_floor_depth_below_geoid"),
                ),
        ),
        (
            "NEMO",
            curvilinear(
                File::new(&[("time_counter", 1), ("y", ROWS), ("x", COLUMNS)]),
                ["nav_lat", "nav_lon"],
                ["y", "x"],
            )
            .with(
                Variable::new(
                    "Bathymetry",
                    &["time_counter", "y", "x"],
                    surface("h", ["y", "x"], 1.0).values,
                )
                .with("units", "m")
                .with("coordinates", "nav_lon nav_lat"),
            ),
        ),
        (
            "ROMS",
            curvilinear(
                File::new(&[("eta_rho", ROWS), ("xi_rho", COLUMNS)]),
                ["lat_rho", "lon_rho"],
                ["eta_rho", "xi_rho"],
            )
            .with(
                surface("h", ["eta_rho", "xi_rho"], 1.0)
                    .with("units", "meter")
                    .with("long_name", "bathymetry at RHO-points"),
            )
            .with(Variable::new(
                "mask_rho",
                &["eta_rho", "xi_rho"],
                over(&[ROWS, COLUMNS], |i| f64::from(depth_m(i[0], i[1]) > 0.0)),
            )),
        ),
    ];
    for (told, mut file) in charts {
        if told == "ETOPO" {
            file.var("x").set("long_name", "Longitude");
            file.var("y").set("long_name", "Latitude");
        }
        let read = read_bathymetry(&file.bytes()).unwrap_or_else(|e| panic_with(told, &e));
        right_chart(&read, told);
    }
}

#[expect(clippy::panic, reason = "tests may")]
fn panic_with<T>(told: &str, error: &dyn std::error::Error) -> T {
    panic!("{told}: {error}")
}

/// A component over time, levels, rows and columns, the levels from the surface.
fn component(name: &str, dimensions: &[&str; 4], value: impl Fn([f64; 2]) -> f64) -> Variable {
    let values = over(&[RECORDS, LEVELS, ROWS, COLUMNS], |i| {
        match depth_m(i[2], i[3]) > 0.0 {
            true => value(current(i[0], i[1])),
            false => f64::NAN,
        }
    });
    Variable::new(name, dimensions, values)
}

fn packed(mut variable: Variable, scale: f64, fill: f64) -> Variable {
    for x in &mut variable.values {
        *x = if x.is_nan() { fill } else { *x / scale };
    }
    variable
        .stored(Stored::Short)
        .with_numbers("scale_factor", &[scale])
        .with_numbers("_FillValue", &[fill])
}

/// 2024-05-01 06:00 UTC.
const FIRST_S: f64 = 1_714_543_200.0;

#[test]
fn currents_on_latitudes_and_longitudes_are_read() {
    let all = ["time", "depth", "latitude", "longitude"];
    let base = |units: &str, start: f64, step: f64| {
        let mut file = degrees(["latitude", "longitude"], ["degrees_north", "degrees_east"])
            .with(axis("time", RECORDS, |t| start + step * t as f64).with("units", units))
            .with(
                axis("depth", LEVELS, |k| DEPTHS_M[k])
                    .with("units", "m")
                    .with("positive", "down"),
            );
        file.dimensions
            .extend([("time".into(), RECORDS), ("depth".into(), LEVELS)]);
        file
    };
    let hours = FIRST_S / 3_600.0;
    let cmems = base("hours since 1950-01-01", hours + 175_320.0, 1.0)
        .with(
            packed(component("uo", &all, |c| c[1]), 0.03125, -32_767.0)
                .with("units", "m s-1")
                .with("standard_name", "eastward_sea_water_velocity"),
        )
        .with(
            packed(component("vo", &all, |c| c[0]), 0.03125, -32_767.0)
                .with("units", "m s-1")
                .with("standard_name", "northward_sea_water_velocity"),
        );
    let mut hycom = base("hours since 2000-01-01 00:00:00", hours - 262_968.0, 1.0)
        .with(packed(component("water_u", &all, |c| c[1]), 0.0625, -30_000.0).with("units", "m/s"))
        .with(packed(component("water_v", &all, |c| c[0]), 0.0625, -30_000.0).with("units", "m/s"));
    hycom
        .var("longitude")
        .values
        .iter_mut()
        .for_each(|x| *x += 360.0);
    for (told, file) in [("CMEMS", cmems), ("HYCOM", hycom)] {
        let (currents, report) =
            read_currents(&file.bytes()).unwrap_or_else(|e| panic_with(told, &e));
        right_currents(&currents, FIRST_S, told);
        assert_eq!(report.levels_m, DEPTHS_M, "{told}");
        assert!(report.dropped.is_empty(), "{told}: {:?}", report.dropped);
    }
}

/// Latitudes and longitudes of a grid turned by `angle` from east, and that angle.
fn leaning(file: File, names: [&str; 2], [y, x]: [&str; 2], angle: f64) -> File {
    let (sin, cos) = libm::sincos(angle);
    let wide = libm::cos(latitude(2).to_radians());
    let north = over(&[ROWS, COLUMNS], |i| {
        0.02 * (i[1] as f64 * sin + i[0] as f64 * cos)
    });
    let east = over(&[ROWS, COLUMNS], |i| {
        0.02 * (i[1] as f64 * cos - i[0] as f64 * sin) / wide
    });
    file.with(
        Variable::new(
            names[0],
            &[y, x],
            north.iter().map(|d| latitude(2) + d).collect(),
        )
        .with("units", "degrees_north"),
    )
    .with(
        Variable::new(
            names[1],
            &[y, x],
            east.iter().map(|d| longitude(2) + d).collect(),
        )
        .with("units", "degrees_east"),
    )
}

const LEAN: f64 = 0.4;

/// The current along a leaning grid's rows and columns.
fn along_grid([north, east]: [f64; 2]) -> [f64; 2] {
    let (sin, cos) = libm::sincos(LEAN);
    [east * cos + north * sin, north * cos - east * sin]
}

#[test]
fn currents_along_a_leaning_grid_are_turned() {
    let all = ["time", "depth", "Y", "X"];
    let sizes = [
        ("time", RECORDS),
        ("depth", LEVELS),
        ("Y", ROWS),
        ("X", COLUMNS),
    ];
    let norkyst = leaning(File::new(&sizes), ["lat", "lon"], ["Y", "X"], LEAN)
        .with(
            axis("time", RECORDS, |t| FIRST_S + 3_600.0 * t as f64)
                .with("units", "seconds since 1970-01-01 00:00:00"),
        )
        .with(
            axis("depth", LEVELS, |k| DEPTHS_M[k])
                .with("units", "m")
                .with("positive", "down"),
        )
        .with(
            axis("X", COLUMNS, |i| 800.0 * i as f64)
                .with("standard_name", "projection_x_coordinate")
                .with("units", "m"),
        )
        .with(
            axis("Y", ROWS, |i| 800.0 * i as f64)
                .with("standard_name", "projection_y_coordinate")
                .with("units", "m"),
        )
        .with(
            surface("h", ["Y", "X"], 1.0)
                .with("units", "meter")
                .with("standard_name", "sea_floor_depth_below_sea_level"),
        )
        .with(surface("angle", ["Y", "X"], 0.0).with("units", "radians"))
        .with(
            component("u", &all, |c| along_grid(c)[0])
                .with("units", "meter second-1")
                .with("standard_name", "sea_water_x_velocity"),
        )
        .with(
            component("v", &all, |c| along_grid(c)[1])
                .with("units", "meter second-1")
                .with("standard_name", "sea_water_y_velocity"),
        );
    let with_angle = |mut file: File, units: &str, angle: f64| {
        file.var("angle").values.fill(angle);
        file.var("angle").set("units", units);
        file
    };
    for (told, file) in [
        ("radians", with_angle(norkyst.clone(), "radians", LEAN)),
        (
            "degrees",
            with_angle(norkyst.clone(), "degrees", LEAN.to_degrees()),
        ),
    ] {
        right_currents(&read_currents(&file.bytes()).unwrap().0, FIRST_S, told);
    }
    // NEMO: names alone say that the components go along the grid, whose directions are those of its points.
    let mut nemo = norkyst;
    for (from, to) in [
        ("lat", "nav_lat"),
        ("lon", "nav_lon"),
        ("u", "vozocrtx"),
        ("v", "vomecrty"),
        ("time", "time_counter"),
    ] {
        nemo.rename(from, to);
    }
    for name in ["angle", "X", "Y", "h"] {
        nemo.take_out(name);
    }
    for name in ["vozocrtx", "vomecrty"] {
        nemo.var(name).drop_attribute("standard_name");
    }
    let (currents, report) = read_currents(&nemo.bytes()).unwrap();
    assert!(
        report
            .assumed
            .iter()
            .any(|a| a.contains("turned by the directions")),
        "{:?}",
        report.assumed
    );
    let met = currents.velocity_mps(0, LEVELS - 1, 2, 2).unwrap();
    let expected = current(0, 0);
    assert!(
        (0..2).all(|i| (f64::from(met[i]) - expected[i]).abs() < 2e-3),
        "{met:?}"
    );
}

/// A model whose components lie between its points, levels from the bed up.
fn staggered(names: &[&str; 8], [u, v]: [[&str; 2]; 2]) -> File {
    let [time, level, y, x, ..] = *names;
    let [lat, lon, stretched, clock] = [names[4], names[5], names[6], names[7]];
    let mut sizes = vec![(time, RECORDS), (level, LEVELS), (y, ROWS), (x, COLUMNS)];
    for (name, size) in [
        (u[0], ROWS),
        (u[1], COLUMNS - 1),
        (v[0], ROWS - 1),
        (v[1], COLUMNS),
    ] {
        if !sizes.iter().any(|s| s.0 == name) {
            sizes.push((name, size));
        }
    }
    let between = |rows: usize, columns: usize, k: usize| {
        over(&[RECORDS, LEVELS, rows, columns], |i| {
            along_grid(current(i[0], LEVELS - 1 - i[1]))[k]
        })
    };
    leaning(File::new(&sizes), [lat, lon], [y, x], LEAN)
        .with(Variable::new(
            clock,
            &[time],
            (0..RECORDS).map(|t| 3_600.0 * t as f64).collect(),
        ))
        .with(surface("h", [y, x], 1.0).with("units", "meter"))
        .with(Variable::new(
            "mask_rho",
            &[y, x],
            over(&[ROWS, COLUMNS], |i| f64::from(depth_m(i[0], i[1]) > 0.0)),
        ))
        .with(Variable::new("angle", &[y, x], vec![LEAN; ROWS * COLUMNS]).with("units", "radians"))
        .with(Variable::new(stretched, &[level], vec![-0.9, -0.5, -0.1]))
        .with(Variable::new("Cs_r", &[level], vec![-0.8, -0.3, -0.02]))
        .with(Variable::new("hc", &[], vec![20.0]).with("units", "meter"))
        .with(Variable::new("Vtransform", &[], vec![2.0]))
        .with(
            Variable::new(
                "u",
                &[time, level, u[0], u[1]],
                between(ROWS, COLUMNS - 1, 0),
            )
            .with("units", "meter second-1"),
        )
        .with(
            Variable::new(
                "v",
                &[time, level, v[0], v[1]],
                between(ROWS - 1, COLUMNS, 1),
            )
            .with("units", "meter second-1"),
        )
}

#[test]
fn models_with_components_between_their_points_are_read() {
    let mut roms = staggered(
        &[
            "ocean_time",
            "s_rho",
            "eta_rho",
            "xi_rho",
            "lat_rho",
            "lon_rho",
            "s_rho",
            "ocean_time",
        ],
        [["eta_u", "xi_u"], ["eta_v", "xi_v"]],
    );
    roms.dimensions
        .iter_mut()
        .filter(|d| d.0 == "xi_v")
        .for_each(|d| d.1 = COLUMNS);
    roms.var("ocean_time")
        .set("units", "seconds since 2024-05-01 06:00:00 GMT");
    let mut croco = staggered(
        &[
            "time",
            "s_rho",
            "eta_rho",
            "xi_rho",
            "lat_rho",
            "lon_rho",
            "sc_r",
            "scrum_time",
        ],
        [["eta_rho", "xi_u"], ["eta_v", "xi_rho"]],
    );
    croco.var("scrum_time").set("units", "second");
    for (told, file, first_s) in [("ROMS", roms, FIRST_S), ("CROCO", croco, 0.0)] {
        let (currents, report) =
            read_currents(&file.bytes()).unwrap_or_else(|e| panic_with(told, &e));
        right_currents(&currents, first_s, told);
        // The depth of a layer by Vtransform 2, from the bed up.
        for (layer, (s, c)) in [(-0.9, -0.8), (-0.5, -0.3), (-0.1, -0.02)]
            .into_iter()
            .enumerate()
        {
            let h = depth_m(3, 1);
            let expected = -h * (20.0 * s + h * c) / (20.0 + h);
            let found = currents.depth_m(layer, 3 * COLUMNS + 1);
            assert!(
                (found - expected).abs() < 1e-9,
                "{told}: {found} {expected}"
            );
        }
        assert_eq!(
            report.assumed.iter().any(|a| a.contains("names no date")),
            told == "CROCO"
        );
    }
}
