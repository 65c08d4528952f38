//! The shape of the code: how long functions are, and which files of a crate use each other in a circle.
//!
//! Code is read as text as `cargo fmt` leaves it. Code under `#[cfg(test)]` and in `tests` is left out.
#![allow(
    clippy::unwrap_used,
    reason = "a test that fails should say where it does"
)]

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};

/// No function has more lines, counted from `fn` to the closing brace.
const MOST_LINES: usize = 64;
/// At most `MOST_LONG` functions have more lines than this.
const LONG: usize = 60;
const MOST_LONG: usize = 6;

fn root() -> PathBuf {
    let examples = Path::new(env!("CARGO_MANIFEST_DIR"));
    examples.parent().unwrap().to_path_buf()
}

/// The Rust files below a folder, without tests and build output, in order.
fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    let mut entries: Vec<_> = fs::read_dir(folder).unwrap().flatten().collect();
    entries.sort_by_key(fs::DirEntry::path);
    for path in entries.iter().map(fs::DirEntry::path) {
        let name = path.file_stem().unwrap().to_string_lossy().into_owned();
        if path.is_dir() && name != "tests" && name != "target" {
            files.extend(rust_files(&path));
        } else if path.extension().is_some_and(|e| e == "rs") && name != "tests" {
            files.push(path);
        }
    }
    files
}

fn indent(line: &str) -> usize {
    line.len() - line.trim_start().len()
}

/// The index of the line that ends the item which starts at `from`: a `}` or `;` at its indent.
fn end_of_item(lines: &[&str], from: usize) -> usize {
    let depth = indent(lines[from]);
    let first = lines[from].trim_end();
    if first.ends_with(';') || first.ends_with('}') {
        return from;
    }
    let ends = |line: &&str| {
        let text = line.trim();
        indent(line) == depth && (text == "}" || text.ends_with(';'))
    };
    let rest = lines[from + 1..].iter().position(ends);
    rest.map_or(lines.len() - 1, |rest| from + 1 + rest)
}

/// The lines of a file with tests and whole-line comments blanked.
fn code(path: &Path) -> Vec<String> {
    let text = fs::read_to_string(path).unwrap();
    let lines: Vec<&str> = text.lines().collect();
    let mut kept: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
    for (i, line) in lines.iter().enumerate() {
        let is_test =
            line.trim().starts_with("#[cfg(test)]") || line.trim().starts_with("#[cfg(all(test");
        if is_test {
            let item = (i + 1..lines.len()).find(|&k| !lines[k].trim().starts_with("#["));
            let Some(item) = item else { continue };
            for blank in &mut kept[i..=end_of_item(&lines, item)] {
                blank.clear();
            }
        } else if line.trim().starts_with("//") {
            kept[i].clear();
        }
    }
    kept
}

#[test]
fn functions_are_short() {
    let mut long = Vec::new();
    for folder in ["crates", "examples", "benches"] {
        for path in rust_files(&root().join(folder)) {
            let kept = code(&path);
            let lines: Vec<&str> = kept.iter().map(String::as_str).collect();
            for (i, line) in lines.iter().enumerate() {
                let words: Vec<&str> = line.split_whitespace().collect();
                let is_head = |word: &&str| {
                    ["pub", "const", "async"].contains(word) || word.starts_with("pub(")
                };
                if words.iter().find(|word| !is_head(word)) != Some(&"fn") {
                    continue;
                }
                let count = end_of_item(&lines, i) + 1 - i;
                if count > LONG {
                    let name = path.strip_prefix(root()).unwrap().display().to_string();
                    long.push(format!("{count} lines: {name}:{}: {}", i + 1, line.trim()));
                }
            }
        }
    }
    let over = |most: usize| {
        let lines = |text: &str| text.split(' ').next().unwrap().parse::<usize>().unwrap();
        long.iter().filter(move |text| lines(text) > most).count()
    };
    assert!(
        over(MOST_LINES) == 0 && long.len() <= MOST_LONG,
        "{} functions over {MOST_LINES} lines, {} over {LONG} (at most {MOST_LONG}):\n{}",
        over(MOST_LINES),
        long.len(),
        long.join("\n")
    );
}

/// The modules of a crate: their paths from the root, with the text of their files.
type Modules = BTreeMap<Vec<String>, String>;

fn modules(folder: &Path) -> Modules {
    let module = |path: PathBuf| {
        let inside = path.strip_prefix(folder).unwrap().with_extension("");
        let mut names: Vec<String> = inside
            .iter()
            .map(|name| name.to_string_lossy().into_owned())
            .collect();
        if ["lib", "main", "mod"].contains(&names.last().unwrap().as_str()) {
            names.pop();
        }
        (names, code(&path).join("\n"))
    };
    rust_files(folder).into_iter().map(module).collect()
}

