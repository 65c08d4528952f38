//! Changes of a file after which it means nothing, or two things.

use crate::kept::pick;
use crate::written::File;
use auv_types::ChaCha8Rng as Random;
use auv_types::rand::RngExt;

/// A change by its name, with the words that its refusal must have.
pub(crate) type Refused = (
    &'static str,
    fn(&mut File, &mut Random),
    &'static [&'static str],
);

pub(crate) const CHART_LOST: &[Refused] = &[
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
            f.dimensions.push(("ensemble".into(), 2));
            let v = &mut f.variables[2];
            v.dimensions.insert(0, "ensemble".into());
            let again = v.values.clone();
            v.values.extend(again);
        },
        &["deptho", "give"],
    ),
];

pub(crate) const CURRENTS_LOST: &[Refused] = &[
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

pub(crate) const CHART_AGAINST: &[Refused] = &[
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

pub(crate) const CURRENTS_AGAINST: &[Refused] = &[
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
