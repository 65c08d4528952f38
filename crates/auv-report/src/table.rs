//! Tables as Markdown and CSV, and the paper's two tables of one mission.

use crate::places::name_of as name;
use auv_mission::{Mission, PathCall, RouteCall};
use std::fmt::{self, Write};

/// A table of texts: headings and rows.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    headings: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// A table with these headings.
    #[must_use]
    pub fn new<T: Into<String>>(headings: impl IntoIterator<Item = T>) -> Self {
        Self {
            headings: headings.into_iter().map(Into::into).collect(),
            rows: Vec::new(),
        }
    }

    /// Adds a row; missing cells stay empty, superfluous ones are kept.
    pub fn row<T: Into<String>>(&mut self, cells: impl IntoIterator<Item = T>) {
        self.rows.push(cells.into_iter().map(Into::into).collect());
    }

    /// The rows.
    #[must_use]
    pub fn rows(&self) -> &[Vec<String>] {
        &self.rows
    }

    /// The table as Markdown; a column of numbers is flush right.
    #[must_use]
    pub fn to_markdown(&self) -> String {
        let columns = self.columns();
        let empty = String::new();
        let cell = |row: &Vec<String>, k: usize| {
            let text = row.get(k).unwrap_or(&empty);
            text.replace('|', "\\|").replace(['\n', '\r'], " ")
        };
        let mut out = String::new();
        let mut line = |cells: &mut dyn Iterator<Item = String>| {
            for cell in cells {
                let _ = write!(out, "| {cell} ");
            }
            out.push_str("|\n");
        };
        line(&mut (0..columns).map(|k| cell(&self.headings, k)));
        line(&mut (0..columns).map(|k| {
            let mut cells = self.rows.iter().filter_map(|row| row.get(k));
            let numeric = cells.all(|c| c.is_empty() || c == "-" || c.parse::<f64>().is_ok());
            if numeric && !self.rows.is_empty() {
                "---:"
            } else {
                "---"
            }
            .to_owned()
        }));
        for row in &self.rows {
            line(&mut (0..columns).map(|k| cell(row, k)));
        }
        out
    }

    /// The table as CSV (RFC 4180, lines end in LF).
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut out = String::new();
        for row in std::iter::once(&self.headings).chain(&self.rows) {
            let cells: Vec<String> = row.iter().map(|cell| quoted(cell)).collect();
            out.push_str(&cells.join(","));
            out.push('\n');
        }
        out
    }

    fn columns(&self) -> usize {
        let rows = self.rows.iter().map(Vec::len);
        rows.max().unwrap_or(0).max(self.headings.len())
    }
}

/// The table as text for people: the first column flush left, the others flush right.
impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let lines = || std::iter::once(&self.headings).chain(&self.rows);
        let width = |column: usize| {
            let cells = lines().filter_map(|row| row.get(column));
            cells.map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        let widths: Vec<_> = (0..self.columns()).map(width).collect();
        for (i, row) in lines().enumerate() {
            let mut line = String::new();
            for (column, (cell, &width)) in row.iter().zip(&widths).enumerate() {
                line += &match column {
                    0 => format!("{cell:<width$}"),
                    _ => format!("  {cell:>width$}"),
                };
            }
            writeln!(f, "{}", line.trim_end())?;
            if i == 0 {
                let total: usize = widths.iter().map(|width| width + 2).sum();
                writeln!(f, "{}", "-".repeat(total.saturating_sub(2)))?;
            }
        }
        Ok(())
    }
}

fn quoted(cell: &str) -> String {
    if cell.contains([',', '"', '\n', '\r']) {
        format!("\"{}\"", cell.replace('"', "\"\""))
    } else {
        cell.into()
    }
}

/// The table of route calls (the paper's Table 2, upper part), with both weights.
#[must_use]
pub fn route_table(mission: &Mission, calls: &[RouteCall]) -> Table {
    let mut table = Table::new([
        "call",
        "reason",
        "start",
        "dest",
        "tasks",
        "route weight",
        "mission weight",
        "cost",
        "CPU (s)",
        "T_available (s)",
        "T_route (s)",
        "valid",
        "adopted",
        "route",
    ]);
    for call in calls {
        let route: Vec<String> = call.route.iter().map(|&node| name(mission, node)).collect();
        let cost = if call.cost < 1e300 {
            format!("{:.4}", call.cost)
        } else {
            "-".into()
        };
        table.row([
            call.call.to_string(),
            call.reason.as_str().into(),
            name(mission, call.start),
            name(mission, call.destination),
            call.tasks.to_string(),
            format!("{:.2}", call.route_weight),
            format!("{:.2}", call.mission_weight),
            cost,
            format!("{:.4}", call.compute_s),
            format!("{:.1}", call.available_s),
            format!("{:.1}", call.route_s),
            if call.valid { "yes" } else { "no" }.into(),
            if call.adopted { "yes" } else { "no" }.into(),
            route.join("-"),
        ]);
    }
    table
}

/// The table of legs (the paper's Table 2, lower part).
#[must_use]
pub fn path_table(mission: &Mission, legs: &[PathCall]) -> Table {
    let mut table = Table::new([
        "route",
        "call",
        "edge",
        "violation",
        "cost",
        "CPU (s)",
        "T_leg (s)",
        "T_expected (s)",
        "T_available (s)",
        "replan",
        "LPP",
        "paths replanned",
        "waited (s)",
        "done",
    ]);
    for leg in legs {
        table.row([
            leg.route_call.to_string(),
            leg.call.to_string(),
            format!("{}-{}", name(mission, leg.from), name(mission, leg.to)),
            format!("{:.6}", leg.violation),
            format!("{:.4}", leg.cost),
            format!("{:.4}", leg.compute_s),
            format!("{:.1}", leg.leg_s),
            format!("{:.1}", leg.expected_s),
            format!("{:.1}", leg.available_s),
            u8::from(leg.replan).to_string(),
            u8::from(leg.next_leg).to_string(),
            leg.replanned_paths.to_string(),
            format!("{:.1}", leg.waited_s),
            if leg.completed { "yes" } else { "no" }.into(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_of_text_line_up() {
        let mut table = Table::new(["leg", "time (s)"]);
        table.row(["1-39", "2333.1"]);
        table.row(["39-7", "755.8"]);
        let text = table.to_string();
        let lengths: Vec<_> = text.lines().map(str::len).collect();
        assert_eq!(lengths, [14; 4]);
    }

    #[test]
    fn markdown_and_csv_quote_what_would_break_them() {
        let mut table = Table::new(["name", "value"]);
        table.row(["a|b, \"c\"", "25212"]);
        table.row(["d"]);
        assert_eq!(
            table.to_markdown(),
            "| name | value |\n| --- | ---: |\n| a\\|b, \"c\" | 25212 |\n| d |  |\n"
        );
        assert_eq!(table.to_csv(), "name,value\n\"a|b, \"\"c\"\"\",25212\nd\n");
    }
}
