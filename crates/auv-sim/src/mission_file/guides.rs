//! Guides: polylines between waypoints through water that is deep enough.

use auv_ocean::{SeaBed, WaterMap};
use auv_planning::motion::Floor;
use auv_types::{Bounds, Point3, Violations, libm};

/// A polyline from one place to another.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Guide {
    /// The corners, both ends included.
    pub(super) points: Vec<Point3<f64>>,
    /// The length, metres.
    pub(super) length_m: f64,
}

impl Guide {
    /// Along a polyline.
    pub(super) fn along(points: Vec<Point3<f64>>) -> Self {
        let length_m = points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum();
        Self { points, length_m }
    }
}

/// Finds guides.
#[derive(Debug)]
pub(super) struct GuideFinder<'a> {
    sea: Option<(Floor<'a>, WaterMap)>,
    ceiling_m: f64,
    greatest_slope: f64,
    /// Greatest distance between two samples of the depth, metres.
    step_m: f64,
    /// Distance guides keep above the floor, and tolerance of their simplification, metres.
    spare_m: f64,
}

impl<'a> GuideFinder<'a> {
    /// Greatest step between two samples of the depth, and least cell of a map, at sea, metres.
    const STEP_M: f64 = 25.0;
    /// The same as a share of a small box's diagonal.
    const STEP_SHARE: f64 = 0.025;
    /// Distance guides keep above the floor at sea, metres.
    const SPARE_M: f64 = 1.0;
    /// The same as a share of a shallow box's depth.
    const SPARE_SHARE: f64 = 0.05;

    /// A finder of guides within a box and above a floor, for a vehicle that stays below the top of the
    /// box and pitches at most `max_pitch_rad`. `None` if the box is missing or the map of the water
    /// cannot be built; the reason is added to `violations`.
    pub(super) fn new(
        floor: Option<Floor<'a>>,
        bounds: Option<&Bounds>,
        cell_m: Option<f64>,
        max_pitch_rad: f64,
        violations: &mut Violations,
    ) -> Option<Self> {
        let ceiling_m = bounds.map_or(0.0, |bounds| bounds.low.z);
        let size = bounds.map(|bounds| bounds.high - bounds.low);
        // A pool has smaller steps than the sea.
        let step_m = size.map_or(Self::STEP_M, |size| {
            Self::STEP_M.min(Self::STEP_SHARE * size.xy().norm())
        });
        let spare_m = size.map_or(Self::SPARE_M, |size| {
            Self::SPARE_M.min(Self::SPARE_SHARE * size.z)
        });
        let sea = match (floor, bounds) {
            (None, _) => None,
            (Some(_), None) => {
                violations.push(
                    "box",
                    "is missing; give one: a mission over a sea bed needs it",
                );
                return None;
            }
            (Some(floor), Some(bounds)) => {
                let across_m = (bounds.high - bounds.low).xy().norm();
                let cell_m = cell_m.unwrap_or((across_m / 400.0).max(step_m));
                let (low, high) = ([bounds.low.x, bounds.low.y], [bounds.high.x, bounds.high.y]);
                let least_m = ceiling_m + 2.0 * spare_m;
                match WaterMap::new(&floor, low, high, cell_m, least_m) {
                    Ok(map) => Some((floor, map)),
                    Err(wrong) => {
                        violations.absorb("connect.", wrong);
                        return None;
                    }
                }
            }
        };
        Some(Self {
            sea,
            ceiling_m,
            greatest_slope: libm::tan((0.7 * max_pitch_rad).min(1.2)),
            step_m,
            spare_m,
        })
    }

    /// The shortest guide found; `None` if no water deep enough connects the two places.
    pub(super) fn between(&self, from: &Point3<f64>, to: &Point3<f64>) -> Option<Guide> {
        let Some((floor, map)) = &self.sea else {
            return Some(Guide::through(vec![*from, *to]));
        };
        let path = map.path([from.x, from.y], [to.x, to.y])?;
        Some(self.over(floor, &path.points, from.z, to.z))
    }

