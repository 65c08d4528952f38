//! The ways of a front, without the corners that only its lattice has.

use super::lattice::Lattice;
use super::tide::Tide;
use crate::motion::speed_over_ground_mps;

/// Leaves out nodes of a way as long as the way then takes no longer and stays clear.
pub(super) fn shortened(
    lattice: &Lattice,
    tide: &Tide,
    (speed_mps, departure_s): (f64, f64),
    mut way: Vec<usize>,
) -> Vec<usize> {
    loop {
        let before = way.len();
        let mut kept = vec![way[0]];
        let mut time_s = departure_s;
        for pair in way.windows(2) {
            let (node, next) = (pair[0], pair[1]);
            let from = kept[kept.len() - 1];
            if node == from {
                continue;
            }
            let piece_s = |a, b, begin_s| straight_s(lattice, tide, speed_mps, (a, b), begin_s);
            let there_s = piece_s(from, node, time_s);
            let on_s = there_s.and_then(|s| Some(s + piece_s(node, next, time_s + s)?));
            let direct_s = piece_s(from, next, time_s);
            let is_quicker = match (direct_s, on_s) {
                (Some(direct_s), Some(on_s)) => direct_s <= on_s,
                (direct_s, _) => direct_s.is_some(),
            };
            if !is_quicker {
                kept.push(node);
                time_s += there_s.unwrap_or(0.0);
            }
        }
        kept.push(way[before - 1]);
        if kept.len() == before {
            return way;
        }
        way = kept;
    }
}

/// How long the straight way between two nodes takes, in the current at the nodes nearest to it, seconds;
/// `None` where it is not clear or no way is made.
fn straight_s(
    lattice: &Lattice,
    tide: &Tide,
    speed_mps: f64,
    (from, to): (usize, usize),
    begin_s: f64,
) -> Option<f64> {
    let (a, b) = (lattice.place(from)?, lattice.place(to)?);
    if !lattice.is_clear((from, a.z), (to, b.z)) {
        return None;
    }
    let length_m = (b - a).norm();
    let direction = (b - a) / length_m.max(1e-9);
    let (begin, end) = (lattice.node(from), lattice.node(to));
    let steps = begin[0]
        .abs_diff(end[0])
        .max(begin[1].abs_diff(end[1]))
        .max(1) as i64;
    let mut time_s = begin_s;
    for k in 0..steps {
        // The node nearest to the middle of the step.
        let at = |axis: usize| {
            let (a, b) = (begin[axis] as i64, end[axis] as i64);
            ((2 * a * steps + (b - a) * (2 * k + 1) + steps) / (2 * steps)) as usize
        };
        let water = tide.at(lattice.index([at(0), at(1), begin[2]]), time_s);
        let ground_mps = speed_over_ground_mps(speed_mps, &direction, &water)?;
        time_s += length_m / steps as f64 / ground_mps;
    }
    Some(time_s - begin_s)
}
