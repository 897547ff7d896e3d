//! The constructors of a [`Dag`], and the simplifications they make.
//!
//! A rule may replace a node only by one with the same value, bit for bit apart from
//! the sign of a zero, wherever all the nodes involved are finite and no intermediate
//! value under- or overflows; docs/maths.md, section 2.2, lists the rules and says why
//! this is enough. Constants are folded here and only here; a result that is not finite
//! is left standing, so that the fault shows where the expression is evaluated.
//!
//! The one exception is [`Dag::pow`]: a power with a constant exponent that is an integer
//! or a half is *defined* as the integer power or the square root.
//!
//! Afterwards: negations have moved outwards into sums, the operands of `+ * min max hypot`
//! are in one order (a constant first), and no operation has only constant operands unless
//! its value is not finite.

use super::dag::Dag;
use super::node::{Binary, Fold, Node, NodeId, Unary};
use super::scalar::Scalar;

/// Larger exponents are left to the general power, whose error does not grow with them.
const MAX_INTEGER_EXPONENT: f64 = 1024.0;

impl Dag {
    /// An operation on one node.
    pub fn unary(&mut self, op: Unary, x: NodeId) -> NodeId {
        if let Some(c) = self.is_constant(x)
            && let Some(folded) = self.folded(f64::unary(op, &c))
        {
            return folded;
        }
        match (op, self.node(x)) {
            (Unary::Neg, _) => self.negated(x),
            (Unary::Abs, Node::Unary(Unary::Neg, y)) => self.abs(*y),
            (Unary::Abs, _) if self.is_nonnegative(x) => x,
            _ => self.intern(Node::Unary(op, x)),
        }
    }

    /// An operation on two nodes.
    pub fn binary(&mut self, op: Binary, a: NodeId, b: NodeId) -> NodeId {
        if op == Binary::Pow
            && let Some(exponent) = self.is_constant(b)
            && let Some(power) = self.constant_power(a, exponent)
        {
            return power;
        }
        if let (Some(p), Some(q)) = (self.is_constant(a), self.is_constant(b))
            && let Some(folded) = self.folded(f64::binary(op, &p, &q))
        {
            return folded;
        }
        match op {
            Binary::Add => self.added(a, b),
            Binary::Sub => self.subtracted(a, b),
            Binary::Mul => self.multiplied(a, b),
            Binary::Div => self.divided(a, b),
            Binary::Hypot => self.hypotenuse(a, b),
            Binary::Min | Binary::Max if a == b => a,
            Binary::Min | Binary::Max => self.commutative(op, a, b),
            Binary::LessEq if a == b => self.constant(1.0),
            Binary::Pow | Binary::Atan2 | Binary::LessEq => self.intern(Node::Binary(op, a, b)),
        }
    }

    /// The square root of the sum of the squares of any number of nodes. Pairs of pairs by `hypot` would have
    /// no derivative where the first two vanish.
    pub fn norm(&mut self, nodes: &[NodeId]) -> NodeId {
        let zero = self.constant(0.0);
        let sum = nodes.iter().fold(zero, |sum, node| {
            let square = self.powi(*node, 2);
            self.add(sum, square)
        });
        self.sqrt(sum)
    }

    /// `x^n`; `x^0` is 1, also at 0.
    pub fn powi(&mut self, x: NodeId, n: i32) -> NodeId {
        if let Some(c) = self.is_constant(x)
            && let Some(folded) = self.folded(f64::integer_power(&c, n))
        {
            return folded;
        }
        match (n, self.node(x)) {
            (0, _) => self.constant(1.0),
            (1, _) => x,
            (-1, _) => {
                let one = self.constant(1.0);
                self.div(one, x)
            }
            (_, Node::Unary(Unary::Neg | Unary::Abs, y)) if n % 2 == 0 => self.powi(*y, n),
            (_, Node::Unary(Unary::Neg, y)) => {
                let power = self.powi(*y, n);
                self.neg(power)
            }
            _ => self.intern(Node::Powi(x, n)),
        }
    }

    /// `then` where `condition` is not 0, else `otherwise`.
    pub fn select(&mut self, condition: NodeId, then: NodeId, otherwise: NodeId) -> NodeId {
        match self.is_constant(condition) {
            Some(0.0) => otherwise,
            Some(_) => then,
            None if then == otherwise => then,
            None => self.intern(Node::Select { condition, then, otherwise }),
        }
    }

    /// A table's partial derivative: `derivative[k]` times with respect to argument `k`.
    /// Both slices have the table's number of arguments.
    pub fn table(&mut self, table: u32, derivative: &[u8], args: &[NodeId]) -> NodeId {
        debug_assert_eq!(derivative.len(), args.len(), "one order of differentiation for each argument");
        self.intern(Node::Table { table, derivative: derivative.to_vec(), args: args.to_vec() })
    }

