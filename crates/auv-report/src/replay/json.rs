//! JSON texts for the page.

use std::fmt::Write;

/// A number with one decimal at most; a non-finite value is written as 1e9.
pub(super) fn number(value: f64) -> String {
    let value = if value.is_finite() {
        value.clamp(-1e9, 1e9)
    } else {
        1e9
    };
    let text = format!("{value:.1}");
    text.strip_suffix(".0").map_or(text.clone(), |whole| {
        if whole == "-0" {
            "0".into()
        } else {
            whole.into()
        }
    })
}

pub(super) fn array(values: &[f64]) -> String {
    let texts: Vec<String> = values.iter().map(|&v| number(v)).collect();
    format!("[{}]", texts.join(","))
}

/// A JSON string that cannot end the script element it stands in.
pub(super) fn text(value: &str) -> String {
    let mut out = String::from("\"");
    for c in value.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '<' | '>' | '&' | '\u{2028}' | '\u{2029}' => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c if c.is_control() => {
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

pub(super) fn list(items: impl IntoIterator<Item = String>) -> String {
    let items: Vec<String> = items.into_iter().collect();
    format!("[{}]", items.join(","))
}

pub(super) fn rows<const N: usize>(rows: &[[f64; N]]) -> String {
    list(rows.iter().map(|row| array(row)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_json_that_stays_in_its_element() {
        assert_eq!(text("a\"<\n"), "\"a\\\"\\u003c\\u000a\"");
        assert_eq!(
            [number(1.25), number(f64::NAN), number(-0.01)],
            ["1.2", "1000000000", "0"]
        );
    }
}
