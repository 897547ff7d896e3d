//! Where the solver starts.

use crate::{Affine, Call, Loop, PhaseRef};

/// To which stretch of time a guess belongs.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum GuessScope {
    /// One phase; `tau` is the phase's scaled time.
    Phase(PhaseRef),
    /// All phases of an agent; `tau` is the agent's whole time, shared out by guessed durations.
    Agent {
        /// Index into `Structure::agents`.
        agent: usize,
        /// Which member, when the agent is a family.
        index: Option<Affine>,
    },
}

/// What is guessed.
#[derive(Clone, Debug, PartialEq)]
pub enum GuessKind {
    /// An output as a function of time.
    Output {
        /// The output's name.
        output: String,
        /// Which member, when it is an array.
        index: Option<Affine>,
        /// A call of a kernel with one row and no slots; it may use `Data::Tau`.
        value: Call,
    },
    /// Outputs along a polygon, by arc length.
    Route {
        /// The outputs' names and members.
        outputs: Vec<(String, Option<Affine>)>,
        /// Number of way-points, the ends included.
        points: usize,
        /// A call without slots and with `points * outputs.len()` rows, point by point.
        values: Call,
    },
    /// The duration of a phase, or of a whole agent, in seconds.
    Duration {
        /// A call of a kernel with one row and no slots.
        value: Call,
    },
    /// A declared variable.
    Variable {
        /// Index into `Structure::variables`.
        variable: usize,
        /// Which member, when it is an array.
        index: Option<Affine>,
        /// A call of a kernel with one row and no slots.
        value: Call,
    },
    /// The start time of an agent, in seconds.
    Start {
        /// A call of a kernel with one row and no slots.
        value: Call,
    },
}

/// One statement of a `guess { }` block.
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// Nested loops, the outermost first.
    pub loops: Vec<Loop>,
    /// Where in time it applies.
    pub scope: GuessScope,
    /// What it says.
    pub kind: GuessKind,
}

/// A parameter that is solved for in turn, each solution the guess of the next.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuation {
    /// Index into `Structure::parameters`.
    pub parameter: usize,
    /// Its values in order, SI; the last is the parameter's default. Where the program has set
    /// another value, that value replaces the last step.
    pub steps: Vec<f64>,
}
