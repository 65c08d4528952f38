//! A file that gets its name once it is complete.

use auv_examples::Failure;
use std::fs::{self, File};
use std::io::{BufWriter, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A file under a temporary name. It gets its own name by [`TemporaryFile::publish`]; dropped before, it
/// is removed. A killed process leaves the temporary name, which ends in `.tmp-` and two numbers.
pub(crate) struct TemporaryFile {
    file: BufWriter<File>,
    path: PathBuf,
    target: PathBuf,
    published: bool,
}

/// Whether a file name is a temporary one of `target`.
pub(crate) fn is_temporary(name: &str) -> bool {
    name.contains(".tmp-")
}

fn unwritable(path: &Path, error: &std::io::Error) -> Failure {
    let text = format!("cannot be written ({error}): give a folder with room that can be written");
    Failure::file(&path.display().to_string(), text)
}

impl TemporaryFile {
    /// Starts a file that will be called `target`. Its temporary name is its own, also when several
    /// processes or machines write the same target.
    pub(crate) fn new(target: PathBuf) -> Result<Self, Failure> {
        let process = std::process::id();
        for attempt in 0_u32.. {
            let mut path = target.clone().into_os_string();
            path.push(format!(".tmp-{process}-{attempt}"));
            let path = PathBuf::from(path);
            match File::create_new(&path) {
                Ok(file) => {
                    return Ok(Self {
                        file: BufWriter::new(file),
                        path,
                        target,
                        published: false,
                    });
                }
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(unwritable(&path, &error)),
            }
        }
        Err(Failure::Internal("no temporary name is left".into()))
    }

    pub(crate) fn write(&mut self, bytes: &[u8]) -> Result<(), Failure> {
        let written = self.file.write_all(bytes);
        written.map_err(|error| unwritable(&self.path, &error))
    }

    /// Brings the file to the disk and gives it its name, in place of one that has it.
    pub(crate) fn publish(mut self) -> Result<(), Failure> {
        self.finish()?;
        let renamed = fs::rename(&self.path, &self.target);
        renamed.map_err(|error| unwritable(&self.target, &error))?;
        self.published = true;
        Ok(())
    }

    /// As [`TemporaryFile::publish`], but a file that has the name stays. Says whether it was given.
    pub(crate) fn publish_first(mut self) -> Result<bool, Failure> {
        self.finish()?;
        match fs::hard_link(&self.path, &self.target) {
            Ok(()) => Ok(true),
            Err(_) if self.target.exists() => Ok(false),
            // A file system without hard links.
            Err(_) => self.publish().map(|()| true),
        }
    }

    fn finish(&mut self) -> Result<(), Failure> {
        let flushed = self.file.flush();
        let synced = flushed.and_then(|()| self.file.get_ref().sync_all());
        synced.map_err(|error| unwritable(&self.path, &error))
    }
}

impl Drop for TemporaryFile {
    fn drop(&mut self) {
        if !self.published {
            let _ = fs::remove_file(&self.path);
        }
    }
}
