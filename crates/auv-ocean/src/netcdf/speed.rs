//! Components of the current in metres per second.

use super::source::{Found, NetcdfError};
use crate::FileReport;
use crate::plausible::{FASTEST_MPS, Implausible, mask_velocities};
use crate::units::{self, Quantity};

/// A factor to m/s.
pub(super) type Unit = f64;

/// The factor of a component's units to m/s.
pub(super) fn unit_of(found: &Found<'_>) -> Result<Unit, NetcdfError> {
    let units = found.text("units").ok_or_else(|| {
        found.error(format!(
            "has no units; give them, for instance with `ncatted -a units,{},o,c,\"m s-1\"`",
            found.name()
        ))
    })?;
    units::factor(&units, Quantity::Speed)
        .ok_or_else(|| found.error(format!("has units `{units}`; give m s-1, cm s-1 or knots")))
}

/// Converts a component to m/s, with NaN for what no current has.
pub(super) fn in_mps(
    found: &Found<'_>,
    unit: Unit,
    values: &mut [f64],
    report: &mut FileReport,
) -> Result<(), NetcdfError> {
    let units = found.text("units").unwrap_or_default();
    if !units::is_one(unit) {
        for value in values.iter_mut() {
            *value *= unit;
        }
        report
            .converted
            .push(format!("`{}` from {units} to m/s", found.name()));
    }
    match mask_velocities(values) {
        Implausible::None => {}
        Implausible::Filled(count, one) => report.dropped.push(format!(
            "`{}`: {count} values like {one} m/s are no current and count as land",
            found.name()
        )),
        Implausible::AnotherUnit(one) => {
            return Err(found.contradiction(
                &format!("units `{units}`"),
                format!("its values: {one} m/s, above {FASTEST_MPS} m/s"),
                "correct the units with `ncatted -a units`",
            ));
        }
    }
    report
        .variables
        .push(found.report("current, m/s").with_values(values));
    Ok(())
}
