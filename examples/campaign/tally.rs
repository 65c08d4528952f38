//! The summary of a campaign, counted from its lines.

use crate::facts::Facts;
use crate::fault_tally::FaultTally;
use crate::mission_tally::MissionTally;
use crate::origin::Origin;
use crate::run_list::{Run, RunList};
use auv_examples::{Arguments, Failure, note, print, print_json, write_file};
use std::path::Path;

/// Counts lines in order, with or without faults.
pub(crate) enum Tally {
    Missions(Box<MissionTally>),
    Faults(Box<FaultTally>),
}

impl Tally {
    pub(crate) fn new(
        list: &RunList,
        origin: Origin,
        (obstacles, reserve_s): (Option<usize>, f64),
    ) -> Self {
        if list.has_faults() {
            return Self::Faults(Box::new(FaultTally::new(origin.seed())));
        }
        Self::Missions(Box::new(MissionTally::new(origin, obstacles, reserve_s)))
    }

    pub(crate) fn count(&mut self, run: Run<'_>, facts: &Facts) {
        match self {
            Self::Missions(tally) => tally.count(facts),
            Self::Faults(tally) => tally.count(run, facts),
        }
    }

    /// Prints the summary to stdout, what went wrong to stderr, and writes `--table`.
    pub(crate) fn report(&mut self, arguments: &Arguments) -> Result<(), Failure> {
        let notes = match self {
            Self::Missions(tally) => tally.notes(),
            Self::Faults(tally) => tally.notes(),
        };
        for line in notes {
            note(line);
        }
        if let (Self::Faults(tally), Some(path)) = (&*self, arguments.text("table")) {
            let table = tally.table().to_markdown();
            write_file(Path::new(path), table.as_bytes())?;
        }
        match (self, arguments.json()) {
            (Self::Missions(tally), true) => print_json(&tally.json()),
            (Self::Missions(tally), false) => print(&tally.text()),
            (Self::Faults(tally), true) => print_json(&tally.json()),
            (Self::Faults(tally), false) => print(&tally.text()),
        }
    }
}
