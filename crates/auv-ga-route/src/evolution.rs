//! The paper's genetic algorithm (Section 4, Fig. 5): routes of variable length, roulette
//! selection, uniform crossover, three mutations, the best of parents and offspring survive.

use crate::{EvolutionSettings, InvalidOffspring, crossover, mutation::Mutation, repair::repair};
use auv_graph::NodeId;
use auv_planning::{Deadline, StopReason};
use auv_population::{Members, Progress, Search};
use auv_route_encoding::{
    Decoder, DecoderScratch, Decoding, KnownRoute, RouletteWheel, ScoredRoute, UsableArcs,
};
use auv_types::{ChaCha8Rng, Seed, rand::RngExt};

/// The state of the paper's algorithm.
pub(crate) struct Evolution<'a> {
    settings: &'a EvolutionSettings,
    arcs: &'a UsableArcs<'a>,
    decoder: Decoder<'a>,
    seed: Seed,
    deadline: Deadline<'a>,
    best: ScoredRoute,
    population: Vec<ScoredRoute>,
    /// Initial routes drawn for members that have none in time, each with the member's index.
    drafts: Members<(usize, ScoredRoute)>,
    /// Two children of each pair.
    children: Members<[ScoredRoute; 2]>,
    mutants: Members<ScoredRoute>,
    wheel: RouletteWheel,
    /// Evaluations granted in this generation.
    granted: usize,
    generation: u64,
    /// How often the initial routes have been drawn.
    tries: u64,
    patience: Patience,
    costs: Vec<f64>,
    violations: Vec<f64>,
}

/// For how many generations nothing has changed.
#[derive(Default)]
struct Patience {
    /// The cost that the last improvement reached.
    best_cost: f64,
    /// Generations without an improvement.
    stalled: u64,
    /// Generations of equal costs.
    uniform: u64,
}

/// The memory of one thread.
#[derive(Default)]
pub(crate) struct EvolutionScratch {
    priorities: Vec<f64>,
    decoder: DecoderScratch,
    visited: Vec<bool>,
}

