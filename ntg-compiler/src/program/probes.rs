//! What to look at when a value is not finite.
//!
//! Takes the values of a kernel, gives the subexpressions that can fail, each with its place. A part of a branch counts
//! where that branch is taken only: elsewhere it may have no value, and nothing is wrong.

use std::collections::{HashMap, HashSet};

use crate::expr::{Binary, Dag, Map, Node, NodeId, Unary};
use crate::source::Span;

/// A branch: a condition, and whether it holds.
type Guard = (NodeId, bool);

/// In how many branches a part may stand; one that stands in more is not looked at.
const MOST_BRANCHES: usize = 4;

/// In which branches each node is needed: none for those needed everywhere.
struct Guards(HashMap<NodeId, Vec<Vec<Guard>>>); // Looked up, never iterated.

impl Guards {
    fn of(dag: &Dag, roots: &[NodeId]) -> Self {
        let mut all: HashMap<NodeId, Vec<Vec<Guard>>> = roots.iter().map(|root| (*root, vec![vec![]])).collect();
        for id in dag.schedule(roots).into_iter().rev() {
            let own = all.get(&id).cloned().unwrap_or_default();
            let mut need = |operand: NodeId, guard: Option<Guard>| {
                let known = all.entry(operand).or_default();
                for branch in &own {
                    let mut branch = branch.clone();
                    branch.extend(guard);
                    if !known.contains(&branch) && known.len() <= MOST_BRANCHES {
                        known.push(branch);
                    }
                }
                if known.iter().any(Vec::is_empty) {
                    *known = vec![vec![]];
                }
            };
            match dag.node(id) {
                Node::Select { condition, then, otherwise } => {
                    need(*condition, None);
                    need(*then, Some((*condition, true)));
                    need(*otherwise, Some((*condition, false)));
                }
                node => node.for_each_operand(|operand| need(operand, None)),
            }
        }
        Self(all)
    }

    /// `probe` where the node is needed, and 0 elsewhere; none where that is too much to ask.
    fn around(&self, dag: &mut Dag, id: NodeId, probe: NodeId) -> Option<NodeId> {
        let branches = self.0.get(&id)?;
        if branches.len() > MOST_BRANCHES {
            return None;
        }
        let zero = dag.constant(0.0);
        let masked = branches.iter().map(|guards| {
            guards.iter().rev().fold(probe, |inner, (condition, holds)| match holds {
                true => dag.select(*condition, inner, zero),
                false => dag.select(*condition, zero, inner),
            })
        });
        let masked: Vec<NodeId> = masked.collect();
        Some(match masked.as_slice() {
            [only] => *only,
            several => dag.sum(several),
        })
    }
}

/// Operations that can give infinity or NaN from finite operands, then the factors in which their derivatives are
/// singular. Of an operation with a divisor, `1 / d` or a negative power of it and the tangent with its cosine, the probe is
/// the inverse of the divisor: a change of its sign is a pole, whatever the dividend does. `norms` are those of the values
/// that are norms with limits: nothing fails at their tips (docs/maths.md, section 11.14).
pub(super) fn probes(
    dag: &mut Dag,
    (values, norms): (&[NodeId], &[NodeId]),
    origin: &Map<NodeId, Span>,
) -> (Vec<NodeId>, Vec<Span>) {
    let limited = limited(dag, values, norms);
    // What the compiler has made itself, such as `1 / T`, is of no help to a person.
    let guards = Guards::of(dag, values);
    let schedule: Vec<NodeId> = dag.schedule(values).into_iter().filter(|id| origin.contains_key(id)).collect();
    let (mut nodes, mut spans) = (Vec::new(), Vec::new());
    for id in &schedule {
        if may_fail(dag, dag.node(*id)) {
            let probe = match divisor(dag, *id) {
                Some(divisor) => inverse(dag, divisor),
                None => overflow(dag, *id).unwrap_or(*id),
            };
            nodes.extend(guards.around(dag, *id, probe));
            spans.resize(nodes.len(), origin[id]);
        }
    }
    for id in schedule {
        let singular = match *dag.node(id) {
            _ if limited.contains(&id) => continue,
            Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Hypot, _, _) => id,
            Node::Unary(Unary::Asin | Unary::Acos, a) => {
                let square = dag.powi(a, 2);
                let one = dag.constant(1.0);
                dag.sub(one, square)
            }
            _ => continue,
        };
        let inverse = inverse(dag, singular);
        nodes.extend(guards.around(dag, id, inverse));
        spans.resize(nodes.len(), origin[&id]);
    }
    (nodes, spans)
}

