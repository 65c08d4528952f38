//! The loop over epochs and generations.

use super::annealing::Annealing;
use super::descent::Descent;
use super::initial_routes::{Construction, constructions};
use super::objective::TourObjective;
use super::pair_crossover::{CrossoverScratch, Offspring, PairCrossover};
use super::perfect::perfect;
use super::search_space::SearchSpace;
use super::tour::Tour;
use crate::memetic_settings::MemeticSettings;
use auv_graph::{QuickestTo, Route};
use auv_planning::{Deadline, RouteProblem, Run, Score, StopReason};
use auv_population::{Members, Progress, Search};
use auv_types::{Seed, rand::RngExt};

/// The state of the memetic algorithm.
pub(crate) struct MemeticSearch<'s, 'r> {
    settings: &'s MemeticSettings,
    objective: TourObjective,
    seed: Seed,
    deadline: Deadline<'r>,
    space: SearchSpace,
    best: Tour,
    /// The best route of each epoch; they join the initial population of the next.
    elite: Vec<Tour>,
    population: Vec<Tour>,
    /// The random order of this generation, as indices of the population.
    order: Vec<usize>,
    offspring: Members<Offspring>,
    stage: EpochStage,
    /// How initial routes are constructed, in turn.
    constructions: [Construction; 2],
    generation: u64,
    epoch: u64,
    /// The epoch that found the best route.
    best_epoch: u64,
    /// Evaluations granted that no member used; the next generation gets them.
    unspent: u64,
    /// Generations without a replacement.
    idle: u64,
    /// Factor of the price of a second; it falls while routes come out too short.
    price_scale: f64,
    /// Improves the best route.
    descent: Descent,
    costs: Vec<f64>,
    violations: Vec<f64>,
}

/// What the next generation does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum EpochStage {
    Initialise,
    Cross,
}

impl<'s, 'r> MemeticSearch<'s, 'r> {
    /// Factors of the price in successive epochs, in turn: no single price suits all problems.
    const PRICE_FACTORS: [f64; 3] = [1.0, 0.85, 1.15];
    /// Factor of the first price, which comes from the greedy route: it earns less than most.
    const FIRST_PRICE_FACTOR: f64 = 0.85;
    /// Factor of the price scale after an epoch whose routes came out too short.
    const SHORT_ROUTES_FACTOR: f64 = 0.85;
    /// Insertions that the final polish may evaluate after the deadline: less than a millisecond.
    const POLISH_LATE: usize = 60_000;

    /// Prepares the search from routes in time. `None` if the run has to stop before that is done.
    pub(crate) fn new(
        settings: &'s MemeticSettings,
        objective: TourObjective,
        problem: &RouteProblem<'_>,
        home: &QuickestTo,
        run: &mut Run<'r>,
        known: &[Route],
    ) -> Option<Self> {
        let deadline = run.deadline();
        let space = SearchSpace::new(problem, home, deadline);
        if run.should_stop() {
            return None;
        }
        let mut space = space?;
        let (elite, best) = known_tours(&space, &objective, known);
        space.price = Self::FIRST_PRICE_FACTOR * best.profit_per_second();
        space.rank_neighbours(settings.neighbours, deadline);
        let constructions = constructions(&space, best.nodes.len() - 1);
        let mut search = Self {
            settings,
            objective,
            seed: run.seed(),
            deadline,
            space,
            best,
            elite,
            population: Vec::new(),
            order: Vec::new(),
            offspring: Members::default(),
            stage: EpochStage::Initialise,
            constructions,
            generation: 0,
            epoch: 0,
            best_epoch: 0,
            unspent: 0,
            idle: 0,
            price_scale: 1.0,
            descent: Descent::default(),
            costs: Vec::new(),
            violations: Vec::new(),
        };
        search.offspring = Members::new(search.size(), Offspring::default);
        Some(search)
    }

    /// Whether the space is large: then one tour is annealed in place of a population.
    pub(crate) fn is_large(&self) -> bool {
        self.space.has_lists()
    }

    /// Anneals the best tour of a large space until the run ends.
    pub(crate) fn anneal(mut self, run: &mut Run<'r>) -> (Route, StopReason) {
        let annealing = Annealing::new(&mut self.space, self.objective, run, self.best);
        let (best, stop) = annealing.run(run);
        let nodes = best.nodes.iter().map(|&node| self.space.id(node));
        (Route::new(nodes.collect()), stop)
    }

