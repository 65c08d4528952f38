//! A campaign in one process.

use crate::facts::Facts;
use crate::flight::Flight;
use crate::replay::{only_one_to_replay, write_replay};
use crate::stream::stream;
use crate::tally::Tally;
use auv_examples::{Arguments, Failure};
use std::fs::{self, File};
use std::io::{BufWriter, Write};
use std::path::Path;

/// Flies all runs, writes their lines to `--out` as they come, and prints the summary.
pub(crate) fn run(arguments: &Arguments, flight: &Flight) -> Result<(), Failure> {
    let runs = flight.list.total();
    only_one_to_replay(arguments, runs)?;
    let workers = arguments.workers()?;
    let mut out = arguments.text("out").map(LinesFile::create).transpose()?;
    let sea = (flight.fleet.obstacles(), flight.fleet.reserve_s());
    let mut tally = Tally::new(&flight.list, flight.fleet.origin(), sea);
    stream(flight, &workers, 0..runs, |i, line| {
        let facts = Facts::read(line).map_err(Failure::Internal)?;
        tally.count(flight.list.run(i), &facts);
        out.as_mut().map_or(Ok(()), |out| out.line(line))
    })?;
    out.map_or(Ok(()), LinesFile::finish)?;
    write_replay(arguments, |picture| flight.watch(0, picture))?;
    tally.report(arguments)
}

/// The file of `--out`.
struct LinesFile<'a> {
    path: &'a str,
    file: BufWriter<File>,
}

impl<'a> LinesFile<'a> {
    fn create(path: &'a str) -> Result<Self, Failure> {
        let folder = Path::new(path).parent();
        let folder = folder.filter(|folder| !folder.as_os_str().is_empty());
        let file = folder
            .map_or(Ok(()), fs::create_dir_all)
            .and_then(|()| File::create(path));
        let file = file.map_err(|error| unwritable(path, &error))?;
        Ok(Self {
            path,
            file: BufWriter::new(file),
        })
    }

    fn line(&mut self, line: &str) -> Result<(), Failure> {
        let written = writeln!(self.file, "{line}");
        written.map_err(|error| unwritable(self.path, &error))
    }

    fn finish(mut self) -> Result<(), Failure> {
        self.file
            .flush()
            .map_err(|error| unwritable(self.path, &error))
    }
}

fn unwritable(path: &str, error: &std::io::Error) -> Failure {
    Failure::file(
        path,
        format!("cannot be written ({error}): give another place"),
    )
}
