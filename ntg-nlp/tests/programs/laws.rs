//! What changes a program without changing its optimum changes neither the optimum nor, by much, the iterations:
//! factors of the objective and of rows, other units, rows that say the same again, another order.

use crate::hs::Problem;
use crate::support::{Jet, dense};
use ntg_nlp::{Options, Outcome, Status, ipm};
use std::sync::Arc;

/// Problems of all kinds: bounds, equalities, inequalities, curved and linear, of 2 to 15 variables.
const PROBLEMS: [u32; 12] = [7, 12, 21, 35, 43, 71, 76, 77, 86, 100, 113, 117];

/// Another program with the same optimum but for a factor.
struct Variant {
    problem: Problem,
    /// Typical sizes of the variables.
    sizes: Vec<f64>,
    /// What multiplies the objective.
    factor: f64,
}

impl Variant {
    fn of(problem: &Problem) -> Self {
        Self { problem: problem.clone(), sizes: vec![1.0; problem.start.len()], factor: 1.0 }
    }

    fn solve(&self) -> Outcome {
        let functions = Arc::clone(&self.problem.functions);
        let mut program = dense(&self.problem.bounds, &self.problem.rows, move |x| functions(x));
        program.limits.scale.clone_from(&self.sizes);
        ipm::solve(&program, &self.problem.start, &Options::default())
    }

    /// The same with functions made of the present ones.
    fn mapped(mut self, map: impl Fn(&dyn Fn(&[Jet]) -> Vec<Jet>, &[Jet]) -> Vec<Jet> + Send + Sync + 'static) -> Self {
        let inner = Arc::clone(&self.problem.functions);
        self.problem.functions = Arc::new(move |x| map(&*inner, x));
        self
    }
}

/// Compares every problem with variants of it; the problems of which a variant breaks the law.
fn holds(name: &str, variants: impl Fn(&Problem) -> Vec<Variant>) {
    let mut broken = Vec::new();
    for number in PROBLEMS {
        let problem = crate::hs::by_number(number);
        let plain = Variant::of(&problem).solve();
        assert_eq!(plain.status, Status::Solved, "{number}");
        let most = 3 * plain.iterations / 2 + 3;
        for (at, variant) in variants(&problem).into_iter().enumerate() {
            let found = variant.solve();
            let objective = found.objective / variant.factor;
            let near = (objective - plain.objective).abs() <= 1e-6 * plain.objective.abs().max(0.1);
            if found.status != Status::Solved || !near || found.iterations > most {
                let (status, iterations) = (&found.status, found.iterations);
                broken.push(format!(
                    "{number} ({at}): {iterations} for {}, {objective:e} for {:e}, {status}",
                    plain.iterations, plain.objective
                ));
            }
        }
    }
    assert!(broken.is_empty(), "{name}:\n{}", broken.join("\n"));
}

#[test]
fn a_factor_of_the_objective() {
    holds("objective", |problem| {
        let variant = |factor: f64| {
            let mut variant = Variant::of(problem).mapped(move |functions, x| {
                let mut values = functions(x);
                values[0] = factor * values[0];
                values
            });
            variant.factor = factor;
            variant
        };
        [1e-8, 1e-4, 1e4, 1e8].map(variant).into_iter().collect()
    });
}

#[test]
fn a_factor_of_any_row() {
    holds("rows", |problem| {
        let variant = |row: usize, factor: f64| {
            let mut variant = Variant::of(problem).mapped(move |functions, x| {
                let mut values = functions(x);
                values[row + 1] = factor * values[row + 1];
                values
            });
            let (lower, upper) = problem.rows[row];
            variant.problem.rows[row] = (lower * factor, upper * factor);
            variant
        };
        (0..problem.rows.len()).flat_map(|row| [1e-6, 1e6].map(|factor| variant(row, factor))).collect()
    });
}

#[test]
fn other_units_of_any_variable() {
    holds("units", |problem| {
        let variant = |variable: usize, unit: f64| {
            let mut variant = Variant::of(problem).mapped(move |functions, x| {
                let mut x = x.to_vec();
                x[variable] = unit * x[variable];
                functions(&x)
            });
            let (lower, upper) = problem.bounds[variable];
            variant.problem.bounds[variable] = (lower / unit, upper / unit);
            variant.problem.start[variable] /= unit;
            variant.sizes[variable] /= unit;
            variant
        };
        (0..problem.start.len()).flat_map(|j| [1e-9, 1e6].map(|unit| variant(j, unit))).collect()
    });
}

#[test]
fn a_row_that_stands_there_twice() {
    holds("twice", |problem| {
        let variant = |row: usize| {
            let mut variant = Variant::of(problem).mapped(move |functions, x| {
                let mut values = functions(x);
                values.push(values[row + 1]);
                values
            });
            variant.problem.rows.push(problem.rows[row]);
            variant
        };
        let equalities = (0..problem.rows.len()).filter(|&row| problem.rows[row].0 == problem.rows[row].1);
        equalities.map(variant).collect()
    });
}

#[test]
fn an_equality_that_others_imply() {
    holds("implied", |problem| {
        let equalities: Vec<usize> =
            (0..problem.rows.len()).filter(|&row| problem.rows[row].0 == problem.rows[row].1).collect();
        if equalities.is_empty() {
            return Vec::new();
        }
        let side: f64 = equalities.iter().map(|&row| 2.0 * problem.rows[row].0).sum();
        let mut variant = Variant::of(problem).mapped(move |functions, x| {
            let mut values = functions(x);
            values.push(equalities.iter().map(|&row| 2.0 * values[row + 1]).sum());
            values
        });
        variant.problem.rows.push((side, side));
        vec![variant]
    });
}

#[test]
fn another_order_of_rows_and_variables() {
    holds("order", |problem| {
        let mut variant = Variant::of(problem).mapped(|functions, x| {
            let x: Vec<Jet> = x.iter().rev().copied().collect();
            let mut values = functions(&x);
            values[1..].reverse();
            values
        });
        variant.problem.start.reverse();
        variant.problem.bounds.reverse();
        variant.problem.rows.reverse();
        vec![variant]
    });
}
