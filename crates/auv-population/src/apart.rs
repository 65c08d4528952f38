//! Values on cache lines of their own.

/// Keeps a value away from its neighbours, so that threads that write next to each other do not slow
/// each other down: processors fetch lines in pairs.
#[derive(Debug, Default)]
#[repr(align(128))]
pub(crate) struct Apart<T>(pub(crate) T);
