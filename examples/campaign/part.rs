//! A part of a sharded campaign: its lines, and the seal that says what they are.

use crate::digest::Sha;
use crate::facts::Facts;
use crate::manifest::{MOST_BYTES, Manifest};
use crate::run_list::RunList;
use auv_examples::{Failure, read_file};
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// The most parts: their numbers have six digits.
pub(crate) const MOST_SHARDS: u64 = 1_000_000;
/// Most bytes of a line.
const MOST_LINE: u64 = 1 << 20;

/// The file of a part's lines.
pub(crate) fn part_file(folder: &Path, shard: u64) -> PathBuf {
    folder.join(format!("part-{shard:06}.jsonl"))
}

/// The file of a part's seal.
pub(crate) fn seal_file(folder: &Path, shard: u64) -> PathBuf {
    folder.join(format!("part-{shard:06}.seal.json"))
}

/// What a part is, written when it is complete and before it gets its name.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Seal {
    shard: u64,
    lines: u64,
    /// The hash of the part's file.
    sha256: String,
    manifest: Manifest,
}

impl Seal {
    pub(crate) const fn new(shard: u64, lines: u64, sha256: String, manifest: Manifest) -> Self {
        Self {
            shard,
            lines,
            sha256,
            manifest,
        }
    }

    /// Reads the seal of a part and compares it with the folder's manifest.
    fn read(folder: &Path, shard: u64, manifest: &Manifest) -> Result<Self, String> {
        let path = seal_file(folder, shard);
        let name = format!("its seal part-{shard:06}.seal.json");
        if !path.exists() {
            return Err(format!("{name} is missing"));
        }
        let bytes = read_file(&path.display().to_string(), MOST_BYTES);
        let bytes = bytes.map_err(|failure| failure.to_string())?;
        let seal: Self = serde_json::from_slice(&bytes)
            .map_err(|error| format!("{name} is not a seal ({error})"))?;
        if seal.shard != shard {
            return Err(format!("{name} is that of part {}", seal.shard));
        }
        let differences = seal.manifest.differences(manifest);
        if differences.is_empty() {
            return Ok(seal);
        }
        Err(format!(
            "is of another campaign than manifest.json says: {differences}"
        ))
    }
}

/// A line of a part: its run's index, its text with the end of line, and what it says.
pub(crate) type Line<'a> = (u64, &'a [u8], &'a Facts);

/// Reads a part line by line and checks it: seal, manifest, missions, number of lines, hash.
///
/// # Errors
/// `Ok(Err(why))` for a part that is not the one of the campaign; `Err` only from `sink`.
pub(crate) fn read_part(
    folder: &Path,
    shard: u64,
    (manifest, list): (&Manifest, &RunList),
    mut sink: impl FnMut(Line<'_>) -> Result<(), Failure>,
) -> Result<Result<(), String>, Failure> {
    let seal = match Seal::read(folder, shard, manifest) {
        Ok(seal) => seal,
        Err(why) => return Ok(Err(why)),
    };
    let file = match File::open(part_file(folder, shard)) {
        Ok(file) => file,
        Err(error) => return Ok(Err(format!("cannot be read ({error})"))),
    };
    let (mut reader, mut sha) = (BufReader::new(file), Sha::default());
    let (runs, origin) = (manifest.runs_of(shard), manifest.origin());
    let (mut line, mut lines) = (Vec::new(), 0);
    loop {
        line.clear();
        match (&mut reader).take(MOST_LINE).read_until(b'\n', &mut line) {
            Ok(0) => break,
            Ok(_) => {}
            Err(error) => return Ok(Err(format!("cannot be read ({error})"))),
        }
        lines += 1;
        let run = runs.start + lines - 1;
        if run >= runs.end {
            let should = runs.end - runs.start;
            return Ok(Err(format!(
                "has more lines than the {should} it should have"
            )));
        }
        let checked = check_line(&line).and_then(|facts| {
            facts.check(list.run(run), &origin)?;
            Ok(facts)
        });
        match checked {
            Ok(facts) => sink((run, &line, &facts))?,
            Err(why) => return Ok(Err(format!("line {lines} {why}"))),
        }
        sha.update(&line);
    }
    let should = runs.end - runs.start;
    if lines != should || seal.lines != should {
        return Ok(Err(format!("has {lines} lines and should have {should}")));
    }
    if sha.hex() != seal.sha256 {
        return Ok(Err(
            "was changed after it was flown: its sha256 is not its seal's".into(),
        ));
    }
    Ok(Ok(()))
}

fn check_line(line: &[u8]) -> Result<Facts, String> {
    let Some(text) = line.strip_suffix(b"\n") else {
        return Err("is cut short".into());
    };
    let text = std::str::from_utf8(text).map_err(|_| "is not UTF-8".to_owned())?;
    Facts::read(text)
}
