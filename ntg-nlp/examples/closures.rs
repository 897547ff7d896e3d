//! A nonlinear program from closures: problem 71 of W. Hock and K. Schittkowski, *Test Examples for Nonlinear
//! Programming Codes* (1981).
//!
//! ```text
//! minimise    a d (a + b + c) + c
//! subject to  a b c d >= 25,   a^2 + b^2 + c^2 + d^2 = 40,   1 <= a, b, c, d <= 5
//! ```
//!
//! Run with `cargo run -p ntg-nlp --example closures`.

use ntg_nlp::closures::{Functions, Program};
use ntg_nlp::{Options, solve};

/// Values, gradients and Hessians of the objective and of both constraints.
fn functions(x: &[f64], out: &mut Functions) {
    let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
    out.set_value(0, a * d * (a + b + c) + c);
    out.set_gradient(0, &[d * (2.0 * a + b + c), a * d, a * d + 1.0, a * (a + b + c)]);
    let by_d = 2.0 * a + b + c;
    #[rustfmt::skip]
    out.set_hessian(0, &[
        2.0 * d, d,   d,   by_d,
        d,       0.0, 0.0, a,
        d,       0.0, 0.0, a,
        by_d,    a,   a,   0.0,
    ]);
    out.set_value(1, a * b * c * d);
    out.set_gradient(1, &[b * c * d, a * c * d, a * b * d, a * b * c]);
    #[rustfmt::skip]
    out.set_hessian(1, &[
        0.0,   c * d, b * d, b * c,
        c * d, 0.0,   a * d, a * c,
        b * d, a * d, 0.0,   a * b,
        b * c, a * c, a * b, 0.0,
    ]);
    out.set_value(2, x.iter().map(|x| x * x).sum());
    for (slope, x) in out.gradient_mut(2).iter_mut().zip(x) {
        *slope = 2.0 * x;
    }
    for i in 0..4 {
        out.hessian_mut(2)[4 * i + i] = 2.0;
    }
}

fn main() {
    let bounds = [(1.0, 5.0); 4];
    let constraints = [(25.0, f64::INFINITY), (40.0, 40.0)];
    let program = Program::dense(&bounds, &constraints, functions);
    let outcome = solve(&program, &[1.0, 5.0, 5.0, 1.0], &Options::default());
    println!("{} after {} iterations", outcome.status, outcome.iterations);
    println!("objective    {:.9}", outcome.objective);
    println!("x            {:.6?}", outcome.x);
    println!("multipliers  {:.6?}", outcome.row_multipliers);
    assert!((outcome.objective - 17.014_017_289).abs() < 1e-6, "the published optimum");
}