impl<'a> Evolution<'a> {
    /// An empty population; an incumbent becomes its first member.
    pub(crate) fn new(
        settings: &'a EvolutionSettings,
        arcs: &'a UsableArcs<'a>,
        known: &'a KnownRoute,
        (seed, deadline): (Seed, Deadline<'a>),
    ) -> Self {
        let mut population = vec![ScoredRoute::none(); settings.population];
        if arcs.problem().incumbent.is_some() {
            population[0] = known.best.clone();
        }
        Self {
            best: known.best.clone(),
            settings,
            arcs,
            decoder: Decoder::new(arcs, &known.home),
            seed,
            deadline,
            population,
            drafts: Members::default(),
            children: Members::new(settings.parent_pairs, Default::default),
            mutants: Members::new(settings.mutants, ScoredRoute::none),
            granted: 0,
            wheel: RouletteWheel::default(),
            generation: 0,
            tries: 0,
            patience: Patience {
                best_cost: f64::INFINITY,
                ..Patience::default()
            },
            costs: Vec::new(),
            violations: Vec::new(),
        }
    }

    /// The best route so far.
    pub(crate) fn best(&self) -> &ScoredRoute {
        &self.best
    }

    /// Whether initial routes are still drawn: for members that have none in time.
    fn is_initialising(&self) -> bool {
        match self.settings.initialisation {
            Decoding::BudgetAware => self.tries == 0,
            Decoding::Plain => {
                self.tries < self.settings.initial_tries
                    && self
                        .population
                        .iter()
                        .any(|member| member.score.violation > 0.0)
            }
        }
    }

    /// Draws a route for the member at index `place`.
    fn draw(&self, place: usize, drawn: &mut ScoredRoute, scratch: &mut EvolutionScratch) {
        let (decoder, priorities) = (&self.decoder, &mut scratch.priorities);
        decoder.draw(self.seed, self.tries, place as u64, priorities);
        let decoding = self.settings.initialisation;
        decoder.decode(priorities, decoding, &mut scratch.decoder, drawn);
    }

    /// Makes the two children of a pair (only one if one is granted), or a mutant.
    fn make_offspring(&self, task: usize, scratch: &mut EvolutionScratch) {
        let parents = Parents {
            settings: self.settings,
            arcs: self.arcs,
            population: &self.population,
            wheel: &self.wheel,
        };
        let random = &mut self.seed.split(self.generation).stream(task as u64);
        match task.checked_sub(self.children.len()) {
            Some(mutant) => parents.mutate(random, &mut self.mutants.lock(mutant), scratch),
            None => {
                let mut pair = self.children.lock(task);
                parents.cross(random, &mut pair, scratch);
                if 2 * task + 1 == self.granted {
                    pair[1] = ScoredRoute::none();
                }
            }
        }
    }

    /// Replaces each member by the route drawn for it if that is less late.
    fn take_drafts(&mut self) {
        for (place, drawn) in std::mem::take(&mut self.drafts).iter_mut() {
            if drawn.score.violation < self.population[*place].score.violation {
                std::mem::swap(drawn, &mut self.population[*place]);
            }
        }
        self.tries += 1;
    }

    /// Keeps the best of parents and offspring, and of equal routes one.
    fn replace(&mut self) {
        let size = self.settings.population;
        let offspring = self
            .children
            .iter_mut()
            .flatten()
            .chain(self.mutants.iter_mut())
            .filter(|offspring| !offspring.nodes.is_empty())
            .map(|offspring| std::mem::replace(offspring, ScoredRoute::none()));
        self.population.extend(offspring);
        let ranking = self.settings.ranking;
        self.population
            .sort_by(|a, b| ranking.order(a, b).then_with(|| a.nodes.cmp(&b.nodes)));
        self.population.dedup_by(|a, b| a.nodes == b.nodes);
        self.population.truncate(size);
    }

    /// The three criteria that end the search: the iteration cap, a population of equal costs, a best
    /// cost that stalls.
    fn reason_to_stop(&mut self) -> Option<StopReason> {
        let settings = self.settings;
        let best = self.best.score.cost;
        let patience = &mut self.patience;
        patience.stalled += 1;
        if best < patience.best_cost - settings.stall_tolerance {
            (patience.best_cost, patience.stalled) = (best, 0);
        }
        let least = self.costs.iter().copied().fold(f64::INFINITY, f64::min);
        let most = self.costs.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let mean = self.costs.iter().sum::<f64>() / self.costs.len() as f64;
        let differ = most - least > settings.uniform_tolerance * mean.abs();
        patience.uniform = if differ { 0 } else { patience.uniform + 1 };
        if self.generation >= settings.iterations {
            Some(StopReason::Finished)
        } else if settings
            .uniform_patience
            .is_some_and(|most| patience.uniform >= most)
            || settings
                .stall_patience
                .is_some_and(|most| patience.stalled >= most)
        {
            Some(StopReason::Stalled)
        } else {
            None
        }
    }
}

impl Search for Evolution<'_> {
    type Scratch = EvolutionScratch;

    fn scratch(&self) -> EvolutionScratch {
        EvolutionScratch::default()
    }

    fn propose(&mut self) -> u64 {
        if self.is_initialising() {
            let late = |member: &&ScoredRoute| member.score.violation > 0.0;
            return self.population.iter().filter(late).count() as u64;
        }
        self.generation += 1;
        let ranking = self.settings.ranking;
        let costs = self
            .population
            .iter()
            .map(|member| ranking.penalised(member));
        self.wheel = RouletteWheel::new(costs, self.settings.selection_pressure);
        (2 * self.children.len() + self.mutants.len()) as u64
    }

    fn begin(&mut self, granted: u64) -> usize {
        self.granted = granted as usize;
        if self.generation == 0 {
            let members = self.population.iter().enumerate();
            self.drafts = members
                .filter(|(_, member)| member.score.violation > 0.0)
                .map(|(place, _)| (place, ScoredRoute::none()))
                .take(self.granted)
                .collect();
            return self.drafts.len();
        }
        let pairs = self.children.len();
        pairs.min(self.granted.div_ceil(2)) + self.granted.saturating_sub(2 * pairs)
    }

