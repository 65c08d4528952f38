//! Where the missions of a campaign come from, as lines and commands tell it.

/// The seed of each mission, and the command that flies one again.
pub(crate) enum Origin {
    /// The paper's Table 2 set-up.
    Table2 { seed: u64 },
    /// A mission file; mission `k` is flown with the seed plus `k`.
    File {
        seed: u64,
        /// The options that name the file and the files beside it, each after a space.
        options: String,
    },
}

impl Origin {
    /// Missions of the mission file among these files, of the Table 2 set-up without files.
    ///
    /// `files` gives the option and the path of each.
    pub(crate) fn new<'a>(seed: u64, files: impl Iterator<Item = (&'a str, &'a str)>) -> Self {
        let options: String = files
            .map(|(option, path)| format!(" --{option} {}", shell_word(path)))
            .collect();
        if options.is_empty() {
            return Self::Table2 { seed };
        }
        Self::File { seed, options }
    }

    /// The campaign's seed.
    pub(crate) const fn seed(&self) -> u64 {
        match self {
            Self::Table2 { seed } | Self::File { seed, .. } => *seed,
        }
    }

    /// The seed that, with its number, tells mission `k`.
    pub(crate) fn seed_of(&self, k: u64) -> u64 {
        match self {
            Self::Table2 { seed } => *seed,
            Self::File { seed, .. } => seed.wrapping_add(k),
        }
    }

    /// The command that flies mission `k` again.
    pub(crate) fn command(&self, k: u64) -> String {
        match self {
            Self::Table2 { seed } => {
                format!("campaign --seed {seed} --first {k} --missions 1 --replay replay.html")
            }
            Self::File { options, .. } => format!("mission{options} --seed {}", self.seed_of(k)),
        }
    }
}

/// A word as a shell takes it.
pub(crate) fn shell_word(word: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || "_-./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', r"'\''"))
}
