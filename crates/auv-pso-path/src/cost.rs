//! Eight B-spline curves costed at once against all regions (Eq. 11, 16-18).

use crate::hazards::{Extent, Hazard, Sample};
use crate::settings::PsoSettings;
use auv_bspline::Basis;
use auv_planning::PathProblem;
use auv_types::{Vector3, Violations};
use wide::f32x8;

/// Curves costed at once: the lanes of one vector.
pub(crate) const LANES: usize = 8;

/// Samples whose common extent decides which regions they are compared with.
const PIECE: usize = 10;

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
        })
    }

    pub(crate) fn scratch(&self) -> Scratch {
        let end = (self.problem.target - self.problem.start).map(|x| f32x8::splat(x as f32));
        let mut controls = vec![[f32x8::ZERO; 3]; self.num_control_points];
        controls[self.num_control_points - 1] = end.into();
        let origin = Sample {
            position: [f32x8::ZERO; 3],
            time: f32x8::ZERO,
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
        let Scratch {
            controls, samples, ..
        } = scratch;
        let pace = f32x8::splat((1.0 / self.problem.vehicle.speed_mps) as f32);
        let mut length = f32x8::ZERO;
        let mut before = [f32x8::ZERO; 3];
        let rows = self
            .firsts
            .iter()
            .zip(self.weights.chunks_exact(self.order));
        for (sample, (&first, row)) in samples.iter_mut().zip(rows) {
            let mut at = [f32x8::ZERO; 3];
            for (control, &weight) in controls[first..].iter().zip(row) {
                let weight = f32x8::splat(weight);
                for k in 0..3 {
                    at[k] += control[k] * weight;
                }
            }
            let step = [0, 1, 2].map(|k| at[k] - before[k]);
            length += (step[0] * step[0] + step[1] * step[1] + step[2] * step[2]).sqrt();
            *sample = Sample {
                position: at,
                time: length * pace,
            };
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
        let whole = extent(samples);
        near.clear();
        near.extend((0..self.hazards.len()).filter(|&i| self.hazards[i].may_touch(&whole)));
        let mut sum = f32x8::ZERO;
        if !near.is_empty() {
            let last = samples.len() - 1;
            for begin in (0..last).step_by(PIECE) {
                let end = (begin + PIECE).min(last);
                let piece = &samples[begin..=end];
                let around = extent(piece);
                for &i in near.iter() {
                    if self.hazards[i].may_touch(&around) {
                        sum += along(&self.hazards[i], piece, end == last);
                    }
                }
            }
        }
        sum * f32x8::splat(1.0 / samples.len() as f32)
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

/// Penetration of one region summed over a piece's samples, the last one only at the curve's end.
fn along(hazard: &Hazard, piece: &[Sample], with_last: bool) -> f32x8 {
    let mut sum = f32x8::ZERO;
    let mut from = hazard.offset(&piece[0]);
    for pair in piece.windows(2) {
        let to = hazard.offset(&pair[1]);
        sum += hazard.penetration(&from, &pair[0]);
        sum += hazard.passing(&from, &to, &pair[0], &pair[1]);
        from = to;
    }
    if with_last {
        sum += hazard.penetration(&from, &piece[piece.len() - 1]);
    }
    sum
}

fn extent(samples: &[Sample]) -> Extent {
    let (mut low, mut high) = (samples[0].position, samples[0].position);
    for sample in &samples[1..] {
        for k in 0..3 {
            low[k] = low[k].fast_min(sample.position[k]);
            high[k] = high[k].fast_max(sample.position[k]);
        }
    }
    let least = |v: f32x8| v.to_array().into_iter().fold(f32::INFINITY, f32::min);
    let most = |v: f32x8| v.to_array().into_iter().fold(f32::NEG_INFINITY, f32::max);
    Extent {
        low: low.map(least),
        high: high.map(most),
        begin: least(samples[0].time),
        end: most(samples[samples.len() - 1].time),
    }
}
