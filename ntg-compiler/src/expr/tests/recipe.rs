//! Random expressions, kept as trees so that their meaning is known without any graph.

use proptest::prelude::*;

use crate::expr::{Binary, Dag, InputId, NodeId, Scalar, Unary};

/// How many inputs random expressions have.
pub(super) const INPUTS: usize = 4;

/// An expression as a tree.
#[derive(Clone, Debug)]
pub(super) enum Recipe {
    Const(f64),
    Input(u32),
    Unary(Unary, Box<Recipe>),
    Binary(Binary, Box<Recipe>, Box<Recipe>),
    Powi(Box<Recipe>, i32),
    Select(Box<Recipe>, Box<Recipe>, Box<Recipe>),
    Table(Box<Recipe>, Box<Recipe>),
}

impl Recipe {
    /// Builds the expression in a graph.
    pub(super) fn build(&self, dag: &mut Dag) -> NodeId {
        match self {
            Self::Const(value) => dag.constant(*value),
            Self::Input(k) => dag.input(InputId(*k)),
            Self::Unary(op, x) => {
                let x = x.build(dag);
                dag.unary(*op, x)
            }
            Self::Binary(op, a, b) => {
                let (a, b) = (a.build(dag), b.build(dag));
                dag.binary(*op, a, b)
            }
            Self::Powi(x, n) => {
                let x = x.build(dag);
                dag.powi(x, *n)
            }
            Self::Select(c, a, b) => {
                let (c, a, b) = (c.build(dag), a.build(dag), b.build(dag));
                dag.select(c, a, b)
            }
            Self::Table(a, b) => {
                let args = [a.build(dag), b.build(dag)];
                dag.table(0, &[0, 0], &args)
            }
        }
    }

    /// The value as the tree is written, or `None` if a value on the way is out of the range in
    /// which simplifications are exact.
    pub(super) fn plain_value(&self, point: &[f64]) -> Option<f64> {
        let value = match self {
            Self::Const(value) => *value,
            Self::Input(k) => point[*k as usize],
            Self::Unary(op, x) => f64::unary(*op, &x.plain_value(point)?),
            Self::Binary(op, a, b) => f64::binary(*op, &a.plain_value(point)?, &b.plain_value(point)?),
            Self::Powi(x, n) => f64::integer_power(&x.plain_value(point)?, *n),
            Self::Select(c, a, b) => {
                f64::select(&c.plain_value(point)?, &a.plain_value(point)?, &b.plain_value(point)?)
            }
            Self::Table(a, b) => table(&[a.plain_value(point)?, b.plain_value(point)?], &[0, 0]),
        };
        let ordinary = value == 0.0 || (1e-200..1e200).contains(&value.abs());
        ordinary.then_some(value)
    }
}

/// The table of the tests, `sin(a) exp(b / 4)`, and its partial derivatives.
pub(super) fn table(args: &[f64], derivative: &[u8]) -> f64 {
    let (s, c) = args[0].sin_cos();
    let along_a = [s, c, -s, -c][usize::from(derivative[0] % 4)];
    along_a * 0.25_f64.powi(i32::from(derivative[1])) * (0.25 * args[1]).exp()
}

fn leaf() -> impl Strategy<Value = Recipe> {
    let constants = prop::sample::select(vec![0.0, 1.0, -1.0, 2.0, -0.5, 0.5, 3.0, -2.75, 0.1, 4.0]);
    prop_oneof![1 => constants.prop_map(Recipe::Const), 3 => (0..INPUTS as u32).prop_map(Recipe::Input)]
}

