//! Footprints on the map, with smooth edges.

use auv_types::{Violations, libm};

/// A point of the map: north and east of the local frame's origin, metres.
pub type MapPoint = [f64; 2];

/// An area on the map from which analytic sea beds and tidal gains are composed.
///
/// Every footprint has a signed distance, at most 0 inside, that changes by at most one metre per metre.
/// The bounds of slopes follow from that.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(rename_all = "snake_case", deny_unknown_fields)
)]
pub enum Footprint {
    /// All positions within a radius of a centre: a shoal, a round island.
    Disc {
        /// Its centre.
        centre: MapPoint,
        /// Its radius (0: a single point), metres.
        radius_m: f64,
    },
    /// An ellipse: a basin.
    Ellipse {
        /// Its centre.
        centre: MapPoint,
        /// From the centre to one end of its first axis, metres north and east.
        half_axis: MapPoint,
        /// Half the length of its second axis, metres.
        half_width_m: f64,
    },
    /// All positions near a polyline: a sill, a ridge, a channel, a wall.
    Line {
        /// The polyline's points, two or more.
        points: Vec<MapPoint>,
        /// Reach to either side, metres (0: only the line).
        half_width_m: f64,
    },
    /// A polygon: an island, a stretch of land.
    Area {
        /// Its corners in either direction, three or more. The first is not repeated.
        outline: Vec<MapPoint>,
    },
    /// Everything beyond a straight line: a coast.
    Beyond {
        /// A point of the line.
        through: MapPoint,
        /// A point on the far side. The line is perpendicular to the direction from `through` to it.
        towards: MapPoint,
    },
}

/// Greatest number of corners.
const MOST_CORNERS: usize = 10_000;
/// Greatest distance of a coordinate from the origin, metres.
const FARTHEST_M: f64 = 1e7;

impl Footprint {
    /// Signed distance, metres; at most 0 inside. Along an ellipse's long axis it grows more slowly than the
    /// true distance. Complexity: linear in the corners.
    #[must_use]
    pub fn distance_m(&self, north_m: f64, east_m: f64) -> f64 {
        let place = [north_m, east_m];
        match self {
            Self::Disc { centre, radius_m } => length(minus(place, *centre)) - radius_m,
            Self::Ellipse {
                centre,
                half_axis,
                half_width_m,
            } => {
                let half_length_m = length(*half_axis);
                let offset = minus(place, *centre);
                let along = dot(offset, *half_axis) / (half_length_m * half_length_m);
                let across = cross(*half_axis, offset) / (half_length_m * half_width_m);
                (length([along, across]) - 1.0) * half_length_m.min(*half_width_m)
            }
            Self::Line {
                points,
                half_width_m,
            } => {
                let square = points
                    .windows(2)
                    .map(|ends| square_to_segment(place, ends[0], ends[1]))
                    .fold(f64::INFINITY, f64::min);
                square.sqrt() - half_width_m
            }
            Self::Area { outline } => {
                let (mut square, mut inside) = (f64::INFINITY, false);
                let Some(&(mut from)) = outline.last() else {
                    return f64::INFINITY;
                };
                for &to in outline {
                    square = square.min(square_to_segment(place, from, to));
                    if (from[0] > north_m) != (to[0] > north_m) {
                        let share = (north_m - from[0]) / (to[0] - from[0]);
                        inside ^= east_m < from[1] + share * (to[1] - from[1]);
                    }
                    from = to;
                }
                if inside {
                    -square.sqrt()
                } else {
                    square.sqrt()
                }
            }
            Self::Beyond { through, towards } => {
                let normal = minus(*towards, *through);
                -dot(minus(place, *through), normal) / length(normal)
            }
        }
    }

