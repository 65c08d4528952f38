//! The machine that a section was measured on.

use auv_examples::{Arguments, Failure};

/// `--machine`, else the number of threads.
pub(crate) fn machine(arguments: &Arguments) -> Result<String, Failure> {
    Ok(
        match arguments.text("machine").filter(|text| !text.is_empty()) {
            Some(text) => text.into(),
            None => format!("{} threads", arguments.workers()?.threads()),
        },
    )
}
