//! What was written, in the user's order and names.
//!
//! Takes nothing, gives the types that `syntax::parse` fills. Every node has the span of its text.
//! White space and plain comments are not here (`syntax::comments` keeps those aside), and
//! neither are parentheses: a sum inside a product says that there were some.
//!
//! Sums and products are lists, however long, so that no pass recurses on their length. What does
//! nest (brackets, `^`, unary minus, blocks) nests at most `syntax::MAX_DEPTH` deep, so recursion
//! on it is safe; so are `Clone`, `PartialEq` and `Drop` as derived.
//!
//! Afterwards: units that the language gives to several elements at once, `(1, 2) [km]`,
//! `1 .. 5 [kg]`, `output x, y [km]`, stand on each element that takes them (the unit's span tells
//! where it was written); relations are `==`, `<=` or `>=`; names are in Unicode form NFC and not
//! reserved. Whether names mean anything is the affair of the next stage.

use crate::source::Span;

pub use super::expression::*;

/// A whole spec: exactly one problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// The problem.
    pub problem: Problem,
}

/// `/// doc` `problem Name { items }`.
#[derive(Clone, Debug, PartialEq)]
pub struct Problem {
    /// The doc comment before it.
    pub doc: Option<Doc>,
    /// Its name, which becomes the generated type's.
    pub name: Ident,
    /// What it declares, in the user's order.
    pub items: Vec<Item>,
    /// From `problem` to the closing brace.
    pub span: Span,
}

/// The lines of a `///` comment, without the slashes and one blank after them, joined by line breaks.
#[derive(Clone, Debug, PartialEq)]
pub struct Doc {
    /// The text.
    pub text: String,
    /// From the first slash to the end of the last line.
    pub span: Span,
}

/// A declaration with the doc comment before it.
#[derive(Clone, Debug, PartialEq)]
pub struct Item {
    /// The doc comment before it.
    pub doc: Option<Doc>,
    /// What is declared.
    pub kind: ItemKind,
    /// From its first word to its `;` or closing brace, the doc comment excluded.
    pub span: Span,
}

/// Everything that may stand in a problem, an agent or a phase.
#[derive(Clone, Debug, PartialEq)]
pub enum ItemKind {
    /// `const N = 3;`
    Const(Const),
    /// `param v_max = 0.25 [km/s];`, `param start_x[N] = (-100, -97) [km];`
    Param(Param),
    /// `variable m0 in 1 .. 5 [kg];`
    Variable(Variable),
    /// `output x, y [km]: spline(order = 5, intervals = 8);`
    Output(Output),
    /// `fn blend(u, w) = 1 / (1 + exp(-u / w));`
    Function(Function),
    /// `let speed [km/s] = hypot(der(x), der(y));`
    Let(Let),
    /// `table f(s [m]) [kN] = linear { 0: 1; 6: 2; }`, also with `param` before it.
    Table(Table),
    /// `continuation width = (20, 10, 5) [deg];`
    Continuation(Continuation),
    /// `duration T in 1 .. 9 [s];`
    Duration(Duration),
    /// `start in 0 .. 600 [s];`, in an agent or the problem.
    Start(Extent),
    /// `phase exposed after covert { ... }`
    Phase(Phase),
    /// `agent uav[i in 1 .. 3] { ... }`
    Agent(Agent),
    /// `jump x, m;`, in a phase.
    Jump(Jump),
    /// `continuous x up to 1;`, in a phase.
    Continuous(Continuous),
    /// `collocation gauss(points = 5);`
    Collocation(Collocation),
    /// `minimize fuel [kg]: m0;`
    Objective(Objective),
    /// `trajectory { ... }` and its three sisters.
    Block(Block),
    /// `guess { ... }`
    Guess(Guess),
}

/// `const name = value;`
#[derive(Clone, Debug, PartialEq)]
pub struct Const {
    /// Its name.
    pub name: Ident,
    /// Its value.
    pub value: Expr,
}

/// `param name = value;` or `param name[size] = (values);`
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: Ident,
    /// The number of elements, for an array.
    pub size: Option<Expr>,
    /// The default.
    pub default: Values,
}

/// One expression, or a tuple of them: what stands where a list may stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Values {
    /// The elements, one at least.
    pub elements: Vec<Expr>,
    /// Whether it was written as a tuple, with parentheses around and a comma or a unit after
    /// (`(1)` by itself is an expression in parentheses).
    pub is_tuple: bool,
    /// All of it, with the unit after it.
    pub span: Span,
}

