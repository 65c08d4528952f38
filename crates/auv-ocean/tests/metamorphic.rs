//! Two thousand files made from sound ones: meaning kept, lost and contradicted.
#![cfg(feature = "netcdf")]
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    reason = "tests may"
)]
#![allow(clippy::print_stdout, reason = "the table is printed")]

mod written;

use auv_ocean::netcdf::{read_bathymetry, read_currents};
use auv_ocean::{ChartedDepths, LocalFrame, ModelCurrents, SeaBed};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed};
use std::collections::BTreeMap;
use written::{Attribute, File, Stored, Variable, chart, currents};

type Random = ChaCha8Rng;
/// A change of a file that keeps its meaning.
type Kept = (&'static str, fn(&mut File, &mut Random));
/// A change that does not, with the words that its refusal must have.
type Refused = (
    &'static str,
    fn(&mut File, &mut Random),
    &'static [&'static str],
);

fn pick<'a>(random: &mut Random, of: &[&'a str]) -> &'a str {
    of[random.random_range(0..of.len())]
}

/// The variable of a standard name or of one of two names.
fn named(file: &File, standard: &str, other: &str) -> String {
    let is = |v: &&Variable| {
        let told = v
            .attributes
            .iter()
            .any(|a| a.0 == "standard_name" && matches!(&a.1, Attribute::Text(t) if t == standard));
        told || v.name == other
    };
    file.variables
        .iter()
        .find(is)
        .expect("the variable")
        .name
        .clone()
}

fn scaled(file: &mut File, name: &str, units: &str, factor: f64) {
    let variable = file.var(name);
    variable.values.iter_mut().for_each(|x| *x /= factor);
    variable.set("units", units);
}

fn shuffled(file: &mut File, name: &str, random: &mut Random) {
    let n = file.var(name).dimensions.len();
    let mut order: Vec<usize> = (0..n).collect();
    for i in (1..n).rev() {
        order.swap(i, random.random_range(0..=i));
    }
    file.permute(name, &order);
}

fn singleton(file: &mut File, name: &str, random: &mut Random) {
    let dimension = "member";
    if !file.dimensions.iter().any(|d| d.0 == dimension) {
        file.dimensions.push((dimension.into(), 1));
    }
    let variable = file.var(name);
    if !variable.dimensions.iter().any(|d| d == dimension) {
        let at = random.random_range(0..=variable.dimensions.len());
        variable.dimensions.insert(at, dimension.into());
    }
}

/// Missing values as a number that an attribute names, packed or not.
fn filled(file: &mut File, name: &str, random: &mut Random) {
    let fill = [-9999.0, 1e20, -32_768.0, 9.969_209_968_386_869e36][random.random_range(0..4)];
    let variable = file.var(name);
    variable
        .values
        .iter_mut()
        .filter(|x| x.is_nan())
        .for_each(|x| *x = fill);
    let attribute = pick(random, &["_FillValue", "missing_value"]);
    variable.drop_attribute(attribute);
    variable
        .attributes
        .push((attribute.into(), Attribute::Numbers(vec![fill, fill])));
}

