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

/// Adds a multiple of a row to another, and returns the squared length of the sum.
pub(crate) fn add_and_measure(to: &mut [f64], from: &[f64], factor: f64) -> f64 {
    const LANES: usize = 8;
    // Sums that need not wait for each other.
    let mut sums = [0.0; LANES];
    let mut to_chunks = to.chunks_exact_mut(LANES);
    let mut from_chunks = from.chunks_exact(LANES);
    for (to, from) in to_chunks.by_ref().zip(from_chunks.by_ref()) {
        for lane in 0..LANES {
            to[lane] += factor * from[lane];
            sums[lane] += to[lane] * to[lane];
        }
    }
    let mut sum: f64 = sums.iter().sum();
    let rest = to_chunks.into_remainder().iter_mut();
    for (to, from) in rest.zip(from_chunks.remainder()) {
        *to += factor * from;
        sum += *to * *to;
    }
    sum
}