    /// Whether the signed distance is greater than `reach_m`, told by corners alone; `false` where that takes
    /// the distance itself.
    pub(crate) fn is_far(&self, north_m: f64, east_m: f64, reach_m: f64) -> bool {
        let (corners, half_width_m) = match self {
            Self::Line {
                points,
                half_width_m,
            } => (points, *half_width_m),
            Self::Area { outline } => (outline, 0.0),
            _ => return false,
        };
        // Distances are rounded.
        let far_m = reach_m + half_width_m + 0.001;
        let beyond = |axis: usize, at_m: f64| {
            let all = |side: fn(f64, f64) -> bool, line_m: f64| {
                corners.iter().all(|corner| side(corner[axis], line_m))
            };
            all(|corner_m, line_m| corner_m > line_m, at_m + far_m)
                || all(|corner_m, line_m| corner_m < line_m, at_m - far_m)
        };
        beyond(0, north_m) || beyond(1, east_m)
    }

    /// Adds everything malformed about the footprint to a list, under the name `place`.
    pub fn validate_into(&self, place: &str, violations: &mut Violations) {
        let key = |name: &str| format!("{place}.{name}");
        match self {
            Self::Disc { centre, radius_m } => {
                check_points(&[*centre], 1, &key("centre"), violations);
                violations.require_not_negative(*radius_m, &key("radius_m"));
            }
            Self::Ellipse {
                centre,
                half_axis,
                half_width_m,
            } => {
                check_points(&[*centre], 1, &key("centre"), violations);
                check_points(&[*half_axis], 1, &key("half_axis"), violations);
                violations.require_positive(length(*half_axis), &key("half_axis"));
                violations.require_positive(*half_width_m, &key("half_width_m"));
            }
            Self::Line {
                points,
                half_width_m,
            } => {
                check_points(points, 2, &key("points"), violations);
                violations.require_not_negative(*half_width_m, &key("half_width_m"));
            }
            Self::Area { outline } => {
                check_points(outline, 3, &key("outline"), violations);
                violations.require(doubled_area(outline).abs() > 0.0, &key("outline"), || {
                    "encloses no area; give corners that do not lie in one line".into()
                });
            }
            Self::Beyond { through, towards } => {
                check_points(&[*through, *towards], 2, &key("through"), violations);
                let distinct = length(minus(*towards, *through)) > 0.0;
                violations.require(distinct, &key("towards"), || {
                    "is the point `through`; give a point on the far side".into()
                });
            }
        }
    }
}

/// Checks the number of points and their coordinates.
fn check_points(points: &[MapPoint], least: usize, place: &str, violations: &mut Violations) {
    let n = points.len();
    violations.require((least..=MOST_CORNERS).contains(&n), place, || {
        format!("has {n} points; give {least} to {MOST_CORNERS}")
    });
    for (i, point) in points.iter().enumerate() {
        let far = point.iter().any(|x| !x.is_finite() || x.abs() > FARTHEST_M);
        violations.require(!far, place, || {
            format!("has point {i} at {point:?}; give metres within 10,000 km")
        });
    }
}

/// Twice the signed area of a polygon.
fn doubled_area(outline: &[MapPoint]) -> f64 {
    (1..outline.len().saturating_sub(1))
        .map(|i| {
            cross(
                minus(outline[i], outline[0]),
                minus(outline[i + 1], outline[0]),
            )
        })
        .sum()
}

/// The share of a feature's effect at a signed distance from its footprint: 1 inside, 0 beyond the skirt,
/// a smooth step (`3 t^2 - 2 t^3`) in between.
pub(crate) fn share_at(distance_m: f64, skirt_m: f64) -> f64 {
    if distance_m <= 0.0 {
        1.0
    } else if distance_m >= skirt_m {
        0.0
    } else {
        let t = 1.0 - distance_m / skirt_m;
        t * t * (3.0 - 2.0 * t)
    }
}

