//! The answers of `campaign` on its command line.

use crate::program;
use std::process::Command;

#[test]
fn one_run_leaves_the_page_that_replays_it_and_two_are_refused() {
    let Some(program) = program("campaign") else {
        return;
    };
    let page = std::env::temp_dir().join(format!("auv-{}-replay.html", std::process::id()));
    let campaign = |arguments: &[&str]| {
        let mut command = Command::new(&program);
        command.args(arguments).arg("--replay").arg(&page);
        command.output().unwrap()
    };
    let refused = campaign(&["--missions", "2"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("give --missions 1"));
    assert!(!page.exists());
    for faults in [
        &[][..],
        &["--faults", "sudden-obstacle", "--intensity", "1"],
    ] {
        let mut arguments = vec!["--missions", "1"];
        arguments.extend(faults);
        assert!(campaign(&arguments).status.success());
        let text = std::fs::read_to_string(&page).unwrap();
        assert_eq!(text.contains("Faults: sudden-obstacle"), !faults.is_empty());
        assert!(text.contains("</html>"));
        std::fs::remove_file(&page).unwrap();
    }
}

#[test]
fn a_brief_is_one_page_and_its_numbers() {
    let Some(program) = program("campaign") else {
        return;
    };
    let folder = std::env::temp_dir().join(format!("auv-brief-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    let document = include_str!("../../../docs/mission-file.md");
    let least = document.split("```toml\n").nth(1).unwrap();
    let (file, page) = (folder.join("small.toml"), folder.join("brief.html"));
    std::fs::write(&file, least.split("```").next().unwrap()).unwrap();
    let campaign = |arguments: &[&str]| {
        let mut command = Command::new(&program);
        command.args(["--missions", "3"]).args(arguments);
        command.arg("--brief").arg(&page).output().unwrap()
    };
    let refused = campaign(&[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("give --mission FILE"));
    let path = file.display().to_string();
    let flown = campaign(&["--mission", &path, "--json"]);
    assert!(flown.status.success(), "{flown:?}");
    let told: serde_json::Value = serde_json::from_slice(&flown.stdout).unwrap();
    let home = told["p_home"].as_array().unwrap();
    assert!(home.len() == 3 && home[0].as_f64() == Some(1.0), "{told}");
    // Three of three: the lower end is 0.025 to the power of a third.
    assert!((home[1].as_f64().unwrap() - 0.292_4).abs() < 1e-4, "{told}");
    assert_eq!(told["tasks"][0]["name"], "profile");
    // The budget is shorter than an hour.
    let less = &told["what_if"][0];
    assert!(
        less["change"] == "one hour less" && less["p_home"][0] == 0.0,
        "{told}"
    );
    assert_eq!(less["lost"][0], "profile");
    let command = told["worst"][2]["command"].as_str().unwrap();
    assert!(
        command.starts_with("mission --mission ") && command.contains("--seed "),
        "{told}"
    );
    let html = std::fs::read_to_string(&page).unwrap();
    assert!(html.contains("two stations") && html.matches("<svg").count() == 2);
    assert!(!html.contains("src=") && !html.contains("href="), "{html}");
    std::fs::remove_dir_all(folder).unwrap();
}
