//! Where kernels are evaluated, and what becomes of their rows.

use crate::{Affine, Call, Family, Loop, Part, PhaseRef, Place, Unit};

/// Where a group is evaluated.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Domain {
    /// Once: the function belongs to no point.
    Mission,
    /// At the start of a phase.
    Start(PhaseRef),
    /// At the end of a phase.
    End(PhaseRef),
    /// At every point of one of the phase's point sets that lies in a part of the phase.
    Path {
        /// The phase.
        phase: PhaseRef,
        /// Index into `Phase::points`.
        points: usize,
        /// Which part; point sets with the ends of intervals have the ends of the part too.
        part: Part,
    },
}

/// What a kernel's row is.
///
/// On a [`Domain::Path`], the rows `Cost`, `Part` and `Integral` are integrands over scaled time:
/// they are multiplied by the point's quadrature weight and added up. The kernel already holds
/// the factor `T` (docs/maths.md, section 3).
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Row {
    /// Adds to the objective, which is always minimised.
    Cost {
        /// Index into `Structure::terms`.
        term: usize,
    },
    /// A constraint row of its own, for every member of the loops and every point.
    Constraint {
        /// Index into `Structure::constraints`.
        constraint: usize,
        /// Row of the group's `bounds` that holds the lower bound; none: minus infinity.
        lower: Option<usize>,
        /// Row of the group's `bounds` that holds the upper bound; none: infinity.
        /// An equality names the same row twice.
        upper: Option<usize>,
    },
    /// Adds to the row that another group on [`Domain::Mission`] makes for this constraint.
    Part {
        /// Index into `Structure::constraints`.
        constraint: usize,
        /// Which member of the constraint: one for each loop of the group that makes the row.
        index: Vec<Affine>,
    },
    /// Adds to an integral that is a variable of its own: its row is `variable - sum = 0`.
    Integral {
        /// Index into `Structure::integrals`.
        integral: usize,
        /// Which member, one for each of the integral's loops.
        index: Vec<Affine>,
    },
}

/// A kernel evaluated over a domain, for all members of nested loops.
#[derive(Clone, Debug, PartialEq)]
pub struct Group {
    /// Nested loops, the outermost first; those over agents and phases come first.
    pub loops: Vec<Loop>,
    /// Where it is evaluated.
    pub domain: Domain,
    /// The kernel and its inputs.
    pub call: Call,
    /// What each of its rows is.
    pub rows: Vec<Row>,
    /// Bounds of the constraint rows, as functions of parameters and indices alone.
    pub bounds: Option<Call>,
}

/// What tables of the limits of a group are evaluated at; its loops and its domain are those of the group.
#[derive(Clone, Debug, PartialEq)]
pub struct Arguments {
    /// The group, counted among `Structure::groups`, or among `Structure::shown`.
    pub group: usize,
    /// Among which of both.
    pub shown: bool,
    /// Computes the arguments, one in each row.
    pub call: Call,
    /// The table and its axis that each row is an argument of.
    pub axes: Vec<(usize, usize)>,
}

/// In which block of the spec a constraint stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Block {
    /// `initial { }`
    Initial,
    /// `trajectory { }`
    Trajectory,
    /// `final { }`
    Final,
    /// `temporal { }`
    Temporal,
    /// Continuity where one phase follows another.
    Continuity,
    /// In none: the compiler's own, which holds a helper above a corner of the objective at the points (docs/maths.md,
    /// section 18), or is a derivative of an equation between states (section 4.9). Such constraints come last, and reports leave
    /// them out.
    Corner,
}

/// A constraint as the user wrote it.
#[derive(Clone, Debug, PartialEq)]
pub struct Constraint {
    /// Its name, with the path of its agent and phase, if it has one.
    pub name: Option<String>,
    /// Where it stands; the text serves as a name where there is none.
    pub place: Place,
    /// The block it stands in.
    pub block: Block,
    /// The unit in which violations are reported.
    pub unit: Unit,
    /// How many of the innermost loops of its rows go through the sides of its corners, `u` and `-u` of `abs(u) <= 1`
    /// (docs/maths.md, section 18). Nobody sees their indices.
    pub sides: usize,
}

