//! Simulated annealing over ruined and rebuilt tours.

use super::labelling::{Labelled, Labelling};
use super::rebuild::Rebuild;
use super::ruin::ruin;
use auv_planning::timed::{Extended, PartialRoutes, Piece, TimedNetwork, TimedTour};
use auv_planning::{Run, Score, StopReason};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Seed, libm};
use std::cmp::Ordering;

/// Evaluations of the first annealing; each one after it has twice as many, up to the longest. Where
/// edges have weights the order matters more: shorter and hotter.
const FIRST_CYCLE: u64 = 4_000;
const FIRST_ORDERED_CYCLE: u64 = 100;
const LONGEST_CYCLE: u64 = 256_000;
/// Evaluations after which a run without a deadline ends.
const MOST_EVALUATIONS: u64 = 60_000;
/// Least evaluations of partial routes after an annealing, which else get as many as that; most that are kept.
const LEAST_PROOF: u64 = 1_000;
const MOST_KEPT: usize = 500_000;
/// Evaluations between two looks at the clock.
const BATCH: u64 = 16;
/// First and last temperature, as shares of the mean weight of a piece.
const HOT: f64 = 0.3;
const HOT_ORDERED: f64 = 1.5;
const COLD: f64 = 0.01;

/// The state of the search.
pub(super) struct TimedSearch<'a> {
    tables: &'a TimedNetwork<'a>,
    pieces: &'a [Piece],
    /// The tour without tasks, from which every other annealing starts.
    start: TimedTour,
    current: TimedTour,
    trial: TimedTour,
    best: TimedTour,
    rebuild: Rebuild,
    random: ChaCha8Rng,
    /// Mean weight of the pieces that have one.
    mean_weight: f64,
    /// Added to the weight for each mandatory task.
    bonus: f64,
}

impl<'a> TimedSearch<'a> {
    pub(super) fn new(
        tables: &'a TimedNetwork<'a>,
        pieces: &'a [Piece],
        start: TimedTour,
        filled: TimedTour,
        seed: Seed,
    ) -> Self {
        let own = if tables.has_own_weights {
            tables.problem.network.weights()
        } else {
            &[]
        };
        let weights = tables
            .works
            .iter()
            .map(|work| work.weight)
            .chain(own.iter().copied());
        let (total, count) = weights
            .filter(|&weight| weight > 0.0)
            .fold((0.0, 0_u32), |(total, count), weight| {
                (total + weight, count + 1)
            });
        Self {
            tables,
            pieces,
            current: filled.clone(),
            trial: filled.clone(),
            best: filled,
            start,
            rebuild: Rebuild::new(tables, pieces),
            random: seed.stream(0),
            mean_weight: total / f64::from(count.max(1)),
            bonus: total + 1.0,
        }
    }

    pub(super) fn best(&self) -> &TimedTour {
        &self.best
    }

    /// Anneals again and again until the run ends.
    pub(super) fn run(&mut self, run: &mut Run<'_>) -> StopReason {
        let has_rules = self.tables.has_rules;
        let mut cycle = if has_rules {
            FIRST_ORDERED_CYCLE
        } else {
            FIRST_CYCLE
        };
        let mut labelling = self
            .rebuild
            .is_plain
            .then(|| Labelling::new(self.tables))
            .flatten();
        let mut partial = None;
        for turn in 0_u64.. {
            if let Some(labelling) = labelling.as_mut().filter(|_| turn > 0)
                && !self.label(run, labelling, (turn - 1) as usize, 2 * cycle)
            {
                break;
            }
            let from = if turn % 2 == 1 {
                &self.start
            } else {
                &self.best
            };
            self.current.copy_from(from);
            if !self.anneal(run, cycle) {
                break;
            }
            if turn == 0 && !self.rebuild.is_plain {
                partial = PartialRoutes::new(run, self.tables, Some(&self.best));
            }
            if let Some(partial) = &mut partial {
                match self.prove(run, partial, cycle.max(LEAST_PROOF)) {
                    Extended::All => return StopReason::Optimal,
                    Extended::Stopped => break,
                    Extended::Some => {}
                }
            }
            if !run.has_deadline() && run.stats(StopReason::Finished).evaluations > MOST_EVALUATIONS
            {
                break;
            }
            cycle = (2 * cycle).min(LONGEST_CYCLE);
        }
        StopReason::Finished
    }

