//! The usable arcs between the nodes of the search space.

use super::numbers::{END, START};
use super::profit_time::ProfitTime;
use super::reachable::ReachableNodes;
use auv_graph::NodeId;
use auv_planning::{Deadline, RouteProblem};
use std::ops::Range;

/// The arc of every pair or, in a large space, the arcs out of each node.
#[derive(Default)]
pub(super) struct ArcTable {
    nodes: usize,
    /// By `tail * nodes + head`; empty in a large space.
    pairs: Vec<ProfitTime>,
    lists: ArcLists,
}

/// Arcs by tail and ascending head.
#[derive(Default)]
struct ArcLists {
    /// The arcs out of node `i` are those from `first[i]` to `first[i + 1]`.
    first: Vec<usize>,
    heads: Vec<u32>,
    arcs: Vec<ProfitTime>,
}

impl ArcLists {
    fn range(&self, tail: u32) -> Range<usize> {
        self.first[tail as usize]..self.first[tail as usize + 1]
    }

    /// Out of line, so that a table of pairs stays quick.
    #[cold]
    #[inline(never)]
    fn arc(&self, tail: u32, head: u32) -> ProfitTime {
        let row = self.range(tail);
        let found = self.heads[row.clone()].binary_search(&head);
        found.map_or(ProfitTime::MISSING, |at| self.arcs[row.start + at])
    }
}

impl ArcTable {
    /// Most nodes of which every pair has an entry (16 bytes each).
    pub(super) const MOST_OF_PAIRS: usize = 1_502;

    /// The usable arcs between some nodes of the network. Arcs into the start and out of the destination are
    /// left out. `None` if the deadline passes first.
    pub(super) fn new(
        problem: &RouteProblem<'_>,
        reachable: &ReachableNodes,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let network = problem.network;
        let n = reachable.ids.len();
        let (heads, weights) = (network.heads(), network.weights());
        let times_s = problem.times.unwrap_or(network.times_s());
        let all_left = problem.removed.is_empty();
        let is_removed =
            |arc: usize| !all_left && problem.removed.contains(network.arcs()[arc].edge);
        let usable = |tail: u32, id: NodeId| {
            let arcs = if tail == END {
                0..0
            } else {
                network.range_from(id)
            };
            arcs.filter_map(move |arc| {
                let head = reachable.numbers[heads[arc].index()];
                let is_useful = head != ReachableNodes::NONE && head != START;
                let is_usable = is_useful && times_s[arc] < f64::INFINITY && !is_removed(arc);
                let (profit, time_s) = (weights[arc], times_s[arc]);
                is_usable.then_some((head, ProfitTime { profit, time_s }))
            })
        };
        let mut table = Self {
            nodes: n,
            ..Self::default()
        };
        if n > Self::MOST_OF_PAIRS {
            table.lists = lists(&reachable.ids, usable, deadline)?;
            return Some(table);
        }
        let pairs = &mut table.pairs;
        pairs.reserve_exact(n * n);
        for (tail, &id) in (0_u32..).zip(&reachable.ids) {
            // Row by row, since the first access to fresh memory takes longest.
            pairs.resize((tail as usize + 1) * n, ProfitTime::MISSING);
            if deadline.passed() {
                return None;
            }
            let row = &mut pairs[tail as usize * n..];
            usable(tail, id).for_each(|(head, arc)| row[head as usize] = arc);
        }
        Some(table)
    }

    /// Whether only the arcs there are are kept.
    pub(super) fn has_lists(&self) -> bool {
        !self.lists.first.is_empty()
    }

    /// The arc from one node to another; [`ProfitTime::MISSING`] if there is none.
    #[inline]
    pub(super) fn arc(&self, tail: u32, head: u32) -> ProfitTime {
        match self.pairs.get(tail as usize * self.nodes + head as usize) {
            Some(&arc) => arc,
            None => self.lists.arc(tail, head),
        }
    }

    /// The arcs from a node to all others. `room` is used where they are not in one row.
    pub(super) fn row<'a>(&'a self, tail: u32, room: &'a mut Vec<ProfitTime>) -> &'a [ProfitTime] {
        if !self.has_lists() {
            return &self.pairs[tail as usize * self.nodes..][..self.nodes];
        }
        room.clear();
        room.resize(self.nodes, ProfitTime::MISSING);
        let row = self.lists.range(tail);
        for (&head, &arc) in self.lists.heads[row.clone()]
            .iter()
            .zip(&self.lists.arcs[row])
        {
            room[head as usize] = arc;
        }
        room
    }

    /// Whether every arc between inner nodes has a reverse of equal profit and time.
    pub(super) fn is_symmetric(&self) -> bool {
        let is_alike = |i: u32, j: u32| self.arc(i, j) == self.arc(j, i);
        let mut inner = END + 1..self.nodes as u32;
        if self.has_lists() {
            let heads = |i: u32| self.lists.heads[self.lists.range(i)].iter();
            inner.all(|i| heads(i).filter(|&&j| j > END).all(|&j| is_alike(i, j)))
        } else {
            inner.all(|i| (END + 1..i).all(|j| is_alike(i, j)))
        }
    }

    /// Whether arcs join more than half of all pairs.
    pub(super) fn is_dense(&self) -> bool {
        let present = self.pairs.iter().filter(|arc| arc.time_s < f64::INFINITY);
        2 * (present.count() + self.lists.heads.len()) > self.nodes * self.nodes
    }
}

/// The arcs that `usable` gives for each node. `None` if the deadline passes.
fn lists<I: Iterator<Item = (u32, ProfitTime)>>(
    ids: &[NodeId],
    usable: impl Fn(u32, NodeId) -> I,
    deadline: Deadline<'_>,
) -> Option<ArcLists> {
    let mut lists = ArcLists {
        first: vec![0],
        ..ArcLists::default()
    };
    let mut row = Vec::new();
    for (tail, &id) in (0..).zip(ids) {
        if deadline.passed() {
            return None;
        }
        row.clear();
        row.extend(usable(tail, id));
        row.sort_unstable_by_key(|&(head, _)| head);
        lists.heads.extend(row.iter().map(|&(head, _)| head));
        lists.arcs.extend(row.iter().map(|&(_, arc)| arc));
        lists.first.push(lists.heads.len());
    }
    Some(lists)
}
