//! `[[surveys]]` of a mission file.

use crate::mission_file::heights::Height;
use crate::mission_file::place::Place;
use auv_types::{Point3, Violations};
use serde::Deserialize;

/// A survey as the file gives it.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(in crate::mission_file) struct SurveyEntry {
    pub(super) name: String,
    /// The corners of what is covered.
    pub(super) polygon: Option<Vec<Place>>,
    pub(super) corridor: Option<Corridor>,
    /// Greatest distance between two lines, metres.
    pub(super) spacing_m: f64,
    /// The course of the lines.
    pub(super) heading_deg: Option<Heading>,
    pub(super) depth_m: Option<f64>,
    pub(super) altitude_m: Option<f64>,
    pub(super) priority: f64,
    pub(super) risk: f64,
    /// Whether a part of it may be flown.
    #[serde(default)]
    pub(super) split: bool,
    #[serde(default)]
    pub(super) order: Order,
    #[serde(default)]
    pub(super) mandatory: bool,
    #[serde(default)]
    pub(super) windows: Vec<[f64; 2]>,
}

/// A strip to both sides of a polyline.
#[derive(Clone, Debug, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Corridor {
    along: Vec<Place>,
    width_m: f64,
}

/// The course of lines over a polygon.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
#[serde(untagged, expecting = "give degrees from north by east, or \"best\"")]
pub(super) enum Heading {
    Degrees(f64),
    Best(Best),
}

/// The course that takes the least time.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Best {
    Best,
}

/// The order of lines.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub(super) enum Order {
    /// As the vehicle turns most easily.
    #[default]
    Any,
    /// One after the other.
    Sequence,
}

/// What is covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Area {
    Polygon,
    Corridor { width_m: f64 },
}

impl SurveyEntry {
    /// The key of its points, the points, and what they are; `None` where it has both or neither.
    pub(super) fn given(&self) -> Option<(&'static str, &[Place], Area)> {
        match (&self.polygon, &self.corridor) {
            (Some(polygon), None) => Some(("polygon", polygon, Area::Polygon)),
            (None, Some(Corridor { along, width_m })) => {
                let area = Area::Corridor { width_m: *width_m };
                Some(("corridor.along", along, area))
            }
            _ => None,
        }
    }

    pub(in crate::mission_file) fn name(&self) -> &str {
        &self.name
    }

    pub(in crate::mission_file) fn may_split(&self) -> bool {
        self.split
    }

    /// What is wrong with it but for its points.
    pub(super) fn check(&self, place: &str, violations: &mut Violations) {
        let key = |name: &str| format!("{place}.{name}");
        let areas = [self.polygon.is_some(), self.corridor.is_some()];
        require_one(["polygon", "corridor"], areas, place, violations);
        let depths = [self.depth_m.is_some(), self.altitude_m.is_some()];
        require_one(["depth_m", "altitude_m"], depths, place, violations);
        let on_course = self.corridor.is_none() || self.heading_deg.is_none();
        violations.require(on_course, &key("heading_deg"), || {
            "is for a polygon: the lines of a corridor lead along it; leave it out".into()
        });
        let mut within = |value: f64, (least, most): (f64, f64), name: &str, unit: &str| {
            violations.require((least..=most).contains(&value), &key(name), || {
                format!("is {value}; give {least} to {most} {unit}")
            });
        };
        within(self.spacing_m, (0.5, 10_000.0), "spacing_m", "m");
        within(
            self.depth_m.unwrap_or_default(),
            (0.0, 11_000.0),
            "depth_m",
            "m",
        );
        within(
            self.altitude_m.unwrap_or(1.0),
            (0.1, 11_000.0),
            "altitude_m",
            "m",
        );
        if let Some(Heading::Degrees(heading_deg)) = self.heading_deg {
            within(
                heading_deg,
                (-360.0, 360.0),
                "heading_deg",
                "degrees from north by east",
            );
        }
        if let Some(Corridor { width_m, .. }) = self.corridor {
            within(width_m, (0.0, 100_000.0), "corridor.width_m", "m");
        }
        violations.require_not_negative(self.priority, &key("priority"));
        violations.require_positive(self.risk, &key("risk"));
    }

    /// The course of its lines, radians; `None` for the best.
    pub(super) fn course(&self) -> Option<f64> {
        match self.heading_deg {
            Some(Heading::Degrees(heading_deg)) => Some(heading_deg.to_radians()),
            Some(Heading::Best(_)) | None => None,
        }
    }

    pub(super) fn is_in_sequence(&self) -> bool {
        self.order == Order::Sequence
    }

    pub(super) fn height(&self) -> Height {
        Height::given(None, self.altitude_m)
    }

    /// The name of the task of beginning it within its windows.
    pub(in crate::mission_file) fn begins(&self) -> String {
        format!("{} start", self.name)
    }
}

/// What is wrong with the corners of an area.
pub(super) fn check_corners(
    points: &[Point3<f64>],
    area: Area,
    place: &str,
    violations: &mut Violations,
) {
    let least = if area == Area::Polygon { 3 } else { 2 };
    violations.require(points.len() >= least, place, || {
        format!("has {} points; give at least {least}", points.len())
    });
    if points.len() < least {
        return;
    }
    let is_small = |p: &Point3<f64>| (p - points[0]).norm() < 1.0;
    if points.iter().all(is_small) {
        violations.push(
            place,
            "is smaller than 1 m; give metres, or degrees as { latitude_deg, longitude_deg }",
        );
        return;
    }
    let apart = points
        .windows(2)
        .all(|pair| (pair[1] - pair[0]).norm() > 0.1);
    violations.require(apart, place, || {
        "has the same point twice in a row; give it once".into()
    });
    if area == Area::Polygon {
        let crosses = (0..points.len()).any(|i| crosses_later(points, i));
        violations.require(!crosses, place, || {
            "crosses itself; give its corners in order round it".into()
        });
        let doubled = |(i, a): (usize, &Point3<f64>)| {
            let b = points[(i + 1) % points.len()];
            a.x * b.y - a.y * b.x
        };
        let area_m2 = 0.5 * points.iter().enumerate().map(doubled).sum::<f64>().abs();
        violations.require(crosses || area_m2 > 1.0, place, || {
            "has no area; give corners that are not in one line".into()
        });
    }
}

/// Whether a side of a polygon crosses one that comes later and does not touch it.
fn crosses_later(points: &[Point3<f64>], i: usize) -> bool {
    let count = points.len();
    let side = |k: usize| (points[k % count], points[(k + 1) % count]);
    let turn = |a: Point3<f64>, b: Point3<f64>, c: Point3<f64>| {
        let (u, v) = (b - a, c - a);
        u.x * v.y - u.y * v.x
    };
    let (a, b) = side(i);
    let last = if i == 0 { count - 1 } else { count };
    (i + 2..last).any(|k| {
        let (c, d) = side(k);
        turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0
    })
}

/// Of two keys one must be given.
fn require_one(
    [one, other]: [&str; 2],
    are_given: [bool; 2],
    place: &str,
    violations: &mut Violations,
) {
    match are_given {
        [true, true] => {
            violations.push(
                place,
                format!("has both {one} and {other}; give one of them"),
            );
        }
        [false, false] => {
            violations.push(
                place,
                format!("has neither {one} nor {other}; give one of them"),
            );
        }
        _ => {}
    }
}
