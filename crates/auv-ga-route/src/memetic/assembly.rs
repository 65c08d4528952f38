//! Edge-assembly crossover for routes that may leave nodes out.
//!
//! The edges in which two parents differ split into cycles whose edges come from both parents in
//! turn ([`AlternatingCycles`]). The exchange of the edges of one cycle turns the first parent into
//! a child that differs from it in few places. Circuits off the route are joined to it or left out.
//!
//! Y. Nagata and S. Kobayashi, "A powerful genetic algorithm using edge assembly crossover for the
//! traveling salesman problem", INFORMS J. Comput. 25 (2013), extended to optional nodes.

use super::alternating_cycles::{AlternatingCycles, Links};
use super::search_space::{END, START, SearchSpace};
use super::tour::Tour;
use auv_types::ChaCha8Rng;

/// The cycles of one pair of parents, and the memory to assemble children; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct Assembly {
    cycles: AlternatingCycles,
    child: Vec<Links>,
    visited: Vec<bool>,
    circuit: Vec<u32>,
}

const NOWHERE: u32 = u32::MAX;

impl Assembly {
    /// Finds the cycles of two parents; returns their number.
    pub(crate) fn find_cycles(
        &mut self,
        space: &SearchSpace,
        parents: [&Tour; 2],
        random: &mut ChaCha8Rng,
    ) -> usize {
        self.cycles.find(space, parents, random)
    }

    /// Makes the child that has the edges of one cycle exchanged. `touched` receives the nodes whose
    /// edges changed. The child may take too long; it is empty if it does not reach the destination.
    pub(crate) fn assemble(
        &mut self,
        space: &SearchSpace,
        cycle: usize,
        child: &mut Tour,
        touched: &mut Vec<u32>,
    ) {
        self.child.clone_from(self.cycles.first());
        touched.clear();
        child.nodes.clear();
        let node = |place: u32| if space.symmetric { place } else { place / 2 };
        let places = self.cycles.places(cycle);
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
        self.visited.resize(space.len(), false);
        self.follow(space, START, &mut child.nodes);
        if child.nodes.last() != Some(&END) {
            child.nodes.clear();
            return;
        }
        self.join_circuits(space, child, touched);
        child.sum(space);
    }

    /// Appends the nodes along the child's edges, from a node to the destination or to the last one
    /// before a visited node.
    fn follow(&mut self, space: &SearchSpace, from: u32, nodes: &mut Vec<u32>) {
        let (mut at, mut before) = (from, NOWHERE);
        loop {
            self.visited[at as usize] = true;
            nodes.push(at);
            if at == END {
                return;
            }
            let next = if space.symmetric {
                let links = self.child[at as usize];
                if links.to[0] != before || links.count < 2 {
                    links.to[0]
                } else {
                    links.to[1]
                }
            } else {
                self.child[2 * at as usize].to[0] / 2
            };
            if self.visited[next as usize] {
                return;
            }
            before = at;
            at = next;
        }
    }

    /// Joins every circuit off the route to it, or leaves it out where that is better.
    fn join_circuits(&mut self, space: &SearchSpace, child: &mut Tour, touched: &mut Vec<u32>) {
        let mut circuit = std::mem::take(&mut self.circuit);
        for k in 0..touched.len() {
            let node = touched[k];
            if self.visited[node as usize] || self.is_left_out(space, node) {
                continue;
            }
            circuit.clear();
            self.follow(space, node, &mut circuit);
            join(space, &circuit, child, touched);
        }
        self.circuit = circuit;
    }

    /// Whether the child has a loop at a node.
    fn is_left_out(&self, space: &SearchSpace, node: u32) -> bool {
        if space.symmetric {
            self.child[node as usize].to[0] == node
        } else {
            self.child[2 * node as usize].to[0] / 2 == node
        }
    }
}

/// A way to join a circuit: its edge from index `opened` to the next is removed, and the rest goes
/// between the route's positions `after` and `after + 1`, reversed or not.
#[derive(Clone, Copy, Debug)]
struct Join {
    opened: usize,
    after: usize,
    reversed: bool,
}

