//! Sets of edges, for edges removed from a network without copying it.

use crate::ids::EdgeId;

/// A set of edges as a bit vector; it grows as edges are inserted.
#[derive(Clone, Debug, Default, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(transparent)
)]
pub struct EdgeSet {
    words: Vec<u64>,
}

impl EdgeSet {
    /// The empty set.
    #[must_use]
    pub const fn empty() -> Self {
        Self { words: Vec::new() }
    }

    /// Whether the edge is in the set.
    #[inline]
    #[must_use]
    pub fn contains(&self, edge: EdgeId) -> bool {
        let (word, bit) = (edge.0 as usize / 64, edge.0 % 64);
        self.words.get(word).is_some_and(|w| w >> bit & 1 == 1)
    }

    /// Inserts an edge; returns whether it was new.
    pub fn insert(&mut self, edge: EdgeId) -> bool {
        let (word, bit) = (edge.0 as usize / 64, edge.0 % 64);
        if word >= self.words.len() {
            self.words.resize(word + 1, 0);
        }
        let new = !self.contains(edge);
        self.words[word] |= 1 << bit;
        new
    }

    /// Number of edges.
    #[must_use]
    pub fn len(&self) -> usize {
        self.words.iter().map(|w| w.count_ones() as usize).sum()
    }

    /// Whether there is no edge.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.words.iter().all(|&w| w == 0)
    }

    /// The edges in ascending order.
    pub fn iter(&self) -> impl Iterator<Item = EdgeId> + '_ {
        (0..self.words.len() as u32 * 64)
            .map(EdgeId)
            .filter(|&edge| self.contains(edge))
    }
}

impl FromIterator<EdgeId> for EdgeSet {
    fn from_iter<I: IntoIterator<Item = EdgeId>>(edges: I) -> Self {
        let mut set = Self::empty();
        for edge in edges {
            set.insert(edge);
        }
        set
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_edge_is_inserted_once_and_listed_in_order() {
        let mut set: EdgeSet = [200, 3, 64].map(EdgeId).into_iter().collect();
        assert!(!set.insert(EdgeId(64)) && set.insert(EdgeId(0)));
        assert!(set.contains(EdgeId(3)) && !set.contains(EdgeId(9_999)));
        assert_eq!(set.iter().map(|e| e.0).collect::<Vec<_>>(), [0, 3, 64, 200]);
        assert_eq!(set.len(), 4);
    }
}
