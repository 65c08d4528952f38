//! Why a command gives no answer.

use auv_planning::PlanError;
use std::fmt;

/// Why a command gives no answer; decides the exit code.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Failure {
    /// Bad input: exit code 2. Names the file or option, the place and the remedy.
    BadInput(String),
    /// An internal error: exit code 1.
    Internal(String),
}

impl Failure {
    /// Something wrong in a file or folder, `error` naming place and remedy.
    pub fn file(path: &str, error: impl fmt::Display) -> Self {
        Self::BadInput(format!("{path}: {error}"))
    }

    /// Something wrong with an option's value.
    pub fn option(name: &str, error: impl fmt::Display) -> Self {
        Self::BadInput(format!("--{name}: {error}"))
    }

    /// A planner's error about a problem read from `path`.
    #[must_use]
    pub fn planning(path: &str, error: &PlanError) -> Self {
        match error {
            PlanError::Failed { .. } => Self::Internal(format!("{path}: {error}")),
            _ => Self::file(path, error),
        }
    }

    /// The process's exit code.
    #[must_use]
    pub const fn exit_code(&self) -> u8 {
        match self {
            Self::BadInput(_) => 2,
            Self::Internal(_) => 1,
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BadInput(message) => f.write_str(message),
            Self::Internal(message) => {
                write!(
                    f,
                    "internal error: {message}; please report it with the command line"
                )
            }
        }
    }
}

impl std::error::Error for Failure {}