/// Joins a circuit to the route where that gains most; leaves it out if nothing gains.
fn join(space: &SearchSpace, circuit: &[u32], child: &mut Tour, touched: &mut Vec<u32>) {
    let Some(best) = best_join(space, circuit, &child.nodes) else {
        return;
    };
    let (at, first) = (best.after, best.opened + 1);
    touched.extend([
        child.nodes[at],
        child.nodes[at + 1],
        circuit[best.opened],
        circuit[first % circuit.len()],
    ]);
    let mut opened: Vec<u32> = circuit[first..]
        .iter()
        .chain(&circuit[..first])
        .copied()
        .collect();
    if best.reversed {
        opened.reverse();
    }
    child.nodes.splice(at + 1..at + 1, opened);
}

/// The join of greatest gain, over the places next to neighbours of the circuit's nodes.
fn best_join(space: &SearchSpace, circuit: &[u32], route: &[u32]) -> Option<Join> {
    let worth = |a: u32, b: u32| space.arc(a, b).worth(space.price);
    let whole: f64 = (0..circuit.len())
        .map(|i| worth(circuit[i], circuit[(i + 1) % circuit.len()]))
        .sum();
    let mut position = vec![NOWHERE; space.len()];
    for (i, &node) in route.iter().enumerate() {
        position[node as usize] = i as u32;
    }
    let mut best = (0.0, None);
    for i in 0..circuit.len() {
        let (tail, head) = (circuit[i], circuit[(i + 1) % circuit.len()]);
        let opened = whole - worth(tail, head);
        let mut offer = |at: usize, reversed: bool| {
            let (enter, leave) = if reversed { (tail, head) } else { (head, tail) };
            let (a, b) = (route[at], route[at + 1]);
            let gain = opened + worth(a, enter) + worth(leave, b) - worth(a, b);
            if gain > best.0 {
                let join = Join {
                    opened: i,
                    after: at,
                    reversed,
                };
                best = (gain, Some(join));
            }
        };
        for reversed in [false, true] {
            if reversed && !space.symmetric {
                break;
            }
            let (enter, leave) = if reversed { (tail, head) } else { (head, tail) };
            for before in space.near::<false>(enter).iter().map(|near| near.node) {
                if position[before as usize] != NOWHERE && before != END {
                    offer(position[before as usize] as usize, reversed);
                }
            }
            for after in space.near::<true>(leave).iter().map(|near| near.node) {
                if position[after as usize] != NOWHERE && after != START {
                    offer(position[after as usize] as usize - 1, reversed);
                }
            }
        }
    }
    best.1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, space, spaces};
    use auv_graph::{Terrain, Topology};
    use auv_types::Seed;

    /// All children of two parents.
    fn children(space: &SearchSpace, parents: [&[u32]; 2]) -> Vec<Vec<u32>> {
        let [first, second] = parents.map(|nodes| Tour::new(nodes.to_vec(), space));
        let mut assembly = Assembly::default();
        let number = assembly.find_cycles(space, [&first, &second], &mut Seed(0).stream(0));
        let (mut child, mut touched) = (Tour::default(), Vec::new());
        let assembled = (0..number).map(|cycle| {
            assembly.assemble(space, cycle, &mut child, &mut touched);
            child.nodes.clone()
        });
        assembled.collect()
    }

    fn complete(topology: Topology) -> SearchSpace {
        let edges = if topology == Topology::Directed {
            90
        } else {
            45
        };
        let terrain = Terrain {
            topology,
            ..Terrain::benchmark(10, edges)
        };
        space(&terrain, 1, 1e6)
    }

    #[test]
    fn one_cycle_of_hand_made_parents_gives_the_second() {
        for topology in [Topology::Undirected, Topology::Directed] {
            let space = complete(topology);
            // The second parent visits one node more: a cycle of its loop and three legs.
            let [shorter, longer] = [&[0, 2, 3, 1][..], &[0, 2, 4, 3, 1]];
            assert_eq!(children(&space, [shorter, longer]), [longer.to_vec()]);
            assert_eq!(children(&space, [longer, shorter]), [shorter.to_vec()]);
            // One node in place of another.
            let other = &[0, 2, 5, 3, 1][..];
            assert_eq!(children(&space, [longer, other]), [other.to_vec()]);
        }
    }

    #[test]
    fn cycles_in_separate_places_give_a_child_each() {
        let space = complete(Topology::Undirected);
        let first = &[0, 2, 3, 4, 5, 6, 1][..];
        let second = &[0, 7, 2, 3, 4, 5, 6, 8, 1][..];
        let mut children = children(&space, [first, second]);
        children.sort();
        assert_eq!(
            children,
            [vec![0, 2, 3, 4, 5, 6, 8, 1], vec![0, 7, 2, 3, 4, 5, 6, 1]]
        );
    }

    #[test]
    fn every_child_is_a_simple_route_with_its_sums() {
        let mut joined = 0;
        for space in spaces() {
            let mut assembly = Assembly::default();
            let (mut child, mut touched) = (Tour::default(), Vec::new());
            for seed in 0..40 {
                let parents = [
                    random_tour(&space, 2 * seed),
                    random_tour(&space, 2 * seed + 1),
                ];
                let random = &mut Seed(seed).stream(0);
                let number = assembly.find_cycles(&space, [&parents[0], &parents[1]], random);
                for cycle in 0..number {
                    assembly.assemble(&space, cycle, &mut child, &mut touched);
                    if child.nodes.is_empty() {
                        continue;
                    }
                    assert_eq!(child, Tour::new(child.nodes.clone(), &space));
                    assert_eq!((child.nodes[0], child.nodes.last()), (START, Some(&END)));
                    let mut once = child.nodes.clone();
                    once.sort_unstable();
                    once.dedup();
                    assert_eq!(once.len(), child.nodes.len());
                    let places = assembly.cycles.places(cycle);
                    joined += usize::from(touched.len() > places.len());
                    // Every leg is one of a parent, or touches a joined circuit.
                    for leg in child.nodes.windows(2) {
                        let is_of_parent = parents.iter().any(|parent| {
                            parent.nodes.windows(2).any(|other| {
                                other == leg || (space.symmetric && other == [leg[1], leg[0]])
                            })
                        });
                        assert!(is_of_parent || touched.contains(&leg[0]), "{leg:?}");
                    }
                }
            }
        }
        assert!(joined > 0, "no circuit was joined");
    }

    #[test]
    fn a_circuit_joins_where_an_enumeration_gains_most() {
        let space = {
            let mut space = complete(Topology::Undirected);
            // All neighbours: the enumeration knows no lists.
            space.rank_neighbours(9, auv_planning::Deadline::default());
            space
        };
        let worth = |nodes: &[u32]| space.sum(nodes).worth(space.price);
        let mut gains = 0;
        for (route, circuit) in [
            (&[0, 2, 3, 4, 1][..], &[5, 6, 7][..]),
            (&[0, 8, 3, 1], &[9, 2, 5, 4]),
            (&[0, 1], &[3, 6, 9]),
        ] {
            let mut expected = (worth(route), route.to_vec());
            for turn in 0..circuit.len() {
                for reversed in [false, true] {
                    let mut opened = circuit.to_vec();
                    opened.rotate_left(turn);
                    if reversed {
                        opened.reverse();
                    }
                    for at in 1..route.len() {
                        let mut nodes = route.to_vec();
                        nodes.splice(at..at, opened.iter().copied());
                        if worth(&nodes) > expected.0 + 1e-9 {
                            expected = (worth(&nodes), nodes);
                        }
                    }
                }
            }
            let mut child = Tour::new(route.to_vec(), &space);
            join(&space, circuit, &mut child, &mut Vec::new());
            assert!((worth(&child.nodes) - expected.0).abs() < 1e-9);
            gains += usize::from(child.nodes.len() > route.len());
        }
        assert!(gains > 0);
    }
}
