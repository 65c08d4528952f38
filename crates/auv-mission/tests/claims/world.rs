//! Small random missions among moving obstacles, a perfect vehicle, and simple planners.

use auv_graph::{Edge, Network, NodeId, Route, Task, Waypoint};
use auv_mission::{Mission, Observation, SyncSettings, Synchroniser};
use auv_obstacles::Region;
use auv_planning::baseline::GreedyRoute;
use auv_planning::{
    PathPlanner, PathProblem, PlanError, Planned, RoutePlanner, RouteProblem, Run, Stats,
    Trajectory, Vehicle,
};
use auv_types::rand::RngExt;
use auv_types::{Point3, Seed, Vector3};
use std::sync::Arc;

pub(crate) struct World {
    pub(crate) mission: Arc<Mission>,
    pub(crate) settings: SyncSettings,
    obstacles: Vec<Region>,
    tick_s: f64,
}

impl World {
    pub(crate) fn new(seed: u64) -> Self {
        let mut random = Seed(seed).stream(0);
        let side = 3;
        let waypoints: Vec<Waypoint> = (0..side * side)
            .map(|i| {
                let (x, y) = (f64::from(i % side) * 400.0, f64::from(i / side) * 400.0);
                let z = random.random_range(10.0..60.0);
                Waypoint::at(Point3::new(x, y, z))
            })
            .collect();
        let mut edges = Vec::new();
        for i in 0..side * side {
            for j in [i + 1, i + side] {
                if j < side * side && (j == i + side || j % side != 0) {
                    let task = Task {
                        priority: random.random_range(1.0..10.0),
                        risk: 1.0,
                        completion_time_s: random.random_range(0.0..60.0),
                    };
                    edges.push(Edge::undirected(i as u32, j as u32, task));
                }
            }
        }
        let steers = seed % 2 == 1;
        let vehicle = if steers {
            Vehicle {
                max_pitch_rad: 1.0,
                ..Vehicle::default()
            }
        } else {
            Vehicle::paper()
        };
        let network = Network::new(&waypoints, &edges, vehicle.speed_mps).unwrap();
        let budget_s = random.random_range(1.5..4.0) * 1_600.0 / vehicle.speed_mps + 300.0;
        let destination = NodeId((side * side - 1) as u32);
        let mut mission =
            Mission::new(Arc::new(network), NodeId(0), destination, budget_s, vehicle);
        mission.clearance_m = 5.0;
        let obstacles = (0..random.random_range(1..5))
            .map(|_| {
                let mut place = || random.random_range(-200.0..1_000.0);
                let mut ball = Region::ball(Point3::new(place(), place(), 30.0), 60.0);
                ball.velocity_mps = Vector3::new(
                    random.random_range(-0.5..0.5),
                    random.random_range(-0.5..0.5),
                    0.0,
                );
                ball
            })
            .collect();
        Self {
            mission: Arc::new(mission),
            settings: if seed.is_multiple_of(3) {
                SyncSettings::paper()
            } else {
                coarse()
            },
            obstacles,
            tick_s: random.random_range(5.0..30.0),
        }
    }

    pub(crate) fn synchroniser(&self) -> Synchroniser {
        Synchroniser::new(Arc::clone(&self.mission), self.settings.clone(), Seed(7)).unwrap()
    }

    /// What a vehicle observes that is exactly on its trajectory.
    pub(crate) fn observe(&self, synchroniser: &Synchroniser, time_s: f64) -> Observation {
        let at_start = (
            self.mission.position_of(self.mission.start),
            Vector3::zeros(),
        );
        let (position, velocity) = synchroniser.trajectory().map_or(at_start, |t| t.at(time_s));
        let regions = self.obstacles.iter().map(|region| {
            let mut seen = *region;
            seen.centre = region.centre_at(time_s);
            seen.from_s = time_s;
            seen
        });
        Observation {
            position_sigma_m: 0.0,
            time_s,
            position,
            velocity,
            regions: regions.collect(),
        }
    }

    pub(crate) fn next_s(&self, synchroniser: &Synchroniser, time_s: f64) -> f64 {
        let due_s = synchroniser.due_s();
        if due_s > time_s {
            due_s.min(time_s + self.tick_s)
        } else {
            time_s + self.tick_s
        }
    }
}

/// The first of a few random detours that the verifier accepts, else the straight line.
pub(crate) struct Detours;

impl PathPlanner for Detours {
    fn name(&self) -> &str {
        "detours"
    }

    fn plan_path(
        &self,
        run: &mut Run<'_>,
        problem: &PathProblem<'_>,
    ) -> Result<Planned<Trajectory>, PlanError> {
        let mut random = run.seed().stream(0);
        let mut best = None;
        for k in 0..6 {
            let side = |random: &mut auv_types::ChaCha8Rng| random.random_range(-200.0..200.0);
            let middle = auv_types::nalgebra::center(&problem.start, &problem.target)
                + Vector3::new(side(&mut random), side(&mut random), 0.0);
            let turn_m = problem.vehicle.turn_radius_m;
            let mut points = vec![problem.start];
            if let (Some(velocity), true) = (problem.start_velocity, turn_m > 0.0) {
                points.push(problem.start + velocity.normalize() * 2.0 * turn_m);
            }
            if k > 0 {
                points.push(middle);
            }
            points.push(problem.target);
            let rounded = auv_planning::polyline::rounded(&points, turn_m);
            let Ok(way) = problem.timed(&rounded) else {
                continue;
            };
            let valid = auv_verify::verify_trajectory(problem, &way).is_valid();
            let violation = if valid { 0.0 } else { 1.0 };
            let planned = Planned::new(way.clone(), way.duration_s(), violation, Stats::default());
            if valid {
                return Ok(planned);
            }
            best = best.or(Some(planned));
        }
        best.ok_or(PlanError::Failed {
            planner: "detours".into(),
            reason: "no way can be timed".into(),
        })
    }
}

/// The greedy baseline.
pub(crate) struct Routes;

impl RoutePlanner for Routes {
    fn name(&self) -> &str {
        "routes"
    }

    fn plan_route(
        &self,
        run: &mut Run<'_>,
        problem: &RouteProblem<'_>,
    ) -> Result<Planned<Route>, PlanError> {
        GreedyRoute.plan_route(run, problem)
    }
}

/// Settings with the margins and the patience for ticks of up to 30 s and a vehicle of 3 m/s.
fn coarse() -> SyncSettings {
    let mut settings = SyncSettings::default();
    settings.margins.detour_margin = 0.003;
    settings.margins.detour_margin_s = 1.0;
    settings.margins.off_track_m = 5.0;
    settings.watchdogs.sonar_silence_s = 120.0;
    settings
}
