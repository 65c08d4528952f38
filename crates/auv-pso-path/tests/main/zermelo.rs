//! Zermelo's problem: the quickest way across a steady flow, against the optimal heading law.

use auv_ocean::CurrentField;
use auv_planning::{Budget, PathPlanner, PathProblem, Run, Vehicle};
use auv_pso_path::{PathSearch, PsoPath};
use auv_types::{Bounds, Point3, Seed, Vector3, libm};

const SPEED_MPS: f64 = 1.5;

/// A steady flow over ground.
#[derive(Clone, Copy, Debug)]
enum Flow {
    /// North with a speed that grows to the east, per second.
    Shear(f64),
    /// A Lamb-Oseen vortex at a place, with its circulation in m2/s and the radius of its core in metres.
    Vortex([f64; 2], f64, f64),
}

impl Flow {
    fn at(self, [x, y]: [f64; 2]) -> [f64; 2] {
        match self {
            Self::Shear(gradient) => [gradient * y, 0.0],
            Self::Vortex(centre, circulation, core_m) => {
                let (dx, dy) = (x - centre[0], y - centre[1]);
                let square = (dx * dx + dy * dy).max(1e-12);
                let inside = 1.0 - libm::exp(-square / (core_m * core_m));
                let spin = circulation / std::f64::consts::TAU / square * inside;
                [-spin * dy, spin * dx]
            }
        }
    }

    /// Rates of place and heading by the law: x, y, heading.
    fn rates(self, [x, y, heading]: [f64; 3]) -> [f64; 3] {
        const STEP_M: f64 = 0.01;
        let (sin, cos) = (libm::sin(heading), libm::cos(heading));
        let change = |k: usize| {
            let mut ends = [[x, y]; 2];
            ends[0][k] -= STEP_M;
            ends[1][k] += STEP_M;
            let [before, after] = ends.map(|end| self.at(end));
            [0, 1].map(|i| (after[i] - before[i]) / (2.0 * STEP_M))
        };
        let ([u_x, v_x], [u_y, v_y]) = (change(0), change(1));
        let [u, v] = self.at([x, y]);
        let turn = sin * sin * v_x + sin * cos * (u_x - v_y) - cos * cos * u_y;
        [SPEED_MPS * cos + u, SPEED_MPS * sin + v, turn]
    }

    /// Where a vehicle that begins with a heading is when it has come `ahead_m` north, and when.
    fn flown(self, heading: f64, ahead_m: f64) -> Option<(f64, f64)> {
        const STEP_S: f64 = 4.0;
        let (mut at, mut time_s) = ([0.0, 0.0, heading], 0.0);
        while time_s < 5_000.0 {
            let moved =
                |rates: [f64; 3], step_s: f64| [0, 1, 2].map(|k: usize| at[k] + step_s * rates[k]);
            let a = self.rates(at);
            let b = self.rates(moved(a, 0.5 * STEP_S));
            let c = self.rates(moved(b, 0.5 * STEP_S));
            let d = self.rates(moved(c, STEP_S));
            let next = [0, 1, 2]
                .map(|k: usize| at[k] + STEP_S / 6.0 * (a[k] + 2.0 * (b[k] + c[k]) + d[k]));
            if next[0] >= ahead_m {
                let share = (ahead_m - at[0]) / (next[0] - at[0]);
                return Some((at[1] + share * (next[1] - at[1]), time_s + share * STEP_S));
            }
            (at, time_s) = (next, time_s + STEP_S);
        }
        None
    }

    /// The least time to a place straight north: of all headings that the law leads there.
    fn least_s(self, ahead_m: f64) -> f64 {
        const HEADINGS: i32 = 24;
        let heading = |k: i32| 1.2 * f64::from(k) / f64::from(HEADINGS);
        let miss = |heading: f64| self.flown(heading, ahead_m).map(|(east_m, _)| east_m);
        let mut least_s = f64::INFINITY;
        for k in -HEADINGS..HEADINGS {
            let (mut low, mut high) = (heading(k), heading(k + 1));
            let (Some(a), Some(b)) = (miss(low), miss(high)) else {
                continue;
            };
            if a * b > 0.0 || (a - b).abs() > 0.2 * ahead_m {
                continue;
            }
            for _ in 0..40 {
                let middle = 0.5 * (low + high);
                match miss(middle) {
                    Some(m) if m * a > 0.0 => low = middle,
                    _ => high = middle,
                }
            }
            if let Some((_, time_s)) = self.flown(low, ahead_m) {
                least_s = least_s.min(time_s);
            }
        }
        least_s
    }
}

impl CurrentField for Flow {
    fn velocity_at(&self, position: &Point3<f64>, _time_s: f64) -> Vector3<f64> {
        let [u, v] = self.at([position.x, position.y]);
        Vector3::new(u, v, 0.0)
    }

    fn max_speed_mps(&self) -> f64 {
        match *self {
            Self::Shear(gradient) => gradient.abs() * 2_000.0,
            // The greatest speed of the vortex lies 1.12 core radii from its centre.
            Self::Vortex(_, circulation, core_m) => 0.1016 * circulation.abs() / core_m,
        }
    }
}

#[test]
fn the_quickest_way_across_a_flow_follows_the_optimal_heading_law() {
    let vehicle = Vehicle {
        speed_mps: SPEED_MPS,
        max_speed_mps: 1.005 * SPEED_MPS,
        ..Vehicle::paper()
    };
    let flows = [
        Flow::Shear(4e-4),
        Flow::Shear(-1.2e-3),
        Flow::Vortex([1_000.0, 150.0], 2_500.0, 250.0),
        Flow::Vortex([800.0, -300.0], -4_000.0, 400.0),
    ];
    for flow in flows {
        let target = Point3::new(2_000.0, 0.0, 20.0);
        let problem = PathProblem {
            current: Some(&flow),
            bounds: Some(Bounds::new(
                Point3::new(-1_000.0, -2_000.0, 19.0),
                Point3::new(3_000.0, 2_000.0, 21.0),
            )),
            ..PathProblem::new(Point3::new(0.0, 0.0, 20.0), target, &vehicle)
        };
        let mut run = Run::new(Seed(0), Budget::evaluations(40_000));
        let planner = PsoPath::new(PathSearch::default());
        let planned = planner.plan_path(&mut run, &problem).unwrap();
        assert_eq!(planned.violation, 0.0);
        let (found_s, least_s) = (planned.best.duration_s(), flow.least_s(2_000.0));
        let gap = found_s / least_s - 1.0;
        assert!(
            gap.abs() < 1e-4,
            "{flow:?}: {found_s} s, {least_s} s by the law"
        );
    }
}
