//! `campaign --shard` and `--merge`: parts joined, and parts refused by name.

use crate::program;
use serde_json::{Value, json};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

const MISSION: &str = r#"
version = 1
name = "two stations"
preset = "paper"
budget_s = 2000.0
start = "boat"
destination = "dock"
waypoints = [
    { name = "boat", at = [0, 0, 20] },
    { name = "station", at = [900, 300, 20], task = "profile" },
    { name = "dock", at = [1800, 0, 20] },
]
tasks.profile = { priority = 6, risk = 2, time_s = 60 }
connect.nearest = 2
"#;

/// The program, a folder of the test's own, and a mission file in it.
struct Study {
    program: PathBuf,
    folder: PathBuf,
}

impl Study {
    fn new(name: &str) -> Option<Self> {
        let program = program("campaign")?;
        let folder = std::env::temp_dir().join(format!("auv-{}-{name}", std::process::id()));
        let _ = fs::remove_dir_all(&folder);
        fs::create_dir_all(&folder).unwrap();
        fs::write(folder.join("mission.toml"), MISSION).unwrap();
        Some(Self { program, folder })
    }

    fn campaign(&self, line: &str) -> Command {
        let mut command = Command::new(&self.program);
        command.args(line.split_whitespace());
        command.current_dir(&self.folder);
        command
    }

    fn run(&self, line: &str) -> Output {
        self.campaign(line).output().unwrap()
    }

    fn answer(&self, line: &str) -> String {
        let output = self.run(line);
        let error = String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{line}: {error}");
        String::from_utf8(output.stdout).unwrap()
    }

    fn refusal(&self, line: &str) -> String {
        let output = self.run(line);
        assert_eq!(output.status.code(), Some(2), "{line}");
        assert!(output.stdout.is_empty(), "{line}");
        String::from_utf8(output.stderr).unwrap()
    }

    fn fly(&self, options: &str, shards: u64, parts: &str) {
        for shard in 0..shards {
            self.answer(&format!(
                "{options} --shard {shard}/{shards} --shards-dir {parts}"
            ));
        }
    }

    fn read(&self, path: &str) -> Vec<u8> {
        fs::read(self.folder.join(path)).unwrap()
    }

    /// Changes a JSON file in the folder.
    fn change(&self, path: &str, change: impl FnOnce(&mut Value)) {
        let mut value: Value = serde_json::from_slice(&self.read(path)).unwrap();
        change(&mut value);
        fs::write(self.folder.join(path), value.to_string()).unwrap();
    }

    fn copy(&self, from: &str, to: &str) {
        fs::copy(self.folder.join(from), self.folder.join(to)).unwrap();
    }

    /// The parts of seven missions of the file, afresh.
    fn seven_missions(&self) {
        let _ = fs::remove_dir_all(self.folder.join("parts"));
        self.fly("--mission mission.toml --missions 7", 3, "parts");
    }

    /// The program's words of the command that a refusal names.
    fn named_command(refusal: &str) -> String {
        let at = refusal.find("fly it with: campaign ").unwrap();
        let line = refusal[at..].lines().next().unwrap();
        line.replace("fly it with: campaign ", "")
    }
}

impl Drop for Study {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.folder);
    }
}

#[test]
fn joined_parts_equal_one_process_and_give_its_summary() {
    let Some(study) = Study::new("joined") else {
        return;
    };
    for (i, options) in [
        "--missions 3 --first 4 --seed 9",
        "--mission mission.toml --missions 5 --seed 18446744073709551614",
        "--missions 1 --faults damaged-file,disconnected --intensity 2,3",
        "--missions 0",
    ]
    .into_iter()
    .enumerate()
    {
        let (one, parts) = (format!("one{i}.jsonl"), format!("parts{i}"));
        let summary = study.answer(&format!("{options} --json --out {one}"));
        let text = study.answer(options);
        assert!(serde_json::from_str::<Value>(&text).is_err(), "{text}");
        study.fly(options, 4, &parts);
        assert_eq!(study.answer(&format!("--merge {parts} --json")), summary);
        assert_eq!(study.answer(&format!("--merge {parts}")), text);
        assert_eq!(
            study.read(&format!("{parts}/campaign.jsonl")),
            study.read(&one)
        );
    }
}

