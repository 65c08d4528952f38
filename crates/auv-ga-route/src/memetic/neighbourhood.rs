//! The moves of the local search that bring a node next to one of its neighbours, each costed in
//! O(1) from sums along the route: insertion, removal, replacement, chains, or-opt and 2-opt.

use super::field::{Field, ProfitTime};

/// Position of a node that is not visited.
pub(super) const OUT: u32 = u32::MAX;
/// Gains up to this are rounding.
const EPSILON: f64 = 1e-9;
/// Most nodes cut out at once.
pub(super) const CUT: usize = 4;
/// Most nodes moved at once.
const BLOCK: usize = 3;
/// Most new nodes in a row.
const CHAIN: usize = 4;
/// How many neighbours of each new node are tried as the next one.
const BREADTH: usize = 2;

/// A change of a route, by positions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Move {
    /// The nodes strictly between two positions give way to `count` new ones.
    Splice {
        from: usize,
        to: usize,
        new: [u32; CHAIN],
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

/// What a splice from a node replaces, up to the place where it returns to the route.
#[derive(Clone, Copy, Debug, Default)]
struct Gap {
    place: usize,
    /// Worth of the legs replaced.
    worth: f64,
    /// Seconds the new legs may take.
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
    /// How much the price has fallen since neighbours were ranked.
    cheaper: f64,
}

/// A route's moves at a price, and the best found so far.
pub(super) struct Neighbourhood<'a> {
    pub(super) field: &'a Field,
    pub(super) nodes: &'a [u32],
    /// Position of each node, [`OUT`] when not visited.
    pub(super) position: &'a [u32],
    /// Sums from the start to each position.
    pub(super) along: &'a [ProfitTime],
    /// What a second is worth.
    pub(super) price: f64,
    /// Time left.
    pub(super) slack_s: f64,
}

struct Best {
    gain: f64,
    chosen: Option<Move>,
}

