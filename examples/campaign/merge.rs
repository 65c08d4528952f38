//! `--merge DIR`: the parts of a campaign joined into one file.

use crate::manifest::Manifest;
use crate::part::{part_file, read_part};
use crate::tally::Tally;
use crate::temporary::{TemporaryFile, is_temporary};
use auv_examples::{Arguments, Failure, Opt, note};
use std::fs;
use std::path::{Path, PathBuf};

/// The most parts named that are missing or wrong.
const NAMED: usize = 20;
/// The options that go with `--merge`; the manifest says the others.
const WITH_MERGE: [&str; 4] = ["json", "merge", "table", "threads"];

/// Checks every part, joins them in order into `DIR/campaign.jsonl`, and prints the summary.
pub(crate) fn run(arguments: &Arguments, options: &[Opt]) -> Result<(), Failure> {
    let folder = Path::new(arguments.text("merge").unwrap_or_default());
    let names = options.iter().map(|option| option.name).chain(["seed"]);
    for name in names {
        if arguments.flag(name) && !WITH_MERGE.contains(&name) {
            let text = "is in the manifest of the parts: leave it out with --merge";
            return Err(Failure::option(name, text));
        }
    }
    let (manifest, list) = Manifest::read(&folder.join("manifest.json"))?;
    let mut tally = Tally::new(&list, manifest.origin(), manifest.sea());
    let mut joined = TemporaryFile::new(folder.join("campaign.jsonl"))?;
    let mut problems = Problems::default();
    for name in strangers(folder, manifest.shards)? {
        let text = format!("there are parts 0 to {}: move it away", manifest.shards - 1);
        problems.add(format!("{name} is no part of this campaign; {text}"));
    }
    for shard in 0..manifest.shards {
        let why = if part_file(folder, shard).exists() {
            let read = read_part(folder, shard, (&manifest, &list), |(i, line, facts)| {
                tally.count(list.run(i), facts);
                joined.write(line)
            })?;
            let Err(why) = read else { continue };
            why
        } else {
            "is missing".into()
        };
        let command = manifest.command(shard, folder, options);
        problems.add(format!(
            "part-{shard:06}.jsonl {why}; fly it with: {command}"
        ));
    }
    problems.refuse(folder)?;
    joined.publish()?;
    for leftover in leftovers(folder)? {
        let _ = fs::remove_file(leftover);
    }
    let path = folder.join("campaign.jsonl");
    note(&format!(
        "{}: {} parts joined",
        path.display(),
        manifest.shards
    ));
    tally.report(arguments)
}

/// What prevents joining.
#[derive(Default)]
struct Problems {
    named: Vec<String>,
    more: u64,
}

impl Problems {
    fn add(&mut self, problem: String) {
        if self.named.len() < NAMED {
            self.named.push(problem);
        } else {
            self.more += 1;
        }
    }

    fn refuse(self, folder: &Path) -> Result<(), Failure> {
        if self.named.is_empty() {
            return Ok(());
        }
        let mut text = format!("cannot be joined:\n  {}", self.named.join("\n  "));
        if self.more > 0 {
            text.push_str(&format!("\n  and {} more", self.more));
        }
        Err(Failure::file(&folder.display().to_string(), text))
    }
}

/// The entries of a folder, in order of their names.
fn entries(folder: &Path) -> Result<Vec<(String, PathBuf)>, Failure> {
    let unreadable = |error: std::io::Error| {
        let text = format!("cannot be read ({error}): give the folder of --shards-dir");
        Failure::file(&folder.display().to_string(), text)
    };
    let mut entries = Vec::new();
    for entry in fs::read_dir(folder).map_err(unreadable)? {
        let entry = entry.map_err(unreadable)?;
        let name = entry.file_name().to_string_lossy().into_owned();
        entries.push((name, entry.path()));
    }
    entries.sort();
    Ok(entries)
}

/// Files that look like parts and are none of 0 to `shards - 1`.
fn strangers(folder: &Path, shards: u64) -> Result<Vec<String>, Failure> {
    let is_stranger = |name: &String| {
        let part = name
            .strip_suffix(".jsonl")
            .filter(|name| name.starts_with("part-"));
        let Some(part) = part else { return false };
        let number = part
            .strip_prefix("part-")
            .and_then(|n| n.parse::<u64>().ok());
        !number.is_some_and(|shard| shard < shards && part == format!("part-{shard:06}"))
    };
    let names = entries(folder)?.into_iter().map(|(name, _)| name);
    Ok(names.filter(is_stranger).collect())
}

/// Temporary files that killed processes left.
fn leftovers(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries = entries(folder)?.into_iter();
    let left = entries.filter(|(name, _)| is_temporary(name));
    Ok(left.map(|(_, path)| path).collect())
}
