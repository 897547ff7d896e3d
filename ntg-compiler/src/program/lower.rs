//! Replaces what is meant by what is computed.
//!
//! Takes `model::Problem`, gives [`Program`].
//! Every function goes where it is needed: split into pieces (`pieces.rs`), given its points
//! (`points.rs`), gathered with the others that are evaluated there under the same loops, and made
//! into one kernel for each such place (`kernel.rs`), so that they share their subexpressions.
//! Afterwards: no formula is left outside kernels; equal kernels exist once.

use std::collections::HashMap;

use ntg_structure::{Affine, Arguments, Call, Domain, Group, Integral, Kernel, Place, Points, Row, Structure};

use super::environment::{Environment, identity, loops as positions};
use super::kernel::{Mode, Root, call};
use super::mission;
use super::names::Names;
use super::pieces::{Piece, Role, part_of, split};
use super::points::point_sets;
use super::{KernelBody, Program};
use crate::expr::{Dag, Map, Node, NodeId};
use crate::model::norms::is_norm;
use crate::model::problem::{self as model, Constraint, Imposed, Loop, Problem};
use crate::source::{Lines, Source, Span};

/// Makes a problem's program. `source` is the text that the problem's spans point into.
pub fn lower(problem: Problem, source: &Source) -> Program {
    let mut lowering = Lowering {
        problem,
        source,
        lines: Lines::of(source),
        kernels: Vec::new(),
        bodies: Vec::new(),
        names: Names::default(),
        integrals: Vec::new(),
        integral_ids: HashMap::new(),
        pending: Vec::new(),
        arguments: Vec::new(),
    };
    let mut structure = mission::structure(&mut lowering);
    structure.named = mission::named(&mut lowering);
    structure.measurements = mission::measurements(&mut lowering);
    let pieces = lowering.pieces();
    lowering.gather(pieces, &mut structure);
    let written = lowering.written();
    structure.shown = lowering.groups(written, &mut structure, true);
    while !lowering.pending.is_empty() {
        let pieces = std::mem::take(&mut lowering.pending);
        lowering.gather(pieces, &mut structure);
    }
    structure.arguments = lowering.arguments;
    structure.integrals = lowering.integrals;
    structure.kernels = lowering.kernels;
    Program { structure, kernels: lowering.bodies }
}

/// What has been made so far.
pub(super) struct Lowering<'a> {
    pub(super) problem: Problem,
    source: &'a Source,
    lines: Lines<'a>,
    kernels: Vec<Kernel>,
    bodies: Vec<KernelBody>,
    names: Names,
    integrals: Vec<Integral>,
    integral_ids: HashMap<(NodeId, Vec<Loop>), usize>, // Looked up, never iterated.
    /// Integrands of integrals that turned out to be variables.
    pending: Vec<Piece>,
    /// What tables of limits are evaluated at.
    arguments: Vec<Arguments>,
}

/// Functions that are evaluated together.
struct Gathered {
    loops: Vec<ntg_structure::Loop>,
    domain: Domain,
    purpose: &'static str,
    pieces: Vec<Piece>,
}

