//! The moves of the local search that bring a node next to one of its neighbours: insertion, removal,
//! replacement, chains, or-opt and 2-opt. Sums along the tour give the gain of each in O(1).

use super::moves::{CHAIN, Move};
use super::profit_time::ProfitTime;
use super::search_space::SearchSpace;

/// Position of a node that is not visited.
pub(super) const OUT: u32 = u32::MAX;
/// Smaller gains are rounding errors.
const EPSILON: f64 = 1e-9;
/// Most nodes removed at once.
pub(super) const MOST_REMOVED: usize = 4;
/// Most nodes moved at once.
const MOST_MOVED: usize = 3;
/// Number of neighbours of each new node that are tried as the next one.
const BREADTH: usize = 2;

/// The stretch of the tour between a position and the place where a chain of new nodes returns.
#[derive(Clone, Copy, Debug, Default)]
struct Gap {
    place: usize,
    /// Worth of the legs replaced.
    worth: f64,
    /// Most seconds that the new legs may take.
    room_s: f64,
}

/// All gaps at a position.
struct Gaps<'a> {
    at: usize,
    gaps: &'a [Gap],
    /// Least worth replaced.
    low: f64,
    /// Most room.
    room_s: f64,
    /// How far the price is below that at which neighbours were ranked.
    cheaper: f64,
}

/// A tour with the sums that its moves are computed from.
pub(super) struct Neighbourhood<'a> {
    pub(super) space: &'a SearchSpace,
    pub(super) nodes: &'a [u32],
    /// Position of each node, [`OUT`] if it is not visited.
    pub(super) position: &'a [u32],
    /// Sums from the start to each position.
    pub(super) along: &'a [ProfitTime],
    /// What a second is worth.
    pub(super) price: f64,
    /// Time left.
    pub(super) slack_s: f64,
}

/// The best move found so far.
struct BestMove {
    gain: f64,
    chosen: Option<Move>,
}

