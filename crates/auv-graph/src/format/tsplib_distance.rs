//! TSPLIB's distances between coordinates.

use super::node_scores::ScoredPlace;
use auv_types::libm;

/// A distance between two places of a file.
pub(super) type Distance = fn(&ScoredPlace, &ScoredPlace) -> f64;

/// The formula that `EDGE_WEIGHT_TYPE` names.
pub(super) fn named(weight_type: &str) -> Option<Distance> {
    Some(match weight_type {
        "EUC_2D" => euclidean,
        "CEIL_2D" => euclidean_ceiling,
        "ATT" => pseudo_euclidean,
        "GEO" => geographical,
        _ => return None,
    })
}

fn straight(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    (dx * dx + dy * dy).sqrt()
}

/// TSPLIB's `EUC_2D`: to the nearest integer.
fn euclidean(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    (straight(a, b) + 0.5).floor()
}

/// TSPLIB's `CEIL_2D`: up to the next integer.
fn euclidean_ceiling(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    straight(a, b).ceil()
}

/// TSPLIB's `ATT`: pseudo-Euclidean.
fn pseudo_euclidean(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    let (dx, dy) = (a.x - b.x, a.y - b.y);
    ((dx * dx + dy * dy) / 10.0).sqrt().ceil()
}

/// TSPLIB's `GEO`: kilometres on its idealised earth, from degrees and minutes `DDD.MM`, truncated.
fn geographical(a: &ScoredPlace, b: &ScoredPlace) -> f64 {
    #[allow(
        clippy::approx_constant,
        reason = "the format prescribes this value of pi"
    )]
    const TSPLIB_PI: f64 = 3.141592;
    let radians = |value: f64| {
        let degrees = value.trunc();
        TSPLIB_PI * (degrees + 5.0 * (value - degrees) / 3.0) / 180.0
    };
    let longitude = libm::cos(radians(a.y) - radians(b.y));
    let minus = libm::cos(radians(a.x) - radians(b.x));
    let plus = libm::cos(radians(a.x) + radians(b.x));
    let cosine = 0.5 * ((1.0 + longitude) * minus - (1.0 - longitude) * plus);
    (6378.388 * libm::acos(cosine.clamp(-1.0, 1.0)) + 1.0).floor()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_tsplib() {
        let place = |x, y| ScoredPlace { x, y, score: 0.0 };
        assert_eq!(euclidean_ceiling(&place(0.0, 0.0), &place(1.0, 1.0)), 2.0);
        assert_eq!(pseudo_euclidean(&place(0.0, 0.0), &place(10.0, 10.0)), 5.0);
        // ulysses16's first two cities: 38.24 N 20.42 E and 39.57 N 26.15 E.
        assert_eq!(
            geographical(&place(38.24, 20.42), &place(39.57, 26.15)),
            509.0
        );
    }
}
