//! Why a task is not done.

use super::earliest::earliest_arrivals;
use super::timed_network::TimedNetwork;
use crate::{RouteProblem, Schedule};
use auv_graph::TimeModel;
use std::fmt;

/// Why a route leaves a task out.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize),
    serde(rename_all = "snake_case")
)]
pub enum LeftOut {
    /// No edges lead to its place and on to a destination.
    NoWay,
    /// Its windows close before the vehicle can be there.
    Window,
    /// A task that it comes after, or the rest of its chain, is left out.
    Order,
    /// The time available does not allow it beside the tasks that are done.
    Time,
    /// It is in time, but tasks of more weight would be left out for it.
    Weight,
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::NoWay => "no way leads there and on",
            Self::Window => "its windows close too early",
            Self::Order => "what it comes after or with is left out",
            Self::Time => "no time is left for it",
            Self::Weight => "more weight would be left out for it",
        })
    }
}

/// The tasks that a route does not do, each with the reason.
#[must_use]
pub fn left_out(
    problem: &RouteProblem<'_>,
    model: &TimeModel,
    schedule: &Schedule,
) -> Vec<(usize, LeftOut)> {
    let tables = TimedNetwork::new(problem, model);
    let mut is_done = vec![false; model.tasks.len()];
    for done in &schedule.done {
        is_done[done.task] = true;
    }
    let arrival_s = arrivals(&tables);
    let begin_s = begins(&tables, &arrival_s);
    let leads_on = leads_on(&tables);
    let why = |task: usize| {
        let work = &tables.works[task];
        let leads_on = work.ends.iter().any(|&node| leads_on[node as usize]);
        if arrival_s[task] == f64::INFINITY || !leads_on {
            return LeftOut::NoWay;
        }
        if tables.ready_s(task as u32, begin_s[task]) == f64::INFINITY {
            return LeftOut::Window;
        }
        let mut after = model.tasks[task].after.iter();
        if after.any(|&other| !is_done[other]) {
            return LeftOut::Order;
        }
        LeftOut::Time
    };
    let tasks = (0..is_done.len()).filter(|&task| !is_done[task]);
    tasks.map(|task| (task, why(task))).collect()
}

/// By task: the earliest arrival where it is done, seconds.
fn arrivals(tables: &TimedNetwork<'_>) -> Vec<f64> {
    let earliest_s = earliest_arrivals(tables, tables.problem.start.0, 0.0);
    let arrival_s = |task: usize| {
        let work = &tables.works[task];
        let [a, b] = work.ends;
        let [a_s, b_s] = work.ends.map(|node| earliest_s[node as usize]);
        if work.is_on_edge {
            tables.arrival_s(a, b, a_s).min(tables.arrival_s(b, a, b_s))
        } else {
            a_s
        }
    };
    (0..tables.model.tasks.len()).map(arrival_s).collect()
}

/// By task: when it can begin at the earliest, after the tasks that it comes after, without the way between them.
fn begins(tables: &TimedNetwork<'_>, arrival_s: &[f64]) -> Vec<f64> {
    let mut begin_s = arrival_s.to_vec();
    // As many passes as the longest order has tasks, at most.
    for _ in 0..begin_s.len() {
        let mut is_later = false;
        for (task, timed) in tables.model.tasks.iter().enumerate() {
            for &other in &timed.after {
                let done_s = tables.ready_s(other as u32, begin_s[other]);
                // One that cannot be done at all is left out itself.
                if done_s.is_finite() && done_s > begin_s[task] {
                    begin_s[task] = done_s;
                    is_later = true;
                }
            }
        }
        if !is_later {
            break;
        }
    }
    begin_s
}

/// The nodes from which a way leads to a destination.
fn leads_on(tables: &TimedNetwork<'_>) -> Vec<bool> {
    let mut leads_on = vec![false; tables.nodes()];
    let mut open = tables.destinations.clone();
    for &end in &open {
        leads_on[end as usize] = true;
    }
    let mut tails = vec![Vec::new(); tables.nodes()];
    for arc in tables.problem.network.arcs() {
        if tables.connects(arc.tail.0, arc.head.0) {
            tails[arc.head.index()].push(arc.tail.0);
        }
    }
    while let Some(head) = open.pop() {
        for &tail in &tails[head as usize] {
            if !std::mem::replace(&mut leads_on[tail as usize], true) {
                open.push(tail);
            }
        }
    }
    leads_on
}
