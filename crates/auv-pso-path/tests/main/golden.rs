//! Fixed-seed answers of the three presets, compared with committed files.

use crate::random_problems::Drawn;
use auv_obstacles::{ObstacleId, Region};
use auv_ocean::{
    AnalyticBed, AnalyticCurrent, CurrentField, FlatBed, LambVortex, SeaBed, Undulation,
    UniformCurrent,
};
use auv_planning::{
    Budget, PathPlanner, PathProblem, PlanError, Planned, Run, Trajectory, Vehicle,
};
use auv_pso_path::{PathSearch, PsoPath, SwarmSettings};
use auv_types::{Bounds, Point3, Seed, Vector3};
use serde_json::{Value, json};

/// A path problem with everything it borrows.
struct Scene {
    name: &'static str,
    start: Point3<f64>,
    target: Point3<f64>,
    start_velocity: Option<Vector3<f64>>,
    departure_s: f64,
    vehicle: Vehicle,
    bounds: Option<Bounds>,
    bed: Option<Box<dyn SeaBed>>,
    current: Option<Box<dyn CurrentField>>,
    regions: Vec<Region>,
    clearance_m: f64,
    /// Waypoints of the trajectory in force.
    warm: Option<Vec<Point3<f64>>>,
}

impl Scene {
    /// A leg of 1 km in open, still water.
    fn open(name: &'static str) -> Self {
        Self {
            name,
            start: Point3::new(0.0, 0.0, 50.0),
            target: Point3::new(1_000.0, 0.0, 60.0),
            start_velocity: None,
            departure_s: 0.0,
            vehicle: Vehicle::paper(),
            bounds: None,
            bed: None,
            current: None,
            regions: Vec::new(),
            clearance_m: 5.0,
            warm: None,
        }
    }

    fn with_regions(name: &'static str, regions: Vec<Region>) -> Self {
        Self {
            regions,
            ..Self::open(name)
        }
    }

    fn answer(&self, search: PathSearch, evaluations: u64) -> Value {
        let mut problem = PathProblem {
            start_velocity: self.start_velocity,
            departure_s: self.departure_s,
            bounds: self.bounds,
            sea_bed: self.bed.as_deref(),
            min_altitude_m: 3.0,
            altitude_sigmas: 1.0,
            current: self.current.as_deref(),
            regions: &self.regions,
            clearance_m: self.clearance_m,
            ..PathProblem::new(self.start, self.target, &self.vehicle)
        };
        let warm = self
            .warm
            .as_ref()
            .map(|points| problem.timed(points).unwrap());
        problem.warm_start = warm.as_ref();
        answer(&problem, search, Seed(11), evaluations)
    }
}

/// FNV-1a over the bits of all points and times.
fn fnv(trajectory: &Trajectory) -> String {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for point in trajectory.points() {
        let at = point.position;
        for value in [at.x, at.y, at.z, point.time_s] {
            for byte in value.to_bits().to_le_bytes() {
                hash = (hash ^ u64::from(byte)).wrapping_mul(0x0100_0000_01b3);
            }
        }
    }
    format!("{hash:016x}")
}

fn plan(
    problem: &PathProblem<'_>,
    search: PathSearch,
    seed: Seed,
    evaluations: u64,
) -> Result<Planned<Trajectory>, PlanError> {
    let mut run = Run::new(seed, Budget::evaluations(evaluations));
    PsoPath::new(search).plan_path(&mut run, problem)
}

fn answer(problem: &PathProblem<'_>, search: PathSearch, seed: Seed, evaluations: u64) -> Value {
    match plan(problem, search, seed, evaluations) {
        Err(error) => json!({ "error": error.to_string() }),
        Ok(planned) => {
            let points = planned.best.points();
            let middle = points[points.len() / 2];
            json!({
                "cost": planned.cost,
                "violation": planned.violation,
                "bound": planned.bound,
                "blocked_by": planned.blocked_by.map(|obstacle| obstacle.0),
                "evaluations": planned.stats.evaluations,
                "generations": planned.stats.generations,
                "stop": format!("{:?}", planned.stats.stop),
                "points": points.len(),
                "middle": [middle.position.x, middle.position.y, middle.position.z, middle.time_s],
                "fnv": fnv(&planned.best),
            })
        }
    }
}

fn ball(x: f64, y: f64, radius_m: f64) -> Region {
    Region::ball(Point3::new(x, y, 52.0), radius_m)
}

fn moving(x: f64, y: f64, radius_m: f64, velocity: [f64; 3], growth_mps: f64) -> Region {
    Region {
        velocity_mps: Vector3::from(velocity),
        growth_mps,
        ..ball(x, y, radius_m)
    }
}

fn numbered(mut regions: Vec<Region>) -> Vec<Region> {
    for (i, region) in regions.iter_mut().enumerate() {
        region.obstacle = ObstacleId(i as u32);
    }
    regions
}

fn crossing_traffic() -> Vec<Region> {
    let mut regions = vec![
        moving(300.0, 180.0, 50.0, [0.0, -1.5, 0.0], 0.05),
        moving(550.0, -100.0, 70.0, [-0.4, 0.6, 0.02], 0.0),
        moving(760.0, 40.0, 60.0, [0.2, 0.1, 0.0], 0.1),
    ];
    regions[2].from_s = 100.0;
    regions[2].until_s = 400.0;
    numbered(regions)
}

fn crowd() -> Vec<Region> {
    let regions = (0..120)
        .map(|k: u32| {
            let (x, y) = (
                f64::from(k * 37 % 840) + 80.0,
                f64::from(k * 53 % 240) - 120.0,
            );
            let z = f64::from(k * 29 % 80) + 10.0;
            let drift = f64::from(k % 5) * 0.1 - 0.2;
            Region {
                velocity_mps: Vector3::new(drift, -drift, 0.0),
                ..Region::ball(Point3::new(x, y, z), 8.0 + f64::from(k % 7) * 3.0)
            }
        })
        .collect();
    numbered(regions)
}

