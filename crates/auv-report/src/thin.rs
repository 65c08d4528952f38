//! Thins time series.

/// Drops redundant rows of a series. Each row starts with its time. Every row dropped lies within
/// `exact` of the linear interpolation between the two rows kept around it.
///
/// The first and the last are kept. Between two kept rows lie at most 120, so that the work is
/// linear in the length of the series.
pub(crate) fn thinned<const N: usize>(rows: &[[f64; N]], exact: f64) -> Vec<[f64; N]> {
    const LONGEST: usize = 120;
    let mut kept: Vec<[f64; N]> = rows.first().copied().into_iter().collect();
    let mut from = 0;
    while from + 1 < rows.len() {
        let steady = |to: usize| {
            let (a, b) = (&rows[from], &rows[to]);
            let whole = b[0] - a[0];
            rows[from + 1..to].iter().all(|row| {
                let share = (row[0] - a[0]) / whole;
                let off = |k: usize| a[k] + (b[k] - a[k]) * share - row[k];
                (1..N).map(|k| off(k) * off(k)).sum::<f64>() <= exact * exact
            })
        };
        let last = (from + LONGEST).min(rows.len() - 1);
        let mut to = from + 1;
        while to < last && steady(to + 1) {
            to += 1;
        }
        kept.push(rows[to]);
        from = to;
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::thinned;

    #[test]
    fn corners_stay_and_straight_stretches_go() {
        let rows: Vec<[f64; 2]> = (0..100_i32)
            .map(|k| [f64::from(k), f64::from((k - 50).abs())])
            .collect();
        assert_eq!(
            thinned(&rows, 1e-9),
            [[0.0, 50.0], [50.0, 0.0], [99.0, 49.0]]
        );
        assert_eq!(thinned(&rows[..1], 1.0), [[0.0, 50.0]]);
        assert!(thinned::<2>(&[], 1.0).is_empty());
    }
}
