//! Random problems of every kind: a path that the planner calls clear passes the independent verifier.

use auv_obstacles::{ObstacleId, Region};
use auv_ocean::{
    AnalyticBed, AnalyticCurrent, CurrentField, FlatBed, LambVortex, SeaBed, TidalConstituent,
    Undulation, UniformCurrent,
};
use auv_planning::{Budget, PathPlanner, PathProblem, Run, Vehicle};
use auv_pso_path::{PathSearch, PsoPath, SwarmSettings};
use auv_types::rand::RngExt;
use auv_types::{Bounds, ChaCha8Rng, Point3, Seed, Vector3, libm};
use auv_verify::verify_trajectory;

/// Problems of a full check.
const MANY: u64 = 100_000;

/// A problem with everything it borrows.
pub(crate) struct Drawn {
    start: Point3<f64>,
    target: Point3<f64>,
    start_velocity: Option<Vector3<f64>>,
    departure_s: f64,
    vehicle: Vehicle,
    bounds: Option<Bounds>,
    bed: Option<Box<dyn SeaBed>>,
    altitude: (f64, f64),
    current: Option<Box<dyn CurrentField>>,
    regions: Vec<Region>,
    clearance_m: f64,
}

impl Drawn {
    pub(crate) fn new(random: &mut ChaCha8Rng) -> Self {
        let chance = |random: &mut ChaCha8Rng, share: f64| random.random_range(0.0..1.0) < share;
        let size_m = [150.0, 600.0, 2_500.0][random.random_range(0..3)];
        let place = |random: &mut ChaCha8Rng| {
            let mut draw = |low: f64, high: f64| random.random_range(low..high);
            Point3::new(draw(0.0, size_m), draw(0.0, size_m), draw(5.0, 90.0))
        };
        let (start, target) = (place(random), place(random));
        let mut vehicle = if chance(random, 0.5) {
            Vehicle::paper()
        } else {
            Vehicle::default()
        };
        if chance(random, 0.2) {
            vehicle.turn_radius_m = random.random_range(0.0..60.0);
        }
        if chance(random, 0.2) {
            vehicle.max_pitch_rad = random.random_range(0.05..1.0);
        }
        let heading = random.random_range(0.0..std::f64::consts::TAU);
        let level = Vector3::new(libm::cos(heading), libm::sin(heading), 0.0);
        let start_velocity = chance(random, 0.5).then(|| level * vehicle.speed_mps);
        let most = [3, 12, 60][random.random_range(0..3)];
        let departure_s = if chance(random, 0.5) { 0.0 } else { 5_000.0 };
        let regions = (0..random.random_range(0..=most))
            .map(|i| region(random, ObstacleId(i), (start, target), size_m, departure_s))
            .collect();
        let margin_m = random.random_range(0.0..200.0);
        let bounds = chance(random, 0.5).then(|| {
            let low = Point3::new(-margin_m, -margin_m, 0.0);
            Bounds::new(low, Point3::new(size_m + margin_m, size_m + margin_m, 95.0))
        });
        Self {
            start,
            target,
            start_velocity,
            departure_s,
            vehicle,
            bounds,
            bed: bed(random),
            altitude: (random.random_range(0.0..8.0), random.random_range(0.0..3.0)),
            current: current(random, vehicle.speed_mps, size_m),
            regions,
            clearance_m: if chance(random, 0.5) {
                0.0
            } else {
                random.random_range(0.0..20.0)
            },
        }
    }

    pub(crate) fn problem(&self) -> PathProblem<'_> {
        PathProblem {
            start_velocity: self.start_velocity,
            departure_s: self.departure_s,
            bounds: self.bounds,
            sea_bed: self.bed.as_deref(),
            min_altitude_m: self.altitude.0,
            altitude_sigmas: self.altitude.1,
            current: self.current.as_deref(),
            regions: &self.regions,
            clearance_m: self.clearance_m,
            ..PathProblem::new(self.start, self.target, &self.vehicle)
        }
    }
}

/// A ball or cylinder near the straight line; some move and grow, some exist only for a while.
fn region(
    random: &mut ChaCha8Rng,
    obstacle: ObstacleId,
    (start, target): (Point3<f64>, Point3<f64>),
    size_m: f64,
    departure_s: f64,
) -> Region {
    let kind = random.random_range(0..6);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    let spread_m = 0.2 * size_m;
    let aside = Vector3::new(
        draw(-spread_m, spread_m),
        draw(-spread_m, spread_m),
        draw(-40.0, 40.0),
    );
    let middle = start + (target - start) * draw(-0.05, 1.05) + aside;
    let radius_m = draw(0.0, 0.08 * size_m);
    let mut region = if kind % 3 == 0 {
        let top_m = draw(-10.0, 80.0);
        let bottom_m = if draw(0.0, 1.0) < 0.3 {
            f64::INFINITY
        } else {
            top_m + draw(1.0, 60.0)
        };
        Region::cylinder(middle, radius_m, top_m, bottom_m)
    } else {
        Region::ball(middle, radius_m)
    };
    region.obstacle = obstacle;
    if kind >= 3 {
        region.at_s = departure_s + draw(-100.0, 100.0);
        region.velocity_mps = Vector3::new(draw(-1.0, 1.0), draw(-1.0, 1.0), draw(-0.1, 0.1));
        region.growth_mps = draw(-0.02, 0.1);
    }
    if kind == 5 {
        region.from_s = departure_s + draw(-100.0, 300.0);
        region.until_s = region.from_s + draw(0.0, 600.0);
    }
    region
}

