//! The JSON schema of mission files for editors, made from what the parser answers to wrong values.
//!
//! `UPDATE_GOLDEN=1 cargo test -p auv-sim --all-features --test mission_file schema` writes it again.

use super::scenario;
use auv_sim::Body;
use serde_json::{Map, Value, json};

const COMMITTED: &str = include_str!("../mission-file.schema.json");
const FILE: &str = concat!(
    env!("CARGO_MANIFEST_DIR"),
    "/../../docs/mission-file.schema.json"
);
/// The required keys with values.
const REQUIRED: [(&str, &str); 6] = [
    ("version", "2"),
    ("name", "\"x\""),
    ("preset", "\"default\""),
    ("start", "\"a\""),
    ("destination", "\"b\""),
    (
        "waypoints",
        "[{ name = \"a\", at = [0, 0, 9] }, { name = \"b\", at = [9, 0, 9] }]",
    ),
];
/// A list, in a path of keys.
const LIST: &str = "[]";
/// Any name, in a path of keys.
const ANY: &str = "*";

/// What is said of a value at a path of keys; empty where nothing is.
fn answer(path: &[String], value: &str) -> String {
    let wrap = |inner: String, key: &String| match key.as_str() {
        LIST => format!("[{inner}]"),
        ANY => format!("{{ any = {inner} }}"),
        key => format!("{{ {key} = {inner} }}"),
    };
    let Some((top, rest)) = path.split_first() else {
        return told("zzz = 0", "");
    };
    let inner = rest.iter().rev().fold(value.to_owned(), wrap);
    told(&format!("{top} = {inner}"), top)
}

fn told(line: &str, key: &str) -> String {
    let others = REQUIRED.iter().filter(|(name, _)| *name != key);
    let others: String = others
        .map(|(name, value)| format!("{name} = {value}\n"))
        .collect();
    scenario(&format!("{others}{line}\n")).map_or_else(|error| error.to_string(), |_| String::new())
}

/// The words that a message about an unknown key, or an unknown word, lists.
fn listed(message: &str, unknown: Unknown) -> Option<Vec<String>> {
    let (_, list) = match unknown {
        Unknown::Key => message
            .split_once("available keys: ")
            .or_else(|| message.split_once("unknown key `zzz`, expected "))?,
        Unknown::Word => message.split_once("unknown word `zzz`, expected ")?,
    };
    let list = list.split(';').next()?.trim_start_matches("one of ");
    let words = list.split([',', ' ', '`']).map(str::trim);
    let words = words.filter(|word| !word.is_empty() && !["or", "and"].contains(word));
    Some(words.map(str::to_owned).collect())
}

#[derive(Clone, Copy)]
enum Unknown {
    Key,
    Word,
}

fn with(path: &[String], key: &str) -> Vec<String> {
    [path, &[key.to_owned()]].concat()
}

/// The schema of a table with these keys.
fn table(path: &[String], keys: &[String]) -> Value {
    let known = keys
        .iter()
        .map(|key| (key.clone(), schema(&with(path, key))));
    json!({
        "type": "object",
        "properties": known.collect::<Map<String, Value>>(),
        "additionalProperties": false,
    })
}

/// The schema of one of these words: alone, or the key of a table with more.
fn one_of(path: &[String], words: &[String]) -> Value {
    let alone = |word: &&String| !answer(path, &format!("\"{word}\"")).contains("a name alone");
    let (alone, with_more): (Vec<&String>, Vec<&String>) = words.iter().partition(alone);
    if with_more.is_empty() {
        return json!({ "enum": words });
    }
    let with_more: Vec<String> = with_more.into_iter().cloned().collect();
    json!({ "anyOf": [{ "enum": alone }, table(path, &with_more)] })
}

/// The schema of the value at a path of keys.
fn schema(path: &[String]) -> Value {
    let (any, list) = (with(path, ANY), with(path, LIST));
    if let Some(keys) = listed(&answer(path, "{ zzz = 0 }"), Unknown::Key) {
        return table(path, &keys);
    }
    if let Some(kinds) = listed(&answer(path, "{ kind = \"zzz\" }"), Unknown::Word) {
        return of_kinds(path, &kinds);
    }
    if let Some(words) = listed(&answer(path, "\"zzz\""), Unknown::Word) {
        return one_of(path, &words);
    }
    if answer(path, "{ any = 0 }").contains("give a table") {
        return json!({ "type": "object", "additionalProperties": schema(&any) });
    }
    let item = |(item, unknown)| listed(&answer(&list, item), unknown).is_some();
    if [("{ zzz = 0 }", Unknown::Key), ("\"zzz\"", Unknown::Word)]
        .into_iter()
        .any(item)
    {
        return json!({ "type": "array", "items": schema(&list) });
    }
    scalar(path)
}

/// A table whose other keys depend on its kind.
fn of_kinds(path: &[String], kinds: &[String]) -> Value {
    let mut all = Map::new();
    for kind in kinds {
        let told = answer(path, &format!("{{ kind = \"{kind}\", zzz = 0 }}"));
        let keys = listed(&told, Unknown::Key);
        for key in keys.unwrap_or_default() {
            all.insert(key, json!({ "type": "number" }));
        }
    }
    all.insert("kind".into(), json!({ "enum": kinds }));
    json!({ "type": "object", "properties": all, "required": ["kind"], "additionalProperties": false })
}

