//! What one operation contributes to a derivative: its partial derivatives with
//! respect to its operands (docs/maths.md, section 2.4).
//!
//! Takes a node, gives a [`Rule`]. Partial derivatives of one node share a divisor,
//! which is divided by once: reverse mode divides the adjoint, forward mode the sum.

use super::mask::masked;
use crate::expr::dag::Dag;
use crate::expr::node::{Binary, Node, NodeId, Unary};

/// The partial derivatives of one node.
pub(super) enum Rule {
    /// `d value = sum(numerator * d operand) / divisor`, each operand once.
    Smooth {
        /// Operands with their numerators.
        factors: Vec<(NodeId, NodeId)>,
        /// 1 if there is none.
        divisor: Option<NodeId>,
    },
    /// The value is one of two operands, and its derivative is that operand's.
    Choice {
        /// Not 0 where the value is `then`.
        condition: NodeId,
        /// One operand.
        then: NodeId,
        /// The other, which is a different node.
        otherwise: NodeId,
    },
}

impl Rule {
    /// The operands with a non-zero partial derivative, as far as they are active.
    pub(super) fn operands(&self, active: impl Fn(NodeId) -> bool) -> Vec<NodeId> {
        let all = match self {
            Self::Smooth { factors, .. } => factors.iter().map(|(x, _)| *x).collect(),
            Self::Choice { then, otherwise, .. } => vec![*then, *otherwise],
        };
        all.into_iter().filter(|x| active(*x)).collect()
    }

    /// `weight * d value / d operand`, made behind the masks of the weight.
    pub(super) fn pull(&self, dag: &mut Dag, weight: NodeId, operand: NodeId) -> NodeId {
        masked(dag, weight, &mut |dag, weight| self.pull_bare(dag, weight, operand))
    }

    fn pull_bare(&self, dag: &mut Dag, weight: NodeId, operand: NodeId) -> NodeId {
        match self {
            Self::Smooth { factors, divisor } => {
                let Some((_, numerator)) = factors.iter().find(|(x, _)| *x == operand) else {
                    return dag.constant(0.0);
                };
                match divisor {
                    None => dag.mul(weight, *numerator),
                    // A constant weight leaves the partial derivative whole, to be shared.
                    Some(divisor) if dag.is_constant(weight).is_some() => {
                        let partial = dag.div(*numerator, *divisor);
                        dag.mul(weight, partial)
                    }
                    Some(divisor) => {
                        let share = dag.div(weight, *divisor);
                        dag.mul(share, *numerator)
                    }
                }
            }
            Self::Choice { condition, then, .. } => {
                let zero = dag.constant(0.0);
                if operand == *then {
                    dag.select(*condition, weight, zero)
                } else {
                    dag.select(*condition, zero, weight)
                }
            }
        }
    }
}

/// The rule of a node; only for operands that are `active`, others may be missing.
/// Leaves and reductions have no factors: the modes treat them before they ask.
pub(super) fn rule(dag: &mut Dag, id: NodeId, active: impl Fn(NodeId) -> bool) -> Rule {
    match dag.node(id).clone() {
        Node::Const(_) | Node::Input(_) | Node::Reduce { .. } => smooth(vec![], None),
        Node::Unary(op, x) => unary(dag, op, x, id),
        Node::Binary(op, a, b) => binary(dag, op, (a, b), id, active),
        Node::Powi(x, n) => {
            let power = dag.powi(x, n.saturating_sub(1));
            let factor = dag.constant(f64::from(n));
            let partial = dag.mul(factor, power);
            smooth(vec![(x, partial)], None)
        }
        Node::Select { condition, then, otherwise } => Rule::Choice { condition, then, otherwise },
        Node::Table { table, derivative, args } => {
            let mut factors = Factors::default();
            for (k, arg) in args.iter().enumerate().filter(|(_, arg)| active(**arg)) {
                let mut orders = derivative.clone();
                orders[k] = orders[k].saturating_add(1);
                let partial = dag.table(table, &orders, &args);
                factors.add(dag, *arg, partial);
            }
            smooth(factors.list, None)
        }
    }
}

fn smooth(factors: Vec<(NodeId, NodeId)>, divisor: Option<NodeId>) -> Rule {
    Rule::Smooth { factors, divisor }
}