const CHART_KEPT: &[Kept] = &[
    ("axes permuted", |f, r| {
        let name = f.variables[2].name.clone();
        shuffled(f, &name, r);
    }),
    ("latitudes fall", |f, _| {
        let d = f.variables[0].dimensions[0].clone();
        f.flip(&d);
    }),
    ("longitudes fall", |f, _| {
        let d = f.variables[1].dimensions[0].clone();
        f.flip(&d);
    }),
    ("other dimension names", |f, r| {
        let (a, b) = (
            f.variables[0].dimensions[0].clone(),
            f.variables[1].dimensions[0].clone(),
        );
        f.rename_dimension(&a, pick(r, &["rows", "j", "dim_0", "north"]));
        f.rename_dimension(&b, pick(r, &["columns", "i", "dim_1", "east"]));
    }),
    ("units and values scaled", |f, r| {
        let (units, factor) = [
            ("feet", 0.3048),
            ("cm", 0.01),
            ("fathoms", 1.8288),
            ("km", 1000.0),
            ("US_survey_foot", 1200.0 / 3937.0),
            ("Meters", 1.0),
        ][r.random_range(0..6)];
        let name = f.variables[2].name.clone();
        scaled(f, &name, units, factor);
    }),
    ("heights, by positive", |f, r| {
        let v = &mut f.variables[2];
        v.values.iter_mut().for_each(|x| *x = -*x);
        v.set("positive", pick(r, &["up", "Up", "UP"]));
        v.drop_attribute("standard_name");
        v.name = "bathymetry".into();
    }),
    ("heights, by standard_name", |f, r| {
        let v = &mut f.variables[2];
        v.values.iter_mut().for_each(|x| *x = -*x);
        v.drop_attribute("positive");
        v.set(
            "standard_name",
            pick(r, &["altitude", "height_above_mean_sea_level", "height"]),
        );
    }),
    ("synonyms of the depth", |f, r| {
        let v = &mut f.variables[2];
        v.name = pick(r, &["Bathymetry", "h", "depth", "q17", "Band1", "bottom"]).into();
    }),
    ("synonyms of positions", |f, r| {
        f.variables[0].name = pick(r, &["nav_lat", "phi", "latitude"]).into();
        f.variables[1].name = pick(r, &["nav_lon", "lambda", "longitude"]).into();
    }),
    ("spellings of degrees", |f, r| {
        f.variables[0].set(
            "units",
            pick(
                r,
                &[
                    "degree_north",
                    "degrees_N",
                    "degreeN",
                    "Degrees_North",
                    "degrees",
                ],
            ),
        );
        f.variables[1].set(
            "units",
            pick(r, &["degree_east", "degrees_E", "degreeE", "degrees"]),
        );
    }),
    ("positions in radians", |f, _| {
        for v in &mut f.variables[..2] {
            v.values.iter_mut().for_each(|x| *x = x.to_radians());
            v.set("units", "radians");
        }
    }),
    ("longitudes from 0 or below -180", |f, r| {
        let turn = if r.random_range(0..2) == 0 {
            360.0
        } else {
            -360.0
        };
        f.variables[1].values.iter_mut().for_each(|x| *x += turn);
        if turn > 0.0 {
            f.variables[1].values.iter_mut().for_each(|x| *x -= 720.0);
        }
    }),
    ("singleton dimension", |f, r| {
        let name = f.variables[2].name.clone();
        singleton(f, &name, r);
    }),
    ("missing by attribute", |f, r| {
        let name = f.variables[2].name.clone();
        filled(f, &name, r);
    }),
    ("two-dimensional positions", |f, _| {
        if f.variables[0].dimensions.len() > 1 {
            return;
        }
        let (rows, columns) = (f.variables[0].values.len(), f.variables[1].values.len());
        let dimensions = vec![
            f.variables[0].dimensions[0].clone(),
            f.variables[1].dimensions[0].clone(),
        ];
        let (lat, lon) = (f.variables[0].values.clone(), f.variables[1].values.clone());
        f.variables[0].values = (0..rows * columns).map(|i| lat[i / columns]).collect();
        f.variables[1].values = (0..rows * columns).map(|i| lon[i % columns]).collect();
        f.variables[0].dimensions.clone_from(&dimensions);
        f.variables[1].dimensions = dimensions;
    }),
];

