//! The search space of the memetic algorithm: the nodes worth visiting, renumbered, with all arcs
//! between them in one table and short lists of promising neighbours.

use super::tour::Tour;
use auv_graph::{NodeId, QuickestTo};
use auv_planning::RouteProblem;
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::{Add, Sub};

/// Start and destination after renumbering.
pub(crate) const START: u32 = 0;
pub(crate) const END: u32 = 1;

/// Profit and time of an arc; a missing arc takes infinitely long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Arc {
    pub(crate) profit: f64,
    pub(crate) time_s: f64,
}

impl Add for Arc {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            profit: self.profit + other.profit,
            time_s: self.time_s + other.time_s,
        }
    }
}

impl Sub for Arc {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            profit: self.profit - other.profit,
            time_s: self.time_s - other.time_s,
        }
    }
}

const MISSING: Arc = Arc {
    profit: 0.0,
    time_s: f64::INFINITY,
};

/// Nodes on some way in time, their arcs and neighbour lists.
pub(crate) struct Field {
    /// The network's node for each of ours.
    pub(crate) ids: Vec<NodeId>,
    pub(crate) time_available_s: f64,
    /// Whether arcs between inner nodes have a twin of equal profit and time.
    pub(crate) symmetric: bool,
    /// Profit that a second is worth.
    pub(crate) price: f64,
    /// The price at which neighbours were ranked.
    pub(crate) ranked_at: f64,
    /// Quickest time to the destination and the next node on that way.
    pub(crate) home: Vec<(f64, u32)>,
    /// All arcs by `tail * nodes + head`.
    table: Vec<Arc>,
    heads: Lists,
    tails: Lists,
}

impl Field {
    /// Most nodes a field holds (16 bytes a pair); of a larger network, those least out of the way.
    const NODES: usize = 1_000;
    /// Most nodes of a small field, in which all of them can be looked at again and again.
    const SMALL: usize = 64;

    /// Tables the usable arcs; `home` are the quickest ways to the destination.
    ///
    /// Complexity: O(n^2 + m log n).
    pub(crate) fn new(problem: &RouteProblem<'_>, home: &QuickestTo) -> Self {
        let network = problem.network;
        let (ids, number) = worth_visiting(problem, home);
        let n = ids.len();
        let mut table = vec![MISSING; n * n];
        for (tail, &id) in ids.iter().enumerate() {
            for (arc_id, arc) in network.arcs_from(id) {
                let head = number[arc.head.index()];
                let is_inner = head != u32::MAX && head != START && tail != END as usize;
                let time_s = network.arc_time_s(arc_id, problem.times);
                if is_inner && time_s < f64::INFINITY && !problem.removed.contains(arc.edge) {
                    table[tail * n + head as usize] = Arc {
                        profit: arc.weight,
                        time_s,
                    };
                }
            }
        }
        let symmetric = (problem.times.is_none() && network.is_undirected())
            || (2..n).all(|i| (2..i).all(|j| table[i * n + j] == table[j * n + i]));
        let home = ids
            .iter()
            .map(|&id| {
                let next = home.way_from(id).and_then(|mut way| way.nth(1));
                let next = next.map_or(END, |next| number[next.index()]);
                (home.time_from_s(id), next)
            })
            .collect();
        Self {
            ids,
            time_available_s: problem.time_available_s,
            symmetric,
            price: 0.0,
            ranked_at: 0.0,
            home,
            table,
            heads: Lists::default(),
            tails: Lists::default(),
        }
    }

    /// A route of the network as one of the field, if the field holds all its nodes.
    pub(crate) fn tour_of(&self, nodes: &[NodeId]) -> Option<Tour> {
        let number = |id: &NodeId| self.ids.iter().position(|other| other == id);
        let numbers: Option<Vec<_>> = nodes.iter().map(|id| Some(number(id)? as u32)).collect();
        Some(Tour::new(numbers?, self))
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.ids.len()
    }

    pub(crate) fn is_small(&self) -> bool {
        self.len() <= Self::SMALL
    }

    /// The arc from a node to one after it, or to a node from one before it.
    pub(crate) fn leg<const AFTER: bool>(&self, node: u32, other: u32) -> Arc {
        if AFTER {
            self.arc(node, other)
        } else {
            self.arc(other, node)
        }
    }

    /// The most promising nodes after or before a node, best first.
    pub(crate) fn near<const AFTER: bool>(&self, node: u32) -> &[Near] {
        let lists = if AFTER { &self.heads } else { &self.tails };
        lists.of(node)
    }

    /// How far all arcs out of or into a node reach.
    pub(crate) fn reach<const AFTER: bool>(&self, node: u32) -> Reach {
        let lists = if AFTER { &self.heads } else { &self.tails };
        lists.reach[node as usize]
    }

    pub(crate) fn arc(&self, tail: u32, head: u32) -> Arc {
        self.table[tail as usize * self.ids.len() + head as usize]
    }

    /// The arc to an inner node, read where many arcs of one node are: near those from it.
    pub(crate) fn arc_to(&self, node: u32, tail: u32) -> Arc {
        if self.symmetric && tail != START {
            self.arc(node, tail)
        } else {
            self.arc(tail, node)
        }
    }

