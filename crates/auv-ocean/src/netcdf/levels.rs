//! The depths of a model's layers.

use super::roles::{Axis, axis_of};
use super::source::{Found, NetcdfError, Source};
use crate::model_currents::LayerDepths;
use crate::plausible::DEEPEST_M;
use crate::units::{self, Quantity};
use crate::{ChartedDepths, FileReport};

/// Layers from the deepest up.
pub(super) struct Layers {
    pub(super) depths_m: LayerDepths,
    /// The stored index of each.
    pub(super) order: Vec<usize>,
}

/// The layers along a dimension of a component, or the only one.
///
/// # Errors
/// Layers without depths, unknown units, attributes against the values.
pub(super) fn layers(
    source: &Source,
    dimension: Option<&str>,
    bathymetry: Option<&ChartedDepths>,
    report: &mut FileReport,
) -> Result<Layers, NetcdfError> {
    let Some(dimension) = dimension else {
        report
            .assumed
            .push("the current has no depth: it holds from the surface to the bed".into());
        return Ok(Layers {
            depths_m: LayerDepths::Level(vec![0.0]),
            order: vec![0],
        });
    };
    let along = |found: &Found<'_>| matches!(found.dimensions(), [own] if own.name == dimension);
    let terrain = source.all().find(|found| {
        along(found)
            && (found.word("standard_name").starts_with("ocean_s")
                || ["s_rho", "sc_r", "sigma"].contains(&found.name()))
    });
    let stretched = terrain.is_some() || source.numbers("sc_r").is_some();
    if let (true, Some(chart)) = (stretched, bathymetry)
        && (source.numbers("Cs_r").is_some() || terrain.is_some())
    {
        return terrain_following(source, terrain, chart, report);
    }
    for found in source.all().filter(along) {
        if axis_of(&found)? == Some(Axis::Level) {
            return fixed(&found, report);
        }
    }
    Err(NetcdfError::Missing {
        variable: "depth of the levels",
        looked_for: format!(
            "a variable over `{dimension}` with standard_name depth, or depth, lev, s_rho with Cs_r, hc and h"
        ),
    })
}

/// Levels of one depth everywhere.
fn fixed(found: &Found<'_>, report: &mut FileReport) -> Result<Layers, NetcdfError> {
    let units = found.text("units");
    let factor = match &units {
        None => {
            report
                .assumed
                .push(format!("`{}` has no units: taken as metres", found.name()));
            1.0
        }
        Some(units) => units::factor(units, Quantity::Length).ok_or_else(|| {
            found.error(format!(
                "has units `{units}`; give levels in metres, for instance by interpolation"
            ))
        })?,
    };
    let mut depths_m = found.values()?;
    let upwards = counts_upwards(found, &depths_m, report)?;
    let factor = if upwards { -factor } else { factor };
    if !units::is_one(factor) {
        for depth_m in &mut depths_m {
            // No level is at minus zero.
            *depth_m = *depth_m * factor + 0.0;
        }
        report
            .converted
            .push(format!("`{}` to depths in metres", found.name()));
    }
    if !depths_m.iter().all(|z| (-1.0..=DEEPEST_M).contains(z)) {
        return Err(
            found.error("is no list of depths within 11,100 m; give metres below the surface")
        );
    }
    let mut order: Vec<usize> = (0..depths_m.len()).collect();
    order.sort_by(|&a, &b| depths_m[b].total_cmp(&depths_m[a]));
    let sorted: Vec<f64> = order.iter().map(|&i| depths_m[i]).collect();
    if sorted.windows(2).any(|pair| pair[0] <= pair[1]) {
        return Err(found.error("has one depth twice; take one level out with `ncks -d`"));
    }
    report.levels_m = sorted.iter().rev().copied().collect();
    report
        .variables
        .push(found.report("levels").with_values(&depths_m));
    Ok(Layers {
        depths_m: LayerDepths::Level(sorted),
        order,
    })
}

