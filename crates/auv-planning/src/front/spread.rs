//! The earliest arrival everywhere: a front that spreads over a lattice, each node labelled with the time at
//! which it is reached (Dijkstra's algorithm, to one goal with the remaining distance as an admissible bound).

use super::lattice::Lattice;
use super::stencil::Stencil;
use super::tide::Tide;
use crate::motion::speed_over_ground_mps;
use crate::{Deadline, Vehicle};
use auv_obstacles::TimedPoint;
use auv_types::{Point3, Vector3, libm};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// Nodes between two looks at the deadline.
const BETWEEN_LOOKS: u64 = 64;
/// Units of work of one step to another node.
pub const STEP_WORK: u64 = 3;
/// A way may be steeper than the pitch allows by this rounding, metres.
const ROUNDING_M: f64 = 1e-9;

/// Where and when a front spreads.
#[derive(Clone, Copy, Debug)]
pub struct Spread<'a> {
    /// The node that it starts from.
    pub from: usize,
    /// It ends when all of these nodes are reached; without any it reaches all nodes that it can.
    pub goals: &'a [usize],
    /// When it leaves, mission time in seconds.
    pub departure_s: f64,
    /// Nodes from which a single goal cannot be reached before this time are left out, mission time in
    /// seconds.
    pub latest_s: f64,
    /// When to stop.
    pub deadline: Deadline<'a>,
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

/// A node from which the front goes on.
#[derive(Debug)]
struct Departure {
    node: usize,
    at: TimedPoint,
    water: Vector3<f64>,
}

/// A front over a lattice.
#[derive(Debug)]
pub struct Front<'a> {
    speed_mps: f64,
    /// No metre takes less time, with a margin for rounding.
    least_s_per_m: f64,
    lattice: &'a Lattice,
    tide: &'a Tide,
    times_s: Vec<f64>,
    parents: Vec<u32>,
    settled: Vec<bool>,
    /// Greatest change of depth per horizontal metre; infinite without a pitch limit.
    slope: f64,
}

impl<'a> Front<'a> {
    /// A front that has not left yet.
    #[must_use]
    pub fn new(vehicle: &Vehicle, lattice: &'a Lattice, tide: &'a Tide) -> Self {
        let nodes = lattice.nodes();
        let free = vehicle.max_pitch_rad >= std::f64::consts::FRAC_PI_2;
        Self {
            speed_mps: vehicle.speed_mps,
            least_s_per_m: (1.0 - 1e-9) / (vehicle.speed_mps + tide.most_mps()),
            lattice,
            tide,
            times_s: vec![f64::INFINITY; nodes],
            parents: vec![u32::MAX; nodes],
            settled: vec![false; nodes],
            slope: if free {
                f64::INFINITY
            } else {
                libm::tan(vehicle.max_pitch_rad)
            },
        }
    }

    /// Spreads along the steps of a stencil that are clear. Returns whether it reached all goals before the
    /// deadline, and the units of work.
    pub fn spread(
        &mut self,
        stencil: &Stencil,
        spread: &Spread<'_>,
        mut is_clear: impl FnMut(&TimedPoint, &TimedPoint) -> bool,
    ) -> (bool, u64) {
        let goal = match spread.goals {
            &[goal] => self.lattice.place(goal),
            _ => None,
        };
        let fastest_mps = self.speed_mps + self.tide.most_mps();
        let left_s = |place: &Point3<f64>| goal.map_or(0.0, |g| (g - place).norm() / fastest_mps);
        let mut queue = BinaryHeap::new();
        self.times_s[spread.from] = spread.departure_s;
        queue.push(Next {
            bound_s: spread.departure_s,
            node: spread.from,
        });
        let (mut popped, mut work, mut missing) = (0_u64, 0_u64, spread.goals.len());
        while let Some(Next { node, .. }) = queue.pop() {
            if std::mem::replace(&mut self.settled[node], true) {
                continue;
            }
            missing -= usize::from(spread.goals.contains(&node));
            if missing == 0 && !spread.goals.is_empty() {
                return (true, work);
            }
            popped += 1;
            if popped.is_multiple_of(BETWEEN_LOOKS) && spread.deadline.passed() {
                break;
            }
            work += STEP_WORK * stencil.steps().len() as u64;
            let at = self.lattice.node(node);
            let Some(from) = self.departure(node) else {
                continue;
            };
            for step in stencil.steps() {
                let Some(next) = self.beside(at, *step) else {
                    continue;
                };
                let Some((time_s, place)) = self.reach(&from, next, &mut is_clear) else {
                    continue;
                };
                let bound_s = time_s + left_s(&place);
                if bound_s < spread.latest_s {
                    self.times_s[next] = time_s;
                    self.parents[next] = node as u32;
                    queue.push(Next {
                        bound_s,
                        node: next,
                    });
                }
            }
        }
        (false, work)
    }

    /// When a node is reached, mission time in seconds; infinite where it is not.
    #[must_use]
    pub fn time_s(&self, node: usize) -> f64 {
        self.times_s[node]
    }

    /// The nodes on the way to a node that is reached, ends included.
    #[must_use]
    pub fn way_to(&self, node: usize) -> Vec<usize> {
        let mut way = vec![node];
        let mut at = node;
        while self.parents[at] != u32::MAX {
            at = self.parents[at] as usize;
            way.push(at);
        }
        way.reverse();
        way
    }

