//! Minimum cuts between two nodes.

use crate::support::SupportLink;

/// Flows between two nodes of a graph, each link with its value as capacity.
pub(crate) struct Flows {
    /// Half-links by tail: head and index; the other half has the index with its last bit flipped.
    half_links: Vec<Vec<(usize, usize)>>,
    tail: Vec<usize>,
    capacity: Vec<f64>,
}

impl Flows {
    pub(crate) fn new(nodes: usize, links: impl Iterator<Item = SupportLink>) -> Self {
        let mut half_links = vec![Vec::new(); nodes];
        let (mut tail, mut capacity) = (Vec::new(), Vec::new());
        for link in links {
            let (u, v) = link.ends;
            half_links[u].push((v, capacity.len()));
            half_links[v].push((u, capacity.len() + 1));
            tail.extend([u, v]);
            capacity.extend([link.value; 2]);
        }
        Self {
            half_links,
            tail,
            capacity,
        }
    }

    /// The nodes on the side of `node` of a minimum cut between it and `sink`, if less than `wanted` flows across
    /// it.
    pub(crate) fn cut(&self, node: usize, sink: usize, wanted: f64) -> Option<Vec<usize>> {
        let mut left = self.capacity.clone();
        let mut flow = 0.0;
        loop {
            let (reached, from) = self.search((node, sink), &left);
            if from[sink].is_none() {
                return (flow < wanted).then_some(reached);
            }
            let path = std::iter::successors(from[sink], |&half| from[self.tail[half]]);
            let path: Vec<_> = path.collect();
            let most = path
                .iter()
                .map(|&half| left[half])
                .fold(f64::INFINITY, f64::min);
            for half in path {
                left[half] -= most;
                left[half ^ 1] += most;
            }
            flow += most;
            if flow >= wanted {
                return None;
            }
        }
    }

    /// The nodes reached from a node over what is left, and the half-link by which each other node was
    /// reached.
    fn search(
        &self,
        (node, sink): (usize, usize),
        left: &[f64],
    ) -> (Vec<usize>, Vec<Option<usize>>) {
        let mut from = vec![None; self.half_links.len()];
        let mut reached = vec![node];
        let mut next = 0;
        while let Some(&tail) = reached.get(next) {
            next += 1;
            for &(head, half) in &self.half_links[tail] {
                if left[half] > 1e-9 && from[head].is_none() && head != node {
                    from[head] = Some(half);
                    if head == sink {
                        return (reached, from);
                    }
                    reached.push(head);
                }
            }
        }
        (reached, from)
    }
}
