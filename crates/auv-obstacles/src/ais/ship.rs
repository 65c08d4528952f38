//! A ship of a table of positions, and the true obstacle that it is.

use super::fix::AisFix;
use super::motion::end_velocity;
use super::rest::{as_reported, settled};
use super::row::Row;
use crate::truth::{AfterLastFix, TrackedShip};
use auv_types::Violations;

/// A ship and its reported positions, in order of time.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
pub struct AisShip {
    /// Its name or number. A second ship of one number has ` (2)` behind it.
    pub vessel: String,
    /// AIS code of its type.
    pub vessel_type: Option<u32>,
    /// Length over all, metres.
    pub length_m: Option<f64>,
    /// Beam, metres.
    pub width_m: Option<f64>,
    /// Draught, metres.
    pub draught_m: Option<f64>,
    /// Its positions in order of time, one per time.
    pub fixes: Vec<AisFix>,
}

/// The size assumed for ships that report none.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(deny_unknown_fields)
)]
pub struct AssumedSize {
    /// Length, metres.
    pub length_m: f64,
    /// Draught, metres.
    pub draught_m: f64,
}

impl Default for AssumedSize {
    /// A coaster of 100 m length and 6 m draught: larger than most ships that report no size.
    fn default() -> Self {
        Self {
            length_m: 100.0,
            draught_m: 6.0,
        }
    }
}

impl AisShip {
    /// A ship from its rows in order of time. Of sizes that change the greatest holds.
    pub(super) fn new(vessel: String, rows: &[Row]) -> Self {
        let greatest = |of: fn(&Row) -> Option<f64>| rows.iter().filter_map(of).reduce(f64::max);
        Self {
            vessel,
            vessel_type: rows.iter().find_map(|row| row.vessel_type),
            length_m: greatest(|row| row.length_m),
            width_m: greatest(|row| row.width_m),
            draught_m: greatest(|row| row.draught_m),
            fixes: rows.iter().map(|row| row.fix).collect(),
        }
    }

    /// The ship as a true obstacle. `to_local` converts degrees north and east to metres north and east of
    /// the mission's origin.
    ///
    /// With [`AfterLastFix::HoldCourse`] the ship sails on with the speed and course that it reports; if it
    /// reports none, or that it lies still, the way made good over a minute or more decides. The same holds
    /// before its first fix. Fixes of a ship at rest that differ by their noise alone are one place. With
    /// [`AfterLastFix::Repeat`] the positions alone count, as reported.
    ///
    /// # Errors
    /// Positions that `to_local` does not map to finite metres.
    pub fn tracked(
        &self,
        to_local: &dyn Fn(f64, f64) -> (f64, f64),
        assumed: AssumedSize,
        after_last_fix: AfterLastFix,
    ) -> Result<TrackedShip, Violations> {
        let fixes = match after_last_fix {
            AfterLastFix::Repeat => as_reported(&self.fixes, to_local),
            AfterLastFix::HoldCourse | AfterLastFix::Leave => settled(&self.fixes, to_local),
        };
        let ship = TrackedShip::new(
            fixes,
            self.length_m.unwrap_or(assumed.length_m),
            self.draught_m.unwrap_or(assumed.draught_m),
            after_last_fix,
        )?;
        let backwards: Vec<AisFix> = self.fixes.iter().rev().copied().collect();
        Ok(ship.with_ends([
            end_velocity(&backwards, to_local),
            end_velocity(&self.fixes, to_local),
        ]))
    }
}
