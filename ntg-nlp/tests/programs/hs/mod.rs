//! The smooth problems of W. Hock and K. Schittkowski, *Test Examples for Nonlinear Programming Codes*, Lecture Notes in
//! Economics and Mathematical Systems 187, Springer (1981), by their numbers there, each with its published start and
//! optimum. The collection has no problems 82, 94 and 115. Left out are
//!
//! - 67 and 87, which are not smooth: an iteration that stops, and piecewise linear costs;
//! - 85, whose tables are not at hand;
//! - 70 and 88 to 92, whose formulas as transcribed do not give the published optimum at the published point.

#![allow(clippy::inconsistent_digit_grouping, reason = "figures as they are printed")]

mod n001_025;
mod n026_050;
mod n051_075;
mod n076_099;
mod n100_108;
mod n109_119;
mod transcendental;

use crate::support::{Jet, dense};
use ntg_nlp::closures::Program;
use std::sync::Arc;

/// The objective and the rows of a problem.
pub(crate) type JetFunctions = Arc<dyn Fn(&[Jet]) -> Vec<Jet> + Send + Sync>;

/// A problem with its published start and optimum.
#[derive(Clone)]
#[allow(dead_code, reason = "each test file uses the part that it needs")]
pub(crate) struct Problem {
    /// The number in the collection.
    pub(crate) number: u32,
    /// The published optimum.
    pub(crate) optimum: f64,
    pub(crate) start: Vec<f64>,
    pub(crate) bounds: Vec<(f64, f64)>,
    pub(crate) rows: Vec<(f64, f64)>,
    /// First the objective, then the rows.
    pub(crate) functions: JetFunctions,
}

impl Problem {
    /// The problem as a program.
    #[allow(dead_code, reason = "each test file uses the part that it needs")]
    pub(crate) fn program(&self) -> Program {
        let functions = Arc::clone(&self.functions);
        dense(&self.bounds, &self.rows, move |x| functions(x))
    }
}

const INF: f64 = f64::INFINITY;
/// A variable or a row that is not negative.
const POSITIVE: (f64, f64) = (0.0, INF);
/// A row that is 0.
const ZERO: (f64, f64) = (0.0, 0.0);

fn problem<const N: usize>(
    number: u32,
    optimum: f64,
    (start, bounds): ([f64; N], [(f64, f64); N]),
    rows: &[(f64, f64)],
    functions: impl Fn([Jet; N]) -> Vec<Jet> + Send + Sync + 'static,
) -> Problem {
    let functions = move |x: &[Jet]| functions(x.try_into().expect("one jet a variable"));
    Problem {
        number,
        optimum,
        start: start.to_vec(),
        bounds: bounds.to_vec(),
        rows: rows.to_vec(),
        functions: Arc::new(functions),
    }
}

/// Bounds below alone.
fn above<const N: usize>(lower: [f64; N]) -> [(f64, f64); N] {
    lower.map(|lower| (lower, INF))
}

/// Bounds below and above.
fn between<const N: usize>(lower: [f64; N], upper: [f64; N]) -> [(f64, f64); N] {
    std::array::from_fn(|j| (lower[j], upper[j]))
}

/// All problems in the order of their numbers.
pub(crate) fn all() -> Vec<Problem> {
    let parts = [
        n001_025::problems(),
        n026_050::problems(),
        n051_075::problems(),
        n076_099::problems(),
        transcendental::problems(),
        n100_108::problems(),
        n109_119::problems(),
    ];
    let mut all = parts.concat();
    all.sort_by_key(|problem| problem.number);
    all
}

/// The problem of a number.
#[allow(dead_code, reason = "each test file uses the part that it needs")]
pub(crate) fn by_number(number: u32) -> Problem {
    all().into_iter().find(|problem| problem.number == number).unwrap_or_else(|| panic!("no problem {number}"))
}
