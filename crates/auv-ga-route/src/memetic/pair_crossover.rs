//! The offspring of one pair of parents: assembled, brought into time, improved.

use super::assembly::Assembly;
use super::descent::Descent;
use super::ejection::Ejection;
use super::objective::TourObjective;
use super::search_space::SearchSpace;
use super::tour::Tour;
use super::window::WindowSearch;
use auv_planning::Deadline;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// What one pair yields within its evaluations.
#[derive(Debug, Default)]
pub(crate) struct Offspring {
    /// Evaluations left.
    pub(crate) quota: u64,
    /// The child that replaces the first parent.
    pub(crate) replacement: Option<Tour>,
    /// The best child under the objective.
    pub(crate) best: Option<Tour>,
}

impl Offspring {
    /// Forgets the children of the last generation.
    pub(crate) fn begin(&mut self, quota: u64) {
        *self = Self {
            quota,
            ..Self::default()
        };
    }

    /// Keeps a child if it is the best under the objective.
    pub(crate) fn update_best(&mut self, objective: &TourObjective, child: &Tour) {
        match &mut self.best {
            Some(best) if objective.prefers(child, best) => best.clone_from(child),
            Some(_) => {}
            None => self.best = Some(child.clone()),
        }
    }
}

/// The memory that crossover needs; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct CrossoverScratch {
    pub(crate) descent: Descent,
    assembly: Assembly,
    ejection: Ejection,
    window: WindowSearch,
    child: Tour,
    touched: Vec<u32>,
    cycles: Vec<usize>,
}

/// Most legs of a window.
const LONGEST_WINDOW: u32 = 10;

/// What all pairs of a generation have in common.
#[derive(Clone, Copy)]
pub(crate) struct PairCrossover<'a> {
    pub(crate) space: &'a SearchSpace,
    pub(crate) objective: &'a TourObjective,
    /// Windows searched in a parent that crossover does not improve.
    pub(crate) windows: u32,
    pub(crate) deadline: Deadline<'a>,
}

