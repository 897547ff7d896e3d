//! Between which numbers an expression stays, whatever the unknowns are: a tariff by the hour, a sum of sines.
//!
//! Takes nodes of the graph, gives bounds by interval arithmetic; none where something in an expression has none. Parameters
//! have none, since who sets them may change them.

use super::covered;
use super::problem::{At, Constraint, Domain, Duration, Form, IndexId, Leaf, Part, PhaseAt, Problem, Start};
use crate::expr::{Binary, Fold, InputId, Map, Node, NodeId, Unary};
use ntg_structure::{TableExtrapolation, TableMethod};

/// How deep expressions are looked into.
const MAX_DEPTH: usize = 500;

/// The least and the largest value.
type Range = (f64, f64);

/// Ranges that are known, found once for each node.
#[derive(Default)]
pub(super) struct Ranges {
    known: Map<NodeId, Option<Range>>, // Looked up, never iterated.
    /// Of outputs by phase and place, and of variables.
    outputs: Map<(usize, usize), Range>, // Looked up, never iterated.
    variables: Map<usize, Range>,      // Looked up, never iterated.
    indices: Map<IndexId, (i64, i64)>, // Looked up, never iterated.
}

impl Ranges {
    /// Ranges of indices with ends that are numbers alone.
    pub(super) fn of_indices(problem: &Problem) -> Self {
        let of_constraints = problem.constraints.iter().flat_map(|own| &own.loops);
        let of_terms = problem.objective.iter().flat_map(|own| &own.loops);
        let mut ranges = Self::default();
        for over in problem.ranges.iter().chain(of_constraints).chain(of_terms) {
            if let Some(ends) = over.first.as_number().zip(over.last.as_number()) {
                ranges.indices.insert(over.index, ends);
            }
        }
        ranges
    }

    fn index(&self, form: &Form) -> Option<Range> {
        let mut range = (form.constant as f64, form.constant as f64);
        for (index, factor) in &form.terms {
            let (first, last) = self.indices.get(index)?;
            let ends = [first, last].map(|end| *factor as f64 * *end as f64);
            range = (range.0 + ends[0].min(ends[1]), range.1 + ends[0].max(ends[1]));
        }
        Some(range)
    }

    /// Ranges where all outputs and variables are within those of their bounds that are numbers.
    pub(super) fn within(problem: &Problem) -> Self {
        let mut ranges = Self::of_indices(problem);
        let number = |end: Option<NodeId>| end.and_then(|end| problem.dag.is_constant(end));
        let both = |own: &Constraint| {
            let lower = number(own.bounds.lower).or(is_magnitude(problem, own.body).then_some(0.0));
            lower.zip(number(own.bounds.upper))
        };
        ranges.outputs = covered::ranges(problem).into_iter().collect();
        for own in &problem.constraints {
            if let Domain::Path(phase, Part::WHOLE) = &own.domain
                && let Some((lower, upper)) = both(own)
                && moves_along(problem, own.body, phase)
            {
                let known = ranges.known.entry(own.body).or_insert(Some((lower, upper)));
                *known = known.map(|known| (known.0.max(lower), known.1.min(upper)));
            }
        }
        for (place, variable) in problem.variables.iter().enumerate() {
            if let (Some(lower), Some(upper)) = (number(variable.bounds.lower), number(variable.bounds.upper)) {
                ranges.variables.insert(place, (lower, upper));
            }
        }
        ranges
    }

    /// The range of an argument, of which one end may be infinite where it is an output.
    pub(super) fn of_argument(&mut self, problem: &Problem, node: NodeId) -> Option<Range> {
        match problem.dag.node(node) {
            Node::Input(input) => self.output(problem, *input).or_else(|| self.of(problem, node)),
            _ => self.of(problem, node),
        }
    }

    fn output(&self, problem: &Problem, input: InputId) -> Option<Range> {
        match problem.leaves.leaf(input) {
            // Limits along a phase count at its ends too: a mesh without points there leaves them to within what it misses.
            Leaf::Flat { phase, output, order: 0, .. } => self.outputs.get(&(phase.phase, *output)).copied(),
            _ => None,
        }
    }

    /// The range of a node, if it has one.
    pub(super) fn of(&mut self, problem: &Problem, node: NodeId) -> Option<Range> {
        self.look(problem, node, 0).filter(|(least, most)| least.is_finite() && most.is_finite())
    }

