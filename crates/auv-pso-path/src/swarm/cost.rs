//! Eight B-spline curves costed at once against all regions (Eq. 11, 16-18).

use crate::swarm::hazards::{Hazard, Sample};
use crate::swarm::lanes::{LANES, Lanes};
use crate::swarm::settings::SwarmSettings;
use auv_bspline::Basis;
use auv_planning::PathProblem;
use auv_types::{Vector3, Violations};
use wide::f32x8;

/// Segments that are compared with a region together.
const PIECE: usize = 8;
/// Regions that appear later than the vehicle needs, at its speed through the water, for this many
/// times the box's diagonal (or the straight line, if that is longer) are left out. No curve is
/// rejected for its length.
const LONGEST_FACTOR: f64 = 20.0;
/// A segment shorter than this takes no time in a current, metres.
const SHORTEST_M: f64 = 1e-6;
/// Time of a segment on which the current allows no headway, seconds: an hour, longer than any
/// other segment takes.
const NO_HEADWAY_S: f64 = 3_600.0;

/// What costing the curves of one leg needs, computed once.
#[derive(Debug)]
pub(crate) struct Costing<'a> {
    problem: &'a PathProblem<'a>,
    hazards: Vec<Hazard>,
    /// The basis table: first control point and weights of each sample.
    firsts: Vec<usize>,
    weights: Vec<f32>,
    order: usize,
    num_control_points: usize,
    /// Length that depths below the bed are divided by, metres.
    bounds_size_m: f64,
    /// Speed through the water, m/s.
    vehicle_speed: f32,
    /// Greatest speed over ground, m/s.
    speed: f32,
}

/// Buffers of one thread.
#[derive(Debug)]
pub(crate) struct CurveScratch {
    controls: Vec<[f32x8; 3]>,
    samples: Vec<Sample<f32x8>>,
    near: Vec<usize>,
}

/// Length in metres and violation of eight curves.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Costed {
    pub(crate) length_m: [f32; LANES],
    pub(crate) violation: [f32; LANES],
}

impl<'a> Costing<'a> {
    pub(crate) fn new(
        problem: &'a PathProblem<'a>,
        settings: &SwarmSettings,
    ) -> Result<Self, Violations> {
        let basis = Basis::new(settings.control_points, settings.order, settings.samples)?;
        let line_m = (problem.target - problem.start).norm();
        let size_m = problem
            .bounds
            .and_then(|bounds| bounds.diagonal_m())
            .unwrap_or(line_m);
        let longest_m = size_m.max(line_m) * LONGEST_FACTOR;
        Ok(Self {
            problem,
            hazards: Hazard::of(problem, longest_m / problem.vehicle.speed_mps),
            firsts: (0..settings.samples).map(|j| basis.first(j)).collect(),
            weights: basis.banded_f32(),
            order: settings.order,
            num_control_points: settings.control_points,
            bounds_size_m: size_m.max(1.0),
            vehicle_speed: problem.vehicle.speed_mps as f32,
            speed: (problem.vehicle.speed_mps
                + problem.current.map_or(0.0, |field| field.max_speed_mps()))
                as f32,
        })
    }

    pub(crate) fn scratch(&self) -> CurveScratch {
        let end = (self.problem.target - self.problem.start).map(|x| f32x8::splat(x as f32));
        let mut controls = vec![[f32x8::ZERO; 3]; self.num_control_points];
        controls[self.num_control_points - 1] = end.into();
        let origin = Sample {
            position: [f32x8::ZERO; 3],
            time: f32x8::ZERO,
            step: f32x8::ZERO,
        };
        CurveScratch {
            controls,
            samples: vec![origin; self.firsts.len()],
            near: Vec::with_capacity(self.hazards.len()),
        }
    }