    /// Adds depths to a path on the map: linear from end to end, but shallower where the floor requires.
    fn over(&self, floor: &Floor<'_>, corners: &[[f64; 2]], from_z: f64, to_z: f64) -> Guide {
        let mut fine: Vec<(Point3<f64>, f64)> = Vec::new();
        let mut sailed_m = 0.0;
        for pair in corners.windows(2) {
            let (north, east) = (pair[1][0] - pair[0][0], pair[1][1] - pair[0][1]);
            let length_m = libm::hypot(north, east);
            let pieces = (length_m / self.step_m).ceil().max(1.0);
            for k in 0..pieces as usize {
                let share = k as f64 / pieces;
                let point = Point3::new(pair[0][0] + share * north, pair[0][1] + share * east, 0.0);
                fine.push((point, sailed_m + share * length_m));
            }
            sailed_m += length_m;
        }
        if let Some(end) = corners.last() {
            fine.push((Point3::new(end[0], end[1], 0.0), sailed_m));
        }
        let whole_m = sailed_m.max(1e-9);
        for (point, at_m) in &mut fine {
            let reach_m = 0.5 * self.step_m;
            let slope = floor.max_slope_near(point.x, point.y, reach_m);
            let deepest_m = floor.depth_at(point.x, point.y) - slope * reach_m - self.spare_m;
            let even_z = from_z + (to_z - from_z) * (*at_m / whole_m);
            point.z = even_z.min(deepest_m.max(self.ceiling_m));
        }
        // The slope stays within the vehicle's pitch: each point is raised where its neighbours require.
        for i in 1..fine.len() {
            let reach_m = self.greatest_slope * (fine[i].1 - fine[i - 1].1);
            fine[i].0.z = fine[i].0.z.min(fine[i - 1].0.z + reach_m);
        }
        for i in (1..fine.len()).rev() {
            let reach_m = self.greatest_slope * (fine[i].1 - fine[i - 1].1);
            fine[i - 1].0.z = fine[i - 1].0.z.min(fine[i].0.z + reach_m);
        }
        let mut points: Vec<_> = fine.into_iter().map(|(point, _)| point).collect();
        let last = points.len() - 1;
        (points[0].z, points[last].z) = (from_z, to_z);
        Guide::through(simplified(&points, self.spare_m))
    }
}

impl Guide {
    fn through(points: Vec<Point3<f64>>) -> Self {
        let length_m = points
            .windows(2)
            .map(|pair| (pair[1] - pair[0]).norm())
            .sum();
        Self { points, length_m }
    }

    /// Whether it is a straight line.
    pub(super) fn is_straight(&self) -> bool {
        self.points.len() == 2
    }
}

/// A polyline with fewer points, at most `tolerance_m` away from the old ones (Douglas and Peucker
/// 1973).
pub(super) fn simplified(points: &[Point3<f64>], tolerance_m: f64) -> Vec<Point3<f64>> {
    let last = points.len() - 1;
    let mut keep = vec![false; points.len()];
    (keep[0], keep[last]) = (true, true);
    let mut open = vec![(0, last)];
    while let Some((from, to)) = open.pop() {
        let farthest = (from + 1..to)
            .map(|i| (distance_m(&points[i], &points[from], &points[to]), i))
            .max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1)));
        if let Some((_, i)) = farthest.filter(|(distance_m, _)| *distance_m > tolerance_m) {
            keep[i] = true;
            open.push((from, i));
            open.push((i, to));
        }
    }
    let kept = points.iter().zip(keep).filter(|(_, keep)| *keep);
    kept.map(|(point, _)| *point).collect()
}

fn distance_m(point: &Point3<f64>, from: &Point3<f64>, to: &Point3<f64>) -> f64 {
    let (line, offset) = (to - from, point - from);
    let square = line.norm_squared();
    let share = if square > 0.0 {
        (offset.dot(&line) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    (offset - line * share).norm()
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_ocean::{AnalyticBed, BedFeature, Footprint};

    fn sound() -> AnalyticBed {
        let island = Footprint::Disc {
            centre: [1_000.0, 1_000.0],
            radius_m: 150.0,
        };
        let sill = Footprint::Line {
            points: vec![[0.0, 2_000.0], [2_000.0, 2_000.0]],
            half_width_m: 100.0,
        };
        AnalyticBed::new(60.0)
            .with(BedFeature::new("island", island, -5.0, 150.0))
            .with(BedFeature::new("sill", sill, 18.0, 300.0))
    }

    #[test]
    fn guides_lead_round_islands_and_over_sills() {
        let bed = sound();
        let floor = Floor {
            bed: &bed,
            min_altitude_m: 5.0,
            altitude_sigmas: 2.0,
        };
        let bounds = Bounds::new(Point3::new(0.0, 0.0, 3.0), Point3::new(2e3, 3e3, 100.0));
        let mut violations = Violations::new();
        let guides =
            GuideFinder::new(Some(floor), Some(&bounds), None, 0.26, &mut violations).unwrap();
        let guide = guides
            .between(
                &Point3::new(1e3, 300.0, 40.0),
                &Point3::new(1e3, 2.8e3, 40.0),
            )
            .unwrap();
        assert!(
            guide.length_m > 2_510.0 && guide.length_m < 2_700.0,
            "{guide:?}"
        );
        for pair in guide.points.windows(2) {
            for i in 0..=100 {
                let p = pair[0] + (pair[1] - pair[0]) * (f64::from(i) / 100.0);
                let spare_m = bed.depth_at(p.x, p.y) - p.z;
                assert!(spare_m > 5.0, "{spare_m} m over the bed at {p}");
            }
            let step = pair[1] - pair[0];
            assert!(step.z.abs() <= 0.25 * step.xy().norm(), "steep: {pair:?}");
        }
        let ashore = Point3::new(1e3, 1e3, 10.0);
        assert!(
            guides
                .between(&Point3::new(1e3, 300.0, 40.0), &ashore)
                .is_none()
        );
    }
}
