//! Changes of a file that keep its meaning.

use crate::written::{Attribute, File};
use auv_types::ChaCha8Rng as Random;
use auv_types::rand::RngExt;

/// A change by its name, and whether it changes the arrangement of the file alone: no name, unit or sign.
pub(crate) type Kept = (&'static str, fn(&mut File, &mut Random), bool);

/// Whether a change may follow others: each is made once, and no two of the same thing.
pub(crate) fn go_together(told: &[&str], next: &str) -> bool {
    const APART: &[&[&str]] = &[
        &["heights, by positive", "heights, by standard_name"],
        // A name that counts upwards or downwards by itself needs its attributes.
        &["heights, by positive", "synonyms of the depth"],
        &[
            "synonyms of components",
            "without standard_name",
            "names against standard_name",
        ],
        &["positions in radians", "spellings of degrees"],
        &["positions in radians", "longitudes from 0 or below -180"],
    ];
    let both = |a: &str, b: &str| APART.iter().any(|set| set.contains(&a) && set.contains(&b));
    !told.iter().any(|&t| t == next || both(t, next))
}

pub(crate) fn pick<'a>(random: &mut Random, of: &[&'a str]) -> &'a str {
    of[random.random_range(0..of.len())]
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

pub(crate) const CHART_KEPT: &[Kept] = &[
    (
        "axes permuted",
        |f, r| {
            let name = f.variables[2].name.clone();
            shuffled(f, &name, r);
        },
        true,
    ),
    (
        "latitudes fall",
        |f, _| {
            let d = f.variables[0].dimensions[0].clone();
            f.flip(&d);
        },
        true,
    ),
    (
        "longitudes fall",
        |f, _| {
            let d = f.variables[1].dimensions[0].clone();
            f.flip(&d);
        },
        true,
    ),
    (
        "other dimension names",
        |f, r| {
            let (a, b) = (
                f.variables[0].dimensions[0].clone(),
                f.variables[1].dimensions[0].clone(),
            );
            f.rename_dimension(&a, pick(r, &["rows", "j", "dim_0", "north"]));
            f.rename_dimension(&b, pick(r, &["columns", "i", "dim_1", "east"]));
        },
        true,
    ),
    (
        "units and values scaled",
        |f, r| {
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
        },
        false,
    ),
    (
        "heights, by positive",
        |f, r| {
            let v = &mut f.variables[2];
            v.values.iter_mut().for_each(|x| *x = -*x);
            v.set("positive", pick(r, &["up", "Up", "UP"]));
            v.drop_attribute("standard_name");
            v.name = "bathymetry".into();
        },
        false,
    ),
    (
        "heights, by standard_name",
        |f, r| {
            let v = &mut f.variables[2];
            v.values.iter_mut().for_each(|x| *x = -*x);
            v.drop_attribute("positive");
            v.set(
                "standard_name",
                pick(r, &["altitude", "height_above_mean_sea_level", "height"]),
            );
        },
        false,
    ),
    (
        "synonyms of the depth",
        |f, r| {
            let v = &mut f.variables[2];
            v.name = pick(r, &["Bathymetry", "h", "depth", "q17", "Band1", "bottom"]).into();
        },
        false,
    ),
    (
        "synonyms of positions",
        |f, r| {
            f.variables[0].name = pick(r, &["nav_lat", "phi", "latitude"]).into();
            f.variables[1].name = pick(r, &["nav_lon", "lambda", "longitude"]).into();
        },
        false,
    ),
    (
        "spellings of degrees",
        |f, r| {
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
        },
        false,
    ),
    (
        "positions in radians",
        |f, _| {
            for v in &mut f.variables[..2] {
                v.values.iter_mut().for_each(|x| *x = x.to_radians());
                v.set("units", "radians");
            }
        },
        false,
    ),
    (
        "longitudes from 0 or below -180",
        |f, r| {
            let turn = if r.random_range(0..2) == 0 {
                360.0
            } else {
                -360.0
            };
            f.variables[1].values.iter_mut().for_each(|x| *x += turn);
            if turn > 0.0 {
                f.variables[1].values.iter_mut().for_each(|x| *x -= 720.0);
            }
        },
        false,
    ),
    (
        "singleton dimension",
        |f, r| {
            let name = f.variables[2].name.clone();
            singleton(f, &name, r);
        },
        true,
    ),
    (
        "missing by attribute",
        |f, r| {
            let name = f.variables[2].name.clone();
            filled(f, &name, r);
        },
        true,
    ),
    (
        "two-dimensional positions",
        |f, _| {
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
        },
        false,
    ),
];

pub(crate) const CURRENTS_KEPT: &[Kept] = &[
    (
        "axes permuted",
        |f, r| {
            for k in [4, 5] {
                let name = f.variables[k].name.clone();
                shuffled(f, &name, r);
            }
        },
        true,
    ),
    (
        "latitudes fall",
        |f, _| {
            let d = f.variables[2].dimensions[0].clone();
            f.flip(&d);
        },
        true,
    ),
    (
        "longitudes fall",
        |f, _| {
            let d = f.variables[3].dimensions[0].clone();
            f.flip(&d);
        },
        true,
    ),
    (
        "levels from the bed",
        |f, _| {
            let d = f.variables[1].dimensions[0].clone();
            f.flip(&d);
        },
        true,
    ),
    (
        "levels as heights",
        |f, _| {
            let v = &mut f.variables[1];
            v.values.iter_mut().for_each(|x| *x = -*x);
            v.set("positive", "up");
        },
        false,
    ),
    (
        "levels in feet",
        |f, _| {
            let name = f.variables[1].name.clone();
            scaled(f, &name, "feet", 0.3048);
        },
        false,
    ),
    (
        "velocities scaled",
        |f, r| {
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
        },
        false,
    ),
    (
        "zones and epochs",
        |f, r| {
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
        },
        false,
    ),
    (
        "calendars",
        |f, r| {
            f.variables[0].set(
                "calendar",
                pick(r, &["standard", "proleptic_gregorian", "Gregorian"]),
            )
        },
        true,
    ),
    (
        "synonyms of components",
        |f, r| {
            let (u, v) = [
                ("water_u", "water_v"),
                ("u", "v"),
                ("u_eastward", "v_northward"),
                ("a7", "b7"),
            ][r.random_range(0..4)];
            f.variables[4].name = u.into();
            f.variables[5].name = v.into();
        },
        false,
    ),
    (
        "without standard_name",
        |f, _| {
            for (k, name) in [(4, "uo"), (5, "vo")] {
                f.variables[k].drop_attribute("standard_name");
                f.variables[k].name = name.into();
            }
        },
        false,
    ),
    (
        "names against standard_name",
        |f, _| {
            f.variables[4].set("standard_name", "eastward_sea_water_velocity");
            f.variables[5].set("standard_name", "northward_sea_water_velocity");
            f.variables[4].name = "vo".into();
            f.variables[5].name = "uo".into();
        },
        false,
    ),
    (
        "singleton dimension",
        |f, r| {
            for k in [4, 5] {
                let name = f.variables[k].name.clone();
                singleton(f, &name, r);
            }
        },
        true,
    ),
    (
        "missing by attribute",
        |f, r| {
            for k in [4, 5] {
                let name = f.variables[k].name.clone();
                filled(f, &name, r);
            }
        },
        true,
    ),
    (
        "a record twice",
        |f, _| {
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
        },
        false,
    ),
];
