//! A mission file and the files beside it, as named on the command line.

use crate::{Arguments, Failure, Opt, note, read_file};
use auv_mission::driver::Stepped;
use auv_sim::mission_file::{
    DataFile, DataReport, LaunchCheck, MissionData, MissionFile, MissionFileError,
};
use auv_sim::{Body, Scenario};
use auv_types::Seed;
use std::path::Path;

/// The mission when none is given.
const HARROW_INLET: &str = include_str!("../missions/harrow_inlet.toml");
/// Most bytes of a mission file, and of a file beside it.
const MOST_TEXT: usize = 16 << 20;
const MOST_DATA: usize = 1 << 30;

/// A mission file with charts, model currents and ship tracks.
#[derive(Debug)]
pub struct MissionInput {
    /// Its name for messages.
    pub path: String,
    /// Its contents.
    pub file: MissionFile,
    text: String,
    told: std::sync::Once,
    beside: Vec<(DataFile, String, Vec<u8>)>,
}

impl MissionInput {
    /// The option that names the mission.
    pub const MISSION: Opt = Opt::value(
        "mission",
        "FILE",
        "",
        "the mission, TOML; see docs/mission-file.md (default: Harrow Inlet, embedded)",
    );
    /// The option that names the chart.
    pub const BATHYMETRY: Opt = Opt::value(
        "bathymetry",
        "FILE",
        "",
        "a chart of depths, NetCDF or GeoTIFF (default: the one the mission names, in AUV_DATA_DIR)",
    );
    /// The option that names the model's currents.
    pub const CURRENTS: Opt = Opt::value(
        "currents",
        "FILE",
        "",
        "the NetCDF file of an ocean model (default: as above)",
    );
    /// The option that names the vehicle's body.
    pub const BODY: Opt = Opt::value(
        "body",
        "NAME",
        "",
        "body of the simulated vehicle, point or remus100 (default: the one the mission says)",
    );
    /// The option that names the ships' tracks.
    pub const AIS: Opt = Opt::value(
        "ais",
        "FILE",
        "",
        "ship tracks, comma-separated (default: as above)",
    );

    /// The mission of `--mission`, else Harrow Inlet; the files beside it by their options, else by
    /// their names in the mission, below AUV_DATA_DIR.
    ///
    /// # Errors
    /// A file that cannot be read or is not a mission; a file that the mission names and that is not given.
    pub fn read(arguments: &Arguments) -> Result<Self, Failure> {
        let (path, text) = match arguments.text("mission") {
            None => ("harrow_inlet.toml (embedded)".into(), HARROW_INLET.into()),
            Some(path) => {
                let text = String::from_utf8(read_file(path, MOST_TEXT)?).map_err(|error| {
                    Failure::file(path, format!("is not UTF-8 ({error}): give TOML"))
                })?;
                (path.to_owned(), text)
            }
        };
        let file = MissionFile::from_toml(&text).map_err(|error| Failure::file(&path, error))?;
        let beside = beside(arguments, &file)?;
        Ok(Self {
            path,
            file,
            text,
            told: std::sync::Once::new(),
            beside,
        })
    }

    /// The same mission with the body of `--body`, if it is given ([`MissionInput::BODY`]).
    ///
    /// # Errors
    /// A body that there is none of.
    pub fn with_body(mut self, arguments: &Arguments) -> Result<Self, Failure> {
        if let Some(body) = Self::body(arguments)? {
            self.file = self.file.with_body(body);
        }
        Ok(self)
    }

    /// The body of `--body`, if it is given ([`MissionInput::BODY`]).
    ///
    /// # Errors
    /// A body that there is none of.
    pub fn body(arguments: &Arguments) -> Result<Option<Body>, Failure> {
        let named = |name| {
            let unknown = || Failure::option("body", "give point or remus100");
            Body::named(name).ok_or_else(unknown)
        };
        arguments.text("body").map(named).transpose()
    }

    /// The mission with everything that a seed draws. What was dropped from the files beside it or assumed
    /// of them goes to stderr.
    ///
    /// # Errors
    /// Everything that prevents the mission, with the file concerned.
    pub fn scenario(&self, seed: Seed) -> Result<Scenario, Failure> {
        let mut report = DataReport::default();
        let scenario = self.scenario_with_report(seed, &mut report)?;
        // Every seed reads the same files.
        self.told.call_once(|| {
            for warning in report.warnings() {
                note(&warning);
            }
        });
        Ok(scenario)
    }

