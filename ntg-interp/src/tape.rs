//! A kernel's formulas as a list of operations on registers.
//!
//! Takes roots of an expression graph, gives a [`Tape`]. A register holds one number for each lane
//! of a chunk. Inputs and constants keep their registers; a temporary's register is free again
//! after its last use, so that the working set stays in the nearest cache.

use std::collections::HashMap;

use ntg_compiler::expr::{Binary, Dag, Node, NodeId, Unary};

/// One operation: it reads registers and writes the register `to`, or several for a look-up.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Step {
    pub(crate) to: usize,
    pub(crate) operation: Operation,
}

/// What an operation does; numbers are registers.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Operation {
    Unary(Unary, usize),
    Binary(Binary, usize, usize),
    Powi(usize, i32),
    Select(usize, usize, usize),
    /// Each derivative goes to a register of its own; of each one `orders` has as many numbers as there are
    /// arguments.
    Table {
        table: usize,
        args: Vec<usize>,
        orders: Vec<u8>,
        results: Vec<usize>,
    },
}

/// A straight-line program.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Tape {
    /// Registers that are loaded from input columns: `(register, column)`.
    pub(crate) inputs: Vec<(usize, usize)>,
    /// Registers that hold constants.
    pub(crate) constants: Vec<(usize, f64)>,
    /// The operations, in order.
    pub(crate) steps: Vec<Step>,
    /// The registers of the results.
    pub(crate) results: Vec<usize>,
    /// How many registers there are.
    pub(crate) registers: usize,
}

impl Tape {
    pub(crate) fn new(dag: &Dag, roots: &[NodeId]) -> Self {
        let schedule = dag.schedule(roots);
        let last_use = last_uses(dag, &schedule, roots);
        let mut tape = Self::default();
        let mut register: HashMap<NodeId, usize> = HashMap::new(); // Looked up, never iterated.
        let mut free: Vec<usize> = Vec::new();
        // Inputs and constants first: their registers are never handed on.
        for id in &schedule {
            match dag.node(*id) {
                Node::Const(number) => tape.constants.push((tape.registers, number.value())),
                Node::Input(input) => tape.inputs.push((tape.registers, input.0 as usize)),
                _ => continue,
            }
            register.insert(*id, tape.registers);
            tape.registers += 1;
        }
        for (position, id) in schedule.iter().enumerate() {
            if dag.is_leaf(*id) {
                continue;
            }
            let mut fresh = || {
                free.pop().unwrap_or_else(|| {
                    tape.registers += 1;
                    tape.registers - 1
                })
            };
            if let Node::Table { table, args, .. } = dag.node(*id) {
                // One look-up gives all derivatives at the same place, when the first is needed.
                if !register.contains_key(id) {
                    let (mut orders, mut results) = (vec![], vec![]);
                    for (other, derivative) in together(dag, &schedule, (*table, args)) {
                        orders.extend_from_slice(derivative);
                        results.push(fresh());
                        register.insert(other, results[results.len() - 1]);
                    }
                    let args = args.iter().map(|arg| register[arg]).collect();
                    tape.steps.push(Step {
                        to: register[id],
                        operation: Operation::Table { table: *table as usize, args, orders, results },
                    });
                }
            } else if let Some(operation) = operation(dag.node(*id), |operand| register[&operand]) {
                let to = fresh();
                register.insert(*id, to);
                tape.steps.push(Step { to, operation });
            }
            let mut operands = dag.node(*id).operands();
            operands.sort_unstable();
            operands.dedup();
            for operand in operands {
                let leaf = matches!(dag.node(operand), Node::Const(_) | Node::Input(_));
                if !leaf && last_use[&operand] == position {
                    free.push(register[&operand]);
                }
            }
        }
        tape.results = roots.iter().map(|root| register[root]).collect();
        tape
    }
}

/// The position of each node's last reader; results are read at the very end.
fn last_uses(dag: &Dag, schedule: &[NodeId], roots: &[NodeId]) -> HashMap<NodeId, usize> {
    let mut last: HashMap<NodeId, usize> = schedule.iter().map(|id| (*id, usize::MAX)).collect();
    for (position, id) in schedule.iter().enumerate() {
        dag.node(*id).for_each_operand(|operand| {
            last.insert(operand, position);
        });
    }
    last.extend(roots.iter().map(|root| (*root, usize::MAX)));
    last
}

/// The derivatives of a table at the same arguments, in the order of the schedule.
fn together<'a>(
    dag: &'a Dag,
    schedule: &'a [NodeId],
    (table, args): (u32, &'a [NodeId]),
) -> impl Iterator<Item = (NodeId, &'a [u8])> {
    schedule.iter().filter_map(move |id| match dag.node(*id) {
        Node::Table { table: t, derivative, args: a } if (*t, &a[..]) == (table, args) => Some((*id, &derivative[..])),
        _ => None,
    })
}

fn operation(node: &Node, register: impl Fn(NodeId) -> usize) -> Option<Operation> {
    Some(match node {
        Node::Const(_) | Node::Input(_) | Node::Table { .. } => return None,
        Node::Unary(op, a) => Operation::Unary(*op, register(*a)),
        Node::Binary(op, a, b) => Operation::Binary(*op, register(*a), register(*b)),
        Node::Powi(a, n) => Operation::Powi(register(*a), *n),
        Node::Select { condition, then, otherwise } => {
            Operation::Select(register(*condition), register(*then), register(*otherwise))
        }
        // Lowering has turned every reduction into an input.
        Node::Reduce { .. } => return None,
    })
}
