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
use auv_planning::{Deadline, RouteProblem, Run, Score, StopReason};
use auv_population::{Members, Progress, Search};
use auv_types::{Seed, rand::RngExt};
use breeding::{Breeder, Brood};
use descent::Descent;
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
    broods: Members<Brood>,
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
    /// Perfects the best route.
    descent: Descent,
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
            broods: Members::default(),
            stage: Stage::Found,
            founders,
            generation: 0,
            epoch: 0,
            best_epoch: 0,
            unspent: 0,
            idle: 0,
            strain: 1.0,
            descent: Descent::default(),
            costs: Vec::new(),
            violations: Vec::new(),
        };
        memetic.broods = Members::new(memetic.size(), Brood::default);
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

    /// Founds a member of the population, an elite route or a first one, improved.
    fn found(&self, i: usize, brood: &mut Brood, room: &mut breeding::Room) {
        let (field, deadline) = (&self.field, self.deadline);
        if brood.quota == 0 || deadline.passed() {
            return;
        }
        let random = &mut self.seed.split(self.generation).stream(i as u64);
        let mut tour = match self.elite.get(i) {
            Some(tour) => tour.clone(),
            None => self.founders[i % 2](field, self.settings.noise, random, deadline),
        };
        brood.quota -= 1;
        let (descent, left) = (&mut room.descent, brood.quota);
        brood.quota -= descent.improve(field, &mut tour, field.price, None, left, deadline);
        brood.offer(&self.goal, &tour);
        brood.heir = Some(tour);
    }

    /// A random order: every member is crossed with the next.
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

    /// Crosses a member with the next in the order.
    fn cross(&self, i: usize, brood: &mut Brood, room: &mut breeding::Room) {
        let breeder = Breeder {
            field: &self.field,
            goal: &self.goal,
            windows: self.settings.windows,
            deadline: self.deadline,
        };
        let next = (i + 1) % self.order.len();
        let parents = [i, next].map(|i| &self.population[self.order[i]]);
        let random = &mut self.seed.split(self.generation).stream(i as u64);
        breeder.breed(parents, brood, room, random);
    }

    /// Takes over a better best route and perfects it.
    fn crown(&mut self) {
        let mut improved = false;
        for brood in self.broods.iter_mut() {
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
        let (field, descent) = (&self.field, &mut self.descent);
        self.goal
            .perfect(field, &mut self.best, descent, self.deadline, late);
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
        self.broods = Members::new(self.size(), Brood::default);
    }
}

impl Search for Memetic<'_, '_> {
    type Scratch = breeding::Room;

    fn scratch(&self) -> breeding::Room {
        breeding::Room::default()
    }

    fn propose(&mut self) -> u64 {
        (self.quota() * self.broods.len() as u64).saturating_sub(self.unspent)
    }

    fn begin(&mut self, granted: u64) -> usize {
        let (quota, granted) = (self.quota(), granted + self.unspent);
        for (i, brood) in self.broods.iter_mut().enumerate() {
            let before = i as u64 * quota;
            brood.begin(granted.saturating_sub(before).min(quota));
        }
        let wanted = quota * self.broods.len() as u64;
        self.unspent = granted.saturating_sub(wanted);
        if self.stage == Stage::Breed {
            self.shuffle();
        }
        self.broods.len()
    }

    fn work(&self, task: usize, room: &mut breeding::Room) {
        let brood = &mut self.broods.lock(task);
        match self.stage {
            Stage::Found => self.found(task, brood, room),
            Stage::Breed => self.cross(task, brood, room),
        }
    }

    fn select(&mut self, _granted: u64) -> Option<StopReason> {
        self.unspent += self.broods.iter_mut().map(|brood| brood.quota).sum::<u64>();
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

    fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
        Progress {
            best: Score::feasible(self.goal.cost(&self.best)),
            costs: &self.costs,
            violations: &self.violations,
        }
    }
}
