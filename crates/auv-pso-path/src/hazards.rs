//! The regions as the swarm sees them: single precision, relative to start and departure.

use crate::lanes::Lanes;
use auv_obstacles::RegionShape;
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
pub(crate) struct Sample<V> {
    pub(crate) position: [V; 3],
    pub(crate) time: V,
    /// Squared length of the segment that ends here.
    pub(crate) step: V,
}

impl<V: Lanes> Sample<V> {
    #[inline(always)]
    pub(crate) fn load(proof: V::Proof, from: &Sample<f32x8>) -> Self {
        let load = |lanes: &f32x8| V::load(proof, lanes);
        let [x, y, z] = &from.position;
        Self {
            position: [load(x), load(y), load(z)],
            time: load(&from.time),
            step: load(&from.step),
        }
    }
}

/// Distance of a sample to the hazard, for the segment that follows.
#[derive(Clone, Copy)]
pub(crate) struct Offset<V> {
    delta: [V; 3],
    radius: V,
    square: V,
    exists: V,
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
                    RegionShape::Ball => None,
                    RegionShape::Cylinder { top_m, bottom_m } => Some((
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
    #[inline(always)]
    pub(crate) fn may_touch<V: Lanes>(
        &self,
        proof: V::Proof,
        middle: &Sample<V>,
        half: V,
        speed: f32,
    ) -> bool {
        let splat = |value| V::splat(proof, value);
        let at = self.offset(proof, middle);
        let reach = at.radius.max(splat(0.0))
            + half * splat(1.0001 * (speed + self.speed + self.growth.abs()))
            + splat(0.01);
        at.square.le(reach * reach).any()
    }

    /// Where eight samples lie relative to the hazard.
    #[inline(always)]
    pub(crate) fn offset<V: Lanes>(&self, proof: V::Proof, sample: &Sample<V>) -> Offset<V> {
        let splat = |value| V::splat(proof, value);
        let t = sample.time;
        let axis =
            |k: usize| sample.position[k] - (splat(self.centre[k]) + splat(self.velocity[k]) * t);
        let delta = [axis(0), axis(1), axis(2)];
        let across = delta[0] * delta[0] + delta[1] * delta[1];
        let square = if self.depths.is_some() {
            across
        } else {
            across + delta[2] * delta[2]
        };
        let exists = if self.from == f32::NEG_INFINITY && self.until == f32::INFINITY {
            splat(f32::from_bits(u32::MAX))
        } else {
            t.ge(splat(self.from)) & t.le(splat(self.until))
        };
        Offset {
            delta,
            radius: splat(self.radius) + splat(self.growth) * t,
            square,
            exists,
        }
    }

    /// Penetration of a sample as a share of the radius: `max(0, 1 - distance / radius)`.
    #[inline(always)]
    pub(crate) fn penetration<V: Lanes>(
        &self,
        proof: V::Proof,
        at: &Offset<V>,
        sample: &Sample<V>,
    ) -> V {
        let zero = V::splat(proof, 0.0);
        let inside = at.exists & at.radius.gt(zero) & at.square.lt(at.radius * at.radius);
        if !inside.any() {
            return zero;
        }
        inside & self.share(proof, at.square, at.radius, sample.position[2])
    }

    /// Whether a curve may pass through between two samples outside: one of them is then no
    /// farther from the surface than half a segment allows.
    #[inline(always)]
    pub(crate) fn may_pass<V: Lanes>(
        &self,
        proof: V::Proof,
        from: &Offset<V>,
        to: &Offset<V>,
        end: &Sample<V>,
        speed: f32,
    ) -> bool {
        let longer = 1.0 + (self.speed + self.growth.abs()) / speed;
        let slack = end.step * V::splat(proof, 0.26 * longer * longer);
        let near = from.square.min(to.square);
        let radius = from.radius.max(to.radius);
        near.lt(radius * radius + slack).any()
    }

    /// Penetration inside the segment between two samples that both lie outside.
    #[inline(always)]
    pub(crate) fn passing<V: Lanes>(
        &self,
        proof: V::Proof,
        from: &Offset<V>,
        to: &Offset<V>,
        begin: &Sample<V>,
        end: &Sample<V>,
    ) -> V {
        let zero = V::splat(proof, 0.0);
        let axes = if self.depths.is_some() { 2 } else { 3 };
        let (mut along, mut length) = (zero, V::splat(proof, 1e-12));
        for k in 0..axes {
            let step = to.delta[k] - from.delta[k];
            along = along - from.delta[k] * step;
            length = length + step * step;
        }
        let outside =
            from.square.ge(from.radius * from.radius) & to.square.ge(to.radius * to.radius);
        let between = along.gt(zero) & along.lt(length);
        let candidate = from.exists & to.exists & outside & between;
        if !candidate.any() {
            return zero;
        }
        let share = along / length;
        let square = (from.square - along * share).max(zero);
        let radius = from.radius + (to.radius - from.radius) * share;
        let inside = candidate & radius.gt(zero) & square.lt(radius * radius);
        if !inside.any() {
            return zero;
        }
        let depth = begin.position[2] + (end.position[2] - begin.position[2]) * share;
        inside & self.share(proof, square, radius, depth)
    }

    #[inline(always)]
    fn share<V: Lanes>(&self, proof: V::Proof, square: V, radius: V, depth: V) -> V {
        let splat = |value| V::splat(proof, value);
        let radial = splat(1.0) - square.sqrt() / radius;
        match self.depths {
            None => radial,
            Some((top, bottom)) => {
                let vertical = (depth - splat(top)).min(splat(bottom) - depth);
                radial.min(vertical / radius).max(splat(0.0))
            }
        }
    }
}
