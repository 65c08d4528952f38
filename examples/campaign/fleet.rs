//! Which missions a campaign flies.

use auv_examples::{Arguments, Failure, MissionInput};
use auv_sim::{Campaign, Scenario};
use auv_types::Seed;

/// Missions by number.
pub(crate) enum Fleet {
    /// The paper's Table 2 set-up, a network and a sea each.
    Table2(Box<Campaign>),
    /// One mission file; mission `k` is flown with the seed plus `k`.
    File(Box<MissionInput>, Seed),
}

impl Fleet {
    pub(crate) fn read(arguments: &Arguments) -> Result<Self, Failure> {
        let seed = arguments.seed()?;
        if arguments.text("mission").is_some() {
            let input = MissionInput::read(arguments)?;
            // An error of the file is reported once, not once a mission.
            input.scenario(seed)?;
            return Ok(Self::File(Box::new(input), seed));
        }
        let campaign = Campaign::table2(seed);
        campaign
            .map(|campaign| Self::Table2(Box::new(campaign)))
            .map_err(|error| Failure::Internal(error.to_string()))
    }

    pub(crate) fn scenario(&self, k: u64) -> Result<Scenario, String> {
        match self {
            Self::Table2(campaign) => campaign.scenario(k).map_err(|error| error.to_string()),
            Self::File(input, _) => {
                let scenario = input.scenario(Seed(self.seed_of(k)));
                scenario.map_err(|failure| failure.to_string())
            }
        }
    }

    /// The seed that, with its number, tells mission `k`.
    pub(crate) fn seed_of(&self, k: u64) -> u64 {
        match self {
            Self::Table2(campaign) => campaign.seed.0,
            Self::File(_, seed) => seed.0.wrapping_add(k),
        }
    }

    /// Obstacles in each sea, where the set-up says so.
    pub(crate) fn obstacles(&self) -> Option<usize> {
        match self {
            Self::Table2(campaign) => Some(campaign.obstacles),
            Self::File(..) => None,
        }
    }

    /// The command that flies mission `k` again.
    pub(crate) fn command(&self, k: u64) -> String {
        match self {
            Self::Table2(campaign) => {
                format!(
                    "campaign --seed {} --first {k} --missions 1 --replay replay.html",
                    campaign.seed.0
                )
            }
            Self::File(input, _) => {
                format!(
                    "mission --mission {}{} --seed {}",
                    input.path,
                    input.beside_options(),
                    self.seed_of(k)
                )
            }
        }
    }
}
