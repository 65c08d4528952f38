//! Which echoes are used, and with which errors.

use crate::{Detection, Sonar};
use auv_types::Point3;

/// Nothing that an echo or a fix names lies farther along an axis, metres.
pub(super) const FARTHEST_M: f64 = 1e7;
/// Nothing in the sea moves faster, m/s.
const FASTEST_MPS: f64 = 50.0;
/// Greatest error of a position or radius, as a share of the range.
const VAGUEST: f64 = 0.1;
/// Greatest radius, in ranges.
const WIDEST: f64 = 10.0;

/// The echo with invalid errors replaced and an invalid velocity dropped; `None` if its position or size
/// is invalid.
pub(super) fn mended(echo: &Detection, sonar: &Sonar) -> Option<Detection> {
    let size = |x: f64| (0.0..=FARTHEST_M).contains(&x);
    let place = |x: &f64| x.abs() <= FARTHEST_M;
    if !echo.position.iter().all(place) || !size(echo.radius_m) {
        return None;
    }
    let or = |valid: bool, given: f64, own: f64| if valid && size(given) { given } else { own };
    let velocity = echo
        .velocity
        .filter(|velocity| velocity.norm() <= FASTEST_MPS && size(echo.velocity_sigma_mps));
    Some(Detection {
        velocity,
        position_sigma_m: or(
            echo.position_sigma_m > 0.0,
            echo.position_sigma_m,
            vague_m(sonar).max(1.0),
        ),
        radius_sigma_m: or(true, echo.radius_sigma_m, sonar.radius_sigma_m),
        ..*echo
    })
}

/// Whether an echo can come from within the sonar's range, with a size and errors that such an echo has.
pub(super) fn is_plausible(echo: &Detection, from: &Point3<f64>, sonar: &Sonar) -> bool {
    let range_m = sonar.range_m;
    let nominal_m = vague_m(sonar).max(sonar.radius_sigma_m).max(1.0);
    let vaguest_m = (VAGUEST * range_m).max(2.0 * nominal_m);
    let vague = echo.position_sigma_m > vaguest_m || echo.radius_sigma_m > vaguest_m;
    let noise_m = echo.position_sigma_m + echo.radius_sigma_m;
    let reach_m = 1.1 * range_m + echo.radius_m + 10.0 * noise_m;
    !vague && echo.radius_m <= WIDEST * range_m && (echo.position - from).norm() <= reach_m
}

/// The error of a position at the end of the range, metres.
fn vague_m(sonar: &Sonar) -> f64 {
    sonar.position_sigma_m + sonar.angle_sigma_rad * sonar.range_m
}
