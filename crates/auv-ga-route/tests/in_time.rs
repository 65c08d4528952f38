//! Routes in time against an enumeration of all routes and all orders of tasks.

#![allow(clippy::unwrap_used, reason = "tests may panic")]

use auv_ga_route::GaRoute;
use auv_graph::{
    ArcId, Chain, Edge, EdgeId, Network, NodeId, Profiles, Route, Task, TaskName, TaskPlace,
    TimeModel, TimedTask, Visits, Waypoint,
};
use auv_planning::baseline::GreedyRoute;
use auv_planning::{
    Budget, PlanError, Planned, RoutePlanner, RouteProblem, Run, Schedule, TaskDone,
};
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed};
use auv_verify::verify_route_in_time;

/// What a drawn problem has beside windows.
#[derive(Clone, Copy, Debug, Default)]
struct Features {
    own_tasks: bool,
    edge_tasks: bool,
    profiles: bool,
    order: bool,
    chain: Option<bool>,
    closed: bool,
    several_ends: bool,
    no_waiting: bool,
    visits: bool,
    sparse: bool,
    /// Every edge is two of one way, each with tasks of its own.
    one_way: bool,
    /// At every node between the ends one task with one window, nothing else.
    one_each: bool,
    /// How many of the last nodes are destinations, which no edge leaves and which have no tasks.
    docks: u32,
}

struct Drawn {
    network: Network,
    model: TimeModel,
    destination: NodeId,
    budget_s: f64,
}

impl Drawn {
    fn problem(&self) -> RouteProblem<'_> {
        let mut problem =
            RouteProblem::new(&self.network, NodeId(0), self.destination, self.budget_s);
        problem.time_model = Some(&self.model);
        problem
    }
}

fn task(random: &mut ChaCha8Rng, most_s: f64) -> Task {
    Task {
        priority: random.random_range(1..10_u32).into(),
        risk: random.random_range(1..4_u32).into(),
        completion_time_s: random.random_range(0.0..most_s),
    }
}

fn draw(seed: u64, nodes: u32, features: Features) -> Drawn {
    let mut random = Seed(seed).stream(0);
    let random = &mut random;
    let waypoints: Vec<_> = (0..nodes)
        .map(|_| {
            let [x, y] = [1_000.0, 1_000.0].map(|most| random.random_range(0.0..most));
            Waypoint::at(Point3::new(x, y, 0.0))
        })
        .collect();
    let mut edges = Vec::new();
    for a in 0..nodes {
        for b in a + 1..nodes {
            let leaves_dock = a >= nodes - features.docks;
            let share = if features.docks > 0 { 0.2 } else { 0.4 };
            if !leaves_dock && (b == a + 1 || !features.sparse || random.random_bool(share)) {
                let own = if features.own_tasks {
                    task(random, 30.0)
                } else {
                    Task::TRANSIT
                };
                if b >= nodes - features.docks {
                    edges.push(Edge::directed(a, b, own));
                } else if features.one_way {
                    edges.push(Edge::directed(a, b, own));
                    edges.push(Edge::directed(b, a, Task::TRANSIT));
                } else {
                    edges.push(Edge::undirected(a, b, own));
                }
            }
        }
    }
    let network = Network::new(&waypoints, &edges, 2.0).unwrap();
    let budget_s = random.random_range(400.0..2_000.0);
    let model = model(random, &network, features, budget_s);
    let destination = NodeId(if features.closed { 0 } else { nodes - 1 });
    Drawn {
        network,
        model,
        destination,
        budget_s,
    }
}

