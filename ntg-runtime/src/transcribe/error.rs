//! Why a problem cannot be set up: found before any iteration, in the user's words.
//!
//! Most mistakes are found when a spec is compiled. These are the ones that only the values of
//! parameters, tables and indices decide, or the program that calls the runtime.

use crate::digits::apart;
use ntg_splines::KnotError;
use ntg_structure::{Place, Unit};
use std::fmt;

/// Why no optimisation problem could be made.
#[derive(Clone, Debug, PartialEq)]
#[non_exhaustive]
pub enum SetupError {
    /// A parameter, bound or time is infinite or not a number.
    NotFinite {
        /// What it is, in words.
        what: String,
        /// The value.
        value: f64,
        /// Where it stands.
        place: Place,
    },
    /// A lower bound lies above its upper bound.
    CrossingBounds {
        /// What is bounded.
        what: String,
        /// The lower bound, in SI units.
        lower: f64,
        /// The upper bound, in SI units.
        upper: f64,
        /// The unit in which both are shown.
        unit: Unit,
        /// Where it stands.
        place: Place,
    },
    /// Boundary conditions or bounds leave a value that a constraint forbids.
    Contradiction {
        /// The constraint that cannot be met.
        what: String,
        /// The value that the other conditions leave, in SI units.
        value: f64,
        /// The bound that it misses, in SI units.
        bound: f64,
        /// What leaves that value and no other.
        why: Why,
        /// The unit in which both are shown.
        unit: Unit,
        /// Where the constraint stands.
        place: Place,
    },
    /// An index outside a family, an array of parameters or an array of outputs.
    IndexOutOfRange {
        /// What is indexed.
        what: String,
        /// The index.
        index: i64,
        /// The first member.
        first: i64,
        /// The last member.
        last: i64,
        /// Where the indexed thing stands, or the constraint that names it.
        place: Place,
    },
    /// A phase that lasts no time.
    Duration {
        /// The phase, in words.
        phase: String,
        /// Its duration or the upper bound of it, with its unit.
        lasting: String,
        /// Where the phase stands.
        place: Place,
    },
    /// A spline that does not exist.
    Knots {
        /// The output, with its phase.
        output: String,
        /// What is wrong.
        error: KnotError,
        /// Where the phase stands.
        place: Place,
    },
    /// A table that cannot be interpolated.
    Table {
        /// The table.
        table: String,
        /// What is wrong.
        message: String,
    },
    /// A guess or a scale that names nothing, or has the wrong shape.
    Guess {
        /// What is wrong, and what could be meant.
        message: String,
    },
    /// `Settings::time_limit` was reached before the problem was set up.
    TimeLimit,
    /// The structure contradicts itself: a defect of the back end that made it.
    Malformed {
        /// What does not fit.
        message: String,
    },
}

/// What leaves a constraint no value that it allows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Why {
    /// Other conditions at the same point fix it.
    Conditions,
    /// Durations, starts and variables within their bounds reach no better one.
    Bounds,
}

impl SetupError {
    /// The code under which the language's documentation explains the same mistake, if it does.
    pub fn code(&self) -> Option<&'static str> {
        match self {
            Self::IndexOutOfRange { .. } => Some("E028"),
            Self::NotFinite { .. } => Some("E032"),
            Self::Knots { .. } => Some("E055"),
            Self::CrossingBounds { .. } => Some("E056"),
            Self::Contradiction { .. } => Some("E057"),
            Self::Duration { .. } => Some("E060"),
            Self::Guess { .. } => Some("E065"),
            Self::Table { .. } => Some("E073"),
            Self::TimeLimit | Self::Malformed { .. } => None,
        }
    }

    /// What to do, where that is not in the message.
    pub fn help(&self) -> Option<&'static str> {
        match self {
            Self::NotFinite { .. } => Some("change the parameters that it is computed from"),
            Self::CrossingBounds { .. } => Some("change the parameters that stand in its bounds"),
            Self::Contradiction { .. } => Some("loosen the bound, or change what is fixed"),
            Self::Duration { .. } => Some("change the parameters that decide how long it lasts"),
            Self::TimeLimit => Some("allow more time (`time_limit`)"),
            _ => None,
        }
    }

    /// What is wrong, without code and place.
    pub fn message(&self) -> String {
        match self {
            Self::NotFinite { what, value, .. } => format!("{what} is {value}; it must be a finite number"),
            Self::CrossingBounds { what, lower, upper, unit, .. } => {
                let (lower, upper) = apart(*lower, *upper, unit);
                format!("the bounds of {what} cross: no number lies between {lower} and {upper}")
            }
            Self::Contradiction { what, value, bound, why, unit, .. } => {
                let side = if value > bound { "at least" } else { "at most" };
                let (value, bound) = apart(*value, *bound, unit);
                let why = match why {
                    Why::Conditions => format!("the other conditions there make it {value}"),
                    Why::Bounds => format!("durations and variables within their bounds make it {side} {value}"),
                };
                format!("{what} cannot hold: {why}, and its bound is {bound}")
            }
            Self::IndexOutOfRange { what, index, first, last, .. } if last < first => {
                format!("{what} has no member {index}: it is empty")
            }
            Self::IndexOutOfRange { what, index, first, last, .. } => {
                format!("{what} has no member {index}: its members are {first} .. {last}")
            }
            Self::Duration { phase, lasting, .. } => {
                format!("{phase} would last {lasting}; a duration must be positive and finite")
            }
            Self::Knots { output, error, .. } => format!("the spline of {output}: {error}"),
            Self::Table { table, message } => format!("table `{table}`: {message}"),
            Self::Guess { message } => message.clone(),
            Self::TimeLimit => "the time limit was reached before the problem was set up".to_owned(),
            Self::Malformed { message } => format!("the compiled problem contradicts itself: {message}"),
        }
    }

    /// Where in the spec the mistake shows, if it has a place.
    pub fn place(&self) -> Option<&Place> {
        let place = match self {
            Self::NotFinite { place, .. }
            | Self::CrossingBounds { place, .. }
            | Self::Contradiction { place, .. }
            | Self::IndexOutOfRange { place, .. }
            | Self::Duration { place, .. }
            | Self::Knots { place, .. } => place,
            Self::Table { .. } | Self::Guess { .. } | Self::TimeLimit | Self::Malformed { .. } => return None,
        };
        (place.line > 0).then_some(place)
    }

    /// A defect of the back end, in words.
    pub(crate) fn malformed(message: impl Into<String>) -> Self {
        Self::Malformed { message: message.into() }
    }
}

impl fmt::Display for SetupError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message())?;
        if let Some(code) = self.code() {
            write!(f, " [{code}]")?;
        }
        match self.place() {
            Some(place) => write!(f, " (line {}, column {}: `{}`)", place.line, place.column, place.text),
            None => Ok(()),
        }
    }
}

impl std::error::Error for SetupError {}
