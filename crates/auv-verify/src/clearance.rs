//! The exact closest approach of a timed segment to a region, from the definition.
//!
//! Independent of the planners' own closed form, so that one mistake cannot hide in both.

use auv_obstacles::{Region, RegionShape, TimedPoint};
use auv_types::{Vector3, libm};

/// Straight motion relative to a region's centre. `s` seconds after the motion starts, the distance
/// is `sqrt(miss_m^2 + speed_mps^2 (s - nearest_s)^2)` and the radius `radius_m + growth_mps s`.
struct RelativeMotion {
    miss_m: f64,
    speed_mps: f64,
    nearest_s: f64,
    radius_m: f64,
    growth_mps: f64,
}

impl RelativeMotion {
    fn new(offset: &Vector3<f64>, velocity: &Vector3<f64>, radius_m: f64, growth_mps: f64) -> Self {
        let speed_mps = velocity.norm();
        let nearest_s = if speed_mps > 0.0 {
            -(offset.dot(velocity) / speed_mps) / speed_mps
        } else {
            0.0
        };
        Self {
            miss_m: (offset + velocity * nearest_s).norm(),
            speed_mps,
            nearest_s,
            radius_m,
            growth_mps,
        }
    }

    fn distance_m(&self, s: f64) -> f64 {
        libm::hypot(self.miss_m, self.speed_mps * (s - self.nearest_s))
    }

    fn gap_m(&self, s: f64) -> f64 {
        self.distance_m(s) - self.radius_m - self.growth_mps * s
    }

    /// A subgradient of the gap, m/s.
    fn gap_rate_mps(&self, s: f64) -> f64 {
        let distance_m = self.distance_m(s);
        let opening = if distance_m > 0.0 {
            self.speed_mps * (self.speed_mps * (s - self.nearest_s) / distance_m)
        } else {
            0.0
        };
        opening - self.growth_mps
    }

    /// When the gap is least within `[0, duration_s]`, unless at an end. The gap is convex. Its rate is zero
    /// where the surface grows as fast as the distance opens: `speed^2 (s - nearest) / distance = growth`.
    fn least_s(&self, duration_s: f64) -> f64 {
        // A surface that grows or shrinks at least as fast as the vehicle moves is nearest at an end.
        if !(self.speed_mps > self.growth_mps.abs()) {
            return 0.0;
        }
        let spare =
            libm::sqrt((self.speed_mps - self.growth_mps) * (self.speed_mps + self.growth_mps));
        let later_s = self.growth_mps / self.speed_mps * self.miss_m / spare;
        (self.nearest_s + later_s).clamp(0.0, duration_s)
    }
}

/// The least signed distance to the region's surface on the segment in metres, and when;
/// `None` when they share no time.
pub(crate) fn closest(region: &Region, from: &TimedPoint, to: &TimedPoint) -> Option<(f64, f64)> {
    let begin_s = from.time_s.max(region.from_s);
    let end_s = to.time_s.min(region.until_s);
    if !(begin_s <= end_s) {
        return None;
    }
    let whole_s = to.time_s - from.time_s;
    let ground = if whole_s > 0.0 {
        (to.position - from.position) / whole_s
    } else {
        Vector3::zeros()
    };
    let position = from.position + ground * (begin_s - from.time_s);
    let since_s = begin_s - region.at_s;
    let mut offset = position - (region.centre + region.velocity_mps * since_s);
    let mut velocity = ground - region.velocity_mps;
    let radius_m = region.radius_m + region.growth_mps * since_s;
    let duration_s = end_s - begin_s;
    let (clearance_m, after_s) = match region.shape {
        RegionShape::Ball => {
            let ball = RelativeMotion::new(&offset, &velocity, radius_m, region.growth_mps);
            let s = ball.least_s(duration_s);
            // The value at an end may round below the one at the stationary point.
            least([s, 0.0, duration_s].map(|s| (ball.gap_m(s), s)))
        }
        RegionShape::Cylinder { top_m, bottom_m } => {
            offset.z = 0.0;
            velocity.z = 0.0;
            CylinderMotion {
                mantle: RelativeMotion::new(&offset, &velocity, radius_m, region.growth_mps),
                depth_m: position.z,
                sink_mps: ground.z,
                top_m,
                bottom_m,
            }
            .least(duration_s)
        }
    };
    Some((clearance_m, (begin_s + after_s).min(end_s)))
}

fn least<const N: usize>(candidates: [(f64, f64); N]) -> (f64, f64) {
    candidates
        .into_iter()
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .unwrap_or((f64::NAN, 0.0))
}

/// Motion relative to a vertical cylinder: horizontally to its mantle, vertically to its end faces.
struct CylinderMotion {
    mantle: RelativeMotion,
    depth_m: f64,
    sink_mps: f64,
    top_m: f64,
    bottom_m: f64,
}

impl CylinderMotion {
    /// Signed distance to the slab between the end faces in metres, and its rate in m/s.
    fn slab(&self, s: f64) -> (f64, f64) {
        let depth_m = self.depth_m + self.sink_mps * s;
        let (above_m, below_m) = (self.top_m - depth_m, depth_m - self.bottom_m);
        if above_m > below_m {
            (above_m, -self.sink_mps)
        } else {
            (below_m, self.sink_mps)
        }
    }

