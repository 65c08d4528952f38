//! The lines of a text.

use csv::StringRecord;

/// Counts lines along a text, once over all calls.
pub(super) struct Lines<'a> {
    text: &'a [u8],
    byte: usize,
    breaks: usize,
}

impl<'a> Lines<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self {
            text: text.as_bytes(),
            byte: 0,
            breaks: 0,
        }
    }

    /// The line that a record begins in; records come in order. The reader's own count is off by one behind
    /// `\r\n`.
    pub(super) fn of(&mut self, record: &StringRecord) -> usize {
        let start = record.position().map_or(0, csv::Position::byte) as usize;
        let rest = self.text.get(start..).unwrap_or_default();
        let end = start + rest.iter().take_while(|b| b"\r\n".contains(b)).count();
        let passed = self.text.get(self.byte..end).unwrap_or_default();
        self.breaks += passed.iter().filter(|&&b| b == b'\n').count();
        self.byte = self.byte.max(end);
        self.breaks + 1
    }
}