    /// Joins `body` over the members of the client's `range`, bound to its `index`.
    pub fn reduce(&mut self, fold: Fold, index: u32, range: u32, body: NodeId) -> NodeId {
        match fold {
            // The neutral element joined any number of times, also none, is itself.
            Fold::Sum if self.is(body, 0.0) => body,
            Fold::Product if self.is(body, 1.0) => body,
            _ => self.intern(Node::Reduce { fold, index, range, body }),
        }
    }

    fn folded(&mut self, value: f64) -> Option<NodeId> {
        value.is_finite().then(|| self.constant(value))
    }

    fn negated(&mut self, x: NodeId) -> NodeId {
        match *self.node(x) {
            Node::Unary(Unary::Neg, y) => y,
            Node::Binary(Binary::Sub, a, b) => self.sub(b, a),
            Node::Binary(Binary::Mul, c, y) => match self.is_constant(c) {
                Some(value) => self.scaled(-value, y),
                None => self.intern(Node::Unary(Unary::Neg, x)),
            },
            _ => self.intern(Node::Unary(Unary::Neg, x)),
        }
    }

    fn added(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let (a, b) = self.ordered(a, b);
        if a == b {
            return self.scaled(2.0, a);
        }
        match self.is_constant(a) {
            Some(0.0) => return b,
            Some(value) if value < 0.0 => {
                let positive = self.constant(-value);
                return self.subtracted(b, positive);
            }
            _ => {}
        }
        match (self.negation_of(a), self.negation_of(b)) {
            (_, Some(q)) => self.sub(a, q),
            (Some(p), None) => self.sub(b, p),
            (None, None) => self.intern(Node::Binary(Binary::Add, a, b)),
        }
    }

    fn subtracted(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if a == b {
            return self.constant(0.0);
        }
        if self.is(a, 0.0) {
            return self.neg(b);
        }
        match self.is_constant(b) {
            Some(0.0) => return a,
            Some(value) if value < 0.0 => {
                let positive = self.constant(-value);
                return self.add(a, positive);
            }
            _ => {}
        }
        match (self.negation_of(a), self.negation_of(b)) {
            (_, Some(q)) => self.add(a, q),
            (Some(p), None) => {
                let sum = self.add(p, b);
                self.neg(sum)
            }
            (None, None) => self.intern(Node::Binary(Binary::Sub, a, b)),
        }
    }

    fn multiplied(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let (a, b) = self.ordered(a, b);
        if let Some(factor) = self.is_constant(a) {
            return self.scaled(factor, b);
        }
        if a == b {
            return self.powi(a, 2);
        }
        match (self.negation_of(a), self.negation_of(b)) {
            (Some(p), Some(q)) => self.mul(p, q),
            (Some(p), None) => {
                let product = self.mul(p, b);
                self.neg(product)
            }
            (None, Some(q)) => {
                let product = self.mul(a, q);
                self.neg(product)
            }
            (None, None) => self.intern(Node::Binary(Binary::Mul, a, b)),
        }
    }

    /// `factor x` for a constant factor.
    fn scaled(&mut self, factor: f64, x: NodeId) -> NodeId {
        if factor == 0.0 {
            return self.constant(0.0);
        }
        if factor == 1.0 {
            return x;
        }
        if factor == -1.0 {
            return self.neg(x);
        }
        match *self.node(x) {
            Node::Unary(Unary::Neg, y) => return self.scaled(-factor, y),
            Node::Binary(Binary::Mul, c, y) => {
                if let Some(inner) = self.is_constant(c)
                    && (is_power_of_two(factor) || is_power_of_two(inner))
                    && (factor * inner).is_normal()
                {
                    return self.scaled(factor * inner, y);
                }
            }
            _ => {}
        }
        let factor = self.constant(factor);
        self.intern(Node::Binary(Binary::Mul, factor, x))
    }

    fn divided(&mut self, a: NodeId, b: NodeId) -> NodeId {
        if self.is(a, 0.0) && !self.is(b, 0.0) {
            return a;
        }
        if a == b && !self.is(b, 0.0) {
            return self.constant(1.0);
        }
        if let Some(divisor) = self.is_constant(b)
            && is_power_of_two(divisor)
            && (1.0 / divisor).is_normal()
        {
            let reciprocal = self.constant(1.0 / divisor);
            return self.mul(reciprocal, a);
        }
        match (self.negation_of(a), self.negation_of(b)) {
            (Some(p), Some(q)) => self.div(p, q),
            (Some(p), None) => {
                let quotient = self.div(p, b);
                self.neg(quotient)
            }
            (None, Some(q)) => {
                let quotient = self.div(a, q);
                self.neg(quotient)
            }
            (None, None) => self.intern(Node::Binary(Binary::Div, a, b)),
        }
    }

    fn hypotenuse(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let (a, b) = (self.without_sign(a), self.without_sign(b));
        let (a, b) = self.ordered(a, b);
        if self.is(a, 0.0) { self.abs(b) } else { self.intern(Node::Binary(Binary::Hypot, a, b)) }
    }

