//! The paper's tables and figures, with our values beside the published ones:
//! `cargo run --release --example paper -- all --out docs/paper`.

mod curves;
mod missions;
mod output;
mod published;
mod routes;
mod scenario_charts;
mod scenarios;
mod swarm_run;
mod table2;

use auv_examples::{
    Arguments, CommandLine, Failure, Operand, Opt, Pictures, note, print, print_json,
};
use output::{Output, Section};
use std::path::PathBuf;

const COMMAND: CommandLine = CommandLine {
    name: "paper",
    about: "Regenerates the tables and figures of MahmoudZadeh et al. (2016, doi 10.1007/s00500-016-2433-2): pictures (SVG)\n\
            and tables (Markdown) with the published values beside ours, and whether each claim holds here.",
    operands: &[Operand::optional(
        "WHAT",
        "curves, table1, fig11, fig12, scenarios, table2, missions or all (default: all)",
    )],
    options: &[
        Opt::value("out", "DIR", "target/paper", "where the files are written"),
        Pictures::PNG,
        Opt::value(
            "runs",
            "N",
            "30",
            "random seeds where the paper shows one run, at least 2",
        ),
    ],
    notes: "Computing times are wall times of single-threaded calls on this machine; run with --threads 1 when they matter.\n\
            Everything else depends on --seed and --runs only. Example: paper all --out docs/paper",
};

/// Runs the command line of the process.
pub fn main() -> std::process::ExitCode {
    COMMAND.run(run)
}

type Part = fn(&Output) -> Result<Vec<Section>, Failure>;

/// What can be asked for, and what makes it.
const PARTS: [(&str, Part); 7] = [
    ("curves", curves::figure2),
    ("table1", routes::table1),
    ("fig11", routes::figure11),
    ("fig12", routes::figure12),
    ("scenarios", scenarios::figures13_to_16),
    ("table2", table2::table2),
    ("missions", missions::figures17_to_19),
];

fn run(arguments: &Arguments) -> Result<(), Failure> {
    let what = arguments.operand("WHAT").unwrap_or("all");
    let chosen: Vec<_> = PARTS
        .iter()
        .filter(|(name, _)| what == "all" || what == *name)
        .collect();
    if chosen.is_empty() {
        let names: Vec<_> = PARTS.iter().map(|(name, _)| *name).collect();
        return Err(Failure::BadInput(format!(
            "WHAT is `{what}`: give one of {}, all",
            names.join(", ")
        )));
    }
    let runs: usize = arguments.number("runs")?.unwrap_or(30);
    if !(2..=10_000).contains(&runs) {
        return Err(Failure::option(
            "runs",
            format!("is {runs}; give 2 to 10000"),
        ));
    }
    let output = Output {
        folder: PathBuf::from(arguments.text("out").unwrap_or("target/paper")),
        pictures: Pictures::asked(arguments)?,
        workers: arguments.workers()?,
        seed: arguments.seed()?,
        runs,
    };
    let mut sections = Vec::new();
    for (name, make) in chosen {
        note(&format!("{name} ..."));
        let made = make(&output)?;
        let mut page = String::new();
        for section in &made {
            page += &section.to_markdown();
        }
        output.write(&format!("{name}.md"), &page)?;
        sections.extend(made.into_iter().map(|section| (*name, section)));
    }
    if what == "all" {
        output.write("README.md", &overview(&output, &sections))?;
    }
    let claims: Vec<_> = sections
        .iter()
        .flat_map(|(_, section)| &section.claims)
        .collect();
    if arguments.json() {
        let claims: Vec<_> = claims
            .iter()
            .map(|claim| serde_json::json!({ "claim": claim.says, "holds": claim.holds, "ours": claim.ours }))
            .collect();
        return print_json(&serde_json::json!({ "out": output.folder, "claims": claims }));
    }
    let mut text = format!("written to {}\n", output.folder.display());
    for claim in claims {
        text += &format!("{:7} {}: {}\n", claim.verdict(), claim.says, claim.ours);
    }
    print(&text)
}

fn overview(output: &Output, sections: &[(&str, Section)]) -> String {
    let mut text = format!(
        "# The paper's results and ours\n\n\
         This page shows the tables and figures of MahmoudZadeh, Powers, Sammut, Yazdani, \"A Novel Versatile Architecture for \
         Autonomous Underwater Vehicle's Motion Planning and Task Assignment\" (2016, doi 10.1007/s00500-016-2433-2). It is made by\n\n\
         ```\ncargo run --release --example paper -- all\n```\n\n\
         with `--seed {}` and `--runs {}`. The paper gives no network, no obstacle and no random seed, and leaves several \
         parameters open. Networks and obstacles here are drawn from the distributions it states: compare magnitudes, not \
         single values. Published values stand as printed. The published computing times are of MATLAB R2014a on an Intel i7 \
         at 3.40 GHz, ours are of compiled code on one thread: they are not comparable.\n\n## Which claims hold here\n\n",
        output.seed.0, output.runs
    );
    let mut table = auv_report::Table::new(["claim of the paper", "here", "ours", "page"]);
    for (name, section) in sections {
        for claim in &section.claims {
            table.row([
                claim.says.clone(),
                claim.verdict().into(),
                claim.ours.clone(),
                format!("[{name}]({name}.md)"),
            ]);
        }
    }
    text += &table.to_markdown();
    for (_, section) in sections {
        text += "\n";
        text += &section.to_markdown();
    }
    text
}
