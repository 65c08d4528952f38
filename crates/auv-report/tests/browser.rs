//! The replay page in a browser, where there is one.
#![allow(
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::print_stdout,
    reason = "a test that fails should say where, a skipped one that it is"
)]

use auv_mission::driver::Stepped;
use auv_planning::baseline::{GreedyRoute, StraightPath};
use auv_report::{MissionPicture, replay_html};
use auv_sim::{Campaign, simulate};
use auv_types::Seed;
use serde_json::Value;
use std::path::Path;
use std::process::Command;

/// Before anything of the page runs: keeps errors where they are found afterwards, and draws by the
/// clock, because a browser whose time is virtual draws no frames of its own.
const BEFORE: &str = r#"<head><script>
const errors = [], keep = error => { errors.push(String(error)); document.documentElement.dataset.errors = JSON.stringify(errors); };
window.onerror = (message, file, line) => keep(message + " at line " + line);
window.onunhandledrejection = event => keep(event.reason);
console.error = (...words) => keep(words.join(" "));
window.requestAnimationFrame = draw => setTimeout(() => draw(performance.now()), 16);
document.documentElement.dataset.errors = "[]";
</script>"#;

/// A page after 10 s of virtual time in a browser; `None`: there is no browser.
fn opened(name: &str, page: &str, hash: &str) -> Option<String> {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    let hands = format!("<script>{}</script></body>", include_str!("browser.js"));
    let page = page
        .replacen("<head>", BEFORE, 1)
        .replacen("</body>", &hands, 1);
    let file = folder.join("replay.html");
    std::fs::write(&file, page).unwrap();
    for browser in [
        "chromium",
        "chromium-browser",
        "google-chrome",
        "google-chrome-stable",
    ] {
        let mut command = Command::new(browser);
        command.args([
            "--headless",
            "--no-sandbox",
            "--disable-gpu",
            "--no-first-run",
            "--dump-dom",
        ]);
        command.args(["--virtual-time-budget=10000", "--window-size=1200,800"]);
        command.arg(format!(
            "--user-data-dir={}",
            folder.join("profile").display()
        ));
        command.arg(format!("file://{}{hash}", file.display()));
        if let Ok(output) = command.output() {
            let document = String::from_utf8_lossy(&output.stdout).into_owned();
            let said = String::from_utf8_lossy(&output.stderr);
            assert!(
                document.contains("<html"),
                "{browser} opened nothing: {said}"
            );
            return Some(document);
        }
    }
    println!("skipped: no chromium");
    None
}

/// What a script left in an attribute of the document.
fn left(document: &str, attribute: &str) -> Value {
    let found = document.split_once(&format!("data-{attribute}=\""));
    let (_, rest) = found.expect("the page left nothing: its scripts did not come to their end");
    let text = rest.split('"').next().unwrap().replace("&quot;", "\"");
    serde_json::from_str(&text).unwrap()
}

#[test]
fn the_replay_opens_scrubs_plays_and_turns_without_an_error() {
    let mut campaign = Campaign::table2(Seed(1)).unwrap();
    campaign.obstacles = 12;
    let scenario = campaign.scenario(0).unwrap();
    let mut picture = MissionPicture::new();
    simulate(
        &scenario,
        &Stepped::new(&GreedyRoute, &StraightPath),
        &mut picture,
    )
    .unwrap();
    let Some(document) = opened("replay", &replay_html(&picture), "#t=600") else {
        return;
    };
    assert_eq!(left(&document, "errors"), serde_json::json!([]));
    let seen = left(&document, "seen");
    let time = |name: &str| seen[name]["time"].as_f64().unwrap();
    let clock = |name: &str| seen[name]["clock"].as_str().unwrap().to_owned();
    let end_s = seen["end"].as_f64().unwrap();
    assert!(end_s > 1800.0, "{seen}");
    assert_eq!(seen["opened"]["time"], 600, "{seen}");
    assert!((time("scrubbed") - 0.5 * end_s).abs() <= 0.5, "{seen}");
    assert!(time("playing") > time("scrubbed"), "{seen}");
    assert_eq!(seen["playing"]["label"], "Pause");
    assert_eq!(seen["paused"]["label"], "Play");
    assert_eq!(seen["paused"], seen["still"]);
    assert!(clock("opened").starts_with("0:10:00"), "{seen}");
    assert_ne!(clock("scrubbed"), clock("paused"));
    // Opened, scrubbed, played and in three dimensions the map shows something else each time.
    assert!(seen["pictures"].as_u64().unwrap() >= 4, "{seen}");
}

#[test]
fn the_page_of_no_mission_has_no_errors_either() {
    if let Some(document) = opened("empty", &replay_html(&MissionPicture::new()), "") {
        assert_eq!(left(&document, "errors"), serde_json::json!([]));
    }
}
