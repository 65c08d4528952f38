//! Orienteering with time windows: the files of Righini and Salani (2009) and those in their form.

use super::error::FormatError;
use super::text::{finite_number, without_mark};
use crate::ids::NodeId;
use crate::instance::RouteInstance;
use crate::network::Network;
use crate::time_model::{Passing, TimeModel};
use crate::timed_task::{TaskName, TaskPlace, TimedTask};
use crate::waypoint::{Edge, Task, Waypoint};
use auv_types::{Point3, Violations, libm};

/// Whether the first line has the four whole numbers of an OPTW file: `k v N t`.
pub(super) fn starts_with_optw_header(text: &str) -> bool {
    let first = text.lines().find(|line| !line.trim().is_empty());
    let words = first.map(|line| line.split_whitespace().collect::<Vec<_>>());
    words.is_some_and(|words| words.len() == 4 && words.iter().all(|w| w.parse::<u32>().is_ok()))
}

/// Decimals that the literature keeps of a distance: two in the files of Cordeau, whose names begin with
/// `pr`, one in those of Solomon.
fn usual_decimals(name: &str) -> u32 {
    if name.starts_with("pr") { 2 } else { 1 }
}

/// Reads an OPTW file for one vehicle: a header `k v N t`, a line `D Q`, then points 0 to `N`, each with
/// number, x, y, service time, profit, other columns, opening and closing. Point 0 is the depot; its
/// closing is the time available. Distances are cut to `decimals` (none given: two if the name begins with
/// `pr`, else one); a unit of length takes one second.
///
/// Node `i` is point `i`, and node `N + 1` the depot again, as destination. A route does the task of each
/// node that it visits ([`Passing::DoesTasks`]).
///
/// # Errors
/// Every line that is not as above, another number of points, and everything that [`Network::new`] and
/// [`TimeModel::validate`] refuse.
pub fn from_optw(
    text: &str,
    name: &str,
    decimals: Option<u32>,
) -> Result<RouteInstance, FormatError> {
    let mut violations = Violations::new();
    let lines = (1..).zip(without_mark(text).lines());
    let mut lines = lines.filter(|(_, line)| !line.trim().is_empty());
    let header = lines
        .next()
        .and_then(|(_, line)| line.split_whitespace().nth(2));
    let given = header.and_then(|word| word.parse::<usize>().ok());
    let points: Vec<_> = lines
        .skip(1)
        .filter_map(|(line, content)| Point::read(line, content, &mut violations))
        .collect();
    violations.require(!points.is_empty(), "the file", || {
        "has no points; give the depot and the customers".into()
    });
    if let (Some(given), true) = (given, violations.is_empty()) {
        violations.require(given.saturating_add(1) == points.len(), "line 1", || {
            let found = points.len();
            format!("gives N {given}, but {found} points follow; N is one less than the points")
        });
    }
    let decimals = decimals.unwrap_or_else(|| usual_decimals(name));
    violations.require(decimals <= 9, "decimals", || {
        format!("is {decimals}; give 0 to 9")
    });
    let most = Network::MAX_EDGES;
    let edges = points.len().saturating_mul(points.len() + 1) / 2;
    violations.require(edges <= most, "the file", || {
        format!("makes a network of {edges} edges; at most {most} are allowed (Network::MAX_EDGES)")
    });
    violations.into_result()?;
    instance(name, &points, decimals)
}

/// A line of the file.
struct Point {
    x: f64,
    y: f64,
    service_s: f64,
    profit: f64,
    window: [f64; 2],
}

impl Point {
    fn read(line: usize, content: &str, violations: &mut Violations) -> Option<Self> {
        let words: Vec<_> = content.split_whitespace().collect();
        if words.len() < 7 {
            let message = format!(
                "has {} entries; give number, x, y, service, profit, .., opening and closing",
                words.len()
            );
            violations.push(format!("line {line}"), message);
            return None;
        }
        let last = words.len() - 1;
        let mut number = |at: usize, field: &str| finite_number(words[at], line, field, violations);
        let (x, y) = (number(1, "x"), number(2, "y"));
        let (service_s, profit) = (number(3, "service"), number(4, "profit"));
        let (opening, closing) = (number(last - 1, "opening"), number(last, "closing"));
        Some(Self {
            x: x?,
            y: y?,
            service_s: service_s?,
            profit: profit?,
            window: [opening?, closing?],
        })
    }
}

