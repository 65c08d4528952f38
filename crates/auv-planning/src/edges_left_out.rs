//! Why a route without times does not pass an edge with a task.

use crate::RouteProblem;
use crate::timed::LeftOut;
use auv_graph::{ArcId, EdgeId, EdgeSet, NodeId, Route};
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// The edges with a task that a route does not pass, each with what keeps it out beside the rest of the route:
/// no way leads there from a node of the route and on to the next over nodes that the route does not visit, no
/// time is left for the quickest such way, or it would be in time and tasks of more weight left out for it. With
/// travel times by departure the last two are not told apart: time.
///
/// Complexity: O(k m log n) for m arcs, n nodes and k legs.
#[must_use]
pub fn edges_left_out(problem: &RouteProblem<'_>, route: &Route) -> Vec<(EdgeId, LeftOut)> {
    let network = problem.network;
    let nodes = route.nodes();
    let (mut out, mut into) = (
        vec![Vec::new(); network.num_nodes()],
        vec![Vec::new(); network.num_nodes()],
    );
    for (i, arc) in network.arcs().iter().enumerate() {
        let time_s = network.arc_time_s(ArcId(i as u32), problem.times);
        if !problem.removed.contains(arc.edge) && time_s < f64::INFINITY {
            out[arc.tail.index()].push((arc.head, time_s));
            into[arc.head.index()].push((arc.tail, time_s));
        }
    }
    let mut is_free = vec![true; network.num_nodes()];
    nodes.iter().for_each(|node| is_free[node.index()] = false);
    let mut passed = EdgeSet::empty();
    let mut route_s = 0.0;
    // The least time that passing each edge adds to the route.
    let mut more_s = vec![f64::INFINITY; network.num_edges()];
    for leg in nodes.windows(2) {
        let arc = network.arc_between(leg[0], leg[1]);
        let leg_s = arc.map_or(0.0, |arc| network.arc_time_s(arc, problem.times));
        if let Some(arc) = arc {
            passed.insert(network.arcs()[arc.index()].edge);
        }
        route_s += leg_s;
        let there_s = least_times_s(&out, &is_free, leg[0]);
        let back_s = least_times_s(&into, &is_free, leg[1]);
        for (i, arc) in network.arcs().iter().enumerate() {
            let time_s = network.arc_time_s(ArcId(i as u32), problem.times);
            let way_s = there_s[arc.tail.index()] + time_s + back_s[arc.head.index()];
            let least_s = &mut more_s[arc.edge.index()];
            *least_s = least_s.min(way_s - leg_s);
        }
    }
    let spare_s = problem.time_available_s - route_s;
    let edges = (0..more_s.len() as u32).map(EdgeId);
    let is_left = |edge: &EdgeId| {
        let is_open = !passed.contains(*edge) && !problem.removed.contains(*edge);
        is_open && network.task(*edge).weight() > 0.0
    };
    let why = |edge: EdgeId| match more_s[edge.index()] {
        f64::INFINITY => (edge, LeftOut::NoWay),
        more_s if more_s > spare_s || problem.time_model.is_some() => (edge, LeftOut::Time),
        _ => (edge, LeftOut::Weight),
    };
    edges.filter(is_left).map(why).collect()
}

/// Least times in seconds from a node over free ones, along links by node.
fn least_times_s(links: &[Vec<(NodeId, f64)>], is_free: &[bool], from: NodeId) -> Vec<f64> {
    let mut least_s = vec![f64::INFINITY; links.len()];
    least_s[from.index()] = 0.0;
    // Times are not negative, so their bits are in the same order as they are.
    let mut open = BinaryHeap::from([Reverse((0_u64, from))]);
    while let Some(Reverse((bits, at))) = open.pop() {
        let at_s = f64::from_bits(bits);
        if at_s > least_s[at.index()] {
            continue;
        }
        for &(to, time_s) in links[at.index()]
            .iter()
            .filter(|(to, _)| is_free[to.index()])
        {
            if at_s + time_s < least_s[to.index()] {
                least_s[to.index()] = at_s + time_s;
                open.push(Reverse(((at_s + time_s).to_bits(), to)));
            }
        }
    }
    least_s
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_graph::{Edge, Network, Task, Waypoint};
    use auv_types::Point3;

    #[test]
    fn what_keeps_an_edge_out_is_told_apart() {
        let task = |priority| Task {
            priority,
            risk: 1.0,
            completion_time_s: 0.0,
        };
        // 0 to 3 along a line; 4 beside it, 5 a dead end.
        let places = [
            (0.0, 0.0),
            (100.0, 0.0),
            (200.0, 0.0),
            (300.0, 0.0),
            (200.0, 50.0),
            (100.0, 90.0),
        ];
        let waypoints = places.map(|(x, y)| Waypoint::at(Point3::new(x, y, 0.0)));
        let edges = [
            Edge::undirected(0, 1, task(5.0)),
            Edge::undirected(1, 2, task(5.0)),
            Edge::undirected(2, 3, task(5.0)),
            Edge::undirected(2, 4, task(1.0)),
            Edge::undirected(4, 3, task(1.0)),
            Edge::undirected(1, 5, task(1.0)),
        ];
        let network = Network::new(&waypoints, &edges, 1.0).unwrap();
        let route = Route::new([0, 1, 2, 3].map(NodeId).to_vec());
        let why = |available_s| {
            let problem = RouteProblem::new(&network, NodeId(0), NodeId(3), available_s);
            edges_left_out(&problem, &route)
        };
        let all = |beside| {
            vec![
                (EdgeId(3), beside),
                (EdgeId(4), beside),
                (EdgeId(5), LeftOut::NoWay),
            ]
        };
        // By 4 it takes 61.8 s more; 5 is a dead end.
        assert_eq!(why(361.0), all(LeftOut::Time));
        assert_eq!(why(362.0), all(LeftOut::Weight));
    }
}
