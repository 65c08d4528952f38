//! The regions as the swarm sees them: single precision, relative to start and departure.

use crate::swarm::lanes::Lanes;
use auv_obstacles::RegionShape;
use auv_planning::PathProblem;
use wide::f32x8;

/// A region with the clearance and the sampling margin added, relative to the leg's start and
/// departure. Metres, seconds.
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

/// Where eight samples lie relative to a hazard. Kept for the segment that follows.
#[derive(Clone, Copy)]
pub(crate) struct Offset<V> {
    delta: [V; 3],
    radius: V,
    square: V,
    exists: V,
}

/// Metres added to every radius, for single precision and the chords between samples.
const SAMPLING_MARGIN_M: f64 = 0.02;
/// Relative and absolute rounding of the reach, so that it never misses a curve.
const REACH_ROUNDING: f32 = 1.0001;
const REACH_ROUNDING_M: f32 = 0.01;
/// Square of half a segment, with rounding: every point of a segment lies within half of it from its
/// nearer end.
const HALF_SEGMENT_SQUARE: f32 = 0.26;
/// Squared length added to every segment, square metres: none has length 0.
const LEAST_SQUARE: f32 = 1e-12;

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

    /// Whether any curve may touch the hazard within `half` seconds of a sample at up to `speed` over
    /// ground. It never misses one that does.
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
            + half * splat(REACH_ROUNDING * (speed + self.speed + self.growth.abs()))
            + splat(REACH_ROUNDING_M);
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

    /// Whether a curve may pass through between two samples outside. Then one of them lies within half
    /// a segment of the surface.
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
        let slack = end.step * V::splat(proof, HALF_SEGMENT_SQUARE * longer * longer);
        let near = from.square.min(to.square);
        let radius = from.radius.max(to.radius);
        near.lt(radius * radius + slack).any()
    }

    /// Penetration at the closest point of a segment whose ends both lie outside.
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
        let (mut along, mut length) = (zero, V::splat(proof, LEAST_SQUARE));
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

    /// Penetration as a share of the radius; of a cylinder the lesser of radial and vertical.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::swarm::lanes::LANES;
    use auv_obstacles::{Region, TimedPoint};
    use auv_planning::Vehicle;
    use auv_types::{Point3, Seed, Vector3, rand::RngExt};

    const DEPARTURE_S: f64 = 700.0;
    const START: Point3<f64> = Point3::new(4_000.0, -2_000.0, 60.0);

    /// A region near the start, of either kind.
    fn region(draw: &mut impl FnMut(f64, f64) -> f64, is_ball: bool) -> Region {
        let aside = Vector3::new(draw(-50.0, 50.0), draw(-50.0, 50.0), draw(-30.0, 30.0));
        let mut region = if is_ball {
            Region::ball(START + aside, draw(5.0, 60.0))
        } else {
            Region::cylinder(
                START + aside,
                draw(5.0, 60.0),
                draw(0.0, 59.0),
                draw(61.0, 130.0),
            )
        };
        region.at_s = DEPARTURE_S;
        region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0);
        region.growth_mps = draw(-0.05, 0.1);
        region
    }

    fn hazard(region: Region) -> Hazard {
        let vehicle = Vehicle::paper();
        let regions = [region];
        let problem = PathProblem {
            regions: &regions,
            clearance_m: 3.0,
            departure_s: DEPARTURE_S,
            ..PathProblem::new(START, START + Vector3::x() * 100.0, &vehicle)
        };
        Hazard::of(&problem, 1_000.0)[0]
    }

    fn sample(points: &[TimedPoint; LANES]) -> Sample<f32x8> {
        let axis = |k: usize| f32x8::new(points.map(|p| (p.position[k] - START[k]) as f32));
        Sample {
            position: [axis(0), axis(1), axis(2)],
            time: f32x8::new(points.map(|p| (p.time_s - DEPARTURE_S) as f32)),
            step: f32x8::ZERO,
        }
    }

    /// `max(0, 1 - distance / radius)`, of a cylinder the lesser of radial and vertical depth.
    fn penetration(region: &Region, point: &TimedPoint) -> f64 {
        let grown = region.inflated(3.0 + SAMPLING_MARGIN_M);
        let radius_m = grown.radius_at(point.time_s);
        if !grown.exists_at(point.time_s) || radius_m <= 0.0 {
            return 0.0;
        }
        (-grown.distance_m(point) / radius_m).max(0.0)
    }

    #[test]
    fn penetration_is_the_share_of_the_radius() {
        let mut random = Seed(21).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let mut inside = 0;
        for round in 0..200 {
            let mut region = region(&mut draw, round % 2 == 0);
            if round % 5 == 0 {
                region.from_s = DEPARTURE_S + 20.0;
                region.until_s = DEPARTURE_S + 60.0;
            }
            let hazard = hazard(region);
            let points: [TimedPoint; LANES] = std::array::from_fn(|_| {
                let aside = Vector3::new(draw(-60.0, 60.0), draw(-60.0, 60.0), draw(-40.0, 40.0));
                TimedPoint::new(START + aside, DEPARTURE_S + draw(0.0, 100.0))
            });
            let sample = sample(&points);
            let found = hazard.penetration((), &hazard.offset((), &sample), &sample);
            for (found, point) in found.to_array().into_iter().zip(&points) {
                let expected = penetration(&region, point);
                assert!(
                    (f64::from(found) - expected).abs() < 1e-4,
                    "{found} {expected}"
                );
                inside += usize::from(expected > 0.0);
            }
            let touched = found.to_array().iter().any(|&share| share > 0.0);
            let may_touch = hazard.may_touch((), &sample, f32x8::ZERO, 3.0);
            assert!(!touched || may_touch);
        }
        assert!(inside > 200, "{inside}");
    }

    #[test]
    fn a_segment_that_passes_through_is_seen_between_its_ends() {
        let mut random = Seed(22).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let mut passed = 0;
        for round in 0..600 {
            let region = region(&mut draw, round % 2 == 0);
            let hazard = hazard(region);
            let begin_s = DEPARTURE_S + draw(0.0, 50.0);
            let begin: [TimedPoint; LANES] = std::array::from_fn(|_| {
                let aside = Vector3::new(draw(-90.0, 90.0), draw(-90.0, 90.0), draw(-30.0, 30.0));
                TimedPoint::new(START + aside, begin_s)
            });
            let end = begin.map(|p| {
                let step = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), 0.0).normalize() * 90.0;
                TimedPoint::new(p.position + step, begin_s + 30.0)
            });
            let (from, mut to) = (sample(&begin), sample(&end));
            to.step = f32x8::splat(90.0 * 90.0);
            let (near, far) = (hazard.offset((), &from), hazard.offset((), &to));
            let found = hazard.passing((), &near, &far, &from, &to).to_array();
            let may_pass = hazard.may_pass((), &near, &far, &to, 3.0);
            assert!(may_pass || found.iter().all(|&share| share <= 0.0));
            for lane in 0..LANES {
                let at = |share: f64| {
                    let step = end[lane].position - begin[lane].position;
                    TimedPoint::new(begin[lane].position + step * share, begin_s + 30.0 * share)
                };
                let ends_m = [at(0.0), at(1.0)].map(|p| region.inflated(3.1).distance_m(&p));
                // A ball's share at the closest point of the segment, where both ends are outside.
                if round % 2 == 0
                    && ends_m.iter().all(|&m| m > 0.0)
                    && region.growth_mps.abs() < 0.02
                {
                    let shares = (0..=3_000).map(|k| penetration(&region, &at(f64::from(k) / 3e3)));
                    let deepest = shares.fold(0.0, f64::max);
                    let share = f64::from(found[lane]);
                    assert!(
                        (share - deepest).abs() < 0.01,
                        "round {round}: {share} {deepest}"
                    );
                    passed += usize::from(deepest > 0.0);
                }
            }
        }
        assert!(passed > 20, "{passed}");
    }

    #[test]
    fn regions_of_another_time_are_left_out() {
        let vehicle = Vehicle::paper();
        let during = |from_s: f64, until_s: f64| Region {
            from_s,
            until_s,
            ..Region::ball(START, 10.0)
        };
        let regions = [
            during(0.0, 699.0),
            during(0.0, 701.0),
            during(750.0, 800.0),
            during(801.0, 900.0),
        ];
        let problem = PathProblem {
            regions: &regions,
            departure_s: DEPARTURE_S,
            ..PathProblem::new(START, START + Vector3::x() * 100.0, &vehicle)
        };
        let kept = Hazard::of(&problem, 100.0);
        assert_eq!(
            kept.iter().map(|h| h.until).collect::<Vec<_>>(),
            [1.0, 100.0]
        );
    }
}
