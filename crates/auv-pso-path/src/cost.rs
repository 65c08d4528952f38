//! Eight B-spline curves costed at once against all regions (Eq. 11, 16-18).

use crate::hazards::{Hazard, Sample};
use crate::settings::PsoSettings;
use auv_bspline::Basis;
use auv_planning::PathProblem;
use auv_types::{Vector3, Violations};
use wide::f32x8;

/// Curves costed at once: the lanes of one vector.
pub(crate) const LANES: usize = 8;

/// Segments that are compared with the same regions.
const PIECE: usize = 8;

/// Everything about one leg that costing curves needs, computed once.
#[derive(Debug)]
pub(crate) struct Costing<'a> {
    problem: &'a PathProblem<'a>,
    hazards: Vec<Hazard>,
    firsts: Vec<usize>,
    weights: Vec<f32>,
    order: usize,
    num_control_points: usize,
    bounds_size_m: f64,
    /// Speed through the water, and the greatest over ground.
    vehicle_speed: f32,
    speed: f32,
}

/// What one thread needs while costing.
#[derive(Clone, Debug)]
pub(crate) struct Scratch {
    controls: Vec<[f32x8; 3]>,
    samples: Vec<Sample>,
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
        settings: &PsoSettings,
    ) -> Result<Self, Violations> {
        let basis = Basis::new(settings.control_points, settings.order, settings.samples)?;
        let line_m = (problem.target - problem.start).norm();
        let size_m = problem
            .bounds
            .map_or(line_m, |bounds| (bounds.high - bounds.low).norm());
        // Curves longer than this are out of the question, and so is what exists only after them.
        let longest_m = size_m.max(line_m) * 20.0;
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

    pub(crate) fn scratch(&self) -> Scratch {
        let end = (self.problem.target - self.problem.start).map(|x| f32x8::splat(x as f32));
        let mut controls = vec![[f32x8::ZERO; 3]; self.num_control_points];
        controls[self.num_control_points - 1] = end.into();
        let origin = Sample {
            position: [f32x8::ZERO; 3],
            time: f32x8::ZERO,
            step: f32x8::ZERO,
        };
        Scratch {
            controls,
            samples: vec![origin; self.firsts.len()],
            near: Vec::with_capacity(self.hazards.len()),
        }
    }

    /// Costs the curves with the given free control points: coordinate `3 i + axis` of point `i`,
    /// relative to the start, eight curves side by side.
    pub(crate) fn cost(&self, free: &[f32x8], scratch: &mut Scratch) -> Costed {
        for (control, point) in scratch.controls[1..].iter_mut().zip(free.chunks_exact(3)) {
            *control = [point[0], point[1], point[2]];
        }
        let length = self.sample(scratch);
        let mut violation = self.regions(scratch);
        if self.problem.sea_bed.is_some() {
            violation += self.grounding(scratch);
        }
        Costed {
            length_m: length.to_array(),
            violation: violation.to_array(),
        }
    }

    /// Positions by the basis table, arrival times by the length so far (Eq. 17).
    fn sample(&self, scratch: &mut Scratch) -> f32x8 {
        // The usual orders with their number of terms known to the compiler.
        match self.order {
            3 => self.sample_order::<3>(scratch),
            4 => self.sample_order::<4>(scratch),
            5 => self.sample_order::<5>(scratch),
            _ => self.sample_any(scratch),
        }
    }

    fn sample_order<const K: usize>(&self, scratch: &mut Scratch) -> f32x8 {
        self.sample_by(scratch, |controls, row| {
            let (Some(controls), Some(row)) = (controls.first_chunk(), row.first_chunk()) else {
                return [f32x8::ZERO; 3];
            };
            weighted::<K>(controls, row)
        })
    }

    fn sample_any(&self, scratch: &mut Scratch) -> f32x8 {
        self.sample_by(scratch, |controls, row| {
            let mut at = [f32x8::ZERO; 3];
            for (control, &weight) in controls.iter().zip(row) {
                for (at, &axis) in at.iter_mut().zip(control) {
                    *at += axis * f32x8::splat(weight);
                }
            }
            at
        })
    }

    #[inline]
    fn sample_by(
        &self,
        scratch: &mut Scratch,
        place: impl Fn(&[[f32x8; 3]], &[f32]) -> [f32x8; 3],
    ) -> f32x8 {
        let Scratch {
            controls, samples, ..
        } = scratch;
        let pace = f32x8::splat((1.0 / self.problem.vehicle.speed_mps) as f32);
        let mut length = f32x8::ZERO;
        let mut before = [f32x8::ZERO; 3];
        let rows = self.weights.chunks_exact(self.order);
        for ((sample, &first), row) in samples.iter_mut().zip(&self.firsts).zip(rows) {
            let at = place(&controls[first..], row);
            let (x, y, z) = (at[0] - before[0], at[1] - before[1], at[2] - before[2]);
            let step = x * x + y * y + z * z;
            length += step.sqrt();
            // In place: a whole sample is moved through memory.
            (sample.position, sample.time, sample.step) = (at, length * pace, step);
            before = at;
        }
        if self.problem.current.is_some() {
            self.time_in_current(samples);
        }
        length
    }

    /// Arrival times where the water moves: every segment at the ground speed at its middle.
    fn time_in_current(&self, samples: &mut [Sample]) {
        let problem = self.problem;
        for lane in 0..LANES {
            let mut time_s = 0.0;
            let place = |sample: &Sample| {
                let axis = |k: usize| f64::from(sample.position[k].to_array()[lane]);
                problem.start + Vector3::new(axis(0), axis(1), axis(2))
            };
            let mut before = problem.start;
            for sample in samples.iter_mut() {
                let at = place(sample);
                let step = at - before;
                let length_m = step.norm();
                if length_m > 1e-6 {
                    let middle = before + step * 0.5;
                    let now_s = problem.departure_s + time_s;
                    // No way made: as if drifting for an hour, which no other curve does.
                    let speed = problem.ground_speed_mps(&(step / length_m), &middle, now_s);
                    time_s += speed.map_or(3_600.0, |speed| length_m / speed);
                }
                let mut times = sample.time.to_array();
                times[lane] = time_s as f32;
                sample.time = f32x8::new(times);
                before = at;
            }
        }
    }

    /// Sum over regions of the mean penetration of samples, and of segments that pass through
    /// between two samples outside.
    fn regions(&self, scratch: &mut Scratch) -> f32x8 {
        let Scratch { samples, near, .. } = scratch;
        let last = samples.len() - 1;
        let (whole, half) = middle(samples, 0, last);
        near.clear();
        near.extend(
            (0..self.hazards.len()).filter(|&i| self.hazards[i].may_touch(whole, half, self.speed)),
        );
        let mut sum = f32x8::ZERO;
        for begin in (0..last).step_by(PIECE) {
            let end = (begin + PIECE).min(last);
            let (middle, half) = middle(samples, begin, end);
            for &i in near.iter() {
                let hazard = &self.hazards[i];
                if hazard.may_touch(middle, half, self.speed) {
                    sum += self.along(hazard, &samples[begin..=end], end == last);
                }
            }
        }
        sum * f32x8::splat(1.0 / samples.len() as f32)
    }

    /// Penetration of one region summed over a piece's samples, the last one only at the curve's end.
    fn along(&self, hazard: &Hazard, piece: &[Sample], with_last: bool) -> f32x8 {
        let mut sum = f32x8::ZERO;
        let mut from = hazard.offset(&piece[0]);
        for pair in piece.windows(2) {
            let to = hazard.offset(&pair[1]);
            sum += hazard.penetration(&from, &pair[0]);
            if hazard.may_pass(&from, &to, &pair[1], self.vehicle_speed) {
                sum += hazard.passing(&from, &to, &pair[0], &pair[1]);
            }
            from = to;
        }
        if with_last {
            sum += hazard.penetration(&from, &piece[piece.len() - 1]);
        }
        sum
    }

    /// Mean depth below the deepest allowed, as a share of the box.
    fn grounding(&self, scratch: &Scratch) -> f32x8 {
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

/// A sample in the middle of a stretch, and the greatest time from it to either end.
fn middle(samples: &[Sample], begin: usize, end: usize) -> (&Sample, f32x8) {
    let middle = &samples[begin.midpoint(end)];
    let before = middle.time - samples[begin].time;
    (middle, before.fast_max(samples[end].time - middle.time))
}

#[inline]
fn weighted<const K: usize>(controls: &[[f32x8; 3]; K], row: &[f32; K]) -> [f32x8; 3] {
    let mut at = [f32x8::ZERO; 3];
    for k in 0..K {
        let weight = f32x8::splat(row[k]);
        at[0] += controls[k][0] * weight;
        at[1] += controls[k][1] * weight;
        at[2] += controls[k][2] * weight;
    }
    at
}