    fn work(&self, task: usize, scratch: &mut EvolutionScratch) {
        if self.deadline.passed() {
            return;
        }
        if self.generation == 0 {
            let (place, drawn) = &mut *self.drafts.lock(task);
            self.draw(*place, drawn, scratch);
        } else {
            self.make_offspring(task, scratch);
        }
    }

    fn select(&mut self, _granted: u64) -> Option<StopReason> {
        if self.generation == 0 {
            self.take_drafts();
            if self.is_initialising() {
                return None;
            }
        }
        self.replace();
        if let Some(best) = self.population.iter().min_by_key(|member| member.score)
            && best.score < self.best.score
        {
            self.best.clone_from(best);
        }
        self.costs.clear();
        self.costs
            .extend(self.population.iter().map(|member| member.score.cost));
        self.violations.clear();
        self.violations
            .extend(self.population.iter().map(|member| member.score.violation));
        // A generation that the deadline cut short says nothing about the search.
        (!self.deadline.passed())
            .then(|| self.reason_to_stop())
            .flatten()
    }

    fn progress(&mut self, _is_observed: bool) -> Progress<'_> {
        Progress {
            best: self.best.score,
            costs: &self.costs,
            violations: &self.violations,
        }
    }
}

/// What offspring are made from.
struct Parents<'a> {
    settings: &'a EvolutionSettings,
    arcs: &'a UsableArcs<'a>,
    population: &'a [ScoredRoute],
    wheel: &'a RouletteWheel,
}

impl Parents<'_> {
    fn spin(&self, random: &mut ChaCha8Rng) -> &[NodeId] {
        &self.population[self.wheel.spin(random)].nodes
    }

    /// Crosses pairs until a child is a route or the retries are used up. A child that is not a route
    /// is discarded.
    fn cross(
        &self,
        random: &mut ChaCha8Rng,
        pair: &mut [ScoredRoute; 2],
        scratch: &mut EvolutionScratch,
    ) {
        for _ in 0..=self.settings.retries {
            let parents = [self.spin(random), self.spin(random)];
            let [first, second] = pair;
            if parents.iter().any(|parent| parent.len() < 4) {
                first.nodes.clear();
                second.nodes.clear();
                continue;
            }
            crossover::uniform(parents, [&mut first.nodes, &mut second.nodes], |_| {
                random.random_range(0..2_u32) == 0
            });
            self.score(first, scratch);
            self.score(second, scratch);
            if !first.nodes.is_empty() || !second.nodes.is_empty() {
                break;
            }
        }
    }

    fn mutate(
        &self,
        random: &mut ChaCha8Rng,
        mutant: &mut ScoredRoute,
        scratch: &mut EvolutionScratch,
    ) {
        for _ in 0..=self.settings.retries {
            mutant.nodes.clear();
            mutant.nodes.extend_from_slice(self.spin(random));
            Mutation::apply_random(&mut mutant.nodes, random);
            self.score(mutant, scratch);
            if !mutant.nodes.is_empty() {
                break;
            }
        }
    }

    /// Scores an offspring. One that repeats a node or uses a missing edge is repaired or discarded.
    fn score(&self, offspring: &mut ScoredRoute, scratch: &mut EvolutionScratch) {
        let visited = &mut scratch.visited;
        visited.clear();
        visited.resize(self.arcs.problem().network.num_nodes(), false);
        if self.settings.invalid_offspring == InvalidOffspring::Repair {
            repair(&mut offspring.nodes, self.arcs, visited);
        } else if offspring
            .nodes
            .iter()
            .any(|node| std::mem::replace(&mut visited[node.index()], true))
        {
            offspring.nodes.clear();
        }
        offspring.evaluate(self.arcs);
        if offspring.score.violation.is_infinite() {
            offspring.nodes.clear();
        }
    }
}
