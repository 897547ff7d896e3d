//! Executes a tape over lanes, a chunk of lanes at a time.

use ntg_compiler::expr::{Binary, Unary};
use ntg_runtime::math;
use ntg_splines::Table;

use crate::tape::{Operation, Step, Tape};

/// Lanes in a chunk: a register is then 512 bytes, and some sixty registers fill a first-level
/// cache of 32 KiB.
const CHUNK: usize = 64;

/// The most arguments a table can have here without allocation.
const MOST_ARGUMENTS: usize = 8;

/// Input columns: those of `first`, then those of `second`, each with one number a lane.
#[derive(Clone, Copy)]
pub(crate) struct Columns<'a> {
    pub(crate) lanes: usize,
    pub(crate) first: &'a [f64],
    pub(crate) second: &'a [f64],
}

impl Columns<'_> {
    /// The lanes `from .. from + count` of one column.
    fn column(&self, column: usize, from: usize, count: usize) -> &[f64] {
        let start = column * self.lanes + from;
        match start.checked_sub(self.first.len()) {
            None => &self.first[start..start + count],
            Some(start) => &self.second[start..start + count],
        }
    }
}

/// Runs a tape; the results go to the columns of `parts`, one part after the other.
pub(crate) fn run(
    tape: &Tape,
    input: Columns<'_>,
    tables: &[Table],
    registers: &mut Vec<f64>,
    parts: &mut [&mut [f64]],
) {
    if registers.len() < tape.registers * CHUNK {
        registers.resize(tape.registers * CHUNK, 0.0);
    }
    for (register, value) in &tape.constants {
        registers[register * CHUNK..][..CHUNK].fill(*value);
    }
    let mut from = 0;
    while from < input.lanes {
        let count = CHUNK.min(input.lanes - from);
        for (register, column) in &tape.inputs {
            registers[register * CHUNK..][..count].copy_from_slice(input.column(*column, from, count));
        }
        for step in &tape.steps {
            execute(step, count, tables, registers);
        }
        let mut results = tape.results.iter();
        for part in parts.iter_mut() {
            for column in part.chunks_exact_mut(input.lanes) {
                let Some(register) = results.next() else { break };
                column[from..from + count].copy_from_slice(&registers[register * CHUNK..][..count]);
            }
        }
        from += count;
    }
}

fn execute(step: &Step, count: usize, tables: &[Table], registers: &mut [f64]) {
    let to = step.to;
    match &step.operation {
        Operation::Unary(op, a) => unary(*op, registers, to, *a, count),
        Operation::Binary(op, a, b) => binary(*op, registers, to, (*a, *b), count),
        Operation::Powi(a, n) => map1(registers, to, *a, count, |x| math::powi(x, *n)),
        Operation::Select(c, a, b) => {
            for lane in 0..count {
                let at = |register: &usize| registers[register * CHUNK + lane];
                registers[to * CHUNK + lane] = math::select(at(c), at(a), at(b));
            }
        }
        Operation::Table { table, derivative, args } => {
            for lane in 0..count {
                let mut point = [0.0; MOST_ARGUMENTS];
                for (x, register) in point.iter_mut().zip(args) {
                    *x = registers[register * CHUNK + lane];
                }
                registers[to * CHUNK + lane] = tables[*table].eval(&point[..args.len()], derivative);
            }
        }
    }
}

/// Chooses the operation once for all lanes.
fn unary(op: Unary, registers: &mut [f64], to: usize, a: usize, count: usize) {
    macro_rules! choose {
        ($($name:ident => $function:expr),+ $(,)?) => {
            match op { $(Unary::$name => map1(registers, to, a, count, $function)),+ }
        };
    }
    choose! {
        Neg => |x: f64| -x,
        Sqrt => math::sqrt,
        Exp => math::exp,
        Log => math::log,
        Sin => math::sin,
        Cos => math::cos,
        Tan => math::tan,
        Asin => math::asin,
        Acos => math::acos,
        Atan => math::atan,
        Sinh => math::sinh,
        Cosh => math::cosh,
        Tanh => math::tanh,
        Abs => math::abs,
        Sign => math::sign,
        Logistic => math::logistic,
        Softplus => math::softplus,
    }
}

/// Chooses the operation once for all lanes.
fn binary(op: Binary, registers: &mut [f64], to: usize, operands: (usize, usize), count: usize) {
    macro_rules! choose {
        ($($name:ident => $function:expr),+ $(,)?) => {
            match op { $(Binary::$name => map2(registers, to, operands, count, $function)),+ }
        };
    }
    choose! {
        Add => |a: f64, b: f64| a + b,
        Sub => |a: f64, b: f64| a - b,
        Mul => |a: f64, b: f64| a * b,
        Div => |a: f64, b: f64| a / b,
        Pow => math::pow,
        Atan2 => math::atan2,
        Hypot => math::hypot,
        Min => math::min,
        Max => math::max,
        LessEq => math::less_eq,
    }
}

/// `to = f(a)`; the register `to` may be `a` itself.
fn map1(registers: &mut [f64], to: usize, a: usize, count: usize, f: impl Fn(f64) -> f64) {
    let (to, a) = (to * CHUNK, a * CHUNK);
    for lane in 0..count {
        registers[to + lane] = f(registers[a + lane]);
    }
}

/// `to = f(a, b)`; the register `to` may be one of the operands.
fn map2(registers: &mut [f64], to: usize, (a, b): (usize, usize), count: usize, f: impl Fn(f64, f64) -> f64) {
    let (to, a, b) = (to * CHUNK, a * CHUNK, b * CHUNK);
    for lane in 0..count {
        registers[to + lane] = f(registers[a + lane], registers[b + lane]);
    }
}
