//! A coarse way among many regions: dynamic programming over a lattice of cross-sections.

use crate::field::{Field, sideways};
use crate::flyable::Launch;
use auv_planning::PathProblem;
use auv_types::{Point3, Vector3};

/// Cells to each side of the straight line.
const REACH: usize = 11;
const WIDTH: usize = 2 * REACH + 1;
/// Greatest distance between cells and between cross-sections, metres.
const CELL_M: f64 = 45.0;
const LAYER_M: f64 = 80.0;
/// Share of a lattice step's extra length that a taut string pays for the same shift.
const TAUT: f32 = 0.5;
/// What a blocked cell costs, metres: ways through regions are taken only where there is no other.
const BLOCKED: f32 = 1e5;

/// Work of the lattice in evaluations: whole curves costed in the same time.
pub(crate) const EVALUATIONS: u64 = 40;

/// The cheapest way from start to target over the lattice, as a polyline; the vehicle is taken to
/// advance at its own speed along the line.
pub(crate) fn coarse_way(
    problem: &PathProblem<'_>,
    field: &Field,
    launch: &Launch,
) -> Vec<Point3<f64>> {
    let line = problem.target - launch.from;
    let length_m = line.norm();
    let layers = ((length_m / LAYER_M).ceil() as usize).clamp(6, 96);
    let step_m = length_m / layers as f64;
    let cell_m = CELL_M.min(0.56 * step_m);
    let ahead = line / length_m;
    let side = sideways(&ahead);
    let down = ahead.cross(&side);
    let middle = |layer: usize| launch.from + line * (layer as f64 / layers as f64);
    let offset = |i: usize| (i as f64 - REACH as f64) * cell_m;
    let place = |layer: usize, cell: usize| {
        middle(layer) + side * offset(cell % WIDTH) + down * offset(cell / WIDTH)
    };

    // Cells are laid out with a margin of one, so that neighbours need no test.
    let mut cost = vec![f32::INFINITY; (WIDTH + 2) * (WIDTH + 2)];
    let mut next = cost.clone();
    let padded = |cell: usize| (cell / WIDTH + 1) * (WIDTH + 2) + cell % WIDTH + 1;
    let centre = REACH * WIDTH + REACH;
    cost[padded(centre)] = 0.0;
    let mut from = vec![0_i8; layers * WIDTH * WIDTH];
    let mut blocked = vec![0.0_f32; WIDTH * WIDTH];
    let shift = |squared: f64| {
        let longer_m = (step_m * step_m + squared * cell_m * cell_m).sqrt() - step_m;
        longer_m as f32 * TAUT
    };
    let moves: [(i32, f32); 9] = std::array::from_fn(|k| {
        let (row, column) = (k as i32 / 3 - 1, k as i32 % 3 - 1);
        let squared = f64::from(row * row + column * column);
        (row * (WIDTH as i32 + 2) + column, shift(squared))
    });
    for layer in 1..=layers {
        block(
            problem,
            field,
            launch,
            &middle(layer),
            (&side, &down, &ahead),
            (cell_m, step_m),
            &mut blocked,
        );
        if problem.bounds.is_some() || problem.sea_bed.is_some() {
            for (cell, blocked) in blocked.iter_mut().enumerate() {
                let p = place(layer, cell);
                let outside = problem.bounds.is_some_and(|bounds| !bounds.contains(&p));
                if outside || p.z > problem.deepest_at(p.x, p.y) {
                    *blocked = BLOCKED;
                }
            }
        }
        // No farther from the line than the way there and back allows.
        let wide = REACH.min(layer).min(layers - layer);
        next.fill(f32::INFINITY);
        for row in REACH - wide..=REACH + wide {
            for column in REACH - wide..=REACH + wide {
                let cell = row * WIDTH + column;
                let at = padded(cell);
                let mut best = (f32::INFINITY, 0_i8);
                for (k, (step, longer)) in moves.iter().enumerate() {
                    let total = cost[(at as i32 - step) as usize] + longer;
                    if total < best.0 {
                        best = (total, k as i8);
                    }
                }
                next[at] = best.0 + blocked[cell];
                from[(layer - 1) * WIDTH * WIDTH + cell] = best.1;
            }
        }
        std::mem::swap(&mut cost, &mut next);
    }

    let mut cell = centre;
    let mut way = vec![problem.target];
    for layer in (1..=layers).rev() {
        let k = usize::from(from[(layer - 1) * WIDTH * WIDTH + cell].unsigned_abs());
        let (row, column) = (cell / WIDTH + 1 - k / 3, cell % WIDTH + 1 - k % 3);
        cell = row * WIDTH + column;
        way.push(place(layer - 1, cell));
    }
    way.reverse();
    corners(&way)
}

/// Marks the cells of a cross-section that a region covers within half a step of it.
fn block(
    problem: &PathProblem<'_>,
    field: &Field,
    launch: &Launch,
    middle: &Point3<f64>,
    (side, down, ahead): (&Vector3<f64>, &Vector3<f64>, &Vector3<f64>),
    (cell_m, step_m): (f64, f64),
    blocked: &mut [f32],
) {
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
        let range = |at: f64, reach: f64| {
            let low = (at - reach + REACH as f64).ceil().max(0.0) as usize;
            let high = (at + reach + REACH as f64).floor();
            low..if high < 0.0 {
                0
            } else {
                (high as usize + 1).min(WIDTH)
            }
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
