//! A tour as a doubly linked list: nodes are inserted and removed in O(1), and changes are taken back.

use super::profit_time::ProfitTime;
use super::search_space::{END, START, SearchSpace};

/// Not on the tour.
const OUT: u32 = u32::MAX;

/// A change of a tour.
#[derive(Clone, Copy, Debug)]
enum Change {
    Inserted { node: u32 },
    Removed { node: u32, after: u32 },
}

/// A tour with the changes since the last [`LinkedTour::commit`].
#[derive(Clone, Debug)]
pub(super) struct LinkedTour {
    next: Vec<u32>,
    before: Vec<u32>,
    sum: ProfitTime,
    /// The sum before the changes.
    committed: ProfitTime,
    changes: Vec<Change>,
}

impl LinkedTour {
    pub(super) fn new(nodes: &[u32], space: &SearchSpace) -> Self {
        let mut tour = Self {
            next: vec![OUT; space.len()],
            before: vec![OUT; space.len()],
            sum: space.sum(nodes),
            committed: ProfitTime::default(),
            changes: Vec::new(),
        };
        for pair in nodes.windows(2) {
            tour.next[pair[0] as usize] = pair[1];
            tour.before[pair[1] as usize] = pair[0];
        }
        tour.commit();
        tour
    }

    /// Profit and time.
    pub(super) fn sum(&self) -> ProfitTime {
        self.sum
    }

    /// Profit and time before the changes.
    pub(super) fn committed(&self) -> ProfitTime {
        self.committed
    }

    /// Whether a node is on the tour.
    pub(super) fn visits(&self, node: u32) -> bool {
        node == START || self.before[node as usize] != OUT
    }

    /// The node after another one on the tour; none after the last.
    pub(super) fn after(&self, node: u32) -> Option<u32> {
        Some(self.next[node as usize]).filter(|&next| next != OUT)
    }

    /// The node before another one on the tour; none before the first.
    pub(super) fn before(&self, node: u32) -> Option<u32> {
        Some(self.before[node as usize]).filter(|&before| before != OUT)
    }

    /// Inserts a node after one on the tour; `detour` is what that adds.
    pub(super) fn insert(&mut self, node: u32, after: u32, detour: ProfitTime) {
        self.link(node, after);
        self.sum = self.sum + detour;
        self.changes.push(Change::Inserted { node });
    }

    /// Removes a node between the ends; false if no arc joins its neighbours.
    pub(super) fn remove(&mut self, node: u32, space: &SearchSpace) -> bool {
        let (Some(before), Some(after)) = (self.before(node), self.after(node)) else {
            return false;
        };
        let straight = space.arc(before, after);
        if node == END || straight.time_s == f64::INFINITY {
            return false;
        }
        let detour = space.arc(before, node) + space.arc(node, after) - straight;
        self.unlink(node);
        self.sum = self.sum - detour;
        self.changes.push(Change::Removed {
            node,
            after: before,
        });
        true
    }

    /// Keeps the changes.
    pub(super) fn commit(&mut self) {
        self.changes.clear();
        self.committed = self.sum;
    }

    /// Takes the changes back.
    pub(super) fn undo(&mut self) {
        while let Some(change) = self.changes.pop() {
            match change {
                Change::Inserted { node } => self.unlink(node),
                Change::Removed { node, after } => self.link(node, after),
            }
        }
        self.sum = self.committed;
    }

    /// The nodes in order.
    pub(super) fn nodes(&self) -> Vec<u32> {
        let mut nodes = vec![START];
        let mut at = START;
        while let Some(next) = self.after(at) {
            nodes.push(next);
            at = next;
        }
        nodes
    }

    fn link(&mut self, node: u32, after: u32) {
        let next = std::mem::replace(&mut self.next[after as usize], node);
        self.before[node as usize] = after;
        self.next[node as usize] = next;
        self.before[next as usize] = node;
    }

    fn unlink(&mut self, node: u32) {
        let before = std::mem::replace(&mut self.before[node as usize], OUT);
        let next = std::mem::replace(&mut self.next[node as usize], OUT);
        self.next[before as usize] = next;
        self.before[next as usize] = before;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::memetic::testing::{random_tour, spaces};
    use auv_types::Seed;
    use auv_types::rand::RngExt;

    #[test]
    fn changes_keep_the_sums_and_are_taken_back() {
        for space in spaces() {
            let first = random_tour(&space, 1);
            let mut tour = LinkedTour::new(&first.nodes, &space);
            let random = &mut Seed(2).stream(0);
            let mut changed = 0;
            for round in 0..200 {
                let before = tour.nodes();
                for _ in 0..5 {
                    let node = random.random_range(END + 1..space.len() as u32);
                    if tour.visits(node) {
                        tour.remove(node, &space);
                    } else {
                        let nodes = tour.nodes();
                        let at = random.random_range(0..nodes.len() - 1);
                        let legs = space.arc(nodes[at], node) + space.arc(node, nodes[at + 1]);
                        let detour = legs - space.arc(nodes[at], nodes[at + 1]);
                        if detour.time_s < f64::INFINITY {
                            tour.insert(node, nodes[at], detour);
                        }
                    }
                }
                let after = tour.nodes();
                changed += usize::from(after != before);
                assert!((space.sum(&after).time_s - tour.sum().time_s).abs() < 1e-6);
                assert!(after.iter().all(|&node| tour.visits(node)));
                if round % 2 == 0 {
                    tour.undo();
                    assert_eq!(tour.nodes(), before);
                    assert_eq!(tour.sum(), tour.committed());
                } else {
                    tour.commit();
                }
            }
            assert!(changed > 50, "{changed}");
        }
    }
}