impl PairCrossover<'_> {
    /// Makes children of a pair, one from each cycle of their difference, in random order. The child
    /// of greatest worth above the first parent's replaces it. If there is none, windows of the first
    /// parent are searched.
    pub(crate) fn cross(
        &self,
        parents: [&Tour; 2],
        offspring: &mut Offspring,
        scratch: &mut CrossoverScratch,
        random: &mut ChaCha8Rng,
    ) {
        if offspring.quota == 0 || self.deadline.passed() {
            return;
        }
        let mut worth = parents[0].worth(self.space) + 1e-9;
        self.assemble_children(parents, &mut worth, offspring, scratch, random);
        if offspring.replacement.is_some() {
            return;
        }
        for _ in 0..self.windows {
            if offspring.quota == 0 || self.deadline.passed() {
                return;
            }
            scratch
                .child
                .clone_from(offspring.replacement.as_ref().unwrap_or(parents[0]));
            self.search_window(&mut worth, offspring, scratch, random);
        }
    }

    /// Assembles a child from each cycle as long as evaluations are left. `worth` is what a child
    /// must exceed to replace the first parent.
    fn assemble_children(
        &self,
        parents: [&Tour; 2],
        worth: &mut f64,
        offspring: &mut Offspring,
        scratch: &mut CrossoverScratch,
        random: &mut ChaCha8Rng,
    ) {
        let space = self.space;
        let number = scratch.assembly.find_cycles(space, parents, random);
        let mut cycles = std::mem::take(&mut scratch.cycles);
        cycles.clear();
        cycles.extend(0..number);
        for i in (1..cycles.len()).rev() {
            cycles.swap(i, random.random_range(0..=i as u64) as usize);
        }
        for &cycle in &cycles {
            if offspring.quota == 0 || self.deadline.passed() {
                break;
            }
            offspring.quota -= 1;
            let (child, touched) = (&mut scratch.child, &mut scratch.touched);
            scratch.assembly.assemble(space, cycle, child, touched);
            scratch.ejection.eject(space, child, touched);
            if !child.nodes.is_empty() {
                self.improve_child(worth, offspring, scratch);
            }
        }
        scratch.cycles = cycles;
    }

    /// Searches a random window of the child; a changed child is improved.
    fn search_window(
        &self,
        worth: &mut f64,
        offspring: &mut Offspring,
        scratch: &mut CrossoverScratch,
        random: &mut ChaCha8Rng,
    ) {
        let (child, touched) = (&mut scratch.child, &mut scratch.touched);
        let legs = (child.nodes.len() - 1) as u32;
        let span = random.random_range(legs.min(2)..=legs.min(LONGEST_WINDOW));
        let from = random.random_range(0..=legs - span) as usize;
        // In three of ten cases time is nearly free: in the end only the profit counts.
        let price = self.space.price * random.random_range(-0.5..1.2_f64).max(1e-6);
        let ends = [from, from + span as usize];
        touched.clear();
        let layers = scratch
            .window
            .solve(self.space, child, ends, price, touched);
        offspring.quota = offspring.quota.saturating_sub(layers);
        if !touched.is_empty() {
            offspring.update_best(self.objective, child);
            self.improve_child(worth, offspring, scratch);
        }
    }

    /// Improves the child by descent, one evaluation a step, and keeps it where it is better.
    fn improve_child(
        &self,
        worth: &mut f64,
        offspring: &mut Offspring,
        scratch: &mut CrossoverScratch,
    ) {
        let space = self.space;
        let child = &mut scratch.child;
        offspring.quota -= scratch.descent.improve(
            space,
            child,
            space.price,
            Some(&scratch.touched),
            offspring.quota,
            self.deadline,
        );
        if child.worth(space) > *worth {
            *worth = child.worth(space);
            offspring.replacement = Some(child.clone());
        }
        offspring.update_best(self.objective, child);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::random_tour;
    use auv_graph::{NodeId, Terrain};
    use auv_planning::RouteProblem;
    use auv_types::Seed;

    #[test]
    fn a_replacement_is_worth_more_than_the_first_parent_and_the_quota_holds() {
        let network = Terrain::benchmark(40, 700).draw(Seed(1)).unwrap().network;
        let problem = RouteProblem::new(&network, NodeId(0), NodeId(1), 18_000.0);
        let home = network.quickest_to(NodeId(1), problem.removed, None);
        let mut space = SearchSpace::new(&problem, &home, Deadline::default()).unwrap();
        space.price = 1e-3;
        space.rank_neighbours(6, Deadline::default());
        let objective = TourObjective::new(&problem).unwrap();
        let crossover = PairCrossover {
            space: &space,
            objective: &objective,
            windows: 2,
            deadline: Deadline::default(),
        };
        let mut scratch = CrossoverScratch::default();
        let mut replaced = 0;
        for seed in 0..20 {
            let parents = [
                random_tour(&space, 2 * seed),
                random_tour(&space, 2 * seed + 1),
            ];
            for quota in [0, 1, 30] {
                let mut offspring = Offspring::default();
                offspring.begin(quota);
                let random = &mut Seed(seed).stream(0);
                crossover.cross(
                    [&parents[0], &parents[1]],
                    &mut offspring,
                    &mut scratch,
                    random,
                );
                assert!(offspring.quota <= quota);
                assert!(quota > 0 || offspring.best.is_none());
                if let Some(child) = &offspring.replacement {
                    assert!(child.worth(&space) > parents[0].worth(&space));
                    assert!(child.time_s <= space.time_available_s);
                    let best = offspring.best.as_ref().unwrap();
                    assert!(!objective.prefers(child, best));
                    replaced += 1;
                }
            }
        }
        assert!(replaced > 10, "{replaced}");
    }
}