fn unary(dag: &mut Dag, op: Unary, x: NodeId, value: NodeId) -> Rule {
    let one = dag.constant(1.0);
    let (numerator, divisor) = match op {
        Unary::Neg => (dag.constant(-1.0), None),
        Unary::Sqrt => (dag.constant(0.5), Some(value)),
        Unary::Exp => (value, None),
        Unary::Log => (one, Some(x)),
        Unary::Sin => (dag.cos(x), None),
        Unary::Cos => {
            let sine = dag.sin(x);
            (dag.neg(sine), None)
        }
        Unary::Tan => {
            let square = dag.powi(value, 2);
            (dag.add(one, square), None)
        }
        Unary::Asin => (one, Some(root_of_one_minus_square(dag, x))),
        Unary::Acos => (dag.constant(-1.0), Some(root_of_one_minus_square(dag, x))),
        Unary::Atan => {
            let square = dag.powi(x, 2);
            (one, Some(dag.add(one, square)))
        }
        Unary::Sinh => (dag.cosh(x), None),
        Unary::Cosh => (dag.sinh(x), None),
        Unary::Tanh => {
            let square = dag.powi(value, 2);
            (dag.sub(one, square), None)
        }
        Unary::Abs => (dag.sign(x), None),
        Unary::Sign => return smooth(vec![], None),
        Unary::Logistic => {
            let rest = dag.sub(one, value);
            (dag.mul(value, rest), None)
        }
        Unary::Softplus => (dag.logistic(x), None),
    };
    smooth(vec![(x, numerator)], divisor)
}

/// `sqrt((1 - x) (1 + x))`, which keeps its digits near the ends.
fn root_of_one_minus_square(dag: &mut Dag, x: NodeId) -> NodeId {
    let one = dag.constant(1.0);
    let below = dag.sub(one, x);
    let above = dag.add(one, x);
    let product = dag.mul(below, above);
    dag.sqrt(product)
}

fn binary(dag: &mut Dag, op: Binary, (a, b): (NodeId, NodeId), value: NodeId, active: impl Fn(NodeId) -> bool) -> Rule {
    let one = dag.constant(1.0);
    let mut factors = Factors::default();
    let divisor = match op {
        Binary::Add => {
            factors.add(dag, a, one);
            factors.add(dag, b, one);
            None
        }
        Binary::Sub => {
            let minus = dag.constant(-1.0);
            factors.add(dag, a, one);
            factors.add(dag, b, minus);
            None
        }
        Binary::Mul => {
            factors.add(dag, a, b);
            factors.add(dag, b, a);
            None
        }
        Binary::Div => {
            let minus = dag.neg(value);
            factors.add(dag, a, one);
            factors.add(dag, b, minus);
            Some(b)
        }
        Binary::Pow => {
            if active(a) {
                let partial = power_by_base(dag, a, b);
                factors.add(dag, a, partial);
            }
            if active(b) {
                let partial = power_by_exponent(dag, a, value);
                factors.add(dag, b, partial);
            }
            None
        }
        Binary::Atan2 => {
            let minus = dag.neg(a);
            factors.add(dag, a, b);
            factors.add(dag, b, minus);
            let (p, q) = (dag.powi(a, 2), dag.powi(b, 2));
            Some(dag.add(p, q))
        }
        Binary::Hypot => {
            factors.add(dag, a, a);
            factors.add(dag, b, b);
            Some(value)
        }
        Binary::Min => return Rule::Choice { condition: dag.less_eq(a, b), then: a, otherwise: b },
        Binary::Max => return Rule::Choice { condition: dag.less_eq(b, a), then: a, otherwise: b },
        Binary::LessEq => None,
    };
    smooth(factors.list, divisor)
}

/// `b a^(b - 1)`.
fn power_by_base(dag: &mut Dag, a: NodeId, b: NodeId) -> NodeId {
    let one = dag.constant(1.0);
    let exponent = dag.sub(b, one);
    let power = dag.pow(a, exponent);
    dag.mul(b, power)
}

/// `a^b log(a)`, and 0 at `a = 0`, its limit for a positive exponent.
fn power_by_exponent(dag: &mut Dag, a: NodeId, value: NodeId) -> NodeId {
    let zero = dag.constant(0.0);
    let log = dag.log(a);
    let partial = dag.mul(value, log);
    dag.select(a, partial, zero)
}

/// Numerators by operand; an operand that occurs twice has one numerator, the sum.
#[derive(Default)]
struct Factors {
    list: Vec<(NodeId, NodeId)>,
}

impl Factors {
    fn add(&mut self, dag: &mut Dag, operand: NodeId, numerator: NodeId) {
        match self.list.iter_mut().find(|(x, _)| *x == operand) {
            Some((_, sum)) => *sum = dag.add(*sum, numerator),
            None => self.list.push((operand, numerator)),
        }
    }
}