#[test]
fn a_folder_begun_otherwise_is_refused_by_what_differs() {
    let Some(study) = Study::new("begun") else {
        return;
    };
    fs::write(
        study.folder.join("other.toml"),
        MISSION.replace("time_s = 60", "time_s = 61"),
    )
    .unwrap();
    let begun = "--mission mission.toml --missions 2";
    study.answer(&format!("{begun} --shard 0/2 --shards-dir parts"));
    let refused = [
        (format!("{begun} --seed 1 --shard 1/2"), "seed is 1"),
        (format!("{begun} --first 1 --shard 1/2"), "first is 1"),
        (format!("{begun}0 --shard 1/2"), "missions is 20"),
        (format!("{begun} --shard 1/3"), "the number of parts is 3"),
        (format!("{begun} --doublecheck --shard 1/2"), "doublecheck"),
        (
            "--missions 2 --shard 1/2".into(),
            "mission file is none here",
        ),
        (
            "--mission other.toml --missions 2 --shard 1/2".into(),
            "mission file is other.toml (sha256",
        ),
    ];
    for (line, what) in refused {
        let refusal = study.refusal(&format!("{line} --shards-dir parts"));
        assert!(
            refusal.contains(what) && refusal.contains("manifest.json"),
            "{refusal}"
        );
    }
    study.change("parts/manifest.json", |manifest| {
        manifest["version"] = json!("0.0.9");
    });
    let refusal = study.refusal(&format!("{begun} --shard 1/2 --shards-dir parts"));
    assert!(refusal.contains("version 0.0.9"), "{refusal}");
    // A file under another name is the same file.
    study.copy("mission.toml", "same.toml");
    study.answer("--mission same.toml --missions 2 --shard 0/2 --shards-dir parts2");
    study.answer(&format!("{begun} --shard 1/2 --shards-dir parts2"));
    study.answer("--merge parts2");
}

#[test]
fn parts_that_are_wrong_are_named_with_the_command_that_mends_them() {
    let Some(study) = Study::new("wrong") else {
        return;
    };
    study.fly("--mission mission.toml --missions 7 --seed 1", 3, "other");
    type Spoil = fn(&Study);
    let spoils: [(&str, &str, Spoil); 8] = [
        ("part-000001.jsonl is missing", "1/3", |study| {
            fs::remove_file(study.folder.join("parts/part-000001.jsonl")).unwrap();
        }),
        ("part-000001.jsonl line 1 is mission 0", "1/3", |study| {
            study.copy("parts/part-000000.jsonl", "parts/part-000001.jsonl");
        }),
        ("part-000002.jsonl has 2 lines", "2/3", |study| {
            let text = study.read("parts/part-000002.jsonl");
            let end = text[..text.len() - 1].iter().rposition(|&b| b == b'\n');
            let path = study.folder.join("parts/part-000002.jsonl");
            fs::write(path, &text[..=end.unwrap()]).unwrap();
        }),
        ("part-000002.jsonl line 3 is cut short", "2/3", |study| {
            let text = study.read("parts/part-000002.jsonl");
            let path = study.folder.join("parts/part-000002.jsonl");
            fs::write(path, &text[..text.len() - 1]).unwrap();
        }),
        ("part-000000.jsonl line 1 has seed 1", "0/3", |study| {
            study.copy("other/part-000000.jsonl", "parts/part-000000.jsonl");
        }),
        ("seed is 1 here and 0 there", "0/3", |study| {
            study.copy("other/part-000000.jsonl", "parts/part-000000.jsonl");
            study.copy("other/part-000000.seal.json", "parts/part-000000.seal.json");
        }),
        ("part-000000.jsonl was changed", "0/3", |study| {
            let text = String::from_utf8(study.read("parts/part-000000.jsonl")).unwrap();
            let path = study.folder.join("parts/part-000000.jsonl");
            fs::write(path, text.replacen("\"tasks\":", "\"tasks\":1", 1)).unwrap();
        }),
        (
            "its seal part-000001.seal.json is missing",
            "1/3",
            |study| {
                fs::remove_file(study.folder.join("parts/part-000001.seal.json")).unwrap();
            },
        ),
    ];
    study.seven_missions();
    study.answer("--merge parts");
    let whole = study.read("parts/campaign.jsonl");
    for (what, part, spoil) in spoils {
        fs::remove_file(study.folder.join("parts/campaign.jsonl")).unwrap();
        spoil(&study);
        let refusal = study.refusal("--merge parts");
        assert!(refusal.contains(what), "{what}: {refusal}");
        assert!(!study.folder.join("parts/campaign.jsonl").exists());
        let command = Study::named_command(&refusal);
        assert!(
            command.contains(&format!("--shard {part} --shards-dir parts")),
            "{command}"
        );
        study.answer(&command);
        study.answer("--merge parts");
        assert_eq!(study.read("parts/campaign.jsonl"), whole, "{what}");
    }
    for name in ["part-000003.jsonl", "part-1.jsonl", "part-000001 (2).jsonl"] {
        study.copy("parts/part-000001.jsonl", &format!("parts/{name}"));
        let refusal = study.refusal("--merge parts");
        assert!(
            refusal.contains(name) && refusal.contains("0 to 2"),
            "{refusal}"
        );
        fs::remove_file(study.folder.join("parts").join(name)).unwrap();
    }
}

