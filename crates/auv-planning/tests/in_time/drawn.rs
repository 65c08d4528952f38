//! Random problems in time.

use auv_graph::{
    ArcId, Chain, Edge, EdgeId, Network, NodeId, Profiles, Task, TaskName, TaskPlace, TimeModel,
    TimedTask, Visits, Waypoint,
};
use auv_planning::RouteProblem;
use auv_types::rand::RngExt;
use auv_types::{ChaCha8Rng, Point3, Seed};

/// What a problem has beside windows.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Features {
    own_tasks: bool,
    edge_tasks: bool,
    profiles: bool,
    order: bool,
    chain: Option<bool>,
    mandatory: bool,
    several_ends: bool,
    is_closed: bool,
    pub(crate) visits: bool,
    may_wait: bool,
}

impl Features {
    /// Each of them in about every third problem.
    fn drawn(random: &mut ChaCha8Rng) -> Self {
        let mut is_drawn = || random.random_bool(0.3);
        Self {
            own_tasks: is_drawn(),
            edge_tasks: is_drawn(),
            profiles: is_drawn(),
            order: is_drawn(),
            chain: is_drawn().then(&mut is_drawn),
            mandatory: is_drawn(),
            several_ends: is_drawn(),
            is_closed: is_drawn(),
            visits: is_drawn(),
            may_wait: !is_drawn(),
        }
    }
}

/// A problem that can be lent.
pub(crate) struct Drawn {
    pub(crate) features: Features,
    network: Network,
    model: TimeModel,
    destination: NodeId,
    budget_s: f64,
}

impl Drawn {
    pub(crate) fn new(seed: u64, nodes: u32) -> Self {
        let random = &mut Seed(seed).stream(0);
        let features = Features::drawn(random);
        let waypoints: Vec<_> = (0..nodes)
            .map(|_| {
                let [x, y] = [1_000.0, 1_000.0].map(|most| random.random_range(0.0..most));
                Waypoint::at(Point3::new(x, y, 0.0))
            })
            .collect();
        let mut edges = Vec::new();
        for a in 0..nodes {
            for b in a + 1..nodes {
                let own = if features.own_tasks {
                    task(random, 30.0)
                } else {
                    Task::TRANSIT
                };
                if b == a + 1 || random.random_bool(0.7) {
                    edges.push(Edge::undirected(a, b, own));
                }
            }
        }
        let network = Network::new(&waypoints, &edges, 2.0).unwrap();
        let budget_s = random.random_range(400.0..2_000.0);
        let model = model(random, &network, features, budget_s);
        Self {
            features,
            destination: NodeId(if features.is_closed { 0 } else { nodes - 1 }),
            network,
            model,
            budget_s,
        }
    }

    pub(crate) fn problem(&self) -> RouteProblem<'_> {
        RouteProblem {
            time_model: Some(&self.model),
            ..RouteProblem::new(&self.network, NodeId(0), self.destination, self.budget_s)
        }
    }
}

fn task(random: &mut ChaCha8Rng, most_s: f64) -> Task {
    Task {
        priority: random.random_range(1..10_u32).into(),
        risk: random.random_range(1..4_u32).into(),
        completion_time_s: random.random_range(0.0..most_s),
    }
}

fn timed_task(
    random: &mut ChaCha8Rng,
    index: usize,
    network: &Network,
    features: Features,
    budget_s: f64,
) -> TimedTask {
    let windows = (0..random.random_range(0..3_u32)).map(|k| {
        let from_s = budget_s * (0.4 * f64::from(k) + random.random_range(0.0..0.3));
        [from_s, from_s + budget_s * random.random_range(0.0..0.1)]
    });
    let windows = windows.collect();
    let place = if features.edge_tasks && random.random_bool(0.5) {
        TaskPlace::Edge(EdgeId(random.random_range(0..network.num_edges() as u32)))
    } else {
        TaskPlace::Node(NodeId(random.random_range(0..network.num_nodes() as u32)))
    };
    let comes_after = features.order && index > 0 && random.random_bool(0.4);
    TimedTask {
        name: TaskName::Number(index as i64),
        place,
        windows,
        task: task(random, 60.0),
        mandatory: features.mandatory && random.random_bool(0.4),
        after: if comes_after { vec![index - 1] } else { vec![] },
        chain: (features.chain.is_some() && index < 3).then_some(0),
    }
}

fn model(
    random: &mut ChaCha8Rng,
    network: &Network,
    features: Features,
    budget_s: f64,
) -> TimeModel {
    let count = random.random_range(2..6_usize);
    let tasks = (0..count).map(|i| timed_task(random, i, network, features, budget_s));
    let mut model = TimeModel {
        tasks: tasks.collect(),
        may_wait: features.may_wait,
        ..TimeModel::default()
    };
    model.chains.extend(features.chain.map(|may_split| Chain {
        name: "chain".into(),
        may_split,
    }));
    if features.profiles {
        let times_s = vec![0.0, 0.3 * budget_s, 0.6 * budget_s];
        let travel = network.arcs().iter().enumerate().map(|(i, arc)| {
            let mut row = [1.0; 3].map(|_| arc.distance_m / 2.0 * random.random_range(0.5..1.5));
            for k in 1..3 {
                row[k] = row[k].max(row[k - 1] - 0.29 * budget_s);
            }
            (ArcId(i as u32), row.to_vec())
        });
        model.profiles = Profiles::new(times_s, travel.collect(), |arc| arc.0.to_string()).unwrap();
    }
    if features.several_ends {
        model.destinations = vec![NodeId(network.num_nodes() as u32 - 1), NodeId(1)];
    }
    model.visits = features.visits.then(|| Visits {
        nodes: vec![NodeId(1), NodeId(2)],
        every_s: 0.45 * budget_s,
    });
    model
}