    /// The best route found, polished also after the deadline; unchanged if no generation ended.
    pub(crate) fn finish(&mut self) -> Route {
        if self.generation > 0 {
            // In a large space the polish would take longer than the search.
            let polish_late = (!self.space.has_lists()).then_some(Self::POLISH_LATE);
            self.perfect_best(polish_late);
        }
        let id = |&node: &u32| self.space.id(node);
        Route::new(self.best.nodes.iter().map(id).collect())
    }

    /// Number of routes in this epoch's population: twice that of the epoch before, limited by the
    /// settings and in a small space by the number of nodes.
    fn size(&self) -> usize {
        let first = self.settings.first_population;
        let doubled = first << self.epoch.min(20);
        let most = first.max(2 * self.space.len());
        doubled.min(self.settings.population).min(most)
    }

    /// Evaluations for each member in this generation.
    fn quota(&self) -> u64 {
        match self.stage {
            EpochStage::Initialise => self.settings.descent.min(8 + 2 * self.space.len() as u64),
            EpochStage::Cross => self.settings.offspring,
        }
    }

    /// Makes member `i` of the initial population: an elite route or a constructed one, improved.
    fn initialise(&self, i: usize, offspring: &mut Offspring, scratch: &mut CrossoverScratch) {
        let (space, deadline) = (&self.space, self.deadline);
        if offspring.quota == 0 || deadline.passed() {
            return;
        }
        let random = &mut self.seed.split(self.generation).stream(i as u64);
        let mut tour = match self.elite.get(i) {
            Some(tour) => tour.clone(),
            None => self.constructions[i % 2](space, self.settings.noise, random, deadline),
        };
        offspring.quota -= 1;
        let (descent, left) = (&mut scratch.descent, offspring.quota);
        offspring.quota -= descent.improve(space, &mut tour, space.price, None, left, deadline);
        offspring.update_best(&self.objective, &tour);
        offspring.replacement = Some(tour);
    }

    /// Draws the order in which each member is crossed with the next.
    fn shuffle(&mut self) {
        let seed = self.seed.split(self.generation);
        let random = &mut seed.stream(self.population.len() as u64);
        self.order.clear();
        self.order.extend(0..self.population.len());
        for i in (1..self.order.len()).rev() {
            self.order
                .swap(i, random.random_range(0..=i as u64) as usize);
        }
    }

    /// Crosses the member at index `i` of the order with the next.
    fn cross(&self, i: usize, offspring: &mut Offspring, scratch: &mut CrossoverScratch) {
        let crossover = PairCrossover {
            space: &self.space,
            objective: &self.objective,
            windows: self.settings.windows,
            deadline: self.deadline,
        };
        let next = (i + 1) % self.order.len();
        let parents = [i, next].map(|i| &self.population[self.order[i]]);
        let random = &mut self.seed.split(self.generation).stream(i as u64);
        crossover.cross(parents, offspring, scratch, random);
    }

    /// Takes the best of all children if it is better than the best route, and perfects it.
    fn update_best(&mut self) {
        let mut improved = false;
        for offspring in self.offspring.iter_mut() {
            if let Some(child) = &offspring.best
                && self.objective.prefers(child, &self.best)
            {
                self.best.clone_from(child);
                improved = true;
            }
        }
        if improved {
            self.best_epoch = self.epoch;
            // In a large space the polish is run once, at the end.
            self.perfect_best(self.space.is_small().then_some(0));
        }
    }

    fn perfect_best(&mut self, polish_late: Option<usize>) {
        perfect(
            &self.space,
            &self.objective,
            &mut self.best,
            &mut self.descent,
            self.deadline,
            polish_late,
        );
    }

    /// Sets the price of a second for an epoch from its initial population. If its routes leave more
    /// than a leg's time on average, the price is too high.
    fn set_price(&mut self) {
        let left_s: f64 = self
            .population
            .iter()
            .map(|tour| tour.time_left_s(&self.space))
            .sum();
        let leg_s = self.best.time_s / (self.best.nodes.len() - 1) as f64;
        if left_s > leg_s * self.population.len() as f64 {
            self.price_scale *= Self::SHORT_ROUTES_FACTOR;
        }
        let factor = Self::PRICE_FACTORS[self.epoch as usize % Self::PRICE_FACTORS.len()];
        self.space.price =
            factor * self.price_scale * self.settings.price * self.best.profit_per_second();
    }