/// `variable name in bounds;` or `variable name;`
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Its name.
    pub name: Ident,
    /// Its unit where no bound tells it: `variable m0 [kg];`.
    pub unit: Option<Unit>,
    /// Its bounds.
    pub bounds: Option<Bounds>,
}

/// `lower .. upper`; one of the two at least is there.
#[derive(Clone, Debug, PartialEq)]
pub struct Bounds {
    /// The lower end.
    pub lower: Option<Expr>,
    /// The upper end.
    pub upper: Option<Expr>,
    /// Both ends and the dots.
    pub span: Span,
}

/// `output names: spline(...);`
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// The outputs declared at once, one at least.
    pub names: Vec<OutputName>,
    /// What they are made of.
    pub spline: Spline,
}

/// `x`, `x [km]`, `x[1 .. N]` or `x[1 .. N] [km]` in a list of outputs.
#[derive(Clone, Debug, PartialEq)]
pub struct OutputName {
    /// Its name.
    pub name: Ident,
    /// The size, for an array.
    pub size: Option<Size>,
    /// Its unit: its own, else the last one of the list.
    pub unit: Option<Unit>,
    /// Name, size and its own unit.
    pub span: Span,
}

/// `first .. last` as a size.
#[derive(Clone, Debug, PartialEq)]
pub struct Size {
    /// The first index (the next stage wants it to be 1).
    pub first: Expr,
    /// The last index, included.
    pub last: Expr,
    /// Both ends and the dots.
    pub span: Span,
}

/// `spline(order = k, intervals = l, smoothness = m)` or `knots = (0, ..., 1)` instead of `intervals`.
#[derive(Clone, Debug, PartialEq)]
pub struct Spline {
    /// k: degree + 1.
    pub order: Option<Expr>,
    /// l: the number of knot intervals.
    pub intervals: Option<Expr>,
    /// Breakpoints in scaled time.
    pub knots: Option<Values>,
    /// m: smoothness conditions at each interior knot.
    pub smoothness: Option<Expr>,
    /// From `spline` to the parenthesis.
    pub span: Span,
}

/// `fn name(parameters) = body;`
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Its name.
    pub name: Ident,
    /// Its parameters, one at least.
    pub parameters: Vec<Ident>,
    /// Its value.
    pub body: Expr,
}

/// `let name = value;`, `let name[i in 1 .. N] [unit] = value;`
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// Its name.
    pub name: Ident,
    /// The index, for a family.
    pub family: Option<IndexRange>,
    /// The unit it is shown in.
    pub unit: Option<Unit>,
    /// Its value.
    pub value: Expr,
}

/// `table name(axes) [unit] = method { rows }` or `... = method from "file";`
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Whether `param` stood before it: nodes and values may be replaced at run time.
    pub is_param: bool,
    /// Its name.
    pub name: Ident,
    /// Its arguments, one at least.
    pub axes: Vec<Axis>,
    /// The unit of its values.
    pub unit: Option<Unit>,
    /// How it is interpolated.
    pub method: Method,
    /// Where its numbers are.
    pub data: TableData,
}

/// `elevation even [deg]`: an argument of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Its name.
    pub name: Ident,
    /// `even` or `periodic`.
    pub symmetry: Option<Symmetry>,
    /// The unit of its nodes.
    pub unit: Option<Unit>,
    /// All of it.
    pub span: Span,
}

/// How a table's axis goes on beyond its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Symmetry {
    /// Mirrored at 0.
    Even,
    /// Closed.
    Periodic,
}

/// `fit bspline(order = 4, intervals = (16, 6), extrapolate = linear)`: how a table is interpolated.
#[derive(Clone, Debug, PartialEq)]
pub struct Method {
    /// Which method.
    pub kind: MethodKind,
    /// Order of the splines; `bspline` and `fit bspline` only.
    pub order: Option<Expr>,
    /// Intervals along each axis; `fit bspline` only.
    pub intervals: Option<Values>,
    /// What the table does outside its nodes; `clamp` where it is not said.
    pub extrapolate: Option<Extrapolate>,
    /// All of it.
    pub span: Span,
}

/// The methods of interpolation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MethodKind {
    /// Shape-preserving cubic.
    Monotone,
    /// Interpolation by B-splines.
    Bspline,
    /// Least squares by B-splines.
    FitBspline,
    /// Straight between nodes.
    Linear,
}

/// What a table does outside its nodes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extrapolate {
    /// Keeps its end value.
    Clamp,
    /// Goes on with its end slope.
    Linear,
}