    /// The node a step away, if it lies on the lattice and is not settled.
    fn beside(&self, at: [usize; 3], step: [isize; 3]) -> Option<usize> {
        let counts = self.lattice.counts();
        let mut to = [0; 3];
        for k in 0..3 {
            to[k] = at[k].checked_add_signed(step[k])?;
            if to[k] >= counts[k] {
                return None;
            }
        }
        Some(self.lattice.index(to)).filter(|&next| !self.settled[next])
    }

    /// A node as it is left.
    fn departure(&self, node: usize) -> Option<Departure> {
        let place = self.lattice.place(node)?;
        let begin_s = self.times_s[node];
        Some(Departure {
            node,
            at: TimedPoint::new(place, begin_s),
            water: self.tide.at(node, begin_s),
        })
    }

    /// When and where a node is reached from another, if that is earlier than known and the way is clear.
    fn reach(
        &self,
        from: &Departure,
        to: usize,
        is_clear: &mut impl FnMut(&TimedPoint, &TimedPoint) -> bool,
    ) -> Option<(f64, Point3<f64>)> {
        let (a, b) = (from.at.position, self.lattice.place(to)?);
        let way = b - a;
        let length_m = way.norm();
        let (begin_s, speed_mps) = (from.at.time_s, self.speed_mps);
        if begin_s + length_m * self.least_s_per_m >= self.times_s[to] {
            return None;
        }
        let direction = way / length_m.max(1e-9);
        let mut time_s = begin_s + length_m / speed_mps;
        if !self.tide.is_still() {
            let there = self.tide.at(to, time_s);
            let (here, there) = (
                speed_over_ground_mps(speed_mps, &direction, &from.water)?,
                speed_over_ground_mps(speed_mps, &direction, &there)?,
            );
            time_s = begin_s + 0.5 * length_m * (1.0 / here + 1.0 / there);
        }
        if time_s >= self.times_s[to] {
            return None;
        }
        let steep = way.z.abs() > self.slope * libm::hypot(way.x, way.y) + ROUNDING_M;
        if steep || !self.lattice.is_clear((from.node, a.z), (to, b.z)) {
            return None;
        }
        let clear = is_clear(&from.at, &TimedPoint::new(b, time_s));
        clear.then_some((time_s, b))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::front::{Depths, Frame};
    use auv_obstacles::Region;
    use auv_ocean::{AnalyticCurrent, LambVortex};
    use auv_types::{Seed, rand::RngExt};

    /// Arrival at a node by relaxing all steps until nothing changes.
    fn slow_s(
        mut front: Front<'_>,
        stencil: &Stencil,
        (from, to): (usize, usize),
        mut is_clear: impl FnMut(&TimedPoint, &TimedPoint) -> bool,
    ) -> f64 {
        front.times_s[from] = 0.0;
        let mut changed = true;
        while changed {
            changed = false;
            for node in 0..front.lattice.nodes() {
                for step in stencil.steps() {
                    let next = front.beside(front.lattice.node(node), *step);
                    let from_known = front.times_s[node].is_finite();
                    let later = next.filter(|_| from_known);
                    if let Some(next) = later
                        && let Some(from) = front.departure(node)
                        && let Some((time_s, _)) = front.reach(&from, next, &mut is_clear)
                    {
                        front.times_s[next] = time_s;
                        changed = true;
                    }
                }
            }
        }
        front.times_s[to]
    }

    #[test]
    fn it_arrives_as_early_as_relaxing_all_steps() {
        let vehicle = Vehicle::paper();
        let mut random = Seed(3).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let frame = Frame {
            anchor: Point3::new(0.0, 0.0, 20.0),
            anchor_node: [0, 4],
            ahead: Vector3::x(),
            side: Vector3::y(),
            cell_m: 100.0,
            counts: [10, 9],
        };
        let depths = Depths::ByRow(vec![20.0; 10]);
        let lattice = Lattice::new(&frame, &depths, None, None, Deadline::default()).unwrap();
        let stencil = Stencil::new(&lattice, 3);
        let ends = [0, 9].map(|row| lattice.index([row, 4, 0]));
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
            let is_clear =
                |from: &TimedPoint, to: &TimedPoint| ball.clearance(from, to).clearance_m >= 0.0;
            let tide = Tide::new(&current, &lattice, (0.0, 1.0, 1), Deadline::default()).unwrap();
            let mut front = Front::new(&vehicle, &lattice, &tide);
            let spread = Spread {
                from: ends[0],
                goals: &ends[1..],
                departure_s: 0.0,
                latest_s: f64::INFINITY,
                deadline: Deadline::default(),
            };
            assert!(front.spread(&stencil, &spread, is_clear).0);
            let way = front.way_to(ends[1]);
            assert_eq!((way[0], way[way.len() - 1]), (ends[0], ends[1]));
            let found_s = front.time_s(ends[1]);
            let fresh = Front::new(&vehicle, &lattice, &tide);
            let exact_s = slow_s(fresh, &stencil, (ends[0], ends[1]), is_clear);
            assert!((found_s - exact_s).abs() < 1e-9 * exact_s);
            bent += usize::from(way.len() > 2);
        }
        assert!(bent > 5);
    }
}
