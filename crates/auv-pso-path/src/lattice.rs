//! A coarse way among many regions: dynamic programming over a lattice of cross-sections.

use crate::field::{Field, sideways};
use crate::flyable::Launch;
use crate::work::LOOK_UP;
use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, Vector3, libm};

/// Cells to each side of the straight line.
const REACH: usize = 11;
const WIDTH: usize = 2 * REACH + 1;
const PADDED: usize = WIDTH + 2;
/// Greatest distance between cells and between cross-sections, metres.
const CELL_M: f64 = 45.0;
const LAYER_M: f64 = 80.0;
/// Share of a lattice step's extra length that a taut string pays for the same shift.
const TAUT: f32 = 0.5;
/// What a blocked cell costs, metres: ways through regions are taken only where there is no other.
const BLOCKED: f32 = 1e5;

/// Cross-sections between start and target.
fn layers(problem: &PathProblem<'_>, launch: &Launch) -> usize {
    let length_m = (problem.target - launch.from).norm();
    ((length_m / LAYER_M).ceil() as usize).clamp(6, 96)
}

/// Units of work of a search.
pub(crate) fn work(problem: &PathProblem<'_>, launch: &Launch) -> u64 {
    let bed = if problem.sea_bed.is_some() {
        WIDTH as u64 * LOOK_UP
    } else {
        0
    };
    layers(problem, launch) as u64 * (350 + problem.regions.len() as u64 / 8 + bed)
}

/// The cheapest way from start to target over the lattice, as a polyline; the vehicle is taken to
/// advance at its own speed along the line. `None` when the deadline passes before.
pub(crate) fn coarse_way(
    problem: &PathProblem<'_>,
    field: &Field,
    launch: &Launch,
    deadline: Deadline<'_>,
) -> Option<Vec<Point3<f64>>> {
    let line = problem.target - launch.from;
    let length_m = line.norm();
    let layers = layers(problem, launch);
    let step_m = length_m / layers as f64;
    let cell_m = CELL_M.min(0.56 * step_m);
    let ahead = line / length_m;
    let side = sideways(&ahead);
    let down = ahead.cross(&side);
    let middle = |layer: usize| launch.from + line * (layer as f64 / layers as f64);
    let offset = |i: usize| (i as f64 - REACH as f64) * cell_m;
    let place = |layer: usize, row: usize, column: usize| {
        middle(layer) + side * offset(column) + down * offset(row)
    };

    // Cells are laid out with a margin of one, so that neighbours need no test.
    let padded = |row: usize, column: usize| (row + 1) * PADDED + column + 1;
    let mut costs = vec![f32::INFINITY; (layers + 1) * PADDED * PADDED];
    costs[padded(REACH, REACH)] = 0.0;
    let mut blocked = vec![0.0_f32; WIDTH * WIDTH];
    let moves = moves(step_m, cell_m);
    for layer in 1..=layers {
        if deadline.passed() {
            return None;
        }
        // No farther from the line than the way there and back allows.
        let wide = REACH.min(layer).min(layers - layer);
        let within = REACH - wide..REACH + wide + 1;
        let frame = Frame {
            middle: middle(layer),
            ahead,
            side,
            down,
            cell_m,
            step_m,
        };
        block(problem, field, launch, &frame, &mut blocked);
        let corners_inside = problem.bounds.is_none_or(|bounds| {
            let ends = [0, WIDTH - 1];
            let mut corners = ends
                .iter()
                .flat_map(|&row| ends.map(|column| (row, column)));
            corners.all(|(row, column)| bounds.contains(&place(layer, row, column)))
        });
        if !corners_inside || problem.sea_bed.is_some() {
            for column in within.clone() {
                // Above one another but for the tilt of the cross-section.
                let middle = place(layer, REACH, column);
                let deepest_m = problem.deepest_at(middle.x, middle.y);
                for row in within.clone() {
                    let p = place(layer, row, column);
                    let outside = problem.bounds.is_some_and(|bounds| !bounds.contains(&p));
                    if outside || p.z > deepest_m {
                        blocked[row * WIDTH + column] = BLOCKED;
                    }
                }
            }
        }
        let (before, now) = costs.split_at_mut(layer * PADDED * PADDED);
        let before = &before[(layer - 1) * PADDED * PADDED..];
        for row in within {
            let (first, count) = (padded(row, REACH - wide), 2 * wide + 1);
            let reached = &mut now[first..first + count];
            for &(step, longer_m) in &moves {
                let from = &before[first.wrapping_add_signed(-step)..][..count];
                for (reached, &from) in reached.iter_mut().zip(from) {
                    let total = from + longer_m;
                    *reached = if total < *reached { total } else { *reached };
                }
            }
            let blocked = &blocked[row * WIDTH + REACH - wide..][..count];
            for (reached, &blocked) in reached.iter_mut().zip(blocked) {
                *reached += blocked;
            }
        }
    }

    let mut at = padded(REACH, REACH);
    let mut way = vec![problem.target];
    for layer in (0..layers).rev() {
        let costs = &costs[layer * PADDED * PADDED..];
        let through = |(step, longer_m): &(isize, f32)| {
            let from = at.wrapping_add_signed(-step);
            (costs[from] + longer_m, from)
        };
        let best = moves.iter().map(through);
        at = best
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .map_or(at, |best| best.1);
        way.push(place(layer, at / PADDED - 1, at % PADDED - 1));
    }
    way.reverse();
    Some(corners(&way))
}

