//! Mandatory tasks that cannot be done, or not together.

use super::earliest::earliest_arrivals;
use super::timed_network::TimedNetwork;

/// The first mandatory task that cannot be done even alone, or the first pair that cannot go together in
/// either order; proven with the quickest ways between their places. `None` proves nothing.
#[must_use]
pub(super) fn conflict(tables: &TimedNetwork<'_>) -> Option<String> {
    let works = tables.works.iter().enumerate();
    let mandatory: Vec<_> = works
        .filter(|(_, work)| work.is_mandatory)
        .map(|(i, _)| i)
        .collect();
    if mandatory.is_empty() {
        return None;
    }
    let name = |task: usize| &tables.model.tasks[task].name;
    let start_s = earliest_arrivals(tables, tables.problem.start.0, 0.0);
    let first: Vec<_> = mandatory
        .iter()
        .map(|&task| ready_s(tables, task, &start_s))
        .collect();
    for (&task, &ready_s) in mandatory.iter().zip(&first) {
        let home_s = home_s(tables, task, ready_s);
        if home_s == f64::INFINITY {
            return Some(format!(
                "task {} cannot be reached within its windows",
                name(task)
            ));
        }
        let available_s = tables.problem.time_available_s;
        if home_s > available_s + auv_graph::TIME_TOLERANCE_S {
            return Some(format!(
                "task {} alone takes {home_s:.1} s of {available_s} s",
                name(task)
            ));
        }
    }
    let after = |i: usize, j: usize| {
        let (ready_i_s, there) = (first[i], mandatory[j]);
        let ends = tables.works[mandatory[i]].ends;
        let arrivals = ends.map(|node| earliest_arrivals(tables, node, ready_i_s));
        let ready = arrivals
            .iter()
            .map(|arrival_s| ready_s(tables, there, arrival_s));
        home_s(tables, there, ready.fold(f64::INFINITY, f64::min))
    };
    let most = tables.problem.time_available_s + auv_graph::TIME_TOLERANCE_S;
    for i in 0..mandatory.len().min(50) {
        for j in i + 1..mandatory.len().min(50) {
            let (first, other) = (&tables.works[mandatory[i]], &tables.works[mandatory[j]]);
            // Two tasks of one edge are done in one pass.
            if !(first.is_on_edge && other.is_on_edge && first.ends == other.ends)
                && after(i, j) > most
                && after(j, i) > most
            {
                let (a, b) = (name(mandatory[i]), name(mandatory[j]));
                return Some(format!(
                    "tasks {a} and {b} cannot go together in either order"
                ));
            }
        }
    }
    None
}

/// The earliest time when a task is ready.
fn ready_s(tables: &TimedNetwork<'_>, task: usize, arrivals_s: &[f64]) -> f64 {
    let work = &tables.works[task];
    let [a, b] = work.ends;
    let arrival_s = if work.is_on_edge {
        let there_s = tables.arrival_s(a, b, arrivals_s[a as usize]);
        there_s.min(tables.arrival_s(b, a, arrivals_s[b as usize]))
    } else {
        arrivals_s[a as usize]
    };
    if arrival_s == f64::INFINITY {
        return f64::INFINITY;
    }
    // Waiting elsewhere may still be allowed by a longer way, so that windows alone count here.
    let start_s = tables.model.tasks[task].earliest_start_s(arrival_s);
    start_s.map_or(f64::INFINITY, |start_s| start_s + work.delta_s)
}

/// The earliest end after a task.
fn home_s(tables: &TimedNetwork<'_>, task: usize, ready_s: f64) -> f64 {
    if ready_s == f64::INFINITY {
        return ready_s;
    }
    let ends = tables.works[task].ends;
    let ends_s = ends.map(|node| {
        let arrival_s = earliest_arrivals(tables, node, ready_s);
        // A way back over the edge of the way there does not do its own task again.
        let again_s = |end: u32| {
            if end == tables.problem.start.0 {
                tables.own_s(node, end)
            } else {
                0.0
            }
        };
        let ends = tables.destinations.iter();
        ends.map(|&end| arrival_s[end as usize] - again_s(end))
            .fold(f64::INFINITY, f64::min)
    });
    ends_s[0].min(ends_s[1])
}