fn model(
    random: &mut ChaCha8Rng,
    network: &Network,
    features: Features,
    budget_s: f64,
) -> TimeModel {
    let nodes = network.num_nodes() as u32;
    let mut tasks = Vec::new();
    let (count, most_windows) = if features.one_each {
        (nodes as usize - 2, 1)
    } else {
        (random.random_range(2..6_usize), 2)
    };
    for i in 0..count {
        let windows = (0..random.random_range(0..=most_windows)).map(|k| {
            let from_s = budget_s * (0.4 * f64::from(k) + random.random_range(0.0..0.3));
            [from_s, from_s + budget_s * random.random_range(0.0..0.1)]
        });
        let windows = windows.collect();
        let on_edge = features.edge_tasks && random.random_bool(0.5);
        let place = if on_edge {
            TaskPlace::Edge(EdgeId(random.random_range(0..network.num_edges() as u32)))
        } else if features.one_each {
            TaskPlace::Node(NodeId(i as u32 + 1))
        } else {
            TaskPlace::Node(NodeId(random.random_range(0..nodes)))
        };
        tasks.push(TimedTask {
            name: TaskName::Number(i as i64),
            place,
            windows,
            task: task(random, 60.0),
            mandatory: false,
            after: if features.order && i > 0 && random.random_bool(0.4) {
                vec![i - 1]
            } else {
                vec![]
            },
            chain: (features.chain.is_some() && i < 3).then_some(0),
        });
    }
    let mut model = TimeModel {
        tasks,
        ..TimeModel::default()
    };
    if let Some(may_split) = features.chain {
        model.chains = vec![Chain {
            name: "c".into(),
            may_split,
        }];
    }
    if features.profiles {
        let times_s = vec![0.0, 0.3 * budget_s, 0.6 * budget_s];
        let travel = network.arcs().iter().enumerate().map(|(i, arc)| {
            let least_s = arc.distance_m / 2.0;
            let row = (0..3).map(|_| least_s * random.random_range(0.5..1.5));
            let mut row: Vec<f64> = row.collect();
            for k in 1..3 {
                row[k] = row[k].max(row[k - 1] - 0.29 * budget_s);
            }
            (ArcId(i as u32), row)
        });
        model.profiles = Profiles::new(times_s, travel.collect(), |arc| arc.0.to_string()).unwrap();
    }
    if features.several_ends {
        model.destinations = vec![NodeId(nodes - 1), NodeId(1)];
    }
    if features.docks > 0 {
        let first = nodes - features.docks;
        let is_dock = |place| matches!(place, TaskPlace::Node(node) if node.0 >= first);
        model.destinations = (first..nodes).map(NodeId).collect();
        model.tasks.retain(|task| !is_dock(task.place));
    }
    model.may_wait = !features.no_waiting;
    if features.visits {
        let every_s = 0.45 * budget_s;
        model.visits = Some(Visits {
            nodes: vec![NodeId(1), NodeId(2)],
            every_s,
        });
    }
    model
}

/// The most weight of all routes and all orders of their tasks, each begun as early as possible.
struct Enumeration<'a> {
    problem: &'a RouteProblem<'a>,
    model: &'a TimeModel,
    nodes: Vec<NodeId>,
    schedule: Schedule,
    passed: Vec<EdgeId>,
    best: Option<f64>,
}

impl Enumeration<'_> {
    fn most_weight(problem: &RouteProblem<'_>) -> Option<f64> {
        let mut all = Enumeration {
            problem,
            model: problem.time_model.unwrap(),
            nodes: vec![problem.start],
            schedule: Schedule::default(),
            passed: Vec::new(),
            best: None,
        };
        all.at(TaskPlace::Node(problem.start), 0.0);
        all.best
    }

    /// Tries every continuation at a place: end, go on, or do one more task there.
    fn at(&mut self, place: TaskPlace, time_s: f64) {
        if time_s > self.problem.time_available_s {
            return;
        }
        for (i, task) in self.model.tasks.iter().enumerate() {
            let is_done = self.schedule.done.iter().any(|done| done.task == i);
            if is_done || task.place != place {
                continue;
            }
            let Some(start_s) = task.earliest_start_s(time_s) else {
                continue;
            };
            self.schedule.done.push(TaskDone { task: i, start_s });
            self.at(place, start_s + task.task.completion_time_s);
            self.schedule.done.pop();
        }
        let here = *self.nodes.last().unwrap();
        if matches!(place, TaskPlace::Edge(_)) {
            self.at(TaskPlace::Node(here), time_s);
            return;
        }
        self.judge(time_s);
        if self.nodes.len() > 1 && here == self.nodes[0] {
            return;
        }
        for (id, arc) in self.problem.network.arcs_from(here) {
            let closes = arc.head == self.nodes[0];
            if self.nodes[1..].contains(&arc.head)
                || (closes
                    && self.model.destinations.is_empty()
                    && self.problem.destination != arc.head)
            {
                continue;
            }
            let profile = self.model.profiles.of(id);
            let travel_s = profile.map_or(arc.distance_m / 2.0, |p| p.travel_s(time_s));
            let is_first = !self.passed.contains(&arc.edge);
            let own_s = self.problem.network.task(arc.edge).completion_time_s;
            self.nodes.push(arc.head);
            self.schedule.departures_s.push(time_s);
            self.passed.push(arc.edge);
            let arrival_s = time_s + travel_s + if is_first { own_s } else { 0.0 };
            self.at(TaskPlace::Edge(arc.edge), arrival_s);
            self.passed.pop();
            self.schedule.departures_s.pop();
            self.nodes.pop();
        }
    }

    fn judge(&mut self, time_s: f64) {
        self.schedule.end_s = time_s;
        let route = Route::new(self.nodes.clone());
        let (report, broken) = verify_route_in_time(self.problem, &route, &self.schedule);
        if broken.is_empty() && self.best.is_none_or(|best| report.weight > best) {
            self.best = Some(report.weight);
        }
    }
}

