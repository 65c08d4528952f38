//! The memetic algorithm: populations of locally optimal routes, bred by edge assembly.
//!
//! Epoch by epoch a population is founded from greedy and random routes, each improved by local
//! search, and bred until it no longer changes; the next epoch starts with twice as many routes
//! and the best of the epochs before. All routes keep the time available; among them the time left
//! has a price, so that a route may pay less now for room to insert a task later.

mod assembly;
mod breeding;
mod descent;
mod field;
mod founding;
mod goal;
mod lists;
mod neighbourhood;
mod polish;
mod tour;
mod window;

use crate::MemeticSettings;
use auv_graph::{QuickestTo, Route};
use auv_planning::{Deadline, RouteProblem, Run, StopReason};
use auv_population::{Search, Standing, Workers};
use auv_types::{Seed, rand::RngExt};
use breeding::{Breeder, Brood};
use field::Field;
use founding::{Founder, founders};
pub(crate) use goal::Goal;
use tour::Tour;

/// A population under evolution.
pub(crate) struct Memetic<'s, 'r> {
    settings: &'s MemeticSettings,
    goal: Goal,
    seed: Seed,
    deadline: Deadline<'r>,
    field: Field,
    best: Tour,
    /// The best of each epoch; they join the founders of the next.
    elite: Vec<Tour>,
    population: Vec<Tour>,
    /// Whose turn it is to be first parent.
    order: Vec<usize>,
    broods: Vec<Brood>,
    stage: Stage,
    /// How first routes are made.
    founders: [Founder; 2],
    generation: u64,
    epoch: u64,
    /// The epoch that found the best route.
    best_epoch: u64,
    /// Evaluations granted that no brood needed; they serve the next generation.
    unspent: u64,
    /// Generations without any change.
    idle: u64,
    /// Share of the usual price of time; it falls while routes come out too short.
    strain: f64,
    rooms: Vec<breeding::Room>,
    costs: Vec<f64>,
    violations: Vec<f64>,
}

/// What the next generation does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    Found,
    Breed,
}

impl<'s, 'r> Memetic<'s, 'r> {
    /// The price of time varies over the epochs: no single one suits all problems.
    const PRICES: [f64; 3] = [1.0, 0.85, 1.15];
    /// The price at first, relative to the greedy route, which earns less than most.
    const FIRST_PRICE: f64 = 0.85;
    /// Insertions looked at after the deadline: below a millisecond of work.
    const LATE: usize = 60_000;

    /// Sets the search up from routes in time; nothing where the run has to stop before that is done.
    pub(crate) fn new(
        settings: &'s MemeticSettings,
        goal: Goal,
        problem: &RouteProblem<'_>,
        home: &QuickestTo,
        run: &mut Run<'r>,
        first: &[Route],
        threads: usize,
    ) -> Option<Self> {
        let deadline = run.deadline();
        let field = Field::new(problem, home, deadline);
        if run.should_stop() {
            return None;
        }
        let mut field = field?;
        let known = first
            .iter()
            .filter_map(|route| field.tour_of(route.nodes()));
        let elite: Vec<_> = known.chain([field.quickest()]).take(first.len()).collect();
        let best = elite.iter().fold(&elite[0], |best, tour| {
            if goal.prefers(tour, best) { tour } else { best }
        });
        let best = best.clone();
        let elite = if field.is_small() {
            elite
        } else {
            vec![best.clone()]
        };
        field.price = Self::FIRST_PRICE * best.profit_per_second();
        field.rank_neighbours(settings.neighbours, deadline);
        let founders = founders(&field, best.nodes.len() - 1);
        let mut memetic = Self {
            settings,
            goal,
            seed: run.seed(),
            deadline,
            field,
            best,
            elite,
            population: Vec::new(),
            order: Vec::new(),
            broods: Vec::new(),
            stage: Stage::Found,
            founders,
            generation: 0,
            epoch: 0,
            best_epoch: 0,
            unspent: 0,
            idle: 0,
            strain: 1.0,
            rooms: vec![breeding::Room::default(); threads],
            costs: Vec::new(),
            violations: Vec::new(),
        };
        memetic.broods = vec![Brood::default(); memetic.size()];
        Some(memetic)
    }

    /// The best route found, perfected even where the deadline cut that short; the greedy route as it
    /// is where there was no time to search at all.
    pub(crate) fn finish(&mut self) -> Route {
        if self.generation > 0 {
            self.perfect(Some(Self::LATE));
        }
        let id = |&node: &u32| self.field.ids[node as usize];
        Route::new(self.best.nodes.iter().map(id).collect())
    }

    /// Routes in this epoch's population: twice as many as in the last, as far as the settings and
    /// a small field allow.
    fn size(&self) -> usize {
        let first = self.settings.first_population;
        let doubled = first << self.epoch.min(20);
        let most = first.max(2 * self.field.len());
        doubled.min(self.settings.population).min(most)
    }

    /// Evaluations for each member in this generation.
    fn quota(&self) -> u64 {
        match self.stage {
            Stage::Found => self.settings.descent.min(8 + 2 * self.field.len() as u64),
            Stage::Breed => self.settings.offspring,
        }
    }

