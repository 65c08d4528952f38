//! The linear relaxation: its rows, the links that are its columns, and its bound.

use crate::cut::Cut;
use crate::digraph::Digraph;
use crate::incumbent::Incumbent;
use crate::links::{Directions, Links};
use crate::multipliers::{Multipliers, Scope};
use crate::program::{Program, VariableId};
use crate::support::LEAST_VIOLATION;
use auv_planning::Deadline;

/// Removed cuts that are kept.
const MOST_REMOVED: usize = 4_000;
/// Links that a node gets before the first solution.
const FIRST_LINKS: usize = 8;

/// `max w x` over links `x` from 0 to 1: in time, one link at start and destination, at most two at every other
/// node, as many arrivals as departures, and what cuts say.
pub(crate) struct Relaxation {
    pub(crate) program: Program,
    pub(crate) links: Links,
    pub(crate) nodes: usize,
    pub(crate) ends: (usize, usize),
    limit_s: f64,
    /// A typical leg's time: the unit of the row of time.
    unit_s: f64,
    /// Largest relative change of a cost that makes ties rare.
    change: f64,
    /// The variable of each link that is a column.
    column: Vec<Option<VariableId>>,
    /// The links that are columns.
    columns: Vec<u32>,
    /// The links that may belong to a better route, ascending.
    pub(crate) open: Vec<u32>,
    /// Inequalities of the last rows.
    cuts: Vec<Cut>,
    /// Those that were rows before: other solutions may violate them again. The latest are last.
    removed: Vec<Cut>,
}

impl Relaxation {
    /// Columns are the links of the best known route and those of most weight less `per_second` times their
    /// time at each node. `None` if the deadline passes.
    pub(crate) fn new(
        graph: &Digraph,
        incumbent: &Incumbent<'_>,
        per_second: f64,
        deadline: Deadline<'_>,
    ) -> Option<Self> {
        let links = Links::new(graph);
        let limit_s = incumbent.problem.time_available_s;
        let mut relaxation = Self {
            program: Program::default(),
            nodes: graph.num_nodes(),
            ends: (graph.start, graph.destination),
            limit_s,
            unit_s: (limit_s / graph.most_arcs(limit_s) as f64).max(1e-9),
            // In all less than the least difference of two weights.
            change: (0.1 * incumbent.gain / incumbent.bound.max(1e-9)).min(1e-6),
            column: vec![None; links.all.len()],
            columns: Vec::new(),
            open: (0..links.all.len() as u32).collect(),
            links,
            cuts: Vec::new(),
            removed: Vec::new(),
        };
        relaxation.add_first_rows();
        for link in relaxation.first_links(graph, incumbent, per_second, deadline)? {
            relaxation.add_column(link);
        }
        Some(relaxation)
    }

    fn is_end(&self, v: usize) -> bool {
        v == self.ends.0 || v == self.ends.1
    }

    fn add_first_rows(&mut self) {
        for v in 0..self.nodes {
            let (right, slack) = if self.is_end(v) {
                (1.0, 0.0)
            } else {
                (2.0, 2.0)
            };
            self.program.add_row(&[], right, slack);
        }
        let time = self.limit_s / self.unit_s;
        self.program.add_row(&[], time, time);
        if self.links.directions == Directions::Apart {
            (0..self.nodes).for_each(|_| self.program.add_row(&[], 0.0, 0.0));
        }
    }

    fn first_links(
        &self,
        graph: &Digraph,
        incumbent: &Incumbent<'_>,
        per_second: f64,
        deadline: Deadline<'_>,
    ) -> Option<Vec<u32>> {
        let mut at_node = vec![Vec::new(); self.nodes];
        for (i, link) in (0..).zip(&self.links.all) {
            let reduced = link.weight - per_second * link.time_s;
            at_node[link.ends.0].push((reduced, i));
            at_node[link.ends.1].push((reduced, i));
        }
        let mut first = Vec::new();
        for (tail, head) in incumbent.route.legs() {
            let mut arcs = graph.arcs_from(tail.index());
            let arc = arcs.find(|&arc| graph.head[arc] == head.index());
            first.extend(arc.map(|arc| self.links.of_arc[arc]));
        }
        for mut of_node in at_node {
            if deadline.passed() {
                return None;
            }
            of_node.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
            first.extend(of_node.iter().take(FIRST_LINKS).map(|&(_, link)| link));
        }
        first.sort_unstable();
        first.dedup();
        Some(first)
    }