    /// Signed distance to the surface in metres, and a subgradient in m/s. Outside both mantle and
    /// slab the rim is nearest, else the farther of the two surfaces counts.
    fn distance(&self, s: f64) -> (f64, f64) {
        let (beside_m, beside_mps) = (self.mantle.gap_m(s), self.mantle.gap_rate_mps(s));
        let (over_m, over_mps) = self.slab(s);
        if beside_m > 0.0 && over_m > 0.0 {
            let rim_m = libm::hypot(beside_m, over_m);
            let rate = (beside_m / rim_m) * beside_mps + (over_m / rim_m) * over_mps;
            (rim_m, rate)
        } else if beside_m > over_m {
            (beside_m, beside_mps)
        } else {
            (over_m, over_mps)
        }
    }

    /// Least distance in metres, and when. The distance to a convex body is convex in time, so the
    /// sign of a subgradient tells on which side of a moment the least lies: bisection to rounding.
    fn least(&self, duration_s: f64) -> (f64, f64) {
        let (mut low_s, mut high_s) = (0.0, duration_s);
        let fastest = self.mantle.speed_mps + self.mantle.growth_mps.abs() + self.sink_mps.abs();
        while (high_s - low_s) * fastest > 1e-11 {
            let middle_s = 0.5 * (low_s + high_s);
            if middle_s <= low_s || middle_s >= high_s {
                break;
            }
            if self.distance(middle_s).1 > 0.0 {
                high_s = middle_s;
            } else {
                low_s = middle_s;
            }
        }
        least([low_s, high_s, 0.0, duration_s].map(|s| (self.distance(s).0, s)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::{Point3, Seed, rand::RngExt};

    #[test]
    fn equals_the_least_of_dense_samples() {
        for case in 0..200 {
            let mut random = Seed(17).stream(case);
            let mut draw = |low: f64, high: f64| random.random_range(low..high);
            let centre = Point3::new(draw(-50.0, 50.0), draw(-50.0, 50.0), draw(0.0, 60.0));
            let mut region = if case % 2 == 0 {
                Region::ball(centre, draw(1.0, 40.0))
            } else {
                let top_m = draw(0.0, 30.0);
                Region::cylinder(centre, draw(1.0, 40.0), top_m, top_m + draw(1.0, 30.0))
            };
            region.velocity_mps = Vector3::new(draw(-2.0, 2.0), draw(-2.0, 2.0), draw(-1.0, 1.0));
            region.growth_mps = draw(-0.2, 3.0);
            region.at_s = draw(-10.0, 10.0);
            region.from_s = draw(-5.0, 10.0);
            let place = |x| Point3::new(x, draw(-90.0, 90.0), draw(0.0, 60.0));
            let [from, to] = [-60.0, 60.0].map(place);
            let (from, to) = (TimedPoint::new(from, 0.0), TimedPoint::new(to, 40.0));
            let sampled_m = (0..=40_000)
                .map(|i| {
                    let share = f64::from(i) / 40_000.0;
                    let place = from.position + (to.position - from.position) * share;
                    region.distance_m(&TimedPoint::new(place, 40.0 * share))
                })
                .fold(f64::INFINITY, f64::min);
            let (clearance_m, time_s) = closest(&region, &from, &to).unwrap();
            assert!(clearance_m <= sampled_m + 1e-9, "case {case}");
            assert!(sampled_m - clearance_m < 0.02, "case {case}");
            assert!((region.from_s.max(0.0)..=40.0).contains(&time_s));
        }
    }

    #[test]
    fn a_region_that_exists_at_another_time_has_no_closest_approach() {
        let mut region = Region::ball(Point3::origin(), 5.0);
        region.from_s = 30.0;
        let at = |time_s| TimedPoint::new(Point3::origin(), time_s);
        assert!(closest(&region, &at(0.0), &at(20.0)).is_none());
        assert_eq!(closest(&region, &at(0.0), &at(30.0)), Some((-5.0, 30.0)));
    }

    #[test]
    fn the_least_distance_to_a_cylinder_is_found_after_a_long_time() {
        // 2,000 km at 1 m/s past a cylinder near the end, where a double no longer resolves a picometre.
        let region = Region::cylinder(Point3::new(1.9e6, 8.0, 0.0), 5.0, 0.0, 50.0);
        let ends = [0.0, 2e6].map(|x| TimedPoint::new(Point3::new(x, 0.0, 20.0), x));
        let (clearance_m, time_s) = closest(&region, &ends[0], &ends[1]).unwrap();
        assert!((clearance_m - 3.0).abs() < 1e-9 && (time_s - 1.9e6).abs() < 1e-3);
    }

    #[test]
    fn a_surface_that_grows_exactly_as_fast_as_the_vehicle_moves_has_a_clearance() {
        // Straight towards it, then straight away, both at 3 m/s.
        for (x, expected) in [(60.0, (-1.0, 10.0)), (-60.0, (59.0, 0.0))] {
            let region = Region {
                growth_mps: 3.0,
                ..Region::ball(Point3::new(x, 0.0, 0.0), 1.0)
            };
            let ends = [0.0, 10.0].map(|s| TimedPoint::new(Point3::new(3.0 * s, 0.0, 0.0), s));
            assert_eq!(closest(&region, &ends[0], &ends[1]), Some(expected));
        }
    }
}
