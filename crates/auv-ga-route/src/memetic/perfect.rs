//! The last improvements of a best tour, by the objective alone.

use super::descent::Descent;
use super::objective::TourObjective;
use super::polish::polish;
use super::search_space::SearchSpace;
use super::tour::Tour;
use auv_planning::Deadline;

/// Most descent steps.
const STEPS: u64 = 100;

/// Improves a best tour at the price that a second has under the objective: by descent, and if
/// `polish_late` is given also by [`polish`], which then may evaluate that many insertions after the
/// deadline.
pub(crate) fn perfect(
    space: &SearchSpace,
    objective: &TourObjective,
    best: &mut Tour,
    descent: &mut Descent,
    deadline: Deadline<'_>,
    polish_late: Option<usize>,
) {
    let mut tour = best.clone();
    let price = objective.price(&tour);
    if !deadline.passed() {
        descent.improve(space, &mut tour, price, None, STEPS, deadline);
    }
    if let Some(late) = polish_late {
        polish(space, &mut tour, price, deadline, late);
    }
    if objective.prefers(&tour, best) {
        *best = tour;
    }
}
