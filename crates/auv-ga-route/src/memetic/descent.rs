//! Local search on profit and time together: insertion, removal, replacement, chains, 2-opt and
//! or-opt, each costed in O(1) from sums along the route.

use super::field::{Arc, Field, START};
use super::tour::Tour;
use auv_planning::Deadline;

/// Room for a descent; one for each thread.
#[derive(Clone, Debug, Default)]
pub(crate) struct Descent {
    /// Position of each node, `OUT` when not visited.
    position: Vec<u32>,
    /// Profit and time from the start to each position.
    along: Vec<(f64, f64)>,
    queue: Vec<u32>,
    queued: Vec<bool>,
}

const OUT: u32 = u32::MAX;
/// Improvements below this share of nothing are rounding.
const EPSILON: f64 = 1e-9;
/// Most nodes cut out at once.
const CUT: usize = 3;
/// Most nodes moved at once.
const BLOCK: usize = 3;
/// How many second nodes of a chain are tried.
const CHAIN: usize = 5;

/// A change of a route, by positions.
#[derive(Clone, Copy, Debug)]
enum Move {
    /// The nodes strictly between two positions give way to up to two new ones.
    Splice {
        from: usize,
        to: usize,
        new: [u32; 2],
        count: usize,
    },
    /// The blocks `first + 1 ..= middle` and `middle + 1 ..= last` change places; reversed ones
    /// where said.
    Exchange {
        first: usize,
        middle: usize,
        last: usize,
        turned: [bool; 2],
    },
    /// The nodes `first + 1 ..= last` are passed in reverse.
    Reverse { first: usize, last: usize },
}

/// The best move found so far.
struct Best {
    gain: f64,
    slack_s: f64,
    price: f64,
    chosen: Option<Move>,
}

impl Best {
    fn offer(&mut self, profit: f64, time_s: f64, candidate: Move) {
        let gain = profit - self.price * time_s;
        if gain > self.gain && time_s <= self.slack_s {
            (self.gain, self.chosen) = (gain, Some(candidate));
        }
    }
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
            if self.position[node as usize] == OUT {
                continue;
            }
            if let Some(chosen) = self.best_move(field, tour, price, node) {
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
        while !tour.nodes.is_empty() && !tour.in_time(field) {
            self.refresh(field, tour);
            let over_s = tour.time_s - field.time_available_s;
            let mut best: Option<(f64, usize, usize)> = None;
            for from in 0..tour.nodes.len() - 1 {
                for to in from + 2..tour.nodes.len().min(from + 2 + CUT) {
                    let bridge = field.arc(tour.nodes[from], tour.nodes[to]);
                    let saved_s = self.along[to].1 - self.along[from].1 - bridge.time_s;
                    if saved_s <= 0.0 {
                        continue;
                    }
                    let loss = self.along[to].0 - self.along[from].0 - bridge.profit;
                    // What is saved beyond need is worth its price; a start on what is needed, its share.
                    let score = if saved_s >= over_s {
                        loss - field.price * (saved_s - over_s)
                    } else {
                        (loss.max(0.0) + EPSILON) * over_s / saved_s
                    };
                    if best.is_none_or(|(least, _, _)| score < least) {
                        best = Some((score, from, to));
                    }
                }
            }
            let Some((_, from, to)) = best else {
                tour.nodes.clear();
                return;
            };
            touched.push(tour.nodes[from]);
            touched.push(tour.nodes[to]);
            tour.nodes.drain(from + 1..to);
            tour.sum(field);
        }
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
        let mut sums = (0.0, 0.0);
        for (i, &node) in tour.nodes.iter().enumerate() {
            if i > 0 {
                let arc = field.arc(tour.nodes[i - 1], node);
                sums = (sums.0 + arc.profit, sums.1 + arc.time_s);
            }
            self.position[node as usize] = i as u32;
            self.along.push(sums);
        }
        (tour.profit, tour.time_s) = sums;
    }

