//! Where a string touches something.

use crate::taut::contact::Contact;

/// A contact of one segment of a string.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SegmentContact {
    /// Index of the region; `None` for the box and the sea bed.
    pub(crate) region: Option<usize>,
    pub(crate) segment: usize,
    pub(crate) contact: Contact,
    /// Force along the contact's normal that holds the string off, in units of its tension.
    pub(crate) force: f64,
}

/// How deep the deepest contact lies inside, metres.
pub(crate) fn deepest_m(contacts: &[SegmentContact]) -> f64 {
    let depths = contacts.iter().map(|touch| -touch.contact.gap_m);
    depths.fold(0.0, f64::max)
}
