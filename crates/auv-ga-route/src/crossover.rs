//! Uniform crossover of two routes (Fig. 8).

use auv_graph::NodeId;

/// Copies the parents to the children and exchanges the genes at the interior positions for which
/// `swaps` is true. The first and last genes of each route stay; a longer route keeps its tail.
///
/// `swaps` is called once for each interior position of the shorter route, in order.
pub(crate) fn uniform(
    parents: [&[NodeId]; 2],
    children: [&mut Vec<NodeId>; 2],
    mut swaps: impl FnMut(usize) -> bool,
) {
    let [first, second] = children;
    first.clear();
    second.clear();
    first.extend_from_slice(parents[0]);
    second.extend_from_slice(parents[1]);
    let shorter = first.len().min(second.len());
    for position in 1..shorter.saturating_sub(1) {
        if swaps(position) {
            std::mem::swap(&mut first[position], &mut second[position]);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn children_are_those_of_fig_8() {
        // Start 1, destination 20; exchanged at the 1-based positions 2, 4, 5, 7 and 8.
        let ids = |nodes: &[u32]| nodes.iter().copied().map(NodeId).collect::<Vec<_>>();
        let parents = [
            ids(&[1, 3, 14, 18, 8, 4, 7, 17, 20]),
            ids(&[1, 5, 9, 6, 11, 16, 13, 10, 12, 19, 20]),
        ];
        let (mut first, mut second) = (Vec::new(), Vec::new());
        uniform(
            [&parents[0], &parents[1]],
            [&mut first, &mut second],
            |position| [2, 4, 5, 7, 8].contains(&(position + 1)),
        );
        assert_eq!(first, ids(&[1, 5, 14, 6, 11, 4, 13, 10, 20]));
        assert_eq!(second, ids(&[1, 3, 9, 18, 8, 16, 7, 17, 12, 19, 20]));
    }
}
