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
