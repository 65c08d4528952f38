//! One call of the path planner among the obstacles of a scenario.

use crate::output::internal;
use auv_examples::{Clock, Failure};
use auv_obstacles::truth::{Birth, LegObstacles, LegScenario, Obstacle, ObstacleClass};
use auv_obstacles::{ObstacleId, Region};
use auv_planning::{Budget, Generation, PathPlanner, PathProblem, Run, Trajectory, Vehicle};
use auv_pso_path::{PathSearch, PsoPath};
use auv_types::{Bounds, Point3, Seed, Vector3, libm};

/// The current of class 4, m/s: the paper's spread of 0.3 m/s, towards the north-east.
pub(crate) const CURRENT_MPS: f64 = 0.3;

/// Costs and violations of all particles at an iteration.
pub(crate) type Iteration = (Vec<f64>, Vec<f64>);
/// One of the two.
pub(crate) type Chosen = fn(&Iteration) -> &Vec<f64>;

/// One planning call.
pub(crate) struct SwarmRun {
    pub(crate) obstacles: Vec<Obstacle>,
    pub(crate) regions: Vec<Region>,
    pub(crate) path: Trajectory,
    pub(crate) violation: f64,
    pub(crate) cost: f64,
    pub(crate) cpu_s: f64,
    /// Costs and violations of all particles, by iteration.
    pub(crate) history: Vec<Iteration>,
}

impl SwarmRun {
    /// Whether the target lies within an obstacle when the path arrives there.
    pub(crate) fn end_covered(&self) -> bool {
        let at_s = self.path.end().time_s;
        self.regions
            .iter()
            .any(|region| (region.centre_at(at_s) - ends().1).norm() < region.radius_at(at_s))
    }
}

pub(crate) fn ends() -> (Point3<f64>, Point3<f64>) {
    (
        Point3::new(0.0, 0.0, 20.0),
        Point3::new(3000.0, 1500.0, 60.0),
    )
}

fn current() -> Vector3<f64> {
    let side = CURRENT_MPS * libm::sqrt(0.5);
    Vector3::new(side, side, 0.0)
}

/// The region that the planner gets for an obstacle: it moves as the obstacle does and its radius grows
/// linearly with time (class 3 by its jitter of 0.1 m/s, class 4 by the current's speed); class 2 at
/// two standard deviations (0.2 r) above its mean.
fn region(i: usize, obstacle: &Obstacle) -> Region {
    let (radius_m, velocity_mps, growth_mps) = match obstacle.class {
        ObstacleClass::Static => (obstacle.radius_m, Vector3::zeros(), 0.0),
        ObstacleClass::Uncertain => (1.4 * obstacle.radius_m, Vector3::zeros(), 0.0),
        ObstacleClass::Moving => (obstacle.radius_m, obstacle.velocity_mps, 0.1),
        ObstacleClass::Drifting => (
            obstacle.radius_m,
            obstacle.velocity_mps + current(),
            CURRENT_MPS,
        ),
    };
    Region {
        obstacle: ObstacleId(i as u32),
        at_s: obstacle.appears_s,
        from_s: obstacle.appears_s,
        velocity_mps,
        growth_mps,
        ..Region::ball(obstacle.centre, radius_m)
    }
}

pub(crate) fn fly(scenario: LegScenario, count: usize, seed: Seed) -> Result<SwarmRun, Failure> {
    let (from, to) = ends();
    let vehicle = Vehicle::paper();
    let drawn = LegObstacles {
        scenario,
        count,
        from,
        to,
        speed_mps: vehicle.speed_mps,
        current_mps: current(),
        birth: Birth::single_leg(),
    };
    let obstacles = drawn.generate(seed.split(0));
    let regions: Vec<Region> = obstacles
        .iter()
        .enumerate()
        .map(|(i, o)| region(i, o))
        .collect();
    let problem = PathProblem {
        regions: &regions,
        bounds: Some(Bounds::new(
            Point3::new(-1000.0, -1000.0, 0.0),
            Point3::new(4000.0, 2500.0, 1000.0),
        )),
        ..PathProblem::new(from, to, &vehicle)
    };
    let mut history = Vec::new();
    let mut observer = |generation: &Generation<'_>| {
        history.push((generation.costs.to_vec(), generation.violations.to_vec()))
    };
    let clock = Clock::start();
    let mut run = Run::new(seed.split(1), Budget::to_the_cap()).with_observer(&mut observer);
    let planned = PsoPath::new(PathSearch::paper())
        .plan_path(&mut run, &problem)
        .map_err(internal)?;
    let cpu_s = clock.elapsed_ms() / 1e3;
    Ok(SwarmRun {
        path: planned.best,
        violation: planned.violation,
        cost: planned.cost,
        cpu_s,
        history,
        obstacles,
        regions,
    })
}
