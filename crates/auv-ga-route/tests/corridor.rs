//! A survey's lines, whose inner ends lead to the next line only, are found and done as one.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use auv_ga_route::GaRoute;
use auv_graph::{Edge, Network, NodeId, Task, Waypoint};
use auv_planning::{Budget, RoutePlanner, RouteProblem, Run};
use auv_types::{Point3, Seed};

/// Eight lines of 1 km, 100 m apart, linked in order, and four places around them. Only the first and the
/// last line's outer ends are connected to the rest.
fn survey(lines: u32) -> (Network, NodeId) {
    let line = Task {
        priority: 10.0,
        risk: 1.0,
        completion_time_s: 0.0,
    };
    let mut places = vec![(-1_500.0, -900.0)];
    for k in 0..lines {
        let east = -350.0 + 100.0 * f64::from(k);
        places.extend([(-500.0, east), (500.0, east)]);
    }
    places.extend([
        (-900.0, -500.0),
        (900.0, 300.0),
        (0.0, 900.0),
        (-700.0, 800.0),
        (-1_500.0, -800.0),
    ]);
    let south = |k: u32| 1 + 2 * k;
    let mut edges: Vec<_> = (0..lines)
        .map(|k| Edge::undirected(south(k), south(k) + 1, line))
        .collect();
    for k in 1..lines {
        let side = k % 2;
        edges.push(Edge::undirected(
            south(k - 1) + side,
            south(k) + side,
            Task::TRANSIT,
        ));
    }
    let last = places.len() as u32 - 1;
    let mut free = vec![0, south(0), south(lines - 1) + lines % 2];
    free.extend(last - 4..=last);
    for (i, &a) in free.iter().enumerate() {
        for &b in &free[i + 1..] {
            edges.push(Edge::undirected(
                a,
                b,
                Task {
                    priority: 1.0,
                    ..Task::TRANSIT
                },
            ));
        }
    }
    let waypoints: Vec<_> = places
        .iter()
        .map(|&(x, y)| Waypoint::at(Point3::new(x, y, 50.0)))
        .collect();
    (Network::new(&waypoints, &edges, 1.5).unwrap(), NodeId(last))
}

#[test]
fn a_lawnmower_is_found_at_once() {
    for lines in [3, 8, 13] {
        let (network, destination) = survey(lines);
        let problem = RouteProblem::new(&network, NodeId(0), destination, 4.0 * 3_600.0);
        let mut run = Run::new(Seed(1), Budget::evaluations(500));
        let planned = GaRoute::default().plan_route(&mut run, &problem).unwrap();
        assert!(
            -planned.cost >= 10.0 * f64::from(lines) + 5.0,
            "{lines} lines: {}",
            planned.cost
        );
        // Without time for the lines the rest is still planned.
        let short = RouteProblem {
            time_available_s: 3_600.0,
            ..problem
        };
        let mut run = Run::new(Seed(1), Budget::evaluations(500));
        let planned = GaRoute::default().plan_route(&mut run, &short).unwrap();
        assert!(
            planned.violation <= 0.0 && -planned.cost >= 3.0,
            "{}",
            planned.cost
        );
    }
}
