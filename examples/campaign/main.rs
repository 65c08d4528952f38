//! Flies many missions in parallel: `cargo run --release --example campaign -- --missions 100`.

mod faults;

use auv_examples::{Arguments, Command, Failure, Opt, note, print, print_json, write_file};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PsoPath, PsoSettings};
use auv_sim::{Campaign, Log, MissionOutcome, Summary, simulate};
use serde_json::{Value, json};
use std::path::Path;

const COMMAND: Command = Command {
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
    ],
    notes: "Mission k depends on --seed and k only. With faults every mission is flown once for each fault and\n\
            intensity; runs that fail are printed as the command that flies them again.\n\
            Examples: campaign --missions 1000 --out campaign.jsonl\n\
            \x20         campaign --missions 20 --faults all --table faults.md\n\
            \x20         campaign --missions 20 --faults all --pairs --intensity 3",
};

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

/// One mission's line, and what the summary needs of it.
struct Flown {
    line: Value,
    summary: Option<Summary>,
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let seed = arguments.seed()?;
    let count: u64 = arguments.number("missions")?.unwrap_or(100);
    let first: u64 = arguments.number("first")?.unwrap_or(0);
    let campaign = Campaign::table2(seed).map_err(|error| Failure::Internal(error.to_string()))?;
    if arguments.text("faults").is_some() {
        return faults::run(arguments, &campaign, first..first.saturating_add(count));
    }
    let workers = arguments.workers()?;
    let mut flown: Vec<Flown> = (0..count)
        .map(|_| Flown {
            line: Value::Null,
            summary: None,
        })
        .collect();
    let mut scratches = vec![(); workers.threads()];
    workers.for_each(&mut flown, 1, &mut scratches, |i, flown, ()| {
        *flown = fly(&campaign, first + i as u64, arguments.flag("doublecheck"));
    });
    let text: String = flown
        .iter()
        .map(|flown| format!("{}\n", flown.line))
        .collect();
    if let Some(path) = arguments.text("out") {
        write_file(Path::new(path), text.as_bytes())?;
    }
    report(arguments, &campaign, first, &flown)
}

/// One mission; twice, if it is to be checked that the log is the same.
fn fly(campaign: &Campaign, k: u64, doublecheck: bool) -> Flown {
    let flown = fly_once(campaign, k);
    if doublecheck && fly_once(campaign, k).line != flown.line {
        let error = "flown twice, the logs differ";
        return Flown {
            line: json!({ "mission": k, "error": error }),
            summary: None,
        };
    }
    flown
}

fn fly_once(campaign: &Campaign, k: u64) -> Flown {
    let (routes, paths) = (
        GaRoute::new(GaSettings::default()),
        PsoPath::new(PsoSettings::default()),
    );
    let driver = Stepped::new(&routes, &paths);
    let mut log = Log::hash_only();
    let scenario = match campaign.scenario(k) {
        Ok(scenario) => scenario,
        Err(error) => {
            return Flown {
                line: json!({ "mission": k, "error": error.to_string() }),
                summary: None,
            };
        }
    };
    match simulate(&scenario, &driver, &mut log) {
        Ok(summary) => Flown {
            line: line(campaign, k, &summary, &log.sha256(), &[]),
            summary: Some(summary),
        },
        Err(error) => Flown {
            line: json!({ "mission": k, "error": error.to_string() }),
            summary: None,
        },
    }
}

fn line(
    campaign: &Campaign,
    k: u64,
    summary: &Summary,
    log_sha256: &str,
    faults: &[&str],
) -> Value {
    let judgement = &summary.judgement;
    let clearance_m = judgement.min_clearance_m;
    json!({
        "mission": k,
        "seed": campaign.seed.0,
        "outcome": summary.outcome,
        "reason": summary.reason,
        "collisions": judgement.collisions,
        "groundings": judgement.groundings,
        "min_true_clearance_m": if clearance_m.is_finite() { json!(clearance_m) } else { Value::Null },
        "time_s": summary.time_s,
        "remaining_s": summary.remaining_s,
        "mission_weight": summary.mission_weight,
        "tasks": summary.tasks,
        "route_calls": summary.route_calls.len(),
        "path_calls": summary.path_calls.len(),
        "replans": summary.path_calls.iter().filter(|leg| leg.replan).count(),
        "faults": faults,
        "log_sha256": log_sha256,
    })
}

fn report(
    arguments: &Arguments,
    campaign: &Campaign,
    first: u64,
    flown: &[Flown],
) -> Result<(), Failure> {
    let summaries: Vec<(u64, &Summary)> = (first..)
        .zip(flown)
        .filter_map(|(k, flown)| Some((k, flown.summary.as_ref()?)))
        .collect();
    let count = |outcome| {
        summaries
            .iter()
            .filter(|(_, s)| s.outcome == outcome)
            .count()
    };
    let docked = count(MissionOutcome::Docked);
    for (k, summary) in summaries
        .iter()
        .filter(|(_, s)| s.outcome != MissionOutcome::Docked)
        .take(20)
    {
        note(&format!(
            "mission {k} {}: {} (campaign --seed {} --first {k} --missions 1)",
            summary.outcome, summary.reason, campaign.seed.0
        ));
    }
    let mut remaining: Vec<f64> = summaries
        .iter()
        .map(|(_, s)| s.remaining_s - campaign.reserve_s)
        .collect();
    remaining.sort_by(f64::total_cmp);
    let median = remaining.get(remaining.len() / 2).copied().unwrap_or(0.0);
    let weight: f64 = summaries.iter().map(|(_, s)| s.mission_weight).sum::<f64>()
        / summaries.len().max(1) as f64;
    let answer = json!({
        "missions": flown.len(),
        "docked": docked,
        "late": count(MissionOutcome::Late),
        "collided": count(MissionOutcome::Collided),
        "aborted": count(MissionOutcome::Aborted),
        "failed": flown.len() - summaries.len(),
        "obstacles": campaign.obstacles,
        "mean_weight": weight,
        "median_remaining_above_reserve_s": median,
    });
    if arguments.json() {
        print_json(&answer)
    } else {
        print(&format!("{answer:#}\n"))
    }
}
