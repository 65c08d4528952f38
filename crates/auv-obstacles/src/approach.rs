//! The closest approach of a straight, constant-speed motion to a region, in closed form.

use crate::region::corner_distance;
use crate::{Region, RegionShape, TimedPoint};
use auv_types::{Vector3, libm};

/// The closest approach of a timed segment to a region.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Closest {
    /// Signed distance to the region's surface in metres: negative inside, `+inf` when the segment
    /// and the region's window share no time.
    pub clearance_m: f64,
    /// Mission time of the closest approach, seconds.
    pub time_s: f64,
}

impl Region {
    /// The closest approach of the straight, constant-speed motion from `from` to `to`.
    ///
    /// Exact up to rounding for balls, and for cylinders if the closest point lies on the lateral surface or
    /// an end face; within 1e-9 m at a rim. Complexity: O(1).
    #[must_use]
    pub fn clearance(&self, from: &TimedPoint, to: &TimedPoint) -> Closest {
        let begin_s = from.time_s.max(self.from_s);
        let end_s = to.time_s.min(self.until_s);
        if begin_s > end_s {
            return Closest {
                clearance_m: f64::INFINITY,
                time_s: from.time_s,
            };
        }
        let (clearance_m, elapsed_s) = Motion::new(self, from, to, (begin_s, end_s)).closest();
        Closest {
            clearance_m,
            time_s: begin_s + elapsed_s,
        }
    }
}

/// Motion relative to a region's centre over `[0, duration_s]`.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Motion {
    offset: Vector3<f64>,
    velocity: Vector3<f64>,
    depth_m: f64,
    sink_mps: f64,
    radius_m: f64,
    growth_mps: f64,
    duration_s: f64,
    shape: RegionShape,
}

/// The best time found so far.
struct Least {
    value_m: f64,
    elapsed_s: f64,
}

impl Motion {
    /// The part of the motion from `from` to `to` that lies in the time `window_s`.
    pub(crate) fn new(
        region: &Region,
        from: &TimedPoint,
        to: &TimedPoint,
        window_s: (f64, f64),
    ) -> Self {
        let whole_s = to.time_s - from.time_s;
        let velocity = if whole_s > 0.0 {
            (to.position - from.position) / whole_s
        } else {
            Vector3::zeros()
        };
        let (begin_s, end_s) = window_s;
        let position = from.position + velocity * (begin_s - from.time_s);
        Self {
            offset: position - region.centre_at(begin_s),
            velocity: velocity - region.velocity_mps,
            depth_m: position.z,
            sink_mps: velocity.z,
            radius_m: region.radius_at(begin_s),
            growth_mps: region.growth_mps,
            duration_s: end_s - begin_s,
            shape: region.shape,
        }
    }

    /// The least signed distance to the surface, metres, and its time, seconds after the start.
    pub(crate) fn closest(&self) -> (f64, f64) {
        match self.shape {
            RegionShape::Ball => self.closest_radially(3),
            RegionShape::Cylinder { top_m, bottom_m } => self.closest_to_cylinder(top_m, bottom_m),
        }
    }

    /// Coefficients of the squared distance `c + 2 b s + a s^2` over the first `axes` axes.
    fn square(&self, axes: usize) -> (f64, f64, f64) {
        let (mut a, mut b, mut c) = (0.0, 0.0, 0.0);
        for k in 0..axes {
            a += self.velocity[k] * self.velocity[k];
            b += self.offset[k] * self.velocity[k];
            c += self.offset[k] * self.offset[k];
        }
        (a, b, c)
    }

    fn radial(&self, axes: usize, s: f64) -> f64 {
        let square: f64 = (0..axes)
            .map(|k| {
                let x = self.offset[k] + self.velocity[k] * s;
                x * x
            })
            .sum();
        square.sqrt() - self.radius_m - self.growth_mps * s
    }

    /// Least `|offset + velocity s| - radius - growth s` over the first `axes` axes: convex in `s`,
    /// so it is least at an end or at the stationary point.
    fn closest_radially(&self, axes: usize) -> (f64, f64) {
        let (a, b, c) = self.square(axes);
        let g = self.growth_mps;
        let mut least = Least::at(0.0, self.radial(axes, 0.0));
        least.consider(self.duration_s, self.radial(axes, self.duration_s));
        if a > g * g {
            // Stationary where (a s + b) = g |offset + velocity s|.
            let across = (a * c - b * b).max(0.0);
            let s = (g * libm::sqrt(across / (a - g * g)) - b) / a;
            if s > 0.0 && s < self.duration_s {
                least.consider(s, self.radial(axes, s));
            }
        }
        (least.value_m, least.elapsed_s)
    }

