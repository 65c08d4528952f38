//! The regions as the swarm sees them: single precision, relative to start and departure.

use auv_obstacles::Shape;
use auv_planning::PathProblem;
use wide::f32x8;

/// A region with clearance and a little for sampling added, relative to the leg's start and departure.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hazard {
    centre: [f32; 3],
    velocity: [f32; 3],
    speed: f32,
    radius: f32,
    growth: f32,
    from: f32,
    until: f32,
    /// Top and bottom depth of a cylinder; `None` for a ball.
    depths: Option<(f32, f32)>,
}

/// Positions and times of eight curves at one sample.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sample {
    pub(crate) position: [f32x8; 3],
    pub(crate) time: f32x8,
    /// Squared length of the segment that ends here.
    pub(crate) step: f32x8,
}

/// Distance of a sample to the hazard, for the segment that follows.
#[derive(Clone, Copy)]
pub(crate) struct Offset {
    delta: [f32x8; 3],
    radius: f32x8,
    square: f32x8,
    exists: f32x8,
}

/// Metres added to every radius: single precision and the chords between samples stay inside it.
const SAMPLING_MARGIN_M: f64 = 0.02;

impl Hazard {
    /// The regions that exist within `latest_s` seconds after departure.
    pub(crate) fn of(problem: &PathProblem<'_>, latest_s: f64) -> Vec<Self> {
        let at_s = problem.departure_s;
        let margin_m = problem.clearance_m + SAMPLING_MARGIN_M;
        problem
            .regions
            .iter()
            .filter(|region| region.until_s >= at_s && region.from_s <= at_s + latest_s)
            .map(|region| {
                let centre = region.centre_at(at_s) - problem.start;
                let depths = match region.shape {
                    Shape::Ball => None,
                    Shape::Cylinder { top_m, bottom_m } => Some((
                        (top_m - margin_m - problem.start.z) as f32,
                        (bottom_m + margin_m - problem.start.z) as f32,
                    )),
                };
                Self {
                    centre: [centre.x as f32, centre.y as f32, centre.z as f32],
                    velocity: region.velocity_mps.map(|v| v as f32).into(),
                    speed: region.velocity_mps.norm() as f32,
                    radius: (region.radius_at(at_s) + margin_m) as f32,
                    growth: region.growth_mps as f32,
                    from: (region.from_s - at_s) as f32,
                    until: (region.until_s - at_s) as f32,
                    depths,
                }
            })
            .collect()
    }

    /// Whether any curve may touch the hazard within `half` seconds of a sample, flying at most
    /// `speed` over ground; never a false no.
    #[inline]
    pub(crate) fn may_touch(&self, middle: &Sample, half: f32x8, speed: f32) -> bool {
        let at = self.offset(middle);
        let reach = at.radius.fast_max(f32x8::ZERO)
            + half * f32x8::splat(1.0001 * (speed + self.speed + self.growth.abs()))
            + f32x8::splat(0.01);
        at.square.simd_le(reach * reach).any()
    }

    /// Where eight samples lie relative to the hazard.
    #[inline]
    pub(crate) fn offset(&self, sample: &Sample) -> Offset {
        let t = sample.time;
        let axis = |k: usize| {
            sample.position[k] - (f32x8::splat(self.centre[k]) + f32x8::splat(self.velocity[k]) * t)
        };
        let delta = [axis(0), axis(1), axis(2)];
        let across = delta[0] * delta[0] + delta[1] * delta[1];
        let square = if self.depths.is_some() {
            across
        } else {
            across + delta[2] * delta[2]
        };
        let exists = if self.from == f32::NEG_INFINITY && self.until == f32::INFINITY {
            f32x8::splat(f32::from_bits(u32::MAX))
        } else {
            t.simd_ge(f32x8::splat(self.from)) & t.simd_le(f32x8::splat(self.until))
        };
        Offset {
            delta,
            radius: f32x8::splat(self.radius) + f32x8::splat(self.growth) * t,
            square,
            exists,
        }
    }

    /// Penetration of a sample as a share of the radius: `max(0, 1 - distance / radius)`.
    #[inline]
    pub(crate) fn penetration(&self, at: &Offset, sample: &Sample) -> f32x8 {
        let inside =
            at.exists & at.radius.simd_gt(f32x8::ZERO) & at.square.simd_lt(at.radius * at.radius);
        if !inside.any() {
            return f32x8::ZERO;
        }
        inside & self.share(at.square, at.radius, sample.position[2])
    }

    /// Whether a curve may pass through between two samples outside: one of them is then no
    /// farther from the surface than half a segment allows.
    #[inline]
    pub(crate) fn may_pass(&self, from: &Offset, to: &Offset, end: &Sample, speed: f32) -> bool {
        let longer = 1.0 + (self.speed + self.growth.abs()) / speed;
        let slack = end.step * f32x8::splat(0.26 * longer * longer);
        let near = from.square.fast_min(to.square);
        let radius = from.radius.fast_max(to.radius);
        near.simd_lt(radius * radius + slack).any()
    }

    /// Penetration inside the segment between two samples that both lie outside.
    pub(crate) fn passing(
        &self,
        from: &Offset,
        to: &Offset,
        begin: &Sample,
        end: &Sample,
    ) -> f32x8 {
        let step = [0, 1, 2].map(|k| to.delta[k] - from.delta[k]);
        let axes = if self.depths.is_some() { 2 } else { 3 };
        let (mut along, mut length) = (f32x8::ZERO, f32x8::splat(1e-12));
        for (&delta, &step) in from.delta.iter().zip(&step).take(axes) {
            along -= delta * step;
            length += step * step;
        }
        let outside = from.square.simd_ge(from.radius * from.radius)
            & to.square.simd_ge(to.radius * to.radius);
        let between = along.simd_gt(f32x8::ZERO) & along.simd_lt(length);
        let candidate = from.exists & to.exists & outside & between;
        if !candidate.any() {
            return f32x8::ZERO;
        }
        let share = along / length;
        let square = (from.square - along * share).fast_max(f32x8::ZERO);
        let radius = from.radius + (to.radius - from.radius) * share;
        let inside = candidate & radius.simd_gt(f32x8::ZERO) & square.simd_lt(radius * radius);
        if !inside.any() {
            return f32x8::ZERO;
        }
        let depth = begin.position[2] + (end.position[2] - begin.position[2]) * share;
        inside & self.share(square, radius, depth)
    }

    #[inline]
    fn share(&self, square: f32x8, radius: f32x8, depth: f32x8) -> f32x8 {
        let radial = f32x8::ONE - square.sqrt() / radius;
        match self.depths {
            None => radial,
            Some((top, bottom)) => {
                let vertical = (depth - f32x8::splat(top)).fast_min(f32x8::splat(bottom) - depth);
                radial.fast_min(vertical / radius).fast_max(f32x8::ZERO)
            }
        }
    }
}
