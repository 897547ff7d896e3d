//! Forward mode: the derivative along one direction, or with respect to time, by the
//! chain rule (docs/maths.md, (2.3)); it also goes through reductions (2.7).

use super::DerivativeError;
use super::rules::{Rule, rule};
use crate::expr::dag::Dag;
use crate::expr::hash::{Map, Set};
use crate::expr::node::{Fold, InputId, Node, NodeId};

/// The derivative of `root` when each input changes at the rate that `tangent` gives;
/// `None` means that it does not change.
///
/// Inputs that depend on the index of a reduction have tangents that depend on it in the
/// same way. `again` makes other indices over the ranges of products.
pub fn forward(
    dag: &mut Dag,
    root: NodeId,
    tangent: impl FnMut(InputId) -> Option<NodeId>,
    again: &mut dyn Again,
) -> NodeId {
    forward_from(dag, root, tangent, again, &mut Rates::default())
}

/// The derivatives of nodes along one direction; `None` where a node does not change.
pub type Rates = Map<NodeId, Option<NodeId>>; // Looked up, never iterated.

/// As [`forward`], where the derivatives of some nodes along the same direction are known; those of all nodes that the
/// root is made of are known afterwards. So what many roots share is differentiated once.
pub fn forward_from(
    dag: &mut Dag,
    root: NodeId,
    mut tangent: impl FnMut(InputId) -> Option<NodeId>,
    again: &mut dyn Again,
    rates: &mut Rates,
) -> NodeId {
    let known = |dag: &Dag, id: NodeId| match dag.node(id) {
        Node::Input(input) => Some(tangent(*input)),
        _ => None,
    };
    sweep(dag, &[root], known, Some(again), rates).expect("products have their indices")[0]
}

/// Makes a second index over the range of a reduction.
pub trait Again {
    /// An index over the same values as `index` over `range`.
    fn again(&mut self, dag: &mut Dag, index: u32, range: u32) -> SecondIndex;
}

/// An index that runs over the values of another.
#[derive(Clone, Copy, Debug)]
pub struct SecondIndex {
    /// The client's name for it.
    pub index: u32,
    /// The client's name for its range.
    pub range: u32,
    /// A node that is not 0 exactly where both indices have one value.
    pub same: NodeId,
}

/// The sweep itself. `known` ends the descent: `Some(t)` at a node says that its tangent is
/// `t` (or zero), and that its operands do not matter.
///
/// Fails at a product over an index: whoever asks here has taken reductions apart.
pub(super) fn tangents(
    dag: &mut Dag,
    roots: &[NodeId],
    known: impl FnMut(&Dag, NodeId) -> Option<Option<NodeId>>,
) -> Result<Vec<NodeId>, DerivativeError> {
    sweep(dag, roots, known, None, &mut Rates::default())
}

fn sweep(
    dag: &mut Dag,
    roots: &[NodeId],
    mut known: impl FnMut(&Dag, NodeId) -> Option<Option<NodeId>>,
    mut again: Option<&mut dyn Again>,
    rates: &mut Rates,
) -> Result<Vec<NodeId>, DerivativeError> {
    for id in schedule_to_known(dag, roots, rates, &mut known) {
        let rate = push(dag, id, rates, &mut again)?;
        let zero = dag.constant(0.0);
        rates.insert(id, rate.filter(|rate| *rate != zero));
    }
    let zero = dag.constant(0.0);
    Ok(roots.iter().map(|root| rates[root].unwrap_or(zero)).collect())
}

/// The nodes between the roots and the known ones, in increasing order; enters the known
/// ones into `rates`.
fn schedule_to_known(
    dag: &Dag,
    roots: &[NodeId],
    rates: &mut Rates,
    known: &mut impl FnMut(&Dag, NodeId) -> Option<Option<NodeId>>,
) -> Vec<NodeId> {
    let mut seen: Set<NodeId> = Set::default();
    let mut found = Vec::new();
    let mut open: Vec<NodeId> = roots.to_vec();
    while let Some(id) = open.pop() {
        if rates.contains_key(&id) || !seen.insert(id) {
            continue;
        }
        match known(dag, id) {
            Some(rate) => {
                rates.insert(id, rate);
            }
            None => {
                found.push(id);
                dag.node(id).for_each_operand(|x| open.push(x));
            }
        }
    }
    found.sort_unstable();
    found
}

/// The rate of one node, given those of its operands.
fn push(
    dag: &mut Dag,
    id: NodeId,
    rates: &Rates,
    again: &mut Option<&mut dyn Again>,
) -> Result<Option<NodeId>, DerivativeError> {
    let mut moves = false;
    dag.node(id).for_each_operand(|x| moves |= rates[&x].is_some());
    if !moves {
        return Ok(None);
    }
    if let Node::Reduce { fold, index, range, body } = *dag.node(id) {
        let rate = rates[&body].expect("a reduction moves only if its body does");
        let family = Family { fold, index, range };
        if fold == Fold::Product {
            let Some(again) = again else { return Err(DerivativeError::Reduction(id)) };
            return Ok(Some(product(dag, family, (body, rate), &mut **again)));
        }
        return Ok(Some(reduction(dag, id, family, body, rate)));
    }
    let zero = dag.constant(0.0);
    Ok(match rule(dag, id, |x| rates[&x].is_some()) {
        Rule::Choice { condition, then, otherwise } => {
            let (p, q) = (rates[&then].unwrap_or(zero), rates[&otherwise].unwrap_or(zero));
            Some(dag.select(condition, p, q))
        }
        Rule::Smooth { factors, divisor } => {
            let mut sum = zero;
            for (operand, numerator) in factors {
                if let Some(rate) = rates[&operand] {
                    let term = dag.mul(numerator, rate);
                    sum = dag.add(sum, term);
                }
            }
            Some(match divisor {
                Some(divisor) => dag.div(sum, divisor),
                None => sum,
            })
        }
    })
}

/// How and over what a reduction joins its members.
#[derive(Clone, Copy)]
struct Family {
    fold: Fold,
    index: u32,
    range: u32,
}

impl Family {
    fn sum(self, dag: &mut Dag, body: NodeId) -> NodeId {
        dag.reduce(Fold::Sum, self.index, self.range, body)
    }
}

/// The rate of a sum, or of the largest or smallest member.
fn reduction(dag: &mut Dag, value: NodeId, family: Family, body: NodeId, rate: NodeId) -> NodeId {
    if family.fold == Fold::Sum {
        return family.sum(dag, rate);
    }
    // Members that attain the value share the rate equally.
    let attains = match family.fold {
        Fold::Min => dag.less_eq(body, value),
        _ => dag.less_eq(value, body),
    };
    let zero = dag.constant(0.0);
    let share = dag.select(attains, rate, zero);
    let total = family.sum(dag, share);
    let count = family.sum(dag, attains);
    dag.div(total, count)
}

/// The rate of a product (docs/maths.md, (2.8)): the sum over a second index of the product in which
/// the member of that index is replaced by its rate. It is exact also where members vanish, and is
/// made of products again, so that it can be differentiated as often as one likes.
fn product(dag: &mut Dag, family: Family, (body, rate): (NodeId, NodeId), again: &mut dyn Again) -> NodeId {
    let second = again.again(dag, family.index, family.range);
    let member = dag.select(second.same, rate, body);
    let replaced = dag.reduce(Fold::Product, family.index, family.range, member);
    dag.reduce(Fold::Sum, second.index, second.range, replaced)
}
