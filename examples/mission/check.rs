//! The text of a check before launch.

use auv_report::{Table, date_time};
use auv_sim::mission_file::{LaunchCheck, StopCheck};
use std::fmt::Write;

/// Width of the text.
const WIDTH: usize = 80;

/// The answer for people; times in UTC too where the launch is given so, in seconds since 1970.
pub(crate) fn text(name: &str, check: &LaunchCheck, launch_unix_s: Option<f64>) -> String {
    let verdict = if check.go { "GO" } else { "NO GO" };
    let mut text = format!("{name}: {verdict}\n");
    for problem in &check.problems {
        item(&mut text, problem);
    }
    if !check.route.is_empty() {
        let _ = write!(text, "\nRoute\n{}", route(check, launch_unix_s));
    }
    let seconds = |seconds: Option<f64>| seconds.map_or("none".into(), |s| format!("{s:.0} s"));
    let energy = check.energy_left_percent.map(|left| format!("{left:.0} %"));
    let figures = [
        (
            "left of the budget at the end",
            Some(seconds(check.margin_s)),
        ),
        ("left in the battery at the end", energy),
        (
            "home in time if launched later by",
            Some(seconds(check.latest_launch_s)),
        ),
    ];
    for (what, told) in figures {
        if let Some(told) = told {
            let _ = writeln!(text, "{what:<34} {told}");
        }
    }
    if check.latest_launch_s.is_some() && !check.tasks.is_empty() {
        text.push_str("(launched so late it leaves out tasks as necessary)\n");
    }
    let impossible: Vec<_> = check.tasks.iter().filter(|task| !task.possible).collect();
    let told = impossible.iter().map(|task| {
        let title = format!("{} at {}: ", task.name, task.at);
        let why = task.reason.as_deref().unwrap_or_default();
        let what = titled(&task.name, &task.at, task.survey.as_deref());
        (what, why.strip_prefix(&title).unwrap_or(why))
    });
    list(&mut text, "Cannot be done", told);
    let is_possible =
        |name: &str, at: &str| !impossible.iter().any(|t| t.name == name && t.at == at);
    let left_out = check.left_out.iter();
    let left_out = left_out.filter(|t| is_possible(&t.task, &t.at));
    let told = left_out.map(|left| {
        let what = titled(&left.task, &left.at, left.survey.as_deref());
        (what, left.text.as_str())
    });
    list(&mut text, "Left out", told);
    if !check.warnings.is_empty() {
        text.push_str("\nTo know\n");
    }
    for warning in &check.warnings {
        item(&mut text, warning);
    }
    text
}

/// What a task is called: a survey that is flown as a whole is one.
fn titled(task: &str, at: &str, survey: Option<&str>) -> String {
    survey.map_or_else(
        || format!("{task} at {at}"),
        |name| format!("survey {name}"),
    )
}

/// Tasks with what is said of them, those of which the same is said together.
fn list<'a>(text: &mut String, heading: &str, tasks: impl Iterator<Item = (String, &'a str)>) {
    let mut told: Vec<(&str, Vec<String>)> = Vec::new();
    for (what, why) in tasks {
        match told.iter_mut().find(|(other, _)| *other == why) {
            Some((_, names)) if names.contains(&what) => {}
            Some((_, names)) => names.push(what),
            None => told.push((why, vec![what])),
        }
    }
    if !told.is_empty() {
        let _ = write!(text, "\n{heading}\n");
    }
    for (why, names) in told {
        item(text, &format!("{}: {why}", names.join(", ")));
    }
}

fn route(check: &LaunchCheck, launch_unix_s: Option<f64>) -> Table {
    let utc = launch_unix_s.map(|_| "arrive (UTC)");
    let heads = ["place", "arrive (s)", "leave (s)"].into_iter().chain(utc);
    let mut table = Table::new(heads.chain(["work"]));
    for stop in &check.route {
        let utc = launch_unix_s
            .map(|launch_s| date_time((launch_s + stop.arrive_s).round()).replace(".000Z", "Z"));
        let cells = [
            stop.place.clone(),
            format!("{:.0}", stop.arrive_s),
            format!("{:.0}", stop.leave_s),
        ];
        table.row(cells.into_iter().chain(utc).chain([doings(stop)]));
    }
    table
}

/// Waits and fixes shorter than this are not told, seconds.
const MOMENT_S: f64 = 0.5;

/// What is done at a stop and on the way there.
fn doings(stop: &StopCheck) -> String {
    let told =
        |what: &str, takes_s: f64| (takes_s >= MOMENT_S).then(|| format!("{what} {takes_s:.0} s"));
    let before = [
        told("fix on the way", stop.fixes_s),
        told("wait", stop.waits_s),
    ];
    let all = before
        .into_iter()
        .flatten()
        .chain(stop.tasks.iter().cloned());
    all.collect::<Vec<_>>().join(", ")
}

/// A text with a dash before it, in lines of at most [`WIDTH`].
fn item(text: &mut String, item: &str) {
    let mut line = String::from(" -");
    for word in item.split_whitespace() {
        if line.chars().count() + 1 + word.chars().count() > WIDTH {
            let _ = writeln!(text, "{line}");
            line = "  ".into();
        }
        line.push(' ');
        line.push_str(word);
    }
    let _ = writeln!(text, "{line}");
}
