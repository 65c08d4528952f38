//! Local search on profit and time together, over a queue of nodes whose surroundings changed.

use super::field::{Field, ProfitTime, START};
use super::neighbourhood::{CUT, Move, Neighbourhood, OUT};
use super::tour::Tour;
use auv_planning::Deadline;

/// Room for a descent; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct Descent {
    /// Position of each node, `OUT` when not visited.
    position: Vec<u32>,
    /// Profit and time from the start to each position.
    along: Vec<ProfitTime>,
    queue: Vec<u32>,
    queued: Vec<bool>,
    /// What cutting out the next 1, 2, ... nodes after each position loses and saves.
    losses: Vec<[ProfitTime; CUT]>,
}

impl Descent {
    /// Descends from a route until no move that touches a queued node pays at `price` a second; at
    /// most `steps` moves. Returns how many were made. With no `touched`, all nodes are queued.
    pub(crate) fn improve(
        &mut self,
        field: &Field,
        tour: &mut Tour,
        price: f64,
        touched: Option<&[u32]>,
        steps: u64,
        deadline: Deadline<'_>,
    ) -> u64 {
        self.queue.clear();
        self.queued.clear();
        self.queued.resize(field.len(), false);
        self.refresh(field, tour);
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
                field,
                nodes: &tour.nodes,
                position: &self.position,
                along: &self.along,
                price,
                slack_s: tour.time_left_s(field),
            };
            if let Some(chosen) = neighbourhood.best_move(at as usize) {
                self.make(chosen, field, tour);
                self.enqueue(node);
                made += 1;
            }
            if deadline.passed() {
                break;
            }
        }
        made
    }

    /// Takes out stretches of the route, the least loss first, until it is in time.
    pub(crate) fn eject(&mut self, field: &Field, tour: &mut Tour, touched: &mut Vec<u32>) {
        let mut over_s = tour.time_s - field.time_available_s;
        if over_s <= 0.0 {
            return;
        }
        let nodes = &mut tour.nodes;
        let losses = &mut self.losses;
        losses.clear();
        losses.extend((0..nodes.len()).map(|from| losses_from(field, nodes, from)));
        while over_s > 0.0 {
            let mut best: Option<(f64, usize, usize)> = None;
            for (from, losses) in losses.iter().enumerate() {
                for (k, lost) in losses.iter().enumerate() {
                    let (saved_s, loss) = (lost.time_s, lost.profit);
                    if saved_s <= 0.0 {
                        continue;
                    }
                    // What is saved beyond need is worth its price; a start on what is needed, its share.
                    let score = if saved_s >= over_s {
                        loss - field.price * (saved_s - over_s)
                    } else {
                        (loss.max(0.0) + 1e-9) * over_s / saved_s
                    };
                    if best.is_none_or(|(least, _, _)| score < least) {
                        best = Some((score, from, from + 2 + k));
                    }
                }
            }
            let Some((_, from, to)) = best else {
                nodes.clear();
                break;
            };
            touched.extend([nodes[from], nodes[to]]);
            over_s -= losses[from][to - from - 2].time_s;
            nodes.drain(from + 1..to);
            losses.drain(from + 1..to);
            let near = from.saturating_sub(CUT);
            for (i, losses) in losses[near..=from].iter_mut().enumerate() {
                *losses = losses_from(field, nodes, near + i);
            }
            if over_s <= 0.0 {
                // Differences add up to nearly the sum.
                over_s = field.sum(nodes).time_s - field.time_available_s;
            }
        }
        tour.sum(field);
    }

    fn enqueue(&mut self, node: u32) {
        if !std::mem::replace(&mut self.queued[node as usize], true) {
            self.queue.push(node);
        }
    }

    fn refresh(&mut self, field: &Field, tour: &mut Tour) {
        self.position.clear();
        self.position.resize(field.len(), OUT);
        self.along.clear();
        let mut sum = ProfitTime::default();
        for (i, &node) in tour.nodes.iter().enumerate() {
            if i > 0 {
                sum = sum + field.arc(tour.nodes[i - 1], node);
            }
            self.position[node as usize] = i as u32;
            self.along.push(sum);
        }
        (tour.profit, tour.time_s) = (sum.profit, sum.time_s);
    }

    fn make(&mut self, chosen: Move, field: &Field, tour: &mut Tour) {
        match chosen {
            Move::Splice {
                from,
                to,
                new,
                count,
            } => {
                for i in from..=to {
                    self.enqueue(tour.nodes[i]);
                }
                tour.nodes
                    .splice(from + 1..to, new[..count].iter().copied());
                for &node in &new[..count] {
                    self.enqueue(node);
                }
            }
            Move::Exchange {
                first,
                middle,
                last,
                turned,
            } => {
                for i in [first, first + 1, middle, middle + 1, last, last + 1] {
                    self.enqueue(tour.nodes[i]);
                }
                let block = &mut tour.nodes[first + 1..=last];
                let size = middle - first;
                if turned[0] {
                    block[..size].reverse();
                }
                if turned[1] {
                    block[size..].reverse();
                }
                block.rotate_left(size);
            }
            Move::Reverse { first, last } => {
                for i in [first, first + 1, last, last + 1] {
                    self.enqueue(tour.nodes[i]);
                }
                tour.nodes[first + 1..=last].reverse();
            }
        }
        self.refresh(field, tour);
        debug_assert_eq!(tour.nodes[0], START);
    }
}

/// What is lost by going from a position straight to the second next, the third next, ...; nothing
/// where the route ends before.
fn losses_from(field: &Field, nodes: &[u32], from: usize) -> [ProfitTime; CUT] {
    let mut losses = [ProfitTime::default(); CUT];
    let ahead = &nodes[from..nodes.len().min(from + 2 + CUT)];
    let mut along = ProfitTime::default();
    for (k, pair) in ahead.windows(2).enumerate() {
        along = along + field.arc(pair[0], pair[1]);
        if k > 0 {
            losses[k - 1] = along - field.arc(ahead[0], pair[1]);
        }
    }
    losses
}
