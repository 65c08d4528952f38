//! Takes steps out of a tour.

use auv_planning::timed::{Piece, Step, TimedNetwork, TimedTour};
use auv_types::ChaCha8Rng;
use auv_types::rand::RngExt;

/// Most steps taken out as one string.
const LONGEST_STRING: usize = 6;
/// Most steps that make way for a piece.
const MOST_EJECTED: usize = 5;

/// Takes strings of steps out, or makes way for a piece that is not on the tour.
pub(super) fn ruin(
    tables: &TimedNetwork<'_>,
    pieces: &[Piece],
    tour: &mut TimedTour,
    random: &mut ChaCha8Rng,
) {
    // Order and edges matter less where nodes alone have weights and there is one end.
    let kinds = if tables.has_rules { 12_u32 } else { 8 };
    match random.random_range(0..kinds) {
        0..=2 => take_string(tables, tour, random),
        3 => {
            take_string(tables, tour, random);
            take_string(tables, tour, random);
        }
        4 => {
            for _ in 0..random.random_range(1..=4_u32) {
                take(tables, tour, random, 1);
            }
        }
        5..=7 => make_way(tables, pieces, tour, random),
        _ => reshape(tables, tour, random),
    }
}

fn take_string(tables: &TimedNetwork<'_>, tour: &mut TimedTour, random: &mut ChaCha8Rng) {
    let count = tour.steps().len();
    if count > 2 {
        let longest = LONGEST_STRING.max(count / 4).min(count - 2);
        let length = random.random_range(1..=longest);
        take(tables, tour, random, length);
    }
}

/// Takes `length` steps out at a random place, if the rest still is a route.
fn take(tables: &TimedNetwork<'_>, tour: &mut TimedTour, random: &mut ChaCha8Rng, length: usize) {
    let count = tour.steps().len();
    if count < length + 2 {
        return;
    }
    let from = random.random_range(1..=count - 1 - length);
    tour.splice(tables, (from, from + length), &[]);
}

/// Reverses a string, moves one elsewhere, or goes to another destination.
fn reshape(tables: &TimedNetwork<'_>, tour: &mut TimedTour, random: &mut ChaCha8Rng) {
    let count = tour.steps().len();
    if tables.destinations.len() > 1 && random.random_range(0..2_u32) == 0 {
        let end = tables.destinations[random.random_range(0..tables.destinations.len())];
        let gone = random.random_range(0..=LONGEST_STRING.min(count - 1));
        tour.end_at(tables, end, count - gone);
        return;
    }
    if count < 4 {
        return;
    }
    let from = random.random_range(1..count - 2);
    let to = random.random_range(from + 2..count.min(from + 12));
    let mut string = tour.steps()[from..to].to_vec();
    if random.random_range(0..2_u32) == 0 {
        string.reverse();
    } else {
        let turn = random.random_range(1..string.len());
        string.rotate_left(turn);
    }
    tour.splice(tables, (from, to), &string);
}

/// Inserts a random piece where the steps that have to go for it weigh least.
fn make_way(
    tables: &TimedNetwork<'_>,
    pieces: &[Piece],
    tour: &mut TimedTour,
    random: &mut ChaCha8Rng,
) {
    if pieces.is_empty() {
        return;
    }
    let piece = &pieces[random.random_range(0..pieces.len())];
    let is_on = |step: &Step| {
        if step.works() {
            tour.does(step.task)
        } else {
            tour.visits(step.node)
        }
    };
    if piece.steps.iter().any(is_on) || (!tables.has_rules && tour.visits(piece.steps[0].node)) {
        return;
    }
    let weight = |step: &Step| {
        if step.works() {
            tables.works[step.task as usize].weight
        } else {
            0.0
        }
    };
    let mut best: Option<(f64, usize, usize)> = None;
    for after in 0..tour.steps().len().saturating_sub(1) {
        let Some(gone) = tour.ejection(tables, &piece.steps, after, MOST_EJECTED) else {
            continue;
        };
        let lost: f64 = tour.steps()[after + 1..after + 1 + gone]
            .iter()
            .map(weight)
            .sum();
        let lost = (lost + 1e-3) * random.random_range(0.5..1.5);
        if best.is_none_or(|(least, ..)| lost < least) {
            best = Some((lost, after, gone));
        }
    }
    if let Some((_, after, gone)) = best {
        tour.splice(tables, (after + 1, after + 1 + gone), &piece.steps);
    }
}
