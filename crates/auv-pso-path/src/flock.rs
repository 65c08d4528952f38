//! The search for better sides: a flock of bumps in the best string, each pulled taut in a window
//! of its own, the ones that gain merged.

use crate::field::{Field, sideways};
use crate::flyable::{Candidate, Launch};
use crate::string::{Pull, Strand, StringMaker};
use crate::work::Rate;
use auv_planning::{Deadline, PathProblem, StopReason};
use auv_population::{Members, Progress, Search};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed, libm};

/// Rounds a bump is pulled for at most.
const ROUNDS: u64 = 14;
/// Evaluations a bump is charged beforehand: its window is a quarter of the curve or less. What it
/// takes beyond them is charged with the next.
const EVALUATIONS: u64 = 4;
/// Evaluations after which a bump is given up, and a merged string.
const MOST: u64 = 20;
const MOST_MERGED: u64 = 150;
/// A bump's gain that counts, as a share of the flight.
const LEAST_GAIN: f64 = 1e-6;

/// Everything that stays the same during a search.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Setting<'a> {
    pub(crate) problem: &'a PathProblem<'a>,
    pub(crate) field: &'a Field,
    pub(crate) launch: &'a Launch,
    pub(crate) rate: Rate,
    pub(crate) deadline: Deadline<'a>,
}

/// The flock around the best candidate.
#[derive(Debug)]
pub(crate) struct Flock<'a> {
    setting: Setting<'a>,
    seed: Seed,
    best: Candidate,
    bumps: Members<Bump>,
    maker: StringMaker<'a>,
    generation: u64,
    idle: u64,
    patience: u64,
    /// Evaluations that past steps took beyond what was granted for them.
    debt: u64,
    /// Bumps tried in this generation.
    tried: u64,
}

/// One bump: a window of the string, and what became of it.
#[derive(Debug, Default)]
struct Bump {
    begin_s: f64,
    end_s: f64,
    points: Vec<Point3<f64>>,
    gain_s: f64,
    work: u64,
}

impl<'a> Flock<'a> {
    /// A flock of `size` bumps at a time; it gives up after `patience` times as many tries at every
    /// contact without a gain.
    pub(crate) fn new(
        setting: Setting<'a>,
        seed: Seed,
        best: Candidate,
        (size, patience): (usize, u64),
    ) -> Self {
        Self {
            setting,
            seed,
            best,
            bumps: Members::new(size, Bump::default),
            maker: StringMaker::new(setting.problem, setting.field),
            generation: 0,
            idle: 0,
            patience,
            debt: 0,
            tried: 0,
        }
    }

    pub(crate) fn into_best(self) -> Candidate {
        self.best
    }

    /// The best string with the gaining bumps in it, the ones that gain most first.
    fn merged(&mut self, only_first: bool) -> Vec<Point3<f64>> {
        let bumps = self.bumps.iter_mut().map(|bump| &*bump);
        let mut order: Vec<&Bump> = bumps.filter(|b| b.gain_s > 0.0).collect();
        order.sort_by(|a, b| b.gain_s.total_cmp(&a.gain_s));
        let mut taken: Vec<&Bump> = Vec::new();
        for bump in order {
            let apart = |other: &&Bump| bump.end_s <= other.begin_s || other.end_s <= bump.begin_s;
            if taken.iter().all(apart) && (taken.is_empty() || !only_first) {
                taken.push(bump);
            }
        }
        taken.sort_by(|a, b| a.begin_s.total_cmp(&b.begin_s));
        let all = &self.best.strand.points;
        let mut points = Vec::new();
        let mut from_s = f64::NEG_INFINITY;
        for bump in taken {
            let between = |time_s: f64| time_s > from_s && time_s < bump.begin_s;
            points.extend(all.iter().filter(|p| between(p.time_s)).map(|p| p.position));
            points.extend(&bump.points);
            from_s = bump.end_s;
        }
        points.extend(all.iter().filter(|p| p.time_s > from_s).map(|p| p.position));
        points
    }
}

impl Bump {
    /// Draws a window and the point it is bent through, and pulls it taut.
    fn try_out(
        &mut self,
        best: &Candidate,
        maker: &mut StringMaker<'_>,
        setting: &Setting<'_>,
        random: &mut ChaCha8Rng,
    ) {
        (self.gain_s, self.work) = (0.0, 0);
        if setting.deadline.passed() {
            return;
        }
        let speed_mps = setting.problem.vehicle.speed_mps;
        let strand = &best.strand;
        let through = self.draw(strand, setting.field, speed_mps, random);
        let (a, b) = (strand.at(self.begin_s), strand.at(self.end_s));
        if (b - a).norm() < 1.0 {
            return;
        }
        let mut seed = vec![a, b];
        if let Some(point) = through {
            seed.insert(1, point);
        }
        let old_s = self.end_s - self.begin_s;
        let pull = Pull {
            rounds: ROUNDS,
            trust_m: f64::INFINITY,
            tolerance: 5e-6,
            limit_s: if best.is_clear() {
                old_s * 1.002
            } else {
                f64::INFINITY
            },
            work: setting.rate.units(MOST),
            deadline: setting.deadline,
        };
        let pulled = maker.pull(&seed, self.begin_s, &pull);
        self.work = pulled.work;
        let points = maker.points();
        let gain_s = old_s - (points[points.len() - 1].time_s - self.begin_s);
        // Where the best is not clear, any clear window may mend it.
        let gain_s = if best.is_clear() {
            gain_s
        } else {
            gain_s + old_s
        };
        if pulled.clear && gain_s > LEAST_GAIN * best.trajectory.duration_s() {
            self.gain_s = gain_s;
            self.points.clear();
            self.points.extend(points.iter().map(|p| p.position));
        }
    }

