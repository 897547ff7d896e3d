//! Why there are no derivatives.

use crate::transcribe::SetupError;
use ntg_nlp::sensitivity::Unavailable;
use std::fmt;

/// Why a solution has no derivatives by parameters.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SensitivityError {
    /// There is no solution: why the solve ended.
    Unsolved(String),
    /// A name that is no parameter's; the names that there are.
    UnknownParameter(String, Vec<String>),
    /// The problem is not the one that was solved, or cannot be set up.
    Setup(SetupError),
    /// The conditions under which a solution can be differentiated do not hold.
    Unavailable(Unavailable),
}

impl fmt::Display for SensitivityError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unsolved(status) => write!(f, "there is no solution to differentiate: {status}"),
            Self::UnknownParameter(name, known) if known.is_empty() => {
                write!(f, "there is no parameter `{name}`: the problem has none")
            }
            Self::UnknownParameter(name, known) => {
                write!(f, "there is no parameter `{name}`; the parameters are: `{}`", known.join("`, `"))
            }
            Self::Setup(error) => write!(f, "{error}"),
            Self::Unavailable(why) => write!(f, "the solution cannot be differentiated: {why}"),
        }
    }
}

impl std::error::Error for SensitivityError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Setup(error) => Some(error),
            Self::Unavailable(why) => Some(why),
            Self::Unsolved(_) | Self::UnknownParameter(..) => None,
        }
    }
}

impl From<SetupError> for SensitivityError {
    fn from(error: SetupError) -> Self {
        Self::Setup(error)
    }
}

impl From<Unavailable> for SensitivityError {
    fn from(why: Unavailable) -> Self {
        Self::Unavailable(why)
    }
}