    /// The mission, and what was read from the files beside it: also of those read before something is
    /// refused.
    ///
    /// # Errors
    /// As [`MissionInput::scenario`].
    pub fn scenario_with_report(
        &self,
        seed: Seed,
        report: &mut DataReport,
    ) -> Result<Scenario, Failure> {
        let scenario = self.file.scenario_with_report(&self.data(), seed, report);
        scenario.map_err(|error| self.failure(&error))
    }

    /// Whether the mission can be launched, and what it is expected to do; see [`MissionFile::launch_check`].
    ///
    /// # Errors
    /// What is wrong with the mission file or a file beside it.
    pub fn launch_check(&self, seed: Seed, driver: &Stepped<'_>) -> Result<LaunchCheck, Failure> {
        let mut report = DataReport::default();
        let check = self
            .file
            .launch_check(&self.data(), seed, driver, &mut report);
        check.map_err(|error| self.failure(&error))
    }

    /// Refuses a mission whose mandatory tasks cannot all be done.
    ///
    /// # Errors
    /// The first task that cannot, and those that it cannot be done with.
    pub fn require_go(&self, seed: Seed, driver: &Stepped<'_>) -> Result<(), Failure> {
        if !self.file.has_mandatory_tasks() {
            return Ok(());
        }
        let mut report = DataReport::default();
        let problems = self
            .file
            .launch_problems(&self.data(), seed, driver, &mut report);
        let problems = problems.map_err(|error| self.failure(&error))?;
        if problems.is_empty() {
            return Ok(());
        }
        Err(Failure::file(&self.path, problems.join("; ")))
    }

    fn data(&self) -> MissionData<'_> {
        let bytes = |kind| {
            let mut files = self.beside.iter();
            files
                .find(|file| file.0 == kind)
                .map(|file| file.2.as_slice())
        };
        MissionData {
            bathymetry: bytes(DataFile::Bathymetry),
            currents: bytes(DataFile::Currents),
            ais: bytes(DataFile::Ais),
        }
    }

    /// What was read: the option that names each file, its path and its contents. The mission file is
    /// the first.
    #[must_use]
    pub fn files(&self) -> Vec<(String, &str, &[u8])> {
        let mission = ("mission".to_owned(), &*self.path, self.text.as_bytes());
        let beside = self.beside.iter();
        let beside = beside.map(|(kind, path, bytes)| (kind.to_string(), &**path, &**bytes));
        std::iter::once(mission).chain(beside).collect()
    }

    /// An error about the mission, naming the file it is about.
    fn failure(&self, error: &MissionFileError) -> Failure {
        let MissionFileError::Data { file, reason } = error else {
            return Failure::file(&self.path, error);
        };
        match self.beside.iter().find(|(kind, _, _)| kind == file) {
            Some((_, path, _)) => Failure::file(path, reason),
            None => Failure::file(&self.path, format!("{reason} with --{file} FILE")),
        }
    }
}

fn beside(
    arguments: &Arguments,
    file: &MissionFile,
) -> Result<Vec<(DataFile, String, Vec<u8>)>, Failure> {
    let folder = std::env::var("AUV_DATA_DIR").ok();
    let mut beside = Vec::new();
    for (kind, named) in [
        (DataFile::Bathymetry, file.bathymetry_file()),
        (DataFile::Currents, file.currents_file()),
        (DataFile::Ais, file.ais_file()),
    ] {
        let option = kind.to_string();
        let path = match (arguments.text(&option), named, &folder) {
            (Some(path), _, _) => path.to_owned(),
            (None, Some(name), Some(folder)) => Path::new(folder).join(name).display().to_string(),
            (None, Some(name), None) => {
                return Err(Failure::BadInput(format!(
                    "the mission names {name}: give it with --{option} FILE, or set AUV_DATA_DIR to the folder \
                     that holds it"
                )));
            }
            (None, None, _) => continue,
        };
        let bytes = read_file(&path, MOST_DATA)?;
        beside.push((kind, path, bytes));
    }
    Ok(beside)
}
