//! Splits functions of the whole mission into parts that live at points.
//!
//! An objective term or a `temporal` constraint may add up integrals and sums over families.
//! Where they enter linearly, with a factor that is one number for the whole mission, each becomes
//! a *piece* of its own: an integrand along a phase, or a function of one member of a family. The
//! optimisation problem then stays a sum of small functions; a mean value, `integral(..) / T`, is
//! one. What enters otherwise stays inside: integrals become variables of their own, sums become
//! reductions (`kernel.rs`).
//!
//! Takes nodes of `model::Problem`, gives [`Piece`]s.

use ntg_structure::Affine;

use super::environment::identity;
use crate::expr::{Binary, Fold, Node, NodeId, Unary};
use crate::model::problem::{Bounds, Domain, Leaf, Loop, Part, Problem};
use crate::source::Span;

/// What a piece adds to.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Role {
    /// A term of the objective.
    Cost { term: usize },
    /// A constraint row of its own.
    Constraint { constraint: usize, bounds: Bounds },
    /// Constraint rows at the ends of intervals alone.
    AtBreakpoints { constraint: usize, bounds: Bounds },
    /// A constraint row that another piece makes.
    Part { constraint: usize, index: Vec<Affine> },
    /// An integral that is a variable.
    Integral { integral: usize, index: Vec<Affine> },
}

/// A function that is evaluated over a domain for all members of its loops.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) loops: Vec<Loop>,
    pub(super) domain: Domain,
    pub(super) body: NodeId,
    pub(super) role: Role,
    pub(super) span: Span,
}

/// A summand still to be looked at: `factor * node` under further loops.
struct Work {
    node: NodeId,
    factor: NodeId,
    inner: Vec<Loop>,
}

/// Splits `body`, a function of the mission under `outer` loops. The first piece holds what is
/// left after integrals and sums have been taken out and has the role `whole`; the others have
/// the role that `part` gives them.
pub(super) fn split(
    problem: &mut Problem,
    outer: &[Loop],
    body: NodeId,
    span: Span,
    whole: Role,
    part: &dyn Fn() -> Role,
) -> Vec<Piece> {
    let one = problem.dag.constant(1.0);
    let mut rest: Vec<(Vec<Loop>, NodeId)> = vec![(Vec::new(), problem.dag.constant(0.0))];
    let mut pieces = Vec::new();
    let mut stack = vec![Work { node: body, factor: one, inner: Vec::new() }];
    while let Some(work) = stack.pop() {
        match step(problem, &work) {
            Step::Summands(more) => stack.extend(more.into_iter().rev()),
            Step::Integral { domain, integrand } => {
                let loops = [outer, &work.inner].concat();
                pieces.push(Piece { loops, domain, body: integrand, role: part(), span });
            }
            Step::Rest(node) => match rest.iter_mut().find(|(inner, _)| *inner == work.inner) {
                Some((_, sum)) => *sum = problem.dag.add(*sum, node),
                None => rest.push((work.inner, node)),
            },
        }
    }
    let mut all = Vec::new();
    for (k, (inner, body)) in rest.into_iter().enumerate() {
        let role = if k == 0 { whole.clone() } else { part() };
        let keep = k > 0 || matches!(role, Role::Constraint { .. }) || problem.dag.is_constant(body) != Some(0.0);
        if keep {
            all.push(Piece { loops: [outer, &inner].concat(), domain: Domain::Mission, body, role, span });
        }
    }
    all.extend(pieces);
    all
}

enum Step {
    Summands(Vec<Work>),
    Integral { domain: Domain, integrand: NodeId },
    Rest(NodeId),
}

fn step(problem: &mut Problem, work: &Work) -> Step {
    let again = |node, factor| Work { node, factor, inner: work.inner.clone() };
    match problem.dag.node(work.node).clone() {
        Node::Binary(Binary::Add, a, b) => Step::Summands(vec![again(a, work.factor), again(b, work.factor)]),
        Node::Binary(Binary::Sub, a, b) => {
            let minus = problem.dag.neg(work.factor);
            Step::Summands(vec![again(a, work.factor), again(b, minus)])
        }
        Node::Unary(Unary::Neg, a) => {
            let minus = problem.dag.neg(work.factor);
            Step::Summands(vec![again(a, minus)])
        }
        Node::Binary(Binary::Mul, a, b) if is_number(problem, a) && worth(problem, b) => {
            let factor = problem.dag.mul(work.factor, a);
            Step::Summands(vec![again(b, factor)])
        }
        Node::Binary(Binary::Mul, a, b) if is_number(problem, b) && worth(problem, a) => {
            let factor = problem.dag.mul(work.factor, b);
            Step::Summands(vec![again(a, factor)])
        }
        Node::Binary(Binary::Div, a, b) if is_number(problem, b) && worth(problem, a) => {
            let factor = problem.dag.div(work.factor, b);
            Step::Summands(vec![again(a, factor)])
        }
        Node::Reduce { fold: Fold::Sum, range, body, .. } => {
            let mut inner = work.inner.clone();
            inner.push(problem.ranges[range as usize].clone());
            Step::Summands(vec![Work { node: body, factor: work.factor, inner }])
        }
        Node::Input(id) => match problem.leaves.leaf(id).clone() {
            Leaf::Integral { phase, integrand } => {
                let duration = problem.leaves.id(Leaf::Duration(phase.clone()));
                let duration = problem.dag.input(duration);
                let scaled = problem.dag.mul(work.factor, duration);
                Step::Integral {
                    domain: Domain::Path(phase, Part::WHOLE),
                    integrand: problem.dag.mul(scaled, integrand),
                }
            }
            _ => Step::Rest(problem.dag.mul(work.factor, work.node)),
        },
        _ => Step::Rest(problem.dag.mul(work.factor, work.node)),
    }
}

/// Whether taking a product apart can expose an integral or a sum; otherwise it stays as written.
fn worth(problem: &Problem, node: NodeId) -> bool {
    problem.dag.schedule(&[node]).iter().any(|id| match problem.dag.node(*id) {
        Node::Reduce { .. } => true,
        Node::Input(input) => matches!(problem.leaves.leaf(*input), Leaf::Integral { .. }),
        _ => false,
    })
}

/// Whether the node is one number for the whole mission: parameters, durations, starts and variables make it, and no
/// output does.
fn is_number(problem: &Problem, node: NodeId) -> bool {
    problem.dag.schedule(&[node]).iter().all(|id| match problem.dag.node(*id) {
        Node::Input(input) => matches!(
            problem.leaves.leaf(*input),
            Leaf::Parameter { .. } | Leaf::Index(_) | Leaf::Duration(_) | Leaf::Start(_) | Leaf::Variable { .. }
        ),
        _ => true,
    })
}

/// The role of the parts of a constraint with `count` loops.
pub(super) fn part_of(constraint: usize, count: usize) -> impl Fn() -> Role {
    move || Role::Part { constraint, index: identity(count) }
}
