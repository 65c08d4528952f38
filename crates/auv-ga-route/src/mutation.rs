//! Insertion, swap and inversion of a route's interior genes (Fig. 9).

use auv_graph::NodeId;
use auv_types::{ChaCha8Rng, rand::RngExt};

/// One of the three mutations between two interior positions.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mutation {
    /// Moves the gene at the second position to the first.
    Insertion,
    /// Exchanges the two genes.
    Swap,
    /// Reverses the genes from the first to the second position.
    Inversion,
}

impl Mutation {
    /// Applies a random mutation between two random interior positions. Routes of fewer than two
    /// interior nodes stay as they are.
    pub(crate) fn apply_random(nodes: &mut [NodeId], random: &mut ChaCha8Rng) {
        let interior = nodes.len().saturating_sub(2);
        if interior < 2 {
            return;
        }
        let kind =
            [Self::Insertion, Self::Swap, Self::Inversion][random.random_range(0..3_u32) as usize];
        let a = random.random_range(0..interior as u32) as usize;
        let b = random.random_range(0..interior as u32 - 1) as usize;
        let b = if b >= a { b + 1 } else { b };
        kind.apply(nodes, 1 + a.min(b), 1 + a.max(b));
    }

    fn apply(self, nodes: &mut [NodeId], low: usize, high: usize) {
        match self {
            Self::Insertion => nodes[low..=high].rotate_right(1),
            Self::Swap => nodes.swap(low, high),
            Self::Inversion => nodes[low..=high].reverse(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use auv_types::Seed;

    #[test]
    fn mutants_are_those_of_fig_9() {
        // Start 1, destination 20.
        let mutated = |mutation: Mutation, low, high| {
            let mut nodes = [1, 6, 11, 19, 5, 9, 13, 8, 20].map(NodeId);
            mutation.apply(&mut nodes, low, high);
            nodes.map(|node| node.0)
        };
        assert_eq!(
            mutated(Mutation::Insertion, 1, 2),
            [1, 11, 6, 19, 5, 9, 13, 8, 20]
        );
        assert_eq!(
            mutated(Mutation::Swap, 1, 6),
            [1, 13, 11, 19, 5, 9, 6, 8, 20]
        );
        assert_eq!(
            mutated(Mutation::Inversion, 1, 6),
            [1, 13, 9, 5, 19, 11, 6, 8, 20]
        );
    }

    #[test]
    fn ends_stay_and_no_node_is_lost() {
        let mut random = Seed(5).stream(0);
        for length in 0..9 {
            let nodes: Vec<_> = (0..length).map(NodeId).collect();
            for _ in 0..50 {
                let mut mutant = nodes.clone();
                Mutation::apply_random(&mut mutant, &mut random);
                assert_eq!(mutant.first(), nodes.first());
                assert_eq!(mutant.last(), nodes.last());
                mutant.sort_unstable();
                assert_eq!(mutant, nodes);
            }
        }
    }
}
