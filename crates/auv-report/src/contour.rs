//! Areas of a sampled field above a level.

/// A function sampled on a regular grid.
pub(crate) struct Grid {
    columns: usize,
    rows: usize,
    origin: (f64, f64),
    step: (f64, f64),
    values: Vec<f64>,
}

impl Grid {
    /// Samples `f(x, y)` at `columns` by `rows` points over a box.
    pub(crate) fn sample(
        (columns, rows): (usize, usize),
        (x, y): ((f64, f64), (f64, f64)),
        f: impl Fn(f64, f64) -> f64,
    ) -> Self {
        let (columns, rows) = (columns.max(2), rows.max(2));
        let step = (
            (x.1 - x.0) / (columns - 1) as f64,
            (y.1 - y.0) / (rows - 1) as f64,
        );
        let values = (0..rows)
            .flat_map(|j| (0..columns).map(move |i| (i, j)))
            .map(|(i, j)| f(x.0 + step.0 * i as f64, y.0 + step.1 * j as f64))
            .collect();
        Self {
            columns,
            rows,
            origin: (x.0, y.0),
            step,
            values,
        }
    }

    /// The greatest value.
    pub(crate) fn greatest(&self) -> f64 {
        self.values
            .iter()
            .copied()
            .fold(f64::NEG_INFINITY, f64::max)
    }

    /// The area where the values exceed `level`, as rings that touch but do not overlap. Within a cell
    /// its border is straight; whole cells of a row form one ring.
    pub(crate) fn above(&self, level: f64) -> Vec<Vec<(f64, f64)>> {
        let mut rings = Vec::new();
        for j in 0..self.rows - 1 {
            let mut run: Option<usize> = None;
            for i in 0..self.columns - 1 {
                let corners = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)];
                let inside = corners.map(|(i, j)| self.value(i, j) > level);
                if inside == [true; 4] {
                    run.get_or_insert(i);
                    continue;
                }
                if let Some(begin) = run.take() {
                    rings.push(self.block(begin, i, j));
                }
                if inside != [false; 4] {
                    rings.push(self.part(corners, level));
                }
            }
            if let Some(begin) = run {
                rings.push(self.block(begin, self.columns - 1, j));
            }
        }
        rings
    }

    fn value(&self, i: usize, j: usize) -> f64 {
        self.values[j * self.columns + i]
    }

    fn place(&self, i: f64, j: f64) -> (f64, f64) {
        (
            self.origin.0 + self.step.0 * i,
            self.origin.1 + self.step.1 * j,
        )
    }

    fn block(&self, from: usize, to: usize, j: usize) -> Vec<(f64, f64)> {
        let (a, b, j) = (from as f64, to as f64, j as f64);
        [(a, j), (b, j), (b, j + 1.0), (a, j + 1.0)]
            .map(|(i, j)| self.place(i, j))
            .to_vec()
    }

    /// The part of a cell above the level: its corners above it and the crossings of its sides.
    fn part(&self, corners: [(usize, usize); 4], level: f64) -> Vec<(f64, f64)> {
        let mut ring = Vec::with_capacity(6);
        for k in 0..4 {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            let (va, vb) = (self.value(a.0, a.1) - level, self.value(b.0, b.1) - level);
            let pa = (a.0 as f64, a.1 as f64);
            if va > 0.0 {
                ring.push(self.place(pa.0, pa.1));
            }
            if (va > 0.0) != (vb > 0.0) {
                let share = va / (va - vb);
                let (di, dj) = (b.0 as f64 - pa.0, b.1 as f64 - pa.1);
                ring.push(self.place(pa.0 + share * di, pa.1 + share * dj));
            }
        }
        ring
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_slope_is_cut_where_it_crosses_the_level() {
        let grid = Grid::sample((5, 3), ((0.0, 4.0), (0.0, 2.0)), |x, _| x);
        let area: f64 = grid.above(1.5).iter().map(|ring| shoelace(ring)).sum();
        assert!((area - 5.0).abs() < 1e-12 && (grid.greatest() - 4.0).abs() < 1e-12);
    }

    fn shoelace(ring: &[(f64, f64)]) -> f64 {
        let pairs = ring.iter().zip(ring.iter().cycle().skip(1));
        0.5 * pairs.map(|(a, b)| a.0 * b.1 - a.1 * b.0).sum::<f64>().abs()
    }
}
