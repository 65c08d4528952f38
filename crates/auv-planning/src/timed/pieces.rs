//! What can be inserted into a tour as one.

use super::timed_network::{NO_TASK, Step, TimedNetwork, TimedWork};

/// Steps that are inserted together.
#[derive(Clone, Debug, PartialEq)]
pub struct Piece {
    /// The steps.
    pub steps: Vec<Step>,
    /// Weight of its tasks; edges' own weights depend on the place.
    pub weight: f64,
    /// Whether one of its tasks is mandatory.
    pub is_mandatory: bool,
}

impl Piece {
    fn new(tables: &TimedNetwork<'_>, steps: Vec<Step>) -> Self {
        let works = || steps.iter().filter(|step| step.works());
        Self {
            weight: works()
                .map(|step| tables.works[step.task as usize].weight)
                .sum(),
            is_mandatory: works().any(|step| tables.works[step.task as usize].is_mandatory),
            steps,
        }
    }
}

/// All pieces of a problem: each task alone (on an edge in both directions, and with the node before it),
/// each node without task if it may be passed, each chain in both orders, corridors of the network.
#[must_use]
pub fn pieces(tables: &TimedNetwork<'_>) -> Vec<Piece> {
    let mut pieces = Vec::new();
    let mut add = |steps: Vec<Step>| pieces.push(Piece::new(tables, steps));
    for (task, work) in tables.works.iter().enumerate() {
        let task = task as u32;
        if tables.model.tasks[task as usize]
            .chain
            .is_some_and(|chain| {
                !tables.model.chains[chain].may_split && tables.model.chain_tasks(chain).count() > 1
            })
        {
            continue;
        }
        for (from, to) in directions(tables, work) {
            let node = to;
            add(vec![Step { node, task }]);
            if work.is_on_edge {
                add(vec![Step::pass(from), Step { node, task }]);
            }
        }
    }
    let has_reasons = tables.has_own_weights || tables.has_profiles() || tables.has_rules;
    let is_plain = tables.passing_works() || !has_reasons;
    for node in (0..tables.nodes() as u32).filter(|_| !is_plain) {
        add(vec![Step::pass(node)]);
    }
    for chain in 0..tables.model.chains.len() {
        let mut tasks: Vec<_> = tables.model.chain_tasks(chain).map(|t| t as u32).collect();
        for _ in 0..2 {
            for steps in chain_ways(tables, &tasks) {
                add(steps);
            }
            tasks.reverse();
        }
    }
    for task in 0..tables.works.len() {
        let mut together = Vec::new();
        with_those_before(tables, task, &mut together);
        if together.len() > 1 {
            let ways = chain_ways(tables, &together);
            pieces.extend(ways.into_iter().map(|steps| Piece::new(tables, steps)));
        }
    }
    pieces.extend(corridors(tables));
    pieces
}

/// A task behind all those that it comes after.
fn with_those_before(tables: &TimedNetwork<'_>, task: usize, together: &mut Vec<u32>) {
    if together.len() < 20 && !together.contains(&(task as u32)) {
        for &before in &tables.model.tasks[task].after {
            with_those_before(tables, before, together);
        }
        together.push(task as u32);
    }
}

/// The corridors of the network in both directions, each with and without its ends: ways of at least three
/// nodes whose inner nodes have two neighbours each.
#[must_use]
pub fn corridors(tables: &TimedNetwork<'_>) -> Vec<Piece> {
    let mut pieces = Vec::new();
    if tables.passing_works() {
        return pieces;
    }
    for way in corridor_ways(tables) {
        let last = way.len();
        for part in [&way[..], &way[1..], &way[..last - 1], &way[1..last - 1]] {
            let steps: Vec<_> = part.iter().copied().map(Step::pass).collect();
            let back = steps.iter().rev().copied().collect();
            pieces.extend([steps, back].map(|steps| Piece::new(tables, steps)));
        }
    }
    pieces
}

/// The usable directions of a task: node before and node where it is done.
fn directions(tables: &TimedNetwork<'_>, work: &TimedWork) -> Vec<(u32, u32)> {
    let [a, b] = work.ends;
    if !work.is_on_edge {
        return vec![(a, a)];
    }
    let both = [(a, b), (b, a)].into_iter();
    both.filter(|&(from, to)| work.is_along(from, to) && tables.connects(from, to))
        .collect()
}