    /// Founds a population: the elite, then first routes, all improved.
    fn found(&mut self, workers: &Workers) {
        let (field, goal, elite, deadline) = (&self.field, &self.goal, &self.elite, self.deadline);
        let founders = self.founders;
        let (seed, noise) = (self.seed.split(self.generation), self.settings.noise);
        workers.for_each(&mut self.broods, 1, &mut self.rooms, |i, brood, room| {
            if brood.quota == 0 || deadline.passed() {
                return;
            }
            let random = &mut seed.stream(i as u64);
            let mut tour = match elite.get(i) {
                Some(tour) => tour.clone(),
                None => founders[i % 2](field, noise, random, deadline),
            };
            brood.quota -= 1;
            let (descent, left) = (&mut room.descent, brood.quota);
            brood.quota -= descent.improve(field, &mut tour, field.price, None, left, deadline);
            brood.offer(goal, &tour);
            brood.heir = Some(tour);
        });
    }

    /// Crosses every member with the next in a random order.
    fn cross(&mut self, workers: &Workers) {
        let seed = self.seed.split(self.generation);
        let random = &mut seed.stream(self.population.len() as u64);
        self.order.clear();
        self.order.extend(0..self.population.len());
        for i in (1..self.order.len()).rev() {
            self.order
                .swap(i, random.random_range(0..=i as u64) as usize);
        }
        let breeder = Breeder {
            field: &self.field,
            goal: &self.goal,
            windows: self.settings.windows,
            deadline: self.deadline,
        };
        let (population, order) = (&self.population, &self.order);
        workers.for_each(&mut self.broods, 1, &mut self.rooms, |i, brood, room| {
            let parents = [order[i], order[(i + 1) % order.len()]].map(|place| &population[place]);
            breeder.breed(parents, brood, room, &mut seed.stream(i as u64));
        });
    }

    /// Takes over a better best route and perfects it.
    fn crown(&mut self) {
        let mut improved = false;
        for brood in &self.broods {
            if let Some(champion) = &brood.champion
                && self.goal.prefers(champion, &self.best)
            {
                self.best.clone_from(champion);
                improved = true;
            }
        }
        if improved {
            self.best_epoch = self.epoch;
            // In a large field the last word is said once, at the end.
            self.perfect(self.field.is_small().then_some(0));
        }
    }

    /// Perfects the best route by the objective alone; polishes it too where `late` tells how many
    /// insertions to look at after the deadline.
    fn perfect(&mut self, late: Option<usize>) {
        let descent = &mut self.rooms[0].descent;
        self.goal
            .perfect(&self.field, &mut self.best, descent, self.deadline, late);
    }

    /// Settles the price of time once the founders are known.
    fn settle_price(&mut self) {
        let left_s: f64 = self
            .population
            .iter()
            .map(|tour| tour.time_left_s(&self.field))
            .sum();
        let leg_s = self.best.time_s / (self.best.nodes.len() - 1) as f64;
        if left_s > leg_s * self.population.len() as f64 {
            self.strain *= 0.85;
        }
        let turn = Self::PRICES[self.epoch as usize % Self::PRICES.len()];
        self.field.price = turn * self.strain * self.settings.price * self.best.profit_per_second();
    }

    /// Begins the next epoch.
    fn restart(&mut self) {
        self.epoch += 1;
        self.stage = Stage::Found;
        if self.elite.last() != Some(&self.best) {
            self.elite.push(self.best.clone());
        }
        // The greedy route and whatever was known served the first epoch.
        let surplus = self.elite.len().saturating_sub(self.size() / 2);
        self.elite.drain(..surplus);
        self.broods = vec![Brood::default(); self.size()];
    }
}

impl Search for Memetic<'_, '_> {
    fn propose(&mut self) -> u64 {
        (self.quota() * self.broods.len() as u64).saturating_sub(self.unspent)
    }

    fn evaluate(&mut self, granted: u64, workers: &Workers) {
        let (quota, granted) = (self.quota(), granted + self.unspent);
        for (i, brood) in self.broods.iter_mut().enumerate() {
            let before = i as u64 * quota;
            brood.begin(granted.saturating_sub(before).min(quota));
        }
        match self.stage {
            Stage::Found => self.found(workers),
            Stage::Breed => self.cross(workers),
        }
        let left: u64 = self.broods.iter().map(|brood| brood.quota).sum();
        let wanted = quota * self.broods.len() as u64;
        self.unspent = left + granted.saturating_sub(wanted);
    }

    fn select(&mut self, _granted: u64) -> Option<StopReason> {
        self.crown();
        let heirs = self.broods.iter_mut().map(|brood| brood.heir.take());
        match self.stage {
            Stage::Found => {
                self.population.clear();
                for heir in heirs.flatten() {
                    if !self.population.contains(&heir) {
                        self.population.push(heir);
                    }
                }
                if self.population.is_empty() {
                    return Some(StopReason::Finished);
                }
                self.broods.truncate(self.population.len());
                self.settle_price();
                (self.stage, self.idle) = (Stage::Breed, 0);
            }
            Stage::Breed => {
                self.idle += 1;
                for (heir, &place) in heirs.zip(&self.order) {
                    if let Some(heir) = heir {
                        self.population[place] = heir;
                        self.idle = 0;
                    }
                }
                // Few members need more generations to have tried as much.
                let fewest = self.settings.first_population.max(self.population.len()) as u64;
                let tried = self.idle * self.population.len() as u64;
                if tried >= self.settings.idle_generations * fewest {
                    self.restart();
                }
            }
        }
        self.generation += 1;
        self.costs.clear();
        self.costs
            .extend(self.population.iter().map(|tour| self.goal.cost(tour)));
        self.violations.resize(self.costs.len(), 0.0);
        (self.epoch - self.best_epoch >= self.settings.patience).then_some(StopReason::Stalled)
    }

    fn standing(&self) -> Standing<'_> {
        Standing {
            best_cost: self.goal.cost(&self.best),
            best_violation: 0.0,
            costs: &self.costs,
            violations: &self.violations,
        }
    }
}
