//! The difference of two tours as cycles whose edges come from both in turn.

use super::search_space::SearchSpace;
use super::tour::Tour;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// Up to two places that edges lead to from one place.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Links {
    pub(super) count: u8,
    pub(super) to: [u32; 2],
}

impl Links {
    pub(super) fn push(&mut self, place: u32) {
        self.to[self.count as usize] = place;
        self.count += 1;
    }

    /// Removes one edge to a place; returns whether there was one.
    pub(super) fn remove(&mut self, place: u32) -> bool {
        let last = self.count.wrapping_sub(1);
        if self.count > 0 && self.to[0] == place {
            self.to[0] = self.to[last as usize];
        } else if self.count < 2 || self.to[1] != place {
            return false;
        }
        self.count -= 1;
        true
    }
}

const NOWHERE: u32 = u32::MAX;

/// The cycles of one pair of tours; the memory serves the next pair.
///
/// Edges join places. In a symmetric space a place is a node. In a directed one each node has two
/// places, one for the arc out (`2 v`) and one for the arc in (`2 v + 1`), so that arcs keep their
/// direction. A node that a tour leaves out has a loop, so every place has as many edges in one tour
/// as in the other.
#[derive(Debug, Default)]
pub(super) struct AlternatingCycles {
    first: Vec<Links>,
    /// The edges of both tours that no cycle has yet.
    left: [Vec<Links>; 2],
    /// The places of all cycles; the first edge of each cycle is one of the first tour.
    cycles: Vec<u32>,
    /// Where each cycle ends.
    ends: Vec<usize>,
    walk: Vec<u32>,
    /// The index of a place in the walk, for even and odd indices; [`NOWHERE`] if it has none.
    index_in_walk: [Vec<u32>; 2],
}

impl AlternatingCycles {
    /// Splits the edges in which two tours differ into cycles; returns their number.
    pub(super) fn find(
        &mut self,
        space: &SearchSpace,
        tours: [&Tour; 2],
        random: &mut ChaCha8Rng,
    ) -> usize {
        let [mut first, mut second] = std::mem::take(&mut self.left);
        fill_edges(space, tours[0], &mut first);
        fill_edges(space, tours[1], &mut second);
        self.first.clone_from(&first);
        for place in 0..first.len() as u32 {
            for k in (0..first[place as usize].count as usize).rev() {
                let other = first[place as usize].to[k];
                if other >= place && (k < first[place as usize].count as usize) {
                    remove_common(&mut first, &mut second, place, other);
                }
            }
        }
        self.left = [first, second];
        for index in &mut self.index_in_walk {
            index.clear();
            index.resize(self.first.len(), NOWHERE);
        }
        self.cycles.clear();
        self.ends.clear();
        self.ends.push(0);
        for place in 0..self.first.len() as u32 {
            while self.left[0][place as usize].count > 0 {
                self.walk_from(place, random);
            }
        }
        self.ends.len() - 1
    }

    /// The edges of the first tour by place.
    pub(super) fn first(&self) -> &Vec<Links> {
        &self.first
    }

    /// The places of a cycle, in order. By position in this list, edges of the first tour join the
    /// entries 0 and 1, 2 and 3, and so on; edges of the second tour join 1 and 2, 3 and 4, ..., and
    /// the last entry and the first.
    pub(super) fn places(&self, cycle: usize) -> &[u32] {
        &self.cycles[self.ends[cycle]..self.ends[cycle + 1]]
    }

    /// Walks along edges of both tours in turn, taking them, and cuts off every closed alternating
    /// stretch as a cycle.
    fn walk_from(&mut self, place: u32, random: &mut ChaCha8Rng) {
        self.walk.clear();
        self.walk.push(place);
        self.index_in_walk[0][place as usize] = 0;
        loop {
            let here = self.walk[self.walk.len() - 1];
            let parity = (self.walk.len() - 1) % 2;
            let left = &mut self.left[parity];
            let links = left[here as usize];
            if links.count == 0 {
                break;
            }
            let k = if links.count == 2 {
                random.random_range(0..2_u32) as usize
            } else {
                0
            };
            let next = links.to[k];
            left[here as usize].remove(next);
            left[next as usize].remove(here);
            self.walk.push(next);
            let parity = (self.walk.len() - 1) % 2;
            let before = self.index_in_walk[parity][next as usize];
            if before == NOWHERE {
                self.index_in_walk[parity][next as usize] = (self.walk.len() - 1) as u32;
            } else {
                self.cut_cycle(before as usize);
            }
        }
        for (i, &place) in self.walk.iter().enumerate() {
            self.index_in_walk[i % 2][place as usize] = NOWHERE;
        }
    }

