//! Text, numbers and error places in files.

use super::error::{FormatError, MAX_FILE_BYTES};
use auv_types::Violations;

/// The bytes as text, if they are short enough and UTF-8, without a byte-order mark.
pub(super) fn text_of(bytes: &[u8]) -> Result<&str, FormatError> {
    if bytes.len() > MAX_FILE_BYTES {
        return Err(FormatError::TooLarge { bytes: bytes.len() });
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let valid = &bytes[..error.valid_up_to()];
        syntax_at(
            &String::from_utf8_lossy(valid),
            valid.len(),
            "is not UTF-8 text; save the file as UTF-8".into(),
        )
    })?;
    Ok(without_mark(text))
}

/// The text without the byte-order mark that some editors put first.
pub(super) fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// A syntax error at a byte offset.
pub(super) fn syntax_at(text: &str, offset: usize, message: String) -> FormatError {
    let before = &text.as_bytes()[..offset];
    let line_start = before
        .iter()
        .rposition(|&b| b == b'\n')
        .map_or(0, |i| i + 1);
    FormatError::Syntax {
        line: 1 + before.iter().filter(|&&b| b == b'\n').count(),
        column: 1 + offset - line_start,
        message,
    }
}

/// The finite number in one word of a text file. Any other word adds a violation that names the line.
pub(super) fn finite_number(
    word: &str,
    line: usize,
    what: &str,
    violations: &mut Violations,
) -> Option<f64> {
    let value = word.parse::<f64>().ok().filter(|value| value.is_finite());
    if value.is_none() {
        violations.push(
            format!("line {line}"),
            format!(
                "holds `{}` as {what}; give a finite number",
                shortened(word)
            ),
        );
    }
    value
}

/// A word, cut for an error message.
pub(super) fn shortened(word: &str) -> String {
    let escaped = word.escape_debug();
    if word.chars().count() <= 40 {
        escaped.collect()
    } else {
        escaped.take(40).chain("...".chars()).collect()
    }
}
