//! `--shard I/N`: one part of a campaign.

use crate::digest::Sha;
use crate::facts::Facts;
use crate::flight::Flight;
use crate::manifest::Manifest;
use crate::part::{MOST_SHARDS, Seal, part_file, read_part, seal_file};
use crate::stream::stream;
use crate::tally::Tally;
use crate::temporary::TemporaryFile;
use auv_examples::{Arguments, Failure, Opt, note};
use std::fs;
use std::path::Path;

/// Flies part I of N into `--shards-dir`, unless it is there, and prints its summary.
pub(crate) fn run(arguments: &Arguments, options: &[Opt], flight: &Flight) -> Result<(), Failure> {
    let (shard, shards) = numbers(arguments.text("shard").unwrap_or_default())?;
    let Some(folder) = arguments.text("shards-dir").map(Path::new) else {
        return Err(Failure::option(
            "shard",
            "needs --shards-dir DIR, the folder of the parts",
        ));
    };
    for option in ["out", "replay", "table"] {
        if arguments.flag(option) {
            let text = "is of a whole campaign: leave it out with --shard";
            return Err(Failure::option(option, text));
        }
    }
    let manifest = Manifest::of(arguments, options, flight, shards)?;
    agree(folder, &manifest)?;
    if let Some(mut tally) = flown_before(folder, shard, flight, &manifest)? {
        note(&format!(
            "part {shard} of {shards} is there and in order: not flown again"
        ));
        return tally.report(arguments);
    }
    fly(arguments, flight, folder, (shard, manifest))?.report(arguments)
}

/// I and N of `I/N`.
fn numbers(text: &str) -> Result<(u64, u64), Failure> {
    let parsed = text.split_once('/').and_then(|(shard, shards)| {
        let shards = shards
            .parse()
            .ok()
            .filter(|n| (1..=MOST_SHARDS).contains(n))?;
        let shard = shard.parse().ok().filter(|&i| i < shards)?;
        Some((shard, shards))
    });
    parsed.ok_or_else(|| {
        let text =
            format!("is `{text}`; give I/N with I from 0 to N-1, and N from 1 to {MOST_SHARDS}");
        Failure::option("shard", text)
    })
}

/// Writes the manifest into an empty folder; refuses a folder of another campaign.
fn agree(folder: &Path, manifest: &Manifest) -> Result<(), Failure> {
    let path = folder.join("manifest.json");
    fs::create_dir_all(folder).map_err(|error| {
        let text = format!("cannot be made ({error}): give another place");
        Failure::file(&folder.display().to_string(), text)
    })?;
    if !path.exists() {
        let mut file = TemporaryFile::new(path.clone())?;
        file.write(manifest.to_text()?.as_bytes())?;
        if file.publish_first()? {
            return Ok(());
        }
    }
    let differences = manifest.differences(&Manifest::read(&path)?.0);
    if differences.is_empty() {
        return Ok(());
    }
    let text = format!(
        "is of another campaign: {differences}; give an empty folder with --shards-dir, or what the folder was \
         begun with"
    );
    Err(Failure::file(&path.display().to_string(), text))
}

fn tally(flight: &Flight, manifest: &Manifest) -> Tally {
    Tally::new(&flight.list, flight.fleet.origin(), manifest.sea())
}

/// The summary of a part that is there and in order.
fn flown_before(
    folder: &Path,
    shard: u64,
    flight: &Flight,
    manifest: &Manifest,
) -> Result<Option<Tally>, Failure> {
    let path = part_file(folder, shard);
    if !path.exists() {
        return Ok(None);
    }
    let mut tally = tally(flight, manifest);
    let list = &flight.list;
    let read = read_part(folder, shard, (manifest, list), |(i, _, facts)| {
        tally.count(list.run(i), facts);
        Ok(())
    })?;
    match read {
        Ok(()) => Ok(Some(tally)),
        Err(why) => {
            note(&format!("{}: {why}: it is flown again", path.display()));
            Ok(None)
        }
    }
}

/// Flies a part; its name appears when it is complete, after its seal's.
fn fly(
    arguments: &Arguments,
    flight: &Flight,
    folder: &Path,
    (shard, manifest): (u64, Manifest),
) -> Result<Tally, Failure> {
    let workers = arguments.workers()?;
    let mut tally = tally(flight, &manifest);
    let mut part = TemporaryFile::new(part_file(folder, shard))?;
    let (mut sha, mut lines) = (Sha::default(), 0);
    stream(flight, &workers, manifest.runs_of(shard), |i, line| {
        let facts = Facts::read(line).map_err(Failure::Internal)?;
        tally.count(flight.list.run(i), &facts);
        for bytes in [line.as_bytes(), b"\n"] {
            part.write(bytes)?;
            sha.update(bytes);
        }
        lines += 1;
        Ok(())
    })?;
    let seal = Seal::new(shard, lines, sha.hex(), manifest);
    let text = serde_json::to_string_pretty(&seal)
        .map_err(|error| Failure::Internal(format!("no JSON of the seal: {error}")))?;
    let mut file = TemporaryFile::new(seal_file(folder, shard))?;
    file.write(text.as_bytes())?;
    file.write(b"\n")?;
    file.publish()?;
    part.publish()?;
    Ok(tally)
}
