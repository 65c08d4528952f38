//! The moves of the local search, and how they change a tour.

/// Most new nodes in a row.
pub(super) const CHAIN: usize = 4;

/// A change of a tour, by positions.
#[derive(Clone, Copy, Debug)]
pub(super) enum Move {
    /// Replaces the nodes strictly between two positions by the first `count` of `new`.
    Splice {
        from: usize,
        to: usize,
        new: [u32; CHAIN],
        count: usize,
    },
    /// Exchanges the blocks `first + 1 ..= middle` and `middle + 1 ..= last`, each reversed where
    /// `reversed` says so.
    Exchange {
        first: usize,
        middle: usize,
        last: usize,
        reversed: [bool; 2],
    },
    /// Reverses the nodes `first + 1 ..= last`.
    Reverse { first: usize, last: usize },
}

impl Move {
    /// Changes the nodes of the tour.
    pub(super) fn apply(&self, nodes: &mut Vec<u32>) {
        match *self {
            Self::Splice {
                from,
                to,
                new,
                count,
            } => {
                nodes.splice(from + 1..to, new[..count].iter().copied());
            }
            Self::Exchange {
                first,
                middle,
                last,
                reversed,
            } => {
                let block = &mut nodes[first + 1..=last];
                let size = middle - first;
                if reversed[0] {
                    block[..size].reverse();
                }
                if reversed[1] {
                    block[size..].reverse();
                }
                block.rotate_left(size);
            }
            Self::Reverse { first, last } => nodes[first + 1..=last].reverse(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn applied(change: Move) -> Vec<u32> {
        let mut nodes = vec![0, 2, 3, 4, 5, 6, 1];
        change.apply(&mut nodes);
        nodes
    }

    #[test]
    fn a_splice_replaces_what_lies_strictly_between() {
        let splice = |to, count| Move::Splice {
            from: 1,
            to,
            new: [7, 8, 9, 10],
            count,
        };
        assert_eq!(applied(splice(2, 1)), [0, 2, 7, 3, 4, 5, 6, 1]);
        assert_eq!(applied(splice(4, 2)), [0, 2, 7, 8, 5, 6, 1]);
        assert_eq!(applied(splice(3, 0)), [0, 2, 4, 5, 6, 1]);
    }

    #[test]
    fn an_exchange_reverses_the_blocks_that_it_is_told_to() {
        let exchange = |reversed| Move::Exchange {
            first: 0,
            middle: 2,
            last: 5,
            reversed,
        };
        assert_eq!(applied(exchange([false, false])), [0, 4, 5, 6, 2, 3, 1]);
        assert_eq!(applied(exchange([true, false])), [0, 4, 5, 6, 3, 2, 1]);
        assert_eq!(applied(exchange([false, true])), [0, 6, 5, 4, 2, 3, 1]);
    }

    #[test]
    fn a_reversal_starts_after_its_first_position() {
        let reversed = applied(Move::Reverse { first: 1, last: 4 });
        assert_eq!(reversed, [0, 2, 5, 4, 3, 6, 1]);
    }
}
