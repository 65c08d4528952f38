//! Flies many missions in parallel: `cargo run --release --example campaign -- --missions 100`.

mod faults;
mod fleet;
mod line;
mod replay;

use auv_examples::{
    Arguments, CommandLine, Failure, MissionInput, Opt, note, print, print_json, write_file,
};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_report::MissionPicture;
use auv_sim::faults::FailureRate;
use auv_sim::{Log, MissionOutcome, Recorder, Summary, simulate};
use fleet::Fleet;
use line::line;
use replay::{only_one_to_replay, write_replay};
use serde_json::{Value, json};
use std::path::Path;

const COMMAND: CommandLine = CommandLine {
    name: "campaign",
    about: "Flies missions of the paper's Table 2 set-up (50 waypoints, 1470 directed edges, 10,800 s, all four\n\
            classes of obstacles, noisy sonar) and judges them by the truth.",
    operands: &[],
    options: &[
        Opt::value("missions", "N", "100", "number of missions"),
        Opt::value("first", "K", "0", "number of the first mission"),
        Opt::value(
            "out",
            "FILE",
            "",
            "where to write one JSON line a mission (default: nowhere)",
        ),
        Opt::value(
            "mission",
            "FILE",
            "",
            "flies this mission file with the seeds --seed + K instead; see docs/mission-file.md",
        ),
        MissionInput::BATHYMETRY,
        MissionInput::CURRENTS,
        MissionInput::AIS,
        Opt::value(
            "faults",
            "LIST",
            "",
            "injects each of these faults: names or numbers with commas between, or all (1 to 24)",
        ),
        Opt::value(
            "intensity",
            "LIST",
            "1,2,3,4",
            "how severe faults are, 1 to 4",
        ),
        Opt::flag(
            "pairs",
            "injects each two of the faults in flight (8 to 24) together, none alone",
        ),
        Opt::flag(
            "doublecheck",
            "flies every mission twice; logs that differ are failures",
        ),
        Opt::value(
            "table",
            "FILE",
            "",
            "where to write the table of faults as Markdown",
        ),
        Opt::value(
            "replay",
            "FILE",
            "",
            "where to write the page that replays the run, HTML; of one run only, so with --missions 1",
        ),
    ],
    notes: "Mission k depends on --seed and k only. With faults every mission is flown once for each fault and\n\
            intensity; runs that fail are printed as the command that flies them again\n\
            and writes the page that replays them.\n\
            Examples: campaign --missions 1000 --out campaign.jsonl\n\
            \x20         campaign --missions 1000 --mission examples/missions/harrow_inlet.toml\n\
            \x20         campaign --missions 20 --faults all --table faults.md\n\
            \x20         campaign --missions 20 --faults all --pairs --intensity 3",
};

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

/// The most missions printed that did not dock.
const PRINTED: usize = 20;

/// One mission's line, and what the summary needs of it.
struct Flown {
    line: Value,
    summary: Option<Summary>,
    /// Time kept in reserve, seconds.
    reserve_s: f64,
}

