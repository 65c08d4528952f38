//! Rows of a dense matrix and sparse columns.

/// Index and entry.
pub(crate) type Entry = (u32, f64);

pub(crate) fn product(sparse: &[Entry], dense: &[f64]) -> f64 {
    let terms = sparse.iter().map(|&(at, entry)| entry * dense[at as usize]);
    terms.sum()
}

#[inline(always)]
pub(crate) fn add_multiple(to: &mut [f64], from: &[f64], factor: f64) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += factor * from;
    }
}

/// Adds a multiple of numbers to others, and to `squares` what the squares of these change by.
#[inline(always)]
pub(crate) fn add_multiple_and_measure(
    to: &mut [f64],
    from: &[f64],
    factor: f64,
    squares: &mut [f64],
) {
    for ((to, from), square) in to.iter_mut().zip(from).zip(squares) {
        let step = factor * from;
        *square += step * (*to + *to + step);
        *to += step;
    }
}

/// Runs loops that are also compiled for AVX2, where the processor has it. Nothing is fused or reordered: both give
/// equal bits.
pub(crate) fn vectorized<R>(loops: impl FnOnce() -> R) -> R {
    pulp::Arch::new().dispatch(loops)
}
