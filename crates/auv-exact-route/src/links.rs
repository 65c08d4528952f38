//! The arcs of a digraph as columns of a linear program.

use crate::digraph::Digraph;

/// Whether the two directions of a link are one column.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Directions {
    /// Time and weight are the same both ways: one column, and no rows that balance arrivals.
    Alike,
    /// Each direction is a column of its own.
    Apart,
}

#[derive(Clone, Copy, Debug)]
pub(crate) struct Link {
    pub(crate) ends: (usize, usize),
    pub(crate) weight: f64,
    pub(crate) time_s: f64,
}

/// The links of a digraph.
#[derive(Debug)]
pub(crate) struct Links {
    pub(crate) directions: Directions,
    pub(crate) all: Vec<Link>,
    /// The link of each arc.
    pub(crate) of_arc: Vec<u32>,
}

impl Links {
    /// Links of both directions if few arcs differ from their reverses. Those that do get the greater
    /// weight and the lesser time, which cannot make a bound too low.
    pub(crate) fn new(graph: &Digraph) -> Self {
        let reverse = reverses(graph);
        let is_between =
            |tail: usize, arc: usize| tail != graph.start && graph.head[arc] != graph.destination;
        let arcs =
            || (0..graph.num_nodes()).flat_map(|v| graph.arcs_from(v).map(move |arc| (v, arc)));
        let inner = arcs().filter(|&(tail, arc)| is_between(tail, arc)).count();
        let alike = |arc: usize, other: usize| {
            graph.weight[arc].total_cmp(&graph.weight[other]).is_eq()
                && graph.time_s[arc].total_cmp(&graph.time_s[other]).is_eq()
        };
        let is_unlike = |&(tail, arc): &(usize, usize)| {
            is_between(tail, arc) && !reverse[arc].is_some_and(|other| alike(arc, other))
        };
        let unlike = arcs().filter(is_unlike).count();
        let directions = if 20 * unlike <= inner {
            Directions::Alike
        } else {
            Directions::Apart
        };
        let mut links = Self {
            directions,
            all: Vec::new(),
            of_arc: vec![u32::MAX; graph.num_arcs()],
        };
        for (tail, arc) in arcs() {
            let other = reverse[arc].filter(|_| directions == Directions::Alike);
            if let Some(other) = other.filter(|&other| other < arc) {
                links.of_arc[arc] = links.of_arc[other];
                continue;
            }
            links.of_arc[arc] = links.all.len() as u32;
            links.all.push(Link {
                ends: (tail, graph.head[arc]),
                weight: other.map_or(graph.weight[arc], |other| {
                    graph.weight[arc].max(graph.weight[other])
                }),
                time_s: other.map_or(graph.time_s[arc], |other| {
                    graph.time_s[arc].min(graph.time_s[other])
                }),
            });
        }
        links
    }
}

/// The arc in the other direction, by arc.
fn reverses(graph: &Digraph) -> Vec<Option<usize>> {
    let mut reverse = vec![None; graph.num_arcs()];
    for tail in 0..graph.num_nodes() {
        for arc in graph.arcs_from(tail) {
            let back = graph.arcs_from(graph.head[arc]);
            // Heads ascend within the arcs of a node.
            let found = graph.head[back.clone()].binary_search(&tail);
            reverse[arc] = found.ok().map(|at| back.start + at);
        }
    }
    reverse
}