/// Whether the values of a level axis are heights.
fn counts_upwards(
    found: &Found<'_>,
    values: &[f64],
    report: &mut FileReport,
) -> Result<bool, NetcdfError> {
    let below = values.iter().all(|&z| z <= 0.0) && values.iter().any(|&z| z < 0.0);
    let above = values.iter().all(|&z| z >= 0.0) && values.iter().any(|&z| z > 0.0);
    let positive = found.word("positive");
    let standard = found.word("standard_name");
    let upwards = match (positive.as_str(), standard.as_str()) {
        ("up", _) => true,
        ("down", _) => false,
        (_, "height" | "altitude") => true,
        (_, "depth") => false,
        _ => {
            if below {
                report
                    .assumed
                    .push(format!("`{}` is negative: taken as heights", found.name()));
            }
            below
        }
    };
    if (upwards && above) || (!upwards && below) {
        let stated = if positive.is_empty() {
            format!("standard_name `{standard}`")
        } else {
            format!("positive `{positive}`")
        };
        return Err(found.contradiction(
            &stated,
            format!(
                "its values, like {}",
                values
                    .iter()
                    .copied()
                    .find(|z| z.abs() > 0.0)
                    .unwrap_or_default()
            ),
            "correct the attribute with `ncatted`",
        ));
    }
    Ok(upwards)
}

/// Terrain-following layers of the Regional Ocean Modeling System, for a surface at rest.
fn terrain_following(
    source: &Source,
    terrain: Option<Found<'_>>,
    bathymetry: &ChartedDepths,
    report: &mut FileReport,
) -> Result<Layers, NetcdfError> {
    let missing = |looked_for: &str| NetcdfError::Missing {
        variable: "layers",
        looked_for: looked_for.into(),
    };
    let number = |name: &str| source.numbers(name).transpose();
    let levels = match terrain {
        Some(found) => found.values()?,
        None => number("sc_r")?.ok_or_else(|| missing("s_rho, sc_r"))?,
    };
    let curves = number("Cs_r")?.ok_or_else(|| missing("Cs_r"))?;
    let critical_m = match number("hc")?.as_deref() {
        Some(&[value]) if value.is_finite() => value,
        _ => return Err(missing("hc (one number)")),
    };
    let transform = match number("Vtransform")?.as_deref() {
        Some(&[value]) if value.is_finite() => value,
        _ => {
            report
                .assumed
                .push("no Vtransform: layers are those of Vtransform = 1".into());
            1.0
        }
    };
    let order = upwards_order(terrain, &levels, &curves)?;
    let mut depths_m = Vec::with_capacity(levels.len() * bathymetry.depths_m().len());
    for &layer in &order {
        let (s, c) = (levels[layer], curves[layer]);
        depths_m.extend(bathymetry.depths_m().iter().map(|&h| {
            let z = if transform < 1.5 {
                critical_m * s + (h - critical_m) * c
            } else {
                h * (critical_m * s + h * c) / (critical_m + h)
            };
            -z
        }));
    }
    if let Some(found) = terrain {
        report.variables.push(
            found
                .report("terrain-following layers")
                .with_values(&levels),
        );
    }
    Ok(Layers {
        depths_m: LayerDepths::Point(depths_m),
        order,
    })
}

/// The layers from the bottom up.
fn upwards_order(
    terrain: Option<Found<'_>>,
    levels: &[f64],
    curves: &[f64],
) -> Result<Vec<usize>, NetcdfError> {
    let rising = levels.windows(2).all(|pair| pair[0] < pair[1]);
    let falling = levels.windows(2).all(|pair| pair[0] > pair[1]);
    let sound = !levels.is_empty() && (rising || falling) && curves.len() == levels.len();
    if !sound || !levels.iter().chain(curves).all(|c| c.is_finite()) {
        return Err(NetcdfError::Data {
            variable: terrain.map_or("sc_r", |found| found.name()).into(),
            reason: "or `Cs_r` is not finite and in order, one value for each layer; give layers from the bottom up".into(),
        });
    }
    let mut order: Vec<usize> = (0..levels.len()).collect();
    if falling && levels.len() > 1 {
        order.reverse();
    }
    Ok(order)
}
