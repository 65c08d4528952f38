//! The values of a latitude or longitude in degrees.

use super::source::{Found, NetcdfError};
use crate::units::{self, Quantity};
use crate::{FileReport, VariableReport};

/// The values of a coordinate in degrees. Values beyond the limit become NaN where they are few.
pub(super) fn degrees(
    found: &Found<'_>,
    role: &str,
    limit: f64,
    report: &mut FileReport,
) -> Result<Vec<f64>, NetcdfError> {
    let units = found.text("units");
    let factor = match &units {
        None => {
            report
                .assumed
                .push(format!("`{}` has no units: taken as degrees", found.name()));
            1.0
        }
        Some(units) => units::factor(units, Quantity::Angle).ok_or_else(|| {
            found.error(format!(
                "has units `{units}`; give degrees_north or degrees_east"
            ))
        })?,
    };
    let mut values = found.values()?;
    if !units::is_one(factor) {
        for value in &mut values {
            *value *= factor;
        }
        report.converted.push(format!(
            "`{}` from {} to degrees",
            found.name(),
            units.as_deref().unwrap_or_default()
        ));
    }
    if limit > 180.0 {
        within_a_circle(found, &mut values, report);
    }
    let missing = values.iter().filter(|x| !x.is_finite()).count();
    if missing > 0 {
        report.dropped.push(format!(
            "`{}`: {missing} values are missing and leave holes",
            found.name()
        ));
    }
    drop_beyond(found, &mut values, (role, limit), report)?;
    let own = found.report(role);
    report
        .variables
        .push(VariableReport::with_values(own, &values));
    Ok(values)
}

/// Counts longitudes behind a whole circle from 0 again: some grids begin in the east.
fn within_a_circle(found: &Found<'_>, longitudes: &mut [f64], report: &mut FileReport) {
    let behind = |x: f64| x > 360.0 && x <= 540.0;
    if !longitudes.iter().any(|&x| behind(x)) {
        return;
    }
    for x in longitudes.iter_mut().filter(|x| behind(**x)) {
        *x -= 360.0;
    }
    report.converted.push(format!(
        "`{}` beyond 360 degrees to those from 0",
        found.name()
    ));
}

/// Takes out values beyond a limit where they are few.
fn drop_beyond(
    found: &Found<'_>,
    values: &mut [f64],
    (role, limit): (&str, f64),
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    let sound = values.iter().filter(|x| x.is_finite()).count();
    let beyond = |x: f64| x.abs() > limit + 1e-6;
    let wrong = values
        .iter()
        .filter(|x| x.is_finite() && beyond(**x))
        .count();
    if wrong * 10 > sound {
        let worst = values
            .iter()
            .copied()
            .find(|x| x.is_finite() && beyond(*x))
            .unwrap_or_default();
        let units = found.text("units").unwrap_or_else(|| "degrees".into());
        return Err(found.contradiction(
            &format!("units `{units}`"),
            format!("its values, like {worst}"),
            "give degrees of latitude within 90 and of longitude within 360",
        ));
    }
    if wrong > 0 {
        report.dropped.push(format!(
            "`{}`: {wrong} values are no {role} and leave holes",
            found.name()
        ));
        for value in values {
            if beyond(*value) {
                *value = f64::NAN;
            }
        }
    }
    Ok(())
}