    /// Signed distance to a cylinder is convex in time: horizontal and vertical distance are, and
    /// the distance to their quadrant is convex and monotone in both. It is least at an end, where
    /// one of the two is least, where they are equal, or off a rim.
    fn closest_to_cylinder(&self, top_m: f64, bottom_m: f64) -> (f64, f64) {
        let vertical = |s: f64| {
            let z = self.depth_m + self.sink_mps * s;
            (top_m - z).max(z - bottom_m)
        };
        let value = |s: f64| corner_distance(self.radial(2, s), vertical(s));
        let (least_radial_m, s) = self.closest_radially(2);
        let (begin_m, end_m) = (vertical(0.0), vertical(self.duration_s));
        let mut least = Least::at(s, value(s));
        // Only the lateral surface matters: the motion stays beside it or does not change depth.
        if (least_radial_m >= 0.0 && begin_m.max(end_m) <= 0.0) || self.sink_mps == 0.0 {
            return (least.value_m, least.elapsed_s);
        }
        let mut consider = |s: f64| {
            if s >= 0.0 && s <= self.duration_s {
                least.consider(s, value(s));
            }
        };
        consider(0.0);
        consider(self.duration_s);
        // Half-way between top and bottom.
        consider((0.5 * (top_m + bottom_m) - self.depth_m) / self.sink_mps);
        for (over_m, rate_mps) in [
            (top_m - self.depth_m, -self.sink_mps),
            (self.depth_m - bottom_m, self.sink_mps),
        ] {
            if over_m.is_finite() {
                self.equal_to(over_m, rate_mps)
                    .into_iter()
                    .for_each(&mut consider);
                if let Some(s) = self.off_the_rim(over_m, rate_mps) {
                    consider(s);
                }
            }
        }
        (least.value_m, least.elapsed_s)
    }

    /// The times at which the horizontal distance equals `over_m + rate_mps s`. A spurious solution never
    /// gives the least distance.
    fn equal_to(&self, over_m: f64, rate_mps: f64) -> [f64; 2] {
        let (a, b, c) = self.square(2);
        let (reach_m, reach_mps) = (self.radius_m + over_m, self.growth_mps + rate_mps);
        let (a, b, c) = (
            a - reach_mps * reach_mps,
            b - reach_m * reach_mps,
            c - reach_m * reach_m,
        );
        let root = libm::sqrt((b * b - a * c).max(0.0));
        // Avoids cancellation, and holds for a = 0 too.
        let sum = -b - root.copysign(b);
        [sum / a, c / sum]
    }

    /// The time of the least distance from the rim of the end face at distance `over_m + rate_mps s`, among
    /// the times at which that distance is positive. The slope of a convex function has its root there; it
    /// is found by Newton's method within a bracket.
    fn off_the_rim(&self, over_m: f64, rate_mps: f64) -> Option<f64> {
        let zero_s = -over_m / rate_mps;
        let (mut low, mut high) = if rate_mps < 0.0 {
            (0.0, self.duration_s.min(zero_s))
        } else {
            (zero_s.max(0.0), self.duration_s)
        };
        let (a, b, c) = self.square(2);
        // Half the slope of the squared distance, and the slope of that.
        let slope = |s: f64| {
            let over_m = over_m + rate_mps * s;
            let flat = (over_m * rate_mps, rate_mps * rate_mps);
            let square = (c + s * (2.0 * b + a * s)).max(0.0);
            let distance_m = square.sqrt();
            let radial_m = distance_m - self.radius_m - self.growth_mps * s;
            if radial_m <= 0.0 || distance_m <= 1e-9 {
                return flat;
            }
            let rate = (b + a * s) / distance_m;
            let bend = (a - rate * rate) / distance_m;
            let rate = rate - self.growth_mps;
            (
                flat.0 + radial_m * rate,
                flat.1 + rate * rate + radial_m * bend,
            )
        };
        if !(low < high && slope(low).0 < 0.0 && slope(high).0 > 0.0) {
            return None;
        }
        let mut s = 0.5 * (low + high);
        for _ in 0..60 {
            let (value, rise) = slope(s);
            if value < 0.0 {
                low = s;
            } else {
                high = s;
            }
            let mut next = s - value / rise;
            if !(next > low && next < high) {
                next = 0.5 * (low + high);
            }
            let step = (next - s).abs();
            s = next;
            if step <= 1e-9 * self.duration_s.min(1.0) {
                break;
            }
        }
        Some(s)
    }
}

impl Least {
    fn at(elapsed_s: f64, value_m: f64) -> Self {
        Self { value_m, elapsed_s }
    }

    fn consider(&mut self, elapsed_s: f64, value_m: f64) {
        if value_m < self.value_m {
            *self = Self { value_m, elapsed_s };
        }
    }
}
