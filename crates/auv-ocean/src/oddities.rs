//! Cells of a curvilinear grid that cannot be cells.

use auv_types::libm;

/// So many times the usual length of the edges around it an edge may be.
const TIMES_USUAL: f64 = 5.0;
/// Edges on either side among which the usual length is taken.
const AROUND: usize = 3;

/// The cells of a grid that are holes: cells of an edge many times as long as those around it, and cells
/// without a width.
#[derive(Debug, Default)]
pub(crate) struct OddCells {
    /// Whether a cell is a hole, `rows - 1` by `columns - 1`.
    pub(crate) holes: Vec<bool>,
    long: usize,
    repeated: usize,
}

/// Finds them. Nodes without a position make holes of their own and are not counted.
pub(crate) fn odd_cells(columns: usize, latitudes_deg: &[f64], longitudes_deg: &[f64]) -> OddCells {
    let rows = latitudes_deg.len().checked_div(columns).unwrap_or(0);
    let mut found = OddCells::default();
    if rows < 2 || columns < 2 {
        return found;
    }
    found.holes = vec![false; (rows - 1) * (columns - 1)];
    // Longest edges of cells, as verdicts: 0 sound, 1 repeated, 2 too long.
    let mut verdicts = vec![0_u8; found.holes.len()];
    let length = |a: usize, b: usize| {
        let north = latitudes_deg[b] - latitudes_deg[a];
        let east = libm::remainder(longitudes_deg[b] - longitudes_deg[a], 360.0);
        let wide = libm::cos((0.5 * (latitudes_deg[a] + latitudes_deg[b])).to_radians());
        libm::hypot(north, east * wide)
    };
    let mut edges: Vec<f64> = Vec::new();
    let judge = |edges: &[f64], mark: &mut dyn FnMut(usize, u8)| {
        for (i, &edge) in edges.iter().enumerate() {
            let verdict = verdict(edges, i, edge);
            if verdict > 0 {
                mark(i, verdict);
            }
        }
    };
    for row in 0..rows {
        edges.clear();
        edges.extend((0..columns - 1).map(|c| length(row * columns + c, row * columns + c + 1)));
        judge(&edges, &mut |column, verdict| {
            for r in [row.wrapping_sub(1), row] {
                if r < rows - 1 {
                    let cell = &mut verdicts[r * (columns - 1) + column];
                    *cell = verdict.max(*cell);
                }
            }
        });
    }
    for column in 0..columns {
        edges.clear();
        edges.extend(
            (0..rows - 1).map(|r| length(r * columns + column, (r + 1) * columns + column)),
        );
        judge(&edges, &mut |row, verdict| {
            for c in [column.wrapping_sub(1), column] {
                if c < columns - 1 {
                    let cell = &mut verdicts[row * (columns - 1) + c];
                    *cell = verdict.max(*cell);
                }
            }
        });
    }
    for (hole, verdict) in found.holes.iter_mut().zip(verdicts) {
        *hole = verdict > 0;
        found.long += usize::from(verdict == 2);
        found.repeated += usize::from(verdict == 1);
    }
    found
}

fn verdict(edges: &[f64], i: usize, edge: f64) -> u8 {
    if !edge.is_finite() {
        return 0;
    }
    if edge < 1e-9 {
        return 1;
    }
    let around = &edges[i.saturating_sub(AROUND)..(i + AROUND + 1).min(edges.len())];
    // Most edges are like the one before: nothing to sort.
    if edge < 170.0
        && around
            .iter()
            .all(|&other| other.is_nan() || other <= 0.0 || edge <= TIMES_USUAL * other)
    {
        return 0;
    }
    let mut usual: Vec<f64> = around
        .iter()
        .copied()
        .filter(|x| x.is_finite() && *x >= 1e-9)
        .collect();
    usual.sort_by(f64::total_cmp);
    let median = usual[(usual.len() - 1) / 2];
    if edge > TIMES_USUAL * median || edge >= 170.0 {
        2
    } else {
        0
    }
}

/// What is odd about a grid, in words.
pub(crate) fn oddities(
    columns: usize,
    latitudes_deg: &[f64],
    longitudes_deg: &[f64],
) -> Vec<String> {
    let odd = odd_cells(columns, latitudes_deg, longitudes_deg);
    let mut words = Vec::new();
    if odd.long > 0 {
        words.push(format!(
            "{} cells many times as long as those around them are holes",
            odd.long
        ));
    }
    if odd.repeated > 0 {
        words.push(format!(
            "{} cells between repeated positions are left out",
            odd.repeated
        ));
    }
    words
}

#[cfg(test)]
mod tests {
    use super::*;

    fn holes(longitudes: &[f64]) -> Vec<usize> {
        let (mut latitudes, mut all) = (Vec::new(), Vec::new());
        for row in 0..3 {
            latitudes.extend(longitudes.iter().map(|_| 58.0 + 0.01 * f64::from(row)));
            all.extend_from_slice(longitudes);
        }
        let odd = odd_cells(longitudes.len(), &latitudes, &all);
        (0..longitudes.len() - 1)
            .filter(|&i| odd.holes[i])
            .collect()
    }

    #[test]
    fn gaps_and_repeated_positions_are_holes() {
        assert!(holes(&[0.0, 0.1, 0.2, 0.3, 0.4]).is_empty());
        assert_eq!(holes(&[0.0, 0.1, 0.2, 3.0, 3.1, 3.2]), [2]);
        assert_eq!(holes(&[0.0, 0.1, 0.2, 3.0, 6.0, 6.1, 6.2, 6.3]), [2, 3]);
        assert_eq!(holes(&[0.0, 0.1, 0.1, 0.2, 0.3]), [1]);
        // A finer part is no gap; nor is the antimeridian.
        assert!(holes(&[0.0, 0.1, 0.2, 0.3, 1.3, 2.3, 3.3, 4.3]).is_empty());
        assert!(holes(&[179.8, 179.9, -180.0, -179.9]).is_empty());
        assert_eq!(
            holes(&[-180.0, -179.9, -179.8, 179.7, 179.8, 179.9]).len(),
            1
        );
        // A position that is missing is a hole of the grid anyway.
        assert!(holes(&[0.0, f64::NAN, 0.2, 0.3]).is_empty());
    }
}