/// The paths that a text starts with, as `a::b::{c, d::e}` gives `a::b::c` and `a::b::d::e`.
fn paths(text: &str) -> Vec<Vec<String>> {
    let text = text.trim_start();
    let stop = |c: char| !(c.is_alphanumeric() || c == '_' || c == '*');
    let name = &text[..text.find(stop).unwrap_or(text.len())];
    if let Some(group) = text.strip_prefix('{') {
        let (mut depth, mut start, mut found) = (0, 0, Vec::new());
        for (i, c) in group.char_indices() {
            match c {
                '{' => depth += 1,
                '}' if depth > 0 => depth -= 1,
                ',' | '}' if depth == 0 => {
                    found.extend(paths(&group[start..i]));
                    start = i + 1;
                }
                _ => {}
            }
            if depth == 0 && c == '}' && start == i + 1 {
                break;
            }
        }
        return found;
    }
    if name.is_empty() {
        return Vec::new();
    }
    let Some(rest) = text[name.len()..].strip_prefix("::") else {
        return vec![vec![name.to_owned()]];
    };
    let tails = paths(rest);
    let with_name = |tail: Vec<String>| [vec![name.to_owned()], tail].concat();
    tails.into_iter().map(with_name).collect()
}

/// What a module imports: the last name of every path of its `use` declarations.
fn imports(text: &str) -> Vec<Vec<String>> {
    let starts = text.match_indices("use ").filter(|(at, _)| {
        let line = text[..*at].rsplit('\n').next().unwrap_or("");
        line.trim().is_empty() || line.trim().starts_with("pub")
    });
    starts.flat_map(|(at, _)| paths(&text[at + 4..])).collect()
}

/// The module in which the item of a path stands, seen from a module; re-exports are followed.
fn resolve(all: &Modules, from: &[String], path: &[String], depth: usize) -> Option<Vec<String>> {
    let mut at = from.to_vec();
    for (i, name) in path.iter().enumerate() {
        let child = [at.clone(), vec![name.clone()]].concat();
        match name.as_str() {
            "crate" => at.clear(),
            "super" => {
                at.pop()?;
            }
            "self" => {}
            _ if all.contains_key(&child) => at = child,
            _ if i == 0 => return None,
            _ => {
                let imported = imports(&all[&at]);
                let import = imported.iter().find(|import| import.last() == Some(name));
                let followed = import.filter(|_| depth < 8);
                return followed
                    .and_then(|import| resolve(all, &at, import, depth + 1))
                    .or(Some(at));
            }
        }
    }
    Some(at)
}

/// The modules that a module uses, by its `use` declarations and by paths that start with `super::`.
/// A child that is only re-exported is not used.
fn uses(all: &Modules, module: &[String]) -> BTreeSet<Vec<String>> {
    let text = &all[module];
    let declared = text.match_indices("use ").filter_map(|(at, _)| {
        let line = text[..at].rsplit('\n').next().unwrap_or("");
        line.trim().is_empty().then(|| paths(&text[at + 4..]))
    });
    let relative = text.match_indices("super::").filter_map(|(at, _)| {
        let inside = text[..at].ends_with(|c: char| c.is_alphanumeric() || "_:".contains(c));
        let reexported = text[..at].ends_with("use ");
        (!inside && !reexported).then(|| paths(&text[at..]))
    });
    let mut found: BTreeSet<Vec<String>> = declared
        .chain(relative)
        .flatten()
        .filter_map(|path| resolve(all, module, &path, 0))
        .collect();
    found.remove(module);
    found
}

#[test]
fn no_files_of_a_crate_use_each_other_in_a_circle() {
    let mut folders: Vec<PathBuf> = fs::read_dir(root().join("crates"))
        .unwrap()
        .map(|entry| entry.unwrap().path().join("src"))
        .collect();
    folders.sort();
    let examples = ["src", "campaign", "paper/src", "quality/src", "coast/src"];
    folders.extend(examples.map(|folder| root().join("examples").join(folder)));
    let mut circles = Vec::new();
    for folder in folders {
        let shown = folder.strip_prefix(root()).unwrap().display().to_string();
        let all = modules(&folder);
        let direct: BTreeMap<_, _> = all.keys().map(|m| (m.clone(), uses(&all, m))).collect();
        let reached = |from: &Vec<String>| {
            let mut seen = BTreeSet::new();
            let mut open: Vec<_> = direct[from].iter().cloned().collect();
            while let Some(next) = open.pop() {
                if seen.insert(next.clone()) {
                    open.extend(direct[&next].iter().cloned());
                }
            }
            seen
        };
        let name = |module: &Vec<String>| format!("crate::{}", module.join("::"));
        for module in all
            .keys()
            .filter(|module| reached(module).contains(*module))
        {
            let back = direct[module]
                .iter()
                .filter(|next| reached(next).contains(module));
            let back: Vec<String> = back.map(name).collect();
            circles.push(format!(
                "{shown}: {} uses {}",
                name(module),
                back.join(", ")
            ));
        }
    }
    assert!(
        circles.is_empty(),
        "circles of imports:\n{}",
        circles.join("\n")
    );
}

#[test]
fn paths_are_read_with_their_groups() {
    let found = paths("crate::a::{B, c::{D, E}, f};");
    let joined: Vec<String> = found.iter().map(|path| path.join("::")).collect();
    assert_eq!(
        joined,
        [
            "crate::a::B",
            "crate::a::c::D",
            "crate::a::c::E",
            "crate::a::f"
        ]
    );
}
