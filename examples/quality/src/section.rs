//! The marked sections of a Markdown file.

/// `text` with what stands between the marks of `name` replaced; `None` without such marks.
pub(crate) fn replaced(text: &str, name: &str, section: &str) -> Option<String> {
    let (begin, end) = (
        format!("<!-- {name}: begin -->\n"),
        format!("<!-- {name}: end -->"),
    );
    let (head, rest) = text.split_once(&begin)?;
    let (_, tail) = rest.split_once(&end)?;
    Some(format!("{head}{begin}{section}{end}{tail}"))
}
