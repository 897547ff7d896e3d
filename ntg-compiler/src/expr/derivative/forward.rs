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
/// same way.
/// Fails at the second derivative of a product over an index.
pub fn forward(
    dag: &mut Dag,
    root: NodeId,
    tangent: impl FnMut(InputId) -> Option<NodeId>,
) -> Result<NodeId, DerivativeError> {
    Ok(forward_all(dag, &[root], tangent)?[0])
}

/// As [`forward`], for several roots in one sweep.
pub fn forward_all(
    dag: &mut Dag,
    roots: &[NodeId],
    mut tangent: impl FnMut(InputId) -> Option<NodeId>,
) -> Result<Vec<NodeId>, DerivativeError> {
    tangents(dag, roots, |dag, id| match dag.node(id) {
        Node::Input(input) => Some(tangent(*input)),
        _ => None,
    })
}

/// The sweep itself. `known` ends the descent: `Some(t)` at a node says that its tangent is
/// `t` (or zero), and that its operands do not matter.
pub(super) fn tangents(
    dag: &mut Dag,
    roots: &[NodeId],
    mut known: impl FnMut(&Dag, NodeId) -> Option<Option<NodeId>>,
) -> Result<Vec<NodeId>, DerivativeError> {
    let mut rates: Map<NodeId, Option<NodeId>> = Map::default();
    for id in schedule_to_known(dag, roots, &mut rates, &mut known) {
        let rate = push(dag, id, &rates)?;
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
    rates: &mut Map<NodeId, Option<NodeId>>,
    known: &mut impl FnMut(&Dag, NodeId) -> Option<Option<NodeId>>,
) -> Vec<NodeId> {
    let mut seen: Set<NodeId> = Set::default();
    let mut found = Vec::new();
    let mut open: Vec<NodeId> = roots.to_vec();
    while let Some(id) = open.pop() {
        if !seen.insert(id) {
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
fn push(dag: &mut Dag, id: NodeId, rates: &Map<NodeId, Option<NodeId>>) -> Result<Option<NodeId>, DerivativeError> {
    let mut moves = false;
    dag.node(id).for_each_operand(|x| moves |= rates[&x].is_some());
    if !moves {
        return Ok(None);
    }
    if let Node::Reduce { fold, index, range, body } = *dag.node(id) {
        let rate = rates[&body].expect("a reduction moves only if its body does");
        return reduction(dag, id, Family { fold, index, range }, body, rate).map(Some);
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

fn reduction(
    dag: &mut Dag,
    value: NodeId,
    family: Family,
    body: NodeId,
    rate: NodeId,
) -> Result<NodeId, DerivativeError> {
    match family.fold {
        Fold::Sum => Ok(family.sum(dag, rate)),
        Fold::Product if is_product_without_zeros(dag, body) => Err(DerivativeError::ProductTwice(value)),
        Fold::Product => Ok(product(dag, family, body, rate)),
        Fold::Min | Fold::Max => {
            // Members that attain the value share the rate equally.
            let attains = match family.fold {
                Fold::Min => dag.less_eq(body, value),
                _ => dag.less_eq(value, body),
            };
            let zero = dag.constant(0.0);
            let share = dag.select(attains, rate, zero);
            let total = family.sum(dag, share);
            let count = family.sum(dag, attains);
            Ok(dag.div(total, count))
        }
    }
}

/// The rate of a product, also where members vanish (docs/maths.md, (2.8)): with no zero
/// among the members it is the product times the sum of the logarithmic rates; with one,
/// the rate of that member times the product of the others; with more, 0.
fn product(dag: &mut Dag, family: Family, body: NodeId, rate: NodeId) -> NodeId {
    let (zero, one) = (dag.constant(0.0), dag.constant(1.0));
    let divisor = dag.select(body, body, one);
    let others = dag.reduce(Fold::Product, family.index, family.range, divisor);
    let is_zero = dag.select(body, zero, one);
    let zeros = family.sum(dag, is_zero);

    let ratio = dag.div(rate, divisor);
    let ratio = dag.select(body, ratio, zero);
    let regular = family.sum(dag, ratio);
    let rate_at_zero = dag.select(body, zero, rate);
    let singular = family.sum(dag, rate_at_zero);

    let at_most_one = dag.less_eq(zeros, one);
    let with_zeros = dag.select(at_most_one, singular, zero);
    let total = dag.select(zeros, with_zeros, regular);
    dag.mul(others, total)
}

/// Whether a body is the one that `product` makes: itself, or 1 where it vanishes.
/// Differentiating that again would be wrong exactly where a member vanishes.
fn is_product_without_zeros(dag: &Dag, body: NodeId) -> bool {
    match dag.node(body) {
        Node::Select { condition, then, otherwise } => condition == then && dag.is(*otherwise, 1.0),
        _ => false,
    }
}