    /// Costs the curves with the given free control points: coordinate `3 i + axis` of point `i`,
    /// relative to the start, eight curves side by side.
    #[inline(always)]
    pub(crate) fn cost<V: Lanes>(
        &self,
        proof: V::Proof,
        free: &[f32x8],
        scratch: &mut CurveScratch,
    ) -> Costed {
        for (control, point) in scratch.controls[1..].iter_mut().zip(free.chunks_exact(3)) {
            *control = [point[0], point[1], point[2]];
        }
        // For the usual orders the compiler knows the number of terms.
        let length = match self.order {
            3 => self.sample::<V, 3>(proof, scratch),
            4 => self.sample::<V, 4>(proof, scratch),
            5 => self.sample::<V, 5>(proof, scratch),
            _ => self.sample::<V, 0>(proof, scratch),
        };
        let mut violation = self.regions::<V>(proof, scratch).store();
        if self.problem.sea_bed.is_some() {
            violation += self.grounding(scratch);
        }
        Costed {
            length_m: length.store().to_array(),
            violation: violation.to_array(),
        }
    }

    /// Computes positions from the basis table and arrival times from the length so far (Eq. 17). `K`
    /// is the order, or 0 for any order. Returns the length.
    #[inline(always)]
    fn sample<V: Lanes, const K: usize>(&self, proof: V::Proof, scratch: &mut CurveScratch) -> V {
        let CurveScratch {
            controls, samples, ..
        } = scratch;
        let zero = V::splat(proof, 0.0);
        let pace = V::splat(proof, (1.0 / self.problem.vehicle.speed_mps) as f32);
        let mut length = zero;
        let mut before = [zero; 3];
        let order = if K == 0 { self.order } else { K };
        let rows = self.weights.chunks_exact(order);
        for ((sample, &first), row) in samples.iter_mut().zip(&self.firsts).zip(rows) {
            let mut at = [zero; 3];
            for (control, &weight) in controls[first..][..order].iter().zip(row) {
                let weight = V::splat(proof, weight);
                for k in 0..3 {
                    at[k] = at[k] + V::load(proof, &control[k]) * weight;
                }
            }
            let (x, y, z) = (at[0] - before[0], at[1] - before[1], at[2] - before[2]);
            let step = x * x + y * y + z * z;
            length = length + step.sqrt();
            // Field by field: a whole sample would go through memory twice.
            sample.position = at.map(V::store);
            sample.time = (length * pace).store();
            sample.step = step.store();
            before = at;
        }
        if self.problem.current.is_some() {
            self.time_in_current(samples);
        }
        length
    }

    /// Arrival times in a current: each segment at the speed over ground at its middle.
    fn time_in_current(&self, samples: &mut [Sample<f32x8>]) {
        let problem = self.problem;
        for lane in 0..LANES {
            let mut time_s = 0.0;
            let place = |sample: &Sample<f32x8>| {
                let axis = |k: usize| f64::from(sample.position[k].to_array()[lane]);
                problem.start + Vector3::new(axis(0), axis(1), axis(2))
            };
            let mut before = problem.start;
            for sample in samples.iter_mut() {
                let at = place(sample);
                let step = at - before;
                let length_m = step.norm();
                if length_m > SHORTEST_M {
                    let middle = before + step * 0.5;
                    let now_s = problem.departure_s + time_s;
                    let speed = problem.ground_speed_mps(&(step / length_m), &middle, now_s);
                    time_s += speed.map_or(NO_HEADWAY_S, |speed| length_m / speed);
                }
                let mut times = sample.time.to_array();
                times[lane] = time_s as f32;
                sample.time = f32x8::new(times);
                before = at;
            }
        }
    }

    /// Sum over regions of the mean penetration of the samples (Eq. 18), and of segments that pass
    /// through a region between two samples outside it.
    #[inline(always)]
    fn regions<V: Lanes>(&self, proof: V::Proof, scratch: &mut CurveScratch) -> V {
        let CurveScratch { samples, near, .. } = scratch;
        let last = samples.len() - 1;
        let (whole, half) = middle::<V>(proof, samples, 0, last);
        near.clear();
        for (i, hazard) in self.hazards.iter().enumerate() {
            if hazard.may_touch(proof, &whole, half, self.speed) {
                near.push(i);
            }
        }
        let mut sum = V::splat(proof, 0.0);
        for begin in (0..last).step_by(PIECE) {
            let end = (begin + PIECE).min(last);
            let (middle, half) = middle::<V>(proof, samples, begin, end);
            for &i in near.iter() {
                let hazard = &self.hazards[i];
                if hazard.may_touch(proof, &middle, half, self.speed) {
                    sum = sum + self.along::<V>(proof, hazard, &samples[begin..=end], end == last);
                }
            }
        }
        sum * V::splat(proof, 1.0 / samples.len() as f32)
    }

