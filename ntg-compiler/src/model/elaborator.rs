//! The state of the one pass that gives a spec its meaning, and its small tools.
//!
//! Names, dimensions and meaning are found together: `expression` and its sisters turn an
//! expression of the spec into a [`Value`] in a [`Context`]; every finding is kept, none ends the
//! pass. A template that several phases share is elaborated once for each, so findings
//! are kept without repetition.

use std::cell::{Cell, RefCell};
use std::collections::hash_map::Entry;
use std::collections::{HashMap, HashSet};
use std::rc::Rc;

use ntg_structure::Unit;

use super::Loader;
use super::bodies::Bodies;
use super::constants::Constant;
use super::definitions::{Memo, MemoKey};
use super::derivatives::{Jump, Lacking};
use super::dimension::Dimension;
use super::files::Contents;
use super::helps::Noted;
use super::kinds::Kinds;
use super::known_shapes::KnownShapes;
use super::problem::{Form, IndexId, Leaf, Loop, PhaseAt, Problem};
use super::rates::{FunctionNeeds, Rates};
use super::scope::{Context, Declared, Entity, Local, Scope, ScopeId};
use super::shape::{Ends, FunctionKey, Shape};
use super::soft::Slack;
use super::units::{self, Quantity};
use super::value::{Flaw, OpenIndex, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{self, Map, NodeId, Set};
use crate::source::{Source, Span};
use crate::syntax::ast;

/// A `const` or `let`.
pub(super) struct Definition<'a> {
    pub(super) name: &'a ast::Ident,
    pub(super) doc: String,
    pub(super) unit: Option<&'a ast::Unit>,
    /// The indices of its family, then the stated size of its members.
    pub(super) shape: Option<&'a ast::Shape>,
    pub(super) value: &'a ast::Expr,
    pub(super) scope: ScopeId,
    pub(super) is_const: bool,
    pub(super) span: Span,
}

impl<'a> Definition<'a> {
    /// The names of the indices of its family.
    pub(super) fn indices(&self) -> impl Iterator<Item = &'a ast::Ident> + use<'a> {
        self.shape.into_iter().flat_map(|shape| shape.axes.iter().filter_map(|axis| axis.index.as_ref()))
    }

    /// Whether the size of its members is stated.
    pub(super) fn is_sized(&self) -> bool {
        self.shape.is_some_and(|shape| shape.axes.iter().any(|axis| axis.index.is_none()))
    }
}

/// A `fn` and where it stands.
pub(super) struct FunctionDeclaration<'a> {
    pub(super) function: &'a ast::Function,
    pub(super) scope: ScopeId,
}

/// A phase as it was declared, before its times and splines are known.
pub(super) struct PhaseDeclaration<'a> {
    pub(super) scope: ScopeId,
    pub(super) agent: usize,
    /// None for the only phase of an agent that declares none.
    pub(super) item: Option<&'a ast::Phase>,
    /// The phase before it.
    pub(super) after: Option<usize>,
    pub(super) span: Span,
}

/// An agent as it was declared.
pub(super) struct AgentDeclaration<'a> {
    pub(super) scope: ScopeId,
    /// None for the only agent of a problem that declares none.
    pub(super) item: Option<&'a ast::Agent>,
    /// In order of time.
    pub(super) phases: Vec<usize>,
}

/// What the signature of a table says, known before its numbers are.
#[derive(Clone)]
pub(super) struct TableSignature {
    pub(super) axes: Vec<(String, Option<Dimension>)>,
    pub(super) dimension: Option<Dimension>,
}

/// A continuation before its parameter is known.
pub(super) struct Steps {
    pub(super) parameter: usize,
    pub(super) values: Vec<f64>,
    pub(super) dimension: Dimension,
    pub(super) place: Span,
    pub(super) name: Span,
}

/// Something in an expression that belongs to no single point.
#[derive(Clone)]
pub(super) struct EventMark {
    pub(super) span: Span,
    pub(super) text: String,
    /// Whether it is only a time, not a boundary value or an integral.
    pub(super) is_time: bool,
}

/// The items of one scope.
pub(super) type Items<'a> = &'a [ast::Item];

