//! Missions with faults: each fault at each intensity on each mission, judged and counted.

use crate::line::line;
use crate::replay::{only_one_to_replay, write_replay};
use auv_examples::{Arguments, Failure, note, print, print_json, write_file};
use auv_ga_route::{GaRoute, GaSettings};
use auv_pso_path::{PathSearch, PsoPath};
use auv_report::Table;
use auv_sim::faults::{
    FailureRate, Fault, FaultPlan, FaultResponse, Intensity, Trial, fly_with_faults,
};
use auv_sim::{Campaign, Log, MissionOutcome, Recorder};
use serde_json::{Value, json};
use std::ops::Range;
use std::path::Path;

/// The most failed runs printed.
const PRINTED: usize = 40;

/// One mission with faults.
struct FaultRun {
    mission: u64,
    faults: Vec<Fault>,
    intensity: Intensity,
    line: Value,
    trial: Option<Trial>,
}

impl FaultRun {
    fn names(&self) -> Vec<&'static str> {
        self.faults.iter().map(|fault| fault.name()).collect()
    }

    /// Why the run failed; empty: it did not.
    fn failures(&self) -> &[String] {
        self.trial.as_ref().map_or(&[], |trial| &trial.failures)
    }

    fn command(&self, campaign: &Campaign) -> String {
        let pairs = if self.faults.len() > 1 {
            " --pairs"
        } else {
            ""
        };
        format!(
            "campaign --seed {} --first {} --missions 1 --faults {} --intensity {}{pairs} --replay replay.html",
            campaign.seed.0,
            self.mission,
            self.names().join(","),
            self.intensity
        )
    }
}

pub(crate) fn run(
    arguments: &Arguments,
    campaign: &Campaign,
    missions: Range<u64>,
) -> Result<(), Failure> {
    let mut runs = Vec::new();
    for faults in plans(arguments)? {
        for &intensity in &intensities(arguments)? {
            runs.extend(missions.clone().map(|mission| FaultRun {
                mission,
                faults: faults.clone(),
                intensity,
                line: Value::Null,
                trial: None,
            }));
        }
    }
    only_one_to_replay(arguments, runs.len() as u64)?;
    let workers = arguments.workers()?;
    let doublecheck = arguments.flag("doublecheck");
    workers.for_each(&mut runs, |_, run| fly(campaign, run, doublecheck));
    if let Some(path) = arguments.text("out") {
        let text: String = runs.iter().map(|run| format!("{}\n", run.line)).collect();
        write_file(Path::new(path), text.as_bytes())?;
    }
    write_replay(arguments, |picture| {
        for run in &runs {
            picture.note(format!(
                "Faults: {}, {}.",
                run.names().join(", "),
                run.intensity
            ));
            watch(campaign, run, picture)?;
        }
        Ok(())
    })?;
    report(arguments, campaign, &runs)
}

fn report(arguments: &Arguments, campaign: &Campaign, runs: &[FaultRun]) -> Result<(), Failure> {
    let failed = runs.iter().filter(|run| !run.failures().is_empty());
    for run in failed.clone().take(PRINTED) {
        note(&format!(
            "{}: {}",
            run.command(campaign),
            run.failures().join("; ")
        ));
    }
    let rows = rows(runs);
    if let Some(path) = arguments.text("table") {
        write_file(Path::new(path), table(&rows).to_markdown().as_bytes())?;
    }
    if arguments.json() {
        return print_json(&json!({
            "runs": runs.len(),
            "failed": failed.count(),
            "faults": rows.iter().map(FaultRow::json).collect::<Vec<_>>(),
        }));
    }
    print(&format!(
        "{}{} of {} runs failed\n",
        table(&rows),
        failed.count(),
        runs.len()
    ))
}

/// The faults of each kind of run: one each, or two each with `--pairs`.
fn plans(arguments: &Arguments) -> Result<Vec<Vec<Fault>>, Failure> {
    let list = arguments.text("faults").unwrap_or("all");
    let mut faults = Vec::new();
    for name in list.split(',') {
        match name {
            "all" => faults.extend_from_slice(Fault::all()),
            name => faults.push(Fault::named(name).ok_or_else(|| {
                let known: Vec<&str> = Fault::all().iter().map(|fault| fault.name()).collect();
                let known = known.join(", ");
                Failure::option("faults", format!("names `{name}`; there are all, {known}"))
            })?),
        }
    }
    if !arguments.flag("pairs") {
        return Ok(faults.into_iter().map(|fault| vec![fault]).collect());
    }
    let pairs = Fault::pairs().into_iter();
    let chosen = pairs.filter(|pair| pair.iter().all(|fault| faults.contains(fault)));
    let plans: Vec<Vec<Fault>> = chosen.map(Vec::from).collect();
    if plans.is_empty() {
        return Err(Failure::option(
            "pairs",
            "give at least two faults in flight (8 to 24)",
        ));
    }
    Ok(plans)
}

