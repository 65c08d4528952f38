//! A coarse path among many regions: dynamic programming over a lattice of cross-sections.

use crate::taut::contact::sideways;
use crate::taut::cross_section::{CrossSection, Grid, REACH, WIDTH};
use crate::taut::regions::GrownRegions;
use crate::taut::work::LOOK_UP;
use auv_planning::departure::DepartureManoeuvre;
use auv_planning::{Deadline, PathProblem};
use auv_types::{Point3, Vector3, libm};
use std::ops::Range;

/// Width of a cross-section with a margin of one cell, so that neighbours need no test.
const PADDED: usize = WIDTH + 2;
const PADDED_CELLS: usize = PADDED * PADDED;
/// Greatest distance between cells and between cross-sections, metres.
const CELL_M: f64 = 45.0;
const LAYER_M: f64 = 80.0;
/// Fewest and most cross-sections.
const LAYERS: (usize, usize) = (6, 96);
/// Greatest distance between cells as a share of that between cross-sections: a step to the next
/// column turns by about 30 degrees.
const CELL_SHARE: f64 = 0.56;
/// Share of a lattice step's extra length that counts. A taut string makes the same shift over many
/// steps and pays about half.
const TAUT: f32 = 0.5;
/// The vehicle is taken to arrive later than along the straight line by this factor.
const DELAY: f64 = 1.005;
/// Units of work of a cross-section, and the regions that one unit draws into it.
const LAYER_WORK: u64 = 350;
const REGIONS_PER_UNIT: u64 = 8;
/// A point where the direction changes by less than this share of a step is no corner.
const STRAIGHT: f64 = 1e-6;

/// Units of work of a search.
pub(crate) fn work(problem: &PathProblem<'_>, departure: &DepartureManoeuvre) -> u64 {
    let bed = if problem.sea_bed.is_some() {
        WIDTH as u64 * LOOK_UP
    } else {
        0
    };
    let regions = problem.regions.len() as u64 / REGIONS_PER_UNIT;
    layers(problem, departure) as u64 * (LAYER_WORK + regions + bed)
}

/// The cheapest path from the end of a departure to the target over the lattice, as a polyline.
///
/// The vehicle is taken to advance at its cruising speed along the line. A path costs half the
/// length that its steps to the side add, and more for each blocked cell than any detour. `None` when
/// the deadline passes first.
pub(crate) fn coarse_path(
    problem: &PathProblem<'_>,
    regions: &GrownRegions,
    departure: &DepartureManoeuvre,
    deadline: Deadline<'_>,
) -> Option<Vec<Point3<f64>>> {
    let lattice = Lattice::new(problem, regions, departure);
    let costs = lattice.least_costs(deadline)?;
    Some(corners(&lattice.cheapest_path(&costs)))
}

/// Cross-sections between start and target.
fn layers(problem: &PathProblem<'_>, departure: &DepartureManoeuvre) -> usize {
    let length_m = (problem.target - departure.end).norm();
    ((length_m / LAYER_M).ceil() as usize).clamp(LAYERS.0, LAYERS.1)
}

/// Index of a cell in a padded cross-section.
fn padded(row: usize, column: usize) -> usize {
    (row + 1) * PADDED + column + 1
}

/// Cross-sections at equal distances along the straight line, each a square of cells.
struct Lattice<'a> {
    problem: &'a PathProblem<'a>,
    regions: &'a GrownRegions,
    departure: &'a DepartureManoeuvre,
    line: Vector3<f64>,
    layers: usize,
    grid: Grid,
    /// Steps to the nine nearest cells of the next cross-section, and what each adds to the path.
    moves: [(isize, f32); 9],
}

impl<'a> Lattice<'a> {
    fn new(
        problem: &'a PathProblem<'a>,
        regions: &'a GrownRegions,
        departure: &'a DepartureManoeuvre,
    ) -> Self {
        let line = problem.target - departure.end;
        let length_m = line.norm();
        let layers = layers(problem, departure);
        let step_m = length_m / layers as f64;
        let cell_m = CELL_M.min(CELL_SHARE * step_m);
        let ahead = line / length_m;
        let side = sideways(&ahead);
        Self {
            problem,
            regions,
            departure,
            line,
            layers,
            grid: Grid {
                step_m,
                cell_m,
                ahead,
                side,
                down: ahead.cross(&side),
            },
            moves: moves(step_m, cell_m),
        }
    }