/// Three balls near the straight line.
fn balls() -> Vec<Region> {
    numbered(vec![
        ball(300.0, 10.0, 60.0),
        ball(560.0, -30.0, 90.0),
        ball(800.0, 25.0, 40.0),
    ])
}

fn scenes() -> Vec<Scene> {
    let mut scenes = among_regions();
    scenes.extend(with_limits());
    scenes.extend(in_currents());
    scenes.extend(special_ends());
    scenes
}

fn among_regions() -> Vec<Scene> {
    let cylinders = vec![
        Region::cylinder(Point3::new(350.0, 15.0, 0.0), 80.0, 0.0, 90.0),
        Region::cylinder(Point3::new(650.0, -25.0, 0.0), 90.0, 40.0, f64::INFINITY),
    ];
    vec![
        Scene::open("open"),
        Scene::with_regions("one_ball", vec![ball(500.0, 20.0, 100.0)]),
        Scene::with_regions("three_balls", balls()),
        Scene::with_regions("traffic", crossing_traffic()),
        Scene::with_regions("cylinders", numbered(cylinders)),
        Scene::with_regions("crowd", crowd()),
        Scene {
            warm: Some(vec![
                Point3::new(0.0, 0.0, 50.0),
                Point3::new(500.0, -140.0, 50.0),
                Point3::new(1_000.0, 0.0, 60.0),
            ]),
            ..Scene::with_regions("warm_start", balls())
        },
    ]
}

fn with_limits() -> Vec<Scene> {
    let mut undulating = AnalyticBed::new(75.0);
    undulating.undulations.push(Undulation {
        amplitude_m: 12.0,
        wavelength: [330.0, 0.0],
    });
    vec![
        Scene {
            vehicle: Vehicle::default(),
            start_velocity: Some(Vector3::new(-0.6, 1.3, 0.0)),
            departure_s: 500.0,
            ..Scene::with_regions("turn_and_pitch", balls())
        },
        Scene {
            vehicle: Vehicle::default(),
            target: Point3::new(60.0, 30.0, 140.0),
            ..Scene::open("steep")
        },
        Scene {
            bed: Some(Box::new(undulating)),
            bounds: Some(Bounds::new(
                Point3::new(-50.0, -150.0, 0.0),
                Point3::new(1_050.0, 150.0, 100.0),
            )),
            ..Scene::with_regions("bed_and_box", balls())
        },
    ]
}

fn in_currents() -> Vec<Scene> {
    let uniform = |north_mps: f64, east_mps: f64| {
        let current = UniformCurrent::new(Vector3::new(north_mps, east_mps, 0.0));
        Some(Box::new(current) as Box<dyn CurrentField>)
    };
    let vortex = AnalyticCurrent {
        vortices: vec![LambVortex {
            centre: [500.0, 100.0],
            circulation_m2ps: 900.0,
            core_radius_m: 120.0,
        }],
        ..AnalyticCurrent::default()
    };
    vec![
        Scene {
            current: uniform(-0.8, 0.5),
            ..Scene::with_regions("even_current", crossing_traffic())
        },
        Scene {
            current: Some(Box::new(vortex)),
            ..Scene::with_regions("vortex", balls())
        },
        Scene {
            current: uniform(-4.0, 0.0),
            ..Scene::open("current_too_strong")
        },
    ]
}

fn special_ends() -> Vec<Scene> {
    let covering = vec![ball(500.0, 0.0, 60.0), ball(990.0, 5.0, 60.0)];
    vec![
        Scene::with_regions("blocked_target", numbered(covering)),
        Scene {
            bed: Some(Box::new(FlatBed::new(58.0))),
            ..Scene::with_regions("target_below_bed", balls())
        },
        Scene {
            target: Point3::new(0.0, 0.0, 50.0),
            ..Scene::with_regions("start_is_target", vec![ball(10.0, 0.0, 60.0)])
        },
    ]
}

fn check(name: &str, search: PathSearch, evaluations: u64) {
    let answers: serde_json::Map<_, _> = scenes()
        .iter()
        .map(|scene| (scene.name.into(), scene.answer(search, evaluations)))
        .collect();
    auv_golden::check(env!("CARGO_MANIFEST_DIR"), name, &answers.into()).unwrap();
}

#[test]
fn the_papers_swarm_answers_as_committed() {
    check("paper", PathSearch::paper(), 1_900);
}

#[test]
fn the_standard_swarm_answers_as_committed() {
    check("standard", PathSearch::standard(), 1_900);
}

#[test]
fn the_default_planner_answers_as_committed() {
    check("default", PathSearch::default(), 600);
}

/// One hash a problem, so that a difference names the problem.
#[test]
fn random_problems_are_answered_as_committed() {
    let answers: Vec<Value> = (0..240)
        .map(|index| {
            let drawn = Drawn::new(&mut Seed(78).stream(index));
            let search = if index % 12 == 11 {
                PathSearch::Swarm(SwarmSettings {
                    particles: 16,
                    iterations: 10,
                    ..SwarmSettings::paper()
                })
            } else {
                PathSearch::default()
            };
            plan(&drawn.problem(), search, Seed(index), 250).map_or_else(
                |error| json!(error.to_string()),
                |planned| {
                    json!(format!(
                        "{} {:016x}",
                        fnv(&planned.best),
                        planned.violation.to_bits()
                    ))
                },
            )
        })
        .collect();
    auv_golden::check(
        env!("CARGO_MANIFEST_DIR"),
        "random_problems",
        &answers.into(),
    )
    .unwrap();
}
