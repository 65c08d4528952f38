//! The summary of a campaign with faults: a table.

use crate::facts::Facts;
use crate::run_list::{FaultKind, Run};
use auv_report::Table;
use auv_sim::MissionOutcome;
use auv_sim::faults::FailureRate;
use serde_json::{Value, json};

/// The most failed runs noted.
const NOTED: usize = 40;
/// The letters of the responses, in the table's order.
const CLASSES: [char; 4] = ['C', 'R', 'F', 'E'];
const HEADINGS: [&str; 14] = [
    "fault",
    "intensity",
    "runs",
    "failed",
    "95 %",
    "docked",
    "late",
    "aborted",
    "collided",
    "unavoidable",
    "C",
    "R",
    "F",
    "E",
];

/// What the columns of the table hold.
const LEGEND: &str = "\
95 %: bounds of the share failed; unavoidable: collisions that nothing could
avoid; how runs ended: C unchanged, R replanned and docked in time, F fallen back,
E refused with an error
";

/// A row for each kind of run in the order flown, and the sum.
pub(crate) struct FaultTally {
    seed: u64,
    rows: Vec<FaultRow>,
    all: FaultRow,
    runs: u64,
    failed: u64,
    notes: Vec<String>,
}

/// A row of the table: one kind of run, or all of them.
#[derive(Default)]
struct FaultRow {
    name: String,
    degree: String,
    rate: FailureRate,
    classes: [u64; 4],
    docked: u64,
    late: u64,
    aborted: u64,
    collided: u64,
    /// Collisions that the oracle proves unavoidable.
    unavoidable: u64,
}

impl FaultTally {
    pub(crate) fn new(seed: u64) -> Self {
        Self {
            seed,
            rows: Vec::new(),
            all: FaultRow {
                name: "all".into(),
                ..FaultRow::default()
            },
            runs: 0,
            failed: 0,
            notes: Vec::new(),
        }
    }

    /// Counts a line; lines come in order.
    pub(crate) fn count(&mut self, run: Run<'_>, facts: &Facts) {
        let Some(kind) = run.kind else { return };
        self.runs += 1;
        let fresh = FaultRow::of(kind);
        let same = |row: &FaultRow| row.name == fresh.name && row.degree == fresh.degree;
        if !self.rows.last().is_some_and(same) {
            self.rows.push(fresh);
        }
        if let Some(row) = self.rows.last_mut() {
            row.count(facts);
        }
        self.all.count(facts);
        let failures = facts.error.iter().chain(&facts.failures);
        let failures: Vec<&str> = failures.map(String::as_str).collect();
        if failures.is_empty() {
            return;
        }
        self.failed += 1;
        if self.notes.len() < NOTED {
            let command = self.command(run.mission, kind);
            self.notes
                .push(format!("{command}: {}", failures.join("; ")));
        }
    }

    /// The command that flies a run again.
    fn command(&self, mission: u64, kind: &FaultKind) -> String {
        let pairs = if kind.faults.len() > 1 {
            " --pairs"
        } else {
            ""
        };
        format!(
            "campaign --seed {} --first {mission} --missions 1 --faults {} --intensity {}{pairs} --replay replay.html",
            self.seed,
            kind.names().join(","),
            kind.intensity
        )
    }

    /// The first failed runs, with the command that flies each again.
    pub(crate) fn notes(&self) -> &[String] {
        &self.notes
    }

    /// The table of the rows.
    pub(crate) fn table(&self) -> Table {
        let mut table = Table::new(HEADINGS);
        for row in self.rows.iter().chain([&self.all]) {
            table.row(row.cells());
        }
        table
    }

    /// The summary.
    pub(crate) fn json(&self) -> Value {
        let rows = self.rows.iter().chain([&self.all]);
        json!({
            "runs": self.runs,
            "failed": self.failed,
            "faults": rows.map(FaultRow::json).collect::<Vec<_>>(),
        })
    }

    /// The summary as text.
    pub(crate) fn text(&self) -> String {
        let table = self.table();
        format!(
            "{table}{LEGEND}{} of {} runs failed\n",
            self.failed, self.runs
        )
    }
}

impl FaultRow {
    fn of(kind: &FaultKind) -> Self {
        let what = match kind.faults[..] {
            [fault] => fault.degrees()[usize::from(kind.intensity.degree()) - 1],
            _ => "",
        };
        Self {
            name: kind.names().join(" + "),
            degree: format!("{} {what}", kind.intensity).trim().to_owned(),
            ..Self::default()
        }
    }

    fn count(&mut self, facts: &Facts) {
        self.rate.runs += 1;
        let failed = facts.error.is_some() || !facts.failures.is_empty();
        self.rate.failures += u64::from(failed);
        self.unavoidable += u64::from(facts.unavoidable_by_s.is_some());
        if let Some(class) = CLASSES.iter().position(|&class| facts.class == Some(class)) {
            self.classes[class] += 1;
        }
        match facts.flown() {
            Some(MissionOutcome::Docked) => self.docked += 1,
            Some(MissionOutcome::Late) => self.late += 1,
            Some(MissionOutcome::Aborted) => self.aborted += 1,
            Some(MissionOutcome::Collided) => self.collided += 1,
            None => {}
        }
    }

    fn cells(&self) -> Vec<String> {
        let (low, high) = self.rate.bounds_95();
        let mut cells = vec![
            self.name.clone(),
            self.degree.clone(),
            self.rate.runs.to_string(),
            self.rate.failures.to_string(),
            format!("{:.1}-{:.1} %", 100.0 * low, 100.0 * high),
        ];
        let counts = [
            self.docked,
            self.late,
            self.aborted,
            self.collided,
            self.unavoidable,
        ];
        cells.extend(counts.iter().chain(&self.classes).map(u64::to_string));
        cells
    }

    fn json(&self) -> Value {
        let (low, high) = self.rate.bounds_95();
        json!({
            "faults": self.name, "intensity": self.degree,
            "runs": self.rate.runs, "failed": self.rate.failures, "bounds_95": [low, high],
            "docked": self.docked, "late": self.late, "aborted": self.aborted,
            "collided": self.collided, "unavoidable": self.unavoidable,
            "classes_c_r_f_e": self.classes,
        })
    }
}