impl Neighbourhood<'_> {
    /// The move of greatest gain that joins the node at a position with one of its neighbours.
    pub(super) fn best_move(&self, at: usize) -> Option<Move> {
        let mut best = BestMove {
            gain: EPSILON,
            chosen: None,
        };
        // If an exchange gains, one of its new legs is worth more than the leg it replaces.
        let leg = |from: usize| self.stretch(from, from + 1).worth(self.price);
        let out = (at + 1 < self.nodes.len()).then(|| leg(at));
        let into = at.checked_sub(1).map(leg);
        let least = match (out, into) {
            (Some(out), Some(into)) if self.space.symmetric => [Some(out.min(into)); 2],
            _ => [out, into],
        };
        if let Some(least) = least[0] {
            self.moves_beside::<true>(at, least, &mut best);
        }
        if let Some(least) = least[1] {
            self.moves_beside::<false>(at, least, &mut best);
        }
        best.chosen
    }

    /// Sum along the tour between two positions.
    fn stretch(&self, from: usize, to: usize) -> ProfitTime {
        self.along[to] - self.along[from]
    }

    fn offer(&self, new: ProfitTime, old: ProfitTime, candidate: Move, best: &mut BestMove) {
        let delta = new - old;
        let gain = delta.worth(self.price);
        if gain > best.gain && delta.time_s <= self.slack_s {
            (best.gain, best.chosen) = (gain, Some(candidate));
        }
    }

    /// Tries the moves that bring a neighbour right after (or before) the node; exchanges only if the
    /// new leg is worth more than `least`.
    fn moves_beside<const AFTER: bool>(&self, at: usize, least: f64, best: &mut BestMove) {
        let mut gaps = [Gap::default(); MOST_REMOVED + 1];
        let most = if AFTER { self.nodes.len() - 1 - at } else { at };
        let gaps = &mut gaps[..most.min(MOST_REMOVED + 1)];
        for (k, gap) in gaps.iter_mut().enumerate() {
            let place = if AFTER { at + k + 1 } else { at - k - 1 };
            let old = self.stretch(at.min(place), at.max(place));
            *gap = Gap {
                place,
                worth: old.worth(self.price),
                room_s: self.slack_s + old.time_s,
            };
        }
        let gaps = Gaps {
            at,
            low: gaps
                .iter()
                .map(|gap| gap.worth)
                .fold(f64::INFINITY, f64::min),
            room_s: gaps.iter().map(|gap| gap.room_s).fold(0.0, f64::max),
            cheaper: (self.space.ranked_at - self.price).max(0.0),
            gaps,
        };
        for near in self.space.near::<AFTER>(self.nodes[at]) {
            let place = self.position[near.node as usize];
            if place != OUT {
                let [a, b] = if AFTER {
                    [at, place as usize]
                } else {
                    [place as usize, at]
                };
                self.join([a, b], near.arc, near.arc.worth(self.price) > least, best);
            } else {
                let mut chain = [0; CHAIN];
                chain[0] = near.node;
                self.extend_chain::<AFTER>(&mut chain, 1, near.arc, &gaps, best);
            }
        }
    }

    /// Tries to return to the tour from a chain of `count` new nodes, the legs of which add up to
    /// `new`, and to extend the chain.
    fn extend_chain<const AFTER: bool>(
        &self,
        chain: &mut [u32; CHAIN],
        count: usize,
        new: ProfitTime,
        gaps: &Gaps<'_>,
        best: &mut BestMove,
    ) {
        self.close_chain::<AFTER>(chain, count, new, gaps, best);
        if count == CHAIN {
            return;
        }
        for near in self
            .space
            .near::<AFTER>(chain[count - 1])
            .iter()
            .take(BREADTH)
        {
            if self.position[near.node as usize] == OUT && !chain[..count].contains(&near.node) {
                chain[count] = near.node;
                self.extend_chain::<AFTER>(chain, count + 1, new + near.arc, gaps, best);
            }
        }
    }

    /// Returns from a chain of new nodes to the tour over the gap where that gains most.
    fn close_chain<const AFTER: bool>(
        &self,
        chain: &[u32; CHAIN],
        count: usize,
        new: ProfitTime,
        gaps: &Gaps<'_>,
        best: &mut BestMove,
    ) {
        let last = chain[count - 1];
        let worth = new.worth(self.price);
        let bounds = self.space.bounds::<AFTER>(last);
        let left_s = gaps.room_s - new.time_s;
        // An upper bound: the last leg is worth at most what the best arc was when ranked, and the
        // seconds that it may take are cheaper now.
        let most = worth + bounds.worth + gaps.cheaper * left_s - gaps.low;
        if left_s < bounds.time_s || most <= best.gain {
            return;
        }
        for gap in gaps.gaps {
            let left_s = gap.room_s - new.time_s;
            let leg = self.space.arc_beside::<AFTER>(last, self.nodes[gap.place]);
            let gain = worth + leg.worth(self.price) - gap.worth;
            if gain > best.gain && leg.time_s <= left_s {
                best.gain = gain;
                let mut new = *chain;
                let (from, to) = if AFTER {
                    (gaps.at, gap.place)
                } else {
                    new[..count].reverse();
                    (gap.place, gaps.at)
                };
                best.chosen = Some(Move::Splice {
                    from,
                    to,
                    new,
                    count,
                });
            }
        }
    }

    /// Tries the moves that lead from position `a` straight to position `b` by a new leg: removal of
    /// what lies between and, if `exchanges`, moved and reversed blocks.
    fn join(&self, [a, b]: [usize; 2], new: ProfitTime, exchanges: bool, best: &mut BestMove) {
        if b == a + 1 || b == a {
            return;
        }
        if b > a && b - a <= 1 + MOST_REMOVED {
            let removal = Move::Splice {
                from: a,
                to: b,
                new: [0; CHAIN],
                count: 0,
            };
            self.offer(new, self.stretch(a, b), removal, best);
        }
        if !exchanges {
            return;
        }
        self.move_blocks(a, b, best);
        if self.space.symmetric {
            self.reverse_blocks(a, b, best);
        }
    }

    /// Or-opt: exchanges neighbouring blocks such that `a` comes right before `b`.
    fn move_blocks(&self, a: usize, b: usize, best: &mut BestMove) {
        const STRAIGHT: [bool; 2] = [false, false];
        let end = self.nodes.len() - 1;
        if b > a {
            // A block that starts at b moves to after a.
            for last in b..end.min(b + MOST_MOVED) {
                self.exchange([a, b - 1, last], STRAIGHT, best);
            }
            // A block that ends at a moves to before b.
            for first in a.saturating_sub(MOST_MOVED)..a {
                self.exchange([first, a, b - 1], STRAIGHT, best);
            }
        } else if b > 0 && a < end {
            // A block that ends at a moves to before one that starts at b; one of them is short.
            let late = (b + MOST_MOVED).max(a.saturating_sub(MOST_MOVED));
            for middle in (b..a.min(b + MOST_MOVED)).chain(late..a) {
                self.exchange([b - 1, middle, a], STRAIGHT, best);
            }
        }
    }

    /// 2-opt and or-opt with reversed blocks such that `a` and `b` become neighbours.
    fn reverse_blocks(&self, a: usize, b: usize, best: &mut BestMove) {
        let end = self.nodes.len() - 1;
        if b > a && b < end {
            self.reverse(a, b, best);
        }
        if b > a && a > 0 {
            self.reverse(a - 1, b - 1, best);
        }
        let (low, high) = (a.min(b), a.max(b));
        // A block that ends at `high` moves, reversed, to right after `low`.
        if high < end {
            for middle in high.saturating_sub(MOST_MOVED).max(low + 1)..high {
                self.exchange([low, middle, high], [false, true], best);
            }
        }
        // A block that starts at `low` moves, reversed, to right before `high`.
        if low > 0 {
            for middle in low..(high - 1).min(low + MOST_MOVED) {
                self.exchange([low - 1, middle, high - 1], [true, false], best);
            }
        }
    }

    fn exchange(
        &self,
        [first, middle, last]: [usize; 3],
        reversed: [bool; 2],
        best: &mut BestMove,
    ) {
        let nodes = self.nodes;
        let ends = |from: usize, to: usize, reversed: bool| {
            if reversed {
                (nodes[to], nodes[from])
            } else {
                (nodes[from], nodes[to])
            }
        };
        let one = ends(first + 1, middle, reversed[0]);
        let two = ends(middle + 1, last, reversed[1]);
        let new = self.space.arc(nodes[first], two.0)
            + self.space.arc(two.1, one.0)
            + self.space.arc(one.1, nodes[last + 1]);
        let old = self.stretch(first, first + 1)
            + self.stretch(middle, middle + 1)
            + self.stretch(last, last + 1);
        let exchange = Move::Exchange {
            first,
            middle,
            last,
            reversed,
        };
        self.offer(new, old, exchange, best);
    }

    fn reverse(&self, first: usize, last: usize, best: &mut BestMove) {
        if last <= first + 1 {
            return;
        }
        let nodes = self.nodes;
        let new = self.space.arc(nodes[first], nodes[last])
            + self.space.arc(nodes[first + 1], nodes[last + 1]);
        let old = self.stretch(first, first + 1) + self.stretch(last, last + 1);
        self.offer(new, old, Move::Reverse { first, last }, best);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, spaces};
    use crate::memetic::tour::Tour;

    /// Positions and sums of a tour.
    fn sums(space: &SearchSpace, tour: &Tour) -> (Vec<u32>, Vec<ProfitTime>) {
        let mut position = vec![OUT; space.len()];
        for (i, &node) in (0..).zip(&tour.nodes) {
            position[node as usize] = i;
        }
        let along = (1..=tour.nodes.len()).map(|n| space.sum(&tour.nodes[..n]));
        (position, along.collect())
    }

    /// The tour after a move, and its gain at a price, from the nodes.
    fn after(space: &SearchSpace, tour: &Tour, price: f64, chosen: &Move) -> (Tour, f64) {
        let mut nodes = tour.nodes.clone();
        chosen.apply(&mut nodes);
        let changed = Tour::new(nodes, space);
        let gain = changed.profit - tour.profit - price * (changed.time_s - tour.time_s);
        (changed, gain)
    }

    #[test]
    fn every_offered_gain_is_that_of_the_changed_tour() {
        let mut kinds = [0; 3];
        for space in spaces() {
            for seed in 0..30 {
                let tour = random_tour(&space, seed);
                let (position, along) = sums(&space, &tour);
                for price in [0.0, 1e-3, 4e-3] {
                    let neighbourhood = Neighbourhood {
                        space: &space,
                        nodes: &tour.nodes,
                        position: &position,
                        along: &along,
                        price,
                        slack_s: tour.time_left_s(&space),
                    };
                    for at in 0..tour.nodes.len() {
                        let Some(chosen) = neighbourhood.best_move(at) else {
                            continue;
                        };
                        kinds[match chosen {
                            Move::Splice { .. } => 0,
                            Move::Exchange { .. } => 1,
                            Move::Reverse { .. } => 2,
                        }] += 1;
                        let (changed, gain) = after(&space, &tour, price, &chosen);
                        assert!(gain > 0.0, "{chosen:?} gains {gain}");
                        assert!(
                            changed.time_s <= space.time_available_s + 1e-6,
                            "{chosen:?}"
                        );
                        let mut once = changed.nodes.clone();
                        once.sort_unstable();
                        once.dedup();
                        assert_eq!(once.len(), changed.nodes.len(), "{chosen:?}");
                        assert_eq!(changed.nodes[0], tour.nodes[0]);
                        assert_eq!(changed.nodes.last(), tour.nodes.last());
                    }
                }
            }
        }
        assert!(kinds.iter().all(|&count| count > 5), "{kinds:?}");
    }

    /// The greatest gain of an insertion of one neighbour beside the node at a position, with up to
    /// [`MOST_REMOVED`] nodes removed, by summing each changed tour.
    fn best_insertion(space: &SearchSpace, tour: &Tour, price: f64, at: usize) -> f64 {
        let mut best: f64 = 0.0;
        let mut consider = |from: usize, to: usize, node: u32| {
            let mut nodes = tour.nodes.clone();
            nodes.splice(from + 1..to, [node]);
            let changed = Tour::new(nodes, space);
            if changed.time_s <= space.time_available_s {
                best =
                    best.max(changed.profit - tour.profit - price * (changed.time_s - tour.time_s));
            }
        };
        let last = tour.nodes.len() - 1;
        let out = |node: &u32| !tour.nodes.contains(node);
        let [heads, tails] = [
            space.near::<true>(tour.nodes[at]),
            space.near::<false>(tour.nodes[at]),
        ];
        for removed in 0..=MOST_REMOVED {
            for node in heads.iter().map(|near| near.node).filter(out) {
                if at + 1 + removed <= last {
                    consider(at, at + 1 + removed, node);
                }
            }
            for node in tails.iter().map(|near| near.node).filter(out) {
                if at > removed {
                    consider(at - 1 - removed, at, node);
                }
            }
        }
        best
    }

    #[test]
    fn the_best_move_gains_no_less_than_any_insertion_of_a_neighbour() {
        let mut gains = 0;
        for space in spaces() {
            for seed in 0..20 {
                let tour = random_tour(&space, seed);
                let (position, along) = sums(&space, &tour);
                // Below, at and above the price at which neighbours were ranked.
                for price in [0.0, space.ranked_at, 2.0 * space.ranked_at] {
                    let neighbourhood = Neighbourhood {
                        space: &space,
                        nodes: &tour.nodes,
                        position: &position,
                        along: &along,
                        price,
                        slack_s: tour.time_left_s(&space),
                    };
                    for at in 0..tour.nodes.len() {
                        let expected = best_insertion(&space, &tour, price, at);
                        let gain = neighbourhood
                            .best_move(at)
                            .map_or(0.0, |chosen| after(&space, &tour, price, &chosen).1);
                        assert!(gain >= expected - 1e-8, "{gain} {expected}");
                        gains += usize::from(expected > 0.0);
                    }
                }
            }
        }
        assert!(gains > 100, "{gains}");
    }
}
