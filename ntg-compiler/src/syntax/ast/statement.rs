//! What stands in blocks: constraints, guesses, and loops around them; a part of `ast`.
//!
//! See `ast` for what holds of these types.

use super::{Boundary, Bounds, Doc, Event, Expr, Ident, IndexRange, Path};
use crate::source::Span;

/// `initial { ... }`, `trajectory { ... }`, `final { ... }`, `temporal { ... }`, `dynamics { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Where its constraints hold.
    pub place: BlockPlace,
    /// In which part of that, if not in all of it.
    pub part: Option<Part>,
    /// What stands in it.
    pub statements: Vec<Statement<Constraint>>,
}

/// Where the constraints of a block hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum BlockPlace {
    /// At the start.
    Initial,
    /// All the way.
    Trajectory,
    /// At the end.
    Final,
    /// At no single point.
    Temporal,
    /// All the way: the equations of motion.
    Dynamics,
    /// Nowhere exactly: what was measured.
    Measure,
}

/// Which part of a trajectory a block is about.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// `except initial`, `except final`, `except initial, final`
    Except {
        /// The ends that are left out, one or two.
        ends: Vec<Boundary>,
        /// All of it.
        span: Span,
    },
    /// `from a to b`, `from a`, `to b`
    Between {
        /// Where it begins.
        from: Option<Expr>,
        /// Where it ends.
        to: Option<Expr>,
        /// All of it.
        span: Span,
    },
}

impl Part {
    /// Where it stands.
    pub fn span(&self) -> Span {
        match self {
            Self::Except { span, .. } | Self::Between { span, .. } => *span,
        }
    }
}

/// `at 2.5 [s] { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct AtBlock {
    /// When its constraints hold.
    pub time: Expr,
    /// What stands in it.
    pub statements: Vec<Statement<Constraint>>,
}

/// Something in a block, or a loop around some of it.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "the lint takes `T` for empty; a constraint is as large as a loop")]
pub enum Statement<T> {
    /// The thing itself.
    One(T),
    /// `for i in 1 .. N { ... }`
    For(For<T>),
}

/// `for i in 1 .. N { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct For<T> {
    /// The index and its range.
    pub over: IndexRange,
    /// What is repeated.
    pub body: Vec<Statement<T>>,
    /// From `for` to the closing brace.
    pub span: Span,
}

/// `name: relation;`
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// The doc comment before it.
    pub doc: Option<Doc>,
    /// At which price it may be missed, if it may.
    pub softness: Option<Softness>,
    /// Its name.
    pub name: Option<Ident>,
    /// What must hold.
    pub relation: Relation,
    /// The standard deviation of what was measured.
    pub sigma: Option<Expr>,
    /// From its first word to before its `;`, the doc comment excluded.
    pub span: Span,
}

/// `soft(w)`, `soft(linear = w)`, `soft(square = w)`: at which price a constraint may be missed; one at least is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Softness {
    /// The price of what is missed.
    pub linear: Option<Expr>,
    /// The price of its square.
    pub square: Option<Expr>,
    /// From `soft` to the parenthesis.
    pub span: Span,
}

/// What a constraint demands.
#[derive(Clone, Debug, PartialEq)]
pub enum Relation {
    /// `left == right`, `left <= right`, `left >= right`
    Compare {
        /// Left of the sign.
        left: Expr,
        /// The sign.
        comparison: Comparison,
        /// Where the sign stands.
        comparison_span: Span,
        /// Right of the sign.
        right: Expr,
    },
    /// `first <= middle <= last`, or with `>=` twice
    Between {
        /// Left of both signs.
        first: Expr,
        /// Both signs; never `==`.
        comparison: Comparison,
        /// Between the signs.
        middle: Expr,
        /// Right of both signs.
        last: Expr,
    },
    /// `value in lower .. upper`
    In {
        /// What is bounded.
        value: Expr,
        /// Its bounds.
        bounds: Bounds,
    },
}

impl Relation {
    /// Everything that is compared, in the order of the text.
    pub fn sides(&self) -> Vec<&Expr> {
        match self {
            Self::Compare { left, right, .. } => vec![left, right],
            Self::Between { first, middle, last, .. } => vec![first, middle, last],
            Self::In { value, bounds } => {
                [Some(value), bounds.lower.as_ref(), bounds.upper.as_ref()].into_iter().flatten().collect()
            }
        }
    }
}

/// The signs that a constraint may hold.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Comparison {
    /// `==`
    Equal,
    /// `<=`
    AtMost,
    /// `>=`
    AtLeast,
}

/// `guess { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct Guess {
    /// What stands in it.
    pub statements: Vec<Statement<GuessKind>>,
}

/// What a guess says.
#[derive(Clone, Debug, PartialEq)]
pub enum GuessKind {
    /// `z = 1 - tau;`, `duration(covert) = 600 [s];`
    Assign(Assign),
    /// `(x, y) through (0, 0), (1, 5) [km];`
    Route(Route),
}

/// `target = value;` in a guess.
#[derive(Clone, Debug, PartialEq)]
pub struct Assign {
    /// What is guessed.
    pub target: Target,
    /// Its guess.
    pub value: Expr,
    /// All of it.
    pub span: Span,
}

/// What a guess can be given for.
#[derive(Clone, Debug, PartialEq)]
pub enum Target {
    /// An output, a variable or a named duration.
    Path(Path),
    /// `duration(covert)`, `start(uav[1])`, or `duration` alone for the scope that it stands in.
    Event {
        /// Which of a phase's times.
        event: Event,
        /// Of which phase or agent.
        path: Option<Path>,
        /// All of it.
        span: Span,
    },
}

/// `(x, y) through (0, 0), (1, 5) [km];`
#[derive(Clone, Debug, PartialEq)]
pub struct Route {
    /// The outputs, one at least.
    pub outputs: Vec<Path>,
    /// The points, one at least, each with as many coordinates as there are outputs.
    pub points: Vec<Point>,
    /// All of it.
    pub span: Span,
}

/// `(1, 5)`: a point of a route.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// One coordinate for each output.
    pub coordinates: Vec<Expr>,
    /// All of it, parentheses included.
    pub span: Span,
}
