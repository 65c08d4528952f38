//! The tour that every planner begins with: the quickest way to a destination.

use super::earliest::{earliest_arrivals, quickest_way};
use super::timed_network::{Step, TimedNetwork};
use super::tour::TimedTour;
use crate::PlanError;

/// The quickest way from the start to a destination, over places to be met again where these are due.
pub(super) enum FirstTour {
    /// It is in time.
    Feasible(Box<TimedTour>),
    /// Its nodes take longer than the time available, or places are not met in time.
    Infeasible(Vec<u32>),
}

pub(super) fn first_tour(tables: &TimedNetwork<'_>) -> Result<FirstTour, PlanError> {
    let start = tables.problem.start.0;
    // Two steps, so that others go between.
    if tables.destinations.contains(&start)
        && let Some(tour) = TimedTour::new(tables, vec![Step::pass(start); 2])
    {
        return Ok(FirstTour::Feasible(tour.into()));
    }
    let arrival_s = earliest_arrivals(tables, start, 0.0);
    let mut ends = tables.destinations.clone();
    ends.sort_by(|&a, &b| {
        arrival_s[a as usize]
            .total_cmp(&arrival_s[b as usize])
            .then(a.cmp(&b))
    });
    let is_free = |node: u32| tables.at_node[node as usize].is_empty() || !tables.passing_works();
    let mut nearest = None;
    for &end in &ends {
        let way = quickest_way(tables, start, end, 0.0, |node| node == end || is_free(node));
        let Some((_, way)) = way else { continue };
        let nodes: Vec<_> = [start].into_iter().chain(way).collect();
        let steps = |nodes: &[u32]| nodes.iter().copied().map(Step::pass).collect();
        if let Some(tour) = TimedTour::new(tables, steps(&nodes)) {
            return Ok(FirstTour::Feasible(tour.into()));
        }
        let over_places = way_over_places(tables, end);
        if let Some(tour) = over_places.and_then(|nodes| TimedTour::new(tables, steps(&nodes))) {
            return Ok(FirstTour::Feasible(tour.into()));
        }
        nearest = nearest.or(Some(nodes));
    }
    nearest
        .map(FirstTour::Infeasible)
        .ok_or(PlanError::Unreachable {
            start,
            destination: ends.first().copied().unwrap_or(start),
        })
}

/// The quickest way to a destination on which no two places to be met are further apart than allowed.
fn way_over_places(tables: &TimedNetwork<'_>, end: u32) -> Option<Vec<u32>> {
    let visits = tables.model.visits.as_ref()?;
    let start = tables.problem.start.0;
    let mut stops = vec![start];
    stops.extend(
        visits
            .nodes
            .iter()
            .map(|node| node.0)
            .filter(|&n| n != end && n != start),
    );
    stops.push(end);
    let last = stops.len() - 1;
    let mut best: Vec<Option<(f64, Vec<u32>)>> = vec![None; stops.len()];
    best[0] = Some((0.0, vec![stops[0]]));
    let mut is_settled = vec![false; stops.len()];
    loop {
        let open = (0..stops.len()).filter(|&i| !is_settled[i] && best[i].is_some());
        let time_s = |i: &usize| {
            best[*i]
                .as_ref()
                .map_or(f64::INFINITY, |(time_s, _)| *time_s)
        };
        let at = open.min_by(|a, b| time_s(a).total_cmp(&time_s(b)))?;
        is_settled[at] = true;
        let (at_s, nodes) = best[at].clone()?;
        if at == last {
            return Some(nodes);
        }
        for to in (0..stops.len()).filter(|&to| !is_settled[to]) {
            let is_free = |node: u32| !nodes.contains(&node);
            let way = quickest_way(tables, stops[at], stops[to], at_s, is_free);
            let is_near = |(there_s, _): &(f64, _)| there_s - at_s <= visits.every_s;
            let Some((there_s, way)) = way.filter(is_near) else {
                continue;
            };
            if best[to]
                .as_ref()
                .is_none_or(|(time_s, _)| there_s < *time_s)
            {
                best[to] = Some((there_s, nodes.iter().copied().chain(way).collect()));
            }
        }
    }
}
