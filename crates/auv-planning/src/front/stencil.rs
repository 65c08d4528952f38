//! The steps that a front takes from a node.

use super::lattice::Lattice;

/// Steps from a node to others: all directions with coordinates up to a reach that are no multiples of
/// shorter ones.
#[derive(Clone, Debug)]
pub struct Stencil {
    steps: Vec<[isize; 3]>,
}

impl Stencil {
    /// The steps over ground of up to `reach` cells, each also one level up and down where there are
    /// levels.
    #[must_use]
    pub fn new(lattice: &Lattice, reach: isize) -> Self {
        let counts = lattice.counts();
        let span = |axis: usize, most: isize| {
            let most = if counts[axis] > 1 { most } else { 0 };
            -most..=most
        };
        let upright = counts[1] == 1;
        let levels = if upright { reach } else { 1 };
        let mut steps = Vec::new();
        for row in span(0, reach) {
            for column in span(1, reach) {
                for level in span(2, levels) {
                    let over_ground = gcd(row.unsigned_abs(), column.unsigned_abs());
                    let whole = gcd(over_ground, level.unsigned_abs());
                    let sloping = !upright && level != 0 && over_ground <= 1;
                    if whole == 1 && (over_ground == 1 || upright || sloping) {
                        steps.push([row, column, level]);
                    }
                }
            }
        }
        Self { steps }
    }

    /// The steps in rows, columns and levels.
    #[must_use]
    pub fn steps(&self) -> &[[isize; 3]] {
        &self.steps
    }
}

fn gcd(a: usize, b: usize) -> usize {
    if b == 0 { a } else { gcd(b, a % b) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Deadline;
    use crate::front::{Depths, Frame};
    use auv_types::{Point3, Vector3};

    #[test]
    fn directions_are_no_multiples_of_each_other() {
        let frame = Frame {
            anchor: Point3::origin(),
            anchor_node: [0, 0],
            ahead: Vector3::x(),
            side: Vector3::y(),
            cell_m: 10.0,
            counts: [20, 20],
        };
        let depths = Depths::ByRow(vec![20.0; 20]);
        let lattice = Lattice::new(&frame, &depths, None, None, Deadline::default()).unwrap();
        let counts = [1, 2, 3, 4, 5].map(|reach| Stencil::new(&lattice, reach).steps().len());
        assert_eq!(counts, [8, 16, 32, 48, 80]);
    }
}