const CURRENTS_KEPT: &[Kept] = &[
    ("axes permuted", |f, r| {
        for k in [4, 5] {
            let name = f.variables[k].name.clone();
            shuffled(f, &name, r);
        }
    }),
    ("latitudes fall", |f, _| {
        let d = f.variables[2].dimensions[0].clone();
        f.flip(&d);
    }),
    ("longitudes fall", |f, _| {
        let d = f.variables[3].dimensions[0].clone();
        f.flip(&d);
    }),
    ("levels from the bed", |f, _| {
        let d = f.variables[1].dimensions[0].clone();
        f.flip(&d);
    }),
    ("levels as heights", |f, _| {
        let v = &mut f.variables[1];
        v.values.iter_mut().for_each(|x| *x = -*x);
        v.set("positive", "up");
    }),
    ("levels in feet", |f, _| {
        let name = f.variables[1].name.clone();
        scaled(f, &name, "feet", 0.3048);
    }),
    ("velocities scaled", |f, r| {
        let (units, factor) = [
            ("cm/s", 0.01),
            ("cm s-1", 0.01),
            ("mm s**-1", 0.001),
            ("km/h", 1.0 / 3.6),
            ("metre per second", 1.0),
            ("dm s-1", 0.1),
        ][r.random_range(0..6)];
        for k in [4, 5] {
            let name = f.variables[k].name.clone();
            scaled(f, &name, units, factor);
        }
    }),
    ("zones and epochs", |f, r| {
        let (units, shift, factor) = [
            ("hours since 2024-05-01 02:00:00 +02:00", 0.0, 1.0),
            ("hours since 2024-04-30 18:30:00 -05:30", 0.0, 1.0),
            ("minutes since 2024-05-01T00:00:00Z", 0.0, 60.0),
            ("seconds since 2024-05-01 00:00:00 GMT", 0.0, 3600.0),
            ("second since 2024-5-1", 0.0, 3600.0),
            ("days since 2024-04-01 UTC", 720.0, 1.0 / 24.0),
            ("hours since 1950-01-01", 651_576.0, 1.0),
        ][r.random_range(0..7)];
        let v = &mut f.variables[0];
        v.values.iter_mut().for_each(|x| *x = (*x + shift) * factor);
        v.set("units", units);
    }),
    ("calendars", |f, r| {
        f.variables[0].set(
            "calendar",
            pick(r, &["standard", "proleptic_gregorian", "Gregorian"]),
        )
    }),
    ("synonyms of components", |f, r| {
        let (u, v) = [
            ("water_u", "water_v"),
            ("u", "v"),
            ("u_eastward", "v_northward"),
            ("a7", "b7"),
        ][r.random_range(0..4)];
        f.variables[4].name = u.into();
        f.variables[5].name = v.into();
    }),
    ("without standard_name", |f, _| {
        for (k, name) in [(4, "uo"), (5, "vo")] {
            f.variables[k].drop_attribute("standard_name");
            f.variables[k].name = name.into();
        }
    }),
    ("names against standard_name", |f, _| {
        f.variables[4].set("standard_name", "eastward_sea_water_velocity");
        f.variables[5].set("standard_name", "northward_sea_water_velocity");
        f.variables[4].name = "vo".into();
        f.variables[5].name = "uo".into();
    }),
    ("singleton dimension", |f, r| {
        for k in [4, 5] {
            let name = f.variables[k].name.clone();
            singleton(f, &name, r);
        }
    }),
    ("missing by attribute", |f, r| {
        for k in [4, 5] {
            let name = f.variables[k].name.clone();
            filled(f, &name, r);
        }
    }),
    ("a record twice", |f, _| {
        let time = f.variables[0].dimensions[0].clone();
        if f.variables
            .iter()
            .any(|v| v.dimensions.contains(&time) && v.dimensions[0] != time)
        {
            return;
        }
        for v in f
            .variables
            .iter_mut()
            .filter(|v| v.dimensions.first() == Some(&time))
        {
            let n = f.dimensions.iter().find(|d| d.0 == time).unwrap().1;
            let record = v.values.len() / n;
            let again = v.values[2 * record..3 * record].to_vec();
            v.values.splice(3 * record..3 * record, again);
        }
        f.dimensions.iter_mut().find(|d| d.0 == time).unwrap().1 += 1;
    }),
];