fn instance(name: &str, points: &[Point], decimals: u32) -> Result<RouteInstance, FormatError> {
    let n = points.len();
    let unit = f64::from(10_u32.pow(decimals));
    let place = |i: usize| &points[i % n];
    let mut edges = Vec::with_capacity(n * (n + 1) / 2);
    for i in 0..=n {
        for j in i + 1..=n {
            let (a, b) = (place(i), place(j));
            let distance = libm::hypot(a.x - b.x, a.y - b.y);
            edges.push(Edge {
                distance_m: Some(libm::floor(distance * unit) / unit),
                ..Edge::undirected(i as u32, j as u32, Task::TRANSIT)
            });
        }
    }
    let waypoint = |i: usize| Waypoint::at(Point3::new(place(i).x, place(i).y, 0.0));
    let waypoints: Vec<_> = (0..=n).map(waypoint).collect();
    let network = Network::new(&waypoints, &edges, 1.0)?;
    let task = |(i, point): (usize, &Point)| TimedTask {
        name: TaskName::Number(i as i64),
        place: TaskPlace::Node(NodeId(i as u32)),
        task: Task {
            priority: point.profit,
            risk: 1.0,
            completion_time_s: point.service_s,
        },
        windows: vec![point.window],
        mandatory: false,
        after: Vec::new(),
        chain: None,
    };
    let model = TimeModel {
        tasks: points.iter().enumerate().skip(1).map(task).collect(),
        passing: Passing::DoesTasks,
        ..TimeModel::default()
    };
    model.validate(&network).into_result()?;
    let ends = (NodeId(0), NodeId(n as u32));
    let mut instance = RouteInstance::new(name, network, ends, points[0].window[1])?;
    instance.time_model = Some(model);
    Ok(instance)
}

#[cfg(test)]
mod tests {
    use super::*;

    const FILE: &str = "4 1 2 1\n0 200\n 0 0.0 0.0 0 0 0 0 0 100\n 1 3 4.1 90 10 1 1 1 20 30\n\
                        2 3.0 0 5.0 20.0 1 1 1 0 50\n";

    #[test]
    fn points_become_tasks_and_the_depot_is_split() {
        let instance = from_optw(FILE, "c1", None).unwrap();
        let model = instance.time_model.as_ref().unwrap();
        assert_eq!(
            (instance.start, instance.destination),
            (NodeId(0), NodeId(3))
        );
        assert_eq!(
            (instance.budget_s, model.tasks[0].windows[0]),
            (100.0, [20.0, 30.0])
        );
        let time_s = |instance: &RouteInstance, a, b| {
            let arc = instance.network.arc_between(NodeId(a), NodeId(b)).unwrap();
            instance.network.arc_time_s(arc, None)
        };
        assert_eq!(
            (time_s(&instance, 0, 1), time_s(&instance, 1, 3)),
            (5.0, 5.0)
        );
        let finer = from_optw(FILE, "pr1", None).unwrap();
        assert_eq!(time_s(&finer, 0, 1), 5.08);
        assert_eq!(time_s(&from_optw(FILE, "pr1", Some(0)).unwrap(), 1, 2), 4.0);
    }

    #[test]
    fn wrong_lines_are_named() {
        let bad = FILE.replace("4.1", "x").replace("0 50\n", "60 50\n");
        let message = from_optw(&bad, "c1", None).unwrap_err().to_string();
        assert!(message.contains("line 4"), "{message}");
        let few = FILE.replace("4 1 2 1", "4 1 3 1");
        let message = from_optw(&few, "c1", None).unwrap_err().to_string();
        assert!(message.contains("gives N 3"), "{message}");
        let closed = FILE.replace("20 30", "40 30");
        assert!(from_optw(&closed, "c1", None).is_err());
    }
}
