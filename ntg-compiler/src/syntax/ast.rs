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

mod expression;
mod statement;
mod table;

pub use expression::*;
pub use statement::*;
pub use table::*;

/// A whole spec: exactly one problem, and the libraries that it uses.
#[derive(Clone, Debug, PartialEq)]
pub struct Spec {
    /// The libraries.
    pub uses: Vec<Use>,
    /// The problem.
    pub problem: Problem,
}

/// A file of constants, functions and tables, without a problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Library {
    /// The libraries that it uses itself.
    pub uses: Vec<Use>,
    /// `const`, `fn` and `table` alone, in the user's order.
    pub items: Vec<Item>,
}

/// `use std::rotation::{about_x, about_z};`, `use "tables/air-3.ntg" as air;`
#[derive(Clone, Debug, PartialEq)]
pub struct Use {
    /// What is used.
    pub target: UseTarget,
    /// Where that stands.
    pub target_span: Span,
    /// The names that are used without the library's own before them.
    pub names: Vec<Ident>,
    /// What the library is called here, if not like its file.
    pub alias: Option<Ident>,
    /// From `use` to before the `;`.
    pub span: Span,
}

/// Where a library is.
#[derive(Clone, Debug, PartialEq)]
pub enum UseTarget {
    /// `std::rotation`: of the language.
    Module(Vec<Ident>),
    /// `"shuttle.ntg"`: the path as written between the quotes.
    File(String),
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
    /// `variable m0 in 1 .. 5 [kg], k [N/m];`
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
    /// `domain s [m];`
    Domain(IndependentVariable),
    /// `duration T in 1 .. 9 [s];`
    Duration(Duration),
    /// `start in 0 .. 600 [s];`, in an agent or the problem.
    Start(Extent),
    /// `phase exposed after covert { ... }`
    Phase(Phase),
    /// `agent uav[i in 1 .. 3] { ... }`
    Agent(Agent),
    /// `scenario plant[k in 1 .. 20] weight p[k] { ... }`
    Scenario(Scenario),
    /// `jump x, m;`, in a phase.
    Jump(Jump),
    /// `continuous x up to 1;`, in a phase.
    Continuous(Continuous),
    /// `periodic x, v up to 1;`
    Periodic(Periodic),
    /// `shared u until 1 [s];`, in a scenario.
    Shared(Shared),
    /// `collocation gauss(points = 5);`
    Collocation(Collocation),
    /// `minimize fuel [kg]: m0;`
    Objective(Objective),
    /// `trajectory { ... }` and its sisters.
    Block(Block),
    /// `at 2.5 [s] { ... }`
    At(AtBlock),
    /// `guess { ... }`
    Guess(Guess),
}

/// `const name = value;` or `const name[size] = (values);`
#[derive(Clone, Debug, PartialEq)]
pub struct Const {
    /// Its name.
    pub name: Ident,
    /// Its size, for a vector or a matrix.
    pub shape: Option<Shape>,
    /// Its value.
    pub value: Expr,
}

/// `[3]`, `[1 .. n, 3]`, `[i in 1 .. n, 3]`: how many elements something has along each axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Shape {
    /// The axes, one at least.
    pub axes: Vec<ShapeAxis>,
    /// From bracket to bracket.
    pub span: Span,
}

/// `3`, `1 .. n` or `i in 1 .. n`: one axis of a shape.
#[derive(Clone, Debug, PartialEq)]
pub struct ShapeAxis {
    /// The name of the index, where the value is written for each of its values.
    pub index: Option<Ident>,
    /// The first index; 1 where none is written.
    pub first: Option<Expr>,
    /// The last index, included.
    pub last: Expr,
    /// All of it.
    pub span: Span,
}

/// `param name = value;` or `param name[size] = (values);`
#[derive(Clone, Debug, PartialEq)]
pub struct Param {
    /// Its name.
    pub name: Ident,
    /// Its size, for an array.
    pub shape: Option<Shape>,
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

/// `variable names;`, each with bounds or without.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// The variables declared at once, one at least.
    pub names: Vec<DeclaredName>,
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

/// `output names: spline(...);`, `state names;`, `input names: held;`
#[derive(Clone, Debug, PartialEq)]
pub struct Output {
    /// Which word declares them.
    pub role: Role,
    /// The outputs declared at once, one at least.
    pub names: Vec<DeclaredName>,
    /// What they are made of.
    pub course: Course,
}

/// What an output is in a system of equations.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// `output`: whatever the constraints make of it.
    Output,
    /// `state`: its derivatives stand in `dynamics`.
    State,
    /// `input`: chosen freely.
    Input,
}

