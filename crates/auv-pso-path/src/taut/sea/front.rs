//! The earliest arrival everywhere: a front that spreads over a lattice, each node labelled with the time at
//! which it is reached (Dijkstra's algorithm, with the remaining distance as an admissible bound).

use crate::taut::regions::GrownRegions;
use crate::taut::sea::chart::Chart;
use crate::taut::sea::tide::Tide;
use auv_obstacles::TimedPoint;
use auv_planning::motion::speed_over_ground_mps;
use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, libm};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Nodes between two looks at the deadline.
const BETWEEN_LOOKS: u64 = 64;
/// Units of work of one step to another node.
pub(crate) const STEP_WORK: u64 = 3;

/// Steps from a node to others: all directions with coordinates up to a reach that are no multiples of
/// shorter ones.
#[derive(Clone, Debug)]
pub(crate) struct Stencil {
    steps: Vec<[isize; 3]>,
}

impl Stencil {
    /// The steps over ground of up to `reach` cells, each also one level up and down where there are
    /// levels.
    pub(crate) fn new(chart: &Chart<'_>, reach: isize) -> Self {
        let span = |axis: usize, most: isize| {
            let most = if chart.counts[axis] > 1 { most } else { 0 };
            -most..=most
        };
        let upright = chart.counts[1] == 1;
        let levels = if upright { reach } else { 1 };
        let mut steps = Vec::new();
        for row in span(0, reach) {
            for column in span(1, reach) {
                for level in span(2, levels) {
                    let over_ground = gcd(row.unsigned_abs(), column.unsigned_abs());
                    let whole = gcd(over_ground, level.unsigned_abs());
                    let sloping = !upright && level != 0 && over_ground <= 1;
                    if whole == 1 && (over_ground == 1 || upright || sloping) {
                        steps.push([row, column, level]);
                    }
                }
            }
        }
        Self { steps }
    }

    pub(crate) fn len(&self) -> usize {
        self.steps.len()
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

/// A node to be settled, the earliest first; of equals the lowest.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Next {
    bound_s: f64,
    node: usize,
}

impl Eq for Next {}

impl PartialOrd for Next {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Next {
    fn cmp(&self, other: &Self) -> Ordering {
        let by_time = other.bound_s.total_cmp(&self.bound_s);
        by_time.then(other.node.cmp(&self.node))
    }
}

/// A front over a lattice.
#[derive(Debug)]
pub(crate) struct Front<'a> {
    problem: &'a PathProblem<'a>,
    regions: &'a GrownRegions,
    chart: &'a Chart<'a>,
    tide: &'a Tide,
    places: Vec<Option<Point3<f64>>>,
    times_s: Vec<f64>,
    parents: Vec<u32>,
    settled: Vec<bool>,
    slope: f64,
}

impl<'a> Front<'a> {
    pub(crate) fn new(
        problem: &'a PathProblem<'a>,
        regions: &'a GrownRegions,
        chart: &'a Chart<'a>,
        tide: &'a Tide,
    ) -> Self {
        let nodes = chart.nodes();
        let free = problem.vehicle.max_pitch_rad >= std::f64::consts::FRAC_PI_2;
        Self {
            problem,
            regions,
            chart,
            tide,
            places: (0..nodes).map(|i| chart.place(i)).collect(),
            times_s: vec![f64::INFINITY; nodes],
            parents: vec![u32::MAX; nodes],
            settled: vec![false; nodes],
            slope: if free {
                f64::INFINITY
            } else {
                libm::tan(problem.vehicle.max_pitch_rad)
            },
        }
    }

