//! Inequalities that every route satisfies and fractional routes break.

/// What an inequality says of the links that cross the rim of a set.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Kind {
    /// They are at least as many as touch this node of the set.
    Node(usize),
    /// If these links are all used, so is another, for the parity of crossings would be wrong (2-matching
    /// inequalities, Edmonds 1965).
    Teeth(Vec<(usize, usize)>),
}

/// An inequality that every route satisfies.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) struct Cut {
    /// The nodes of the set as bits in words.
    set: Vec<u64>,
    pub(crate) kind: Kind,
}

impl Cut {
    /// The inequality of some of `nodes` nodes.
    pub(crate) fn new(nodes: usize, members: &[usize], kind: Kind) -> Self {
        let mut set = vec![0_u64; nodes.div_ceil(64)];
        for &v in members {
            set[v / 64] |= 1 << (v % 64);
        }
        Self { set, kind }
    }

    pub(crate) fn has(&self, node: usize) -> bool {
        self.set[node / 64] >> (node % 64) & 1 == 1
    }

    pub(crate) fn crosses(&self, (u, v): (usize, usize)) -> bool {
        self.has(u) != self.has(v)
    }

    /// The node whose links the row charges for.
    pub(crate) fn node(&self) -> Option<usize> {
        match self.kind {
            Kind::Node(node) => Some(node),
            Kind::Teeth(_) => None,
        }
    }

    /// The links that the row charges for, although they cross the rim.
    pub(crate) fn teeth(&self) -> &[(usize, usize)] {
        match &self.kind {
            Kind::Node(_) => &[],
            Kind::Teeth(teeth) => teeth,
        }
    }

    /// Most links that cross the rim: two at each node.
    pub(crate) fn most_crossings(&self) -> f64 {
        2.0 * f64::from(self.set.iter().map(|word| word.count_ones()).sum::<u32>())
    }

    /// The right side of the row.
    pub(crate) fn right(&self) -> f64 {
        match &self.kind {
            Kind::Node(_) => 0.0,
            Kind::Teeth(teeth) => teeth.len() as f64 - 1.0,
        }
    }

    /// The coefficient of a link in the row: -1 if it crosses the rim, and 1 more if it touches the node or 2
    /// more if it is a tooth.
    pub(crate) fn coefficient(&self, ends: (usize, usize)) -> f64 {
        let more = match &self.kind {
            Kind::Node(node) => f64::from(u8::from(ends.0 == *node || ends.1 == *node)),
            Kind::Teeth(teeth) => 2.0 * f64::from(u8::from(teeth.binary_search(&ends).is_ok())),
        };
        more - f64::from(u8::from(self.crosses(ends)))
    }
}
