//! Echoes of what is known already: charted obstacles, and ships that their transponders report.

use crate::{Detection, Region, RegionShape};

/// Whether an echo comes from a charted obstacle: it has the place and size of one, or, for a sonar that sees
/// the near face only, lies within one. A vehicle that is unsure of its place may see it elsewhere.
pub(super) fn is_of(
    charted: &[Region],
    echo: &Detection,
    time_s: f64,
    (near_face, place_error_m): (bool, f64),
) -> bool {
    let mut there = charted.iter().filter(|region| region.exists_at(time_s));
    there.any(|region| {
        let distance_m = distance_m(region, echo, time_s);
        let radius_m = region.radius_at(time_s);
        let same = distance_m <= 5.0 * echo.position_sigma_m + place_error_m
            && (echo.radius_m - radius_m).abs() <= 5.0 * echo.radius_sigma_m;
        same || near_face && lies_within(region, echo, time_s, place_error_m)
    })
}

/// Whether an echo lies within one of the ships reported, at their depths, but for the error of the vehicle's place.
pub(super) fn is_within(
    ships: &[Region],
    echo: &Detection,
    time_s: f64,
    place_error_m: f64,
) -> bool {
    let mut there = ships.iter().filter(|ship| ship.exists_at(time_s));
    there.any(|ship| {
        let RegionShape::Cylinder { top_m, bottom_m } = ship.shape else {
            return lies_within(ship, echo, time_s, place_error_m);
        };
        let (z, noise_m) = (echo.position.z, 3.0 * echo.position_sigma_m);
        let deep = (top_m - noise_m..=bottom_m + noise_m).contains(&z);
        deep && lies_within(ship, echo, time_s, place_error_m)
    })
}

/// Whether all of an echo lies within a region, but for three standard deviations and an error of place.
fn lies_within(region: &Region, echo: &Detection, time_s: f64, place_error_m: f64) -> bool {
    let sigma_m = echo.position_sigma_m + echo.radius_sigma_m;
    let reach_m = distance_m(region, echo, time_s) + echo.radius_m;
    reach_m <= region.radius_at(time_s) + 3.0 * sigma_m + place_error_m
}

/// Distance between the centres; horizontal for a cylinder, metres.
fn distance_m(region: &Region, echo: &Detection, time_s: f64) -> f64 {
    let offset = echo.position - region.centre_at(time_s);
    match region.shape {
        RegionShape::Ball => offset.norm(),
        RegionShape::Cylinder { .. } => offset.xy().norm(),
    }
}