    /// Spreads from the start, left at `departure_s`, until it reaches the target. Nodes from which the
    /// target cannot be reached by `latest_s` are left out. Returns the way to the target and the work;
    /// `None` where there is no way or the deadline passes first.
    pub(crate) fn spread(
        &mut self,
        stencil: &Stencil,
        departure_s: f64,
        latest_s: f64,
        deadline: Deadline<'_>,
    ) -> (Option<Vec<Point3<f64>>>, u64) {
        let (start, target) = (self.chart.start_node(), self.chart.target_node());
        let fastest_mps = self.problem.vehicle.speed_mps + self.tide.most_mps();
        let goal = self.problem.target;
        let left_s = |place: &Point3<f64>| (goal - place).norm() / fastest_mps;
        let mut queue = BinaryHeap::new();
        self.times_s[start] = departure_s;
        queue.push(Next {
            bound_s: departure_s,
            node: start,
        });
        let (mut popped, mut work) = (0_u64, 0_u64);
        while let Some(Next { node, .. }) = queue.pop() {
            if std::mem::replace(&mut self.settled[node], true) {
                continue;
            }
            if node == target {
                return (Some(self.way_to(target)), work);
            }
            popped += 1;
            if popped % BETWEEN_LOOKS == 0 && deadline.passed() {
                break;
            }
            work += STEP_WORK * stencil.len() as u64;
            let at = self.chart.node(node);
            for step in &stencil.steps {
                let Some(next) = self.beside(at, *step) else {
                    continue;
                };
                let Some(time_s) = self.reach(node, next, &mut work) else {
                    continue;
                };
                let Some(place) = self.places[next] else {
                    continue;
                };
                let bound_s = time_s + left_s(&place);
                if bound_s < latest_s {
                    self.times_s[next] = time_s;
                    self.parents[next] = node as u32;
                    queue.push(Next {
                        bound_s,
                        node: next,
                    });
                }
            }
        }
        (None, work)
    }

    /// The node a step away, if it lies on the lattice and is not settled.
    fn beside(&self, at: [usize; 3], step: [isize; 3]) -> Option<usize> {
        let mut to = [0; 3];
        for k in 0..3 {
            to[k] = at[k].checked_add_signed(step[k])?;
            if to[k] >= self.chart.counts[k] {
                return None;
            }
        }
        Some(self.chart.index(to)).filter(|&next| !self.settled[next])
    }

    /// When a node is reached from another, if that is earlier than known and the way is clear.
    fn reach(&self, from: usize, to: usize, work: &mut u64) -> Option<f64> {
        let (a, b) = (self.places[from]?, self.places[to]?);
        let way = b - a;
        let length_m = way.norm();
        let direction = way / length_m.max(1e-9);
        let (begin_s, speed_mps) = (self.times_s[from], self.problem.vehicle.speed_mps);
        let mut time_s = begin_s + length_m / speed_mps;
        if self.problem.current.is_some() {
            let here = self.tide.at(from, begin_s);
            let there = self.tide.at(to, time_s);
            let (here, there) = (
                speed_over_ground_mps(speed_mps, &direction, &here)?,
                speed_over_ground_mps(speed_mps, &direction, &there)?,
            );
            time_s = begin_s + 0.5 * length_m * (1.0 / here + 1.0 / there);
        }
        if time_s >= self.times_s[to] {
            return None;
        }
        let steep = way.z.abs() > self.slope * libm::hypot(way.x, way.y) + 1e-9;
        if steep || !self.chart.is_clear((from, a.z), (to, b.z)) {
            return None;
        }
        let mut clear = true;
        if !self.problem.regions.is_empty() {
            let (begin, end) = (TimedPoint::new(a, begin_s), TimedPoint::new(b, time_s));
            *work += self
                .regions
                .contacts(&begin, &end, |_, contact| clear &= contact.gap_m >= 0.0);
        }
        clear.then_some(time_s)
    }

