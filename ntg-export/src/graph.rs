//! Expressions of the whole program, each once.
//!
//! A [`Graph`] holds every nonlinear expression that rows and objective are made of. Equal expressions are one node, so
//! what several points and functions have in common is found without looking for it. Operands are made before their
//! users: increasing numbers are an order of evaluation.

use std::collections::HashMap;

/// A node of a graph.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(crate) struct Id(u32);

impl Id {
    /// Its place in the graph, from 0.
    pub(crate) fn index(self) -> usize {
        self.0 as usize
    }
}

/// A number that can be compared and hashed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) struct Bits(u64);

impl Bits {
    pub(crate) fn value(self) -> f64 {
        f64::from_bits(self.0)
    }
}

/// `constant + sum of coefficient * x[variable]`, by increasing variable, none with coefficient 0.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Affine {
    pub(crate) constant: f64,
    pub(crate) terms: Vec<(u32, f64)>,
}

/// Functions of one expression.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Unary {
    Floor,
    Abs,
    Tanh,
    Tan,
    Sqrt,
    Sinh,
    Sin,
    Log,
    Exp,
    Cosh,
    Cos,
    Atan,
    Asin,
    Acos,
}

/// Functions of two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Binary {
    Add,
    Sub,
    Mul,
    Div,
    Pow,
    Atan2,
}

/// Comparisons of two expressions.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Compare {
    Less,
    LessEqual,
    NotEqual,
}

/// One expression.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Node {
    Constant(Bits),
    Variable(u32),
    /// An affine function of two variables or more, or with a coefficient or a constant.
    Linear(Bits, Vec<(u32, Bits)>),
    Unary(Unary, Id),
    Binary(Binary, Id, Id),
    Least(Vec<Id>),
    Greatest(Vec<Id>),
    If {
        compare: (Compare, Id, Id),
        then: Id,
        otherwise: Id,
    },
}

impl Node {
    /// Calls `visit` with each operand, in order.
    pub(crate) fn each_operand(&self, mut visit: impl FnMut(Id)) {
        match self {
            Self::Constant(_) | Self::Variable(_) | Self::Linear(..) => {}
            Self::Unary(_, a) => visit(*a),
            Self::Binary(_, a, b) => [*a, *b].into_iter().for_each(visit),
            Self::Least(all) | Self::Greatest(all) => all.iter().copied().for_each(visit),
            Self::If { compare: (_, a, b), then, otherwise } => [*a, *b, *then, *otherwise].into_iter().for_each(visit),
        }
    }
}

/// All expressions of a program.
#[derive(Clone, Debug, Default)]
pub(crate) struct Graph {
    nodes: Vec<Node>,
    known: HashMap<Node, Id>, // Looked up, never iterated.
}

impl Graph {
    /// What a node is.
    pub(crate) fn node(&self, id: Id) -> &Node {
        &self.nodes[id.index()]
    }

    /// All nodes in order of evaluation.
    pub(crate) fn ids(&self) -> impl DoubleEndedIterator<Item = Id> + use<> {
        (0..u32::try_from(self.nodes.len()).unwrap_or(u32::MAX)).map(Id)
    }

    /// The one node that is this expression.
    pub(crate) fn add(&mut self, node: Node) -> Id {
        if let Some(id) = self.known.get(&node) {
            return *id;
        }
        let id = Id(u32::try_from(self.nodes.len()).expect("2^32 expressions do not fit into memory"));
        self.nodes.push(node.clone());
        self.known.insert(node, id);
        id
    }

    pub(crate) fn constant(&mut self, value: f64) -> Id {
        // The sign of a zero is dropped, so that equal numbers are one node.
        self.add(Node::Constant(Bits((value + 0.0).to_bits())))
    }

    pub(crate) fn unary(&mut self, function: Unary, a: Id) -> Id {
        self.add(Node::Unary(function, a))
    }

    pub(crate) fn binary(&mut self, function: Binary, a: Id, b: Id) -> Id {
        self.add(Node::Binary(function, a, b))
    }

    pub(crate) fn choose(&mut self, compare: (Compare, Id, Id), then: Id, otherwise: Id) -> Id {
        self.add(Node::If { compare, then, otherwise })
    }

    /// An affine function as one expression.
    pub(crate) fn affine(&mut self, affine: &Affine) -> Id {
        match affine.terms[..] {
            [] => self.constant(affine.constant),
            [(variable, 1.0)] if affine.constant == 0.0 => self.add(Node::Variable(variable)),
            _ => {
                let terms = affine.terms.iter().map(|(variable, c)| (*variable, Bits(c.to_bits()))).collect();
                self.add(Node::Linear(Bits((affine.constant + 0.0).to_bits()), terms))
            }
        }
    }
}