const CHART_LOST: &[Refused] = &[
    (
        "unknown unit of depth",
        |f, r| {
            let u = pick(r, &["parsec", "dbar", "furlong", "m s-1"]);
            f.variables[2].set("units", u);
        },
        &["deptho", "units", "give"],
    ),
    (
        "positions without a name",
        |f, r| {
            let k = r.random_range(0..2);
            f.variables[k].attributes.clear();
            f.variables[k].name = "a".into();
        },
        &["variable", "missing", "add or rename"],
    ),
    (
        "no positions",
        |f, r| {
            let k = ["lat", "lon"][r.random_range(0..2)];
            f.take_out(k);
        },
        &["variable", "missing", "add or rename"],
    ),
    (
        "depth without a name",
        |f, _| {
            f.variables[2].attributes.clear();
            f.variables[2].name = "q".into();
        },
        &["variable `depth`", "missing", "add or rename"],
    ),
    (
        "positions in metres",
        |f, _| {
            for (k, n) in [(0, "y"), (1, "x")] {
                f.variables[k].drop_attribute("standard_name");
                f.variables[k].set("units", "m");
                f.variables[k].name = n.into();
            }
        },
        &["units `m`", "degrees"],
    ),
    (
        "direction lost",
        |f, _| {
            let v = &mut f.variables[2];
            v.attributes.retain(|a| a.0 == "units");
            v.name = "depth".into();
        },
        &["depth", "which way", "positive"],
    ),
    (
        "unit of positions unknown",
        |f, r| {
            let u = pick(r, &["gon", "furlongs"]);
            f.variables[0].set("units", u);
        },
        &["lat", "units", "give"],
    ),
    (
        "all land",
        |f, _| f.variables[2].values.iter_mut().for_each(|x| *x = -x.abs()),
        &["deptho", "no water", "positive"],
    ),
    (
        "another ensemble dimension",
        |f, _| {
            f.dimensions.push(("member".into(), 2));
            let v = &mut f.variables[2];
            v.dimensions.insert(0, "member".into());
            let again = v.values.clone();
            v.values.extend(again);
        },
        &["deptho", "give"],
    ),
];

const CURRENTS_LOST: &[Refused] = &[
    (
        "velocity without a unit",
        |f, r| {
            let k = 4 + r.random_range(0..2);
            f.variables[k].drop_attribute("units");
        },
        &["no units", "give"],
    ),
    (
        "unknown unit of velocity",
        |f, r| {
            let u = pick(r, &["m", "m2 s-1", "furlong fortnight-1", "Pa"]);
            f.variables[4].set("units", u);
        },
        &["uo", "units", "give"],
    ),
    (
        "one component",
        |f, r| {
            let n = ["uo", "vo"][r.random_range(0..2)];
            f.take_out(n);
        },
        &["no partner", "give"],
    ),
    (
        "unknown unit of time",
        |f, r| {
            let u = pick(
                r,
                &[
                    "months since 2024-01-01",
                    "fortnights since 2024-01-01",
                    "days since yesterday",
                    "hours since 2024-13-01",
                ],
            );
            f.variables[0].set("units", u);
        },
        &["time", "units", "give"],
    ),
    (
        "time without a unit",
        |f, _| f.variables[0].drop_attribute("units"),
        &["time", "units", "give"],
    ),
    (
        "unknown calendar",
        |f, _| f.variables[0].set("calendar", "mayan"),
        &["time", "calendar", "give"],
    ),
    (
        "levels without depths",
        |f, _| f.take_out("depth"),
        &["depth of the levels", "missing"],
    ),
    (
        "levels in pressure",
        |f, r| {
            let u = pick(r, &["dbar", "Pa", "level"]);
            f.variables[1].set("units", u);
        },
        &["depth", "units", "give"],
    ),
    (
        "times lost",
        |f, _| f.take_out("time"),
        &["time", "missing"],
    ),
    (
        "a day that does not exist",
        |f, _| {
            f.variables[0].set("calendar", "360_day");
            f.variables[0].set("units", "days since 2001-02-20");
        },
        &["time", "does not exist", "give"],
    ),
];

const CHART_AGAINST: &[Refused] = &[
    (
        "latitude in degrees east",
        |f, _| f.variables[0].set("units", "degrees_east"),
        &["lat", "degrees_east", "latitude"],
    ),
    (
        "longitude named latitude",
        |f, _| f.variables[1].set("standard_name", "latitude"),
        &["lon", "degrees_east", "latitude"],
    ),
    (
        "depth that counts upwards",
        |f, _| f.variables[2].set("positive", "up"),
        &["deptho", "positive `up`", "sea_floor_depth"],
    ),
    (
        "degrees with metres",
        |f, _| f.variables[0].values.iter_mut().for_each(|x| *x *= 1e4),
        &["lat", "degrees_north", "values"],
    ),
    (
        "axis against name",
        |f, _| f.variables[0].set("axis", "X"),
        &["lat", "axis `x`", "latitude"],
    ),
    (
        "millimetres called metres",
        |f, _| f.variables[2].values.iter_mut().for_each(|x| *x *= 1e3),
        &["deptho", "units `m`", "values"],
    ),
    (
        "two charts",
        |f, _| {
            let mut again = f.variables[2].clone();
            again.name = "other".into();
            f.variables.push(again);
        },
        &["deptho", "other"],
    ),
];

