//! E6: Table 2, one mission call by call.

use crate::missions::{CONFIGURATION, campaign, fly};
use crate::output::{Output, Section, internal, spread};
use crate::published;
use auv_examples::Failure;
use auv_report::{MissionPicture, Table, mission_svg, path_table, route_table};
use auv_sim::{MissionOutcome, Summary};

pub(crate) fn table2(output: &Output) -> Result<Vec<Section>, Failure> {
    let scenario = campaign(output)?.scenario(0).map_err(internal)?;
    let mut picture = MissionPicture::new();
    picture.note("The mission of our Table 2: the paper's planners and synchroniser in our sea.");
    let summary = fly(&scenario, &mut picture)?;
    output.write("table2-mission.svg", &mission_svg(&picture))?;
    let routes = route_table(&scenario.mission, &summary.route_calls);
    let paths = path_table(&scenario.mission, &summary.path_calls);
    output.write("table2-routes.csv", &routes.to_csv())?;
    output.write("table2-paths.csv", &paths.to_csv())?;

    let mut section = Section::new("Table 2: one mission, call by call");
    section.show("table2-mission.svg", "The mission of Table 2");
    section.say(format!(
        "Configuration: {CONFIGURATION}. Waypoints here count from 0 (the paper: from 1)."
    ));
    section.table(&overview(&summary));
    section.say(
        "A. Route calls, ours (both weights: of the planned route, and of what is done with it):",
    );
    section.table(&routes);
    section.say("B. Path calls, ours (one row a leg; \"paths replanned\" counts path calls in the middle of it):");
    section.table(&paths);
    section.say("A. Route calls, published:");
    section.table(&published::routes());
    section.say("B. Path calls, published:");
    section.table(&published::legs());
    section.say("In the published tables call 2 is called valid although its 7805 s exceed the 7710.8 s available, the costs of legs 1 and 2 look swapped, and the LPP \
                 flag of leg 30-42 is 0 although the LPP runs next. The replay of these decisions is a test of the synchroniser's crate.");
    let judgement = &summary.judgement;
    section.claim(
        "the vehicle reaches its destination within the time available, safely",
        summary.outcome == MissionOutcome::Docked,
        format!(
            "{} with {:.1} s left, {} true collisions, least true clearance {:.1} m",
            summary.outcome, summary.remaining_s, judgement.collisions, judgement.min_clearance_m
        ),
    );
    section.claim(
        "the remaining time approaches zero",
        summary.remaining_s >= 0.0 && summary.remaining_s < 0.05 * scenario.mission.budget_s,
        format!(
            "{:.1} s of {:.0} s remain ({:.2} %; published 0.11 %)",
            summary.remaining_s,
            scenario.mission.budget_s,
            100.0 * summary.remaining_s / scenario.mission.budget_s
        ),
    );
    Ok(vec![section])
}

fn overview(summary: &Summary) -> Table {
    let mut table = Table::new(["", "paper", "ours"]);
    let replans = summary.path_calls.iter().filter(|leg| leg.replan).count();
    let cpu = |values: Vec<f64>| spread(&values, 4);
    for (name, published, ours) in [
        ("outcome", "success", summary.outcome.to_string()),
        ("route calls", "7", summary.route_calls.len().to_string()),
        (
            "path calls (legs)",
            "13",
            summary.path_calls.len().to_string(),
        ),
        ("replans", "6", replans.to_string()),
        (
            "mission time (s)",
            "10788.3",
            format!("{:.1}", summary.time_s),
        ),
        (
            "remaining time (s)",
            "11.7",
            format!("{:.1}", summary.remaining_s),
        ),
        ("tasks done", "13", summary.tasks.to_string()),
        (
            "mission weight",
            "38",
            format!("{:.1}", summary.mission_weight),
        ),
        (
            "total cost",
            "0.038",
            "- (no formula of the paper gives the published value)".into(),
        ),
        (
            "CPU of a route call (s)",
            "17.3 to 23.9",
            cpu(summary.route_calls.iter().map(|c| c.compute_s).collect()),
        ),
        (
            "CPU of a leg's path calls (s)",
            "37.4 to 47.3",
            cpu(summary.path_calls.iter().map(|c| c.compute_s).collect()),
        ),
    ] {
        table.row([name.to_owned(), published.to_owned(), ours]);
    }
    table
}
