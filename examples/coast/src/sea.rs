//! The connected water of a bed, sampled.

/// Distance between samples, metres.
const CELL_M: f64 = 25.0;

/// The largest connected part of the samples that are deep enough.
pub(crate) struct Sea {
    half_m: f64,
    /// Samples in a row.
    side: usize,
    joined: Vec<bool>,
}

impl Sea {
    /// Samples the square of half side `half_m` about the origin, and keeps the largest connected part.
    pub(crate) fn flooded(half_m: f64, deep: impl Fn([f64; 2]) -> bool) -> Self {
        let side = (2.0 * half_m / CELL_M).ceil() as usize + 1;
        let at = |k: usize| (k as f64) * CELL_M - half_m;
        let water: Vec<bool> = (0..side * side)
            .map(|k| deep([at(k / side), at(k % side)]))
            .collect();
        let mut seen = vec![false; water.len()];
        let mut largest = Vec::new();
        for source in 0..water.len() {
            if !water[source] || seen[source] {
                continue;
            }
            seen[source] = true;
            let (mut part, mut next) = (vec![source], 0);
            while let Some(&cell) = part.get(next) {
                next += 1;
                for near in neighbours(cell, side) {
                    if water[near] && !std::mem::replace(&mut seen[near], true) {
                        part.push(near);
                    }
                }
            }
            if part.len() > largest.len() {
                largest = part;
            }
        }
        let mut joined = vec![false; water.len()];
        for cell in largest {
            joined[cell] = true;
        }
        Self {
            half_m,
            side,
            joined,
        }
    }

    /// Whether all samples around a place belong to the connected part.
    pub(crate) fn joins(&self, place: [f64; 2]) -> bool {
        let [north, east] = place.map(|x| ((x + self.half_m) / CELL_M).round() as isize);
        let inside = |k: isize| (1..self.side as isize - 1).contains(&k);
        let row = |north: isize| {
            let start = north as usize * self.side + east as usize;
            self.joined[start - 1..=start + 1].iter().all(|&cell| cell)
        };
        inside(north) && inside(east) && (north - 1..=north + 1).all(row)
    }
}

/// The four neighbours of a cell.
fn neighbours(cell: usize, side: usize) -> impl Iterator<Item = usize> {
    let (row, column) = (cell / side, cell % side);
    [
        (row > 0).then(|| cell.wrapping_sub(side)),
        (row + 1 < side).then_some(cell + side),
        (column > 0).then(|| cell.wrapping_sub(1)),
        (column + 1 < side).then_some(cell + 1),
    ]
    .into_iter()
    .flatten()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_larger_of_two_basins_is_joined() {
        let sea = Sea::flooded(500.0, |[n, _]| !(100.0..200.0).contains(&n));
        assert!(sea.joins([-300.0, 0.0]) && !sea.joins([350.0, 0.0]));
        assert!(!sea.joins([90.0, 0.0]), "a shore is near");
        assert!(!sea.joins([-500.0, 0.0]), "the edge is near");
    }
}