/// How smooth an output is.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a spec has few declarations, and most have a spline")]
pub enum Course {
    /// `: spline(...)`, the only one for `output`.
    Spline(Spline),
    /// `: held`: one value in each interval.
    Held,
    /// `: continuous`: no jumps between intervals.
    Continuous,
    /// Nothing written: as the collocation and the equations ask for.
    Collocated,
}

/// `x`, `x [km]`, `x[1 .. N] [km]` or `m in 750 .. 2000 [kg]` in a list of outputs or variables.
#[derive(Clone, Debug, PartialEq)]
pub struct DeclaredName {
    /// Its name.
    pub name: Ident,
    /// The size, for an array.
    pub shape: Option<Shape>,
    /// Its unit: its own, else the one that the list gives it.
    pub unit: Option<Unit>,
    /// Between what it stays, an output all the way.
    pub bounds: Option<Bounds>,
    /// Name, size, its own unit and bounds.
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

/// `fn name(parameters) [size] [unit] = body;`, or `{ ... }` in place of `= body;`
#[derive(Clone, Debug, PartialEq)]
pub struct Function {
    /// Its name.
    pub name: Ident,
    /// Its parameters, one at least.
    pub parameters: Vec<Argument>,
    /// The stated size of its value.
    pub shape: Option<Shape>,
    /// The stated unit of its value.
    pub unit: Option<Unit>,
    /// Its value.
    pub body: Expr,
}

/// `v`, `v [m/s]`, `r[3] [m]`: a parameter of a function.
#[derive(Clone, Debug, PartialEq)]
pub struct Argument {
    /// Its name.
    pub name: Ident,
    /// Its size, where it is stated; else any.
    pub shape: Option<Shape>,
    /// Its unit, where it is stated; else any.
    pub unit: Option<Unit>,
}

/// `let name = value;`, `let name[i in 1 .. N] [unit] = value;`, `let name[3] = value;`
#[derive(Clone, Debug, PartialEq)]
pub struct Let {
    /// Its name.
    pub name: Ident,
    /// The indices of a family, then the stated size of its members.
    pub shape: Option<Shape>,
    /// The unit it is shown in.
    pub unit: Option<Unit>,
    /// Its value.
    pub value: Expr,
}

/// `continuation name = (values);`
#[derive(Clone, Debug, PartialEq)]
pub struct Continuation {
    /// The parameter that is declared or refined.
    pub name: Ident,
    /// Its values, in the order in which they are solved for.
    pub values: Values,
}

/// `domain s [m];`: what everything is a function of, instead of `t` in seconds.
#[derive(Clone, Debug, PartialEq)]
pub struct IndependentVariable {
    /// Its name.
    pub name: Ident,
    /// The unit it is shown in; none for a pure number.
    pub unit: Option<Unit>,
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

/// `scenario name[k in 1 .. S] weight p[k] { items }`
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Its name.
    pub name: Ident,
    /// The index of its members.
    pub family: IndexRange,
    /// With what a member's terms enter the objective; none: 1 over the number of members.
    pub weight: Option<Expr>,
    /// What stands in it.
    pub items: Vec<Item>,
    /// From `scenario` to before the brace.
    pub head: Span,
}

/// `shared u until 1 [s];`: members of a scenario have the same inputs, up to some time or all the way.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// The inputs, one at least; an index picks one of an array.
    pub inputs: Vec<Segment>,
    /// Until when; all the way where none is written.
    pub until: Option<Expr>,
}

/// `jump x, m;`: these outputs are not continuous at the start of the phase.
#[derive(Clone, Debug, PartialEq)]
pub struct Jump {
    /// The outputs, one at least; an index picks one of an array, a path leads to one of a scenario.
    pub outputs: Vec<Path>,
}

/// `continuous x, y up to 1;`: these outputs are continuous up to that derivative.
#[derive(Clone, Debug, PartialEq)]
pub struct Continuous {
    /// The outputs, as in [`Jump`].
    pub outputs: Vec<Path>,
    /// The highest derivative that is continuous.
    pub up_to: Expr,
}

/// `periodic x, y;`, `periodic x up to 1;`: these outputs end as they begin.
#[derive(Clone, Debug, PartialEq)]
pub struct Periodic {
    /// The outputs, one at least; an index picks one of an array.
    pub outputs: Vec<Segment>,
    /// The highest derivative that ends as it begins; all that are continuous where none is written.
    pub up_to: Option<Expr>,
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
    /// `inequalities = points`: inequalities hold at the points alone, not at the ends of intervals; `gauss` only.
    pub inequalities: Option<Expr>,
    /// `intervals` of every spline that says nothing else.
    pub intervals: Option<Expr>,
    /// `knots` of every spline that says nothing else.
    pub knots: Option<Values>,
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
