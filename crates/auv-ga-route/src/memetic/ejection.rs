//! Ejection: removes stretches from a tour that takes too long, until it is in time.

use super::neighbourhood::MOST_REMOVED;
use super::profit_time::ProfitTime;
use super::search_space::SearchSpace;
use super::tour::Tour;

/// The state of an ejection; one for each thread.
#[derive(Debug, Default)]
pub(crate) struct Ejection {
    /// For each position, what the removal of the next 1, 2, ... nodes loses and saves.
    losses: Vec<[ProfitTime; MOST_REMOVED]>,
}

impl Ejection {
    /// Removes the stretch of least loss again and again until the tour is in time. `touched`
    /// receives the nodes beside each. The tour is empty if nothing saves time.
    pub(crate) fn eject(&mut self, space: &SearchSpace, tour: &mut Tour, touched: &mut Vec<u32>) {
        let mut over_s = tour.time_s - space.time_available_s;
        if over_s <= 0.0 {
            return;
        }
        let nodes = &mut tour.nodes;
        let losses = &mut self.losses;
        losses.clear();
        losses.extend((0..nodes.len()).map(|from| losses_from(space, nodes, from)));
        while over_s > 0.0 {
            let Some((from, to)) = least_loss(losses, over_s, space.price) else {
                nodes.clear();
                break;
            };
            touched.extend([nodes[from], nodes[to]]);
            over_s -= losses[from][to - from - 2].time_s;
            nodes.drain(from + 1..to);
            losses.drain(from + 1..to);
            let first = from.saturating_sub(MOST_REMOVED);
            for (i, losses) in losses[first..=from].iter_mut().enumerate() {
                *losses = losses_from(space, nodes, first + i);
            }
            if over_s <= 0.0 {
                // The differences add up to the sum but for rounding: check with the sum itself.
                over_s = space.sum(nodes).time_s - space.time_available_s;
            }
        }
        tour.sum(space);
    }
}

/// The ends of the stretch with the least loss for the time that it saves.
fn least_loss(
    losses: &[[ProfitTime; MOST_REMOVED]],
    over_s: f64,
    price: f64,
) -> Option<(usize, usize)> {
    let mut best: Option<(f64, usize, usize)> = None;
    for (from, losses) in losses.iter().enumerate() {
        for (k, lost) in losses.iter().enumerate() {
            let (saved_s, loss) = (lost.time_s, lost.profit);
            if saved_s <= 0.0 {
                continue;
            }
            // Time saved beyond the need counts at its price. A stretch that saves too little is
            // scored as if as many of its kind were removed as it takes.
            let score = if saved_s >= over_s {
                loss - price * (saved_s - over_s)
            } else {
                (loss.max(0.0) + 1e-9) * over_s / saved_s
            };
            if best.is_none_or(|(least, _, _)| score < least) {
                best = Some((score, from, from + 2 + k));
            }
        }
    }
    best.map(|(_, from, to)| (from, to))
}

/// What is lost by going from a position straight to the second, third, ... next one; 0 beyond the
/// end of the tour.
fn losses_from(space: &SearchSpace, nodes: &[u32], from: usize) -> [ProfitTime; MOST_REMOVED] {
    let mut losses = [ProfitTime::default(); MOST_REMOVED];
    let ahead = &nodes[from..nodes.len().min(from + 2 + MOST_REMOVED)];
    let mut along = ProfitTime::default();
    for (k, pair) in ahead.windows(2).enumerate() {
        along = along + space.arc(pair[0], pair[1]);
        if k > 0 {
            losses[k - 1] = along - space.arc(ahead[0], pair[1]);
        }
    }
    losses
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::search_space::{END, START};
    use crate::memetic::testing::{random_tour, spaces};

    #[test]
    fn losses_are_those_of_the_shortened_tour() {
        for space in spaces() {
            let tour = random_tour(&space, 1);
            for from in 0..tour.nodes.len() {
                let losses = losses_from(&space, &tour.nodes, from);
                for (k, lost) in losses.iter().enumerate() {
                    let mut shorter = tour.nodes.clone();
                    if from + k + 2 >= tour.nodes.len() {
                        assert_eq!(*lost, ProfitTime::default());
                        continue;
                    }
                    shorter.drain(from + 1..from + k + 2);
                    let expected = space.sum(&tour.nodes) - space.sum(&shorter);
                    if expected.time_s.is_finite() {
                        assert!((expected.time_s - lost.time_s).abs() < 1e-6);
                        assert!((expected.profit - lost.profit).abs() < 1e-9);
                    } else {
                        assert!(lost.time_s < 0.0, "a missing arc saves nothing");
                    }
                }
            }
        }
    }

    #[test]
    fn an_ejected_tour_is_in_time_and_keeps_its_order() {
        for mut space in spaces() {
            for seed in 0..20 {
                let mut tour = random_tour(&space, seed);
                let whole = tour.clone();
                let available_s = space.time_available_s;
                space.time_available_s = 0.7 * tour.time_s;
                let mut touched = Vec::new();
                Ejection::default().eject(&space, &mut tour, &mut touched);
                assert!(tour.time_s <= space.time_available_s);
                if !tour.nodes.is_empty() {
                    let ends = (tour.nodes.first(), tour.nodes.last());
                    assert_eq!(ends, (Some(&START), Some(&END)));
                    let mut order = whole.nodes.iter();
                    assert!(
                        tour.nodes
                            .iter()
                            .all(|node| order.any(|other| other == node))
                    );
                    assert!(!touched.is_empty());
                }
                space.time_available_s = available_s;
            }
        }
    }

    #[test]
    fn the_least_loss_prefers_enough_time_for_little_profit() {
        let loss = |profit, time_s| ProfitTime { profit, time_s };
        let none = ProfitTime::default();
        let losses = [
            [loss(9.0, 100.0), none, none, none],
            [loss(5.0, 40.0), loss(6.0, 100.0), none, none],
            [loss(1.0, 10.0), none, none, none],
        ];
        // 100 s over: 9, 5 x 2.5, 6, 1 x 10.
        assert_eq!(least_loss(&losses, 100.0, 0.0), Some((1, 4)));
        // 5 s over: what is saved beyond is worth 0.1 a second.
        assert_eq!(least_loss(&losses, 5.0, 0.1), Some((1, 4)));
        assert_eq!(least_loss(&losses, 5.0, 0.0), Some((2, 4)));
        assert_eq!(least_loss(&[[none; MOST_REMOVED]], 5.0, 0.0), None);
    }
}
