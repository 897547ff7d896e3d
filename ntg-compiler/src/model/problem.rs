//! What is meant: the vocabulary between the user's text and the functions to be computed.
//!
//! A [`Problem`] has no names left in expressions: every expression is a node of one [`Dag`] whose
//! inputs are [`Leaf`]s, in SI units. Time derivatives are in *real* time here; scaled time comes
//! with `program`. Arrays, loops, phases and agents are families: an index is a [`Form`] in
//! [`IndexId`]s, and whoever holds an expression also holds the [`Loop`]s that bind its indices.

use ntg_structure::{Block, Grid, Helper, Independent, Parameter, Shared, Spline, Table, Unit};

use crate::diagnostic::Diagnostic;
use crate::expr::{Dag, InputId, Map, NodeId};
use crate::source::Span;

/// A loop index, unique in the whole problem.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct IndexId(pub u32);

/// A whole number, affine in loop indices.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Default)]
pub struct Form {
    /// The part that depends on no index.
    pub constant: i64,
    /// `(index, coefficient)` by increasing index, without zero coefficients.
    pub terms: Vec<(IndexId, i64)>,
}

/// An index and its values `first ..= last`; the ends may name the indices of outer loops.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct Loop {
    /// The index.
    pub index: IndexId,
    /// Its first value.
    pub first: Form,
    /// Its last value; the loop is empty when it is smaller than `first`.
    pub last: Form,
}

/// A phase, and which member of which families it is.
#[derive(Clone, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct PhaseAt {
    /// Index into `Problem::phases`.
    pub phase: usize,
    /// The agent's member, when the agent is a family.
    pub agent: Option<Form>,
    /// The phase's member, when the phase is a family.
    pub index: Option<Form>,
}

/// At which point of a phase, and which part of it. The index of [`At::Among`] is the number of an [`IndexId`] here.
pub use ntg_structure::{At, Instant, Part, Places};

/// What an input of the expression graph means.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Leaf {
    /// A flat output or its derivative in real time.
    Flat {
        /// The phase whose spline it is.
        phase: PhaseAt,
        /// The point of that phase.
        at: At,
        /// Index into that phase's `outputs`.
        output: usize,
        /// The member, when the output is an array.
        index: Option<Form>,
        /// Order of the derivative with respect to real time.
        order: usize,
    },
    /// Mission time at the point of evaluation in this phase, seconds.
    Time(PhaseAt),
    /// The scaled time at the point of evaluation, 0..1.
    Tau,
    /// A phase's duration, seconds.
    Duration(PhaseAt),
    /// The mission time at which a phase starts, seconds.
    Start(PhaseAt),
    /// A parameter.
    Parameter {
        /// Index into `Problem::parameters`.
        parameter: usize,
        /// The member, when it is an array.
        index: Option<Form>,
    },
    /// A declared variable.
    Variable {
        /// Index into `Problem::variables`.
        variable: usize,
        /// The member, when it is an array.
        index: Option<Form>,
    },
    /// An index expression as a number.
    Index(Form),
    /// The integral of an expression over real time along one phase.
    Integral {
        /// The phase.
        phase: PhaseAt,
        /// The integrand: an expression at a point of that phase.
        integrand: NodeId,
    },
    /// A placeholder of the compiler's own (for `partial`); none is left in a finished problem.
    Symbol(u32),
}

/// All leaves of a problem: `InputId(i)` is `leaves[i]`.
#[derive(Clone, Debug, Default)]
pub struct Leaves {
    list: Vec<Leaf>,
    ids: Map<Leaf, InputId>, // Looked up, never iterated.
}

impl Leaves {
    /// The input that stands for a leaf; the same leaf is always the same input.
    pub fn id(&mut self, leaf: Leaf) -> InputId {
        if let Some(id) = self.ids.get(&leaf) {
            return *id;
        }
        let id = InputId(u32::try_from(self.list.len()).expect("fewer than 2^32 leaves fit in memory"));
        self.list.push(leaf.clone());
        self.ids.insert(leaf, id);
        id
    }

    /// What an input stands for.
    pub fn leaf(&self, id: InputId) -> &Leaf {
        &self.list[id.0 as usize]
    }
}

/// Bounds as expressions of parameters and indices alone.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Bounds {
    /// The lower bound, if there is one.
    pub lower: Option<NodeId>,
    /// The upper bound, if there is one.
    pub upper: Option<NodeId>,
}

/// A free number, constant in time.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Its members, when it is an array (ends are constants).
    pub family: Option<Loop>,
    /// The indices of its elements, when it is a matrix, whose members go row by row.
    pub grid: Option<Grid>,
    /// Its bounds, those of each member for an array.
    pub bounds: Bounds,
    /// Where it is declared.
    pub span: Span,
}

/// When an agent starts.
#[derive(Clone, Debug)]
pub enum Start {
    /// At a fixed time in seconds; none: 0.
    Fixed(Option<NodeId>),
    /// At a free time within bounds.
    Free(Bounds),
}

