//! Rows of a dense matrix and sparse columns.

/// Row index and entry.
pub(crate) type Entry = (u32, f64);

pub(crate) fn product(column: &[Entry], row: &[f64]) -> f64 {
    let terms = column.iter().map(|&(at, entry)| entry * row[at as usize]);
    terms.sum()
}

pub(crate) fn add_multiple(to: &mut [f64], from: &[f64], factor: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += factor * from;
    }
}

pub(crate) fn squared_length(row: &[f64]) -> f64 {
    // Four sums, so that they need not wait for each other.
    let mut sums = [0.0; 4];
    let chunks = row.chunks_exact(4);
    let rest: f64 = chunks.remainder().iter().map(|entry| entry * entry).sum();
    for chunk in chunks {
        for (sum, entry) in sums.iter_mut().zip(chunk) {
            *sum += entry * entry;
        }
    }
    sums.iter().sum::<f64>() + rest
}
