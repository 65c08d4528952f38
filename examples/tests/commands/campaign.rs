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
