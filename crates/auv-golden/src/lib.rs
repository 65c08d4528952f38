//! Golden tests: a fixed-seed result is compared with the JSON file committed for it.
//!
//! A golden says what the code answered when the file was written, not what is right. Equal goldens
//! prove that a change is pure. A commit that changes a golden says so and brings the benchmark table
//! (`docs/CONTRIBUTING.md`).
//!
//! The file is `tests/golden/NAME.json` of the crate under test. `UPDATE_GOLDEN=1 cargo test` writes
//! the files; without that variable a difference or a missing file fails the test.
//!
//! ```no_run
//! let answer = serde_json::json!({ "cost": 719.5, "evaluations": 1000 });
//! auv_golden::check(env!("CARGO_MANIFEST_DIR"), "static_6", &answer)?;
//! # Ok::<(), String>(())
//! ```

use serde_json::Value;
use std::path::Path;
use std::{env, fs};

/// Compares a result with `tests/golden/NAME.json` below a crate's folder, or writes that file when
/// `UPDATE_GOLDEN` is `1`. Floats are compared to the last bit.
///
/// # Errors
/// The first difference, with its place in the JSON, or why the file cannot be read or written.
pub fn check(crate_dir: &str, name: &str, found: &Value) -> Result<(), String> {
    let file = Path::new(crate_dir)
        .join("tests/golden")
        .join(format!("{name}.json"));
    let shown = file.display();
    if env::var("UPDATE_GOLDEN").is_ok_and(|value| value == "1") {
        let text = serde_json::to_string_pretty(found).map_err(|e| e.to_string())?;
        let folder = file.parent().unwrap_or(&file);
        fs::create_dir_all(folder).map_err(|e| format!("{shown}: {e}"))?;
        return fs::write(&file, text + "\n").map_err(|e| format!("{shown}: {e}"));
    }
    let text = fs::read_to_string(&file)
        .map_err(|e| format!("{shown}: {e}; write it with UPDATE_GOLDEN=1"))?;
    let golden: Value = serde_json::from_str(&text).map_err(|e| format!("{shown}: {e}"))?;
    difference("", &golden, found).map_or(Ok(()), |difference| {
        Err(format!(
            "{shown}: {difference}\na pure change leaves goldens as they are; for another one set UPDATE_GOLDEN=1 and bring its benchmark table"
        ))
    })
}

/// The first place where two values differ, with both of them.
fn difference(place: &str, golden: &Value, found: &Value) -> Option<String> {
    let differ = || Some(format!("{place}: was {golden}, is {found}"));
    match (golden, found) {
        (Value::Array(a), Value::Array(b)) => {
            if a.len() != b.len() {
                return Some(format!("{place}: had {} items, has {}", a.len(), b.len()));
            }
            let pairs = a.iter().zip(b).enumerate();
            pairs
                .into_iter()
                .find_map(|(i, (a, b))| difference(&format!("{place}[{i}]"), a, b))
        }
        (Value::Object(a), Value::Object(b)) => {
            let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
            keys.into_iter().find_map(|key| {
                let [a, b] = [a, b].map(|object| object.get(key).unwrap_or(&Value::Null));
                difference(&format!("{place}.{key}"), a, b)
            })
        }
        (Value::Number(a), Value::Number(b)) => {
            let bits = |n: &serde_json::Number| n.as_f64().map(f64::to_bits);
            (bits(a) != bits(b)).then(differ).flatten()
        }
        _ => (golden != found).then(differ).flatten(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn the_first_difference_is_named_with_its_place() {
        let golden = json!({ "legs": [{ "cost": 1.0 }, { "cost": 2.0 }], "stop": "Cap" });
        assert_eq!(difference("", &golden, &golden.clone()), None);
        let mut found = golden.clone();
        found["legs"][1]["cost"] = json!(2.0 + f64::EPSILON * 2.0);
        let told = difference("", &golden, &found).unwrap();
        assert!(told.starts_with(".legs[1].cost: was 2.0, is 2.0000000000000004"));
        let more = json!({ "legs": golden["legs"], "stop": "Cap", "seed": 1 });
        assert_eq!(
            difference("", &golden, &more).unwrap(),
            ".seed: was null, is 1"
        );
        let short = json!({ "legs": [], "stop": "Cap" });
        assert_eq!(
            difference("", &golden, &short).unwrap(),
            ".legs: had 2 items, has 0"
        );
    }

    #[test]
    fn a_missing_file_tells_how_it_is_written() {
        let told = check(env!("CARGO_MANIFEST_DIR"), "no_such_golden", &json!(1));
        assert!(told.unwrap_err().contains("UPDATE_GOLDEN=1"));
    }
}
