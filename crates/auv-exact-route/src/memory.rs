//! What relaxed walks remember (ng-routes: Baldacci, Mingozzi and Roberti 2011).

use crate::digraph::Digraph;
use auv_planning::Deadline;

/// The memory after a return to a remembered node.
pub(crate) const FORBIDDEN: u16 = u16::MAX;

/// Which nodes a walk remembers at each node, and how memories change along the arcs.
///
/// Walks are followed from the destination backwards. A memory is a set of remembered nodes, one bit
/// each. Along an arc, a walk forgets what the tail does not remember, and remembers the head if the
/// tail does. It must not return to a node that it remembers.
#[derive(Clone, Debug)]
pub(crate) struct Memory {
    pub(crate) bits: usize,
    /// The nodes remembered at each node, at most `bits`.
    pub(crate) near: Vec<Vec<usize>>,
    /// The memory at an arc's tail, by arc and memory at its head.
    carried: Vec<u16>,
}

impl Memory {
    /// Remembers at each node the nodes of `near`, at most `bits`. `None` if the deadline passes.
    pub(crate) fn new(
        graph: &Digraph,
        near: &[Vec<usize>],
        bits: usize,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let states = 1 << bits;
        let mut carried = Vec::with_capacity(graph.num_arcs() * states);
        let mut kept = Vec::with_capacity(bits);
        for tail in 0..graph.num_nodes() {
            if deadline.passed() {
                return None;
            }
            let bit_at_tail = |node| near[tail].iter().position(|&other| other == node);
            for arc in graph.arcs_from(tail) {
                let head = graph.head[arc];
                let own = bit_at_tail(head).map_or(0, |bit| 1_u16 << bit);
                let bits = near[head].iter().map(|&node| bit_at_tail(node));
                kept.clear();
                kept.extend(bits.map(|bit| bit.map_or(0, |bit| 1 << bit)));
                let returns = near[head].iter().position(|&node| node == tail);
                carried.extend((0..states).map(|memory| {
                    if returns.is_some_and(|bit| memory >> bit & 1 == 1) {
                        return FORBIDDEN;
                    }
                    let bits = (0..kept.len()).filter(|bit| memory >> bit & 1 == 1);
                    bits.fold(own, |all, bit| all | kept[bit])
                }));
            }
        }
        Some(Self {
            bits,
            near: near.to_vec(),
            carried,
        })
    }

    /// Number of memories at a node.
    pub(crate) fn states(&self) -> usize {
        1 << self.bits
    }

    /// The memories at an arc's tail by the memory at its head, or [`FORBIDDEN`].
    pub(crate) fn carried(&self, arc: usize) -> &[u16] {
        &self.carried[arc * self.states()..][..self.states()]
    }
}

/// Chooses the nodes to remember at each node, at most `bits`: first those of `near`, remembered
/// before, so that bounds never get worse; then those in whose cycles the node occurred most often
/// (`cycles`, by node and remembered node); then those with the most reduced weight there and back.
/// `None` if the deadline passes.
pub(crate) fn choose_memory(
    graph: &Digraph,
    (reduced, cycles): (&[f64], &[f64]),
    mut near: Vec<Vec<usize>>,
    bits: usize,
    deadline: Deadline<'_>,
) -> Option<Vec<Vec<usize>>> {
    let n = graph.num_nodes();
    let mut there = vec![f64::NEG_INFINITY; n * n];
    for (tail, there) in there.chunks_exact_mut(n).enumerate() {
        for arc in graph.arcs_from(tail) {
            there[graph.head[arc]] = reduced[arc];
        }
        if deadline.passed() {
            return None;
        }
    }
    for (v, near) in near.iter_mut().enumerate() {
        if deadline.passed() {
            return None;
        }
        let other = |u: &usize| ![v, graph.start, graph.destination].contains(u);
        let rank = |u: usize| {
            let both = there[v * n + u] + there[u * n + v];
            (cycles[v * n + u], both, u)
        };
        let others = (0..n).filter(|u| other(u) && !near.contains(u));
        let mut others: Vec<_> = others.map(rank).collect();
        let order = |a: &(f64, f64, usize), b: &(f64, f64, usize)| {
            let less = b.0.total_cmp(&a.0).then(b.1.total_cmp(&a.1));
            less.then(a.2.cmp(&b.2))
        };
        let wanted = bits.saturating_sub(near.len());
        if wanted < others.len() {
            others.select_nth_unstable_by(wanted, order);
            others.truncate(wanted);
        }
        others.sort_unstable_by(order);
        near.extend(others.iter().map(|&(.., u)| u));
        near.truncate(bits);
    }
    Some(near)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::digraph;
    use std::collections::BTreeSet;

    #[test]
    fn memories_along_an_arc_are_those_of_sets() {
        let graph = digraph(8, 50, 1, 25_000.0);
        let near: Vec<Vec<usize>> = (0..8)
            .map(|v| {
                (1..7)
                    .filter(|&u| u != v && (u + v) % 3 != 0)
                    .take(3)
                    .collect()
            })
            .collect();
        let memory = Memory::new(&graph, &near, 3, Deadline::default()).unwrap();
        let set = |node: usize, bits: usize| -> BTreeSet<usize> {
            let all = near[node].iter().enumerate();
            all.filter(|(bit, _)| bits >> bit & 1 == 1)
                .map(|(_, &u)| u)
                .collect()
        };
        let mut forbidden = 0;
        for tail in 0..8 {
            for arc in graph.arcs_from(tail) {
                let head = graph.head[arc];
                for at_head in 0..1_usize << near[head].len() {
                    let before = set(head, at_head);
                    let found = memory.carried(arc)[at_head];
                    if before.contains(&tail) {
                        assert_eq!(found, FORBIDDEN);
                        forbidden += 1;
                        continue;
                    }
                    let mut expected = before;
                    expected.insert(head);
                    expected.retain(|u| near[tail].contains(u));
                    assert_eq!(set(tail, found as usize), expected);
                }
            }
        }
        assert!(forbidden > 0);
    }

    #[test]
    fn what_was_remembered_stays_and_cycles_come_next() {
        let graph = digraph(6, 30, 1, 25_000.0);
        let reduced = vec![0.0; graph.num_arcs()];
        let mut cycles = vec![0.0; 36];
        cycles[2 * 6 + 4] = 3.0;
        let mut near = vec![Vec::new(); 6];
        near[2] = vec![3];
        let chosen = choose_memory(&graph, (&reduced, &cycles), near, 2, Deadline::default());
        let chosen = chosen.unwrap();
        assert_eq!(chosen[2], [3, 4]);
        for (v, near) in chosen.iter().enumerate() {
            assert_eq!(near.len(), 2);
            assert!(!near.contains(&v) && !near.contains(&0) && !near.contains(&5));
        }
    }
}