    /// Rows before those of cuts.
    fn first_cut_row(&self) -> usize {
        self.program.num_rows() - self.cuts.len()
    }

    /// The variable of a link, if it is a column.
    pub(crate) fn variable(&self, link: u32) -> Option<VariableId> {
        self.column[link as usize]
    }

    /// Makes a link a column, if it is none.
    pub(crate) fn add_column(&mut self, index: u32) {
        if self.variable(index).is_some() {
            return;
        }
        let link = &self.links.all[index as usize];
        let (u, v) = link.ends;
        let time = link.time_s / self.unit_s;
        let mut column = vec![(u as u32, 1.0), (v as u32, 1.0), (self.nodes as u32, time)];
        if self.links.directions == Directions::Apart {
            let balanced = [(u, 1.0), (v, -1.0)]
                .into_iter()
                .filter(|&(node, _)| !self.is_end(node));
            column.extend(balanced.map(|(node, entry)| ((self.nodes + 1 + node) as u32, entry)));
        }
        let of_cuts = (self.first_cut_row() as u32..).zip(&self.cuts);
        let of_cuts = of_cuts.map(|(row, cut)| (row, cut.coefficient(link.ends)));
        column.extend(of_cuts.filter(|&(_, entry)| entry != 0.0));
        // Different for each link, and not in the bound.
        let change = u64::from(index).wrapping_mul(0x9E37_79B9_7F4A_7C15) >> 40;
        let cost = link.weight * (1.0 + self.change * change as f64 / f64::from(1 << 24));
        self.column[index as usize] = Some(self.program.add_variable(cost, column));
        self.columns.push(index);
    }

    pub(crate) fn add_cut(&mut self, cut: Cut) {
        let entry = |&link: &u32| {
            let entry = cut.coefficient(self.links.all[link as usize].ends);
            self.variable(link).map(|id| (id, entry))
        };
        let entries = self.columns.iter().filter_map(entry);
        let entries: Vec<_> = entries.filter(|&(_, entry)| entry != 0.0).collect();
        let right = cut.right();
        self.program
            .add_row(&entries, right, right + cut.most_crossings());
        self.cuts.push(cut);
    }

    /// Removes the cuts whose slack is in the basis: they do not hold the present solution.
    pub(crate) fn remove_slack_cuts(&mut self) {
        let first = self.first_cut_row();
        let is_tight = |row: usize| !self.program.has_basic_slack(row);
        let rows = 0..self.program.num_rows();
        let keep: Vec<_> = rows.map(|row| row < first || is_tight(row)).collect();
        let new_id = self.program.remove_rows(&keep);
        self.rename(&new_id);
        let cuts = std::mem::take(&mut self.cuts);
        for (cut, &is_kept) in cuts.into_iter().zip(&keep[first..]) {
            if is_kept {
                self.cuts.push(cut);
            } else {
                self.removed.push(cut);
            }
        }
        let surplus = self.removed.len().saturating_sub(MOST_REMOVED);
        self.removed.drain(..surplus);
    }

    /// Removes the columns of closed links.
    pub(crate) fn remove_closed_columns(&mut self) {
        let new_id = self.program.remove_idle();
        self.rename(&new_id);
    }

    /// Gives columns the new ids of their variables; those without are columns no longer.
    fn rename(&mut self, new_id: &[Option<VariableId>]) {
        let column = &mut self.column;
        self.columns.retain(|&link| {
            let column = &mut column[link as usize];
            *column = column.and_then(|id| new_id[id]);
            column.is_some()
        });
    }

    /// Takes those of the removed cuts that a solution violates most, at most `most`.
    pub(crate) fn take_violated(&mut self, solution: &[(u32, f64)], most: usize) -> Vec<Cut> {
        let ends = |link: u32| self.links.all[link as usize].ends;
        let links: Vec<_> = solution
            .iter()
            .map(|&(link, value)| (ends(link), value))
            .collect();
        let violation = |cut: &Cut| {
            let terms = links
                .iter()
                .map(|&(ends, value)| value * cut.coefficient(ends));
            terms.sum::<f64>() - cut.right()
        };
        let all = self.removed.iter().map(violation).enumerate();
        let mut violated: Vec<_> = all.filter(|cut| cut.1 > LEAST_VIOLATION).collect();
        violated.sort_by(|a, b| b.1.total_cmp(&a.1).then(a.0.cmp(&b.0)));
        violated.truncate(most);
        let mut places: Vec<_> = violated.into_iter().map(|(at, _)| at).collect();
        places.sort_unstable();
        // From the last on, so that the places before stay what they are.
        let places = places.into_iter().rev();
        places.map(|at| self.removed.remove(at)).collect()
    }

