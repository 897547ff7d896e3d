//! Which outputs are angles whose values formulas know by their sines and cosines alone (docs/maths.md, sections 8.7 and 11.15).

use std::collections::BTreeMap;

use ntg_structure::Angle;

use super::problem::{Leaf, Problem};
use crate::expr::{Binary, Degree, InputId, Node, NodeId, Set, Unary, degree};

/// Whole turns of an argument are whole turns of another where their ratio is so near to a whole number. Rounding.
const SAME: f64 = 1e-9;

/// How many summands of an argument are looked at; of a longer one no output is an angle.
const MOST_SUMMANDS: usize = 500;

/// An output, by its phase and its number there.
type Output = (usize, usize);

/// What formulas know of the outputs of a problem.
#[derive(Default)]
struct Uses {
    /// The factors with which an output stands in arguments of sines, cosines and tangents.
    turned: BTreeMap<Output, Vec<f64>>,
    /// Outputs of which the values themselves are used.
    exposed: Vec<Output>,
    /// Outputs of which derivatives are used.
    moving: Vec<Output>,
}

/// The outputs whose values occur in formulas only as a part, with a constant factor, of arguments of sines, cosines and
/// tangents, and as what is bounded.
pub(crate) fn angles(problem: &Problem) -> Vec<Angle> {
    let Uses { turned, exposed, moving } = uses(problem);
    let is_angle = |output: &Output| !exposed.contains(output);
    let angle = |((phase, output), factors): (Output, Vec<f64>)| {
        let (least, most) =
            factors.iter().fold((f64::INFINITY, 0.0_f64), |(least, most), k| (least.min(*k), most.max(*k)));
        let is_whole = |k: &f64| (k / least - (k / least).round()).abs() <= SAME;
        let turn = factors.iter().all(is_whole).then(|| std::f64::consts::TAU / least);
        Angle { phase, output, radian: 1.0 / most, turn, moves: moving.contains(&(phase, output)) }
    };
    turned.into_iter().filter(|(output, _)| is_angle(output)).map(angle).collect()
}

/// Walks through every formula of the objective and the constraints once.
fn uses(problem: &Problem) -> Uses {
    let mut uses = Uses::default();
    let mut open: Vec<NodeId> = problem.objective.iter().map(|term| term.body).collect();
    let bodies = problem.constraints.iter().map(|constraint| constraint.body);
    open.extend(bodies.filter(|body| !is_bound(problem, *body)));
    let mut seen: Set<NodeId> = open.iter().copied().collect();
    while let Some(id) = open.pop() {
        let mut next: Vec<NodeId> = vec![];
        match problem.dag.node(id) {
            Node::Input(input) => match problem.leaves.leaf(*input) {
                Leaf::Flat { phase, output, order: 0, .. } => uses.exposed.push((phase.phase, *output)),
                Leaf::Flat { phase, output, .. } => uses.moving.push((phase.phase, *output)),
                Leaf::Integral { integrand, .. } => next.push(*integrand),
                _ => {}
            },
            Node::Unary(Unary::Sin | Unary::Cos | Unary::Tan, argument) => {
                uses.collect_argument(problem, (*argument, 1.0), &mut next);
            }
            node => node.for_each_operand(|operand| next.push(operand)),
        }
        open.extend(next.into_iter().filter(|id| seen.insert(*id)));
    }
    uses
}

impl Uses {
    /// Takes apart the argument of a periodic function. What of it is no output times a constant goes to `rest`.
    fn collect_argument(&mut self, problem: &Problem, argument: (NodeId, f64), rest: &mut Vec<NodeId>) {
        let dag = &problem.dag;
        let (mut open, mut count) = (vec![argument], 0);
        while let Some((id, factor)) = open.pop() {
            count += 1;
            match *dag.node(id) {
                _ if !is_usable(factor) || count > MOST_SUMMANDS => rest.push(id),
                Node::Unary(Unary::Neg, a) => open.push((a, factor)),
                Node::Binary(Binary::Add | Binary::Sub, a, b) => open.extend([(a, factor), (b, factor)]),
                Node::Binary(Binary::Mul, a, b) => match (dag.is_constant(a), dag.is_constant(b)) {
                    (Some(k), _) => open.push((b, factor * k.abs())),
                    (_, Some(k)) => open.push((a, factor * k.abs())),
                    _ => rest.push(id),
                },
                Node::Binary(Binary::Div, a, b) => match dag.is_constant(b) {
                    Some(k) => open.push((a, factor / k.abs())),
                    None => rest.push(id),
                },
                _ => match output_of(problem, id) {
                    Some(output) => self.turned.entry(output).or_default().push(factor),
                    None => rest.push(id),
                },
            }
        }
    }
}

/// Whether a factor of an argument says how long a turn is.
fn is_usable(factor: f64) -> bool {
    factor.is_finite() && factor > 0.0
}

/// Whether a body bounds the value of one output by itself, `psi - north`: that says nothing of how formulas use it.
fn is_bound(problem: &Problem, body: NodeId) -> bool {
    let is_value = |input: InputId| matches!(problem.leaves.leaf(input), Leaf::Flat { order: 0, .. });
    let is_given = |input: InputId| matches!(problem.leaves.leaf(input), Leaf::Parameter { .. } | Leaf::Index(_));
    let inputs = problem.dag.inputs_of(&[body]);
    let values = inputs.iter().filter(|input| is_value(**input)).count();
    let others = inputs.iter().filter(|input| is_given(**input)).count();
    values == 1 && values + others == inputs.len() && degree(&problem.dag, body, is_value) <= Degree::Linear
}

/// The output whose value a node is.
fn output_of(problem: &Problem, node: NodeId) -> Option<Output> {
    let Node::Input(input) = problem.dag.node(node) else { return None };
    match problem.leaves.leaf(*input) {
        Leaf::Flat { phase, output, order: 0, .. } => Some((phase.phase, *output)),
        _ => None,
    }
}
