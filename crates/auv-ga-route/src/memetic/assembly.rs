//! Edge-assembly crossover for routes that may leave nodes out.
//!
//! A node that is not visited carries a loop to itself, so every node has as many edges in one
//! parent as in the other, and the edges in which the parents differ fall apart into cycles that
//! alternate between them. Giving the first parent the edges of one cycle makes a child that
//! differs from it in few places; circuits that come off the route are joined to it or dropped.
//! (Nagata and Kobayashi's edge assembly, extended to optional nodes.)

use super::field::{END, Field, START};
use super::tour::Tour;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// Up to two neighbours of a place.
#[derive(Clone, Copy, Debug, Default)]
struct Ends {
    count: u8,
    at: [u32; 2],
}

impl Ends {
    fn push(&mut self, place: u32) {
        self.at[self.count as usize] = place;
        self.count += 1;
    }

    fn remove(&mut self, place: u32) -> bool {
        let last = self.count.wrapping_sub(1);
        if self.count > 0 && self.at[0] == place {
            self.at[0] = self.at[last as usize];
        } else if self.count < 2 || self.at[1] != place {
            return false;
        }
        self.count -= 1;
        true
    }
}

/// Room for crossing; one for each thread.
///
/// Places are nodes in a symmetric field; else each node is two, one for the arc out (`2 v`) and
/// one for the arc in (`2 v + 1`), so that arcs keep their direction.
#[derive(Debug, Default)]
pub(crate) struct Assembly {
    first: Vec<Ends>,
    /// What is left of the first and the second parent's edges while cycles are taken out.
    left: [Vec<Ends>; 2],
    /// Cycles as places, the first edge of each being one of the first parent.
    cycles: Vec<u32>,
    ends: Vec<usize>,
    walk: Vec<u32>,
    /// Where a place occurs in the walk, by parity.
    seen: [Vec<u32>; 2],
    child: Vec<Ends>,
    visited: Vec<bool>,
    circuit: Vec<u32>,
}

const NOWHERE: u32 = u32::MAX;

