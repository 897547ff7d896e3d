//! The contract between a program and the solver (docs/maths.md, section 4).
//!
//! ```text
//! minimise    f(x) = sum over elements e, rows r with target Objective of  weight * phi_er(u_e)
//! subject to  row_lower <= c(x) <= row_upper,  c_i = the same sum over rows with target Row(i)
//!             lower <= x <= upper
//! where       u_e = E_e x[variables_e] + offset_e
//! ```
//!
//! An *element* is a vector of smooth functions of a few *slots* `u`, its internal variables. Derivatives are
//! computed with respect to slots, where they are small, dense and exact; the *map* `E`, the element's range
//! transformation, takes them to the variables of the program. A method may work on elements (make
//! each convex, condense each, order them) because the program has not forgotten them. Reference: A. Griewank and
//! Ph. L. Toint, *Numerische Mathematik* 39 (1982), for functions of this form.

/// What becomes of one row of one element.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// It adds to the objective.
    Objective,
    /// It adds to this constraint row.
    Row(u32),
}

impl Target {
    /// The constraint row, if it is one.
    pub(crate) fn row(self) -> Option<usize> {
        match self {
            Self::Objective => None,
            Self::Row(row) => Some(row as usize),
        }
    }
}

/// Elements of one shape. They never change while a program is solved.
#[derive(Clone, Debug, Default)]
pub struct Block {
    /// How many elements.
    pub elements: usize,
    /// Slots (internal variables) of each element.
    pub slots: usize,
    /// Rows (functions) of each element.
    pub rows: usize,
    /// Pattern of first derivatives `(row, slot)`, the same for all elements.
    pub jacobian: Vec<(usize, usize)>,
    /// Pattern of weighted second derivatives `(i, j)`, `i >= j`.
    pub hessian: Vec<(usize, usize)>,
    /// Where each element's variables start in `variables`: `elements + 1` entries.
    pub variable_start: Vec<usize>,
    /// Indices of the program's variables, distinct within an element, increasing.
    pub variables: Vec<u32>,
    /// Where each element's map starts in `map`: `elements + 1` entries.
    pub map_start: Vec<usize>,
    /// For each element its range transformation: a matrix of `slots` rows and one column a variable, row by row.
    pub map: Vec<f64>,
    /// The constant part of each slot: entry `slot * elements + element`.
    pub offset: Vec<f64>,
    /// Where each row goes: entry `row * elements + element`.
    pub target: Vec<Target>,
    /// The factor of each row: entry `row * elements + element`.
    pub weight: Vec<f64>,
}

impl Block {
    /// The variables of element `e`.
    pub fn variables(&self, e: usize) -> &[u32] {
        &self.variables[self.variable_start[e]..self.variable_start[e + 1]]
    }

    /// The map of element `e`: `slots` rows, one column a variable.
    pub fn map(&self, e: usize) -> &[f64] {
        &self.map[self.map_start[e]..self.map_start[e + 1]]
    }
}

/// What an evaluation writes, one a block; entry `i` of element `e` is `[i * elements + e]`.
/// Values and first derivatives are those of the element's functions, without `weight`;
/// second derivatives are weighted (see [`Nlp::derivatives`]).
#[derive(Clone, Debug, Default)]
pub struct BlockValues {
    /// One number a row.
    pub values: Vec<f64>,
    /// One number an entry of the block's Jacobian pattern.
    pub jacobian: Vec<f64>,
    /// One number an entry of the block's Hessian pattern.
    pub hessian: Vec<f64>,
}

/// The program at one point.
#[derive(Clone, Debug, Default)]
pub struct Evaluation {
    /// The objective (minimised).
    pub objective: f64,
    /// The constraint rows.
    pub rows: Vec<f64>,
    /// The elements behind them.
    pub blocks: Vec<BlockValues>,
}

/// Bounds and scales that stay the same while a program is solved.
#[derive(Clone, Debug, Default)]
pub struct Limits {
    /// Lower bounds of the variables, or minus infinity.
    pub lower: Vec<f64>,
    /// Upper bounds of the variables, or infinity.
    pub upper: Vec<f64>,
    /// A positive typical size of each variable.
    pub scale: Vec<f64>,
    /// Variables with the same number share their typical size, such as the coefficients of one spline. Empty: each has
    /// its own.
    pub alike: Vec<u32>,
    /// Whether the size of a variable is that of a start that says little about it: it is no more than a little beside 0, or
    /// is there for want of a better one. Empty: none is.
    pub doubtful: Vec<bool>,
    /// Rows with the same number are one function at several points, whose slopes are comparable. Empty: those of one place
    /// in the elements of a block are.
    pub relation: Vec<u32>,
    /// Lower bounds of the rows; equal to the upper bound for an equality.
    pub row_lower: Vec<f64>,
    /// Upper bounds of the rows.
    pub row_upper: Vec<f64>,
    /// The rows that are norms: roots of sums of squares, times or over smooth factors. Their squares are posed in their
    /// place (docs/maths.md, section 11.14). Empty where there are none.
    pub norms: Vec<bool>,
    /// Rows that define variables by others; the interior-point method meets them at every trial point (docs/maths.md,
    /// section 11.18).
    pub definitions: Vec<Definition>,
    /// Durations in rows that are posed times powers of them, since they may vanish (docs/maths.md, section 11.17).
    pub shrinking: Vec<Shrinking>,
    /// Variables that objective and rows know by their sines and cosines alone, with the change that is a radian: a step
    /// turns them by little (docs/maths.md, section 11.15).
    pub angles: Vec<(u32, f64)>,
    /// A positive typical size of each row, from units and bounds; 1 where nothing is known.
    pub row_scale: Vec<f64>,
    /// How much the scaled violation of each row counts beside that of a row of weight 1; empty where all weigh alike.
    /// Where rows cannot all be met, those of small weight give way.
    pub row_weight: Vec<f64>,
    /// A positive typical size of the objective; none: what it varies by at the start says.
    pub objective_size: Option<f64>,
    /// What of the objective is nothing, as a ten thousandth of a standard deviation is in an estimate: an objective below it is
    /// not asked for an optimum relative to itself. 0: whatever is not 0 counts.
    pub negligible: f64,
}