    pub(crate) fn set_bounds(&mut self, link: u32, bounds: (f64, f64)) {
        if let Some(id) = self.variable(link) {
            self.program.set_bounds(id, bounds);
        }
    }

    /// Gives multipliers of rows their names.
    pub(crate) fn named(&self, of_rows: &[f64]) -> Multipliers {
        let balance = |v| {
            if self.is_end(v) {
                0.0
            } else {
                of_rows[self.nodes + 1 + v]
            }
        };
        let balance = match self.links.directions {
            Directions::Alike => Vec::new(),
            Directions::Apart => (0..self.nodes).map(balance).collect(),
        };
        let of_cuts = of_rows[self.first_cut_row()..]
            .iter()
            .copied()
            .zip(&self.cuts);
        let cuts: Vec<_> = of_cuts.filter(|(value, _)| value.abs() > 1e-9).collect();
        let per_second = of_rows[self.nodes] / self.unit_s;
        Multipliers::new(per_second, of_rows[..self.nodes].to_vec(), balance, &cuts)
    }

    /// The reduced weights of links.
    pub(crate) fn priced(
        &self,
        multipliers: &Multipliers,
        links: impl Iterator<Item = u32>,
    ) -> Vec<(u32, f64)> {
        let reduced = |link| (link, multipliers.reduced(&self.links.all[link as usize]));
        links.map(reduced).collect()
    }

    /// The routes that visit some nodes and use some links.
    pub(crate) fn scope<'a>(&self, visited: &'a [usize], used: &'a [u32]) -> Scope<'a> {
        Scope {
            ends: self.ends,
            limit_s: self.limit_s,
            visited,
            used,
        }
    }

    /// The links of the present solution.
    pub(crate) fn solution(&self) -> Vec<(u32, f64)> {
        let value = |&link: &u32| Some((link, self.program.value_of(self.variable(link)?)));
        let values = self.columns.iter().filter_map(value);
        values.filter(|&(_, value)| value > 1e-6).collect()
    }

    /// The open links at a node.
    pub(crate) fn links_at(&self, v: usize) -> impl Iterator<Item = u32> + '_ {
        let is_at = move |link: &u32| {
            let (a, b) = self.links.all[*link as usize].ends;
            a == v || b == v
        };
        self.open.iter().copied().filter(is_at)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cut::Kind;
    use crate::testing::digraph;
    use auv_graph::{NodeId, Route};
    use auv_planning::{Budget, RouteProblem, Run};
    use auv_types::Seed;

    #[test]
    fn removed_cuts_come_back_once_they_are_violated() {
        let graph = digraph(8, 50, 3, 9_000.0);
        let instance = auv_graph::Terrain::paper(8, 20).draw(Seed(3)).unwrap();
        let ends = (NodeId(0), NodeId(7));
        let problem = RouteProblem::new(&instance.network, ends.0, ends.1, 9_000.0);
        let incumbent = Incumbent::new(&problem, Route::new(vec![ends.0, ends.1]), 0.0);
        let run = Run::new(Seed(0), Budget::to_the_cap());
        let mut relaxation = Relaxation::new(&graph, &incumbent, 0.0, run.deadline()).unwrap();
        let inner = |&link: &u32| {
            let (u, v) = relaxation.links.all[link as usize].ends;
            !relaxation.is_end(u) && !relaxation.is_end(v)
        };
        let link = relaxation.open.iter().copied().find(inner).unwrap();
        let (u, v) = relaxation.links.all[link as usize].ends;
        // No link crosses its rim, but one touches its node.
        let cut = Cut::new(8, &[u, v], Kind::Node(u));
        relaxation.add_cut(cut.clone());
        // Its slack is in the basis until the program is solved.
        relaxation.remove_slack_cuts();
        assert!(relaxation.cuts.is_empty());
        assert_eq!(relaxation.take_violated(&[], 5), []);
        assert_eq!(relaxation.take_violated(&[(link, 1.0)], 5), [cut]);
        assert_eq!(relaxation.take_violated(&[(link, 1.0)], 5), []);
    }
}
