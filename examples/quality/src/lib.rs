//! Measures how good the planners' answers are, against the best known:
//! `cargo run --release --example quality -- paths` (or `sea`, `routes`, `threads`, `ticks`, `waypoints`).

mod machine;
mod paths;
mod routes;
mod section;
mod threads;
mod ticks;
mod waypoints;

use auv_examples::{CommandLine, Failure, Operand, Opt, print, read_file, write_file};
use std::path::{Path, PathBuf};

const COMMAND: CommandLine = CommandLine {
    name: "quality",
    about: "Measures the planners on the scenes or instances below AUV_DATA_DIR and writes a section of the benchmarks.",
    operands: &[Operand::required(
        "WHAT",
        "paths, sea, routes, threads, ticks or waypoints",
    )],
    options: &[
        Opt::value(
            "seeds",
            "N",
            "10",
            "seeds of every scene or instance, from --seed on",
        ),
        Opt::value(
            "machine",
            "TEXT",
            "",
            "what it was measured on, for the section's head (default: number of threads)",
        ),
        Opt::value(
            "file",
            "FILE",
            "",
            "Markdown file whose marked section is replaced (default: print only)",
        ),
    ],
    notes: "Example: quality paths --machine \"2 cores, shared\" --file docs/benchmarks.md",
};

/// Runs the command line of the process.
pub fn main() -> std::process::ExitCode {
    COMMAND.run(|arguments| {
        let what = arguments.operand("WHAT").unwrap_or_default();
        let text = match what {
            "paths" => paths::measure(arguments, &data()?, paths::STILL)?,
            "sea" => paths::measure(arguments, &data()?, paths::SEA)?,
            "routes" => routes::measure(arguments, &data()?)?,
            "threads" => threads::measure(arguments, &data()?)?,
            "ticks" => ticks::measure(arguments)?,
            "waypoints" => waypoints::measure(arguments)?,
            other => {
                return Err(Failure::BadInput(format!(
                    "{other}: give paths, sea, routes, threads, ticks or waypoints"
                )));
            }
        };
        if let Some(file) = arguments.text("file").filter(|file| !file.is_empty()) {
            let bytes = read_file(file, 1 << 20)?;
            let before = String::from_utf8_lossy(&bytes);
            let after = section::replaced(&before, what, &text).ok_or_else(|| {
                Failure::file(
                    file,
                    format!(
                        "has no section marked <!-- {what}: begin --> and <!-- {what}: end -->"
                    ),
                )
            })?;
            write_file(Path::new(file), after.as_bytes())?;
        }
        print(&text)
    })
}

/// The folder of instances, scenes and references.
fn data() -> Result<PathBuf, Failure> {
    std::env::var("AUV_DATA_DIR")
        .map(PathBuf::from)
        .map_err(|_| {
            Failure::BadInput(
                "set AUV_DATA_DIR to the folder that holds scenes, instances and references".into(),
            )
        })
}