impl Neighbourhood<'_> {
    /// The move of greatest gain that touches the node at a position.
    pub(super) fn best_move(&self, at: usize) -> Option<Move> {
        let mut best = Best {
            gain: EPSILON,
            chosen: None,
        };
        // An exchange that pays has a node whose new leg beats the one it replaces.
        let leg = |from: usize| self.worth(self.stretch(from, from + 1));
        let out = (at + 1 < self.nodes.len()).then(|| leg(at));
        let into = at.checked_sub(1).map(leg);
        let least = match (out, into) {
            (Some(out), Some(into)) if self.field.symmetric => [Some(out.min(into)); 2],
            _ => [out, into],
        };
        if let Some(least) = least[0] {
            self.around::<true>(at, least, &mut best);
        }
        if let Some(least) = least[1] {
            self.around::<false>(at, least, &mut best);
        }
        best.chosen
    }

    fn worth(&self, arc: ProfitTime) -> f64 {
        arc.profit - self.price * arc.time_s
    }

    /// Sum along the route between two positions.
    fn stretch(&self, from: usize, to: usize) -> ProfitTime {
        self.along[to] - self.along[from]
    }

    fn offer(&self, new: ProfitTime, old: ProfitTime, candidate: Move, best: &mut Best) {
        let delta = new - old;
        let gain = self.worth(delta);
        if gain > best.gain && delta.time_s <= self.slack_s {
            (best.gain, best.chosen) = (gain, Some(candidate));
        }
    }

    /// The moves by which the node's neighbours come after (or before) it; exchanges only where the
    /// new leg is worth more than `least`.
    fn around<const AFTER: bool>(&self, at: usize, least: f64, best: &mut Best) {
        let mut gaps = [Gap::default(); CUT + 1];
        let most = if AFTER { self.nodes.len() - 1 - at } else { at };
        let gaps = &mut gaps[..most.min(CUT + 1)];
        for (k, gap) in gaps.iter_mut().enumerate() {
            let place = if AFTER { at + k + 1 } else { at - k - 1 };
            let old = self.stretch(at.min(place), at.max(place));
            *gap = Gap {
                place,
                worth: self.worth(old),
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
            cheaper: (self.field.ranked_at - self.price).max(0.0),
            gaps,
        };
        for near in self.field.near::<AFTER>(self.nodes[at]) {
            let place = self.position[near.node as usize];
            if place != OUT {
                let [a, b] = if AFTER {
                    [at, place as usize]
                } else {
                    [place as usize, at]
                };
                self.join([a, b], near.leg, self.worth(near.leg) > least, best);
            } else {
                let mut chain = [0; CHAIN];
                chain[0] = near.node;
                self.prolong::<AFTER>(&mut chain, 1, near.leg, &gaps, best);
            }
        }
    }

    /// Leads a chain of new nodes, whose legs add up to `new`, back to the route, or on to more.
    fn prolong<const AFTER: bool>(
        &self,
        chain: &mut [u32; CHAIN],
        count: usize,
        new: ProfitTime,
        gaps: &Gaps<'_>,
        best: &mut Best,
    ) {
        self.close::<AFTER>(chain, count, new, gaps, best);
        if count == CHAIN {
            return;
        }
        for near in self
            .field
            .near::<AFTER>(chain[count - 1])
            .iter()
            .take(BREADTH)
        {
            if self.position[near.node as usize] == OUT && !chain[..count].contains(&near.node) {
                chain[count] = near.node;
                self.prolong::<AFTER>(chain, count + 1, new + near.leg, gaps, best);
            }
        }
    }

    /// Leads a chain of new nodes back to the route over the gap where that gains most.
    fn close<const AFTER: bool>(
        &self,
        chain: &[u32; CHAIN],
        count: usize,
        new: ProfitTime,
        gaps: &Gaps<'_>,
        best: &mut Best,
    ) {
        let last = chain[count - 1];
        let worth = self.worth(new);
        let reach = self.field.reach::<AFTER>(last);
        let left_s = gaps.room_s - new.time_s;
        let most = worth + reach.worth + gaps.cheaper * left_s - gaps.low;
        if left_s < reach.time_s || most <= best.gain {
            return;
        }
        for gap in gaps.gaps {
            let left_s = gap.room_s - new.time_s;
            let leg = self.field.leg::<AFTER>(last, self.nodes[gap.place]);
            let gain = worth + self.worth(leg) - gap.worth;
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

    /// Brings two visited nodes together by a new leg: cuts out what lies between or, where `pays`,
    /// moves or reverses stretches.
    fn join(&self, [a, b]: [usize; 2], new: ProfitTime, pays: bool, best: &mut Best) {
        let end = self.nodes.len() - 1;
        if b == a + 1 || b == a {
            return;
        }
        if b > a && b - a <= 1 + CUT {
            let cut = Move::Splice {
                from: a,
                to: b,
                new: [0; CHAIN],
                count: 0,
            };
            self.offer(new, self.stretch(a, b), cut, best);
        }
        if !pays {
            return;
        }
        const STRAIGHT: [bool; 2] = [false, false];
        if b > a {
            // The block that begins at b comes first.
            for last in b..end.min(b + BLOCK) {
                self.exchange([a, b - 1, last], STRAIGHT, best);
            }
            // The block that ends at a goes before b.
            for first in a.saturating_sub(BLOCK)..a {
                self.exchange([first, a, b - 1], STRAIGHT, best);
            }
        } else if b > 0 && a < end {
            // What ends at a comes before what begins at b; one of the two is short.
            let late = (b + BLOCK).max(a.saturating_sub(BLOCK));
            for middle in (b..a.min(b + BLOCK)).chain(late..a) {
                self.exchange([b - 1, middle, a], STRAIGHT, best);
            }
        }
        if !self.field.symmetric {
            return;
        }
        if b > a && b < end {
            self.reverse(a, b, best);
        }
        if b > a && a > 0 {
            self.reverse(a - 1, b - 1, best);
        }
        let (low, high) = (a.min(b), a.max(b));
        // The stretch that ends at `high` comes, reversed, right after `low`.
        if high < end {
            for middle in high.saturating_sub(BLOCK).max(low + 1)..high {
                self.exchange([low, middle, high], [false, true], best);
            }
        }
        // The stretch that begins at `low` goes, reversed, right before `high`.
        if low > 0 {
            for middle in low..(high - 1).min(low + BLOCK) {
                self.exchange([low - 1, middle, high - 1], [true, false], best);
            }
        }
    }

    fn exchange(&self, [first, middle, last]: [usize; 3], turned: [bool; 2], best: &mut Best) {
        let nodes = self.nodes;
        let ends = |begin: usize, end: usize, turned: bool| {
            if turned {
                (nodes[end], nodes[begin])
            } else {
                (nodes[begin], nodes[end])
            }
        };
        let one = ends(first + 1, middle, turned[0]);
        let two = ends(middle + 1, last, turned[1]);
        let new = self.field.arc(nodes[first], two.0)
            + self.field.arc(two.1, one.0)
            + self.field.arc(one.1, nodes[last + 1]);
        let old = self.stretch(first, first + 1)
            + self.stretch(middle, middle + 1)
            + self.stretch(last, last + 1);
        let exchange = Move::Exchange {
            first,
            middle,
            last,
            turned,
        };
        self.offer(new, old, exchange, best);
    }

    fn reverse(&self, first: usize, last: usize, best: &mut Best) {
        if last <= first + 1 {
            return;
        }
        let nodes = self.nodes;
        let new = self.field.arc(nodes[first], nodes[last])
            + self.field.arc(nodes[first + 1], nodes[last + 1]);
        let old = self.stretch(first, first + 1) + self.stretch(last, last + 1);
        self.offer(new, old, Move::Reverse { first, last }, best);
    }
}
