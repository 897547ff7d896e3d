//! Why a program cannot be written down.

use std::fmt;

/// What a format cannot say.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum ExportError {
    /// A formula, in the user's words, with a number that is not finite.
    NotFinite(String),
    /// The program would hold more numbers of this table and of those before it than is reasonable.
    Tables(String),
    /// A program that the compiler does not make.
    Malformed(&'static str),
}

impl fmt::Display for ExportError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotFinite(label) => {
                write!(f, "`{label}` has a number that is not finite, which an .nl file cannot hold")
            }
            Self::Tables(name) => write!(
                f,
                "an .nl file knows no tables: every look-up is written as polynomials on all cells, and with `{name}` they are \
                 more than {} numbers; use fewer nodes, a `fit` on fewer intervals, or fewer points",
                crate::table::MOST_NUMBERS
            ),
            Self::Malformed(what) => write!(f, "a malformed program: {what}"),
        }
    }
}

impl std::error::Error for ExportError {}
