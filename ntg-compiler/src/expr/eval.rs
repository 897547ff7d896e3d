//! The value of expressions for given inputs: the meaning of a graph.
//!
//! Takes roots and an [`Environment`], which knows what inputs, tables and ranges stand
//! for, gives the roots' values. Generic over [`Scalar`], so that the same walk serves
//! constants of a spec, and dual numbers or intervals elsewhere.
//! Finds: a table or a range that the environment does not know.
//! Afterwards: what is not finite in the result was not finite in the mathematics.

use std::fmt;

use super::dag::Dag;
use super::hash::Map;
use super::node::{Binary, Fold, InputId, Node, NodeId};
use super::scalar::Scalar;

/// What the leaves, tables and ranges of a graph stand for.
pub trait Environment<S> {
    /// The value of an input, under the indices bound at the moment.
    fn input(&mut self, input: InputId) -> S;

    /// A table's partial derivative, or `None` for a table that is not known.
    fn table(&mut self, table: u32, args: &[S], derivative: &[u8]) -> Option<S>;

    /// The values of an index over a range, or `None` for a range that is not known.
    fn range(&mut self, range: u32) -> Option<Vec<i64>>;

    /// Binds an index to a value, and gives the value it had. `None` frees it.
    fn bind(&mut self, index: u32, value: Option<i64>) -> Option<i64>;
}

/// Why an expression has no value here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EvalError {
    /// The environment does not know this table.
    UnknownTable(u32),
    /// The environment does not know this range.
    UnknownRange(u32),
}

impl fmt::Display for EvalError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::UnknownTable(table) => write!(f, "table {table} has no values here"),
            Self::UnknownRange(range) => write!(f, "range {range} has no members here"),
        }
    }
}

impl std::error::Error for EvalError {}

/// The values of the roots where tables are given by a function and there are no reductions
/// (they are refused as unknown ranges).
pub fn eval(
    dag: &Dag,
    roots: &[NodeId],
    input: impl FnMut(InputId) -> f64,
    table: impl FnMut(u32, &[f64], &[u8]) -> f64,
) -> Result<Vec<f64>, EvalError> {
    eval_in(dag, roots, &mut Functions { input, table })
}

/// The values of the roots in an environment. The recursion is as deep as reductions are
/// nested, not as expressions are long.
pub fn eval_in<S: Scalar>(
    dag: &Dag,
    roots: &[NodeId],
    environment: &mut impl Environment<S>,
) -> Result<Vec<S>, EvalError> {
    eval_from(dag, roots, environment, &mut Map::default())
}

/// As [`eval_in`], where the values of some nodes in the same environment are known; those of all nodes outside reductions that
/// the roots are made of are known afterwards. So what many roots share is evaluated once.
pub fn eval_from<S: Scalar>(
    dag: &Dag,
    roots: &[NodeId],
    environment: &mut impl Environment<S>,
    values: &mut Map<NodeId, S>,
) -> Result<Vec<S>, EvalError> {
    for id in dag.schedule_unknown(roots, |id| values.contains_key(&id)) {
        let value = match dag.node(id) {
            Node::Const(number) => S::constant(number.value()),
            Node::Input(input) => environment.input(*input),
            Node::Unary(op, x) => S::unary(*op, &values[x]),
            Node::Binary(op, a, b) => S::binary(*op, &values[a], &values[b]),
            Node::Powi(x, n) => S::integer_power(&values[x], *n),
            Node::Select { condition, then, otherwise } => {
                S::select(&values[condition], &values[then], &values[otherwise])
            }
            Node::Table { table, derivative, args } => {
                let args: Vec<S> = args.iter().map(|x| values[x].clone()).collect();
                environment.table(*table, &args, derivative).ok_or(EvalError::UnknownTable(*table))?
            }
            Node::Reduce { fold, index, range, body } => {
                let members = environment.range(*range).ok_or(EvalError::UnknownRange(*range))?;
                reduce(dag, *fold, *body, (*index, &members), environment)?
            }
        };
        values.insert(id, value);
    }
    Ok(roots.iter().map(|root| values[root].clone()).collect())
}

fn reduce<S: Scalar>(
    dag: &Dag,
    fold: Fold,
    body: NodeId,
    (index, members): (u32, &[i64]),
    environment: &mut impl Environment<S>,
) -> Result<S, EvalError> {
    let (op, neutral) = match fold {
        Fold::Sum => (Binary::Add, 0.0),
        Fold::Product => (Binary::Mul, 1.0),
        Fold::Min => (Binary::Min, f64::INFINITY),
        Fold::Max => (Binary::Max, f64::NEG_INFINITY),
    };
    let mut result = S::constant(neutral);
    for member in members {
        // An index of the same name outside is hidden inside, and restored afterwards.
        let outer = environment.bind(index, Some(*member));
        let value = eval_in(dag, &[body], environment);
        environment.bind(index, outer);
        result = S::binary(op, &result, &value?[0]);
    }
    Ok(result)
}

struct Functions<I, T> {
    input: I,
    table: T,
}

impl<I, T> Environment<f64> for Functions<I, T>
where
    I: FnMut(InputId) -> f64,
    T: FnMut(u32, &[f64], &[u8]) -> f64,
{
    fn input(&mut self, input: InputId) -> f64 {
        (self.input)(input)
    }

    fn table(&mut self, table: u32, args: &[f64], derivative: &[u8]) -> Option<f64> {
        Some((self.table)(table, args, derivative))
    }

    fn range(&mut self, _range: u32) -> Option<Vec<i64>> {
        None
    }

    fn bind(&mut self, _index: u32, _value: Option<i64>) -> Option<i64> {
        None
    }
}
