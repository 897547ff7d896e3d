//! A kernel's formulas with the inputs that an element gives them.

use crate::error::ExportError;
use crate::graph::{Binary, Compare, Graph, Id, Node, Unary};
use crate::table;
use crate::value::Value;
use ntg_compiler::expr::{self, Dag, NodeId, Scalar};
use ntg_compiler::program::Program;
use ntg_runtime::transcribe::{ElementCall, ElementInput};
use ntg_splines::Table;
use ntg_structure::ReduceOp;
use std::collections::HashMap;

/// What all elements are written with.
pub(crate) struct Writer<'a> {
    pub(crate) program: &'a Program,
    pub(crate) tables: &'a [Table],
    pub(crate) graph: Graph,
    /// Numbers of tables that have been written so far.
    pub(crate) numbers: usize,
}

impl Writer<'_> {
    /// The rows of a call; `slots` are those of the element.
    ///
    /// # Errors
    /// What the format cannot say.
    pub(crate) fn rows(&mut self, call: &ElementCall, slots: &[Value]) -> Result<Vec<Value>, ExportError> {
        let mut inputs = vec![];
        for input in &call.inputs {
            inputs.push(match input {
                ElementInput::Slot(slot) => slots[*slot].clone(),
                ElementInput::Number(number) => Value::constant(*number),
                ElementInput::Reduced(op, members) => self.reduced(*op, members, slots)?,
            });
        }
        let program = self.program;
        let body = &program.kernels[call.kernel];
        let mut values: HashMap<NodeId, Value> = HashMap::new(); // Looked up, never iterated.
        for id in body.dag.schedule(&body.values) {
            let value = self.value(&body.dag, id, &inputs, &values)?;
            values.insert(id, value);
        }
        body.values.iter().map(|row| self.checked(&values[row], call.kernel)).collect()
    }

    /// A value without numbers that no file can hold.
    fn checked(&self, value: &Value, kernel: usize) -> Result<Value, ExportError> {
        let affine = &value.affine;
        let is_finite = affine.constant.is_finite() && affine.terms.iter().all(|(_, c)| c.is_finite());
        if is_finite { Ok(value.clone()) } else { Err(ExportError::NotFinite(self.label(kernel))) }
    }

    fn label(&self, kernel: usize) -> String {
        let body = &self.program.kernels[kernel];
        body.labels.first().cloned().unwrap_or_else(|| self.program.structure.kernels[kernel].name.clone())
    }

    fn reduced(&mut self, op: ReduceOp, members: &[ElementCall], slots: &[Value]) -> Result<Value, ExportError> {
        let mut values = vec![];
        for member in members {
            values.push(self.rows(member, slots)?.swap_remove(0));
        }
        Ok(match op {
            ReduceOp::Sum => self.halves(&values, Value::constant(0.0), |own, a, b| a.plus(1.0, b, &mut own.graph)),
            ReduceOp::Product => self.halves(&values, Value::constant(1.0), Self::product),
            ReduceOp::Min => self.extreme(&values, f64::INFINITY),
            ReduceOp::Max => self.extreme(&values, f64::NEG_INFINITY),
        })
    }

    /// Combines halves, so that no expression is deeper than it must be.
    fn halves(&mut self, values: &[Value], none: Value, both: fn(&mut Self, &Value, &Value) -> Value) -> Value {
        match values {
            [] => none,
            [one] => one.clone(),
            _ => {
                let (left, right) = values.split_at(values.len() / 2);
                let (left, right) = (self.halves(left, none.clone(), both), self.halves(right, none, both));
                both(self, &left, &right)
            }
        }
    }

    /// The smallest of some values, or with `none` below zero the largest.
    fn extreme(&mut self, values: &[Value], none: f64) -> Value {
        match values {
            [] => return Value::constant(none),
            [one] => return one.clone(),
            _ => {}
        }
        let ids = values.iter().map(|value| value.id(&mut self.graph)).collect();
        Value::nonlinear(self.graph.add(if none > 0.0 { Node::Least(ids) } else { Node::Greatest(ids) }))
    }

    fn product(&mut self, a: &Value, b: &Value) -> Value {
        match (a.number(), b.number()) {
            (Some(factor), _) => b.times(factor, &mut self.graph),
            (_, Some(factor)) => a.times(factor, &mut self.graph),
            _ => self.joined(Binary::Mul, a, b),
        }
    }

    fn joined(&mut self, function: Binary, a: &Value, b: &Value) -> Value {
        let (a, b) = (a.id(&mut self.graph), b.id(&mut self.graph));
        Value::nonlinear(self.graph.binary(function, a, b))
    }

    fn value(
        &mut self,
        dag: &Dag,
        id: NodeId,
        inputs: &[Value],
        values: &HashMap<NodeId, Value>,
    ) -> Result<Value, ExportError> {
        Ok(match dag.node(id) {
            expr::Node::Const(number) => Value::constant(number.value()),
            expr::Node::Input(input) => inputs[input.0 as usize].clone(),
            expr::Node::Unary(op, a) => self.unary(*op, &values[a]),
            expr::Node::Binary(op, a, b) => self.binary(*op, &values[a], &values[b]),
            expr::Node::Powi(a, n) => match values[a].number() {
                Some(number) => Value::constant(f64::integer_power(&number, *n)),
                None => self.joined(Binary::Pow, &values[a], &Value::constant(f64::from(*n))),
            },
            expr::Node::Select { condition, then, otherwise } => {
                self.select(dag.node(*condition), values, (condition, then, otherwise))
            }
            expr::Node::Table { table, derivative, args } => {
                let args: Vec<Value> = args.iter().map(|arg| values[arg].clone()).collect();
                self.table(*table as usize, derivative, &args)?
            }
            expr::Node::Reduce { .. } => return Err(ExportError::Malformed("a reduction inside a kernel")),
        })
    }

    fn table(&mut self, table: usize, derivative: &[u8], args: &[Value]) -> Result<Value, ExportError> {
        let Some(found) = self.tables.get(table) else {
            return Err(ExportError::Malformed("a table that is not there"));
        };
        if let Some(numbers) = args.iter().map(Value::number).collect::<Option<Vec<f64>>>() {
            return Ok(Value::constant(found.eval(&numbers, derivative)));
        }
        self.numbers += table::size(found);
        if self.numbers > table::MOST_NUMBERS {
            return Err(ExportError::Tables(self.program.structure.tables[table].name.clone()));
        }
        let args: Vec<Id> = args.iter().map(|arg| arg.id(&mut self.graph)).collect();
        Ok(Value::nonlinear(table::look_up(&mut self.graph, found, derivative, &args)))
    }

    fn select(
        &mut self,
        test: &expr::Node,
        values: &HashMap<NodeId, Value>,
        (condition, then, otherwise): (&NodeId, &NodeId, &NodeId),
    ) -> Value {
        if let Some(number) = values[condition].number() {
            return values[if number != 0.0 { then } else { otherwise }].clone();
        }
        let [then, otherwise] = [then, otherwise].map(|id| values[id].id(&mut self.graph));
        let compare = match test {
            expr::Node::Binary(expr::Binary::LessEq, a, b) => {
                let [a, b] = [a, b].map(|id| values[id].id(&mut self.graph));
                (Compare::LessEqual, a, b)
            }
            _ => {
                let [condition, zero] = [values[condition].id(&mut self.graph), self.graph.constant(0.0)];
                (Compare::NotEqual, condition, zero)
            }
        };
        Value::nonlinear(self.graph.choose(compare, then, otherwise))
    }

    fn binary(&mut self, op: expr::Binary, a: &Value, b: &Value) -> Value {
        if let (Some(x), Some(y)) = (a.number(), b.number()) {
            return Value::constant(f64::binary(op, &x, &y));
        }
        match op {
            expr::Binary::Add => a.plus(1.0, b, &mut self.graph),
            expr::Binary::Sub => a.plus(-1.0, b, &mut self.graph),
            expr::Binary::Mul => self.product(a, b),
            expr::Binary::Div => match b.number() {
                // A quotient and a product with the inverse round differently; both are the same function.
                Some(divisor) if (1.0 / divisor).is_finite() => a.times(1.0 / divisor, &mut self.graph),
                _ => self.joined(Binary::Div, a, b),
            },
            expr::Binary::Pow => self.joined(Binary::Pow, a, b),
            expr::Binary::Atan2 => self.joined(Binary::Atan2, a, b),
            expr::Binary::Hypot => {
                let two = Value::constant(2.0);
                let [a, b] = [a, b].map(|x| self.joined(Binary::Pow, x, &two));
                let sum = a.plus(1.0, &b, &mut self.graph);
                self.applied(Unary::Sqrt, &sum)
            }
            expr::Binary::Min => self.extreme(&[a.clone(), b.clone()], f64::INFINITY),
            expr::Binary::Max => self.extreme(&[a.clone(), b.clone()], f64::NEG_INFINITY),
            expr::Binary::LessEq => {
                let [a, b] = [a, b].map(|x| x.id(&mut self.graph));
                let [one, zero] = [1.0, 0.0].map(|x| self.graph.constant(x));
                Value::nonlinear(self.graph.choose((Compare::LessEqual, a, b), one, zero))
            }
        }
    }

    fn applied(&mut self, function: Unary, a: &Value) -> Value {
        let a = a.id(&mut self.graph);
        Value::nonlinear(self.graph.unary(function, a))
    }

    fn unary(&mut self, op: expr::Unary, a: &Value) -> Value {
        if let Some(number) = a.number() {
            return Value::constant(f64::unary(op, &number));
        }
        let function = match op {
            expr::Unary::Neg => return a.times(-1.0, &mut self.graph),
            expr::Unary::Sign => return self.sign(a),
            expr::Unary::Logistic => return self.logistic(a),
            expr::Unary::Softplus => return self.softplus(a),
            expr::Unary::Sqrt => Unary::Sqrt,
            expr::Unary::Exp => Unary::Exp,
            expr::Unary::Log => Unary::Log,
            expr::Unary::Sin => Unary::Sin,
            expr::Unary::Cos => Unary::Cos,
            expr::Unary::Tan => Unary::Tan,
            expr::Unary::Asin => Unary::Asin,
            expr::Unary::Acos => Unary::Acos,
            expr::Unary::Atan => Unary::Atan,
            expr::Unary::Sinh => Unary::Sinh,
            expr::Unary::Cosh => Unary::Cosh,
            expr::Unary::Tanh => Unary::Tanh,
            expr::Unary::Abs => Unary::Abs,
        };
        self.applied(function, a)
    }

    /// -1, 0 or 1.
    fn sign(&mut self, a: &Value) -> Value {
        let a = a.id(&mut self.graph);
        let [minus, zero, one] = [-1.0, 0.0, 1.0].map(|x| self.graph.constant(x));
        let not_positive = self.graph.choose((Compare::Less, a, zero), minus, zero);
        Value::nonlinear(self.graph.choose((Compare::Less, zero, a), one, not_positive))
    }

    /// `1 / (1 + exp(-x)) = (1 + tanh(x / 2)) / 2`, which cannot overflow.
    fn logistic(&mut self, a: &Value) -> Value {
        let half = a.times(0.5, &mut self.graph);
        let tanh = self.applied(Unary::Tanh, &half);
        Value::constant(0.5).plus(0.5, &tanh, &mut self.graph)
    }

    /// `log(1 + exp(x)) = (x + |x|) / 2 + log(1 + exp(-|x|))`, which cannot overflow.
    fn softplus(&mut self, a: &Value) -> Value {
        let size = self.applied(Unary::Abs, a);
        let minus = size.times(-1.0, &mut self.graph);
        let tail = self.applied(Unary::Exp, &minus);
        let tail = Value::constant(1.0).plus(1.0, &tail, &mut self.graph);
        let tail = self.applied(Unary::Log, &tail);
        let twice = a.plus(1.0, &size, &mut self.graph);
        tail.plus(0.5, &twice, &mut self.graph)
    }
}