#[test]
fn a_manifest_that_was_changed_is_refused() {
    let Some(study) = Study::new("manifest") else {
        return;
    };
    study.seven_missions();
    let original = study.read("parts/manifest.json");
    type Change = fn(&mut Value);
    let changes: [(&str, Change); 9] = [
        ("seed is 0", |manifest| manifest["seed"] = json!(1)),
        ("version 9.9.9", |manifest| {
            manifest["version"] = json!("9.9.9");
        }),
        ("binary is sha256", |manifest| {
            manifest["binary_sha256"] = json!("0".repeat(64));
        }),
        ("mission file is mission.toml (sha256", |manifest| {
            manifest["files"][0]["sha256"] = json!("0".repeat(64));
        }),
        ("mission file is", |manifest| manifest["files"] = json!([])),
        ("8 runs", |manifest| manifest["runs"] = json!(8)),
        ("first is 0", |manifest| manifest["first"] = json!(1)),
        ("parts is 3", |manifest| manifest["shards"] = json!(2)),
        ("unknown field `sea`", |manifest| manifest["sea"] = json!(1)),
    ];
    for (what, change) in changes {
        study.change("parts/manifest.json", change);
        let refusal = study.refusal("--merge parts");
        assert!(refusal.contains(what), "{what}: {refusal}");
        fs::write(study.folder.join("parts/manifest.json"), &original).unwrap();
    }
    study.answer("--merge parts");
    fs::remove_file(study.folder.join("parts/manifest.json")).unwrap();
    assert!(study.refusal("--merge parts").contains("manifest.json"));
    assert!(study.refusal("--merge parts --seed 1").contains("--seed"));
    for shard in ["3/3", "1", "-1/3", "0/0", "0/1000001", "a/b"] {
        let line = format!("--missions 1 --shard {shard} --shards-dir fresh");
        assert!(study.refusal(&line).contains("give I/N"), "{shard}");
    }
    let alone = study.refusal("--missions 1 --shard 0/1");
    assert!(alone.contains("--shards-dir DIR"), "{alone}");
    let alone = study.refusal("--missions 1 --shards-dir fresh");
    assert!(alone.contains("--shard I/N"), "{alone}");
    let out = study.refusal("--missions 1 --shard 0/1 --shards-dir fresh --out a.jsonl");
    assert!(out.contains("--out"), "{out}");
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let name = |entry: fs::DirEntry| entry.file_name().into_string().unwrap();
    entries.map(name).collect()
}

#[test]
fn a_killed_part_leaves_a_temporary_name_and_the_next_run_flies_what_is_missing() {
    let Some(study) = Study::new("killed") else {
        return;
    };
    let options = "--mission mission.toml --missions 40000 --seed 3";
    let parts = study.folder.join("parts");
    let mut killed = study.campaign(&format!("{options} --shard 0/2 --shards-dir parts"));
    let mut killed = killed.stdout(Stdio::null()).spawn().unwrap();
    let has_begun = || names(&parts).iter().any(|n| n.starts_with("part-"));
    while !has_begun() {
        std::thread::yield_now();
    }
    killed.kill().unwrap();
    killed.wait().unwrap();
    let left = names(&parts);
    assert!(
        left.iter()
            .all(|n| n == "manifest.json" || n.contains(".tmp-"))
    );
    assert!(left.iter().any(|n| n.starts_with("part-000000.jsonl.tmp-")));

    let options = "--mission mission.toml --missions 4";
    study.fly(options, 2, "small");
    study.copy("mission.toml", "small/part-000001.jsonl.tmp-1-0");
    let flown_at = || {
        let part = study.folder.join("small/part-000000.jsonl");
        fs::metadata(part).unwrap().modified().unwrap()
    };
    let before = flown_at();
    let again = format!("{options} --shard 0/2 --shards-dir small");
    let output = study.run(&again);
    assert!(String::from_utf8_lossy(&output.stderr).contains("not flown again"));
    assert_eq!(flown_at(), before);
    fs::write(study.folder.join("small/part-000000.jsonl"), "{}\n").unwrap();
    let output = study.run(&again);
    assert!(String::from_utf8_lossy(&output.stderr).contains("it is flown again"));
    study.answer("--merge small");
    let left = names(&study.folder.join("small"));
    assert!(left.iter().all(|n| !n.contains(".tmp-")), "{left:?}");
}