/// The steepest change of [`share_at`] between two distances, per metre.
pub(crate) fn steepest_share(low_m: f64, high_m: f64, skirt_m: f64) -> f64 {
    if high_m <= 0.0 || low_m >= skirt_m {
        return 0.0;
    }
    let t = (0.5 * skirt_m).clamp(low_m.max(0.0), high_m.min(skirt_m)) / skirt_m;
    6.0 * t * (1.0 - t) / skirt_m
}

fn minus(a: MapPoint, b: MapPoint) -> MapPoint {
    [a[0] - b[0], a[1] - b[1]]
}

fn dot(a: MapPoint, b: MapPoint) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

fn cross(a: MapPoint, b: MapPoint) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn length(a: MapPoint) -> f64 {
    libm::sqrt(dot(a, a))
}

fn square_to_segment(place: MapPoint, from: MapPoint, to: MapPoint) -> f64 {
    let along = minus(to, from);
    let offset = minus(place, from);
    let whole = dot(along, along);
    let share = if whole > 0.0 {
        (dot(offset, along) / whole).clamp(0.0, 1.0)
    } else {
        0.0
    };
    let rest = [offset[0] - share * along[0], offset[1] - share * along[1]];
    dot(rest, rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_those_of_simple_figures() {
        let square = Footprint::Area {
            outline: vec![[0.0, 0.0], [0.0, 10.0], [10.0, 10.0], [10.0, 0.0]],
        };
        assert!((square.distance_m(5.0, 4.0) + 4.0).abs() < 1e-12);
        assert!((square.distance_m(13.0, 14.0) - 5.0).abs() < 1e-12);
        let bend = Footprint::Line {
            points: vec![[0.0, 0.0], [10.0, 0.0], [10.0, 10.0]],
            half_width_m: 1.0,
        };
        assert!((bend.distance_m(13.0, 5.0) - 2.0).abs() < 1e-12);
        let coast = Footprint::Beyond {
            through: [0.0, 100.0],
            towards: [0.0, 90.0],
        };
        assert!((coast.distance_m(7.0, 80.0) + 20.0).abs() < 1e-12);
        let basin = Footprint::Ellipse {
            centre: [0.0, 0.0],
            half_axis: [0.0, 40.0],
            half_width_m: 20.0,
        };
        assert!(basin.distance_m(0.0, 40.0).abs() < 1e-12);
        assert!((basin.distance_m(25.0, 0.0) - 5.0).abs() < 1e-12);
    }

    #[test]
    fn what_is_far_is_farther_than_asked() {
        let outline = vec![[0.0, 0.0], [40.0, 10.0], [30.0, 60.0], [-5.0, 30.0]];
        let line = Footprint::Line {
            points: outline.clone(),
            half_width_m: 7.0,
        };
        let (mut far, mut near) = (0, 0);
        for shape in [line, Footprint::Area { outline }] {
            for k in 0..10_000 {
                let (north_m, east_m) =
                    (f64::from(k % 100) * 3.0 - 150.0, f64::from(k / 100) * 3.0);
                let distance_m = shape.distance_m(north_m, east_m);
                for reach_m in [0.0, 12.5, 60.0] {
                    let told = shape.is_far(north_m, east_m, reach_m);
                    assert!(!told || distance_m > reach_m, "{distance_m} m, {reach_m} m");
                    far += u32::from(told);
                    near += u32::from(!told && distance_m > reach_m);
                }
            }
        }
        assert!(far > 3 * near, "{far} told, {near} not");
    }

    #[test]
    fn malformed_shapes_are_named() {
        let mut violations = Violations::new();
        Footprint::Area {
            outline: vec![[0.0, 0.0], [1.0, 1.0], [2.0, 2.0]],
        }
        .validate_into("island", &mut violations);
        Footprint::Line {
            points: vec![[f64::NAN, 0.0]],
            half_width_m: -1.0,
        }
        .validate_into("sill", &mut violations);
        assert_eq!(violations.total(), 4, "{violations}");
        assert!(violations.to_string().contains("island.outline"));
    }
}
