//! Why a table cannot be built, in plain words.

use std::fmt;

use super::{MAX_ARGUMENTS, MAX_TABLE_ORDER};

/// Why nodes, values and method do not make a table. Arguments and nodes are counted from 0
/// here and from 1 in the message.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub enum TableError {
    /// No argument, or more than [`MAX_ARGUMENTS`].
    Arguments {
        /// How many there are.
        found: usize,
    },
    /// Fewer than two nodes of an argument.
    TooFewNodes {
        /// Which argument.
        axis: usize,
        /// How many nodes it has.
        found: usize,
    },
    /// A node is infinite or not a number.
    NodeNotFinite {
        /// Which argument.
        axis: usize,
        /// Which node.
        index: usize,
    },
    /// A node does not exceed the one before it.
    NodesNotIncreasing {
        /// Which argument.
        axis: usize,
        /// Which node.
        index: usize,
    },
    /// The values are not one for each combination of nodes.
    WrongNumberOfValues {
        /// The product of the numbers of nodes.
        expected: usize,
        /// How many values there are.
        found: usize,
    },
    /// A value is infinite or not a number.
    ValueNotFinite {
        /// Which value, in row-major order.
        index: usize,
    },
    /// An even argument has a negative node.
    EvenNegative {
        /// Which argument.
        axis: usize,
        /// Its first node.
        node: f64,
    },
    /// The values at the first and the last node of a periodic argument differ.
    PeriodicNotClosed {
        /// Which argument.
        axis: usize,
        /// A value at the first node.
        first: f64,
        /// Its counterpart at the last node.
        last: f64,
    },
    /// `Monotone` exists for one and two arguments only.
    MonotoneArguments {
        /// How many arguments the table has.
        found: usize,
    },
    /// The order is below 2 or above [`MAX_TABLE_ORDER`].
    Order {
        /// The order that was asked for.
        order: usize,
    },
    /// The numbers of intervals of a fit are not one for each argument.
    WrongNumberOfIntervals {
        /// The number of arguments.
        expected: usize,
        /// How many numbers there are.
        found: usize,
    },
    /// The number of intervals of a fit is 0.
    NoIntervals {
        /// Which argument.
        axis: usize,
    },
    /// The interpolant would have more coefficients than memory should hold.
    TooLarge,
    /// The numbers are so large or the nodes so close that the interpolant is not finite.
    NotRepresentable,
    /// New nodes of another number than the old ones.
    SizeChanged {
        /// Which argument.
        axis: usize,
        /// How many nodes it has.
        expected: usize,
        /// How many new ones there are.
        found: usize,
    },
}

impl fmt::Display for TableError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Arguments { found } => {
                write!(f, "a table has between 1 and {MAX_ARGUMENTS} arguments, but this one has {found}")
            }
            Self::TooFewNodes { axis, found } => {
                write!(f, "argument {} needs at least two nodes, but it has {found}", axis + 1)
            }
            Self::NodeNotFinite { axis, index } => {
                write!(f, "node {} of argument {} is not a finite number", index + 1, axis + 1)
            }
            Self::NodesNotIncreasing { axis, index } => {
                write!(f, "node {} of argument {} is not larger than the node before it", index + 1, axis + 1)
            }
            Self::WrongNumberOfValues { expected, found } => {
                write!(f, "the nodes ask for {expected} values, but there are {found}")
            }
            Self::ValueNotFinite { index } => write!(f, "value {} is not a finite number", index + 1),
            Self::EvenNegative { axis, node } => write!(
                f,
                "argument {} is even, so its nodes must not be negative, but the first one is {node}",
                axis + 1
            ),
            Self::PeriodicNotClosed { axis, first, last } => write!(
                f,
                "argument {} is periodic, so its last node must repeat the values of the first, but they are {first} and {last}",
                axis + 1
            ),
            Self::MonotoneArguments { found } => write!(
                f,
                "monotone interpolation serves one or two arguments, but there are {found}; use bspline, fit or linear"
            ),
            Self::Order { order } => {
                write!(f, "the order of a table must be between 2 and {MAX_TABLE_ORDER}, but it is {order}")
            }
            Self::WrongNumberOfIntervals { expected, found } => write!(
                f,
                "a fit needs one number of intervals for each of the {expected} arguments, but there are {found}"
            ),
            Self::NoIntervals { axis } => {
                write!(f, "a fit needs at least one interval, but argument {} has none", axis + 1)
            }
            Self::TooLarge => write!(f, "the table has too many coefficients; use fewer intervals or nodes"),
            Self::NotRepresentable => {
                write!(f, "the values are too large or the nodes too close for an interpolant in double precision")
            }
            Self::SizeChanged { axis, expected, found } => write!(
                f,
                "the size of a table is fixed: argument {} has {expected} nodes, but {found} are given",
                axis + 1
            ),
        }
    }
}

impl std::error::Error for TableError {}