    /// `x^exponent` where the exponent makes it a simpler operation.
    fn constant_power(&mut self, x: NodeId, exponent: f64) -> Option<NodeId> {
        if exponent == 0.5 || exponent == -0.5 {
            let root = self.sqrt(x);
            return Some(if exponent < 0.0 { self.powi(root, -1) } else { root });
        }
        let is_integer = exponent.fract() == 0.0 && exponent.abs() <= MAX_INTEGER_EXPONENT;
        #[expect(clippy::cast_possible_truncation, reason = "an integer whose magnitude was just compared")]
        is_integer.then(|| self.powi(x, exponent as i32))
    }

    fn commutative(&mut self, op: Binary, a: NodeId, b: NodeId) -> NodeId {
        let (a, b) = self.ordered(a, b);
        self.intern(Node::Binary(op, a, b))
    }

    /// One order for the operands of commutative operations: a constant first, then by id.
    fn ordered(&self, a: NodeId, b: NodeId) -> (NodeId, NodeId) {
        let key = |x: NodeId| (self.is_constant(x).is_none(), x);
        if key(a) <= key(b) { (a, b) } else { (b, a) }
    }

    fn negation_of(&self, x: NodeId) -> Option<NodeId> {
        match self.node(x) {
            Node::Unary(Unary::Neg, y) => Some(*y),
            _ => None,
        }
    }

    /// `x` or `-x` or `y` of `|y|`: the same for an operation that ignores the sign.
    fn without_sign(&self, x: NodeId) -> NodeId {
        match self.node(x) {
            Node::Unary(Unary::Neg | Unary::Abs, y) => *y,
            _ => x,
        }
    }

    /// Whether the operation alone guarantees a value of at least 0.
    fn is_nonnegative(&self, x: NodeId) -> bool {
        match self.node(x) {
            Node::Const(number) => number.value() >= 0.0,
            Node::Unary(op, _) => matches!(
                op,
                Unary::Abs | Unary::Sqrt | Unary::Exp | Unary::Cosh | Unary::Acos | Unary::Logistic | Unary::Softplus
            ),
            Node::Binary(op, ..) => matches!(op, Binary::Hypot | Binary::LessEq),
            Node::Powi(_, n) => n % 2 == 0,
            _ => false,
        }
    }
}

/// Whether multiplying by `x` only shifts the exponent.
fn is_power_of_two(x: f64) -> bool {
    const FRACTION_BITS: u64 = (1 << (f64::MANTISSA_DIGITS - 1)) - 1;
    x.is_normal() && x.to_bits() & FRACTION_BITS == 0
}

/// Makes one short constructor for each operation on one node.
macro_rules! unary_constructors {
    ($($name:ident => $op:ident, $words:literal;)*) => {
        impl Dag {
            $(
                #[doc = $words]
                pub fn $name(&mut self, x: NodeId) -> NodeId {
                    self.unary(Unary::$op, x)
                }
            )*
        }
    };
}

/// Makes one short constructor for each operation on two nodes.
macro_rules! binary_constructors {
    ($($name:ident => $op:ident, $words:literal;)*) => {
        impl Dag {
            $(
                #[doc = $words]
                pub fn $name(&mut self, a: NodeId, b: NodeId) -> NodeId {
                    self.binary(Binary::$op, a, b)
                }
            )*
        }
    };
}

unary_constructors! {
    neg => Neg, "`-x`.";
    sqrt => Sqrt, "The square root.";
    exp => Exp, "The exponential.";
    log => Log, "The natural logarithm.";
    sin => Sin, "The sine.";
    cos => Cos, "The cosine.";
    tan => Tan, "The tangent.";
    asin => Asin, "The inverse sine.";
    acos => Acos, "The inverse cosine.";
    atan => Atan, "The inverse tangent.";
    sinh => Sinh, "The hyperbolic sine.";
    cosh => Cosh, "The hyperbolic cosine.";
    tanh => Tanh, "The hyperbolic tangent.";
    abs => Abs, "The absolute value.";
    sign => Sign, "-1, 0 or 1.";
    logistic => Logistic, "`1 / (1 + exp(-x))`.";
    softplus => Softplus, "`log(1 + exp(x))`.";
}

binary_constructors! {
    add => Add, "`a + b`.";
    sub => Sub, "`a - b`.";
    mul => Mul, "`a b`.";
    div => Div, "`a / b`.";
    pow => Pow, "`a^b`; a constant exponent that is an integer or a half is an integer power or a square root.";
    atan2 => Atan2, "The angle of the point with ordinate `a` and abscissa `b`.";
    hypot => Hypot, "`sqrt(a^2 + b^2)` without overflow.";
    min => Min, "The smaller.";
    max => Max, "The larger.";
    less_eq => LessEq, "1 if `a <= b`, else 0.";
}

impl Dag {
    /// The sum of the terms, from left to right; 0 for none.
    pub fn sum(&mut self, terms: &[NodeId]) -> NodeId {
        let zero = self.constant(0.0);
        terms.iter().fold(zero, |sum, term| self.add(sum, *term))
    }
}