    /// Extends partial routes: the best of them all is proven.
    fn prove(&mut self, run: &mut Run<'_>, partial: &mut PartialRoutes<'a>, most: u64) -> Extended {
        partial.offer(&self.best);
        let extended = partial.extend(run, most, MOST_KEPT);
        if let Some(found) = partial.best()
            && self.order(&found, &self.best) == Ordering::Less
        {
            self.best.copy_from(&found);
        }
        extended
    }

    /// One labelling; whether the run goes on.
    fn label(
        &mut self,
        run: &mut Run<'_>,
        labelling: &mut Labelling<'_>,
        near: usize,
        most: u64,
    ) -> bool {
        let (steps, goes_on) = match labelling.run(run, near, most) {
            Labelled::Ended(steps) => (steps, true),
            Labelled::Stopped(steps) => (steps, false),
        };
        let count = self.trial.steps().len();
        if self.trial.splice(self.tables, (0, count), &steps)
            && self.order(&self.trial, &self.best) == Ordering::Less
        {
            self.best.copy_from(&self.trial);
        }
        goes_on
    }

    /// One annealing; whether the run goes on.
    fn anneal(&mut self, run: &mut Run<'_>, evaluations: u64) -> bool {
        let hot = if self.tables.has_rules {
            HOT_ORDERED
        } else {
            HOT
        };
        let cooling = libm::pow(COLD / hot, BATCH as f64 / evaluations as f64);
        let mut temperature = hot * self.mean_weight;
        let mut left = evaluations;
        while left > 0 {
            let granted = run.grant(BATCH);
            if granted == 0 {
                return false;
            }
            for _ in 0..granted {
                self.try_change(temperature);
            }
            run.end_generation(self.score(), &[], &[]);
            temperature *= cooling;
            left = left.saturating_sub(BATCH);
        }
        true
    }

    fn try_change(&mut self, temperature: f64) {
        self.trial.copy_from(&self.current);
        ruin(self.tables, self.pieces, &mut self.trial, &mut self.random);
        self.rebuild
            .apply(self.tables, self.pieces, &mut self.trial, &mut self.random);
        let change = self.value(&self.trial) - self.value(&self.current);
        let uniform: f64 = self.random.random();
        if change >= 0.0 || change > temperature * libm::log(uniform.max(1e-300)) {
            std::mem::swap(&mut self.current, &mut self.trial);
            if self.order(&self.current, &self.best) == Ordering::Less {
                self.best.copy_from(&self.current);
            }
        }
    }

    /// Weight, mandatory tasks first, less a small price of time.
    fn value(&self, tour: &TimedTour) -> f64 {
        let missing = if self.tables.has_mandatory {
            tour.missing(self.tables)
        } else {
            0
        };
        let time_share = tour.end_s() / self.tables.problem.time_available_s.max(1e-9);
        tour.weight() - self.bonus * missing as f64 - 0.02 * self.mean_weight * time_share
    }

    /// The better tour first: fewer mandatory tasks missing, more weight, less time.
    fn order(&self, a: &TimedTour, b: &TimedTour) -> Ordering {
        let missing = |tour: &TimedTour| tour.missing(self.tables);
        let by_weight = || b.weight().total_cmp(&a.weight());
        missing(a)
            .cmp(&missing(b))
            .then_with(by_weight)
            .then(a.end_s().total_cmp(&b.end_s()))
    }

    fn score(&self) -> Score {
        Score::new(self.best.missing(self.tables) as f64, -self.best.weight())
    }
}