    /// Cuts the walk from an index on off as a cycle.
    fn cut_cycle(&mut self, from: usize) {
        let end = self.walk.len() - 1;
        // If the first edge is one of the second tour, the cycle is listed from its next place on.
        let shift = from % 2;
        self.cycles.extend_from_slice(&self.walk[from + shift..end]);
        if shift == 1 {
            self.cycles.push(self.walk[from]);
        }
        self.ends.push(self.cycles.len());
        for i in from + 1..end {
            self.index_in_walk[i % 2][self.walk[i] as usize] = NOWHERE;
        }
        self.walk.truncate(from + 1);
    }
}

/// The edges of a tour by place.
fn fill_edges(space: &SearchSpace, tour: &Tour, edges: &mut Vec<Links>) {
    let n = space.len();
    edges.clear();
    edges.resize(if space.symmetric { n } else { 2 * n }, Links::default());
    let mut connect = |tail: u32, head: u32| {
        let (a, b) = if space.symmetric {
            (tail, head)
        } else {
            (2 * tail, 2 * head + 1)
        };
        edges[a as usize].push(b);
        edges[b as usize].push(a);
    };
    let mut visited = vec![false; n];
    for pair in tour.nodes.windows(2) {
        connect(pair[0], pair[1]);
        visited[pair[0] as usize] = true;
        visited[pair[1] as usize] = true;
    }
    for node in (0..n as u32).filter(|&node| !visited[node as usize]) {
        connect(node, node);
    }
}

/// Removes an edge from both sets if both have it.
fn remove_common(first: &mut [Links], second: &mut [Links], a: u32, b: u32) {
    if second[a as usize].remove(b) {
        second[b as usize].remove(a);
        first[a as usize].remove(b);
        first[b as usize].remove(a);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, spaces};
    use auv_types::Seed;
    use std::collections::BTreeMap;

    /// How often each edge occurs.
    type Count = BTreeMap<(u32, u32), i32>;

    fn count(edges: impl Iterator<Item = (u32, u32)>) -> Count {
        let mut count = Count::new();
        for (a, b) in edges {
            *count.entry((a.min(b), a.max(b))).or_default() += 1;
        }
        count
    }

    /// The edges of a tour between places, each once.
    fn edges(space: &SearchSpace, tour: &Tour) -> Count {
        let place = |tail: u32, head: u32| match space.symmetric {
            true => (tail, head),
            false => (2 * tail, 2 * head + 1),
        };
        let legs = tour.nodes.windows(2).map(|pair| place(pair[0], pair[1]));
        let out = (0..space.len() as u32).filter(|node| !tour.nodes.contains(node));
        count(legs.chain(out.map(|node| place(node, node))))
    }

    #[test]
    fn all_cycles_exchanged_turn_the_first_tour_into_the_second() {
        for space in spaces() {
            let mut cycles = AlternatingCycles::default();
            for seed in 0..20 {
                let tours = [
                    random_tour(&space, 2 * seed),
                    random_tour(&space, 2 * seed + 1),
                ];
                let random = &mut Seed(seed).stream(0);
                let number = cycles.find(&space, [&tours[0], &tours[1]], random);
                assert!(number > 0);
                let [mut first, second] = [0, 1].map(|i| edges(&space, &tours[i]));
                for cycle in 0..number {
                    let places = cycles.places(cycle);
                    assert_eq!(places.len() % 2, 0);
                    for (i, &place) in places.iter().enumerate() {
                        let next = places[(i + 1) % places.len()];
                        let edge = (place.min(next), place.max(next));
                        *first.entry(edge).or_default() += if i % 2 == 0 { -1 } else { 1 };
                    }
                }
                first.retain(|_, &mut times| times != 0);
                assert_eq!(first, second, "seed {seed}");
            }
        }
    }

    #[test]
    fn equal_tours_have_no_cycle() {
        for space in spaces() {
            let tour = random_tour(&space, 1);
            let random = &mut Seed(0).stream(0);
            let number = AlternatingCycles::default().find(&space, [&tour, &tour], random);
            assert_eq!(number, 0);
        }
    }
}
