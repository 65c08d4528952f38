//! The page that replays the only run.

use auv_examples::{Arguments, Failure, note, write_file};
use auv_report::{MissionPicture, replay_html};
use std::path::Path;

/// Refuses `--replay` unless there is exactly one run.
pub(crate) fn only_one_to_replay(arguments: &Arguments, runs: u64) -> Result<(), Failure> {
    if runs == 1 || arguments.text("replay").is_none() {
        return Ok(());
    }
    Err(Failure::option(
        "replay",
        format!(
            "replays one run, not {runs}: give --missions 1, and at most one fault at one intensity"
        ),
    ))
}

/// With `--replay`, repeats the only run with a recorder and writes the page.
pub(crate) fn write_replay(
    arguments: &Arguments,
    fly: impl FnOnce(&mut MissionPicture) -> Result<(), String>,
) -> Result<(), Failure> {
    let Some(path) = arguments.text("replay") else {
        return Ok(());
    };
    let mut picture = MissionPicture::new();
    fly(&mut picture).map_err(Failure::BadInput)?;
    write_file(Path::new(path), replay_html(&picture).as_bytes())?;
    note(&format!("open {path}"));
    Ok(())
}