    /// Takes the initial population; returns whether it has any member.
    fn take_initial_population(&mut self) -> bool {
        self.population.clear();
        for offspring in self.offspring.iter_mut() {
            if let Some(tour) = offspring.replacement.take()
                && !self.population.contains(&tour)
            {
                self.population.push(tour);
            }
        }
        if self.population.is_empty() {
            return false;
        }
        self.offspring.truncate(self.population.len());
        self.set_price();
        (self.stage, self.idle) = (EpochStage::Cross, 0);
        true
    }

    /// Replaces members by their offspring; starts the next epoch after too many idle generations.
    fn take_offspring(&mut self) {
        self.idle += 1;
        for (offspring, &member) in self.offspring.iter_mut().zip(&self.order) {
            if let Some(child) = offspring.replacement.take() {
                self.population[member] = child;
                self.idle = 0;
            }
        }
        // A small population needs more generations for the same number of trials.
        let fewest = self.settings.first_population.max(self.population.len()) as u64;
        let tried = self.idle * self.population.len() as u64;
        if tried >= self.settings.idle_generations * fewest {
            self.next_epoch();
        }
    }

    fn next_epoch(&mut self) {
        self.epoch += 1;
        self.stage = EpochStage::Initialise;
        if self.elite.last() != Some(&self.best) {
            self.elite.push(self.best.clone());
        }
        // The oldest leave first: the routes known before the search served the first epoch.
        let surplus = self.elite.len().saturating_sub(self.size() / 2);
        self.elite.drain(..surplus);
        self.offspring = Members::new(self.size(), Offspring::default);
    }
}

/// The known routes as tours, in a large space only the best, and the best. If the space lacks a node
/// of one, the quickest route takes its place.
fn known_tours(
    space: &SearchSpace,
    objective: &TourObjective,
    known: &[Route],
) -> (Vec<Tour>, Tour) {
    let numbers = known
        .iter()
        .filter_map(|route| space.numbers_of(route.nodes()));
    let tours: Vec<_> = numbers
        .chain([space.quickest()])
        .take(known.len())
        .map(|nodes| Tour::new(nodes, space))
        .collect();
    let best = tours.iter().fold(&tours[0], |best, tour| {
        if objective.prefers(tour, best) {
            tour
        } else {
            best
        }
    });
    let best = best.clone();
    let elite = if space.is_small() {
        tours
    } else {
        vec![best.clone()]
    };
    (elite, best)
}

impl Search for MemeticSearch<'_, '_> {
    type Scratch = CrossoverScratch;

    fn scratch(&self) -> CrossoverScratch {
        CrossoverScratch::default()
    }

    fn propose(&mut self) -> u64 {
        (self.quota() * self.offspring.len() as u64).saturating_sub(self.unspent)
    }

    fn begin(&mut self, granted: u64) -> usize {
        let (quota, granted) = (self.quota(), granted + self.unspent);
        for (i, offspring) in self.offspring.iter_mut().enumerate() {
            let before = i as u64 * quota;
            offspring.begin(granted.saturating_sub(before).min(quota));
        }
        let wanted = quota * self.offspring.len() as u64;
        self.unspent = granted.saturating_sub(wanted);
        if self.stage == EpochStage::Cross {
            self.shuffle();
        }
        self.offspring.len()
    }

    fn work(&self, task: usize, scratch: &mut CrossoverScratch) {
        let offspring = &mut self.offspring.lock(task);
        match self.stage {
            EpochStage::Initialise => self.initialise(task, offspring, scratch),
            EpochStage::Cross => self.cross(task, offspring, scratch),
        }
    }

    fn select(&mut self, _granted: u64) -> Option<StopReason> {
        let quotas = self.offspring.iter_mut().map(|offspring| offspring.quota);
        self.unspent += quotas.sum::<u64>();
        self.update_best();
        match self.stage {
            EpochStage::Initialise => {
                if !self.take_initial_population() {
                    return Some(StopReason::Finished);
                }
            }
            EpochStage::Cross => self.take_offspring(),
        }
        self.generation += 1;
        self.costs.clear();
        self.costs
            .extend(self.population.iter().map(|tour| self.objective.cost(tour)));
        self.violations.resize(self.costs.len(), 0.0);
        (self.epoch - self.best_epoch >= self.settings.patience).then_some(StopReason::Stalled)
    }

    fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
        Progress {
            best: Score::feasible(self.objective.cost(&self.best)),
            costs: &self.costs,
            violations: &self.violations,
        }
    }
}