/// An independent timeline.
#[derive(Clone, Debug)]
pub struct Agent {
    /// Its name; none for the one agent of a problem that declares none.
    pub name: Option<String>,
    /// Its members, when it is a family (ends are constants).
    pub family: Option<Loop>,
    /// When it starts.
    pub start: Start,
    /// The name of its whole duration beside phases.
    pub duration_name: Option<String>,
    /// Its phases in order of time, as indices into `Problem::phases`.
    pub phases: Vec<usize>,
    /// Where it is declared.
    pub span: Span,
}

/// How long a phase lasts.
#[derive(Clone, Debug)]
pub enum Duration {
    /// A fixed time in seconds.
    Fixed(NodeId),
    /// A free time within bounds.
    Free(Bounds),
}

/// A flat output in one phase.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its name; the same name in another phase of the agent is the same output.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Its members `first ..= last`, when it is an array (ends are constants).
    pub family: Option<(i64, i64)>,
    /// The indices of its elements, when it is a matrix, whose members go row by row.
    pub grid: Option<Grid>,
    /// How many elements each of its vectors has: all of an array that is declared by its size alone, else its columns.
    pub vector: Option<usize>,
    /// Its spline in this phase.
    pub spline: Spline,
    /// Where it is declared.
    pub span: Span,
}

/// How a phase is discretised.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Collocation {
    /// Gauss-Legendre points in every knot interval.
    Gauss {
        /// Points for the integrals and inequalities.
        points: usize,
        /// Points for equalities; the same number unless told.
        equalities: usize,
        /// Whether inequalities hold at the ends of intervals too.
        ends: bool,
    },
    /// Equally spaced breakpoints, trapezoid rule.
    Uniform {
        /// How many, both ends included.
        points: usize,
    },
}

/// A stretch of an agent's time with its own splines.
#[derive(Clone, Debug)]
pub struct Phase {
    /// Its name; none for the one phase of an agent that declares none.
    pub name: Option<String>,
    /// Index into `Problem::agents`.
    pub agent: usize,
    /// Its members, when it is a family: consecutive stretches of time (ends are constants).
    pub family: Option<Loop>,
    /// The phase (family) it follows.
    pub after: Option<usize>,
    /// How long it, or each of its members, lasts.
    pub duration: Duration,
    /// The name of the duration.
    pub duration_name: Option<String>,
    /// The outputs.
    pub outputs: Vec<Output>,
    /// How it is discretised.
    pub collocation: Collocation,
    /// Where it is declared.
    pub span: Span,
}

/// Where an expression lives.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Domain {
    /// At no single point.
    Mission,
    /// At a phase's start.
    Start(PhaseAt),
    /// At a phase's end.
    End(PhaseAt),
    /// Along a part of a phase.
    Path(PhaseAt, Part),
}

/// At which points of its domain a constraint is imposed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum Imposed {
    /// At all.
    #[default]
    Everywhere,
    /// At the start of its phase, for the members of these loops: from there the equations of motion keep it.
    AtStart(Vec<Loop>),
    /// At the ends of the intervals of parts of its phase, for the members of the loops beside each: what drifts in between is taken
    /// back there (docs/maths.md, section 4.9).
    AtBreakpoints(Vec<(Vec<Loop>, Part)>),
    /// At the points of the integrands alone: it is about a number that has its values there and means nothing in between.
    AtIntegrands,
    /// At none: the phase before ends where it holds.
    Nowhere,
}

/// `lower <= body <= upper`, at every point of the domain, for all members of the loops.
#[derive(Clone, Debug)]
pub struct Constraint {
    /// Its name with the path of its agent and phase, if it has one.
    pub name: Option<String>,
    /// Where it stands; its text is its name where there is none.
    pub span: Span,
    /// The block it stands in.
    pub block: Block,
    /// The unit in which violations are reported.
    pub unit: Unit,
    /// The loops around it: agent, phase, then `for`s, then those of its sides.
    pub loops: Vec<Loop>,
    /// How many of its loops go through the sides of its corners.
    pub sides: usize,
    /// The body as it was written, where helpers stand for corners in its integrals.
    pub written: Option<NodeId>,
    /// Where it holds.
    pub domain: Domain,
    /// Where it is imposed.
    pub imposed: Imposed,
    /// What is bounded.
    pub body: NodeId,
    /// Bounds; an equality has the same node twice.
    pub bounds: Bounds,
}

/// An equation with corners, in its two forms; constraints by their numbers.
#[derive(Clone, Debug)]
pub struct Relaxation {
    /// The form with helpers.
    pub equation: usize,
    /// The form as it is written.
    pub other: usize,
    /// The helpers.
    pub helpers: Vec<Helper>,
    /// Where the corners are.
    pub corners: Vec<Span>,
    /// Whether inputs have no part in the corners.
    pub exact_first: bool,
}

/// A term of the objective, always to be minimised (negated for `maximize`).
#[derive(Clone, Debug)]
pub struct Term {
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Where it stands.
    pub span: Span,
    /// The unit in which it is reported.
    pub unit: Unit,
    /// The loops around it: its members add up.
    pub loops: Vec<Loop>,
    /// An expression of the whole mission; its [`Leaf::Flat`]s say their phase and point.
    pub body: NodeId,
    /// The expression as it was written, where helpers stand for its corners in `body`.
    pub written: Option<NodeId>,
}

