//! One pair's offspring: assembled, brought into time, improved.

use super::assembly::Assembly;
use super::descent::Descent;
use super::field::Field;
use super::goal::Goal;
use super::tour::Tour;
use super::window::Window;
use auv_planning::Deadline;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// What a pair brings forth within its evaluations.
#[derive(Debug, Default)]
pub(crate) struct Brood {
    /// Evaluations left to spend.
    pub(crate) quota: u64,
    /// Takes the first parent's place.
    pub(crate) heir: Option<Tour>,
    /// The best by the objective.
    pub(crate) champion: Option<Tour>,
}

impl Brood {
    pub(crate) fn begin(&mut self, quota: u64) {
        *self = Self {
            quota,
            ..Self::default()
        };
    }

    /// Remembers a route if it is the best by the objective.
    pub(crate) fn offer(&mut self, goal: &Goal, tour: &Tour) {
        match &mut self.champion {
            Some(champion) if goal.prefers(tour, champion) => champion.clone_from(tour),
            Some(_) => {}
            None => self.champion = Some(tour.clone()),
        }
    }
}

/// Room to breed in; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct Room {
    pub(crate) descent: Descent,
    assembly: Assembly,
    window: Window,
    child: Tour,
    touched: Vec<u32>,
    cycles: Vec<usize>,
}

/// Most legs of a window that is solved anew.
const LONGEST_WINDOW: u32 = 10;

/// What every pair is bred by.
#[derive(Clone, Copy)]
pub(crate) struct Breeder<'a> {
    pub(crate) field: &'a Field,
    pub(crate) goal: &'a Goal,
    pub(crate) windows: u32,
    pub(crate) deadline: Deadline<'a>,
}

impl Breeder<'_> {
    /// Breeds children of a pair, each from one cycle of their difference, in random order. The one of
    /// greatest worth above the first parent's becomes its heir.
    /// Without one, `windows` windows of the first parent are solved anew.
    pub(crate) fn breed(
        &self,
        parents: [&Tour; 2],
        brood: &mut Brood,
        room: &mut Room,
        random: &mut ChaCha8Rng,
    ) {
        let Self {
            field,
            goal,
            windows,
            deadline,
        } = *self;
        if brood.quota == 0 || deadline.passed() {
            return;
        }
        let Room {
            descent,
            assembly,
            window,
            child,
            touched,
            cycles,
        } = room;
        cycles.clear();
        cycles.extend(0..assembly.take_apart(field, parents, random));
        for i in (1..cycles.len()).rev() {
            cycles.swap(i, random.random_range(0..=i as u64) as usize);
        }
        let mut worth = parents[0].worth(field) + 1e-9;
        for &cycle in cycles.iter() {
            if brood.quota == 0 || deadline.passed() {
                break;
            }
            brood.quota -= 1;
            assembly.assemble(field, cycle, child, touched);
            descent.eject(field, child, touched);
            if child.nodes.is_empty() {
                continue;
            }
            brood.quota -= descent.improve(
                field,
                child,
                field.price,
                Some(touched),
                brood.quota,
                deadline,
            );
            if child.worth(field) > worth {
                worth = child.worth(field);
                brood.heir = Some(child.clone());
            }
            brood.offer(goal, child);
        }
        if brood.heir.is_some() {
            return;
        }
        // A parent that crossing does not improve is improved window by window.
        for _ in 0..windows {
            child.clone_from(brood.heir.as_ref().unwrap_or(parents[0]));
            if brood.quota == 0 || deadline.passed() {
                return;
            }
            let legs = (child.nodes.len() - 1) as u32;
            let span = random.random_range(legs.min(2)..=legs.min(LONGEST_WINDOW));
            let from = random.random_range(0..=legs - span) as usize;
            // Often without a price at all: what counts in the end.
            let price = field.price * random.random_range(-0.5..1.2_f64).max(1e-6);
            let ends = [from, from + span as usize];
            touched.clear();
            let layers = window.solve(field, child, ends, price, touched);
            brood.quota = brood.quota.saturating_sub(layers);
            if !touched.is_empty() {
                brood.offer(goal, child);
                brood.quota -= descent.improve(
                    field,
                    child,
                    field.price,
                    Some(touched),
                    brood.quota,
                    deadline,
                );
                brood.offer(goal, child);
                if child.worth(field) > worth {
                    worth = child.worth(field);
                    brood.heir = Some(child.clone());
                }
            }
        }
    }
}