    /// A stretch to straighten, or a contact to pass on another side.
    fn draw(
        &mut self,
        strand: &Strand,
        field: &Field,
        speed_mps: f64,
        random: &mut ChaCha8Rng,
    ) -> Option<Point3<f64>> {
        let begin_s = strand.points[0].time_s;
        let end_s = strand.points[strand.points.len() - 1].time_s;
        let mut window = |middle_s: f64, half_s: f64| {
            self.begin_s = (middle_s - half_s).max(begin_s);
            self.end_s = (middle_s + half_s).min(end_s);
        };
        let pick = random.random_range(0..=strand.contacts.len());
        let Some(&(region, time_s)) = strand.contacts.get(pick) else {
            let share = random.random_range(0.0..1.0);
            let span_s = end_s - begin_s;
            window(
                begin_s + span_s * share,
                span_s * random.random_range(0.03..0.25),
            );
            return None;
        };
        let (centre, radius_m) = field.at(region, time_s);
        // One bump in four is wide enough for a cluster.
        let wide = if random.random_range(0..4) == 0 {
            3.0
        } else {
            1.0
        };
        let half_m = wide * (radius_m * random.random_range(1.5..5.0) + 50.0);
        window(time_s, half_m / speed_mps);
        let ahead = strand.at(self.end_s) - strand.at(self.begin_s);
        if ahead.norm() < 1.0 {
            return None;
        }
        let side = sideways(&ahead);
        let other = ahead.normalize().cross(&side);
        let angle = random.random_range(0.0..std::f64::consts::TAU);
        let out = side * libm::cos(angle) + other * libm::sin(angle);
        let far = if wide > 1.0 { 3.0 } else { 1.6 };
        Some(centre + out * (radius_m * random.random_range(1.0..far) + 1.0))
    }
}

impl<'a> Search for Flock<'a> {
    type Scratch = StringMaker<'a>;

    fn scratch(&self) -> StringMaker<'a> {
        StringMaker::new(self.setting.problem, self.setting.field)
    }

    fn propose(&mut self) -> u64 {
        self.debt + self.bumps.len() as u64 * EVALUATIONS
    }

    fn begin(&mut self, granted: u64) -> usize {
        let size = self.bumps.len();
        let granted = granted.saturating_sub(std::mem::take(&mut self.debt));
        let count = usize::try_from(granted / EVALUATIONS)
            .unwrap_or(size)
            .min(size);
        for bump in self.bumps.iter_mut().skip(count) {
            (bump.gain_s, bump.work) = (0.0, 0);
        }
        self.tried = count as u64;
        count
    }

    fn work(&self, task: usize, maker: &mut StringMaker<'a>) {
        let number = self.generation * self.bumps.len() as u64 + task as u64;
        let random = &mut self.seed.stream(number);
        let mut bump = self.bumps.lock(task);
        bump.try_out(&self.best, maker, &self.setting, random);
    }

    fn select(&mut self, _granted: u64) -> Option<StopReason> {
        let work = self.bumps.iter_mut().map(|bump| bump.work).sum();
        let taken = self.setting.rate.evaluations(work);
        self.debt = taken.saturating_sub(self.tried * EVALUATIONS);
        self.generation += 1;
        self.idle += 1;
        if self.bumps.iter_mut().any(|bump| bump.gain_s > 0.0) {
            for only_first in [false, true] {
                let points = self.merged(only_first);
                let Setting {
                    problem,
                    launch,
                    rate,
                    deadline,
                    ..
                } = self.setting;
                let pull = Pull {
                    rounds: 20,
                    trust_m: 20.0,
                    tolerance: 1e-6,
                    limit_s: f64::INFINITY,
                    work: rate.units(MOST_MERGED),
                    deadline,
                };
                let maker = &mut self.maker;
                let work = maker.pull(&points, launch.departure_s, &pull).work;
                let candidate = Candidate::new(problem, launch, Strand::of(maker));
                let checked = candidate.as_ref().map_or(0, |c| c.work(problem));
                self.debt += rate.evaluations(work + checked);
                if let Some(better) = candidate.filter(|c| c.is_better(&self.best)) {
                    self.best = better;
                    self.idle = 0;
                    break;
                }
            }
        }
        let contacts = self.best.strand.contacts.len() as u64;
        let tries = self.idle * self.bumps.len() as u64;
        (tries > self.patience * 8 * (1 + contacts)).then_some(StopReason::Stalled)
    }

    fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
        Progress {
            best: self.best.score(),
            costs: &[],
            violations: &[],
        }
    }
}