/// What was measured: a part of a term of the objective.
#[derive(Clone, Debug)]
pub struct Measurement {
    /// Index into `Problem::objective`; the body of that term is 0.
    pub term: usize,
    /// Where it stands.
    pub span: Span,
    /// The unit in which residuals are reported.
    pub unit: Unit,
    /// The loops around it.
    pub loops: Vec<Loop>,
    /// The left side without the right one.
    pub residual: NodeId,
    /// Its standard deviation, which nothing that is solved for changes.
    pub sigma: NodeId,
    /// Half the square of their ratio.
    pub cost: NodeId,
}

/// A `let`.
#[derive(Clone, Debug)]
pub struct Named {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// The unit in which it is shown.
    pub unit: Unit,
    /// Where it stands.
    pub span: Span,
    /// Whose it is, as an index into `Problem::agents`.
    pub agent: usize,
    /// The loops around it: agent, phase, then its own family's.
    pub loops: Vec<Loop>,
    /// Whether the last loop is a family of the `let` itself.
    pub family: bool,
    /// [`Domain::Path`], or [`Domain::Mission`] for a number.
    pub domain: Domain,
    /// What it is.
    pub body: NodeId,
}

/// To which stretch of time a guess belongs.
#[derive(Clone, Debug, PartialEq)]
pub enum GuessScope {
    /// One phase.
    Phase(PhaseAt),
    /// All phases of an agent (member).
    Agent(usize, Option<Form>),
}

/// What is guessed. Expressions depend on parameters, indices, [`Leaf::Tau`] and guessed
/// durations ([`Leaf::Duration`], [`Leaf::Start`], [`Leaf::Time`]) alone.
#[derive(Clone, Debug)]
pub enum GuessKind {
    /// An output along its scope.
    Output {
        /// The output's name.
        output: String,
        /// The member, when it is an array.
        index: Option<Form>,
        /// Its value.
        value: NodeId,
    },
    /// Outputs along a polygon.
    Route {
        /// The outputs' names and members.
        outputs: Vec<(String, Option<Form>)>,
        /// Way-points, each with one coordinate an output.
        points: Vec<Vec<NodeId>>,
    },
    /// The duration of the scope, seconds.
    Duration(NodeId),
    /// A declared variable: which, its member when it is an array, and its value.
    Variable(usize, Option<Form>, NodeId),
    /// The start of the scope's agent, seconds.
    Start(NodeId),
}

/// One statement of a guess block.
#[derive(Clone, Debug)]
pub struct Guess {
    /// The loops around it.
    pub loops: Vec<Loop>,
    /// Where it applies.
    pub scope: GuessScope,
    /// What it says.
    pub kind: GuessKind,
}

/// A parameter solved for in turn.
#[derive(Clone, Debug)]
pub struct Continuation {
    /// Index into `Problem::parameters`.
    pub parameter: usize,
    /// Values in order, SI.
    pub steps: Vec<f64>,
}

/// What a spec means.
#[derive(Clone, Debug, Default)]
pub struct Problem {
    /// Its name.
    pub name: String,
    /// Its documentation.
    pub doc: String,
    /// Where its name stands.
    pub span: Span,
    /// All expressions.
    pub dag: Dag,
    /// What the graph's inputs mean.
    pub leaves: Leaves,
    /// What the graph's reduction ranges are; `Node::Reduce { index, range, .. }` binds
    /// `IndexId(index)`, and `ranges[range]` has that index too.
    pub ranges: Vec<Loop>,
    /// Where a node was first written.
    pub origin: Map<NodeId, Span>,
    /// Whether the spec says `maximize`.
    pub maximize: bool,
    /// The unit of the objective.
    pub objective_unit: Unit,
    /// What everything is a function of.
    pub independent: Independent,
    /// Parameters with their defaults.
    pub parameters: Vec<Parameter>,
    /// Tables in SI units; `Node::Table { table, .. }` is an index into them.
    pub tables: Vec<Table>,
    /// Outputs that members of scenarios have in common.
    pub shared: Vec<Shared>,
    /// Free numbers.
    pub variables: Vec<Variable>,
    /// Timelines.
    pub agents: Vec<Agent>,
    /// Phases of all agents.
    pub phases: Vec<Phase>,
    /// Terms of the objective.
    pub objective: Vec<Term>,
    /// What was measured.
    pub measurements: Vec<Measurement>,
    /// Places that differ from member to member of a loop.
    pub places: Vec<Places>,
    /// Constraints, continuity between phases included.
    pub constraints: Vec<Constraint>,
    /// Where a gradient may jump in the objective or a constraint.
    pub corners: Vec<Span>,
    /// Equations with corners for which helpers stand.
    pub relaxations: Vec<Relaxation>,
    /// Named expressions.
    pub named: Vec<Named>,
    /// Guesses, in the order of the spec.
    pub guesses: Vec<Guess>,
    /// Parameters solved for in turn.
    pub continuations: Vec<Continuation>,
    /// What the user should know though nothing is wrong.
    pub notes: Vec<Diagnostic>,
}
