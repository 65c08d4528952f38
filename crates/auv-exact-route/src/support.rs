//! A fractional route as a graph.

/// Violations below this are not worth a row.
pub(crate) const LEAST_VIOLATION: f64 = 1e-3;

/// A link of a fractional route.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SupportLink {
    pub(crate) ends: (usize, usize),
    pub(crate) value: f64,
}

/// A fractional route over `nodes` nodes.
pub(crate) struct Support<'a> {
    pub(crate) nodes: usize,
    pub(crate) ends: (usize, usize),
    pub(crate) links: &'a [SupportLink],
}

impl Support<'_> {
    pub(crate) fn is_end(&self, v: usize) -> bool {
        v == self.ends.0 || v == self.ends.1
    }

    /// The sum of the links at each node.
    pub(crate) fn touch(&self) -> Vec<f64> {
        let mut touch = vec![0.0; self.nodes];
        for link in self.links {
            touch[link.ends.0] += link.value;
            touch[link.ends.1] += link.value;
        }
        touch
    }

    /// The sets of three nodes and more that grow when links are merged, the heaviest first.
    pub(crate) fn merged_sets(&self, may_merge: impl Fn(&SupportLink) -> bool) -> Vec<Vec<usize>> {
        let mut links: Vec<_> = self.links.iter().filter(|link| may_merge(link)).collect();
        links.sort_by(|a, b| b.value.total_cmp(&a.value).then(a.ends.cmp(&b.ends)));
        let mut set_of: Vec<usize> = (0..self.nodes).collect();
        let mut members: Vec<Vec<usize>> = (0..self.nodes).map(|v| vec![v]).collect();
        let mut sets = Vec::new();
        for link in links {
            let (a, b) = (set_of[link.ends.0], set_of[link.ends.1]);
            if a != b {
                let moved = std::mem::take(&mut members[b]);
                moved.iter().for_each(|&v| set_of[v] = a);
                members[a].extend(moved);
                if members[a].len() > 2 {
                    sets.push(members[a].clone());
                }
            }
        }
        sets
    }
}