/// A row `variable - sum = 0`, in which the sum does not hold the variable.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Definition {
    /// The row, of bounds 0.
    pub row: u32,
    /// The variable, without bounds.
    pub variable: u32,
}

/// A duration in a row that holds derivatives by a time of which the duration is the scale: terms are over powers of it. A row with
/// two durations has two entries.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shrinking {
    /// The row, with one bound or two that are equal.
    pub row: u32,
    /// The duration, above 0 by its bounds.
    pub variable: u32,
    /// The highest power of the duration that terms are over.
    pub order: u8,
    /// The duration below which the row is posed times this power, and above which it is posed as it is.
    pub small: f64,
    /// Whether no other duration stands in the row.
    pub is_only: bool,
}

/// A number of an evaluation, by its indices.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Entry {
    /// A variable of the point itself.
    Variable(usize),
    /// The value of a row of an element.
    Value {
        /// The block.
        block: usize,
        /// The element within the block.
        element: usize,
        /// The row within the element.
        row: usize,
    },
    /// A first derivative of a row of an element.
    FirstDerivative {
        /// The block.
        block: usize,
        /// The element within the block.
        element: usize,
        /// The row within the element.
        row: usize,
    },
    /// A weighted second derivative of an element.
    SecondDerivative {
        /// The block.
        block: usize,
        /// The element within the block.
        element: usize,
    },
}

/// A number of an evaluation that is not finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NotFinite {
    /// Which number.
    pub entry: Entry,
    /// The number: `NaN` or `inf`.
    pub value: f64,
}

/// A nonlinear program made of elements.
pub trait Nlp: Sync {
    /// Buffers for evaluations, sized once.
    type Workspace: Send + 'static;

    /// Number of variables.
    fn variables(&self) -> usize {
        self.limits().lower.len()
    }
    /// Number of constraint rows.
    fn rows(&self) -> usize {
        self.limits().row_lower.len()
    }
    /// Bounds and scales.
    fn limits(&self) -> &Limits;
    /// The elements.
    fn blocks(&self) -> &[Block];
    /// The first of the variables that may appear in any element (in an optimal control problem durations and static
    /// variables). They come last. The variables before it are ordered so that elements depend on variables close
    /// together (in order of time).
    fn globals(&self) -> usize {
        self.variables()
    }
    /// Fresh buffers, and an [`Evaluation`] with all arrays sized.
    fn workspace(&self) -> (Self::Workspace, Evaluation);

    /// Objective, rows and element values at `x`. Allocates nothing.
    ///
    /// # Errors
    /// The first value that is not finite.
    fn values(&self, x: &[f64], work: &mut Self::Workspace, out: &mut Evaluation) -> Result<(), NotFinite>;

    /// As `values`, and first and second derivatives of all elements. The second derivatives of
    /// an element are those of `sum over its rows of w * weight * phi`, where `w` is
    /// `objective_weight` for the objective and `multipliers[i]` for row `i`. Allocates nothing.
    ///
    /// # Errors
    /// The first number that is not finite.
    fn derivatives(
        &self,
        x: &[f64],
        objective_weight: f64,
        multipliers: &[f64],
        work: &mut Self::Workspace,
        out: &mut Evaluation,
    ) -> Result<(), NotFinite>;
}

impl std::fmt::Display for NotFinite {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { entry, value } = self;
        match entry {
            Entry::Variable(variable) => write!(f, "variable {variable} of the start is {value}"),
            Entry::Value { block, element, row } => {
                write!(f, "row {row} of element {element} of block {block} is {value}")
            }
            Entry::FirstDerivative { block, element, row } => {
                write!(f, "a first derivative of row {row} of element {element} of block {block} is {value}")
            }
            Entry::SecondDerivative { block, element } => {
                write!(f, "a second derivative of element {element} of block {block} is {value}")
            }
        }
    }
}