    fn best_move(&self, field: &Field, tour: &Tour, price: f64, node: u32) -> Option<Move> {
        let mut best = Best {
            gain: EPSILON,
            slack_s: field.time_available_s - tour.time_s,
            price,
            chosen: None,
        };
        let nodes = &tour.nodes;
        let at = self.position[node as usize] as usize;
        // Exchanges pay only if, seen from one of their nodes, the new leg beats the one it replaces.
        let worth = |arc: Arc| arc.profit - price * arc.time_s;
        let leg = |from: usize| worth(field.arc(nodes[from], nodes[from + 1]));
        let out = (at + 1 < nodes.len()).then(|| leg(at));
        let into = (at > 0).then(|| leg(at - 1));
        let least = match (out, into) {
            (Some(out), Some(into)) if field.symmetric => [out.min(into); 2],
            _ => [out, into].map(|leg| leg.unwrap_or(f64::INFINITY)),
        };
        if at + 1 < nodes.len() {
            for &head in field.heads(node) {
                match self.position[head as usize] {
                    OUT => self.splice_after(field, nodes, at, head, &mut best),
                    position => {
                        let pays = worth(field.arc(node, head)) > least[0];
                        self.join(field, nodes, [at, position as usize], pays, &mut best);
                    }
                }
            }
        }
        if at > 0 {
            for &tail in field.tails(node) {
                match self.position[tail as usize] {
                    OUT => self.splice_before(field, nodes, at, tail, &mut best),
                    position => {
                        let pays = worth(field.arc(tail, node)) > least[1];
                        self.join(field, nodes, [position as usize, at], pays, &mut best);
                    }
                }
            }
        }
        best.chosen
    }

    /// Sum along the route between two positions.
    fn stretch(&self, from: usize, to: usize) -> Arc {
        let (a, b) = (self.along[from], self.along[to]);
        Arc {
            profit: b.0 - a.0,
            time_s: b.1 - a.1,
        }
    }

