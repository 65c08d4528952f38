//! Local search on profit and time together, over a queue of nodes whose neighbourhood changed.

use super::moves::Move;
use super::neighbourhood::{Neighbourhood, OUT};
use super::profit_time::ProfitTime;
use super::search_space::{START, SearchSpace};
use super::tour::Tour;
use auv_planning::Deadline;

/// The state of a descent; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct Descent {
    /// Position of each node, [`OUT`] if it is not visited.
    position: Vec<u32>,
    /// Profit and time from the start to each position.
    along: Vec<ProfitTime>,
    queue: Vec<u32>,
    queued: Vec<bool>,
}

impl Descent {
    /// Makes moves until none that touches a queued node gains at `price` a second, at most `steps`
    /// of them. Returns their number. Queues the nodes of `touched`, or all if it is `None`.
    pub(crate) fn improve(
        &mut self,
        space: &SearchSpace,
        tour: &mut Tour,
        price: f64,
        touched: Option<&[u32]>,
        steps: u64,
        deadline: Deadline<'_>,
    ) -> u64 {
        self.queue.clear();
        self.queued.clear();
        self.queued.resize(space.len(), false);
        self.refresh(space, tour);
        match touched {
            Some(nodes) => nodes.iter().for_each(|&node| self.enqueue(node)),
            None => (0..tour.nodes.len())
                .rev()
                .for_each(|i| self.enqueue(tour.nodes[i])),
        }
        let mut made = 0;
        while made < steps
            && let Some(node) = self.queue.pop()
        {
            self.queued[node as usize] = false;
            let at = self.position[node as usize];
            if at == OUT {
                continue;
            }
            let neighbourhood = Neighbourhood {
                space,
                nodes: &tour.nodes,
                position: &self.position,
                along: &self.along,
                price,
                slack_s: tour.time_left_s(space),
            };
            if let Some(chosen) = neighbourhood.best_move(at as usize) {
                self.make(&chosen, space, tour);
                self.enqueue(node);
                made += 1;
            }
            if deadline.passed() {
                break;
            }
        }
        made
    }

    fn enqueue(&mut self, node: u32) {
        if !std::mem::replace(&mut self.queued[node as usize], true) {
            self.queue.push(node);
        }
    }

    /// Computes positions and sums from the nodes.
    fn refresh(&mut self, space: &SearchSpace, tour: &mut Tour) {
        self.position.clear();
        self.position.resize(space.len(), OUT);
        self.along.clear();
        let mut sum = ProfitTime::default();
        for (i, &node) in tour.nodes.iter().enumerate() {
            if i > 0 {
                sum = sum + space.arc(tour.nodes[i - 1], node);
            }
            self.position[node as usize] = i as u32;
            self.along.push(sum);
        }
        (tour.profit, tour.time_s) = (sum.profit, sum.time_s);
    }

    /// Makes a move and queues the nodes next to which something changed.
    fn make(&mut self, chosen: &Move, space: &SearchSpace, tour: &mut Tour) {
        match *chosen {
            Move::Splice { from, to, .. } => {
                (from..=to).for_each(|i| self.enqueue(tour.nodes[i]));
            }
            Move::Exchange {
                first,
                middle,
                last,
                ..
            } => {
                for i in [first, first + 1, middle, middle + 1, last, last + 1] {
                    self.enqueue(tour.nodes[i]);
                }
            }
            Move::Reverse { first, last } => {
                for i in [first, first + 1, last, last + 1] {
                    self.enqueue(tour.nodes[i]);
                }
            }
        }
        chosen.apply(&mut tour.nodes);
        if let Move::Splice { new, count, .. } = *chosen {
            new[..count].iter().for_each(|&node| self.enqueue(node));
        }
        self.refresh(space, tour);
        debug_assert_eq!(tour.nodes[0], START);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, spaces};

    #[test]
    fn every_descent_gains_until_no_move_does() {
        for space in spaces() {
            for seed in 0..10 {
                let mut tour = random_tour(&space, seed);
                let before = tour.clone();
                let worth = |tour: &Tour| tour.profit - space.price * tour.time_s;
                let mut descent = Descent::default();
                let deadline = Deadline::default();
                let price = space.price;
                let made = descent.improve(&space, &mut tour, price, None, 10_000, deadline);
                assert!(made > 0 && worth(&tour) > worth(&before));
                assert_eq!(tour, Tour::new(tour.nodes.clone(), &space));
                assert!(tour.time_s <= space.time_available_s);
                // A move may make others pay that touch no queued node: they are found next time.
                let ended = (0..5).any(|_| {
                    let before = worth(&tour);
                    let made = descent.improve(&space, &mut tour, price, None, 10_000, deadline);
                    assert!(made == 0 || worth(&tour) > before);
                    made == 0
                });
                assert!(ended, "seed {seed}");
            }
        }
    }

    #[test]
    fn makes_no_more_steps_than_allowed() {
        let [space, ..] = spaces();
        let mut tour = random_tour(&space, 1);
        let mut descent = Descent::default();
        let made = descent.improve(&space, &mut tour, space.price, None, 1, Deadline::default());
        assert_eq!(made, 1);
    }
}
