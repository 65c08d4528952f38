//! Filling a tour with the pieces that pay most for their time.

use super::earliest::quickest_way;
use super::pieces::Piece;
use super::timed_network::{Step, TimedNetwork};
use super::tour::TimedTour;
use super::tour_insertion::Insertion;
use auv_graph::TIME_TOLERANCE_S;

/// Most nodes of a network for which the times of all ways are computed to spare searches for them.
const MOST_NODES: usize = 256;

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
                .filter(|(_, p)| p.weight > 0.0 || p.is_mandatory || p.steps.len() > 1)
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
/// it; steps make way for a mandatory one. Whether it did.
pub fn insert_by_detour(tables: &TimedNetwork<'_>, tour: &mut TimedTour, piece: &Piece) -> bool {
    let is_done = |step: &Step| step.works() && tour.does(step.task);
    if tables.passing_works() || piece.steps.is_empty() || piece.steps.iter().any(is_done) {
        return false;
    }
    let (weight, missing) = (tour.weight(), tour.missing(tables));
    let last = tour.steps().len() - 1;
    let most_gone = if piece.is_mandatory { last } else { 0 };
    for after in 0..last {
        for next in after + 1..=last.min(after + 1 + most_gone) {
            let Some(steps) = detour(tables, tour, piece, (after, next)) else {
                continue;
            };
            let gone = tour.steps()[after + 1..next].to_vec();
            if tour.splice(tables, (after + 1, next), &steps) {
                let fewer = tour.missing(tables) < missing;
                if fewer || (gone.is_empty() && tour.weight() > weight + 1e-9) {
                    return true;
                }
                tour.splice(tables, (after + 1, after + 1 + steps.len()), &gone);
            }
        }
    }
    false
}

/// The steps from step `after` over a piece to step `next`, neither included; those between make way.
fn detour(
    tables: &TimedNetwork<'_>,
    tour: &TimedTour,
    piece: &Piece,
    (after, next): (usize, usize),
) -> Option<Vec<Step>> {
    let (first, last) = (piece.steps.first()?, piece.steps.last()?);
    let (before, goal) = (tour.steps()[after], tour.steps()[next]);
    let is_direct =
        tables.connects(before.node, first.node) && tables.connects(last.node, goal.node);
    if before.node == goal.node || (is_direct && next == after + 1) {
        return None;
    }
    let gone = &tour.steps()[after + 1..next];
    let is_off = |node: u32| {
        !tour.visits(node)
            || (gone.iter().any(|step| step.node == node)
                && ![before.node, goal.node].contains(&node))
    };
    if !piece.steps.iter().all(|step| is_off(step.node))
        || (tables.nodes() <= MOST_NODES && is_too_far(tables, tour, piece, (after, next)))
    {
        return None;
    }
    let is_free = |node: u32| is_off(node) && piece.steps.iter().all(|step| step.node != node);
    let to_first = |node: u32| node == first.node || is_free(node);
    let leave_s = tour.ready_s[after];
    let (arrival_s, there) = quickest_way(tables, before.node, first.node, leave_s, to_first)?;
    let leave_s = tables.ready_along_s(&piece.steps, first.node, arrival_s);
    let to_goal = |node: u32| node == goal.node || (is_free(node) && !there.contains(&node));
    let (_, on) = quickest_way(tables, last.node, goal.node, leave_s, to_goal)?;
    let there = there[..there.len() - 1].iter().copied().map(Step::pass);
    let on = on[..on.len() - 1].iter().copied().map(Step::pass);
    Some(there.chain(piece.steps.iter().copied()).chain(on).collect())
}

/// Whether no ways from step `after` to a piece and on to step `next` are short enough.
fn is_too_far(
    tables: &TimedNetwork<'_>,
    tour: &TimedTour,
    piece: &Piece,
    (after, next): (usize, usize),
) -> bool {
    let (first, last) = (piece.steps[0], piece.steps[piece.steps.len() - 1]);
    let there_s = tables.least_way_s(tour.steps()[after].node, first.node);
    let on_s = tables.least_way_s(last.node, tour.steps()[next].node);
    // With room for the rounding of the sums.
    let latest_s = tour.latest_s[next] * (1.0 + 1e-12) + 2.0 * TIME_TOLERANCE_S;
    tour.ready_s[after] + there_s + on_s > latest_s
}
