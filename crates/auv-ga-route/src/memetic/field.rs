//! The search space of the memetic algorithm: the nodes worth visiting, renumbered, with all arcs
//! between them in one table and short lists of promising neighbours.

use super::lists::{Best, Lists, Near, Reach};
use super::tour::Tour;
use auv_graph::{NodeId, QuickestTo};
use auv_planning::{Deadline, RouteProblem};
use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::ops::{Add, Sub};

/// Start and destination after renumbering.
pub(crate) const START: u32 = 0;
pub(crate) const END: u32 = 1;

/// Profit and time of an arc; a missing arc takes infinitely long.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct ProfitTime {
    pub(crate) profit: f64,
    pub(crate) time_s: f64,
}

impl Add for ProfitTime {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        Self {
            profit: self.profit + other.profit,
            time_s: self.time_s + other.time_s,
        }
    }
}

impl Sub for ProfitTime {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        Self {
            profit: self.profit - other.profit,
            time_s: self.time_s - other.time_s,
        }
    }
}

pub(super) const MISSING: ProfitTime = ProfitTime {
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
    /// Whether most nodes are joined by arcs, so that a node can be inserted nearly anywhere.
    pub(crate) is_dense: bool,
    /// Profit that a second is worth.
    pub(crate) price: f64,
    /// The price at which neighbours were ranked.
    pub(crate) ranked_at: f64,
    /// Quickest time to the destination and the next node on that way.
    pub(crate) home: Vec<(f64, u32)>,
    /// All arcs by `tail * nodes + head`.
    table: Vec<ProfitTime>,
    heads: Lists,
    tails: Lists,
}

impl Field {
    /// Most nodes a field holds (16 bytes a pair); of a larger network, those least out of the way.
    const NODES: usize = 1_000;
    /// Most nodes of a small field, in which all of them can be looked at again and again.
    const SMALL: usize = 64;

    /// Tables the usable arcs; `home` are the quickest ways to the destination. Nothing where the
    /// deadline passes first.
    ///
    /// Complexity: O(n^2 + m log n).
    pub(crate) fn new(
        problem: &RouteProblem<'_>,
        home: &QuickestTo,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        if deadline.passed() {
            return None;
        }
        let network = problem.network;
        let (ids, number) = worth_visiting(problem, home);
        let n = ids.len();
        let (heads, weights) = (network.heads(), network.weights());
        let times_s = problem.times.unwrap_or(network.times_s());
        let is_whole = problem.removed.is_empty();
        let is_removed =
            |arc: usize| !is_whole && problem.removed.contains(network.arcs()[arc].edge);
        let mut table = Vec::with_capacity(n * n);
        for (tail, &id) in ids.iter().enumerate() {
            table.resize((tail + 1) * n, MISSING);
            let row = &mut table[tail * n..];
            if deadline.passed() {
                return None;
            }
            if tail == END as usize {
                continue;
            }
            for arc in network.range_from(id) {
                let head = number[heads[arc].index()];
                let is_ahead = head != u32::MAX && head != START;
                if is_ahead && times_s[arc] < f64::INFINITY && !is_removed(arc) {
                    row[head as usize] = ProfitTime {
                        profit: weights[arc],
                        time_s: times_s[arc],
                    };
                }
            }
        }
        let symmetric = (problem.times.is_none() && network.is_undirected())
            || (2..n).all(|i| (2..i).all(|j| table[i * n + j] == table[j * n + i]));
        let num_arcs = table.iter().filter(|arc| arc.time_s < f64::INFINITY);
        let is_dense = 2 * num_arcs.count() > n * n;
        let home = ids
            .iter()
            .map(|&id| {
                let next = home.way_from(id).and_then(|mut way| way.nth(1));
                let next = next.map_or(END, |next| number[next.index()]);
                (home.time_from_s(id), next)
            })
            .collect();
        Some(Self {
            ids,
            time_available_s: problem.time_available_s,
            symmetric,
            is_dense,
            price: 0.0,
            ranked_at: 0.0,
            home,
            table,
            heads: Lists::default(),
            tails: Lists::default(),
        })
    }

    /// A route of the network as one of the field, if the field holds all its nodes.
    pub(crate) fn tour_of(&self, nodes: &[NodeId]) -> Option<Tour> {
        let number = |id: &NodeId| self.ids.iter().position(|other| other == id);
        let numbers: Option<Vec<_>> = nodes.iter().map(|id| Some(number(id)? as u32)).collect();
        Some(Tour::new(numbers?, self))
    }

    /// The quickest route.
    pub(crate) fn quickest(&self) -> Tour {
        let mut nodes = vec![START];
        let mut at = START;
        while at != END {
            at = self.home[at as usize].1;
            nodes.push(at);
        }
        Tour::new(nodes, self)
    }

