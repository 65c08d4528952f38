//! The command line, input and output that the examples share.
//!
//! An example declares its [`CommandLine`] as data, from which both `--help` and parsing follow, and
//! gives [`CommandLine::run`] what it does:
//!
//! ```no_run
//! use auv_examples::{CommandLine, Failure, Operand, Opt, print};
//!
//! const COMMAND: CommandLine = CommandLine {
//!     name: "depth",
//!     about: "Prints the depth of a file of soundings.",
//!     operands: &[Operand::required("FILE", "soundings in metres, one a line")],
//!     options: &[
//!         Opt::value("limit-m", "METRES", "350", "deepest sounding believed, m"),
//!         Opt::value("average", "N", "", "soundings averaged (default: all)"),
//!         Opt::choice("datum", &["chart", "mean"], "chart", "what depths are measured from"),
//!         Opt::flag("shallowest", "print the least depth instead"),
//!     ],
//!     notes: "Example: depth strait.txt --datum mean --json",
//! };
//!
//! fn main() -> std::process::ExitCode {
//!     COMMAND.run(|arguments| {
//!         let path = arguments.operand("FILE").unwrap_or_default();
//!         let bytes = auv_examples::read_file(path, 1 << 20)?;
//!         let limit_m: f64 = arguments.number("limit-m")?.unwrap_or(f64::INFINITY);
//!         if !(limit_m > 0.0) {
//!             return Err(Failure::option("limit-m", "give a depth above 0"));
//!         }
//!         let average: Option<usize> = arguments.number("average")?;
//!         print(&format!("{} bytes, {average:?}, seed {}\n", bytes.len(), arguments.seed()?.0))
//!     })
//! }
//! ```
//!
//! Every command has `--seed`, `--threads`, `--json` and `--help` besides its own options. Exit codes:
//! 0 for an answer, 2 for bad input with one message on stderr, 1 for an internal error. Nothing
//! panics visibly: [`CommandLine::run`] turns a panic into one line and exit code 1.

/// The programs of the pages in `docs`, compiled and run.
#[cfg(doctest)]
mod pages {
    #[doc = include_str!("../../docs/first-mission.md")]
    mod first_mission {}
    #[doc = include_str!("../../docs/new-planner.md")]
    mod new_planner {}
    #[doc = include_str!("../../docs/vehicle.md")]
    mod vehicle {}
}

mod arguments;
mod bounded;
mod clock;
mod command_line;
mod failure;
mod files;
mod mission_input;
mod pictures;
mod run;

pub use arguments::Arguments;
pub use bounded::{Bounded, gap_percent, proven_bound};
pub use clock::Clock;
pub use command_line::{CommandLine, Operand, Opt};
pub use failure::Failure;
pub use files::{note, print, print_json, read_file, write_file};
pub use mission_input::MissionInput;
pub use pictures::Pictures;