impl Constraint {
    /// The indices of a member without those of its sides.
    pub fn shown_indices<'a>(&self, indices: &'a [i64]) -> &'a [i64] {
        &indices[..indices.len().saturating_sub(self.sides)]
    }
}

/// A term of the objective.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// Its name, as in `minimize fuel: ...`.
    pub name: Option<String>,
    /// Where it stands.
    pub place: Place,
    /// The unit in which it is reported.
    pub unit: Unit,
}

/// An equation with corners for which helpers stand, numbers beside the corners (docs/maths.md, equation 18.5): it has one form
/// with the helpers and one as it is written, of which one is posed. All constraints are given by their numbers.
#[derive(Clone, Debug, PartialEq, Eq, Default)]
pub struct Relaxation {
    /// The form that is posed, as the constraint of the spec.
    pub equation: usize,
    /// The form that is not posed.
    pub other: usize,
    /// The helpers. Equations may have some in common.
    pub helpers: Vec<Helper>,
    /// Where the corners are.
    pub corners: Vec<Place>,
    /// Whether a solver poses it first as it is written: inputs have no part in the corners, and nothing holds a trajectory there.
    pub exact_first: bool,
    /// Whether it is posed as it is written.
    pub is_exact: bool,
}

/// A number for each point that stands for a corner of equations. All constraints are given by their numbers.
#[derive(Clone, Debug, PartialEq, Eq, Hash, Default)]
pub struct Helper {
    /// What holds it beside the corner, one for each side of that.
    pub sides: Vec<usize>,
    /// Its own bounds.
    pub bounds: Vec<usize>,
    /// What holds it at 0 where no equation that is posed has it.
    pub at_zero: usize,
}

/// Measured values with their standard deviations: half the sum of squared ratios is part of a term of the objective
/// (docs/maths.md, section 17).
#[derive(Clone, Debug, PartialEq)]
pub struct Measurement {
    /// Index into `Structure::terms`.
    pub term: usize,
    /// The unit in which residuals are reported.
    pub unit: Unit,
    /// Nested loops, the outermost first: one residual for each of their members.
    pub loops: Vec<Loop>,
    /// A call of a kernel with one row: the left side without the right one.
    pub residual: Call,
    /// A call of a kernel with one row and no slots: the standard deviation.
    pub sigma: Call,
}

/// An output whose values formulas know by the sines and cosines of its multiples alone.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Angle {
    /// Index into `Structure::phases`.
    pub phase: usize,
    /// Index into that phase's `outputs`.
    pub output: usize,
    /// The change of the output, SI, by which no argument of a sine changes by more than one.
    pub radian: f64,
    /// The change of the output, SI, that formulas do not see, but for bounds of the output; none where there is none.
    pub turn: Option<f64>,
    /// Whether formulas know its derivatives by time too.
    pub moves: bool,
}

/// An integral that enters some function nonlinearly.
#[derive(Clone, Debug, PartialEq)]
pub struct Integral {
    /// Its members: one for every combination of indices.
    pub loops: Vec<Loop>,
    /// Where it stands.
    pub place: Place,
}

/// A named expression: a `let`, which appears in solutions and reports.
#[derive(Clone, Debug, PartialEq)]
pub struct Named {
    /// Its name, without the path of its agent and phase.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Its members, when it is a family; the family's index is the last of `loops`.
    pub family: Option<Family>,
    /// Whose it is, as an index into `Structure::agents`.
    pub agent: usize,
    /// The loops over agents and phases, then the family's.
    pub loops: Vec<Loop>,
    /// [`Domain::Path`] for an expression along a phase (whatever its point set), or
    /// [`Domain::Mission`] for a number.
    pub domain: Domain,
    /// A call of a kernel with one row.
    pub call: Call,
}
