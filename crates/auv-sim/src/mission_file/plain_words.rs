//! What the TOML reader says of a wrong value, in an operator's words.

/// A message of the reader without names of Rust's types, for a value that this key has; `None` where it says it as
/// it is.
pub(super) fn plain(message: &str, key: Option<&str>) -> Option<String> {
    let subject = key.map_or_else(|| "the value".into(), |key| format!("`{key}`"));
    if let Some(rest) = message.strip_prefix("invalid length ") {
        let (length, expected) = rest.split_once(", expected ")?;
        return Some(format!(
            "{subject} is a list of {length}; give {}",
            wanted(expected)
        ));
    }
    match message {
        "duplicate key" => return Some("a key is given twice; keep one of them".into()),
        "wanted string or table" => {
            return Some(format!("{subject} is not text; give text in quotes"));
        }
        deep if deep.starts_with("cannot recurse further") => {
            return Some("lists or tables lie too deep in one another; remove brackets".into());
        }
        _ => {}
    }
    if let Some(rest) = message.strip_prefix("missing field ") {
        return Some(format!("the key {rest} is missing"));
    }
    if let Some(rest) = message.strip_prefix("unknown field ") {
        return Some(format!("unknown key {rest}"));
    }
    if let Some(rest) = message.strip_prefix("unknown variant ") {
        return Some(format!("unknown word {rest}"));
    }
    let rest = message
        .strip_prefix("invalid type: ")
        .or_else(|| message.strip_prefix("invalid value: "))?;
    let (given, expected) = rest.rsplit_once(", expected ")?;
    let given = given_as(given);
    // Of the right type, and not negative: it is more than the type holds.
    let is_too_much = message.starts_with("invalid value: ")
        && !given.starts_with('-')
        && wanted(expected).starts_with("a whole number");
    let wanted = match is_too_much {
        true => "a smaller one".into(),
        false => wanted(expected),
    };
    Some(format!("{subject} is {given}; give {wanted}"))
}

/// What is said of a list with more entries than its key takes; `None` of another message.
pub(super) fn list_too_long(message: &str) -> Option<String> {
    let rest = message.strip_prefix("invalid length ")?;
    let (length, key) = rest.split_once(", expected fewer elements in array")?;
    let key = key.trim().trim_start_matches("in ");
    Some(format!(
        "{key} has a list of {length}, more than it takes; leave out the rest"
    ))
}

fn given_as(given: &str) -> String {
    let value = || given.split('`').nth(1).unwrap_or(given).to_owned();
    match given {
        "sequence" => "a list".into(),
        "map" => "a table or a date".into(),
        "unit variant" => "a name alone".into(),
        text if text.starts_with("string ") => format!("the text {}", &text["string ".len()..]),
        number if number.starts_with("integer ") || number.starts_with("floating point ") => {
            value()
        }
        answer if answer.starts_with("boolean ") => value(),
        other => other.into(),
    }
}

fn wanted(expected: &str) -> String {
    let is_table = ["struct", "a map", "internally tagged"];
    match expected {
        "f64" | "a float" => "a number".into(),
        "u8" | "u32" | "u64" | "usize" => "a whole number, 0 or more".into(),
        "i32" | "i64" => "a whole number".into(),
        "a boolean" => "true or false".into(),
        "a string" => "text in quotes".into(),
        "a sequence" => "a list: [ , ]".into(),
        table if is_table.iter().any(|kind| table.starts_with(kind)) => {
            "a table: { key = value, }".into()
        }
        list => list.strip_prefix("an array of length ").map_or_else(
            || list.to_owned(),
            |length| format!("a list of {length}: [ , ]"),
        ),
    }
}

/// The key that the value at a place of the text has, where it stands before it in its line.
pub(super) fn key_before(text: &str, at: usize) -> Option<&str> {
    let line = text.get(..at)?.rsplit('\n').next()?;
    let before = line.trim_end().strip_suffix('=')?.trim_end();
    let key = before.rsplit(['{', ',', ' ', '\t', '[']).next()?;
    (!key.is_empty()).then_some(key)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn wrong_values_are_told_without_names_of_types() {
        let cases = [
            (
                "invalid type: string \"x, expected y\", expected f64",
                "`a` is the text \"x, expected y\"; give a number",
            ),
            (
                "invalid value: integer `-1`, expected usize",
                "`a` is -1; give a whole number, 0 or more",
            ),
            (
                "invalid type: boolean `true`, expected a sequence",
                "`a` is true; give a list: [ , ]",
            ),
            (
                "invalid type: sequence, expected struct BoxEntry",
                "`a` is a list; give a table: { key = value, }",
            ),
            (
                "invalid length 1, expected an array of length 2",
                "`a` is a list of 1; give a list of 2: [ , ]",
            ),
            (
                "invalid value: integer `99999999999`, expected u32",
                "`a` is 99999999999; give a smaller one",
            ),
            ("missing field `at`", "the key `at` is missing"),
            (
                "wanted string or table",
                "`a` is not text; give text in quotes",
            ),
            ("duplicate key", "a key is given twice; keep one of them"),
            (
                "cannot recurse further; max recursion depth met",
                "lists or tables lie too deep in one another; remove brackets",
            ),
        ];
        for (message, told) in cases {
            assert_eq!(plain(message, Some("a")).as_deref(), Some(told));
        }
        assert_eq!(plain("key with no value", None), None);
    }

    #[test]
    fn a_list_that_is_too_long_is_named_by_its_key() {
        let told = "invalid length 3, expected fewer elements in array in `box.north_m`";
        assert_eq!(
            list_too_long(told).as_deref(),
            Some("`box.north_m` has a list of 3, more than it takes; leave out the rest")
        );
        assert_eq!(list_too_long("invalid length 1, expected 2"), None);
    }

    #[test]
    fn the_key_of_a_value_is_the_name_before_it() {
        let text = "a.b = 1\nc = { d = 2, e = [3] }";
        let key_at = |value: &str| key_before(text, text.find(value).unwrap());
        assert_eq!(key_at("1"), Some("a.b"));
        assert_eq!(key_at("2"), Some("d"));
        assert_eq!((key_at("[3"), key_at("3]")), (Some("e"), None));
        assert_eq!(key_before(text, 999), None);
    }
}
