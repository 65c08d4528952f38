//! The numbers of the two ends of a route in the search space.

/// The number of the start.
pub(crate) const START: u32 = 0;
/// The number of the destination.
pub(crate) const END: u32 = 1;
