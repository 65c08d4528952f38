//! Which missions a campaign flies.

use crate::origin::Origin;
use auv_examples::{Arguments, Failure, MissionInput};
use auv_ga_route::{GaRoute, GaSettings};
use auv_mission::driver::Stepped;
use auv_pso_path::{PathSearch, PsoPath};
use auv_sim::{Campaign, Scenario};
use auv_types::Seed;

/// Missions by number.
pub(crate) enum Fleet {
    /// The paper's Table 2 set-up, a network and a sea each.
    Table2(Box<Campaign>),
    /// One mission file; mission `k` is flown with the seed plus `k`.
    File {
        input: Box<MissionInput>,
        seed: Seed,
        reserve_s: f64,
    },
}

impl Fleet {
    pub(crate) fn read(arguments: &Arguments) -> Result<Self, Failure> {
        let seed = arguments.seed()?;
        if arguments.text("mission").is_some() {
            let input = MissionInput::read(arguments)?.with_body(arguments)?;
            // An error of the file is reported once, not once a mission.
            let reserve_s = input.scenario(seed)?.mission.reserve_s;
            let (routes, paths) = (
                GaRoute::new(GaSettings::default()),
                PsoPath::new(PathSearch::default()),
            );
            input.require_go(seed, &Stepped::new(&routes, &paths))?;
            return Ok(Self::File {
                input: Box::new(input),
                seed,
                reserve_s,
            });
        }
        let campaign = Campaign::table2(seed);
        campaign
            .map(|campaign| Self::Table2(Box::new(campaign)))
            .map_err(|error| Failure::Internal(error.to_string()))
    }

    pub(crate) fn scenario(&self, k: u64) -> Result<Scenario, String> {
        match self {
            Self::Table2(campaign) => campaign.scenario(k).map_err(|error| error.to_string()),
            Self::File { input, seed, .. } => {
                let scenario = input.scenario(Seed(seed.0.wrapping_add(k)));
                scenario.map_err(|failure| failure.to_string())
            }
        }
    }

    pub(crate) fn origin(&self) -> Origin {
        let seed = match self {
            Self::Table2(campaign) => campaign.seed.0,
            Self::File { seed, .. } => seed.0,
        };
        let files = self.files();
        let named = files
            .iter()
            .map(|(option, path, _)| (option.as_str(), *path));
        Origin::new(seed, named)
    }

    /// Obstacles in each sea, where the set-up says so.
    pub(crate) fn obstacles(&self) -> Option<usize> {
        match self {
            Self::Table2(campaign) => Some(campaign.obstacles),
            Self::File { .. } => None,
        }
    }

    /// Time kept in reserve by every mission, seconds.
    pub(crate) fn reserve_s(&self) -> f64 {
        match self {
            Self::Table2(campaign) => campaign.reserve_s,
            Self::File { reserve_s, .. } => *reserve_s,
        }
    }

    /// The file and those beside it: option, path, contents. None for the Table 2 set-up.
    pub(crate) fn files(&self) -> Vec<(String, &str, &[u8])> {
        match self {
            Self::Table2(_) => Vec::new(),
            Self::File { input, .. } => input.files(),
        }
    }
}
