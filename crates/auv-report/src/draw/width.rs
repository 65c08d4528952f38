//! How wide a text is.

/// Advance widths of the characters from space to `~`, thousandths of the size, as Helvetica, Arial
/// and Liberation Sans have them alike.
#[rustfmt::skip]
const ADVANCES: [u16; 95] = [
    278, 278, 355, 556, 556, 889, 667, 191, 333, 333, 389, 584, 278, 333, 278, 278,
    556, 556, 556, 556, 556, 556, 556, 556, 556, 556, 278, 278, 584, 584, 584, 556,
    1015, 667, 667, 722, 722, 667, 611, 778, 722, 278, 500, 667, 556, 833, 722, 778,
    667, 778, 722, 667, 611, 722, 667, 944, 667, 667, 611, 278, 278, 278, 469, 556,
    333, 556, 556, 500, 556, 556, 278, 556, 556, 222, 222, 500, 222, 833, 556, 556,
    556, 556, 333, 500, 278, 556, 500, 722, 500, 500, 500, 334, 260, 334, 584,
];

/// Of characters beyond the table, as of digits.
const OTHER: u16 = 556;

/// How much wider bold is, on the whole.
pub(crate) const BOLD: f64 = 1.08;

/// How wide a text is, pixels, in the pictures' font at a size.
pub(crate) fn width_of(text: &str, size: f64) -> f64 {
    let advance = |c: char| {
        let place = (c as usize).checked_sub(' ' as usize);
        let known = place.and_then(|place| ADVANCES.get(place));
        u32::from(*known.unwrap_or(&OTHER))
    };
    size * f64::from(text.chars().map(advance).sum::<u32>()) / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_are_as_wide_as_they_are() {
        // By hand from Adobe's metrics of Helvetica: A 667, U 722, V 667, space 278, ~ 584.
        let widths = [width_of("AUV ~", 1000.0), width_of("\u{7}é", 10.0)];
        assert_eq!(widths.map(|width| width.to_string()), ["2918", "11.12"]);
    }
}
