//! Executes a tape over lanes, a chunk of lanes at a time.
//!
//! Each operation runs over the packs of a chunk, with the same functions as generated code, so
//! that both give the same bits.

use ntg_compiler::expr::{Binary, Unary};
use ntg_runtime::math::{self, MOST_LANES, Pack, Simd, Task, Work, dispatch};
use ntg_splines::Table;

use crate::tape::{Operation, Step, Tape};

/// Lanes in a chunk, a multiple of the lanes of every pack: a register is then 512 bytes, and some
/// sixty registers fill a first-level cache of 32 KiB.
const CHUNK: usize = 64;

/// The most arguments a table can have here without allocation.
const MOST_ARGUMENTS: usize = 8;

/// How many derivatives of a table are taken at once.
const MOST_RESULTS: usize = 16;

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
        dispatch(Chunk { tape, count, tables, registers });
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

/// The operations of a tape over the lanes of a chunk.
struct Chunk<'a> {
    tape: &'a Tape,
    count: usize,
    tables: &'a [Table],
    registers: &'a mut [f64],
}

impl Task for Chunk<'_> {
    #[inline(always)]
    fn run<S: Simd>(self, simd: S) {
        let Self { tape, count, tables, registers } = self;
        for step in &tape.steps {
            simd.vectorize(Execution { simd, step, count, tables, registers: &mut *registers });
        }
    }
}

/// One operation over the lanes of a chunk; lanes beyond `count` up to the end of a pack may hold anything.
struct Execution<'a, S> {
    simd: S,
    step: &'a Step,
    count: usize,
    tables: &'a [Table],
    registers: &'a mut [f64],
}

impl<S: Simd> Work for Execution<'_, S> {
    #[inline(always)]
    fn run(mut self) {
        match &self.step.operation {
            Operation::Unary(op, a) => self.unary(*op, *a),
            Operation::Binary(op, a, b) => self.binary(*op, *a, *b),
            Operation::Powi(a, n) => self.map([*a], |[x]| math::powi(x, *n)),
            Operation::Select(c, a, b) => self.map([*c, *a, *b], |[c, a, b]| math::select(c, a, b)),
            Operation::Table { table, args, orders, results } => self.table(*table, args, orders, results),
        }
    }
}

impl<S: Simd> Execution<'_, S> {
    /// Chooses the operation once for all lanes.
    #[inline(always)]
    fn unary(&mut self, op: Unary, a: usize) {
        macro_rules! choose {
            ($($name:ident => $function:expr),+ $(,)?) => {
                match op { $(Unary::$name => self.map([a], |[x]| $function(x))),+ }
            };
        }
        choose! {
            Neg => |x: Pack<S>| -x,
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
    #[inline(always)]
    fn binary(&mut self, op: Binary, a: usize, b: usize) {
        macro_rules! choose {
            ($($name:ident => $function:expr),+ $(,)?) => {
                match op { $(Binary::$name => self.map([a, b], |[a, b]| $function(a, b))),+ }
            };
        }
        choose! {
            Add => |a: Pack<S>, b| a + b,
            Sub => |a: Pack<S>, b| a - b,
            Mul => |a: Pack<S>, b| a * b,
            Div => |a: Pack<S>, b| a / b,
            Pow => math::pow,
            Atan2 => math::atan2,
            Hypot => math::hypot,
            Min => math::min,
            Max => math::max,
            LessEq => math::less_eq,
        }
    }

    /// `to = f(operands)`, pack by pack; the register `to` may be one of the operands.
    #[inline(always)]
    fn map<const N: usize>(&mut self, operands: [usize; N], f: impl Fn([Pack<S>; N]) -> Pack<S>) {
        const { assert!(CHUNK.is_multiple_of(S::LANES)) };
        let to = self.step.to * CHUNK;
        for lane in (0..self.count).step_by(S::LANES) {
            let x = operands.map(|register| Pack::load(self.simd, &self.registers[register * CHUNK + lane..]));
            f(x).store(&mut self.registers[to + lane..]);
        }
    }

    #[inline(always)]
    fn table(&mut self, table: usize, args: &[usize], orders: &[u8], results: &[usize]) {
        let mut point = [[0.0; MOST_LANES]; MOST_ARGUMENTS];
        for lane in (0..self.count).step_by(S::LANES) {
            for (x, register) in point.iter_mut().zip(args) {
                x[..S::LANES].copy_from_slice(&self.registers[register * CHUNK + lane..][..S::LANES]);
            }
            let groups = results.chunks(MOST_RESULTS).zip(orders.chunks(MOST_RESULTS * args.len()));
            for (results, orders) in groups {
                let mut out = [[0.0; MOST_LANES]; MOST_RESULTS];
                self.tables[table].look_up(S::LANES, &point[..args.len()], orders, &mut out[..results.len()]);
                for (register, derivative) in results.iter().zip(out) {
                    self.registers[register * CHUNK + lane..][..S::LANES].copy_from_slice(&derivative[..S::LANES]);
                }
            }
        }
    }
}