    fn look(&mut self, problem: &Problem, node: NodeId, depth: usize) -> Option<Range> {
        if let Some(known) = self.known.get(&node) {
            return *known;
        }
        if depth > MAX_DEPTH {
            return None;
        }
        let mut own = |x: NodeId| self.look(problem, x, depth + 1);
        let range = match *problem.dag.node(node) {
            Node::Const(number) => Some((number.value(), number.value())),
            Node::Input(input) => self.leaf(problem, input),
            Node::Table { table, ref derivative, .. } if derivative.iter().all(|order| *order == 0) => {
                data(problem, table as usize)
            }
            Node::Unary(op, x) => match op {
                Unary::Sin | Unary::Cos => Some((-1.0, 1.0)),
                Unary::Tanh => own(x).map(|(a, b)| (a.tanh(), b.tanh())).or(Some((-1.0, 1.0))),
                Unary::Logistic => Some((0.0, 1.0)),
                Unary::Neg => own(x).map(|(a, b)| (-b, -a)),
                Unary::Exp => own(x).map(|(a, b)| (a.exp(), b.exp())),
                Unary::Sqrt => own(x).filter(|(a, _)| *a >= 0.0).map(|(a, b)| (a.sqrt(), b.sqrt())),
                Unary::Abs => own(x).map(|(a, b)| (a.max(-b).max(0.0), b.max(-a))),
                _ => None,
            },
            Node::Binary(op, a, b) => match (op, own(a), own(b)) {
                (Binary::Add, Some(a), Some(b)) => Some((a.0 + b.0, a.1 + b.1)),
                (Binary::Sub, Some(a), Some(b)) => Some((a.0 - b.1, a.1 - b.0)),
                (Binary::Mul, Some(a), Some(b)) => Some(product(a, b)),
                (Binary::Div, Some(a), Some(b)) if b.0 > 0.0 => Some(product(a, (b.1.recip(), b.0.recip()))),
                (Binary::Min, Some(a), Some(b)) => Some((a.0.min(b.0), a.1.min(b.1))),
                (Binary::Max, Some(a), Some(b)) => Some((a.0.max(b.0), a.1.max(b.1))),
                (Binary::Hypot, Some(a), Some(b)) => {
                    Some((0.0, a.0.abs().max(a.1.abs()).hypot(b.0.abs().max(b.1.abs()))))
                }
                _ => None,
            },
            Node::Powi(x, 2) => own(x).map(|(a, b)| (a.max(-b).max(0.0).powi(2), b.max(-a).powi(2))),
            Node::Select { then, otherwise, .. } => match (own(then), own(otherwise)) {
                (Some(a), Some(b)) => Some((a.0.min(b.0), a.1.max(b.1))),
                _ => None,
            },
            Node::Reduce { fold: Fold::Min | Fold::Max, body, .. } => own(body),
            _ => None,
        };
        self.known.insert(node, range);
        range
    }

    fn leaf(&self, problem: &Problem, input: InputId) -> Option<Range> {
        match problem.leaves.leaf(input) {
            Leaf::Tau => Some((0.0, 1.0)),
            Leaf::Time(at) => clock(problem, at),
            Leaf::Flat { .. } => self.output(problem, input).filter(|(a, b)| a.is_finite() && b.is_finite()),
            Leaf::Index(form) => self.index(form),
            Leaf::Variable { variable, .. } => self.variables.get(variable).copied(),
            _ => None,
        }
    }
}

/// Whether an expression has outputs at the points of a phase, so that what holds there holds wherever it is evaluated.
fn moves_along(problem: &Problem, node: NodeId, along: &PhaseAt) -> bool {
    problem
        .dag
        .inputs_of(&[node])
        .into_iter()
        .any(|input| matches!(problem.leaves.leaf(input), Leaf::Flat { phase, at: At::Here, .. } if phase == along))
}

/// Whether an expression is never negative by what it is.
fn is_magnitude(problem: &Problem, node: NodeId) -> bool {
    matches!(problem.dag.node(node), Node::Unary(Unary::Abs | Unary::Sqrt, _) | Node::Binary(Binary::Hypot, ..))
}

fn product(a: Range, b: Range) -> Range {
    let ends = [a.0 * b.0, a.0 * b.1, a.1 * b.0, a.1 * b.1];
    (ends.into_iter().fold(f64::INFINITY, f64::min), ends.into_iter().fold(f64::NEG_INFINITY, f64::max))
}

/// The times of an agent that begins and whose phases last as numbers say.
fn clock(problem: &Problem, at: &PhaseAt) -> Option<Range> {
    let agent = &problem.agents[problem.phases[at.phase].agent];
    let start = match agent.start {
        Start::Fixed(start) => start.map_or(Some(0.0), |start| problem.dag.is_constant(start))?,
        Start::Free(_) => return None,
    };
    let durations = agent.phases.iter().map(|phase| match problem.phases[*phase].duration {
        Duration::Fixed(duration) => problem.dag.is_constant(duration),
        _ => None,
    });
    Some((start, start + durations.sum::<Option<f64>>()?))
}

/// The values of a table that stays between those at its nodes.
fn data(problem: &Problem, table: usize) -> Option<Range> {
    let table = problem.tables.get(table)?;
    let stays = matches!(table.method, TableMethod::Linear | TableMethod::Monotone)
        && table.extrapolation == TableExtrapolation::Clamp
        && !table.replaceable;
    let ends = || table.values.iter().copied();
    stays.then(|| (ends().fold(f64::INFINITY, f64::min), ends().fold(f64::NEG_INFINITY, f64::max)))
}
