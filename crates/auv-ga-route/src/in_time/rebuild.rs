//! Puts pieces into a tour, one after the other in a random order.

use auv_planning::timed::{Insertion, Piece, TimedNetwork, TimedTour, insert, insert_by_detour};
use auv_types::ChaCha8Rng;
use auv_types::rand::RngExt;

/// Share of pieces that are passed over.
const BLINK: f64 = 0.03;

/// Memory of the rebuilding.
pub(super) struct Rebuild {
    /// Whether every piece is one step and edges have no own weights.
    pub(super) is_plain: bool,
    /// Whether many pairs of nodes have no edge.
    is_sparse: bool,
    /// Pieces in the order in which they are tried.
    order: Vec<(f64, u32)>,
}

impl Rebuild {
    pub(super) fn new(tables: &TimedNetwork<'_>, pieces: &[Piece]) -> Self {
        let nodes = tables.nodes();
        let arcs = tables.problem.network.arcs().len();
        Self {
            is_plain: !tables.has_own_weights
                && !tables.has_rules
                && pieces.iter().all(|piece| piece.steps.len() == 1),
            is_sparse: 10 * arcs < 9 * nodes * nodes.saturating_sub(1),
            order: Vec::new(),
        }
    }

    /// Inserts pieces where they fit.
    pub(super) fn apply(
        &mut self,
        tables: &TimedNetwork<'_>,
        pieces: &[Piece],
        tour: &mut TimedTour,
        random: &mut ChaCha8Rng,
    ) {
        let noise = [0.0, 0.5, 2.0][random.random_range(0..3_usize)];
        self.order.clear();
        for (i, piece) in pieces.iter().enumerate() {
            let step = piece.steps[0];
            let is_done = step.works() && tour.does(step.task);
            if is_done || (self.is_plain && tour.visits(step.node)) {
                continue;
            }
            let draw: f64 = random.random();
            if draw < BLINK {
                continue;
            }
            let weight = if piece.is_mandatory {
                1e12
            } else {
                piece.weight
            };
            let key = if noise > 1.0 {
                draw
            } else {
                weight * (1.0 - noise + noise * draw * 2.0)
            };
            self.order.push((-key, i as u32));
        }
        self.order
            .sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        for k in 0..self.order.len() {
            let piece = &pieces[self.order[k].1 as usize];
            if self.is_plain {
                insert_plain(tables, piece, tour);
            } else {
                insert_best(tables, piece, tour, random);
            }
        }
        if self.is_sparse && random.random_range(0..2_u32) == 0 && !pieces.is_empty() {
            insert_by_detour(tables, tour, &pieces[random.random_range(0..pieces.len())]);
        }
    }
}

/// Inserts a piece of one step where it delays the next step least.
fn insert_plain(tables: &TimedNetwork<'_>, piece: &Piece, tour: &mut TimedTour) {
    let step = piece.steps[0];
    if tour.visits(step.node) {
        return;
    }
    let (mut least_s, mut place) = (f64::INFINITY, 0);
    for after in 0..tour.steps().len() - 1 {
        let delay_s = tour.delay_s(tables, step, after);
        if delay_s < least_s {
            (least_s, place) = (delay_s, after);
        }
    }
    if least_s < f64::INFINITY {
        tour.splice(tables, (place + 1, place + 1), &piece.steps);
    }
}

/// Inserts a piece where it gains most, or most for its delay, or anywhere.
fn insert_best(
    tables: &TimedNetwork<'_>,
    piece: &Piece,
    tour: &mut TimedTour,
    random: &mut ChaCha8Rng,
) {
    let criterion = random.random_range(0..5_u32);
    let mut best: Option<(f64, Insertion)> = None;
    for after in 0..tour.steps().len() {
        if !tour.has_room(&piece.steps, after) {
            continue;
        }
        let Some(place) = tour.insertion(tables, &piece.steps, after) else {
            continue;
        };
        let gain = piece.weight + place.own_weight;
        if gain <= 1e-9 && !piece.is_mandatory {
            continue;
        }
        let value = match criterion {
            0 | 1 => gain / place.delay_s.max(1e-3),
            2 | 3 => gain,
            _ => random.random_range(0.0..1.0),
        };
        if best.is_none_or(|(most, _)| value > most) {
            best = Some((value, place));
        }
    }
    if let Some((_, place)) = best {
        // A further place to be met again is looked for now and then only: that takes long.
        if tables.model.visits.is_some() && random.random_range(0..8_u32) > 0 {
            let at = place.after + 1;
            tour.splice(tables, (at, at), &piece.steps);
        } else {
            insert(tables, tour, piece, place);
        }
    }
}