fn bed(random: &mut ChaCha8Rng) -> Option<Box<dyn SeaBed>> {
    let kind = random.random_range(0..4);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    match kind {
        0 => Some(Box::new(FlatBed::new(draw(60.0, 150.0)))),
        1 => {
            let mut bed = AnalyticBed::new(draw(70.0, 130.0));
            bed.undulations.push(Undulation {
                amplitude_m: draw(0.0, 30.0),
                wavelength: [draw(100.0, 900.0), draw(-900.0, 900.0)],
            });
            Some(Box::new(bed))
        }
        _ => None,
    }
}

/// No current, a uniform one, or an eddy in a tide; sometimes too strong for the vehicle.
fn current(random: &mut ChaCha8Rng, speed_mps: f64, size_m: f64) -> Option<Box<dyn CurrentField>> {
    let kind = random.random_range(0..5);
    let mut draw = |low: f64, high: f64| random.random_range(low..high);
    let most_mps = speed_mps * if draw(0.0, 1.0) < 0.1 { 1.5 } else { 0.4 };
    match kind {
        0 => Some(Box::new(UniformCurrent::new(Vector3::new(
            draw(-most_mps, most_mps),
            draw(-most_mps, most_mps),
            0.0,
        )))),
        1 => Some(Box::new(AnalyticCurrent {
            tide: vec![TidalConstituent::turning_at(
                draw(0.0, 9_000.0),
                [draw(0.0, most_mps), 0.0],
            )],
            vortices: vec![LambVortex {
                centre: [draw(0.0, size_m), draw(0.0, size_m)],
                circulation_m2ps: draw(-1.0, 1.0) * most_mps * size_m,
                core_radius_m: draw(0.1, 0.5) * size_m,
            }],
            ..AnalyticCurrent::default()
        })),
        _ => None,
    }
}

/// Plans the problems and panics at the first path that is called clear and is not. Returns the
/// number called clear.
pub(crate) fn check(problems: std::ops::Range<u64>) -> u64 {
    let mut clear = 0;
    for index in problems {
        let mut random = Seed(77).stream(index);
        let drawn = Drawn::new(&mut random);
        let problem = drawn.problem();
        let search = if index % 20 == 19 {
            PathSearch::Swarm(SwarmSettings {
                particles: 16,
                iterations: 10,
                ..SwarmSettings::paper()
            })
        } else {
            PathSearch::default()
        };
        let evaluations = [1, 30, 200, 600][random.random_range(0..4)];
        let mut run = Run::new(Seed(index), Budget::evaluations(evaluations));
        let Ok(planned) = PsoPath::new(search).plan_path(&mut run, &problem) else {
            // Only a current can leave no path at all.
            assert!(problem.current.is_some(), "problem {index} has no answer");
            continue;
        };
        assert!(planned.stats.evaluations <= evaluations && planned.violation >= 0.0);
        if planned.violation == 0.0 {
            let report = verify_trajectory(&problem, &planned.best);
            assert!(report.is_valid(), "problem {index}: {report:?}");
            clear += 1;
        }
    }
    clear
}

#[test]
fn clear_paths_pass_the_verifier() {
    let count = 700;
    let clear = check(0..count);
    assert!(clear > count / 4, "only {clear} of {count} clear");
}

#[test]
fn a_stay_is_clear_where_the_verifier_says_so() {
    let (mut clear, mut blocked) = (0, 0);
    for index in 0..400 {
        let drawn = Drawn::new(&mut Seed(79).stream(index));
        let problem = PathProblem {
            target: drawn.start,
            ..drawn.problem()
        };
        let search = if index % 2 == 0 {
            PathSearch::default()
        } else {
            PathSearch::paper()
        };
        let mut run = Run::new(Seed(index), Budget::evaluations(10));
        let planned = PsoPath::new(search).plan_path(&mut run, &problem).unwrap();
        let report = verify_trajectory(&problem, &planned.best);
        assert_eq!(
            planned.violation == 0.0,
            report.is_valid(),
            "problem {index}: {} {report:?}",
            planned.violation
        );
        clear += usize::from(planned.violation == 0.0);
        blocked += usize::from(planned.violation > 0.0);
    }
    assert!(clear > 100 && blocked > 20, "{clear} clear, {blocked} not");
}

/// `AUV_PROBLEMS=100000 cargo test --release -p auv-pso-path -- --ignored many_clear`
#[test]
#[ignore = "takes minutes; AUV_PROBLEMS sets the number"]
fn many_clear_paths_pass_the_verifier() {
    let text = std::env::var("AUV_PROBLEMS").unwrap_or_default();
    check(0..text.parse().unwrap_or(MANY));
}
