//! What was read from the files beside a mission.

use super::DataFile;
use auv_ocean::FileReport;
use serde::Serialize;
use std::fmt::Write;

/// What was read from each file beside a mission.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct DataReport {
    /// The files, in the order read.
    pub files: Vec<FileRead>,
    /// What the operator must know of the files together with the mission.
    pub notes: Vec<String>,
}

/// What was read from one file.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct FileRead {
    /// Which file.
    pub file: DataFile,
    /// What was read from it.
    #[serde(flatten)]
    pub report: FileReport,
}

impl DataReport {
    pub(super) fn add(&mut self, file: DataFile, report: FileReport) {
        self.files.push(FileRead { file, report });
    }

    /// Everything that was dropped or assumed, one sentence each, with its file.
    #[must_use]
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        for FileRead { file, report } in &self.files {
            warnings.extend(report.warnings().map(|text| format!("{file}: {text}")));
        }
        warnings.extend(self.notes.iter().cloned());
        warnings
    }

    /// The whole report as text, for people.
    #[must_use]
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        for FileRead { file, report } in &self.files {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{file}: {}", report.format);
            describe_variables(&mut text, report);
            if let Some([south, north, west, east]) = report.extent_deg {
                let _ = writeln!(
                    text,
                    "  extent: {south} to {north} north, {west} to {east} east, degrees"
                );
            }
            if let Some((first, last, count)) = report.records {
                let _ = writeln!(
                    text,
                    "  times: {count} records over {:.0} s, from {first:.0} s after 1970-01-01 00:00 UTC",
                    last - first
                );
            }
            if !report.levels_m.is_empty() {
                let _ = writeln!(text, "  levels: {:?} m", report.levels_m);
            }
            if let Some(vertical) = &report.vertical {
                let _ = writeln!(text, "  vertical: {vertical}");
            }
            for (what, lines) in [
                ("converted", &report.converted),
                ("dropped", &report.dropped),
                ("assumed", &report.assumed),
            ] {
                for line in lines {
                    let _ = writeln!(text, "  {what}: {line}");
                }
            }
        }
        for note in &self.notes {
            let _ = writeln!(text, "note: {note}");
        }
        if self.files.is_empty() {
            text.push_str("the mission names no chart, no modelled current and no ship tracks\n");
        }
        text
    }
}

fn describe_variables(text: &mut String, report: &FileReport) {
    for v in &report.variables {
        let shape: Vec<_> = v
            .shape
            .iter()
            .map(|(name, n)| format!("{name} {n}"))
            .collect();
        let units = if v.units.is_empty() {
            "no units"
        } else {
            &v.units
        };
        let _ = write!(
            text,
            "  {} = {} [{units}] ({})",
            v.role,
            v.name,
            shape.join(" x ")
        );
        if let Some([low, high]) = v.range {
            let _ = write!(
                text,
                ", {low} to {high}, {:.1} % missing",
                100.0 * v.missing_share
            );
        }
        text.push('\n');
    }
}