    fn cross_section(&self, layer: usize) -> CrossSection<'_> {
        let departure = self.departure;
        let middle = departure.end + self.line * (layer as f64 / self.layers as f64);
        let so_far_m = (middle - departure.end).norm();
        CrossSection {
            grid: &self.grid,
            middle,
            time_s: departure.end_s + DELAY * so_far_m / self.problem.vehicle.speed_mps,
            // No farther aside than a path from the start to the target can be.
            wide: REACH.min(layer).min(self.layers - layer),
        }
    }

    /// The least cost of reaching each cell, layer by layer. `None` when the deadline passes first.
    fn least_costs(&self, deadline: Deadline<'_>) -> Option<Vec<f32>> {
        let mut costs = vec![f32::INFINITY; (self.layers + 1) * PADDED_CELLS];
        costs[padded(REACH, REACH)] = 0.0;
        let mut blocked = vec![0.0_f32; WIDTH * WIDTH];
        for layer in 1..=self.layers {
            if deadline.passed() {
                return None;
            }
            let section = self.cross_section(layer);
            section.block(self.problem, self.regions, &mut blocked);
            let (before, now) = costs.split_at_mut(layer * PADDED_CELLS);
            let before = &before[(layer - 1) * PADDED_CELLS..];
            self.advance(section.within(), before, now, &blocked);
        }
        Some(costs)
    }

    /// The costs of a layer from those of the one before.
    fn advance(&self, within: Range<usize>, before: &[f32], now: &mut [f32], blocked: &[f32]) {
        for row in within.clone() {
            let (first, count) = (padded(row, within.start), within.len());
            let reached = &mut now[first..first + count];
            for &(step, longer_m) in &self.moves {
                let from = &before[first.wrapping_add_signed(-step)..][..count];
                for (reached, &from) in reached.iter_mut().zip(from) {
                    let total = from + longer_m;
                    *reached = if total < *reached { total } else { *reached };
                }
            }
            let blocked = &blocked[row * WIDTH + within.start..][..count];
            for (reached, &blocked) in reached.iter_mut().zip(blocked) {
                *reached += blocked;
            }
        }
    }

    /// One place in each cross-section, from start to target.
    fn cheapest_path(&self, costs: &[f32]) -> Vec<Point3<f64>> {
        let mut at = padded(REACH, REACH);
        let mut path = vec![self.problem.target];
        for layer in (0..self.layers).rev() {
            let costs = &costs[layer * PADDED_CELLS..];
            let through = |(step, longer_m): &(isize, f32)| {
                let from = at.wrapping_add_signed(-step);
                (costs[from] + longer_m, from)
            };
            let best = self.moves.iter().map(through);
            at = best
                .min_by(|a, b| a.0.total_cmp(&b.0))
                .map_or(at, |best| best.1);
            let section = self.cross_section(layer);
            path.push(section.place(at / PADDED - 1, at % PADDED - 1));
        }
        path.reverse();
        path
    }
}

/// Steps to the nine nearest cells of the next cross-section, and what each adds to the path.
fn moves(step_m: f64, cell_m: f64) -> [(isize, f32); 9] {
    std::array::from_fn(|k| {
        let (row, column) = (k as isize / 3 - 1, k as isize % 3 - 1);
        let across_m = ((row * row + column * column) as f64).sqrt() * cell_m;
        let longer_m = libm::hypot(step_m, across_m) - step_m;
        (row * PADDED as isize + column, longer_m as f32 * TAUT)
    })
}

/// The polyline without the points in the middle of straight stretches.
fn corners(path: &[Point3<f64>]) -> Vec<Point3<f64>> {
    let mut kept = vec![path[0]];
    for i in 1..path.len() - 1 {
        let (before, after) = (path[i] - path[i - 1], path[i + 1] - path[i]);
        if (after - before).norm() > STRAIGHT * before.norm() {
            kept.push(path[i]);
        }
    }
    kept.push(path[path.len() - 1]);
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::taut::cross_section::BLOCKED;
    use auv_obstacles::{Region, TimedPoint};
    use auv_planning::{Budget, Run, Vehicle};
    use auv_types::{Bounds, Seed, rand::RngExt};

    /// Layers of the shortest lattice: all its paths can be enumerated.
    const FEWEST: usize = 6;

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
            let step_m = line.norm() / FEWEST as f64;
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

        /// The least cost over all paths from a cell to the target.
        fn least(&self, layer: usize, cell: (i32, i32), blocked: &[Vec<bool>]) -> f64 {
            if layer == FEWEST {
                return if cell == (0, 0) { 0.0 } else { f64::INFINITY };
            }
            let left = (FEWEST - layer) as i32 - 1;
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
            (0..=FEWEST).map(cells).collect()
        }

        /// The cells of a polyline where it crosses the cross-sections.
        fn cells(&self, path: &[Point3<f64>]) -> Vec<(i32, i32)> {
            let along = |p: &Point3<f64>| (p - self.problem.start).dot(&self.axes[0]);
            (0..=FEWEST)
                .map(|layer| {
                    let at_m = layer as f64 * self.step_m;
                    let pair = path
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
    fn its_path_costs_the_least_of_all_paths() {
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
            let grown = GrownRegions::new(&problem, 0.0, false);
            let run = Run::new(Seed(0), Budget::to_the_cap());
            let departure = DepartureManoeuvre::none(&problem);
            let path = coarse_path(&problem, &grown, &departure, run.deadline()).unwrap();
            assert_eq!(
                (path[0], path[path.len() - 1]),
                (problem.start, problem.target)
            );

            let reference = Reference::new(&problem);
            let blocked = reference.blocked();
            let least = reference.least(0, (0, 0), &blocked);
            let cells = reference.cells(&path);
            let found: f64 = (1..=FEWEST)
                .map(|layer| {
                    reference.step_cost(cells[layer - 1], cells[layer])
                        + cost_of(&blocked, layer, cells[layer])
                })
                .sum();
            assert!(
                (found - least).abs() < 1e-6 * least + 1e-3,
                "round {round}: {found} {least}"
            );
            bent += usize::from(path.len() > 2);
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
        let grown = GrownRegions::new(&problem, 0.0, false);
        let run = Run::new(Seed(0), Budget::to_the_cap());
        let departure = DepartureManoeuvre::none(&problem);
        let path = coarse_path(&problem, &grown, &departure, run.deadline()).unwrap();
        let above = path.iter().map(|p| p.z).fold(f64::INFINITY, f64::min);
        assert!(above < 80.0, "over the top: {above}");
        let trajectory = problem.timed(&path).unwrap();
        let crossing: TimedPoint = trajectory.points()[trajectory.points().len() / 2];
        assert!(regions[0].distance_m(&crossing) > 0.0);
    }
}
