//! A kernel together with what its inputs mean.

use crate::{Affine, Instant, Loop};

/// One member of a family of phases.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct PhaseRef {
    /// Which phase (family), as an index into `Structure::phases`.
    pub phase: usize,
    /// Which member of the agent's family, when the agent is a family.
    pub agent: Option<Affine>,
    /// Which member of the phase's family, when the phase is a family.
    pub index: Option<Affine>,
}

/// At which point of a phase a flat variable is taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum At {
    /// At the point at which the group is evaluated.
    Here,
    /// At the phase's start.
    Start,
    /// At the phase's end.
    End,
    /// At a place inside the phase, from the right where intervals meet.
    Inside(Instant),
    /// At a place for each value of one index.
    Among {
        /// Index into `Structure::places`.
        places: usize,
        /// Which of the surrounding loops, counted from the outermost.
        index: usize,
    },
}

/// An input with respect to which a kernel is differentiated.
/// Every slot is an affine function of the variables of the optimisation problem.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Slot {
    /// A flat output or its derivative with respect to the phase's scaled time `tau` in 0..1
    /// (docs/maths.md, section 3).
    Flat {
        /// The phase.
        phase: PhaseRef,
        /// The point in that phase.
        at: At,
        /// Which output, as an index into `Phase::outputs`.
        output: usize,
        /// Which member, when the output is an array.
        index: Option<Affine>,
        /// Order of the derivative; 0 is the output itself.
        derivative: usize,
    },
    /// The duration of a phase whose duration is free, in seconds.
    Duration(PhaseRef),
    /// The time at which a phase starts, when that is not fixed, in seconds of mission time.
    Start(PhaseRef),
    /// A declared variable.
    Variable {
        /// Index into `Structure::variables`.
        variable: usize,
        /// Which member, when the variable is an array.
        index: Option<Affine>,
    },
    /// An integral that enters nonlinearly.
    Integral {
        /// Index into `Structure::integrals`.
        integral: usize,
        /// Which member, one for each of its loops.
        index: Vec<Affine>,
    },
}

/// An input that does not change while the problem is solved.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Data {
    /// A parameter.
    Parameter {
        /// Index into `Structure::parameters`.
        parameter: usize,
        /// Which member, when the parameter is an array (counted from 1).
        index: Option<Affine>,
    },
    /// An index expression, as a number.
    Index(Affine),
    /// The phase's scaled time at the point of evaluation.
    Tau,
    /// The same as conditions see it: at the end of an interval a little within the interval from which the point is looked at.
    TauWithin,
    /// The duration of a phase whose duration is fixed; in a guess, also the guessed one.
    Duration(PhaseRef),
    /// The start of a phase when everything before it is fixed; in a guess, also the guessed one.
    Start(PhaseRef),
}

/// How the members of a family are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum ReduceOp {
    /// Their sum; 0 for an empty range.
    Sum,
    /// Their product; 1 for an empty range.
    Product,
    /// The smallest; positive infinity for an empty range.
    Min,
    /// The largest; negative infinity for an empty range.
    Max,
}

/// The combination of a kernel's result over a range of one more index.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Reduction {
    /// How to combine.
    pub op: ReduceOp,
    /// The new index, which follows the indices of the surrounding loops.
    pub over: Loop,
    /// A call of a kernel with one row.
    pub body: Call,
}

/// A kernel and its inputs, as functions of the surrounding loops' indices.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct Call {
    /// Index into `Structure::kernels`.
    pub kernel: usize,
    /// The inputs that are differentiated.
    pub slots: Vec<Slot>,
    /// Further differentiated inputs, which are results of inner calls.
    pub reductions: Vec<Reduction>,
    /// The inputs that are not differentiated.
    pub data: Vec<Data>,
}
