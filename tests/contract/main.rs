//! Every shipped spec, through both back ends.
//!
//! Generated code and interpreter must agree bit for bit; first and second derivatives must agree
//! with central differences of the values, and with hyper-dual numbers to rounding. Every test goes
//! through the specs on all cores.

mod dual;
mod elements;
mod inputs;
mod specs;

use inputs::Sample;
use ntg::runtime::problem::{Derivatives, Lanes, Parametric, Problem};
use ntg::runtime::splines::Table;
use ntg::runtime::structure::Kernel;
use rayon::prelude::*;

/// Lanes evaluated at once: more than one chunk of the interpreter, and not a multiple of it.
const LANES: usize = 67;

struct Results {
    values: Vec<f64>,
    jacobian: Vec<f64>,
    hessian: Vec<f64>,
    probes: Vec<f64>,
}

fn evaluate(problem: &dyn Problem, number: usize, kernel: &Kernel, sample: &Sample, tables: &[Table]) -> Results {
    let column = |entries: usize| vec![f64::NAN; entries * sample.lanes];
    let mut results = Results {
        values: column(kernel.rows),
        jacobian: column(kernel.jacobian.len()),
        hessian: column(kernel.hessian.len()),
        probes: column(kernel.probes.len()),
    };
    let point = Lanes { lanes: sample.lanes, inputs: &sample.inputs, weights: &sample.weights };
    let out =
        Derivatives { values: &mut results.values, jacobian: &mut results.jacobian, hessian: &mut results.hessian };
    problem.derivatives(number, point, tables, out);
    let mut values = column(kernel.rows);
    problem.values(number, sample.lanes, &sample.inputs, tables, &mut values);
    assert!(same_bits(&values, &results.values), "values alone differ from values beside derivatives");
    problem.probes(number, sample.lanes, &sample.inputs, tables, &mut results.probes);
    results
}

fn same_bits(a: &[f64], b: &[f64]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| a.to_bits() == b.to_bits() || (a.is_nan() && b.is_nan()))
}

#[test]
fn generated_code_and_interpreter_agree_bit_for_bit() {
    specs::all().par_iter().for_each(|spec| {
        let structure = spec.generated.structure();
        assert_eq!(structure, spec.interpreted.structure(), "{}", spec.name);
        for (number, kernel) in structure.kernels.iter().enumerate() {
            let sample = Sample::new(&structure, number, LANES, 1);
            let generated = evaluate(spec.generated.as_ref(), number, kernel, &sample, &spec.tables);
            let interpreted = evaluate(&spec.interpreted, number, kernel, &sample, &spec.tables);
            let what = format!("{}: {}", spec.name, kernel.name);
            assert!(same_bits(&generated.values, &interpreted.values), "values of {what}");
            assert!(same_bits(&generated.jacobian, &interpreted.jacobian), "first derivatives of {what}");
            assert!(same_bits(&generated.hessian, &interpreted.hessian), "second derivatives of {what}");
            assert!(same_bits(&generated.probes, &interpreted.probes), "probes of {what}");
            assert!(kernel.rows == 0 || generated.values.iter().any(|v| v.is_finite()), "{what} is never finite");
        }
    });
}

#[test]
fn generated_code_and_interpreter_have_one_parametric_form() {
    specs::all().par_iter().for_each(|spec| {
        let generated = spec.generated.parametric();
        let interpreted = spec.interpreted.parametric();
        let structure = generated.structure();
        assert_eq!(structure, interpreted.structure(), "{}", spec.name);
        assert!(structure.variables.len() > spec.interpreted.structure().variables.len(), "{}", spec.name);
        for (number, kernel) in structure.kernels.iter().enumerate() {
            let sample = Sample::new(&structure, number, 3, 1);
            let one = evaluate(&*generated, number, kernel, &sample, &spec.tables);
            let other = evaluate(&*interpreted, number, kernel, &sample, &spec.tables);
            let what = format!("{}: {}", spec.name, kernel.name);
            assert!(same_bits(&one.values, &other.values), "values of {what}");
            assert!(same_bits(&one.jacobian, &other.jacobian), "first derivatives of {what}");
            assert!(same_bits(&one.hessian, &other.hessian), "second derivatives of {what}");
        }
    });
}

#[test]
fn derivatives_are_those_of_the_values_by_central_differences() {
    /// Relative step: the cube root of the rounding unit balances truncation and cancellation.
    const STEP: f64 = 6e-6;
    specs::all().par_iter().for_each(|spec| {
        let structure = spec.generated.structure();
        for (number, kernel) in structure.kernels.iter().enumerate() {
            if kernel.jacobian.is_empty() {
                continue; // A kernel that is only shown, or of parameters alone.
            }
            let sample = Sample::new(&structure, number, LANES, 2);
            let at = |s: &Sample| evaluate(spec.generated.as_ref(), number, kernel, s, &spec.tables);
            let middle = at(&sample);
            for slot in 0..kernel.slots {
                let (low, high, steps) = sample.around(slot, STEP);
                let (low, high) = (at(&low), at(&high));
                let (half_low, half_high, half_steps) = sample.around(slot, 0.5 * STEP);
                let (half_low, half_high) = (at(&half_low), at(&half_high));
                // The difference over half the step takes away the error of second order, which is large near a pole.
                let slope = |of: &dyn Fn(&Results) -> f64, lane: usize| {
                    let whole = (of(&high) - of(&low)) / steps[lane];
                    let half = (of(&half_high) - of(&half_low)) / half_steps[lane];
                    (4.0 * half - whole) / 3.0
                };
                for (lane, step) in steps.iter().enumerate() {
                    let mut wanted = vec![0.0; kernel.rows];
                    for (entry, (row, of)) in kernel.jacobian.iter().enumerate() {
                        if *of == slot {
                            wanted[*row] = middle.jacobian[entry * LANES + lane];
                        }
                    }
                    for (row, wanted) in wanted.iter().enumerate() {
                        let found = slope(&|at| at.values[row * LANES + lane], lane);
                        let size = middle.values[row * LANES + lane].abs() / step.abs() * 1e-10;
                        inputs::close(*wanted, found, 1e-5, size * 1e2, || format!("{}: d{row}/d{slot}", spec.name));
                    }
                    let gradient = |r: &Results, of: usize| inputs::weighted(kernel, &r.jacobian, &sample, of, lane);
                    for (entry, (i, j)) in kernel.hessian.iter().enumerate() {
                        if *i != slot {
                            continue;
                        }
                        let found = slope(&|at| gradient(at, *j), lane);
                        let size = gradient(&middle, *j).abs() / step.abs() * 1e-8;
                        let what = || format!("{}: {} d2/d{i} d{j}", spec.name, kernel.name);
                        inputs::close(middle.hessian[entry * LANES + lane], found, 1e-5, size, what);
                    }
                }
            }
        }
    });
}

#[test]
fn derivatives_are_those_of_hyper_dual_numbers() {
    specs::all().par_iter().for_each(|spec| {
        let structure = spec.generated.structure();
        for (number, kernel) in structure.kernels.iter().enumerate() {
            let sample = Sample::new(&structure, number, 5, 3);
            let found = evaluate(spec.generated.as_ref(), number, kernel, &sample, &spec.tables);
            for lane in 0..sample.lanes {
                let body = &spec.program.kernels[number];
                dual::compare(body, kernel, &sample, lane, &spec.tables, &found.jacobian, &found.hessian);
            }
        }
    });
}
