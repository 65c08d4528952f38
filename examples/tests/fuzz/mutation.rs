//! Damage to a text: bytes, slices, lines, numbers.

use auv_types::ChaCha8Rng;
use auv_types::rand::RngExt;

/// Numbers and words in place of a number.
const ODD: [&str; 28] = [
    "0",
    "-0.0",
    "-1",
    "1",
    "2",
    "1e-300",
    "1e300",
    "-1e300",
    "1e308",
    "1e999",
    "5e-324",
    "nan",
    "inf",
    "-inf",
    "NaN",
    "null",
    "true",
    "\"x\"",
    "[]",
    "{}",
    "4294967295",
    "4294967296",
    "-2147483649",
    "9007199254740993",
    "18446744073709551616",
    "0x10",
    "1e9",
    "100000",
];

/// One number of a list of ordinary and extreme ones.
pub(crate) fn odd(random: &mut ChaCha8Rng) -> f64 {
    const NUMBERS: [f64; 20] = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        10.0,
        100.0,
        1e3,
        1e4,
        1e-9,
        1e9,
        1e-300,
        1e300,
        -1e300,
        f64::MAX,
        f64::MIN_POSITIVE,
        f64::EPSILON,
        f64::INFINITY,
        f64::NEG_INFINITY,
        f64::NAN,
    ];
    NUMBERS[random.random_range(0..NUMBERS.len())]
}

/// The text with one to five faults.
pub(crate) fn damaged(text: &str, random: &mut ChaCha8Rng) -> String {
    let mut bytes = text.as_bytes().to_vec();
    for _ in 0..random.random_range(1..6) {
        if bytes.is_empty() {
            break;
        }
        match random.random_range(0..8) {
            0 => bytes.truncate(random.random_range(0..bytes.len())),
            1 => {
                let at = random.random_range(0..bytes.len());
                bytes[at] = random.random_range(0..=255);
            }
            2 => cut(&mut bytes, random),
            3 => repeat(&mut bytes, random),
            _ => other_number(&mut bytes, random),
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn slice(bytes: &[u8], random: &mut ChaCha8Rng) -> std::ops::Range<usize> {
    let from = random.random_range(0..bytes.len());
    let length = random.random_range(1..40);
    from..(from + length).min(bytes.len())
}

fn cut(bytes: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let range = slice(bytes, random);
    bytes.drain(range);
}

/// A slice, or the line that it is in, again somewhere else.
fn repeat(bytes: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let mut range = slice(bytes, random);
    if random.random() {
        let before = bytes[..range.start].iter().rposition(|b| *b == b'\n');
        let after = bytes[range.start..].iter().position(|b| *b == b'\n');
        range = before.map_or(0, |at| at + 1)..after.map_or(bytes.len(), |at| range.start + at + 1);
    }
    let copy = bytes[range.clone()].to_vec();
    let at = if random.random() {
        range.end
    } else {
        random.random_range(0..=bytes.len())
    };
    bytes.splice(at..at, copy);
}

/// A number becomes another.
fn other_number(bytes: &mut Vec<u8>, random: &mut ChaCha8Rng) {
    let is_part = |b: u8| b.is_ascii_digit() || matches!(b, b'.' | b'-' | b'+' | b'e');
    let from = random.random_range(0..bytes.len());
    let Some(start) = (from..bytes.len()).find(|&k| bytes[k].is_ascii_digit()) else {
        return;
    };
    let start = bytes[..start]
        .iter()
        .rposition(|b| !is_part(*b))
        .map_or(0, |k| k + 1);
    let end = (start..bytes.len())
        .find(|&k| !is_part(bytes[k]))
        .unwrap_or(bytes.len());
    let odd = ODD[random.random_range(0..ODD.len())];
    bytes.splice(start..end, odd.bytes());
}