fn intensities(arguments: &Arguments) -> Result<Vec<Intensity>, Failure> {
    let list = arguments.text("intensity").unwrap_or("1,2,3,4").split(',');
    list.map(|word| {
        let degree = word.trim().parse().ok().and_then(Intensity::new);
        degree.ok_or_else(|| Failure::option("intensity", format!("is `{word}`; give 1 to 4")))
    })
    .collect()
}

fn fly(campaign: &Campaign, run: &mut FaultRun, doublecheck: bool) {
    let (trial, hash) = match fly_once(campaign, run) {
        Ok(flown) => flown,
        Err(error) => {
            run.line = json!({ "mission": run.mission, "error": error });
            return;
        }
    };
    let mut trial = trial;
    if doublecheck {
        let again = fly_once(campaign, run);
        if again.is_ok_and(|(_, other)| other != hash) {
            trial.failures.push("flown twice, the logs differ".into());
        }
    }
    let names = run.names();
    run.line = match &trial.summary {
        Some(summary) => line((run.mission, campaign.seed.0), summary, &hash, &names),
        None => json!({
            "mission": run.mission,
            "seed": campaign.seed.0,
            "outcome": MissionOutcome::Aborted,
            "reason": "refused before the start",
            "faults": names,
            "log_sha256": hash,
        }),
    };
    if let Some(line) = run.line.as_object_mut() {
        line.insert("intensity".into(), json!(run.intensity.degree()));
        line.insert("class".into(), json!(trial.response.letter()));
        line.insert("begun_s".into(), json!(trial.started_s));
        line.insert("failures".into(), json!(trial.failures));
        line.insert("unavoidable_by_s".into(), json!(trial.unavoidable_by_s));
    }
    run.trial = Some(trial);
}

fn fly_once(campaign: &Campaign, run: &FaultRun) -> Result<(Trial, String), String> {
    let mut log = Log::hash_only();
    let trial = watch(campaign, run, &mut log)?;
    Ok((trial, log.sha256()))
}

fn watch(
    campaign: &Campaign,
    run: &FaultRun,
    recorder: &mut dyn Recorder,
) -> Result<Trial, String> {
    let (routes, paths) = (
        GaRoute::new(GaSettings::default()),
        PsoPath::new(PathSearch::default()),
    );
    let scenario = campaign
        .scenario(run.mission)
        .map_err(|error| error.to_string())?;
    let plan = FaultPlan {
        faults: run.faults.clone(),
        intensity: run.intensity,
        seed: scenario.seed.split(9),
    };
    fly_with_faults(&scenario, &routes, &paths, &plan, recorder).map_err(|error| error.to_string())
}

/// A row of the table: one kind of run at one intensity, or all of them.
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

const CLASSES: [FaultResponse; 4] = [
    FaultResponse::Unchanged,
    FaultResponse::Replanned,
    FaultResponse::FellBack,
    FaultResponse::Refused,
];

impl FaultRow {
    fn count(&mut self, run: &FaultRun) {
        let Some(trial) = &run.trial else { return };
        self.rate.runs += 1;
        self.rate.failures += u64::from(!trial.is_in_order());
        self.unavoidable += u64::from(trial.unavoidable_by_s.is_some());
        let class = CLASSES.iter().position(|&class| class == trial.response);
        self.classes[class.unwrap_or(0)] += 1;
        match trial.summary.as_ref().map(|summary| summary.outcome) {
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

/// A row for each kind of run and intensity in the order flown, and the sum.
fn rows(runs: &[FaultRun]) -> Vec<FaultRow> {
    let mut rows: Vec<FaultRow> = Vec::new();
    let mut all = FaultRow {
        name: "all".into(),
        ..FaultRow::default()
    };
    for run in runs {
        let name = run.names().join(" + ");
        let what = match run.faults[..] {
            [fault] => fault.degrees()[usize::from(run.intensity.degree()) - 1],
            _ => "",
        };
        let degree = format!("{} {what}", run.intensity).trim().to_owned();
        let same = |row: &&mut FaultRow| row.name == name && row.degree == degree;
        match rows.last_mut().filter(same) {
            Some(row) => row.count(run),
            None => {
                let mut row = FaultRow {
                    name,
                    degree,
                    ..FaultRow::default()
                };
                row.count(run);
                rows.push(row);
            }
        }
        all.count(run);
    }
    rows.push(all);
    rows
}

/// The table of the rows.
fn table(rows: &[FaultRow]) -> Table {
    let mut table = Table::new(HEADINGS);
    for row in rows {
        table.row(row.cells());
    }
    table
}