/// The roots that norms with limits are, or are products and quotients of, and that stand nowhere else.
fn limited(dag: &Dag, values: &[NodeId], norms: &[NodeId]) -> HashSet<NodeId> {
    let is_root = |id: NodeId| matches!(dag.node(id), Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Hypot, _, _));
    let mut elsewhere: Vec<NodeId> = values.iter().copied().filter(|value| !norms.contains(value)).collect();
    let (mut found, mut open) = (HashSet::new(), norms.to_vec());
    while let Some(id) = open.pop() {
        match *dag.node(id) {
            _ if is_root(id) => {
                found.insert(id);
                elsewhere.extend(dag.node(id).operands());
            }
            Node::Binary(Binary::Div, a, b) => {
                open.push(a);
                elsewhere.push(b);
            }
            Node::Binary(Binary::Mul, a, b) if is_root(a) != is_root(b) => {
                let (root, factor) = if is_root(a) { (a, b) } else { (b, a) };
                open.push(root);
                elsewhere.push(factor);
            }
            _ => elsewhere.push(id),
        }
    }
    for id in dag.schedule(&elsewhere) {
        found.remove(&id);
    }
    found
}

fn inverse(dag: &mut Dag, of: NodeId) -> NodeId {
    let one = dag.constant(1.0);
    dag.div(one, of)
}

/// What is NaN where a function without poles overflows, and between 1/2 and 1 elsewhere: the top of a bell is far above its
/// feet, and nothing is singular there.
fn overflow(dag: &mut Dag, id: NodeId) -> Option<NodeId> {
    let one = dag.constant(1.0);
    let least_one = match *dag.node(id) {
        Node::Unary(Unary::Exp, _) => dag.add(one, id),
        Node::Unary(Unary::Cosh, _) => id,
        Node::Unary(Unary::Sinh, a) => dag.unary(Unary::Cosh, a),
        _ => return None,
    };
    let more = dag.add(one, least_one);
    Some(dag.div(least_one, more))
}

/// What an operation divides by.
fn divisor(dag: &mut Dag, id: NodeId) -> Option<NodeId> {
    match *dag.node(id) {
        // An even power of what changes its sign does not.
        Node::Binary(Binary::Div, _, divisor) => match *dag.node(divisor) {
            Node::Powi(base, exponent) if exponent > 0 => Some(base),
            _ => Some(divisor),
        },
        Node::Powi(base, exponent) if exponent < 0 => Some(base),
        Node::Unary(Unary::Tan, angle) => Some(dag.unary(Unary::Cos, angle)),
        _ => None,
    }
}

/// Overflow of sums and products is left out: the row itself tells of it.
fn may_fail(dag: &Dag, node: &Node) -> bool {
    match node {
        Node::Unary(op, _) => matches!(
            op,
            Unary::Sqrt | Unary::Log | Unary::Exp | Unary::Tan | Unary::Asin | Unary::Acos | Unary::Sinh | Unary::Cosh
        ),
        Node::Binary(Binary::Div, _, divisor) => dag.is_constant(*divisor).is_none(),
        Node::Binary(Binary::Pow, _, _) | Node::Table { .. } => true,
        Node::Powi(_, exponent) => *exponent < 0,
        _ => false,
    }
}