    /// Profit and time of a route.
    pub(crate) fn sum(&self, nodes: &[u32]) -> Arc {
        let legs = nodes.windows(2).map(|pair| self.arc(pair[0], pair[1]));
        legs.fold(Arc::default(), Add::add)
    }

    /// Ranks neighbours by profit less time at the price of a second; keeps `width` of them.
    ///
    /// Complexity: O(n^2).
    pub(crate) fn rank_neighbours(&mut self, width: usize) {
        let n = self.ids.len();
        self.heads = Lists::new(n, width);
        self.tails = Lists::new(n, width);
        for (tail, row) in self.table.chunks_exact(n).enumerate() {
            for (head, &leg) in row.iter().enumerate() {
                if leg.time_s < f64::INFINITY {
                    let worth = leg.profit - self.price * leg.time_s;
                    let near = |node: usize| Near {
                        node: node as u32,
                        leg,
                    };
                    self.heads.offer(tail, worth, near(head));
                    self.tails.offer(head, worth, near(tail));
                }
            }
        }
        self.ranked_at = self.price;
    }
}

/// A promising neighbour and the arc to it or from it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Near {
    pub(crate) node: u32,
    pub(crate) leg: Arc,
}

/// Bounds of all arcs out of a node, or of all into it.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Reach {
    /// Least time.
    pub(crate) time_s: f64,
    /// Greatest worth at the price at which neighbours were ranked.
    pub(crate) worth: f64,
}

/// Up to `width` neighbours of each node, best first.
#[derive(Default)]
struct Lists {
    width: usize,
    counts: Vec<u32>,
    worths: Vec<f64>,
    near: Vec<Near>,
    reach: Vec<Reach>,
}

impl Lists {
    fn new(nodes: usize, width: usize) -> Self {
        let nobody = Near {
            node: 0,
            leg: MISSING,
        };
        let nowhere = Reach {
            time_s: f64::INFINITY,
            worth: f64::NEG_INFINITY,
        };
        Self {
            width,
            counts: vec![0; nodes],
            worths: vec![f64::NEG_INFINITY; nodes * width],
            near: vec![nobody; nodes * width],
            reach: vec![nowhere; nodes],
        }
    }

    fn of(&self, node: u32) -> &[Near] {
        let begin = node as usize * self.width;
        &self.near[begin..begin + self.counts[node as usize] as usize]
    }

    /// Keeps a neighbour if it is among the best so far; of equal ones the first offered.
    fn offer(&mut self, node: usize, worth: f64, near: Near) {
        let reach = &mut self.reach[node];
        reach.time_s = reach.time_s.min(near.leg.time_s);
        reach.worth = reach.worth.max(worth);
        let (begin, end) = (node * self.width, (node + 1) * self.width);
        if worth <= self.worths[end - 1] {
            return;
        }
        let mut slot = end;
        while slot > begin && worth > self.worths[slot - 1] {
            slot -= 1;
        }
        self.worths.copy_within(slot..end - 1, slot + 1);
        self.near.copy_within(slot..end - 1, slot + 1);
        (self.worths[slot], self.near[slot]) = (worth, near);
        self.counts[node] = (self.counts[node] + 1).min(self.width as u32);
    }
}

/// The nodes that some walk visits in time, start and destination first, and their numbers.
fn worth_visiting(problem: &RouteProblem<'_>, home: &QuickestTo) -> (Vec<NodeId>, Vec<u32>) {
    let away_s = quickest_from_start(problem);
    let ends = [problem.start, problem.destination];
    let through_s = |node: NodeId| away_s[node.index()] + home.time_from_s(node);
    let mut inner: Vec<_> = (0..away_s.len() as u32)
        .map(NodeId)
        // Rounding must not part a node from the quickest way it lies on.
        .filter(|&node| through_s(node) * (1.0 - 1e-12) <= problem.time_available_s)
        .filter(|node| !ends.contains(node))
        .collect();
    if inner.len() > Field::NODES {
        inner.sort_by(|&a, &b| {
            let order = through_s(a).total_cmp(&through_s(b));
            order.then(home.time_from_s(a).total_cmp(&home.time_from_s(b)))
        });
        inner.truncate(Field::NODES);
        inner.sort_unstable();
    }
    let ids: Vec<_> = ends.into_iter().chain(inner).collect();
    let mut number = vec![u32::MAX; away_s.len()];
    for (i, id) in ids.iter().enumerate() {
        number[id.index()] = i as u32;
    }
    (ids, number)
}

/// Dijkstra from the start over the usable arcs.
fn quickest_from_start(problem: &RouteProblem<'_>) -> Vec<f64> {
    let network = problem.network;
    let mut time_s = vec![f64::INFINITY; network.num_nodes()];
    // Times are not negative: their bits order as they do.
    let mut heap = BinaryHeap::from([Reverse((0_u64, problem.start))]);
    time_s[problem.start.index()] = 0.0;
    while let Some(Reverse((bits, node))) = heap.pop() {
        let here_s = f64::from_bits(bits);
        if here_s > time_s[node.index()] {
            continue;
        }
        for (id, arc) in network.arcs_from(node) {
            let there_s = here_s + network.arc_time_s(id, problem.times);
            if there_s < time_s[arc.head.index()] && !problem.removed.contains(arc.edge) {
                time_s[arc.head.index()] = there_s;
                heap.push(Reverse((there_s.to_bits(), arc.head)));
            }
        }
    }
    time_s
}