    fn way_to(&self, target: usize) -> Vec<Point3<f64>> {
        let mut way = Vec::new();
        let mut node = target;
        loop {
            way.extend(self.places[node]);
            match self.parents[node] {
                u32::MAX => break,
                before => node = before as usize,
            }
        }
        way.reverse();
        way
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taut::sea::chart::Extent;
    use auv_obstacles::Region;
    use auv_ocean::{AnalyticCurrent, LambVortex};
    use auv_planning::{Budget, Run, Vehicle};
    use auv_types::{Seed, Vector3, rand::RngExt};

    /// Arrival at the target by relaxing all steps until nothing changes.
    fn slow_s(front: &Front<'_>, stencil: &Stencil) -> f64 {
        let chart = front.chart;
        let mut fresh = Front::new(front.problem, front.regions, chart, front.tide);
        fresh.times_s[chart.start_node()] = 0.0;
        let mut changed = true;
        while changed {
            changed = false;
            for node in 0..chart.nodes() {
                for step in &stencil.steps {
                    let next = fresh.beside(chart.node(node), *step);
                    let from_known = fresh.times_s[node].is_finite();
                    let later = next.filter(|_| from_known);
                    if let Some(next) = later
                        && let Some(time_s) = fresh.reach(node, next, &mut 0)
                    {
                        fresh.times_s[next] = time_s;
                        changed = true;
                    }
                }
            }
        }
        fresh.times_s[chart.target_node()]
    }

    #[test]
    fn it_arrives_as_early_as_relaxing_all_steps() {
        let vehicle = Vehicle::paper();
        let mut random = Seed(3).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let mut bent = 0;
        for _ in 0..10 {
            let current = AnalyticCurrent {
                vortices: vec![LambVortex {
                    centre: [draw(0.0, 900.0), draw(-200.0, 200.0)],
                    circulation_m2ps: draw(-3_000.0, 3_000.0),
                    core_radius_m: 120.0,
                }],
                ..AnalyticCurrent::default()
            };
            let mut ball = Region::ball(Point3::new(450.0, draw(-60.0, 60.0), 20.0), 90.0);
            ball.velocity_mps = Vector3::new(0.0, draw(-0.2, 0.2), 0.0);
            let regions = [ball];
            let problem = PathProblem {
                current: Some(&current),
                regions: &regions,
                ..PathProblem::new(
                    Point3::new(0.0, 0.0, 20.0),
                    Point3::new(900.0, 0.0, 20.0),
                    &vehicle,
                )
            };
            let grown = GrownRegions::new(&problem, 0.0, false);
            let run = Run::new(Seed(0), Budget::to_the_cap());
            let chart = Chart::new(&problem, problem.start, 9, Extent::Level, run.deadline());
            let chart = chart.unwrap();
            let tide = Tide::new(&problem, &chart, 0.0, run.deadline()).unwrap();
            let stencil = Stencil::new(&chart, 3);
            let mut front = Front::new(&problem, &grown, &chart, &tide);
            let (way, _) = front.spread(&stencil, 0.0, f64::INFINITY, run.deadline());
            let way = way.unwrap();
            assert_eq!(
                (way[0], way[way.len() - 1]),
                (problem.start, problem.target)
            );
            let found_s = front.times_s[chart.target_node()];
            assert!((found_s - slow_s(&front, &stencil)).abs() < 1e-9 * found_s);
            bent += usize::from(way.len() > 2);
        }
        assert!(bent > 5);
    }

    #[test]
    fn directions_are_no_multiples_of_each_other() {
        let vehicle = Vehicle::paper();
        let problem = PathProblem::new(
            Point3::new(0.0, 0.0, 20.0),
            Point3::new(900.0, 0.0, 20.0),
            &vehicle,
        );
        let run = Run::new(Seed(0), Budget::to_the_cap());
        let chart = Chart::new(&problem, problem.start, 20, Extent::Level, run.deadline());
        let chart = chart.unwrap();
        let counts = [1, 2, 3, 4, 5].map(|reach| Stencil::new(&chart, reach).len());
        assert_eq!(counts, [8, 16, 32, 48, 80]);
    }
}