/// Any operations on anything, apart from general powers: values need not be finite.
pub(super) fn wild() -> impl Strategy<Value = Recipe> {
    let unary = prop::sample::select(Unary::ALL.to_vec());
    let binary = prop::sample::select(Binary::ALL.iter().copied().filter(|op| *op != Binary::Pow).collect::<Vec<_>>());
    leaf().prop_recursive(5, 40, 3, move |inner| {
        prop_oneof![
            2 => (Just(Unary::Neg), inner.clone()).prop_map(|(op, x)| Recipe::Unary(op, x.into())),
            2 => (unary.clone(), inner.clone()).prop_map(|(op, x)| Recipe::Unary(op, x.into())),
            5 => (binary.clone(), inner.clone(), inner.clone())
                .prop_map(|(op, a, b)| Recipe::Binary(op, a.into(), b.into())),
            1 => (inner.clone(), -3..6).prop_map(|(x, n)| Recipe::Powi(x.into(), n)),
            1 => (inner.clone(), inner.clone(), inner)
                .prop_map(|(c, a, b)| Recipe::Select(c.into(), a.into(), b.into())),
        ]
    })
}

/// Every operation, with operands guarded so that values are moderate and differentiable.
pub(super) fn tame() -> impl Strategy<Value = Recipe> {
    use Unary::*;
    let direct = prop::sample::select(vec![Neg, Sin, Cos, Atan, Tanh, Abs, Logistic, Softplus]);
    let bounded = prop::sample::select(vec![Exp, Sinh, Cosh, Asin, Acos, Tan]);
    let positive = prop::sample::select(vec![Sqrt, Log]);
    let plain = prop::sample::select(vec![Binary::Add, Binary::Sub, Binary::Mul, Binary::Min, Binary::Max]);
    let apart = prop::sample::select(vec![Binary::Div, Binary::Atan2, Binary::Hypot]);
    leaf().prop_recursive(4, 24, 3, move |inner| {
        prop_oneof![
            2 => (direct.clone(), inner.clone()).prop_map(|(op, x)| Recipe::Unary(op, x.into())),
            1 => (bounded.clone(), inner.clone()).prop_map(|(op, x)| Recipe::Unary(op, squashed(x).into())),
            1 => (positive.clone(), inner.clone()).prop_map(|(op, x)| Recipe::Unary(op, lifted(x).into())),
            4 => (plain.clone(), inner.clone(), inner.clone())
                .prop_map(|(op, a, b)| Recipe::Binary(op, a.into(), b.into())),
            2 => (apart.clone(), inner.clone(), inner.clone())
                .prop_map(|(op, a, b)| Recipe::Binary(op, a.into(), lifted(b).into())),
            1 => (inner.clone(), inner.clone())
                .prop_map(|(a, b)| Recipe::Binary(Binary::Pow, lifted(a).into(), squashed(b).into())),
            1 => (inner.clone(), prop::sample::select(vec![0.5, 1.5, -2.5, 3.0]))
                .prop_map(|(a, c)| Recipe::Binary(Binary::Pow, lifted(a).into(), Recipe::Const(c).into())),
            1 => (inner.clone(), -2..5).prop_map(|(x, n)| Recipe::Powi(lifted(x).into(), n)),
            1 => (inner.clone(), inner.clone()).prop_map(|(a, b)| Recipe::Table(a.into(), squashed(b).into())),
            1 => (inner.clone(), inner.clone(), inner.clone()).prop_map(|(c, a, b)| Recipe::Select(
                Recipe::Binary(Binary::LessEq, c.clone().into(), a.clone().into()).into(),
                a.into(),
                b.into()
            )),
        ]
    })
}

/// `0.9 tanh(x)`.
fn squashed(x: Recipe) -> Recipe {
    let bounded = Recipe::Unary(Unary::Tanh, x.into());
    Recipe::Binary(Binary::Mul, Recipe::Const(0.9).into(), bounded.into())
}

/// `0.75 + x^2`.
fn lifted(x: Recipe) -> Recipe {
    Recipe::Binary(Binary::Add, Recipe::Const(0.75).into(), Recipe::Powi(x.into(), 2).into())
}

/// A point with coordinates of order one.
pub(super) fn point() -> impl Strategy<Value = Vec<f64>> {
    prop::collection::vec(-2.0..2.0_f64, INPUTS)
}