/// What is wrong with the planners' answers.
fn faults(seed: u64, nodes: u32, features: Features, evaluations: u64) -> Vec<String> {
    let drawn = draw(seed, nodes, features);
    let problem = drawn.problem();
    let most = Enumeration::most_weight(&problem);
    let mut faults = Vec::new();
    let planners: [&dyn RoutePlanner; 2] = [&GaRoute::default(), &GreedyRoute];
    for planner in planners {
        let mut run = Run::new(Seed(1), Budget::evaluations(evaluations));
        let fault = match planner.plan_route(&mut run, &problem) {
            Ok(planned) => fault(&problem, &planned, most, planner.name() == "ga"),
            Err(PlanError::Impossible { .. }) if most.is_none() => None,
            Err(error) => Some(error.to_string()),
        };
        faults.extend(fault.map(|fault| format!("{} {seed} {fault} {features:?}", planner.name())));
    }
    faults
}

fn fault(
    problem: &RouteProblem<'_>,
    planned: &Planned<Route>,
    most: Option<f64>,
    is_best: bool,
) -> Option<String> {
    let schedule = planned.schedule.as_ref().unwrap();
    let (report, broken) = verify_route_in_time(problem, &planned.best, schedule);
    if planned.violation > 0.0 {
        return (broken.is_empty() || most.is_some()).then(|| format!("misses {most:?}"));
    }
    if !broken.is_empty() {
        return Some(format!("{broken:?}"));
    }
    if (planned.cost + report.weight).abs() > 1e-9 {
        return Some(format!("claims {} for {}", planned.cost, report.weight));
    }
    // The enumeration begins everything as early as possible; between visits later may be better.
    let most = most.unwrap_or(f64::NEG_INFINITY);
    let is_above = report.weight > most + 1e-9 && problem.time_model?.visits.is_none();
    let is_below = is_best && report.weight < most - 1e-9;
    (is_above || is_below).then(|| format!("{} of {most}", report.weight))
}

fn check(seeds: std::ops::Range<u64>, nodes: u32, features: Features) {
    let faults: Vec<_> = seeds
        .flat_map(|seed| faults(seed, nodes, features, 4_000))
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn windows_alone_are_solved() {
    check(0..20, 6, Features::default());
}

#[test]
fn one_task_with_one_window_at_each_node_is_solved() {
    let features = Features {
        one_each: true,
        ..Features::default()
    };
    check(900..920, 7, features);
    let faults: Vec<_> = (920..923)
        .flat_map(|seed| faults(seed, 7, features, 60_000))
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

/// With more evaluations partial routes are labelled too.
#[test]
fn windows_alone_are_solved_with_more_evaluations() {
    let faults: Vec<_> = (20..26)
        .flat_map(|seed| faults(seed, 6, Features::default(), 60_000))
        .collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn own_tasks_and_profiles_are_solved() {
    let features = Features {
        own_tasks: true,
        profiles: true,
        ..Features::default()
    };
    check(100..120, 6, features);
    check(
        150..170,
        6,
        Features {
            closed: true,
            ..features
        },
    );
}

#[test]
fn tasks_on_edges_order_and_chains_are_solved() {
    let features = Features {
        edge_tasks: true,
        order: true,
        ..Features::default()
    };
    check(200..220, 5, features);
    for may_split in [false, true] {
        let features = Features {
            chain: Some(may_split),
            order: false,
            ..features
        };
        check(300..320, 5, features);
    }
}

#[test]
fn ends_visits_and_no_waiting_are_kept() {
    let features = Features {
        several_ends: true,
        own_tasks: true,
        ..Features::default()
    };
    check(400..430, 5, features);
    let features = Features {
        visits: true,
        ..Features::default()
    };
    check(500..520, 6, features);
    let features = Features {
        no_waiting: true,
        edge_tasks: true,
        ..Features::default()
    };
    check(600..620, 5, features);
}

/// The route begins with the quickest way to a dock; the best one often ends at another, to which no edge
/// leads from there.
#[test]
fn the_best_of_several_docks_is_found_on_sparse_networks() {
    for docks in [2, 3] {
        for nodes in [7, 8, 9] {
            let features = Features {
                docks,
                one_each: true,
                sparse: true,
                ..Features::default()
            };
            let first = u64::from(1_000 * docks + 100 * nodes);
            check(first..first + 20, nodes, features);
        }
    }
}

#[test]
fn all_at_once_on_sparse_networks() {
    let features = Features {
        own_tasks: true,
        edge_tasks: true,
        profiles: true,
        order: true,
        chain: Some(true),
        closed: true,
        sparse: true,
        ..Features::default()
    };
    check(700..720, 6, features);
}

#[test]
fn tasks_of_one_way_edges_are_not_done_the_other_way() {
    let features = Features {
        own_tasks: true,
        edge_tasks: true,
        one_way: true,
        ..Features::default()
    };
    check(800..820, 5, features);
    check(
        820..840,
        5,
        Features {
            closed: true,
            ..features
        },
    );
}