    /// `node -> head`, then on to one of the next nodes, directly or through one more new node.
    #[allow(
        clippy::needless_range_loop,
        reason = "positions index the route and its sums alike"
    )]
    fn splice_after(&self, field: &Field, nodes: &[u32], from: usize, head: u32, best: &mut Best) {
        let first = field.arc(nodes[from], head);
        for to in from + 1..nodes.len().min(from + 2 + CUT) {
            let old = self.stretch(from, to);
            let last = field.arc(head, nodes[to]);
            best.offer(
                first.profit + last.profit - old.profit,
                first.time_s + last.time_s - old.time_s,
                Move::Splice {
                    from,
                    to,
                    new: [head, 0],
                    count: 1,
                },
            );
        }
        for &second in field.heads(head).iter().take(CHAIN) {
            if self.position[second as usize] != OUT {
                continue;
            }
            let step = field.arc(head, second);
            for to in from + 1..nodes.len().min(from + 2 + CUT) {
                let old = self.stretch(from, to);
                let last = field.arc(second, nodes[to]);
                best.offer(
                    first.profit + step.profit + last.profit - old.profit,
                    first.time_s + step.time_s + last.time_s - old.time_s,
                    Move::Splice {
                        from,
                        to,
                        new: [head, second],
                        count: 2,
                    },
                );
            }
        }
    }

    /// From one of the previous nodes, directly or through one more new node, `tail -> node`.
    #[allow(
        clippy::needless_range_loop,
        reason = "positions index the route and its sums alike"
    )]
    fn splice_before(&self, field: &Field, nodes: &[u32], to: usize, tail: u32, best: &mut Best) {
        let last = field.arc(tail, nodes[to]);
        for from in to.saturating_sub(1 + CUT)..to {
            let old = self.stretch(from, to);
            let first = field.arc(nodes[from], tail);
            best.offer(
                first.profit + last.profit - old.profit,
                first.time_s + last.time_s - old.time_s,
                Move::Splice {
                    from,
                    to,
                    new: [tail, 0],
                    count: 1,
                },
            );
        }
        for &second in field.tails(tail).iter().take(CHAIN) {
            if self.position[second as usize] != OUT {
                continue;
            }
            let step = field.arc(second, tail);
            for from in to.saturating_sub(1 + CUT)..to {
                let old = self.stretch(from, to);
                let first = field.arc(nodes[from], second);
                best.offer(
                    first.profit + step.profit + last.profit - old.profit,
                    first.time_s + step.time_s + last.time_s - old.time_s,
                    Move::Splice {
                        from,
                        to,
                        new: [second, tail],
                        count: 2,
                    },
                );
            }
        }
    }

    /// Brings two visited nodes together: cuts out what lies between, moves or reverses stretches.
    fn join(
        &self,
        field: &Field,
        nodes: &[u32],
        [a, b]: [usize; 2],
        pays: bool,
        best: &mut Best,
    ) {
        let end = nodes.len() - 1;
        if b == a + 1 || b == a {
            return;
        }
        let new = field.arc(nodes[a], nodes[b]);
        if b > a {
            if b - a <= 1 + CUT {
                let old = self.stretch(a, b);
                best.offer(
                    new.profit - old.profit,
                    new.time_s - old.time_s,
                    Move::Splice {
                        from: a,
                        to: b,
                        new: [0, 0],
                        count: 0,
                    },
                );
            }
            if !pays {
                return;
            }
            // first = a, middle = b - 1: the block that begins at b comes first.
            for last in b..end.min(b + BLOCK) {
                self.offer_exchange(field, nodes, [a, b - 1, last], best);
            }
            // middle = a, last = b - 1: the block that ends at a goes before b.
            for first in a.saturating_sub(BLOCK)..a {
                self.offer_exchange(field, nodes, [first, a, b - 1], best);
            }
            if field.symmetric && b < end {
                self.offer_reverse(field, nodes, a, b, best);
            }
            if field.symmetric && a > 0 {
                self.offer_reverse(field, nodes, a - 1, b - 1, best);
            }
        } else if !pays {
            return;
        } else if b > 0 && a < end {
            // last = a, first + 1 = b.
            for middle in (b..a).filter(|m| m - b < BLOCK || a - m <= BLOCK) {
                self.offer_exchange(field, nodes, [b - 1, middle, a], best);
            }
        }
        if field.symmetric {
            self.turn(field, nodes, a, b, best);
        }
    }

    /// Moves a short stretch next to another node, reversed (symmetric fields).
    fn turn(&self, field: &Field, nodes: &[u32], a: usize, b: usize, best: &mut Best) {
        let end = nodes.len() - 1;
        let (low, high) = (a.min(b), a.max(b));
        // The stretch that ends at `high` comes, reversed, right after `low`.
        if high < end {
            for middle in high.saturating_sub(BLOCK).max(low + 1)..high {
                self.offer_turned(field, nodes, [low, middle, high], [false, true], best);
            }
        }
        // The stretch that begins at `low` goes, reversed, right before `high`.
        if low > 0 {
            for middle in low..(high - 1).min(low + BLOCK) {
                self.offer_turned(
                    field,
                    nodes,
                    [low - 1, middle, high - 1],
                    [true, false],
                    best,
                );
            }
        }
    }

    fn offer_exchange(&self, field: &Field, nodes: &[u32], cut: [usize; 3], best: &mut Best) {
        let [first, middle, last] = cut;
        let new = [
            field.arc(nodes[first], nodes[middle + 1]),
            field.arc(nodes[last], nodes[first + 1]),
            field.arc(nodes[middle], nodes[last + 1]),
        ];
        self.offer_cut(cut, new, [false, false], best);
    }

    fn offer_turned(
        &self,
        field: &Field,
        nodes: &[u32],
        cut: [usize; 3],
        turned: [bool; 2],
        best: &mut Best,
    ) {
        let [first, middle, last] = cut;
        let (begin_1, end_1) = if turned[0] {
            (nodes[middle], nodes[first + 1])
        } else {
            (nodes[first + 1], nodes[middle])
        };
        let (begin_2, end_2) = if turned[1] {
            (nodes[last], nodes[middle + 1])
        } else {
            (nodes[middle + 1], nodes[last])
        };
        let new = [
            field.arc(nodes[first], begin_2),
            field.arc(end_2, begin_1),
            field.arc(end_1, nodes[last + 1]),
        ];
        self.offer_cut(cut, new, turned, best);
    }

    fn offer_cut(
        &self,
        [first, middle, last]: [usize; 3],
        new: [Arc; 3],
        turned: [bool; 2],
        best: &mut Best,
    ) {
        let old = [
            self.stretch(first, first + 1),
            self.stretch(middle, middle + 1),
            self.stretch(last, last + 1),
        ];
        let sum = |arcs: &[Arc; 3]| {
            (
                arcs[0].profit + arcs[1].profit + arcs[2].profit,
                arcs[0].time_s + arcs[1].time_s + arcs[2].time_s,
            )
        };
        let (new, old) = (sum(&new), sum(&old));
        best.offer(
            new.0 - old.0,
            new.1 - old.1,
            Move::Exchange {
                first,
                middle,
                last,
                turned,
            },
        );
    }

    fn offer_reverse(
        &self,
        field: &Field,
        nodes: &[u32],
        first: usize,
        last: usize,
        best: &mut Best,
    ) {
        if last <= first + 1 {
            return;
        }
        let new = [
            field.arc(nodes[first], nodes[last]),
            field.arc(nodes[first + 1], nodes[last + 1]),
        ];
        let old = [self.stretch(first, first + 1), self.stretch(last, last + 1)];
        best.offer(
            new[0].profit + new[1].profit - old[0].profit - old[1].profit,
            new[0].time_s + new[1].time_s - old[0].time_s - old[1].time_s,
            Move::Reverse { first, last },
        );
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