/// Steps to the nine nearest cells of the next cross-section, and what each adds to the way.
fn moves(step_m: f64, cell_m: f64) -> [(isize, f32); 9] {
    std::array::from_fn(|k| {
        let (row, column) = (k as isize / 3 - 1, k as isize % 3 - 1);
        let across = ((row * row + column * column) as f64).sqrt() * cell_m;
        let longer_m = libm::hypot(step_m, across) - step_m;
        (row * PADDED as isize + column, longer_m as f32 * TAUT)
    })
}

/// A cross-section of the lattice.
struct Frame {
    middle: Point3<f64>,
    ahead: Vector3<f64>,
    side: Vector3<f64>,
    down: Vector3<f64>,
    cell_m: f64,
    step_m: f64,
}

/// Marks the cells of a cross-section that a region covers within half a step of it.
fn block(
    problem: &PathProblem<'_>,
    field: &Field,
    launch: &Launch,
    frame: &Frame,
    blocked: &mut [f32],
) {
    let Frame {
        middle,
        ahead,
        side,
        down,
        cell_m,
        step_m,
    } = frame;
    blocked.fill(0.0);
    let so_far_m = (middle - launch.from).norm();
    let time_s = launch.departure_s + 1.005 * so_far_m / problem.vehicle.speed_mps;
    field.regions_near(middle, |region| {
        let Some(section) = field.at_time(region, time_s) else {
            return;
        };
        let (radius_m, depths) = (section.radius_m, section.depths_m);
        let delta = section.centre - middle;
        let beyond_m = (delta.dot(ahead).abs() - 0.5 * step_m).max(0.0);
        let square = radius_m * radius_m - beyond_m * beyond_m;
        if radius_m <= 0.0 || square <= 0.0 {
            return;
        }
        let (x, y, r) = (
            delta.dot(side) / cell_m,
            delta.dot(down) / cell_m,
            square.sqrt() / cell_m,
        );
        // Rounded by conversion: a call for every row costs more than the row.
        let range = |at: f64, reach: f64| {
            let (low, high) = (at - reach + REACH as f64, at + reach + REACH as f64);
            let first = low.clamp(0.0, WIDTH as f64) as i32;
            let first = first + i32::from(f64::from(first) < low);
            let end = (high.clamp(-1.0, WIDTH as f64 - 1.0) + 1.0) as i32;
            first as usize..end as usize
        };
        let rows = if depths.is_some() {
            0..WIDTH
        } else {
            range(y, r)
        };
        for row in rows {
            let v = row as f64 - REACH as f64;
            let half = match depths {
                None => r * r - (v - y) * (v - y),
                Some((top_m, bottom_m)) => {
                    let z = middle.z + down.z * v * cell_m;
                    if z > top_m && z < bottom_m {
                        r * r
                    } else {
                        -1.0
                    }
                }
            };
            if half >= 0.0 {
                for column in range(x, half.sqrt()) {
                    blocked[row * WIDTH + column] = BLOCKED;
                }
            }
        }
    });
}