/// The schema of a value that is no table, by what is expected instead of a wrong one. What takes more than one kind
/// of value may be anything.
fn scalar(path: &[String]) -> Value {
    if answer(path, "\"zzz\"").contains("is not a time in UTC") {
        return json!({ "type": ["number", "string"] });
    }
    let messages = ["true", "\"zzz\""].map(|wrong| answer(path, wrong));
    let expected = messages.iter().find_map(|message| {
        let (_, what) = message.split_once(" is ")?;
        what.split_once("; give ")?.1.split(';').next()
    });
    match expected.unwrap_or_default() {
        "text in quotes" => json!({ "type": "string" }),
        "true or false" => json!({ "type": "boolean" }),
        "a number" => json!({ "type": "number" }),
        what if what.starts_with("a whole number") => json!({ "type": "integer" }),
        "a list: [ , ]" => json!({ "type": "array" }),
        what if what.starts_with("a list of") => json!({ "type": "array" }),
        _ => json!({}),
    }
}

#[test]
fn the_schema_is_what_the_parser_accepts() {
    let keys = listed(&answer(&[], ""), Unknown::Key).unwrap();
    let mut made = table(&[], &keys);
    // Keys that are taken out before the others are read.
    let vehicle = &mut made["properties"]["vehicle"]["properties"];
    vehicle["body"] = json!({ "enum": Body::ALL.map(Body::as_str) });
    vehicle["turn_margin"] = json!({ "type": "number" });
    made["$schema"] = "https://json-schema.org/draft/2020-12/schema".into();
    made["title"] = "Mission file, version 2".into();
    made["properties"]["version"] = json!({ "enum": [1, 2] });
    let text = serde_json::to_string_pretty(&made).unwrap() + "\n";
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(FILE, &text).unwrap();
        return;
    }
    assert!(
        text == COMMITTED,
        "docs/mission-file.schema.json is out of date: UPDATE_GOLDEN=1 writes it again"
    );
}

/// Whether a value fits the part of JSON Schema that is used here; where not, the key that does not.
fn misfit(value: &Value, schema: &Value) -> Option<String> {
    if let Some(words) = schema["enum"].as_array() {
        return (!words.contains(value)).then(|| value.to_string());
    }
    if let Some(either) = schema["anyOf"].as_array() {
        let fits = either.iter().any(|schema| misfit(value, schema).is_none());
        return (!fits).then(|| value.to_string());
    }
    let is_wrong = match schema["type"].as_str() {
        Some("object") => !value.is_object(),
        Some("array") => !value.is_array(),
        Some("string") => !value.is_string(),
        Some("boolean") => !value.is_boolean(),
        Some("number" | "integer") => !value.is_number(),
        _ => false,
    };
    if is_wrong {
        return Some(value.to_string());
    }
    if let Some(list) = value.as_array() {
        let items = &schema["items"];
        return list.iter().find_map(|item| misfit(item, items));
    }
    let table = value.as_object()?;
    let known = schema["properties"].as_object();
    table.iter().find_map(
        |(key, value)| match known.and_then(|known| known.get(key)) {
            Some(schema) => misfit(value, schema),
            None if schema["additionalProperties"].is_object() => {
                misfit(value, &schema["additionalProperties"])
            }
            None => (schema["additionalProperties"] == false).then(|| key.clone()),
        },
    )
}

/// The mission files of the examples; none outside the repository.
fn shipped() -> Vec<String> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../examples/missions");
    let Ok(files) = std::fs::read_dir(folder) else {
        println!("skipped: {folder} is not there");
        return Vec::new();
    };
    let text = |file: std::io::Result<std::fs::DirEntry>| {
        std::fs::read_to_string(file.unwrap().path()).unwrap()
    };
    files.map(text).collect()
}

#[test]
fn shipped_missions_fit_the_schema_and_wrong_ones_do_not() {
    let schema: Value = serde_json::from_str(COMMITTED).unwrap();
    let read = |text: &str| -> Value {
        let table: toml::Table = text.parse().unwrap();
        serde_json::to_value(table).unwrap()
    };
    let shipped = shipped();
    let shipped = shipped.iter().map(String::as_str);
    for text in super::documented().into_iter().chain(shipped) {
        assert_eq!(misfit(&read(text), &schema), None, "{text}");
    }
    for (line, wrong) in [
        ("tasks.x.tim_s = 5", "tim_s"),
        ("surveys = [{ spacing = 5 }]", "spacing"),
        ("docking.trys = 2", "trys"),
        ("emergency = [{ when = \"leaks\" }]", "\"leaks\""),
        ("contingencies = [\"swim\"]", "\"swim\""),
        ("tasks.x.mandatory = \"yes\"", "\"yes\""),
        ("vehicle.body = \"remus600\"", "\"remus600\""),
    ] {
        assert_eq!(misfit(&read(line), &schema).as_deref(), Some(wrong));
    }
}
