//! The partial routes of one place that were extended.

use super::label::Label;

/// Partial routes of equal place that were extended, the heaviest first, as arrays: comparing new ones with them is
/// most of the work. They are extended in the order of time, so all of them are ready no later than new ones.
#[derive(Debug, Default)]
pub(super) struct Rivals {
    weight: Vec<f64>,
    /// The nodes that each has visited; all where it must not beat another one.
    visited: Vec<u128>,
    ready_s: Vec<f64>,
    /// The time since a place to be met again, and the latest time for the next.
    visits_s: Vec<[f64; 2]>,
}

impl Rivals {
    /// Whether one of them is at least as good as a new one: it has visited none of the nodes `near` that the new
    /// one can still visit. Where arriving early is not as good as arriving late, only one that is ready at the
    /// same time is.
    pub(super) fn beat(&self, new: &Label, near: u128, early_is_good: bool) -> bool {
        let heavier = self.heavier(new.weight);
        let times_s = self.ready_s.iter().zip(&self.visits_s);
        let mut rivals = self.visited[..heavier].iter().zip(times_s);
        rivals.any(|(visited, (ready_s, [since_s, due_s]))| {
            visited & near & !new.shut == 0
                && *since_s <= new.since_s
                && *due_s >= new.due_s
                && (early_is_good || ready_s.to_bits() == new.ready_s.to_bits())
        })
    }

    pub(super) fn add(&mut self, label: &Label) {
        let at = self.heavier(label.weight);
        self.weight.insert(at, label.weight);
        self.visited.insert(at, label.beats_with());
        self.ready_s.insert(at, label.ready_s);
        self.visits_s.insert(at, [label.since_s, label.due_s]);
    }

    /// How many weigh at least so much.
    fn heavier(&self, weight: f64) -> usize {
        self.weight.partition_point(|&other| other >= weight)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::timed::partial::label::{Place, Stage};
    use crate::timed::timed_network::Step;

    fn label(ready_s: f64, weight: f64, visited: u128) -> Label {
        Label {
            ready_s,
            weight,
            since_s: 0.0,
            due_s: f64::INFINITY,
            visited,
            shut: visited,
            most: f64::INFINITY,
            earns_less_back: false,
            step: Step::pass(0),
            parent: 0,
            place: Place {
                node: 0,
                known: 0,
                here: 0,
                edge: None,
                stage: Stage::Node,
                chain: None,
                has_worked: false,
                is_closed: false,
            },
            rivals: 0,
        }
    }

    #[test]
    fn what_weighs_as_much_with_fewer_nodes_beats() {
        let mut rivals = Rivals::default();
        rivals.add(&label(5.0, 3.0, 0b011));
        rivals.add(&label(6.0, 7.0, 0b101));
        assert!(rivals.beat(&label(6.0, 3.0, 0b011), u128::MAX, true));
        assert!(
            !rivals.beat(&label(6.0, 3.0, 0b011), u128::MAX, false),
            "not as early"
        );
        assert!(
            !rivals.beat(&label(6.0, 3.5, 0b011), u128::MAX, true),
            "heavier"
        );
        assert!(
            !rivals.beat(&label(6.0, 7.0, 0b001), u128::MAX, true),
            "fewer nodes"
        );
        let cannot_go_on = Label {
            shut: 0b101,
            ..label(6.0, 7.0, 0b001)
        };
        assert!(rivals.beat(&cannot_go_on, u128::MAX, true));
        let mut back = label(1.0, 9.0, 0b1);
        back.earns_less_back = true;
        rivals.add(&back);
        assert!(!rivals.beat(&label(8.0, 8.0, 0b1), u128::MAX, true));
    }
}
