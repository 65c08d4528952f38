//! What decides the lines of a sharded campaign, in a file beside its parts.

use crate::digest::{program_sha256, sha256};
use crate::flight::Flight;
use crate::origin::{Origin, shell_word};
use crate::run_list::RunList;
use auv_examples::{Arguments, Failure, Opt, read_file};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::path::Path;

/// The form of the manifest.
const FORM: u32 = 1;
/// What a flag is in the manifest.
const GIVEN: &str = "yes";
/// Most bytes of a manifest or seal.
pub(crate) const MOST_BYTES: usize = 1 << 20;
/// The options that change no line. Every other option is in the manifest, a later one too.
const CHANGES_NO_LINE: [&str; 9] = [
    "help",
    "json",
    "merge",
    "out",
    "replay",
    "shard",
    "shards-dir",
    "table",
    "threads",
];
/// The options with a place of their own in the manifest.
const OWN_PLACE: [&str; 4] = ["seed", "first", "missions", "faults"];

/// Everything that decides the lines of a campaign and its division into parts.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct Manifest {
    campaign_manifest: u32,
    version: String,
    /// The hash of the program that flew: two builds of one version may answer differently.
    binary_sha256: String,
    seed: u64,
    first: u64,
    missions: u64,
    pub(crate) shards: u64,
    /// Lines of all parts: missions, times kinds of faults.
    runs: u64,
    faults: Option<String>,
    /// Every other option that may change a line, with its value.
    options: BTreeMap<String, String>,
    files: Vec<InputFile>,
    obstacles: Option<usize>,
    reserve_s: f64,
}

/// A file that was read. Its name may differ from machine to machine; its contents may not.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct InputFile {
    option: String,
    file: String,
    sha256: String,
}

impl Manifest {
    /// The manifest of a campaign in `shards` parts.
    pub(crate) fn of(
        arguments: &Arguments,
        options: &[Opt],
        flight: &Flight,
        shards: u64,
    ) -> Result<Self, Failure> {
        let read = flight.fleet.files();
        let is_file = |name: &str| read.iter().any(|(option, _, _)| option == name);
        let mut others = BTreeMap::new();
        for option in options {
            let name = option.name;
            if CHANGES_NO_LINE.contains(&name) || OWN_PLACE.contains(&name) || is_file(name) {
                continue;
            }
            let value = match arguments.text(name) {
                Some("") => GIVEN,
                Some(value) => value,
                None => continue,
            };
            others.insert(name.to_owned(), value.to_owned());
        }
        Ok(Self {
            campaign_manifest: FORM,
            version: env!("CARGO_PKG_VERSION").into(),
            binary_sha256: program_sha256()?,
            seed: arguments.seed()?.0,
            first: flight.list.first(),
            missions: flight.list.missions(),
            shards,
            runs: flight.list.total(),
            faults: arguments.text("faults").map(str::to_owned),
            options: others,
            files: read
                .iter()
                .map(|(option, path, bytes)| InputFile {
                    option: option.clone(),
                    file: (*path).to_owned(),
                    sha256: sha256(bytes),
                })
                .collect(),
            obstacles: flight.fleet.obstacles(),
            reserve_s: flight.fleet.reserve_s(),
        })
    }

    /// Reads a manifest and the list of its runs.
    ///
    /// # Errors
    /// A file that cannot be read or is not a manifest of this version.
    pub(crate) fn read(path: &Path) -> Result<(Self, RunList), Failure> {
        let path = path.display().to_string();
        let bytes = read_file(&path, MOST_BYTES)?;
        let manifest: Self = serde_json::from_slice(&bytes).map_err(|error| {
            let text = format!(
                "is not a manifest of a campaign ({error}): give the folder of --shards-dir"
            );
            Failure::file(&path, text)
        })?;
        manifest
            .check_version()
            .map_err(|error| Failure::file(&path, error))?;
        let list = manifest
            .list()
            .map_err(|error| Failure::file(&path, error))?;
        if manifest.runs != list.total() || manifest.shards == 0 {
            let text = format!(
                "says {} runs in {} parts and should say {} runs: it was changed; fly the parts again in an empty folder",
                manifest.runs,
                manifest.shards,
                list.total()
            );
            return Err(Failure::file(&path, text));
        }
        Ok((manifest, list))
    }

    fn check_version(&self) -> Result<(), String> {
        let own = env!("CARGO_PKG_VERSION");
        if self.campaign_manifest == FORM && self.version == own {
            return Ok(());
        }
        Err(format!(
            "is of version {}, this program of version {own}: use the program that flew the parts, or fly them \
             again in an empty folder",
            self.version
        ))
    }

