//! Flies many missions in parallel: `cargo run --release --example campaign -- --missions 100`.

mod brief;
mod digest;
mod facts;
mod fault_tally;
mod faults;
mod fleet;
mod flight;
mod line;
mod manifest;
mod merge;
mod mission_tally;
mod origin;
mod part;
mod progress;
mod replay;
mod run_list;
mod shard;
mod stream;
mod tally;
mod temporary;
mod whole;

use auv_examples::{Arguments, CommandLine, Failure, MissionInput, Opt};
use fleet::Fleet;
use flight::Flight;
use run_list::RunList;

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
            "where to write one JSON line a mission, as they are flown (default: nowhere)",
        ),
        Opt::value(
            "shard",
            "I/N",
            "",
            "flies part I (from 0) of N parts into --shards-dir, unless it is there already",
        ),
        Opt::value(
            "shards-dir",
            "DIR",
            "",
            "the folder of the parts and their manifest.json; see docs/campaigns.md",
        ),
        Opt::value(
            "merge",
            "DIR",
            "",
            "flies nothing; checks the parts in this folder, joins them into DIR/campaign.jsonl, prints the summary",
        ),
        Opt::value(
            "mission",
            "FILE",
            "",
            "flies this mission file with the seeds --seed + K instead; see docs/mission-file.md",
        ),
        Opt::value(
            "brief",
            "FILE",
            "",
            "with --mission: where to write one page for the decision to launch, HTML; flies the missions also with one hour less, in a stronger current and at other launches",
        ),
        MissionInput::BATHYMETRY,
        MissionInput::CURRENTS,
        MissionInput::AIS,
        MissionInput::BODY,
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
            \x20         campaign --missions 20 --faults all --pairs --intensity 3\n\
            \x20         campaign --missions 200 --mission examples/missions/harrow_inlet.toml --brief brief.html\n\
            \x20         campaign --missions 1000 --shard 0/8 --shards-dir parts; campaign --merge parts",
};

fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.flag("merge") {
        return merge::run(arguments, COMMAND.options);
    }
    let missions: u64 = arguments.number("missions")?.unwrap_or(100);
    let first: u64 = arguments.number("first")?.unwrap_or(0);
    let fleet = Fleet::read(arguments)?;
    if let Some(path) = arguments.text("brief") {
        return brief::run(arguments, &fleet, (first, missions), path);
    }
    let faults = arguments.text("faults");
    let intensity = arguments.text("intensity").unwrap_or_default();
    let pairs = arguments.flag("pairs");
    let flight = Flight {
        fleet,
        list: RunList::new((first, missions), faults, intensity, pairs)?,
        doublecheck: arguments.flag("doublecheck"),
    };
    if arguments.flag("shard") {
        return shard::run(arguments, COMMAND.options, &flight);
    }
    if arguments.flag("shards-dir") {
        return Err(Failure::option(
            "shards-dir",
            "is the folder of --shard I/N: give which part to fly",
        ));
    }
    whole::run(arguments, &flight)
}