const CURRENTS_AGAINST: &[Refused] = &[
    (
        "levels below called above",
        |f, _| f.variables[1].set("positive", "up"),
        &["depth", "positive `up`", "values"],
    ),
    (
        "levels above called below",
        |f, _| f.variables[1].values.iter_mut().for_each(|x| *x = -*x),
        &["depth", "positive `down`", "values"],
    ),
    (
        "centimetres called metres",
        |f, _| f.variables[4].values.iter_mut().for_each(|x| *x *= 100.0),
        &["uo", "units `m s-1`", "values"],
    ),
    (
        "both components eastward",
        |f, _| f.variables[5].set("standard_name", "eastward_sea_water_velocity"),
        &["uo", "vo"],
    ),
    (
        "latitude in degrees east",
        |f, _| {
            f.variables[2].set("units", "degrees_east");
            f.variables[2].set("standard_name", "latitude");
        },
        &["latitude", "degrees_east", "standard_name"],
    ),
];

fn close(a: f64, b: f64) -> bool {
    (a.is_nan() && b.is_nan()) || (a - b).abs() <= 1e-9 * a.abs().max(b.abs()).max(1e-3)
}

fn same_chart(a: &ChartedDepths, b: &ChartedDepths, told: &str) {
    assert_eq!(a.shape(), b.shape(), "{told}");
    for (x, y) in sorted(a).into_iter().zip(sorted(b)) {
        assert!(
            close(x[0], y[0]) && close(x[1], y[1]),
            "{told}: {x:?} {y:?}"
        );
        // Land is land, however high.
        let depth = |d: f64| if d > 0.0 { d } else { 0.0 };
        assert!(close(depth(x[2]), depth(y[2])), "{told}: {x:?} {y:?}");
    }
}

/// Latitude, longitude from 0 and depth of every node, from south-west on.
fn sorted(chart: &ChartedDepths) -> Vec<[f64; 3]> {
    let mut all: Vec<[f64; 3]> = chart
        .soundings()
        .map(|s| [s.latitude_deg, s.longitude_deg.rem_euclid(360.0), s.depth_m])
        .collect();
    let key = |x: f64| (x * 1e6).round() as i64;
    all.sort_by_key(|s| (key(s[0]), key(s[1])));
    all
}

fn same_currents(a: &ModelCurrents, b: &ModelCurrents, told: &str) {
    assert_eq!((a.shape(), a.layers()), (b.shape(), b.layers()), "{told}");
    assert_eq!(a.times_unix_s().len(), b.times_unix_s().len(), "{told}");
    for (x, y) in a.times_unix_s().iter().zip(b.times_unix_s()) {
        assert!((x - y).abs() < 1e-5, "{told}: {x} {y}");
    }
    let (rows, columns) = a.shape();
    for (x, y) in a.places_deg().zip(b.places_deg()) {
        assert!(close(x[0], y[0]) && close(x[1], y[1]), "{told}");
    }
    for time in 0..a.times_unix_s().len() {
        for layer in 0..a.layers() {
            assert!(close(a.depth_m(layer, 0), b.depth_m(layer, 0)), "{told}");
            for point in 0..rows * columns {
                let of = |m: &ModelCurrents| {
                    m.velocity_mps(time, layer, point / columns, point % columns)
                };
                match (of(a), of(b)) {
                    (Some(x), Some(y)) => assert!(
                        (0..2).all(|k| close(x[k].into(), y[k].into())),
                        "{told}: {x:?} {y:?}"
                    ),
                    (x, y) => assert_eq!(x.is_some(), y.is_some(), "{told}"),
                }
            }
        }
    }
}