impl Flown {
    fn failed(k: u64, error: impl std::fmt::Display) -> Self {
        Self {
            line: json!({ "mission": k, "error": error.to_string() }),
            summary: None,
            reserve_s: 0.0,
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let count: u64 = arguments.number("missions")?.unwrap_or(100);
    let first: u64 = arguments.number("first")?.unwrap_or(0);
    let fleet = Fleet::read(arguments)?;
    if arguments.text("faults").is_some() {
        let Fleet::Table2(campaign) = &fleet else {
            return Err(Failure::option(
                "faults",
                "are injected into missions of the Table 2 set-up only; leave out --mission",
            ));
        };
        return faults::run(arguments, campaign, first..first.saturating_add(count));
    }
    only_one_to_replay(arguments, count)?;
    let workers = arguments.workers()?;
    let mut flown: Vec<Flown> = (0..count).map(|k| Flown::failed(k, "not flown")).collect();
    workers.for_each(&mut flown, |i, flown| {
        *flown = fly(&fleet, first + i as u64, arguments.flag("doublecheck"));
    });
    let text: String = flown
        .iter()
        .map(|flown| format!("{}\n", flown.line))
        .collect();
    if let Some(path) = arguments.text("out") {
        write_file(Path::new(path), text.as_bytes())?;
    }
    let watched = |picture: &mut MissionPicture| watch(&fleet, first, picture).map(|_| ());
    write_replay(arguments, watched)?;
    report(arguments, &fleet, first, &flown)
}

/// Flies one mission, or twice to check that the logs are equal.
fn fly(fleet: &Fleet, k: u64, doublecheck: bool) -> Flown {
    let flown = fly_once(fleet, k);
    if doublecheck && fly_once(fleet, k).line != flown.line {
        return Flown::failed(k, "flown twice, the logs differ");
    }
    flown
}

fn fly_once(fleet: &Fleet, k: u64) -> Flown {
    let mut log = Log::hash_only();
    match watch(fleet, k, &mut log) {
        Ok((summary, reserve_s)) => Flown {
            line: line((k, fleet.seed_of(k)), &summary, &log.sha256(), &[]),
            summary: Some(summary),
            reserve_s,
        },
        Err(error) => Flown::failed(k, error),
    }
}

/// Flies mission `k`. Returns its summary and its reserve in seconds.
fn watch(fleet: &Fleet, k: u64, recorder: &mut dyn Recorder) -> Result<(Summary, f64), String> {
    let (routes, paths) = (
        GaRoute::new(GaSettings::default()),
        PsoPath::new(PathSearch::default()),
    );
    let driver = Stepped::new(&routes, &paths);
    let scenario = fleet.scenario(k)?;
    let summary = simulate(&scenario, &driver, recorder).map_err(|error| error.to_string())?;
    Ok((summary, scenario.mission.reserve_s))
}

fn report(
    arguments: &Arguments,
    fleet: &Fleet,
    first: u64,
    flown: &[Flown],
) -> Result<(), Failure> {
    let summaries: Vec<&Summary> = flown
        .iter()
        .filter_map(|flown| flown.summary.as_ref())
        .collect();
    let count = |outcome| summaries.iter().filter(|s| s.outcome == outcome).count();
    let docked = count(MissionOutcome::Docked);
    let others = (first..).zip(flown).filter_map(|(k, flown)| {
        let what = match &flown.summary {
            Some(summary) if summary.outcome == MissionOutcome::Docked => return None,
            Some(summary) => format!("{}: {}", summary.outcome, summary.reason),
            None => flown.line["error"].to_string(),
        };
        Some(format!("mission {k} {what} ({})", fleet.command(k)))
    });
    for other in others.take(PRINTED) {
        note(&other);
    }
    let mut remaining: Vec<f64> = flown
        .iter()
        .filter_map(|flown| Some(flown.summary.as_ref()?.remaining_s - flown.reserve_s))
        .collect();
    remaining.sort_by(f64::total_cmp);
    let median = remaining.get(remaining.len() / 2).copied().unwrap_or(0.0);
    let weight: f64 =
        summaries.iter().map(|s| s.mission_weight).sum::<f64>() / summaries.len().max(1) as f64;
    let rate = FailureRate {
        failures: (flown.len() - docked) as u64,
        runs: flown.len() as u64,
    };
    let (low, high) = rate.bounds_95();
    let bounds = [low, high];
    let answer = json!({
        "missions": flown.len(),
        "docked": docked,
        "late": count(MissionOutcome::Late),
        "collided": count(MissionOutcome::Collided),
        "aborted": count(MissionOutcome::Aborted),
        "failed": flown.len() - summaries.len(),
        "not_docked_95": bounds,
        "obstacles": fleet.obstacles(),
        "mean_weight": weight,
        "median_remaining_above_reserve_s": median,
    });
    if arguments.json() {
        print_json(&answer)
    } else {
        print(&format!("{answer:#}\n"))
    }
}
