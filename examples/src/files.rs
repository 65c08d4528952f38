//! Files, stdout and stderr.

use crate::Failure;
use serde::Serialize;
use std::fs::{self, File};
use std::io::{ErrorKind, Read, Write};
use std::path::Path;

/// Reads a file of at most `limit` bytes.
///
/// # Errors
/// A file that cannot be read or is longer.
pub fn read_file(path: &str, limit: usize) -> Result<Vec<u8>, Failure> {
    if path.is_empty() {
        return Err(Failure::BadInput(
            "the name of a file is empty: give a path".into(),
        ));
    }
    let unreadable = |error: std::io::Error| {
        let remedy = match error.kind() {
            ErrorKind::NotFound => "check the path",
            ErrorKind::PermissionDenied => "make it readable",
            _ => "give a readable file",
        };
        Failure::file(path, format!("cannot be read ({error}): {remedy}"))
    };
    let file = File::open(path).map_err(unreadable)?;
    if file.metadata().map_err(unreadable)?.is_dir() {
        return Err(Failure::file(path, "is a folder: give a file"));
    }
    let mut bytes = Vec::new();
    file.take(limit as u64 + 1)
        .read_to_end(&mut bytes)
        .map_err(unreadable)?;
    if bytes.len() > limit {
        let text =
            format!("is longer than {limit} bytes, the most that is read: give a smaller file");
        return Err(Failure::file(path, text));
    }
    Ok(bytes)
}

/// Writes a file, making the folders above it.
///
/// # Errors
/// A place that cannot be written to.
pub fn write_file(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    let folder = path
        .parent()
        .filter(|folder| !folder.as_os_str().is_empty());
    folder
        .map_or(Ok(()), fs::create_dir_all)
        .and_then(|()| fs::write(path, contents))
        .map_err(|error| {
            Failure::file(
                &path.display().to_string(),
                format!("cannot be written ({error}): give another place"),
            )
        })
}

/// Prints to stdout unchanged. If the reader has closed the pipe, the process ends with exit code 0.
///
/// # Errors
/// Stdout cannot be written to.
pub fn print(text: &str) -> Result<(), Failure> {
    let mut stdout = std::io::stdout().lock();
    let written = stdout
        .write_all(text.as_bytes())
        .and_then(|()| stdout.flush());
    match written {
        Err(error) if error.kind() == ErrorKind::BrokenPipe => std::process::exit(0),
        written => {
            written.map_err(|error| Failure::file("stdout", format!("cannot be written: {error}")))
        }
    }
}

/// Prints one JSON object on a line of its own.
///
/// # Errors
/// As [`print()`], or the value has no JSON form.
pub fn print_json(value: &impl Serialize) -> Result<(), Failure> {
    let mut text = serde_json::to_string(value)
        .map_err(|error| Failure::Internal(format!("no JSON of the answer: {error}")))?;
    text.push('\n');
    print(&text)
}

/// Writes a line to stderr. An error of stderr is ignored.
pub fn note(line: &str) {
    let _ = writeln!(std::io::stderr().lock(), "{line}");
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn says_why_a_file_is_not_read() {
        let refusal = |path, limit| read_file(path, limit).unwrap_err().to_string();
        assert!(refusal("/no/such/file", 9).contains("check the path"));
        assert!(refusal(env!("CARGO_MANIFEST_DIR"), 9).contains("folder"));
        let own = concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml");
        assert!(refusal(own, 9).contains("longer than 9 bytes"));
        assert!(read_file(own, 1 << 16).is_ok());
    }
}