impl Lowering<'_> {
    /// All functions of the optimisation problem.
    fn pieces(&mut self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for m in self.problem.measurements.clone() {
            let cost = || Role::Cost { term: m.term };
            pieces.extend(split(&mut self.problem, &m.loops, m.cost, m.span, cost(), &cost));
        }
        let measured: Vec<usize> = self.problem.measurements.iter().map(|m| m.term).collect();
        for (term, t) in self.problem.objective.clone().into_iter().enumerate() {
            if measured.contains(&term) {
                continue;
            }
            let cost = || Role::Cost { term };
            pieces.extend(split(&mut self.problem, &t.loops, t.body, t.span, cost(), &cost));
        }
        for (constraint, c) in self.problem.constraints.clone().into_iter().enumerate() {
            let body = c.body;
            pieces.extend(self.constraint_pieces(constraint, c, body));
        }
        pieces
    }

    /// The pieces of a constraint with a given body.
    fn constraint_pieces(&mut self, number: usize, of: Constraint, body: NodeId) -> Vec<Piece> {
        let role = Role::Constraint { constraint: number, bounds: of.bounds.clone() };
        match (of.imposed, &of.domain) {
            (Imposed::Nowhere, _) => return vec![],
            (Imposed::AtStart(loops), model::Domain::Path(phase, _)) => {
                let domain = model::Domain::Start(phase.clone());
                return vec![Piece { loops, domain, body, role, span: of.span }];
            }
            (Imposed::AtBreakpoints(parts), model::Domain::Path(phase, _)) => {
                let role = Role::AtBreakpoints { constraint: number, bounds: of.bounds.clone() };
                let at = |(loops, part)| {
                    let domain = model::Domain::Path(phase.clone(), part);
                    Piece { loops, domain, body, role: role.clone(), span: of.span }
                };
                return parts.into_iter().map(at).collect();
            }
            _ => {}
        }
        if of.domain == model::Domain::Mission {
            let part = part_of(number, of.loops.len());
            return split(&mut self.problem, &of.loops, body, of.span, role, &part);
        }
        vec![Piece { loops: of.loops, domain: of.domain, body, role, span: of.span }]
    }

    /// Puts pieces that are evaluated at the same place under the same loops into one group.
    fn gather(&mut self, pieces: Vec<Piece>, structure: &mut Structure) {
        let groups = self.groups(pieces, structure, false);
        structure.groups.extend(groups);
    }

    fn groups(&mut self, pieces: Vec<Piece>, structure: &mut Structure, shown: bool) -> Vec<Group> {
        let mut gathered: Vec<Gathered> = Vec::new();
        // By whether they are about what members of a scenario have in common alone, loops and domain.
        let mut known: HashMap<(bool, Vec<ntg_structure::Loop>, Domain), usize> = HashMap::new(); // Looked up, never iterated.
        for piece in pieces {
            let loops = positions(&piece.loops);
            let environment = Environment::of(&piece.loops);
            let is_common = self.is_common(&piece);
            for (domain, purpose) in self.domains(&piece, &environment, structure) {
                let apart = matches!(domain, Domain::Mission);
                let key = (is_common, loops.clone(), domain.clone());
                if let Some(group) = known.get(&key) {
                    gathered[*group].pieces.push(piece.clone());
                    continue;
                }
                if !apart {
                    known.insert(key, gathered.len());
                }
                let pieces = vec![piece.clone()];
                gathered.push(Gathered { loops: loops.clone(), domain, purpose, pieces });
            }
        }
        let first = if shown { 0 } else { structure.groups.len() };
        for (number, group) in gathered.iter().enumerate() {
            let made = self.arguments(group, (first + number, shown));
            self.arguments.extend(made);
        }
        gathered.into_iter().map(|group| self.group(group)).collect()
    }

    /// What tables of the limits along a phase are evaluated at; none of equations, and none inside of sums.
    fn arguments(&mut self, gathered: &Gathered, (group, shown): (usize, bool)) -> Option<Arguments> {
        if !matches!(gathered.domain, Domain::Path { .. }) || self.problem.tables.is_empty() {
            return None;
        }
        let mut found: Vec<((usize, usize), NodeId, &Piece)> = vec![];
        for piece in &gathered.pieces {
            let Role::Constraint { bounds, .. } = &piece.role else { continue };
            if bounds.lower == bounds.upper {
                continue;
            }
            for (axis, argument) in arguments_of_tables(&self.problem.dag, piece.body) {
                let is_known = |known: &((usize, usize), NodeId, &Piece)| {
                    (known.0, known.1) == (axis, argument) && known.2.loops == piece.loops
                };
                if !found.iter().any(is_known) {
                    found.push((axis, argument, piece));
                }
            }
        }
        let label = |piece: &Piece| self.source.snippet(piece.span);
        let roots: Vec<Root<'_>> = found
            .iter()
            .map(|(_, body, piece)| Root { body: *body, loops: &piece.loops, label: label(piece), is_norm: false })
            .collect();
        let axes: Vec<(usize, usize)> = found.iter().map(|(axis, ..)| *axis).collect();
        (!axes.is_empty()).then(|| Arguments { group, shown, call: call(self, "arguments", Mode::Show, &roots), axes })
    }

    /// Costs and constraints as the spec writes them, where helpers stand for corners or not all points are taken; not those that
    /// would need integrals of their own.
    fn written(&mut self) -> Vec<Piece> {
        let mut pieces = Vec::new();
        for (term, t) in self.problem.objective.clone().into_iter().enumerate() {
            let Some(written) = t.written else { continue };
            let cost = || Role::Cost { term };
            let own = split(&mut self.problem, &t.loops, written, t.span, cost(), &cost);
            pieces.extend(self.without_integrals(own));
        }
        for (constraint, c) in self.problem.constraints.clone().into_iter().enumerate() {
            // What is imposed at some points holds at all.
            let written = c.written.or_else(|| (c.imposed != Imposed::Everywhere).then_some(c.body));
            let Some(written) = written else { continue };
            let everywhere = Constraint { imposed: Imposed::Everywhere, ..c };
            let own = self.constraint_pieces(constraint, everywhere, written);
            pieces.extend(self.without_integrals(own));
        }
        pieces
    }

    /// Pieces that need no integrals of their own; else none.
    fn without_integrals(&mut self, pieces: Vec<Piece>) -> Vec<Piece> {
        let is_integral =
            |input: crate::expr::InputId| matches!(self.problem.leaves.leaf(input), model::Leaf::Integral { .. });
        let bodies: Vec<NodeId> = pieces.iter().map(|piece| piece.body).collect();
        if self.problem.dag.inputs_of(&bodies).into_iter().any(is_integral) { vec![] } else { pieces }
    }

    /// Whether a constraint is about shared outputs alone: its rows are the same for several members.
    fn is_common(&self, piece: &Piece) -> bool {
        if self.problem.shared.is_empty() || !matches!(piece.role, Role::Constraint { .. } | Role::AtBreakpoints { .. })
        {
            return false;
        }
        let is_shared = |phase: usize, output: usize| {
            self.problem.shared.iter().any(|shared| (shared.phase, shared.output) == (phase, output))
        };
        let mut flats = 0;
        let leaves = self.problem.dag.inputs_of(&[piece.body]);
        leaves.into_iter().all(|input| match self.problem.leaves.leaf(input) {
            model::Leaf::Flat { phase, output, .. } => {
                flats += 1;
                is_shared(phase.phase, *output)
            }
            _ => true,
        }) && flats > 0
    }

    /// Where a piece is evaluated, and what to call a kernel there.
    fn domains(&self, piece: &Piece, at: &Environment, structure: &mut Structure) -> Vec<(Domain, &'static str)> {
        match &piece.domain {
            model::Domain::Mission => vec![(Domain::Mission, "mission")],
            model::Domain::Start(phase) => vec![(Domain::Start(at.phase(phase)), "initial")],
            model::Domain::End(phase) => vec![(Domain::End(at.phase(phase)), "final")],
            model::Domain::Path(phase, part) => point_sets(&self.problem, phase, piece)
                .into_iter()
                .map(|points| {
                    let purpose = match points {
                        Points::Gauss { .. } | Points::Uniform { .. } => "path",
                        Points::Breakpoints => "breakpoints",
                        Points::LeftLimits => "left_limits",
                        Points::Times { .. } => "times",
                    };
                    let sets = &mut structure.phases[phase.phase].points;
                    let points = sets.iter().position(|p| *p == points).unwrap_or_else(|| {
                        sets.push(points);
                        sets.len() - 1
                    });
                    (Domain::Path { phase: at.phase(phase), points, part: *part }, purpose)
                })
                .collect(),
        }
    }

    fn group(&mut self, gathered: Gathered) -> Group {
        let Gathered { loops, domain, purpose, pieces, .. } = gathered;
        let roots: Vec<Root<'_>> = pieces.iter().map(|piece| self.root(piece)).collect();
        let call = call(self, purpose, Mode::Solve, &roots);
        let (rows, bounds) = self.rows(&pieces);
        Group { loops, domain, call, rows, bounds }
    }

    /// The function of a piece.
    fn root<'p>(&self, piece: &'p Piece) -> Root<'p> {
        let is_limit = matches!(piece.role, Role::Constraint { .. });
        Root {
            body: piece.body,
            loops: &piece.loops,
            label: self.source.snippet(piece.span),
            is_norm: is_limit && is_norm(&self.problem, piece.body),
        }
    }

    /// What the rows are, and the call that computes their bounds.
    fn rows(&mut self, pieces: &[Piece]) -> (Vec<Row>, Option<Call>) {
        let source = self.source;
        let row_of = |node: Option<NodeId>, piece: &Piece, list: &mut Vec<(NodeId, Vec<Loop>, String)>| {
            let node = node?;
            let found = list.iter().position(|(n, l, _)| *n == node && *l == piece.loops);
            Some(found.unwrap_or_else(|| {
                list.push((node, piece.loops.clone(), source.snippet(piece.span)));
                list.len() - 1
            }))
        };
        let mut list = Vec::new();
        let rows = pieces
            .iter()
            .map(|piece| match &piece.role {
                Role::Cost { term } => Row::Cost { term: *term },
                Role::Constraint { constraint, bounds } | Role::AtBreakpoints { constraint, bounds } => {
                    Row::Constraint {
                        constraint: *constraint,
                        lower: row_of(bounds.lower, piece, &mut list),
                        upper: row_of(bounds.upper, piece, &mut list),
                    }
                }
                Role::Part { constraint, index } => Row::Part { constraint: *constraint, index: index.clone() },
                Role::Integral { integral, index } => Row::Integral { integral: *integral, index: index.clone() },
            })
            .collect();
        let call = (!list.is_empty()).then(|| {
            let roots: Vec<Root<'_>> = list
                .iter()
                .map(|(n, l, text)| Root { body: *n, loops: l, label: text.clone(), is_norm: false })
                .collect();
            call(self, "bounds", Mode::Setup, &roots)
        });
        (rows, call)
    }

    /// The number of a kernel with this shape and body, made if there is no equal one.
    pub(super) fn kernel(&mut self, mut shape: Kernel, body: KernelBody) -> usize {
        let equal = |k: usize| {
            let (s, b) = (&self.kernels[k], &self.bodies[k]);
            let shapes = (s.slots, s.data, s.rows, &s.probes) == (shape.slots, shape.data, shape.rows, &shape.probes);
            shapes && b.computes_the_same(&body)
        };
        if let Some(k) = (0..self.kernels.len()).find(|k| equal(*k)) {
            return k;
        }
        shape.name = self.names.distinct(&shape.name);
        self.kernels.push(shape);
        self.bodies.push(body);
        self.kernels.len() - 1
    }

    /// The variable that stands for an integral used under these loops, and which member it is.
    pub(super) fn integral(&mut self, node: NodeId, loops: &[Loop]) -> (usize, Vec<Affine>) {
        let index = identity(loops.len());
        if let Some(known) = self.integral_ids.get(&(node, loops.to_vec())) {
            return (*known, index);
        }
        let integral = self.integrals.len();
        let span = self.problem.origin.get(&node).copied().unwrap_or_default();
        self.integrals.push(Integral { loops: positions(loops), place: self.place(span) });
        self.integral_ids.insert((node, loops.to_vec()), integral);
        let role = Role::Integral { integral, index: index.clone() };
        let pieces = split(&mut self.problem, loops, node, span, role.clone(), &|| role.clone());
        self.pending.extend(pieces);
        (integral, index)
    }

    /// Whether the optimisation chooses a phase's duration.
    pub(super) fn duration_is_free(&self, phase: usize) -> bool {
        matches!(self.problem.phases[phase].duration, model::Duration::Free(_))
    }

    /// Whether the optimisation moves a phase's start.
    pub(super) fn start_is_free(&self, phase: usize) -> bool {
        let this = &self.problem.phases[phase];
        matches!(self.problem.agents[this.agent].start, model::Start::Free(_))
            || (this.family.is_some() && self.duration_is_free(phase))
            || self.before(phase).any(|p| self.duration_is_free(p))
    }

    /// Whether a phase starts at time 0, whatever the parameters.
    pub(super) fn start_is_zero(&self, phase: usize) -> bool {
        let this = &self.problem.phases[phase];
        let at_zero = matches!(self.problem.agents[this.agent].start, model::Start::Fixed(None));
        at_zero && this.after.is_none() && this.family.is_none()
    }

    /// The phases before a phase.
    fn before(&self, phase: usize) -> impl Iterator<Item = usize> {
        std::iter::successors(self.problem.phases[phase].after, |p| self.problem.phases[*p].after)
    }

    /// How the spec is called in messages.
    pub(super) fn source_name(&self) -> &str {
        &self.source.name
    }

    /// Where something stands, for structures that outlive the source.
    pub(super) fn place(&self, span: Span) -> Place {
        let at = self.lines.place(span.start);
        let number = |n: usize| u32::try_from(n).unwrap_or(u32::MAX);
        Place { line: number(at.line), column: number(at.column), text: self.source.snippet(span) }
    }
}

/// The arguments of the tables in an expression, each with its table and axis; constants and what stands in sums are left out.
fn arguments_of_tables(dag: &Dag, body: NodeId) -> Vec<((usize, usize), NodeId)> {
    let (mut open, mut known, mut found) = (vec![body], Map::default(), vec![]);
    while let Some(node) = open.pop() {
        if known.insert(node, ()).is_some() || matches!(dag.node(node), Node::Reduce { .. }) {
            continue;
        }
        if let Node::Table { table, args, .. } = dag.node(node) {
            let own = args.iter().enumerate().filter(|(_, argument)| dag.is_constant(**argument).is_none());
            found.extend(own.map(|(axis, argument)| ((*table as usize, axis), *argument)));
        }
        dag.node(node).for_each_operand(|operand| open.push(operand));
    }
    found
}
