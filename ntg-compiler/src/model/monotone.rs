//! Whether a node grows with an operand, or falls, and whether that pushes what stands for the operand (docs/maths.md,
//! section 18).

use super::corners::Corners;
use super::elaborator::Elaborator;
use super::unknowns::is_given;
use crate::expr::{Binary, Fold, Node, NodeId, Unary};

/// How what stands for an operand is pushed onto it by the objective, the surest way first: within several functions the least sure
/// one counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(super) enum Push {
    /// Everywhere, by no less than a positive factor.
    Steep,
    /// By a weight that is given before the solve and may be 0: what floats there costs nothing.
    Floating,
    /// Everywhere, but far away by less and less: an exponential on its way down, a reciprocal. What has a bound away from its
    /// corner stays where it is pushed.
    Fading,
    /// Not everywhere, or by what is solved for: what floats there would make a point look stationary that is none.
    Nothing,
}

impl Elaborator<'_> {
    /// Whether a node grows with an operand, or falls; none where that is not known.
    pub(super) fn slope(&self, pass: &mut Corners, node: &Node, at: usize) -> Option<bool> {
        let mut positive = |x: NodeId| pass.signs.is_positive(&self.problem, x);
        match *node {
            Node::Unary(Unary::Neg, _) => Some(false),
            Node::Unary(
                Unary::Sqrt
                | Unary::Exp
                | Unary::Log
                | Unary::Atan
                | Unary::Sinh
                | Unary::Tanh
                | Unary::Logistic
                | Unary::Softplus,
                _,
            ) => Some(true),
            Node::Unary(Unary::Cosh | Unary::Abs, x) => positive(x).then_some(true),
            Node::Binary(Binary::Add | Binary::Min | Binary::Max, ..) => Some(true),
            Node::Binary(Binary::Sub, ..) => Some(at == 0),
            Node::Binary(Binary::Mul, a, b) => self.sign(pass, if at == 0 { b } else { a }),
            Node::Binary(Binary::Div, _, b) if at == 0 => self.sign(pass, b),
            Node::Binary(Binary::Div, a, b) => (positive(b)).then(|| self.sign(pass, a)).flatten().map(|up| !up),
            Node::Binary(Binary::Hypot, a, b) => positive(if at == 0 { a } else { b }).then_some(true),
            Node::Binary(Binary::Pow, a, b) if at == 0 => {
                let power = self.problem.dag.is_constant(b)?;
                positive(a).then_some(power > 0.0)
            }
            Node::Powi(_, n) if n > 0 && n % 2 != 0 => Some(true),
            Node::Powi(x, n) => positive(x).then_some(n > 0),
            Node::Select { .. } => (at > 0).then_some(true),
            Node::Reduce { fold: Fold::Product, body, .. } => positive(body).then_some(true),
            Node::Reduce { .. } => Some(true),
            _ => None,
        }
    }

    /// Whether a factor is not negative, or not positive; none where neither is known.
    fn sign(&self, pass: &mut Corners, factor: NodeId) -> Option<bool> {
        if pass.signs.is_positive(&self.problem, factor) {
            return Some(true);
        }
        match *self.problem.dag.node(factor) {
            Node::Const(number) if number.value() <= 0.0 => Some(false),
            Node::Unary(Unary::Neg, x) => pass.signs.is_positive(&self.problem, x).then_some(false),
            Node::Binary(Binary::Mul, a, b) => Some(self.sign(pass, a)? == self.sign(pass, b)?),
            Node::Binary(Binary::Div, a, b) => Some(self.sign(pass, a)? == self.sign(pass, b)?),
            _ => None,
        }
    }

    /// How a node pushes what stands for an operand, `down` onto the operand from above or up from below; `both` says whether
    /// others may stand for other operands too.
    pub(super) fn push(&self, pass: &mut Corners, node: &Node, at: usize, down: bool, both: bool) -> Push {
        let factor = match *node {
            Node::Unary(Unary::Tanh | Unary::Logistic | Unary::Atan, _) => return Push::Fading,
            Node::Unary(Unary::Exp | Unary::Softplus, _) if !down => return Push::Fading,
            Node::Binary(Binary::Div, ..) if at == 1 => return Push::Fading,
            Node::Powi(_, n) if n < 0 => return Push::Fading,
            Node::Binary(Binary::Pow, _, power) => {
                let rises = self.problem.dag.is_constant(power).is_some_and(|power| power > 0.0);
                return if rises && down { Push::Steep } else { Push::Nothing };
            }
            // These grow with what is not negative, and stay so where they are approached from above.
            Node::Unary(Unary::Cosh | Unary::Abs, _) | Node::Binary(Binary::Hypot, ..) if !down => {
                return Push::Nothing;
            }
            // Level at 0, through which what is pushed down would have to pass.
            Node::Powi(x, n) if n > 1 => {
                let ends_at_zero = down && pass.signs.is_positive(&self.problem, x);
                return if ends_at_zero { Push::Steep } else { Push::Nothing };
            }
            Node::Reduce { fold: Fold::Product, .. } => return Push::Nothing,
            // What is not chosen has no weight.
            Node::Select { condition, .. } if is_given(&self.problem, condition) => return Push::Floating,
            Node::Select { .. } => return Push::Nothing,
            Node::Binary(Binary::Mul | Binary::Div, ..) if both => return Push::Nothing,
            Node::Binary(Binary::Mul, a, b) => {
                if at == 0 {
                    b
                } else {
                    a
                }
            }
            Node::Binary(Binary::Div, _, b) => b,
            _ => return Push::Steep,
        };
        if self.is_away_from_zero(pass, factor) {
            Push::Steep
        } else if is_given(&self.problem, factor) {
            Push::Floating
        } else {
            Push::Nothing
        }
    }

    /// Whether a factor, or its negative, stays above 0.
    fn is_away_from_zero(&self, pass: &mut Corners, factor: NodeId) -> bool {
        if pass.signs.is_above_zero(&self.problem, factor) {
            return true;
        }
        match *self.problem.dag.node(factor) {
            Node::Const(number) => number.value() != 0.0,
            Node::Unary(Unary::Neg, x) => self.is_away_from_zero(pass, x),
            Node::Binary(Binary::Mul | Binary::Div, a, b) => {
                self.is_away_from_zero(pass, a) && self.is_away_from_zero(pass, b)
            }
            _ => false,
        }
    }
}