/// One to four changes of a list, each at most once, in any order.
fn changed(
    mut file: File,
    changes: &[Kept],
    random: &mut Random,
    counts: &mut BTreeMap<String, usize>,
    kind: &str,
) -> (File, String) {
    let mut told = Vec::new();
    for _ in 0..random.random_range(1..=4) {
        let (name, change) = changes[random.random_range(0..changes.len())];
        // Both turn the sign, or both name the components.
        let twice = told.iter().any(|t: &&str| {
            *t == name || (t.starts_with("heights") && name.starts_with("heights"))
        });
        let names = [
            "synonyms of components",
            "without standard_name",
            "names against standard_name",
        ];
        let renamed = names.contains(&name) && told.iter().any(|t| names.contains(t));
        let degrees = ["spellings of degrees", "longitudes from 0 or below -180"];
        let turned = (name == "positions in radians" && told.iter().any(|t| degrees.contains(t)))
            || (degrees.contains(&name) && told.contains(&"positions in radians"));
        // A name that counts upwards or downwards by itself needs its attributes.
        if twice
            || renamed
            || turned
            || (name == "synonyms of the depth" && told.contains(&"heights, by positive"))
        {
            continue;
        }
        change(&mut file, random);
        *counts.entry(format!("kept, {kind}: {name}")).or_default() += 1;
        told.push(name);
    }
    (file, told.join(", "))
}

fn refused<T>(
    changes: &[Refused],
    sound: fn() -> File,
    read: impl Fn(&[u8]) -> Result<T, String>,
    case: usize,
    random: &mut Random,
) -> &'static str {
    let (name, change, words) = changes[case % changes.len()];
    let mut file = sound();
    change(&mut file, random);
    let Err(message) = read(&file.bytes()) else {
        panic!("{name}: read")
    };
    for word in words {
        assert!(
            message.contains(word),
            "{name}: `{word}` is not in: {message}"
        );
    }
    name
}

#[test]
fn meaning_kept_is_read_and_meaning_lost_or_contradicted_is_refused() {
    let mut random = Seed(21).stream(0);
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    let sound_chart = read_bathymetry(&chart().bytes()).unwrap().0;
    let sound_currents = read_currents(&currents().bytes()).unwrap().0;
    let frame = LocalFrame::new(sound_chart.centre().unwrap()).unwrap();
    let bed = sound_chart.to_bed(&frame, 150.0).unwrap();
    for case in 0..650 {
        let (file, told) = changed(chart(), CHART_KEPT, &mut random, &mut counts, "chart");
        let (found, _) = read_bathymetry(&file.bytes()).unwrap_or_else(|e| panic!("{told}: {e}"));
        same_chart(&sound_chart, &found, &told);
        // Falling two-dimensional positions keep their order, and shoals their side of a cell.
        if case % 10 == 0 && !told.contains("two-dimensional") {
            let again = found.to_bed(&frame, 150.0).unwrap();
            for (n, e) in [
                (0.0, 0.0),
                (333.0, -777.0),
                (-1500.0, 900.0),
                (-60.0, -390.0),
            ] {
                assert!(close(bed.depth_at(n, e), again.depth_at(n, e)), "{told}");
            }
        }
    }
    for _ in 0..600 {
        let (file, told) = changed(
            currents(),
            CURRENTS_KEPT,
            &mut random,
            &mut counts,
            "current",
        );
        let (found, _) = read_currents(&file.bytes()).unwrap_or_else(|e| panic!("{told}: {e}"));
        same_currents(&sound_currents, &found, &told);
    }
    let read_chart = |bytes: &[u8]| read_bathymetry(bytes).map_err(|e| e.to_string());
    let read_model = |bytes: &[u8]| read_currents(bytes).map_err(|e| e.to_string());
    for case in 0..210 {
        let name = refused(CHART_LOST, chart, read_chart, case, &mut random);
        *counts.entry(format!("lost, chart: {name}")).or_default() += 1;
        let name = refused(CURRENTS_LOST, currents, read_model, case, &mut random);
        *counts.entry(format!("lost, current: {name}")).or_default() += 1;
    }
    for case in 0..165 {
        let name = refused(CHART_AGAINST, chart, read_chart, case, &mut random);
        *counts
            .entry(format!("contradicted, chart: {name}"))
            .or_default() += 1;
        let name = refused(CURRENTS_AGAINST, currents, read_model, case, &mut random);
        *counts
            .entry(format!("contradicted, current: {name}"))
            .or_default() += 1;
    }
    println!(
        "650 + 600 files kept their meaning: all read. 420 lost it, 330 contradict themselves: all refused."
    );
    println!("| change | files |\n|---|---|");
    for (name, count) in &counts {
        println!("| {name} | {count} |");
    }
    let _ = (named as fn(&File, &str, &str) -> String, Stored::Short);
}