/// Where a table's numbers are.
#[derive(Clone, Debug, PartialEq)]
pub enum TableData {
    /// In the spec.
    Inline(Rows),
    /// In a file; the path as written between the quotes.
    File {
        /// The path.
        path: String,
        /// The string with its quotes.
        span: Span,
    },
}

/// The rows of an inline table. Whether they are ragged is the next stage's affair.
#[derive(Clone, Debug, PartialEq)]
pub struct Rows {
    /// `0, 30, 31;`: the nodes of the second argument, if there is such a row.
    pub header: Option<Vec<Expr>>,
    /// `20: 2.5, 2.5, 5.5;`, one row for each node of the first argument.
    pub rows: Vec<Row>,
    /// From brace to brace.
    pub span: Span,
}

/// `node: values;`
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// The node of the first argument.
    pub node: Expr,
    /// The values there, one at least.
    pub values: Vec<Expr>,
    /// All of it.
    pub span: Span,
}

/// `continuation name = (values);`
#[derive(Clone, Debug, PartialEq)]
pub struct Continuation {
    /// The parameter that is declared or refined.
    pub name: Ident,
    /// Its values, in the order in which they are solved for.
    pub values: Values,
}

/// `duration T = 5 [s];`, `duration in 60 .. 1500 [s];`
#[derive(Clone, Debug, PartialEq)]
pub struct Duration {
    /// Its name, if it has one.
    pub name: Option<Ident>,
    /// Fixed or free.
    pub extent: Extent,
}

/// A duration or start time: fixed, or free within bounds.
#[derive(Clone, Debug, PartialEq)]
pub enum Extent {
    /// `= value`
    Fixed(Expr),
    /// `in lower .. upper`
    Free(Bounds),
}

/// `phase name[i in 1 .. N] after other { items }`
#[derive(Clone, Debug, PartialEq)]
pub struct Phase {
    /// Its name.
    pub name: Ident,
    /// The index, for a family.
    pub family: Option<IndexRange>,
    /// The phase before it, `leg[i - 1]`.
    pub after: Option<Segment>,
    /// What stands in it.
    pub items: Vec<Item>,
}

/// `agent name[i in 1 .. N] { items }`
#[derive(Clone, Debug, PartialEq)]
pub struct Agent {
    /// Its name.
    pub name: Ident,
    /// The index, for a family.
    pub family: Option<IndexRange>,
    /// What stands in it.
    pub items: Vec<Item>,
}

/// `jump x, m;`: these outputs are not continuous at the start of the phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump {
    /// The outputs, one at least; an index picks one of an array.
    pub outputs: Vec<Segment>,
}

/// `continuous x, y up to 1;`: these outputs are continuous up to that derivative.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuous {
    /// The outputs, one at least; an index picks one of an array.
    pub outputs: Vec<Segment>,
    /// The highest derivative that is continuous.
    pub up_to: Expr,
}

/// `collocation gauss(points = 5, equalities = 3);`, `collocation uniform(breakpoints = 41);`
#[derive(Clone, Debug, PartialEq)]
pub struct Collocation {
    /// Which points.
    pub kind: CollocationKind,
    /// `points`: per knot interval (`gauss`) or per phase (`uniform`, where it is another word for `breakpoints`).
    pub points: Option<Expr>,
    /// `equalities`: points per knot interval at which equalities hold; `gauss` only.
    pub equalities: Option<Expr>,
}

/// Which points a problem is collocated at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CollocationKind {
    /// Gauss-Legendre points of each knot interval.
    Gauss,
    /// Equally spaced over the phase.
    Uniform,
}

/// `minimize e;`, `maximize name [unit]: e;`
#[derive(Clone, Debug, PartialEq)]
pub struct Objective {
    /// Minimise or maximise.
    pub sense: Sense,
    /// The name of the term.
    pub name: Option<Ident>,
    /// The unit it is shown in.
    pub unit: Option<Unit>,
    /// Its value.
    pub value: Expr,
}

/// Which way is better.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// Less is better.
    Minimize,
    /// More is better.
    Maximize,
}

/// `initial { ... }`, `trajectory { ... }`, `final { ... }`, `temporal { ... }`
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Where its constraints hold.
    pub place: BlockPlace,
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
}

/// Something in a block, or a loop around some of it.
#[derive(Clone, Debug, PartialEq)]
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
    /// Its name.
    pub name: Option<Ident>,
    /// What must hold.
    pub relation: Relation,
    /// From its first word to before its `;`, the doc comment excluded.
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
