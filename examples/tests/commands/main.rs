//! The answers of the examples on their command lines.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a test that fails should say where, a skipped one that it is"
)]

mod campaign;
mod mission;
mod path;
mod route;
mod shards;
mod vehicle_stdio;

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

/// The built example beside this test; `None` where only the test was built.
fn program(name: &str) -> Option<PathBuf> {
    let test = std::env::current_exe().unwrap();
    let folder = test.parent()?.parent()?.join("examples");
    let program = folder.join(format!("{name}{}", std::env::consts::EXE_SUFFIX));
    if !program.exists() {
        println!("skipped: build the examples");
        return None;
    }
    Some(program)
}

/// What an example answers to a file of this text.
fn answer_to(program: &Path, name: &str, text: &str, options: &[&str]) -> Output {
    let file = std::env::temp_dir().join(format!("auv-{}-{name}", std::process::id()));
    std::fs::write(&file, text).unwrap();
    let output = Command::new(program).arg(&file).args(options).output();
    std::fs::remove_file(file).unwrap();
    output.unwrap()
}
