//! Flies runs in parallel and gives their lines in order, a block at a time.

use crate::flight::Flight;
use crate::progress::Progress;
use auv_examples::Failure;
use auv_population::Workers;
use std::ops::Range;

/// Runs of a block for each thread. Threads wait for each other at the end of a block only.
const BLOCK: usize = 512;

/// Flies `runs` and gives each line to `sink`, in order. Holds one block of lines.
pub(crate) fn stream(
    flight: &Flight,
    workers: &Workers,
    runs: Range<u64>,
    mut sink: impl FnMut(u64, &str) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let progress = Progress::new(runs.end - runs.start);
    let block = BLOCK * workers.threads();
    let mut lines: Vec<String> = Vec::new();
    for from in runs.clone().step_by(block) {
        let count = (runs.end - from).min(block as u64);
        lines.clear();
        lines.resize(count as usize, String::new());
        workers.for_each(&mut lines, |i, line| {
            *line = flight.fly(from + i as u64);
            progress.one();
        });
        for (run, line) in (from..).zip(&lines) {
            sink(run, line)?;
        }
    }
    Ok(())
}
