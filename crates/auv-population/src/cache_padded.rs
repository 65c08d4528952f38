//! Padding against false sharing.

/// A value on cache lines of its own, so that threads which write neighbouring values do not slow
/// each other down. 128 bytes, since processors prefetch lines in pairs.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(crate) struct CachePadded<T>(pub(crate) T);