    fn list(&self) -> Result<RunList, Failure> {
        let intensity = self.options.get("intensity").map_or("", String::as_str);
        let pairs = self.options.contains_key("pairs");
        let numbers = (self.first, self.missions);
        RunList::new(numbers, self.faults.as_deref(), intensity, pairs)
    }

    /// The file's text.
    pub(crate) fn to_text(&self) -> Result<String, Failure> {
        let text = serde_json::to_string_pretty(self);
        text.map(|text| text + "\n")
            .map_err(|error| Failure::Internal(format!("no JSON of the manifest: {error}")))
    }

    /// How this manifest differs from another: `WHAT is A here and B there`; empty if lines and parts are
    /// the same.
    pub(crate) fn differences(&self, other: &Self) -> String {
        let mut found = Vec::new();
        let mut compare = |what: &str, here: String, there: String| {
            if here != there {
                found.push(format!("{what} is {here} here and {there} there"));
            }
        };
        let none = || "none".to_owned();
        compare("version", self.version.clone(), other.version.clone());
        let sha = |manifest: &Self| format!("sha256 {}", manifest.binary_sha256);
        compare("binary", sha(self), sha(other));
        compare("seed", self.seed.to_string(), other.seed.to_string());
        compare("first", self.first.to_string(), other.first.to_string());
        compare(
            "missions",
            self.missions.to_string(),
            other.missions.to_string(),
        );
        compare(
            "the number of parts",
            self.shards.to_string(),
            other.shards.to_string(),
        );
        let faults = |manifest: &Self| manifest.faults.clone().unwrap_or_else(none);
        compare("faults", faults(self), faults(other));
        for name in self.options.keys().chain(other.options.keys()) {
            let value = |manifest: &Self| manifest.options.get(name).cloned().unwrap_or_else(none);
            compare(name, value(self), value(other));
        }
        let files = self.files.iter().chain(&other.files);
        for option in files.map(|file| &file.option) {
            let sha = |manifest: &Self| manifest.file(option).map(|file| file.sha256.clone());
            if sha(self) != sha(other) {
                let (here, there) = (self.shown(option), other.shown(option));
                found.push(format!("{option} file is {here} here and {there} there"));
            }
        }
        let mut listed: Vec<String> = Vec::new();
        for text in found {
            if !listed.contains(&text) {
                listed.push(text);
            }
        }
        // What follows from the above.
        if listed.is_empty() && self.derived() != other.derived() {
            let (here, there) = (self.derived(), other.derived());
            listed.push(format!(
                "runs, obstacles, reserve are {here:?} here and {there:?} there"
            ));
        }
        listed.join("; ")
    }

    const fn derived(&self) -> (u64, Option<usize>, f64) {
        (self.runs, self.obstacles, self.reserve_s)
    }

    fn file(&self, option: &str) -> Option<&InputFile> {
        self.files.iter().find(|file| file.option == option)
    }

    /// A file by its option, for messages.
    fn shown(&self, option: &str) -> String {
        self.file(option).map_or("none".into(), |file| {
            format!("{} (sha256 {})", file.file, file.sha256)
        })
    }

    pub(crate) fn origin(&self) -> Origin {
        let files = self.files.iter();
        Origin::new(self.seed, files.map(|file| (&*file.option, &*file.file)))
    }

    /// Obstacles in each sea and the reserve in seconds, for the summary.
    pub(crate) const fn sea(&self) -> (Option<usize>, f64) {
        (self.obstacles, self.reserve_s)
    }

    /// The runs of a part: parts differ by one run at most.
    pub(crate) fn runs_of(&self, shard: u64) -> std::ops::Range<u64> {
        let from = |shard: u64| {
            let run = u128::from(self.runs) * u128::from(shard) / u128::from(self.shards.max(1));
            run as u64
        };
        from(shard)..from(shard + 1)
    }

    /// The command that flies a part.
    pub(crate) fn command(&self, shard: u64, folder: &Path, options: &[Opt]) -> String {
        let mut words = vec![
            "campaign".to_owned(),
            format!("--seed {}", self.seed),
            format!("--first {}", self.first),
            format!("--missions {}", self.missions),
        ];
        words.extend(
            self.faults
                .iter()
                .map(|faults| format!("--faults {}", shell_word(faults))),
        );
        for (name, value) in &self.options {
            let declared = options.iter().find(|option| option.name == name);
            match declared {
                Some(option) if option.default == value => {}
                Some(option) if option.value.is_empty() => words.push(format!("--{name}")),
                _ => words.push(format!("--{name} {}", shell_word(value))),
            }
        }
        let files = self.files.iter();
        words.extend(files.map(|file| format!("--{} {}", file.option, shell_word(&file.file))));
        let folder = shell_word(&folder.display().to_string());
        words.push(format!(
            "--shard {shard}/{} --shards-dir {folder}",
            self.shards
        ));
        words.join(" ")
    }
}
