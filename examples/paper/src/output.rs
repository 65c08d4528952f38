//! What all parts share: where files go, parallel runs, sections with claims.

use auv_examples::{Failure, Pictures};
use auv_population::Workers;
use auv_report::{Figure, Table};
use auv_sim::statistics::BoxStats;
use auv_types::Seed;
use std::path::PathBuf;

/// Where output goes and what it is made with.
pub(crate) struct Output {
    pub(crate) folder: PathBuf,
    pub(crate) pictures: Pictures,
    pub(crate) workers: Workers,
    pub(crate) seed: Seed,
    pub(crate) runs: usize,
}

/// A claim of the paper, and whether it holds here.
pub(crate) struct Claim {
    pub(crate) says: String,
    pub(crate) holds: bool,
    pub(crate) ours: String,
}

/// One table or figure.
pub(crate) struct Section {
    title: String,
    text: Vec<String>,
    pub(crate) claims: Vec<Claim>,
}

impl Output {
    pub(crate) fn write(&self, name: &str, text: &str) -> Result<(), Failure> {
        self.pictures.write(&self.folder.join(name), text)
    }

    pub(crate) fn draw(&self, name: &str, figure: &Figure) -> Result<(), Failure> {
        self.write(name, &figure.to_svg())
    }

    /// `work(0)`, `work(1)`, ... in parallel, in order.
    pub(crate) fn each<T: Send>(
        &self,
        count: usize,
        work: impl Fn(usize) -> Result<T, Failure> + Sync,
    ) -> Result<Vec<T>, Failure> {
        let mut slots: Vec<Option<Result<T, Failure>>> = (0..count).map(|_| None).collect();
        self.workers.for_each(&mut slots, |i, slot| {
            *slot = Some(work(i));
        });
        slots.into_iter().flatten().collect()
    }
}

impl Claim {
    pub(crate) fn verdict(&self) -> &'static str {
        if self.holds { "holds" } else { "FAILS" }
    }
}

impl Section {
    pub(crate) fn new(title: &str) -> Self {
        Self {
            title: title.into(),
            text: Vec::new(),
            claims: Vec::new(),
        }
    }

    pub(crate) fn say(&mut self, paragraph: impl Into<String>) {
        self.text.push(paragraph.into());
    }

    pub(crate) fn show(&mut self, file: &str, caption: &str) {
        self.text.push(format!("![{caption}]({file})"));
    }

    pub(crate) fn table(&mut self, table: &Table) {
        self.text.push(table.to_markdown().trim_end().into());
    }

    pub(crate) fn claim(&mut self, says: &str, holds: bool, ours: impl Into<String>) {
        self.claims.push(Claim {
            says: says.into(),
            holds,
            ours: ours.into(),
        });
    }

    pub(crate) fn to_markdown(&self) -> String {
        let mut text = format!("## {}\n", self.title);
        for paragraph in &self.text {
            text += &format!("\n{paragraph}\n");
        }
        for claim in &self.claims {
            let verdict = if claim.holds {
                "holds"
            } else {
                "does not hold"
            };
            text += &format!(
                "\nThe paper: {}. Here this **{verdict}**: {}.\n",
                claim.says, claim.ours
            );
        }
        text + "\n"
    }
}

/// A library error as an internal one: the problems of this program are well-formed.
pub(crate) fn internal(error: impl std::fmt::Display) -> Failure {
    Failure::Internal(error.to_string())
}

/// Median with the 5 % and 95 % quantiles.
pub(crate) fn spread(values: &[f64], decimals: usize) -> String {
    BoxStats::of(values).map_or("-".into(), |s| {
        format!(
            "{:.decimals$} ({:.decimals$} to {:.decimals$})",
            s.median, s.low, s.high
        )
    })
}