/// See the module's header.
pub(super) struct Elaborator<'a> {
    pub(super) source: &'a Source,
    /// Where the spec's own text ends, if texts of libraries stand behind it.
    pub(super) main: Option<u32>,
    /// The folder of each library's scope, for the files that its tables name.
    pub(super) folders: HashMap<ScopeId, String>, // Looked up, never iterated.
    pub(super) loader: &'a dyn Loader,
    /// The constants that are set where the spec is compiled.
    pub(super) given: HashMap<usize, Constant>, // Looked up, never iterated.
    /// The numbers of files that arrays are read from; none of a file that was told of.
    pub(super) files: HashMap<String, Option<Rc<Contents>>>, // Looked up, never iterated.
    pub(super) problem: Problem,
    pub(super) scopes: Vec<Scope<'a>>,
    /// The items of each scope.
    pub(super) items: Vec<Items<'a>>,
    pub(super) definitions: Vec<Definition<'a>>,
    pub(super) functions: Vec<FunctionDeclaration<'a>>,
    pub(super) parameters: Vec<(&'a ast::Ident, Option<Dimension>)>,
    pub(super) variables: Vec<(&'a ast::DeclaredName, Option<Dimension>)>,
    pub(super) tables: Vec<&'a ast::Table>,
    pub(super) signatures: Vec<TableSignature>,
    pub(super) phases: Vec<PhaseDeclaration<'a>>,
    pub(super) agents: Vec<AgentDeclaration<'a>>,
    /// Continuations, until all parameters are known.
    pub(super) pending: Vec<Steps>,
    /// Whether the shape at hand is of an expression with a name that nothing has.
    pub(super) meets_unknown: bool,
    /// Names that a `use` promised and that are not to be had; it was told.
    pub(super) lost: Vec<&'a str>,
    /// Dimensions of the outputs of each phase, as in `Problem::phases`; none where the unit was refused.
    pub(super) output_dimensions: Vec<Vec<Option<Dimension>>>,
    /// Names of indices met so far and where they are bound.
    pub(super) index_names: HashMap<&'a str, Span>, // Looked up, never iterated.
    /// The index over a family of phases that totals use.
    pub(super) total_indices: HashMap<usize, u32>,
    /// The first event time, boundary value or integral in the expression at hand.
    pub(super) event: Option<EventMark>,
    /// The dimension of the independent variable: that of time, or of what `domain` says; none in a spec without units.
    pub(super) time: Dimension,
    /// The declaration of another independent variable.
    pub(super) domain: Option<&'a ast::IndependentVariable>,
    /// The functions being inlined.
    pub(super) inlining: Vec<usize>,
    pub(super) memo: Map<MemoKey, Memo>,
    /// The definitions of which an element was made, with no place, by their contexts.
    pub(super) warmed: Set<MemoKey>, // Asked, never iterated.
    /// The members of definitions that are being elaborated, each inside the one before.
    pub(super) members: Vec<(usize, Vec<Form>)>,
    /// How many of the innermost members made one by one are indices of an element of the constraint in hand.
    pub(super) element_axes: usize,
    /// Axes of parameters, of variables, and of the outputs of each phase.
    pub(super) parameter_axes: Vec<Vec<Ends>>,
    pub(super) variable_axes: Vec<Vec<Ends>>,
    pub(super) output_axes: Vec<Vec<Vec<Ends>>>,
    /// Where the outputs of a phase stand among them, and their units.
    output_places: Map<(usize, &'a str), (usize, Rc<Unit>)>, // Looked up, never iterated.
    /// The units of parameters.
    parameter_units: Map<usize, Rc<Unit>>, // Looked up, never iterated.
    /// Shapes of the members of definitions in each scope, and of functions.
    pub(super) member_shapes: Map<(usize, ScopeId), Option<Shape>>, // Looked up, never iterated.
    /// The axes of definitions with a size, where these are numbers.
    pub(super) written_axes: Map<(usize, ScopeId), Vec<Ends>>, // Looked up, never iterated.
    pub(super) function_shapes: Map<FunctionKey, Option<Shape>>, // Looked up, never iterated.
    /// The contexts inside calls and behind steps.
    pub(super) bodies: Bodies<'a>,
    /// The indices of members of definitions as local names.
    pub(super) member_names: Map<(usize, Vec<Form>), Option<Rc<Local<'a>>>>, // Looked up, never iterated.
    /// The shapes of expressions, kept once all names are declared.
    pub(super) shapes: Option<KnownShapes>,
    /// The definitions whose shapes are being looked for, and whether one needs its own.
    pub(super) shaping: Vec<usize>,
    /// The same with those that are looked for before the shapes that need them.
    pub(super) shapes_open: Vec<usize>,
    pub(super) recurs: bool,
    pub(super) unknown_indices: u32,
    /// Whether shapes of branches are looked for that may not be chosen for all members: their indices may be outside.
    pub(super) may_not_be_chosen: bool,
    /// The sums of squares of which nodes are the roots.
    pub(super) squares: Map<NodeId, NodeId>, // Looked up, never iterated.
    /// An index that something settled must know.
    pub(super) opened: Option<OpenIndex>,
    pub(super) kinds: Kinds,
    /// What helps need to know about the spec.
    pub(super) noted: Noted,
    pub(super) found: Vec<Diagnostic>,
    /// Derivatives that splines do not have.
    pub(super) lacking: Vec<Lacking>,
    /// The derivatives that jump at knots, until all are known.
    pub(super) jumps: Vec<Jump>,
    /// The derivatives of nodes with respect to time in the phase at hand.
    pub(super) time_rates: (Option<PhaseAt>, expr::Rates),
    /// How many times the expression at hand is going to be differentiated.
    pub(super) derivatives_around: usize,
    /// The dimension of the objective, once there is one.
    pub(super) objective_dimension: Option<Dimension>,
    /// The calls whose gradient may jump, where they stand.
    pub(super) kinks: Vec<(NodeId, Span)>,
    /// By how much soft constraints are missed.
    pub(super) slacks: Vec<Slack>,
    /// How many equations `dynamics` has in each phase, where it has any.
    pub(super) equations: HashMap<usize, i64>, // Looked up, never iterated.
    /// The units that were read, by their address in the syntax tree.
    units: Map<*const ast::Unit, (Quantity, Rc<Unit>)>, // Looked up, never iterated.
    /// How often the equations of each phase differentiate its states, where that was asked.
    pub(super) rates: Map<usize, Rates<'a>>, // Looked up, never iterated.
    pub(super) function_needs: FunctionNeeds<'a>,
    /// How many expressions were looked at for that, and how many were elaborated: what tests of growth count.
    pub(super) looks: usize,
    pub(super) elaborated: usize,
    /// What stands in brackets behind the names of definitions, of so many of them, with the first one.
    pub(super) behind_names: RefCell<(usize, HashMap<String, &'a str>)>, // Looked up, never iterated.
    /// How often names like an unknown one were looked for, and among how many.
    pub(super) searched: Cell<(usize, usize)>,
    reported: HashSet<(Code, Span, String)>, // Asked, never iterated.
    pub(super) next_index: u32,
    pub(super) next_symbol: u32,
    steps: usize,
    depth: usize,
}

/// How many expressions inside functions may be elaborated, each use of a function counted. Far
/// above what people write, reached within a second by functions that double one another.
const MAX_STEPS: usize = 1_000_000;

/// How deeply expressions, definitions and functions may nest in one another.
const MAX_DEPTH: usize = 500;

impl<'a> Elaborator<'a> {
    pub(super) fn new(source: &'a Source, loader: &'a dyn Loader) -> Self {
        Self {
            source,
            main: None,
            folders: HashMap::new(),
            loader,
            given: HashMap::new(),
            files: HashMap::new(),
            problem: Problem::default(),
            scopes: Vec::new(),
            items: Vec::new(),
            definitions: Vec::new(),
            functions: Vec::new(),
            parameters: Vec::new(),
            variables: Vec::new(),
            tables: Vec::new(),
            signatures: Vec::new(),
            phases: Vec::new(),
            agents: Vec::new(),
            pending: Vec::new(),
            meets_unknown: false,
            lost: Vec::new(),
            output_dimensions: Vec::new(),
            index_names: HashMap::new(),
            total_indices: HashMap::new(),
            event: None,
            time: Dimension::TIME,
            domain: None,
            inlining: Vec::new(),
            memo: Map::default(),
            warmed: Set::default(),
            members: Vec::new(),
            element_axes: 0,
            parameter_axes: Vec::new(),
            variable_axes: Vec::new(),
            output_axes: Vec::new(),
            output_places: Map::default(),
            parameter_units: Map::default(),
            member_shapes: Map::default(),
            written_axes: Map::default(),
            function_shapes: Map::default(),
            bodies: Bodies::default(),
            member_names: Map::default(),
            shapes: None,
            shaping: Vec::new(),
            shapes_open: Vec::new(),
            recurs: false,
            unknown_indices: 0,
            may_not_be_chosen: false,
            squares: Map::default(),
            opened: None,
            kinds: Kinds::default(),
            noted: Noted::default(),
            found: Vec::new(),
            lacking: Vec::new(),
            jumps: Vec::new(),
            time_rates: Default::default(),
            derivatives_around: 0,
            objective_dimension: None,
            kinks: Vec::new(),
            slacks: Vec::new(),
            equations: HashMap::new(),
            units: Map::default(),
            rates: Map::default(),
            function_needs: HashMap::new(),
            looks: 0,
            elaborated: 0,
            behind_names: RefCell::default(),
            searched: Cell::default(),
            reported: HashSet::new(),
            next_index: 0,
            next_symbol: 0,
            steps: 0,
            depth: 0,
        }
    }

    /// Keeps a finding, unless the same was kept before.
    pub(super) fn report(&mut self, finding: Diagnostic) {
        let key = (finding.code, finding.span, finding.message.clone());
        if self.reported.insert(key) {
            let finding = self.helped(finding);
            self.found.push(finding);
        }
    }

    /// A value that is never reported again.
    pub(super) fn poison(&mut self, span: Span) -> Value {
        let node = self.problem.dag.constant(f64::NAN);
        Value { node, dimension: None, unit: None, span, flaw: Some(Flaw::Reported) }
    }

    /// Keeps a finding and gives the poison in its place.
    pub(super) fn refuse(&mut self, finding: Diagnostic, span: Span) -> Value {
        self.report(finding);
        self.poison(span)
    }

    /// Counts one step of elaboration; refuses when there were too many or they nest too deeply.
    pub(super) fn enter(&mut self, span: Span) -> bool {
        self.depth += 1;
        self.elaborated += 1;
        // Only functions inside functions can make more of a spec than its text.
        self.steps += usize::from(!self.inlining.is_empty());
        if self.steps > MAX_STEPS {
            if self.steps == MAX_STEPS + 1 {
                let message = "this problem is too large to be given a meaning";
                self.report(Diagnostic::new(Code::TooManySteps, span, message).help(
                    "functions that use one another several times double at every level: name the parts by `let`",
                ));
            }
            return false;
        }
        self.is_shallow(span)
    }

    /// As `enter`, for what takes no step: looking for a shape.
    pub(super) fn deeper(&mut self, span: Span) -> bool {
        self.depth += 1;
        self.elaborated += 1;
        self.is_shallow(span)
    }

    fn is_shallow(&mut self, span: Span) -> bool {
        if self.depth > MAX_DEPTH {
            let message = "definitions and functions are nested too deeply here";
            self.report(
                Diagnostic::new(Code::TooDeepMeaning, span, message)
                    .help("use fewer definitions inside one another, or a sum over an index"),
            );
            return false;
        }
        true
    }

    /// Ends what `enter` began.
    pub(super) fn leave(&mut self) {
        self.depth -= 1;
    }

    /// Notes an event time, boundary value or integral in the expression at hand; the latter two matter more.
    pub(super) fn mark_event(&mut self, span: Span, text: String, is_time: bool) {
        if self.event.as_ref().is_none_or(|mark| mark.is_time && !is_time) {
            self.event = Some(EventMark { span, text, is_time });
        }
    }

    /// The context of a text that stands in a scope: a library's own names, else those of the context.
    pub(super) fn home(&self, cx: &Context<'a>, scope: ScopeId) -> Context<'a> {
        if self.scopes[scope].is_library {
            return Context { locals: None, library: Some(scope), ..cx.clone() };
        }
        Context { locals: None, lexical: scope, library: None, ..cx.clone() }
    }

    /// Notes where a node was first written, and the nodes made on the way to it. What stands in a library has the
    /// place where the spec uses it.
    pub(super) fn origin(&mut self, node: NodeId, span: Span) {
        if self.main.is_some_and(|end| span.start > end) || self.problem.origin.contains_key(&node) {
            return;
        }
        let mut open = vec![node];
        while let Some(node) = open.pop() {
            // What has a place already has parts with places.
            if let Entry::Vacant(entry) = self.problem.origin.entry(node) {
                entry.insert(span);
                self.problem.dag.node(node).for_each_operand(|operand| open.push(operand));
            }
        }
    }

    /// The node of a leaf.
    pub(super) fn leaf(&mut self, leaf: Leaf) -> NodeId {
        let id = self.problem.leaves.id(leaf);
        self.problem.dag.input(id)
    }

    /// On what a node depends.
    pub(super) fn kinds(&mut self, node: NodeId) -> super::kinds::Kind {
        self.kinds.of(&self.problem, node)
    }

    /// A new index with its range.
    pub(super) fn new_index(&mut self, first: Form, last: Form) -> Loop {
        let over = Loop { index: IndexId(self.next_index), first, last };
        self.next_index += 1;
        over
    }

    /// The meaning of a unit; what is wrong with it is told.
    pub(super) fn unit(&mut self, unit: &'a ast::Unit) -> Option<(Quantity, Unit)> {
        self.shared_unit(unit).map(|(quantity, shown)| (quantity, (*shown).clone()))
    }

    /// As [`Self::unit`]: a unit in the text is read once, however often what it stands at is elaborated.
    pub(super) fn shared_unit(&mut self, unit: &'a ast::Unit) -> Option<(Quantity, Rc<Unit>)> {
        if let Some(known) = self.units.get(&std::ptr::from_ref(unit)) {
            return Some(known.clone());
        }
        let read = self.read_unit(unit)?;
        self.units.insert(unit, read.clone());
        Some(read)
    }

    fn read_unit(&mut self, unit: &ast::Unit) -> Option<(Quantity, Rc<Unit>)> {
        match units::quantity(unit) {
            Ok(quantity) => Some((quantity, Rc::new(units::shown(unit, &quantity, self.source)))),
            Err(finding) => {
                // A constant in brackets was meant as a size.
                let finding = match unit.factors.as_slice() {
                    [ast::UnitFactor { base: ast::UnitBase::Symbol(name), power: 1, .. }]
                        if self.scopes.iter().any(|scope| scope.names.contains_key(name.text.as_str())) =>
                    {
                        finding.help(format!("as a size write `[1 .. {}]`", name.text))
                    }
                    [ast::UnitFactor { base: ast::UnitBase::Symbol(name), power: 1, .. }]
                        if let Some(family) = self.family_without_range(&name.text) =>
                    {
                        finding.help(format!(
                            "a value for each index is written `let {family}[{} in 1 .. 3] = ...;`",
                            name.text
                        ))
                    }
                    _ => finding,
                };
                self.report(finding);
                None
            }
        }
    }

    /// Where an output of a phase stands among them, and its unit.
    pub(super) fn output_named(&mut self, phase: usize, name: &'a str) -> Option<(usize, Rc<Unit>)> {
        if let Some(known) = self.output_places.get(&(phase, name)) {
            return Some(known.clone());
        }
        let outputs = &self.problem.phases.get(phase)?.outputs;
        let place = outputs.iter().position(|output| output.name == name)?;
        let known = (place, Rc::new(outputs[place].unit.clone()));
        self.output_places.insert((phase, name), known.clone());
        Some(known)
    }

    /// The unit of a parameter that was declared.
    pub(super) fn parameter_unit(&mut self, parameter: usize) -> Rc<Unit> {
        let unit = &self.problem.parameters[parameter].unit;
        self.parameter_units.entry(parameter).or_insert_with(|| Rc::new(unit.clone())).clone()
    }

    /// Declares a name in a scope; tells where that is the second time.
    pub(super) fn declare(&mut self, scope: ScopeId, ident: &'a ast::Ident, declared: Declared) {
        // `min` and `max` make good names for quantities, and calls are told apart by their parentheses.
        let callable = matches!(declared.entity, Entity::Function(_) | Entity::Table(_));
        let taken = super::functions::builtin(&ident.text)
            .filter(|builtin| callable || !matches!(builtin.name(), "min" | "max"));
        if let Some(builtin) = taken {
            let message = format!("`{}` is a function of the language", builtin.name());
            self.report(
                Diagnostic::new(Code::ShadowsFunction, ident.span, message)
                    .help(format!("choose another name, such as `{}_1`", ident.text)),
            );
        }
        if let Some(first) = self.scopes[scope].names.get(ident.text.as_str()) {
            let message = format!("`{}` is declared twice", ident.text);
            let first = first.span;
            self.report(
                Diagnostic::new(Code::DeclaredTwice, ident.span, message)
                    .label(ident.span, "declared again here")
                    .label(first, "first declared here")
                    .help("give one of them another name"),
            );
            return;
        }
        let scope = &mut self.scopes[scope];
        scope.names.insert(&ident.text, declared);
        scope.order.push(&ident.text);
    }

    /// The text of a place, for messages.
    pub(super) fn text(&self, span: Span) -> String {
        self.source.snippet(span)
    }

    /// The same, in parentheses where it may be a sum.
    pub(super) fn grouped(&self, span: Span) -> String {
        let text = self.text(span);
        let whole = text.starts_with('(') && text.ends_with(')') && text.matches('(').count() == 1;
        let sum = text.char_indices().any(|(k, c)| k > 0 && matches!(c, '+' | '-'));
        if sum && !whole { format!("({text})") } else { text }
    }

    /// Whether an error was found.
    pub(super) fn has_failed(&self) -> bool {
        !self.lost.is_empty() || self.found.iter().any(|finding| finding.severity == crate::diagnostic::Severity::Error)
    }
}

/// The text of a doc comment.
pub(super) fn doc_text(doc: &Option<ast::Doc>) -> String {
    doc.as_ref().map(|doc| doc.text.clone()).unwrap_or_default()
}
