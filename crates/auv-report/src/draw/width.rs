//! How wide a text is in the widest of the fonts that pictures name.
//!
//! A viewer takes the first font it has of Helvetica, Arial, Liberation Sans and DejaVu Sans. The
//! first three have the same advance widths; DejaVu Sans is up to a third wider, `J` and some
//! capitals are narrower. Every character is measured with the wider of its two widths, so that no
//! text leaves its place in either font.

/// Advance widths of the characters from space to `~`, thousandths of the size: the wider of DejaVu
/// Sans 2.37 and Liberation Sans 1.07.4 (tables `hmtx` of the fonts).
#[rustfmt::skip]
const REGULAR: [u16; 95] = [
    318, 401, 460, 838, 636, 950, 780, 275, 390, 390, 500, 838, 318, 361, 318, 337,
    636, 636, 636, 636, 636, 636, 636, 636, 636, 636, 337, 337, 838, 838, 838, 556,
    1015, 684, 686, 722, 770, 667, 611, 778, 752, 295, 500, 667, 557, 863, 748, 787,
    667, 787, 722, 667, 611, 732, 684, 989, 685, 667, 685, 390, 337, 390, 838, 556,
    500, 613, 635, 550, 635, 615, 352, 635, 634, 278, 278, 579, 278, 974, 634, 612,
    635, 635, 411, 521, 392, 634, 592, 818, 592, 592, 525, 636, 337, 636, 838,
];

/// The same of the bold faces.
#[rustfmt::skip]
const BOLD: [u16; 95] = [
    348, 456, 521, 838, 696, 1002, 872, 306, 457, 457, 523, 838, 380, 415, 380, 365,
    696, 696, 696, 696, 696, 696, 696, 696, 696, 696, 400, 400, 838, 838, 838, 611,
    1000, 774, 762, 734, 830, 683, 683, 821, 837, 372, 556, 775, 637, 995, 837, 850,
    733, 850, 770, 720, 682, 812, 774, 1103, 771, 724, 725, 457, 365, 457, 838, 556,
    500, 675, 716, 593, 716, 678, 435, 716, 712, 343, 343, 665, 343, 1042, 712, 687,
    716, 716, 493, 595, 478, 712, 652, 924, 645, 652, 582, 712, 365, 712, 838,
];

/// The width taken for every other character, thousandths of the size: accented letters have at most
/// 700, mathematical signs and arrows 838 to 1000.
const OTHER: u16 = 1000;

/// The width of a text in a regular face of this size, pixels.
pub(crate) fn width_of(text: &str, size: f64) -> f64 {
    measured(text, size, &REGULAR)
}

/// The width of a text in a bold face of this size, pixels.
pub(crate) fn bold_width_of(text: &str, size: f64) -> f64 {
    measured(text, size, &BOLD)
}

fn measured(text: &str, size: f64, advances: &[u16; 95]) -> f64 {
    let advance = |c: char| {
        let place = (c as usize).checked_sub(' ' as usize);
        let known = place.and_then(|place| advances.get(place));
        u32::from(*known.unwrap_or(&OTHER))
    };
    size * f64::from(text.chars().map(advance).sum::<u32>()) / 1000.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_as_wide_as_in_the_wider_font() {
        // A 684 and V 684 are DejaVu's, space 318 too; J 500 is Liberation's.
        assert_eq!(width_of("AV J", 1000.0).to_string(), "2186");
        assert_eq!(bold_width_of("AV J", 1000.0).to_string(), "2452");
        assert_eq!(width_of("\u{7}é", 10.0).to_string(), "20");
    }
}