/// The polyline without the points in the middle of straight stretches.
fn corners(way: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut kept = vec![way[0]];
    for i in 1..way.len() - 1 {
        let (before, after) = (way[i] - way[i - 1], way[i + 1] - way[i]);
        if (after - before).norm() > 1e-6 * before.norm() {
            kept.push(way[i]);
        }
    }
    kept.push(way[way.len() - 1]);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_obstacles::{Region, TimedPoint};
    use auv_planning::{Budget, Run, Vehicle};
    use auv_types::{Bounds, Seed, rand::RngExt};

    /// Layers of the shortest lattice: all its ways can be enumerated.
    const LAYERS: usize = 6;

    /// The lattice of a problem by its definition, cell by cell.
    struct Reference<'a> {
        problem: &'a PathProblem<'a>,
        step_m: f64,
        cell_m: f64,
        axes: [Vector3<f64>; 3],
    }

    impl<'a> Reference<'a> {
        fn new(problem: &'a PathProblem<'a>) -> Self {
            let line = problem.target - problem.start;
            let step_m = line.norm() / LAYERS as f64;
            let ahead = line.normalize();
            let side = sideways(&ahead);
            Self {
                problem,
                step_m,
                cell_m: 45.0_f64.min(0.56 * step_m),
                axes: [ahead, side, ahead.cross(&side)],
            }
        }

        fn place(&self, layer: usize, (row, column): (i32, i32)) -> Point3<f64> {
            let [ahead, side, down] = self.axes;
            self.problem.start
                + ahead * (layer as f64 * self.step_m)
                + side * (f64::from(column) * self.cell_m)
                + down * (f64::from(row) * self.cell_m)
        }

        /// Whether a region covers the cell within half a step of its cross-section.
        fn is_blocked(&self, layer: usize, cell: (i32, i32)) -> bool {
            let problem = self.problem;
            let place = self.place(layer, cell);
            let along_m = layer as f64 * self.step_m;
            let time_s = problem.departure_s + 1.005 * along_m / problem.vehicle.speed_mps;
            let covered = problem.regions.iter().any(|region| {
                let grown = region.inflated(problem.clearance_m + 2e-3);
                let delta = place - grown.centre_at(time_s);
                let axial_m = delta.dot(&self.axes[0]);
                let beyond_m = (axial_m.abs() - 0.5 * self.step_m).max(0.0);
                let across = (delta - self.axes[0] * axial_m).norm_squared();
                let reach_m = libm::hypot(across.sqrt(), beyond_m);
                grown.exists_at(time_s) && reach_m <= grown.radius_at(time_s)
            });
            let outside = problem.bounds.is_some_and(|b| !b.contains(&place));
            covered || outside
        }

        fn step_cost(&self, from: (i32, i32), to: (i32, i32)) -> f64 {
            let (rows, columns) = (f64::from(to.0 - from.0), f64::from(to.1 - from.1));
            let across_m = libm::hypot(rows, columns) * self.cell_m;
            0.5 * (libm::hypot(self.step_m, across_m) - self.step_m)
        }

        /// The least cost over all ways from a cell to the target.
        fn least(&self, layer: usize, cell: (i32, i32), blocked: &[Vec<bool>]) -> f64 {
            if layer == LAYERS {
                return if cell == (0, 0) { 0.0 } else { f64::INFINITY };
            }
            let left = (LAYERS - layer) as i32 - 1;
            let mut least = f64::INFINITY;
            for k in 0..9 {
                let to = (cell.0 + k / 3 - 1, cell.1 + k % 3 - 1);
                if to.0.abs() <= left && to.1.abs() <= left {
                    let own = self.step_cost(cell, to) + cost_of(blocked, layer + 1, to);
                    least = least.min(own + self.least(layer + 1, to, blocked));
                }
            }
            least
        }

        fn blocked(&self) -> Vec<Vec<bool>> {
            let cells = |layer: usize| {
                let each = (0..49).map(|k| self.is_blocked(layer, (k / 7 - 3, k % 7 - 3)));
                each.collect()
            };
            (0..=LAYERS).map(cells).collect()
        }

        /// The cells of a polyline where it crosses the cross-sections.
        fn cells(&self, way: &[Point3<f64>]) -> Vec<(i32, i32)> {
            let along = |p: &Point3<f64>| (p - self.problem.start).dot(&self.axes[0]);
            (0..=LAYERS)
                .map(|layer| {
                    let at_m = layer as f64 * self.step_m;
                    let pair = way
                        .windows(2)
                        .find(|pair| along(&pair[1]) >= at_m - 1e-6)
                        .unwrap();
                    let (a, b) = (along(&pair[0]), along(&pair[1]));
                    let crossing = pair[0] + (pair[1] - pair[0]) * ((at_m - a) / (b - a));
                    let offset = (crossing - self.problem.start) / self.cell_m;
                    let cell = |axis: usize| {
                        let exact = offset.dot(&self.axes[axis]);
                        assert!((exact - exact.round()).abs() < 1e-6, "off the lattice");
                        exact.round() as i32
                    };
                    (cell(2), cell(1))
                })
                .collect()
        }
    }

    fn cost_of(blocked: &[Vec<bool>], layer: usize, (row, column): (i32, i32)) -> f64 {
        let index = ((row + 3) * 7 + column + 3) as usize;
        f64::from(u8::from(blocked[layer][index])) * f64::from(BLOCKED)
    }

    #[test]
    fn its_way_costs_the_least_of_all_ways() {
        let vehicle = Vehicle::paper();
        let mut random = Seed(6).stream(0);
        let mut draw = |low: f64, high: f64| random.random_range(low..high);
        let (mut bent, mut closed) = (0, 0);
        for round in 0..60 {
            let regions: Vec<_> = (0..12)
                .map(|_| {
                    let centre =
                        Point3::new(draw(40.0, 440.0), draw(-70.0, 70.0), draw(50.0, 150.0));
                    let mut region = Region::ball(centre, draw(10.0, 55.0));
                    region.velocity_mps = Vector3::new(0.0, draw(-0.3, 0.3), 0.0);
                    region
                })
                .collect();
            let problem = PathProblem {
                regions: &regions,
                clearance_m: 2.0,
                bounds: (round % 3 == 0).then(|| {
                    Bounds::new(
                        Point3::new(-10.0, -60.0, 0.0),
                        Point3::new(500.0, 200.0, 160.0),
                    )
                }),
                ..PathProblem::new(
                    Point3::new(0.0, 0.0, 100.0),
                    Point3::new(470.0, draw(-30.0, 30.0), 100.0),
                    &vehicle,
                )
            };
            let field = Field::new(&problem, 0.0, false);
            let run = Run::new(Seed(0), Budget::to_the_cap());
            let launch = Launch::new(&problem, Vec::new(), problem.start, 0.0);
            let way = coarse_way(&problem, &field, &launch, run.deadline()).unwrap();
            assert_eq!(
                (way[0], way[way.len() - 1]),
                (problem.start, problem.target)
            );

            let reference = Reference::new(&problem);
            let blocked = reference.blocked();
            let least = reference.least(0, (0, 0), &blocked);
            let cells = reference.cells(&way);
            let found: f64 = (1..=LAYERS)
                .map(|layer| {
                    reference.step_cost(cells[layer - 1], cells[layer])
                        + cost_of(&blocked, layer, cells[layer])
                })
                .sum();
            assert!(
                (found - least).abs() < 1e-6 * least + 1e-3,
                "round {round}: {found} {least}"
            );
            bent += usize::from(way.len() > 2);
            closed += usize::from(least >= f64::from(BLOCKED));
        }
        assert!(bent > 20 && closed > 0, "{bent} bent, {closed} closed");
    }

    #[test]
    fn a_cylinder_blocks_the_cells_between_its_top_and_bottom() {
        let vehicle = Vehicle::paper();
        let regions = [Region::cylinder(
            Point3::new(240.0, 0.0, 0.0),
            70.0,
            80.0,
            f64::INFINITY,
        )];
        let problem = PathProblem {
            regions: &regions,
            ..PathProblem::new(
                Point3::new(0.0, 0.0, 100.0),
                Point3::new(480.0, 0.0, 100.0),
                &vehicle,
            )
        };
        let field = Field::new(&problem, 0.0, false);
        let run = Run::new(Seed(0), Budget::to_the_cap());
        let launch = Launch::new(&problem, Vec::new(), problem.start, 0.0);
        let way = coarse_way(&problem, &field, &launch, run.deadline()).unwrap();
        let above = way.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        assert!(above < 80.0, "over the top: {above}");
        let trajectory = problem.timed(&way).unwrap();
        let crossing: TimedPoint = trajectory.points()[trajectory.points().len() / 2];
        assert!(regions[0].distance_m(&crossing) > 0.0);
    }
}
