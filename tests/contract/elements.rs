//! The optimisation problem of every spec, assembled from its elements, against a dense oracle of
//! central differences.

use ntg::prelude::{Settings, solve};
use ntg::runtime::nlp::{Assembly, Evaluation, Nlp};
use ntg::runtime::transcribe::Transcription;
use rayon::prelude::*;

use crate::inputs::close;
use crate::specs;

/// Relative step of the differences, as in `main.rs`.
const STEP: f64 = 6e-6;
/// What differences can be trusted to, relative to the largest entry of the column.
const TRUST: f64 = 1e-5;

#[test]
fn gradient_jacobian_and_hessian_assemble_from_the_elements() {
    specs::all().par_iter().for_each(|spec| {
        let nlp = Transcription::new(spec.generated.as_ref()).expect("shipped specs can be set up");
        let x = near_the_solution(spec);
        let multipliers: Vec<f64> = (0..nlp.rows()).map(|i| (1.0 + i as f64).sin()).collect();
        let (mut work, mut at) = nlp.workspace();
        let (mut spare, mut near) = nlp.workspace();
        let mut assembly = Assembly::new(nlp.variables(), nlp.rows(), nlp.blocks());
        let mut first_derivatives = |x: &[f64], assembly: &mut Assembly, at: &mut Evaluation| {
            nlp.derivatives(x, 1.0, &multipliers, &mut work, at).expect("finite near the solution");
            assembly.first(nlp.blocks(), at);
            // The gradient of the Lagrangian, whose derivative is the Hessian.
            let mut slope = assembly.gradient.clone();
            assembly.jacobian.add_transposed_product(1.0, &multipliers, &mut slope);
            slope
        };
        first_derivatives(&x, &mut assembly, &mut at);
        assembly.hessian(nlp.blocks(), &at, |_, _, _| {});
        let middle = (at.clone(), assembly.clone());
        // As many terms make an entry of the Lagrangian's gradient, which is nearly zero too.
        let slope_terms: Vec<f64> = (0..x.len())
            .map(|j| {
                let rows = middle.1.jacobian.column(j).map(|(row, value)| (multipliers[row] * value).abs());
                middle.1.gradient[j].abs() + rows.sum::<f64>()
            })
            .collect();
        // A row that is nearly zero may be the difference of large terms, which are rounded as such.
        let mut terms = vec![0.0; nlp.rows()];
        for (j, x) in x.iter().enumerate() {
            middle.1.jacobian.column(j).for_each(|(row, value)| terms[row] += (value * x).abs());
        }

        for j in 0..nlp.variables() {
            let h = STEP * x[j].abs().max(1.0);
            let shifted = |sign: f64| {
                let mut x = x.clone();
                x[j] += sign * h;
                x
            };
            let (low, high) = (shifted(-1.0), shifted(1.0));
            let slope_low = first_derivatives(&low, &mut assembly, &mut at);
            let values_low = at.clone();
            let slope_high = first_derivatives(&high, &mut assembly, &mut at);
            let step = high[j] - low[j];

            // Signatures are steep: the difference over half the step takes away its error of second order.
            // That makes three times as much of each value's rounding, `3 d / h` instead of `2 d / (2 h)`.
            let mut half = |sign: f64| {
                let mut x = x.clone();
                x[j] += sign * h / 2.0;
                nlp.values(&x, &mut spare, &mut near).expect("finite near the solution");
                near.clone()
            };
            let (half_low, half_high) = (half(-1.0), half(1.0));
            let slope = |low: f64, half_low: f64, half_high: f64, high: f64| {
                (4.0 * (half_high - half_low) / h - (high - low) / step) / 3.0
            };

            let found = slope(values_low.objective, half_low.objective, half_high.objective, at.objective);
            let noise = 3.0 * middle.0.objective.abs() / step * 1e-13;
            close(middle.1.gradient[j], found, TRUST, noise, || format!("{}: gradient {j}", spec.name));

            let mut column = vec![0.0; nlp.rows()];
            middle.1.jacobian.column(j).for_each(|(row, value)| column[row] = value);
            for (row, wanted) in column.iter().enumerate() {
                let rows = [&values_low, &half_low, &half_high, &at].map(|e| e.rows[row]);
                let found = slope(rows[0], rows[1], rows[2], rows[3]);
                let noise = 3.0 * (middle.0.rows[row].abs() * 1e-13 + terms[row] * f64::EPSILON) / step;
                let what = || format!("{}: {} by {}", spec.name, nlp.row_name(row), nlp.variable_name(j));
                close(*wanted, found, TRUST, noise + 1e-9, what);
            }

            let found: Vec<f64> = slope_high.iter().zip(&slope_low).map(|(h, l)| (h - l) / step).collect();
            let largest = found.iter().fold(0.0_f64, |m, v| m.max(v.abs()));
            for (i, found) in found.iter().enumerate().take(j + 1) {
                let wanted = middle.1.hessian.position(i, j).map_or(0.0, |k| middle.1.hessian.value[k]);
                let what = || format!("{}: Hessian {i}, {j}", spec.name);
                // A term is the result of a hundred operations at most.
                let noise = 1e2 * slope_terms[i] * f64::EPSILON / step;
                close(wanted, *found, 1e-4, 1e-4 * largest + noise + 1e-12, what);
            }
        }
    });
}

/// A point at which everything is defined and nothing is special.
fn near_the_solution(spec: &specs::Spec) -> Vec<f64> {
    let report = solve(spec.generated.as_ref(), &Settings::default()).expect("shipped specs can be set up");
    let x = report.solution.coefficients().iter().enumerate();
    x.map(|(i, x)| x * (1.0 + 1e-3 * (3.0 * i as f64).sin())).collect()
}