impl Assembly {
    /// Takes apart the difference of two parents; returns the number of cycles.
    pub(crate) fn take_apart(
        &mut self,
        field: &Field,
        parents: [&Tour; 2],
        random: &mut ChaCha8Rng,
    ) -> usize {
        let [mut first, mut second] = std::mem::take(&mut self.left);
        edges(field, parents[0], &mut first);
        edges(field, parents[1], &mut second);
        self.first.clone_from(&first);
        for place in 0..first.len() as u32 {
            for k in (0..first[place as usize].count as usize).rev() {
                let other = first[place as usize].at[k];
                if other >= place && (k < first[place as usize].count as usize) {
                    remove_common(&mut first, &mut second, place, other);
                }
            }
        }
        self.left = [first, second];
        for seen in &mut self.seen {
            seen.clear();
            seen.resize(self.first.len(), NOWHERE);
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

    /// Walks along edges of both parents in turn, taking them, and cuts every closed alternating
    /// stretch off as a cycle.
    fn walk_from(&mut self, place: u32, random: &mut ChaCha8Rng) {
        self.walk.clear();
        self.walk.push(place);
        self.seen[0][place as usize] = 0;
        loop {
            let here = self.walk[self.walk.len() - 1];
            let parity = (self.walk.len() - 1) % 2;
            let left = &mut self.left[parity];
            let ends = left[here as usize];
            if ends.count == 0 {
                break;
            }
            let k = if ends.count == 2 {
                random.random_range(0..2_u32) as usize
            } else {
                0
            };
            let next = ends.at[k];
            left[here as usize].remove(next);
            left[next as usize].remove(here);
            self.walk.push(next);
            let parity = (self.walk.len() - 1) % 2;
            let before = self.seen[parity][next as usize];
            if before == NOWHERE {
                self.seen[parity][next as usize] = (self.walk.len() - 1) as u32;
            } else {
                self.cut_cycle(before as usize);
            }
        }
        for (i, &place) in self.walk.iter().enumerate() {
            self.seen[i % 2][place as usize] = NOWHERE;
        }
    }

    fn cut_cycle(&mut self, begin: usize) {
        let end = self.walk.len() - 1;
        // A cycle that begins with an edge of the second parent is told from its next place on.
        let shift = begin % 2;
        self.cycles
            .extend_from_slice(&self.walk[begin + shift..end]);
        if shift == 1 {
            self.cycles.push(self.walk[begin]);
        }
        self.ends.push(self.cycles.len());
        for i in begin + 1..end {
            self.seen[i % 2][self.walk[i] as usize] = NOWHERE;
        }
        self.walk.truncate(begin + 1);
    }

    /// The first parent with the edges of one cycle exchanged. `touched` receives the nodes whose
    /// edges changed. The child may take too long; it is empty when nothing sensible came out.
    pub(crate) fn assemble(
        &mut self,
        field: &Field,
        cycle: usize,
        child: &mut Tour,
        touched: &mut Vec<u32>,
    ) {
        self.child.clone_from(&self.first);
        touched.clear();
        child.nodes.clear();
        let node = |place: u32| if field.symmetric { place } else { place / 2 };
        let places = &self.cycles[self.ends[cycle]..self.ends[cycle + 1]];
        for pair in places.chunks_exact(2) {
            self.child[pair[0] as usize].remove(pair[1]);
            self.child[pair[1] as usize].remove(pair[0]);
        }
        for (i, pair) in places.chunks_exact(2).enumerate() {
            let next = places[(2 * i + 2) % places.len()];
            self.child[pair[1] as usize].push(next);
            self.child[next as usize].push(pair[1]);
        }
        touched.extend(places.iter().map(|&place| node(place)));
        self.visited.clear();
        self.visited.resize(field.len(), false);
        self.follow(field, START, &mut child.nodes);
        if child.nodes.last() != Some(&END) {
            child.nodes.clear();
            return;
        }
        self.join_circuits(field, child, touched);
        child.sum(field);
    }

    /// The nodes from one on, until the destination or a node seen before.
    fn follow(&mut self, field: &Field, from: u32, nodes: &mut Vec<u32>) {
        let (mut at, mut before) = (from, NOWHERE);
        loop {
            self.visited[at as usize] = true;
            nodes.push(at);
            if at == END {
                return;
            }
            let next = if field.symmetric {
                let ends = self.child[at as usize];
                if ends.at[0] != before || ends.count < 2 {
                    ends.at[0]
                } else {
                    ends.at[1]
                }
            } else {
                self.child[2 * at as usize].at[0] / 2
            };
            if self.visited[next as usize] {
                return;
            }
            before = at;
            at = next;
        }
    }

    /// Joins every circuit off the route to it where that keeps more than half its worth.
    fn join_circuits(&mut self, field: &Field, child: &mut Tour, touched: &mut Vec<u32>) {
        let mut circuit = std::mem::take(&mut self.circuit);
        for k in 0..touched.len() {
            let node = touched[k];
            if self.visited[node as usize] || self.is_loop(field, node) {
                continue;
            }
            circuit.clear();
            self.follow(field, node, &mut circuit);
            join(field, &circuit, child, touched);
        }
        self.circuit = circuit;
    }

    fn is_loop(&self, field: &Field, node: u32) -> bool {
        if field.symmetric {
            self.child[node as usize].at[0] == node
        } else {
            self.child[2 * node as usize].at[0] / 2 == node
        }
    }
}

/// Opens a circuit at one edge and the route at another such that the exchange costs least; leaves
/// the circuit out where that is better.
fn join(field: &Field, circuit: &[u32], child: &mut Tour, touched: &mut Vec<u32>) {
    let value = |a: u32, b: u32| {
        let arc = field.arc(a, b);
        arc.profit - field.price * arc.time_s
    };
    let whole: f64 = (0..circuit.len())
        .map(|i| value(circuit[i], circuit[(i + 1) % circuit.len()]))
        .sum();
    let mut position = vec![NOWHERE; field.len()];
    for (i, &node) in child.nodes.iter().enumerate() {
        position[node as usize] = i as u32;
    }
    let mut best = (0.0, None);
    for i in 0..circuit.len() {
        let (tail, head) = (circuit[i], circuit[(i + 1) % circuit.len()]);
        let opened = whole - value(tail, head);
        let mut offer = |at: usize, reversed: bool| {
            let (enter, leave) = if reversed { (tail, head) } else { (head, tail) };
            let (a, b) = (child.nodes[at], child.nodes[at + 1]);
            let gain = opened + value(a, enter) + value(leave, b) - value(a, b);
            if gain > best.0 {
                best = (gain, Some((i, at, reversed)));
            }
        };
        for reversed in [false, true] {
            if reversed && !field.symmetric {
                break;
            }
            let (enter, leave) = if reversed { (tail, head) } else { (head, tail) };
            for before in field.near::<false>(enter).iter().map(|near| near.node) {
                if position[before as usize] != NOWHERE && before != END {
                    offer(position[before as usize] as usize, reversed);
                }
            }
            for after in field.near::<true>(leave).iter().map(|near| near.node) {
                if position[after as usize] != NOWHERE && after != START {
                    offer(position[after as usize] as usize - 1, reversed);
                }
            }
        }
    }
    if let (_, Some((i, at, reversed))) = best {
        touched.extend([
            child.nodes[at],
            child.nodes[at + 1],
            circuit[i],
            circuit[(i + 1) % circuit.len()],
        ]);
        let turn = i + 1;
        let mut opened: Vec<u32> = circuit[turn..]
            .iter()
            .chain(&circuit[..turn])
            .copied()
            .collect();
        if reversed {
            opened.reverse();
        }
        child.nodes.splice(at + 1..at + 1, opened);
    }
}

/// The edges of a route by place; nodes left out carry a loop.
fn edges(field: &Field, tour: &Tour, out: &mut Vec<Ends>) {
    let n = field.len();
    out.clear();
    out.resize(if field.symmetric { n } else { 2 * n }, Ends::default());
    let mut connect = |tail: u32, head: u32| {
        let (a, b) = if field.symmetric {
            (tail, head)
        } else {
            (2 * tail, 2 * head + 1)
        };
        out[a as usize].push(b);
        out[b as usize].push(a);
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

/// Takes an edge out of both sets if both have it.
fn remove_common(first: &mut [Ends], second: &mut [Ends], a: u32, b: u32) {
    if second[a as usize].remove(b) {
        second[b as usize].remove(a);
        first[a as usize].remove(b);
        first[b as usize].remove(a);
    }
}