    /// Penetration of one region, summed over a piece's samples without the last, which the next
    /// piece has; `with_last` adds it at the end of the curve.
    #[inline(always)]
    fn along<V: Lanes>(
        &self,
        proof: V::Proof,
        hazard: &Hazard,
        piece: &[Sample<f32x8>],
        with_last: bool,
    ) -> V {
        let mut sum = V::splat(proof, 0.0);
        let mut begin = Sample::<V>::load(proof, &piece[0]);
        let mut from = hazard.offset(proof, &begin);
        for end in &piece[1..] {
            let end = Sample::<V>::load(proof, end);
            let to = hazard.offset(proof, &end);
            sum = sum + hazard.penetration(proof, &from, &begin);
            if hazard.may_pass(proof, &from, &to, &end, self.vehicle_speed) {
                sum = sum + hazard.passing(proof, &from, &to, &begin, &end);
            }
            (begin, from) = (end, to);
        }
        if with_last {
            sum = sum + hazard.penetration(proof, &from, &begin);
        }
        sum
    }

    /// Mean depth below the deepest allowed, as a share of the box's diagonal.
    fn grounding(&self, scratch: &CurveScratch) -> f32x8 {
        let mut sum = [0.0_f32; LANES];
        for sample in &scratch.samples {
            let position = sample.position.map(|axis| axis.to_array());
            for (lane, sum) in sum.iter_mut().enumerate() {
                let at = |k: usize| self.problem.start[k] + f64::from(position[k][lane]);
                let short_m = at(2) - self.problem.deepest_at(at(0), at(1));
                *sum += (short_m.max(0.0) / self.bounds_size_m) as f32;
            }
        }
        f32x8::new(sum) * f32x8::splat(1.0 / scratch.samples.len() as f32)
    }
}

