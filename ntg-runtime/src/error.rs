//! Why a problem cannot be solved at all.

use crate::settings::InvalidSetting;
use crate::transcribe::SetupError;
use std::fmt;

/// Why nothing could be solved at all. That no solution was *found* is no error: the report's
/// status says so.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum Error {
    /// The problem cannot be set up with the present parameters, or the guess does not fit it.
    Setup(SetupError),
    /// A setting is out of its range.
    Setting(InvalidSetting),
}

impl fmt::Display for Error {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Setup(error) => write!(f, "{error}"),
            Self::Setting(error) => write!(f, "{error}"),
        }
    }
}

impl std::error::Error for Error {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Setup(error) => Some(error),
            Self::Setting(error) => Some(error),
        }
    }
}

impl From<SetupError> for Error {
    fn from(error: SetupError) -> Self {
        Self::Setup(error)
    }
}

impl From<InvalidSetting> for Error {
    fn from(error: InvalidSetting) -> Self {
        Self::Setting(error)
    }
}
