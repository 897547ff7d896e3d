//! First and second derivatives by hyper-dual numbers, which are exact to rounding.

use ntg::runtime::splines::Table;
use ntg::runtime::structure::Kernel;
use ntg_compiler::expr::{Binary, Environment, InputId, Scalar, Unary, eval_in};
use ntg_compiler::program::KernelBody;
use num_dual::{DualNum, HyperDual64};

use crate::inputs::{Sample, close};

/// A hyper-dual number with the compiler's operations.
#[derive(Clone)]
struct Hyper(HyperDual64);

impl Scalar for Hyper {
    fn constant(value: f64) -> Self {
        Self(HyperDual64::from(value))
    }

    fn unary(op: Unary, x: &Self) -> Self {
        let (x, one) = (x.0, HyperDual64::from(1.0));
        Self(match op {
            Unary::Neg => -x,
            Unary::Sqrt => x.sqrt(),
            Unary::Exp => x.exp(),
            Unary::Log => x.ln(),
            Unary::Sin => x.sin(),
            Unary::Cos => x.cos(),
            Unary::Tan => x.tan(),
            Unary::Asin => x.asin(),
            Unary::Acos => x.acos(),
            Unary::Atan => x.atan(),
            Unary::Sinh => x.sinh(),
            Unary::Cosh => x.cosh(),
            Unary::Tanh => x.tanh(),
            Unary::Abs => {
                if x.re < 0.0 {
                    -x
                } else {
                    x
                }
            }
            Unary::Sign => HyperDual64::from(f64::unary(Unary::Sign, &x.re)),
            // The stable forms, so that no infinity comes between.
            Unary::Logistic if x.re >= 0.0 => one / (one + (-x).exp()),
            Unary::Logistic => x.exp() / (one + x.exp()),
            Unary::Softplus if x.re > 0.0 => x + (one + (-x).exp()).ln(),
            Unary::Softplus => (one + x.exp()).ln(),
        })
    }

    fn binary(op: Binary, a: &Self, b: &Self) -> Self {
        let (a, b) = (a.0, b.0);
        Self(match op {
            Binary::Add => a + b,
            Binary::Sub => a - b,
            Binary::Mul => a * b,
            Binary::Div => a / b,
            Binary::Pow => (b * a.ln()).exp(),
            Binary::Atan2 => a.atan2(b),
            Binary::Hypot => (a * a + b * b).sqrt(),
            Binary::Min => {
                if a.re <= b.re {
                    a
                } else {
                    b
                }
            }
            Binary::Max => {
                if a.re >= b.re {
                    a
                } else {
                    b
                }
            }
            Binary::LessEq => HyperDual64::from(f64::from(u8::from(a.re <= b.re))),
        })
    }

    fn integer_power(x: &Self, n: i32) -> Self {
        Self(x.0.powi(n))
    }

    fn select(condition: &Self, then: &Self, otherwise: &Self) -> Self {
        if condition.0.re != 0.0 { then.clone() } else { otherwise.clone() }
    }
}

/// The inputs of one lane; two slots carry the two infinitesimals.
struct At<'a> {
    sample: &'a Sample,
    lane: usize,
    slots: (usize, usize),
    tables: &'a [Table],
}

impl Environment<Hyper> for At<'_> {
    fn input(&mut self, input: InputId) -> Hyper {
        let k = input.0 as usize;
        let mut x = HyperDual64::from(self.sample.inputs[k * self.sample.lanes + self.lane]);
        x.eps1 = f64::from(u8::from(k == self.slots.0));
        x.eps2 = f64::from(u8::from(k == self.slots.1));
        Hyper(x)
    }

    /// The chain rule of second order over a table's partial derivatives.
    fn table(&mut self, table: u32, args: &[Hyper], derivative: &[u8]) -> Option<Hyper> {
        let table = self.tables.get(table as usize)?;
        let point: Vec<f64> = args.iter().map(|a| a.0.re).collect();
        let partial = |more: &[usize]| {
            let mut orders = derivative.to_vec();
            more.iter().for_each(|k| orders[*k] += 1);
            table.eval(&point, &orders)
        };
        let mut result = HyperDual64::from(partial(&[]));
        for (i, a) in args.iter().enumerate() {
            let slope = partial(&[i]);
            result.eps1 += slope * a.0.eps1;
            result.eps2 += slope * a.0.eps2;
            result.eps1eps2 += slope * a.0.eps1eps2;
            for (j, b) in args.iter().enumerate() {
                result.eps1eps2 += partial(&[i, j]) * a.0.eps1 * b.0.eps2;
            }
        }
        Some(Hyper(result))
    }

    fn range(&mut self, _: u32) -> Option<Vec<i64>> {
        None
    }

    fn bind(&mut self, _: u32, _: Option<i64>) -> Option<i64> {
        None
    }
}

/// Compares all first and second derivatives of a kernel in one lane; entries outside the patterns
/// must be zero.
pub(crate) fn compare(
    body: &KernelBody,
    kernel: &Kernel,
    sample: &Sample,
    lane: usize,
    tables: &[Table],
    jacobian: &[f64],
    hessian: &[f64],
) {
    /// Relative agreement that rounding allows, and the size below which a number is rounding.
    const RELATIVE: f64 = 1e-9;
    if kernel.jacobian.is_empty() {
        return; // A kernel that is only shown has no derivatives.
    }
    let entry = |pattern: &[(usize, usize)], entries: &[f64], at: (usize, usize)| {
        pattern.iter().position(|p| *p == at).map_or(0.0, |e| entries[e * sample.lanes + lane])
    };
    for i in 0..kernel.slots {
        for j in 0..=i {
            let mut at = At { sample, lane, slots: (i, j), tables };
            let rows = eval_in(&body.dag, &body.values, &mut at).expect("kernels hold no reductions");
            let mut second = 0.0;
            let mut size = 0.0;
            for (row, value) in rows.iter().enumerate() {
                let what = || format!("{} d{row}/d{i}", kernel.name);
                let slope = value.0.eps1;
                close(entry(&kernel.jacobian, jacobian, (row, i)), slope, RELATIVE, slope.abs() * 1e-9 + 1e-14, what);
                let term = sample.weights[row * sample.lanes + lane] * value.0.eps1eps2;
                second += term;
                size += term.abs();
            }
            let what = || format!("{} d2/d{i} d{j}", kernel.name);
            close(entry(&kernel.hessian, hessian, (i, j)), second, RELATIVE, size * 1e-9 + 1e-14, what);
        }
    }
}