/// The ways through the tasks of a chain in this order: for each direction of the first task the quickest
/// one, with and without the node before it.
fn chain_ways(tables: &TimedNetwork<'_>, tasks: &[u32]) -> Vec<Vec<Step>> {
    let Some((&first, rest)) = tasks.split_first() else {
        return Vec::new();
    };
    let mut found = Vec::new();
    let ends = |task: u32| directions(tables, &tables.works[task as usize]);
    for (from, node) in ends(first) {
        let mut best: Vec<(f64, Vec<Step>)> =
            vec![(0.0, vec![Step::pass(from), Step { node, task: first }])];
        for &task in rest {
            let mut next: Vec<(f64, Vec<Step>)> = Vec::new();
            for (from, node) in ends(task) {
                let ways = best.iter().filter_map(|(time_s, steps)| {
                    let mut steps = steps.clone();
                    if is_on_last_edge(tables, &steps, task) {
                        steps.push(Step {
                            node: steps.last()?.node,
                            task,
                        });
                        return Some((*time_s, steps));
                    }
                    let link_s = link(tables, &mut steps, from)?;
                    let line_s = tables.least_s(from, node) * f64::from(u8::from(from != node));
                    steps.push(Step { node, task });
                    Some((time_s + link_s + line_s, steps))
                });
                next.extend(ways.min_by(|a, b| a.0.total_cmp(&b.0)));
            }
            best = next;
        }
        for (_, steps) in best {
            let skips_first =
                steps[1].node == steps[0].node || tables.works[first as usize].is_on_edge;
            if skips_first {
                found.push(steps[1..].to_vec());
            }
            if steps[1].node != steps[0].node {
                found.push(steps);
            }
        }
    }
    found
}

/// Whether a task is on the edge over which the last step, an edge's task too, was reached.
fn is_on_last_edge(tables: &TimedNetwork<'_>, steps: &[Step], task: u32) -> bool {
    let works = |task: u32| {
        tables
            .works
            .get(task as usize)
            .filter(|work| work.is_on_edge)
    };
    let ends = |task: u32| works(task).map(|work| work.ends);
    let last = steps.last().map_or(NO_TASK, |step| step.task);
    ends(task).is_some_and(|edge| ends(last) == Some(edge))
}

/// Appends the quickest way from the last step to a node over nodes that are not on the steps; its time in
/// seconds.
fn link(tables: &TimedNetwork<'_>, steps: &mut Vec<Step>, to: u32) -> Option<f64> {
    let from = steps.last()?.node;
    if from == to {
        return Some(0.0);
    }
    if steps.iter().any(|step| step.node == to) {
        return None;
    }
    if tables.connects(from, to) {
        steps.push(Step::pass(to));
        return Some(tables.least_s(from, to));
    }
    let is_free = |node: u32| steps.iter().all(|step| step.node != node);
    // When the piece is done is not known yet: as if at the start.
    let (time_s, way) = super::earliest::quickest_way(tables, from, to, 0.0, is_free)?;
    steps.extend(way.into_iter().map(Step::pass));
    Some(time_s)
}

/// Maximal ways of at least three nodes whose inner nodes have two neighbours each, without start and
/// destinations.
fn corridor_ways(tables: &TimedNetwork<'_>) -> Vec<Vec<u32>> {
    let count = tables.nodes();
    let network = tables.problem.network;
    let mut neighbours = vec![Vec::new(); count];
    for arc in network.arcs() {
        let (tail, head) = (arc.tail.0, arc.head.0);
        if tables.connects(tail, head) {
            neighbours[tail as usize].push(head);
            neighbours[head as usize].push(tail);
        }
    }
    for list in &mut neighbours {
        list.sort_unstable();
        list.dedup();
    }
    let is_end = |node: u32| node == tables.problem.start.0 || tables.destinations.contains(&node);
    let is_inner = |node: u32| neighbours[node as usize].len() == 2 && !is_end(node);
    let mut is_used = vec![false; count];
    let mut corridors = Vec::new();
    for node in 0..count as u32 {
        if !is_inner(node) || is_used[node as usize] {
            continue;
        }
        is_used[node as usize] = true;
        let mut way = vec![node];
        for _ in 0..2 {
            while let Some(&last) = way.last() {
                let next = neighbours[last as usize].iter().find(|n| !way.contains(n));
                match next {
                    Some(&next) if !is_end(next) && (is_inner(last) || way.len() == 1) => {
                        if is_inner(last) {
                            is_used[next as usize] |= is_inner(next);
                            way.push(next);
                        } else {
                            break;
                        }
                    }
                    _ => break,
                }
            }
            way.reverse();
        }
        if way.len() >= 3 {
            corridors.push(way);
        }
    }
    corridors
}
