//! The vocabulary of expressions: what a node can be, and how nodes are named.
//!
//! Plain data without behaviour of its own; [`super::Dag`] makes nodes, and
//! [`super::Scalar`] says what each operation means for a number.

/// Names a node of one [`super::Dag`].
///
/// Ids grow as nodes are made and operands are made before their users, so
/// increasing id is a valid order of evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct NodeId(pub(super) u32);

impl NodeId {
    /// The place of the node in its graph, counted from 0.
    pub fn index(self) -> usize {
        self.0 as usize
    }
}

/// Names a leaf; what it means is the client's affair.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct InputId(pub u32);

/// A constant that can be compared and hashed: `-0.0` is stored as `0.0`.
#[derive(Clone, Copy, PartialEq, Eq, Hash)]
pub struct Number(u64);

impl Number {
    /// Wraps a value; the sign of a zero is dropped, so that equal numbers are one node.
    pub fn new(value: f64) -> Self {
        Self((value + 0.0).to_bits())
    }

    /// The value.
    pub fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

impl std::fmt::Debug for Number {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{:?}", self.value())
    }
}

/// Operations on one number. [`super::Scalar`] gives their exact meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Unary {
    /// `-x`.
    Neg,
    /// Square root.
    Sqrt,
    /// Exponential.
    Exp,
    /// Natural logarithm.
    Log,
    /// Sine.
    Sin,
    /// Cosine.
    Cos,
    /// Tangent.
    Tan,
    /// Inverse sine, in -π/2 .. π/2.
    Asin,
    /// Inverse cosine, in 0 .. π.
    Acos,
    /// Inverse tangent, in -π/2 .. π/2.
    Atan,
    /// Hyperbolic sine.
    Sinh,
    /// Hyperbolic cosine.
    Cosh,
    /// Hyperbolic tangent.
    Tanh,
    /// Absolute value.
    Abs,
    /// -1, 0 or 1; 0 at 0.
    Sign,
    /// `1 / (1 + exp(-x))`.
    Logistic,
    /// `log(1 + exp(x))`.
    Softplus,
}

impl Unary {
    /// Every unary operation, in the order of declaration.
    pub const ALL: [Self; 17] = [
        Self::Neg,
        Self::Sqrt,
        Self::Exp,
        Self::Log,
        Self::Sin,
        Self::Cos,
        Self::Tan,
        Self::Asin,
        Self::Acos,
        Self::Atan,
        Self::Sinh,
        Self::Cosh,
        Self::Tanh,
        Self::Abs,
        Self::Sign,
        Self::Logistic,
        Self::Softplus,
    ];

    /// What generated code, and the language where it has it as a function, call the operation.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Neg => "neg",
            Self::Sqrt => "sqrt",
            Self::Exp => "exp",
            Self::Log => "log",
            Self::Sin => "sin",
            Self::Cos => "cos",
            Self::Tan => "tan",
            Self::Asin => "asin",
            Self::Acos => "acos",
            Self::Atan => "atan",
            Self::Sinh => "sinh",
            Self::Cosh => "cosh",
            Self::Tanh => "tanh",
            Self::Abs => "abs",
            Self::Sign => "sign",
            Self::Logistic => "logistic",
            Self::Softplus => "softplus",
        }
    }
}

/// Operations on two numbers. [`super::Scalar`] gives their exact meaning.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Binary {
    /// `a + b`.
    Add,
    /// `a - b`.
    Sub,
    /// `a b`.
    Mul,
    /// `a / b`.
    Div,
    /// `a^b` for a real exponent.
    Pow,
    /// The angle of the point with ordinate `a` and abscissa `b`.
    Atan2,
    /// `sqrt(a^2 + b^2)` without overflow.
    Hypot,
    /// The smaller.
    Min,
    /// The larger.
    Max,
    /// 1 if `a <= b`, else 0.
    LessEq,
}

impl Binary {
    /// Every binary operation, in the order of declaration.
    pub const ALL: [Self; 10] = [
        Self::Add,
        Self::Sub,
        Self::Mul,
        Self::Div,
        Self::Pow,
        Self::Atan2,
        Self::Hypot,
        Self::Min,
        Self::Max,
        Self::LessEq,
    ];

    /// What generated code, and the language where it has it as a function, call the operation.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Add => "add",
            Self::Sub => "sub",
            Self::Mul => "mul",
            Self::Div => "div",
            Self::Pow => "pow",
            Self::Atan2 => "atan2",
            Self::Hypot => "hypot",
            Self::Min => "min",
            Self::Max => "max",
            Self::LessEq => "less_eq",
        }
    }
}

/// How a [`Node::Reduce`] joins its members.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Fold {
    /// 0 for no members.
    Sum,
    /// 1 for no members.
    Product,
    /// The smallest; positive infinity for no members.
    Min,
    /// The largest; negative infinity for no members.
    Max,
}

/// One operation on nodes made before it.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub enum Node {
    /// A number.
    Const(Number),
    /// A leaf.
    Input(InputId),
    /// An operation on one node.
    Unary(Unary, NodeId),
    /// An operation on two nodes.
    Binary(Binary, NodeId, NodeId),
    /// An integer power.
    Powi(NodeId, i32),
    /// `then` where the condition is not 0, else `otherwise`; the branch not taken
    /// does not influence the value, even if it is not finite.
    Select {
        /// Compared with 0.
        condition: NodeId,
        /// The value where the condition is not 0.
        then: NodeId,
        /// The value where it is 0.
        otherwise: NodeId,
    },
    /// A partial derivative of the client's table (of order 0: its value).
    Table {
        /// The client's name for the table.
        table: u32,
        /// How often the table is differentiated with respect to each argument.
        derivative: Vec<u8>,
        /// Where it is evaluated.
        args: Vec<NodeId>,
    },
    /// The members of a family, joined. Inputs that depend on the index occur in the body.
    Reduce {
        /// How members are joined, in order of the index.
        fold: Fold,
        /// The client's name for the bound index.
        index: u32,
        /// The client's name for the range of the index.
        range: u32,
        /// One member.
        body: NodeId,
    },
}

impl Node {
    /// Calls `visit` with each operand, in order; the body of a reduction is one.
    pub fn for_each_operand(&self, mut visit: impl FnMut(NodeId)) {
        match self {
            Self::Const(_) | Self::Input(_) => {}
            Self::Unary(_, x) | Self::Powi(x, _) => visit(*x),
            Self::Binary(_, a, b) => {
                visit(*a);
                visit(*b);
            }
            Self::Select { condition, then, otherwise } => {
                visit(*condition);
                visit(*then);
                visit(*otherwise);
            }
            Self::Table { args, .. } => args.iter().copied().for_each(visit),
            Self::Reduce { body, .. } => visit(*body),
        }
    }

    /// The operands, in order; the body of a reduction is one.
    pub fn operands(&self) -> Vec<NodeId> {
        let mut operands = Vec::new();
        self.for_each_operand(|x| operands.push(x));
        operands
    }
}