    /// Number of nodes.
    pub(crate) fn len(&self) -> usize {
        self.ids.len()
    }

    pub(crate) fn is_small(&self) -> bool {
        self.len() <= Self::SMALL
    }

    /// The arc from a node to one after it, or to a node from one before it.
    pub(crate) fn leg<const AFTER: bool>(&self, node: u32, other: u32) -> ProfitTime {
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

    pub(crate) fn arc(&self, tail: u32, head: u32) -> ProfitTime {
        self.table[tail as usize * self.ids.len() + head as usize]
    }

    /// The arc to a node, read where many arcs of one node are: near those from it.
    pub(crate) fn arc_to(&self, node: u32, tail: u32) -> ProfitTime {
        if self.symmetric && tail != START && node != END {
            self.arc(node, tail)
        } else {
            self.arc(tail, node)
        }
    }

    /// Profit and time of a route.
    pub(crate) fn sum(&self, nodes: &[u32]) -> ProfitTime {
        let legs = nodes.windows(2).map(|pair| self.arc(pair[0], pair[1]));
        legs.fold(ProfitTime::default(), Add::add)
    }

    /// Ranks neighbours by profit less time at the price of a second; keeps `width` of them. Until
    /// the deadline.
    ///
    /// Complexity: O(n^2).
    pub(crate) fn rank_neighbours(&mut self, width: usize, deadline: Deadline<'_>) {
        let nodes = START..self.len() as u32;
        let inner = END + 1..nodes.end;
        self.heads = Lists::new(nodes.len(), width);
        self.tails = Lists::new(nodes.len(), width);
        let (mut best, mut into) = (Best::new(width, self.price), Vec::new());
        for node in nodes.clone().take_while(|_| !deadline.passed()) {
            let out = &self.table[node as usize * nodes.len()..][..nodes.len()];
            best.find(END + 1, &out[inner.start as usize..]);
            self.heads.list(node, &best, END, |head| out[head as usize]);
            if !self.symmetric || !inner.contains(&node) {
                into.clear();
                into.extend(inner.clone().map(|tail| self.arc(tail, node)));
                best.find(END + 1, &into);
            }
            let (table, n) = (&self.table, nodes.len());
            let leg = |tail: u32| table[tail as usize * n + node as usize];
            self.tails.list(node, &best, START, leg);
        }
        self.ranked_at = self.price;
    }
}

/// The nodes that some walk visits in time, start and destination first, and their numbers.
fn worth_visiting(problem: &RouteProblem<'_>, home: &QuickestTo) -> (Vec<NodeId>, Vec<u32>) {
    let away_s = quickest_from_start(problem, home);
    let ends = [problem.start, problem.destination];
    let through_s = |node: NodeId| away_s[node.index()] + home.time_from_s(node);
    let mut inner: Vec<_> = (0..away_s.len() as u32)
        .map(NodeId)
        .filter(|&node| is_in_time(problem, through_s(node)))
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

/// Rounding must not part a node from the quickest way it lies on.
fn is_in_time(problem: &RouteProblem<'_>, time_s: f64) -> bool {
    time_s * (1.0 - 1e-12) <= problem.time_available_s
}

/// Dijkstra from the start over the usable arcs, to the nodes from which `home` is reached in time;
/// where none of them has to be left out, only until all are known to be among those.
fn quickest_from_start(problem: &RouteProblem<'_>, home: &QuickestTo) -> Vec<f64> {
    let network = problem.network;
    let (heads, times_s) = (network.heads(), problem.times.unwrap_or(network.times_s()));
    let is_through = |node: NodeId, time_s| is_in_time(problem, time_s + home.time_from_s(node));
    let mut away_s = vec![f64::INFINITY; network.num_nodes()];
    away_s[problem.start.index()] = 0.0;
    // Where nodes will have to be left out, it takes all times exactly.
    let mut missing = if away_s.len() > Field::NODES {
        usize::MAX
    } else {
        away_s.len() - 1
    };
    // Times are not negative: their bits order as they do.
    let mut heap = BinaryHeap::from([Reverse((0_u64, problem.start))]);
    while missing > 0
        && let Some(Reverse((bits, node))) = heap.pop()
    {
        let here_s = f64::from_bits(bits);
        if here_s > away_s[node.index()] {
            continue;
        }
        for arc in network.range_from(node) {
            let (head, there_s) = (heads[arc], here_s + times_s[arc]);
            let before_s = away_s[head.index()];
            if there_s < before_s
                && is_through(head, there_s)
                && !problem.removed.contains(network.arcs()[arc].edge)
            {
                missing -= usize::from(before_s == f64::INFINITY);
                away_s[head.index()] = there_s;
                heap.push(Reverse((there_s.to_bits(), head)));
            }
        }
    }
    away_s
}
