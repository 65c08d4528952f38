//! E6: Table 2, one mission call by call.

use crate::missions::{CONFIGURATION, campaign, fly};
use crate::output::{Output, Section, internal, spread};
use auv_examples::Failure;
use auv_report::{MissionPicture, Table, mission_svg, path_table, route_table};
use auv_sim::MissionOutcome;

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
    section.table(&table);
    section.say(
        "A. Route calls, ours (both weights: of the planned route, and of what is done with it):",
    );
    section.table(&routes);
    section.say("B. Path calls, ours (one row a leg; \"paths replanned\" counts path calls in the middle of it):");
    section.table(&paths);
    section.say("A. Route calls, published:");
    section.table(&published_routes());
    section.say("B. Path calls, published:");
    section.table(&published_legs());
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

fn published(headings: &str, rows: &[&str]) -> Table {
    let mut table = Table::new(headings.split('|'));
    for row in rows {
        table.row(row.split('|'));
    }
    table
}

fn published_routes() -> Table {
    published(
        "call|start|dest|tasks|weight|cost|CPU|T_available|T_route|valid|route",
        &[
            "1|1|50|8|22|0.048|17.3|10800|10262|Yes|1-39-7-16-48-33-40-38-50",
            "2|7|50|10|34|0.030|23.9|7710.8|7805|Yes|7-41-14-12-36-48-22-15-47-40-50",
            "3|12|50|7|38|0.024|21.9|5375.3|5211|Yes|12-4-39-44-30-28-11-50",
            "4|4|50|5|44|0.040|19.8|4234.7|3998|Yes|4-41-12-44-11-50",
            "5|41|50|5|36|0.029|18.4|3474.7|3468|Yes|41-46-3-44-17-50",
            "6|3|50|4|38|0.078|20.7|2117.3|2008|Yes|3-29-30-42-50",
            "7|30|50|2|35|0.477|21.8|1054.5|1051|Yes|30-42-50",
        ],
    )
}

/// Part B of Table 2 as printed.
const PUBLISHED_LEGS: [&str; 13] = [
    "1|1|1-39|0.000000|0.2260|47.3|2333.1|2535.3|8466.7|0|1",
    "1|2|39-7|0.000043|0.7010|39.8|755.8|666.6|7710.8|1|0",
    "2|1|7-41|0.000000|0.1460|42.4|501.4|508.3|7209.4|0|1",
    "2|2|41-14|0.000000|0.3170|40.0|1078|1179|6131.4|0|1",
    "2|3|14-12|0.000000|0.2260|42.3|756.1|686.6|5375.3|1|0",
    "3|1|12-4|0.000000|0.2790|40.9|1140.6|528.3|4234.7|1|0",
    "4|1|4-41|0.000000|0.2020|37.4|760.02|696.8|3474.7|1|0",
    "5|1|41-46|0.000000|0.2017|40.6|674.5|820.6|2800.2|0|1",
    "5|2|46-3|0.000000|0.2037|44.1|682.8|647.8|2117.3|1|0",
    "6|1|3-29|0.000000|0.1600|39.8|567.2|857.6|1550.1|0|1",
    "6|2|29-30|0.000000|0.1460|43.4|495.5|334.8|1054.5|1|0",
    "7|1|30-42|0.000000|0.1420|39.7|479.04|482.1|575.4|0|0",
    "7|2|42-50|0.000000|0.1370|40.1|563.7|569.3|11.7|0|0",
];

/// Flight time and expected time of the legs of Table 2, seconds.
pub(crate) fn published_times_s() -> impl Iterator<Item = (f64, f64)> {
    let cell = |text: Option<&str>| text.and_then(|text| text.parse().ok()).unwrap_or(f64::NAN);
    PUBLISHED_LEGS.iter().map(move |row| {
        let mut cells = row.split('|').skip(6);
        (cell(cells.next()), cell(cells.next()))
    })
}

fn published_legs() -> Table {
    published(
        "route|call|edge|violation|cost|CPU|T_path-flight|T_expected|T_available|replan|LPP",
        &PUBLISHED_LEGS,
    )
}