/// The middle sample of a stretch, and the longer of the times from it to either end.
#[inline(always)]
fn middle<V: Lanes>(
    proof: V::Proof,
    samples: &[Sample<f32x8>],
    begin: usize,
    end: usize,
) -> (Sample<V>, V) {
    let middle = Sample::<V>::load(proof, &samples[begin.midpoint(end)]);
    let time = |sample: usize| V::load(proof, &samples[sample].time);
    let before = middle.time - time(begin);
    (middle, before.max(time(end) - middle.time))
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_bspline::BSpline;
    use auv_obstacles::{Region, TimedPoint};
    use auv_ocean::{AnalyticBed, Undulation, UniformCurrent};
    use auv_planning::Vehicle;
    use auv_types::{Point3, Seed, rand::RngExt};

    /// Metres added to every region by the costing.
    const MARGIN_M: f64 = 0.02;

    /// Length and violation of one curve in double precision, without culling. Regions count where
    /// a sample lies inside them.
    fn by_definition(
        problem: &PathProblem<'_>,
        settings: &SwarmSettings,
        curve: &BSpline,
    ) -> [f64; 2] {
        let points = curve.uniform_points(settings.samples).unwrap();
        let (mut length_m, mut time_s, mut sum) = (0.0, problem.departure_s, 0.0);
        for (i, point) in points.iter().enumerate() {
            let before = points[i.saturating_sub(1)];
            let step = point - before;
            length_m += step.norm();
            if step.norm() > 0.0 {
                let middle = before + step * 0.5;
                let direction = step.normalize();
                let speed = problem.ground_speed_mps(&direction, &middle, time_s);
                time_s += step.norm() / speed.unwrap();
            }
            let at = TimedPoint::new(*point, time_s);
            for region in problem.regions {
                let grown = region.inflated(problem.clearance_m + MARGIN_M);
                if grown.exists_at(time_s) {
                    sum += (-grown.distance_m(&at) / grown.radius_at(time_s)).max(0.0);
                }
            }
            let deep_m = point.z - problem.deepest_at(point.x, point.y);
            let scale_m = (problem.target - problem.start).norm();
            sum += deep_m.max(0.0) / scale_m;
        }
        [length_m, sum / points.len() as f64]
    }

    /// Wide regions, so that hardly any segment passes through one between its ends.
    fn wide_regions(draw: &mut impl FnMut(f64, f64) -> f64) -> Vec<Region> {
        (0..3)
            .map(|i| {
                let centre = Point3::new(draw(200.0, 800.0), draw(-150.0, 150.0), 60.0);
                let mut region = if i == 0 {
                    Region::cylinder(centre, draw(60.0, 120.0), 0.0, 200.0)
                } else {
                    Region::ball(centre, draw(60.0, 120.0))
                };
                region.velocity_mps = Vector3::new(draw(-0.5, 0.5), draw(-0.5, 0.5), 0.0);
                region
            })
            .collect()
    }

    /// Eight curves along the leg: coordinate `3 i + axis` of free control point `i`.
    fn offsets(free: usize, draw: &mut impl FnMut(f64, f64) -> f64) -> Vec<[f32; LANES]> {
        (0..3 * free)
            .map(|k| {
                let along = if k % 3 == 0 {
                    140.0 * (k / 3 + 1) as f64
                } else {
                    0.0
                };
                std::array::from_fn(|_| (along + draw(-60.0, 60.0)) as f32)
            })
            .collect()
    }

    fn curve(
        problem: &PathProblem<'_>,
        order: usize,
        offsets: &[[f32; LANES]],
        lane: usize,
    ) -> BSpline {
        let mut control = vec![problem.start];
        control.extend(offsets.chunks_exact(3).map(|point| {
            let at = |k: usize| problem.start[k] + f64::from(point[k][lane]);
            Point3::new(at(0), at(1), at(2))
        }));
        control.push(problem.target);
        BSpline::new(order, control).unwrap()
    }

    #[test]
    fn eight_curves_cost_what_the_definition_says() {
        let vehicle = Vehicle::paper();
        let current = UniformCurrent::new(Vector3::new(0.5, -0.7, 0.0));
        let mut bed = AnalyticBed::new(90.0);
        bed.undulations.push(Undulation {
            amplitude_m: 20.0,
            wavelength: [400.0, 0.0],
        });
        let mut random = Seed(31).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let mut intruding = 0;
        for round in 0..12 {
            let regions = wide_regions(&mut draw);
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 4.0,
                departure_s: 100.0,
                current: (round % 3 == 1).then_some(&current as _),
                sea_bed: (round % 3 == 2).then_some(&bed as _),
                ..PathProblem::new(
                    Point3::new(0.0, 0.0, 60.0),
                    Point3::new(1_000.0, 0.0, 70.0),
                    &vehicle,
                )
            };
            let settings = SwarmSettings {
                samples: 400,
                order: 3 + round % 4,
                ..SwarmSettings::paper()
            };
            let costing = Costing::new(&problem, &settings).unwrap();
            let offsets = offsets(settings.control_points - 2, &mut draw);
            let lanes: Vec<_> = offsets.iter().map(|&o| f32x8::new(o)).collect();
            let costed = costing.cost::<f32x8>((), &lanes, &mut costing.scratch());
            for lane in 0..LANES {
                let curve = curve(&problem, settings.order, &offsets, lane);
                let [length_m, violation] = by_definition(&problem, &settings, &curve);
                assert!((f64::from(costed.length_m[lane]) / length_m - 1.0).abs() < 1e-4);
                let found = f64::from(costed.violation[lane]);
                let off = (found - violation).abs();
                assert!(
                    off < 2e-3 * (violation + 0.02),
                    "round {round}: {found} {violation}"
                );
                intruding += usize::from(violation > 0.0);
            }
        }
        assert!(intruding > 30, "{intruding}");
    }
}
