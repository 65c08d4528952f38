//! Filling a tour with the pieces that pay most for their time.

use super::earliest::quickest_way;
use super::pieces::Piece;
use super::timed_network::{Step, TimedNetwork};
use super::tour::TimedTour;
use super::tour_insertion::Insertion;

/// Inserts pieces as long as one fits: mandatory ones first, then the one of most weight per delay.
///
/// Complexity: O(pieces * steps) for each insertion, and a search for a way for each piece that has no
/// direct one.
pub fn fill(tables: &TimedNetwork<'_>, tour: &mut TimedTour, pieces: &[Piece]) {
    let mut is_refused = vec![false; pieces.len()];
    loop {
        let candidates = (0..pieces.len()).filter(|&i| !is_refused[i]);
        let ranked = candidates.filter_map(|i| {
            let (insertion, gain) = best_place(tables, tour, &pieces[i])?;
            let rate = gain / insertion.delay_s.max(1e-6);
            Some((pieces[i].is_mandatory, rate, i, insertion))
        });
        let best = ranked.max_by(|a, b| {
            (a.0.cmp(&b.0))
                .then(a.1.total_cmp(&b.1))
                .then(b.2.cmp(&a.2))
        });
        let Some((_, _, i, insertion)) = best else {
            let detour = |(i, piece): (usize, &Piece)| {
                let tried = is_refused[i] || !insert_by_detour(tables, tour, piece);
                (!tried).then_some(())
            };
            if pieces
                .iter()
                .enumerate()
                .filter(|(_, p)| p.weight > 0.0 || p.steps.len() > 1)
                .find_map(detour)
                .is_none()
            {
                return;
            }
            continue;
        };
        is_refused[i] = !insert(tables, tour, &pieces[i], insertion);
    }
}

/// The place of least delay for a piece that gains weight there, with the gain.
fn best_place(
    tables: &TimedNetwork<'_>,
    tour: &TimedTour,
    piece: &Piece,
) -> Option<(Insertion, f64)> {
    let places = (0..tour.steps().len()).filter(|&after| tour.has_room(&piece.steps, after));
    let fitting = places.filter_map(|after| {
        let insertion = tour.insertion(tables, &piece.steps, after)?;
        let gain = piece.weight + insertion.own_weight;
        (gain > 1e-9).then_some((insertion, gain))
    });
    fitting.min_by(|a, b| a.0.delay_s.total_cmp(&b.0.delay_s))
}

/// Inserts a piece, if need be with one more place to be met again; whether it did.
pub fn insert(
    tables: &TimedNetwork<'_>,
    tour: &mut TimedTour,
    piece: &Piece,
    insertion: Insertion,
) -> bool {
    let at = insertion.after + 1;
    if tour.splice(tables, (at, at), &piece.steps) {
        return true;
    }
    let Some(visits) = &tables.model.visits else {
        return false;
    };
    let mut steps = tour.steps().to_vec();
    steps.splice(at..at, piece.steps.iter().copied());
    let whole = (0, tour.steps().len());
    for node in visits.nodes.iter().map(|node| node.0) {
        if steps.iter().any(|step| step.node == node) {
            continue;
        }
        for k in 1..steps.len() {
            steps.insert(k, Step::pass(node));
            if tour.splice(tables, whole, &steps) {
                return true;
            }
            steps.remove(k);
        }
    }
    false
}

/// Inserts a piece over ways through nodes that are not on the tour, where no edge leads to it or on from
/// it; whether it did.
pub fn insert_by_detour(tables: &TimedNetwork<'_>, tour: &mut TimedTour, piece: &Piece) -> bool {
    let (Some(first), Some(last)) = (piece.steps.first(), piece.steps.last()) else {
        return false;
    };
    let is_new = |step: &Step| !(tour.visits(step.node) || step.works() && tour.does(step.task));
    if tables.passing_works() || !piece.steps.iter().all(is_new) {
        return false;
    }
    let weight = tour.weight();
    for after in 0..tour.steps().len().saturating_sub(1) {
        let (before, next) = (tour.steps()[after], tour.steps()[after + 1]);
        if before.node == next.node
            || (tables.connects(before.node, first.node) && tables.connects(last.node, next.node))
        {
            continue;
        }
        let in_piece = |node: u32| piece.steps.iter().any(|step| step.node == node);
        let free = |node: u32| !tour.visits(node) && !in_piece(node);
        let Some((_, there)) = quickest_way(tables, before.node, first.node, |n| {
            n == first.node || free(n)
        }) else {
            continue;
        };
        let Some((_, on)) = quickest_way(tables, last.node, next.node, |n| {
            n == next.node || (free(n) && !there.contains(&n))
        }) else {
            continue;
        };
        let way = there[..there.len() - 1].iter().copied().map(Step::pass);
        let on = on[..on.len() - 1].iter().copied().map(Step::pass);
        let steps: Vec<_> = way.chain(piece.steps.iter().copied()).chain(on).collect();
        if tour.splice(tables, (after + 1, after + 1), &steps) {
            if tour.weight() > weight + 1e-9 {
                return true;
            }
            tour.splice(tables, (after + 1, after + 1 + steps.len()), &[]);
        }
    }
    false
}
