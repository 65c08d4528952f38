//! What a command does with the process: parse, work, exit code.

use crate::{Arguments, CommandLine, Failure};
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::process::ExitCode;
use std::sync::{Mutex, PoisonError};

/// What the last panic said, for the one line printed of it.
static LAST_PANIC: Mutex<String> = Mutex::new(String::new());

impl CommandLine {
    /// Parses the process's arguments and does the work; the exit code is 0 for an answer, 2 for
    /// bad input and 1 for an internal error, panics included.
    pub fn run(&self, work: impl FnOnce(&Arguments) -> Result<(), Failure>) -> ExitCode {
        std::panic::set_hook(Box::new(|panic| {
            let mut last = LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner);
            *last = panic.to_string().replace('\n', " ");
        }));
        let outcome = catch_unwind(AssertUnwindSafe(|| {
            let arguments = Arguments::parse(self, std::env::args_os().skip(1))?;
            if arguments.flag("help") {
                crate::print(&self.help())
            } else {
                work(&arguments)
            }
        }))
        .unwrap_or_else(|_| {
            let last = LAST_PANIC.lock().unwrap_or_else(PoisonError::into_inner);
            Err(Failure::Internal(last.clone()))
        });
        match outcome {
            Ok(()) => ExitCode::SUCCESS,
            Err(failure) => {
                crate::note(&format!("{}: {failure}", self.name));
                ExitCode::from(failure.exit_code())
            }
        }
    }
}
