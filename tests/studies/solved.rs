//! What is called solved is: the conditions of a minimum, checked without the solver's own code.
//!
//! Derivatives are central differences of the program's rows and objective; from the solver come only
//! the point and its multipliers. The test is that of docs/maths.md, section 6.1, with a tolerance
//! that differences can keep.

use ntg::prelude::*;
use ntg::runtime::nlp::Nlp;
use ntg::runtime::transcribe::Transcription;
use rayon::prelude::*;

use crate::support::Shipped;

/// Largest violation, relative to the size of bounds.
const PRIMAL: f64 = 1e-6;
/// Largest component of the Lagrangian's gradient, relative to the largest term in it.
const DUAL: f64 = 1e-5;
/// Largest product of a multiplier and its distance, relative to the objective.
const COMPLEMENTARITY: f64 = 1e-6;

/// Objective and rows at a point.
fn evaluate(nlp: &Transcription, x: &[f64]) -> (f64, Vec<f64>) {
    let (mut work, mut out) = nlp.workspace();
    nlp.values(x, &mut work, &mut out).unwrap_or_else(|error| panic!("{error}"));
    (out.objective, out.rows)
}

/// Asserts that a multiplier's sign fits the bound that is near, and that the value is within bounds.
#[track_caller]
fn bounded(what: &str, value: f64, (lower, upper): (f64, f64), multiplier: f64, (size, cost): (f64, f64)) {
    assert!(value >= lower - PRIMAL * size && value <= upper + PRIMAL * size, "{what}: {lower} {value} {upper}");
    if lower == upper {
        return;
    }
    let distance = if multiplier > 0.0 { value - lower } else { upper - value };
    let product = if multiplier == 0.0 { 0.0 } else { (multiplier * distance).abs() };
    assert!(product <= COMPLEMENTARITY * cost, "{what}: multiplier {multiplier:e}, distance {distance:e}");
}

/// Checks the conditions of a minimum at the end of a solve.
#[track_caller]
fn check(problem: &Shipped, report: &Report) {
    let nlp = Transcription::new(problem.problem()).unwrap_or_else(|error| panic!("{error}"));
    let x = report.solution.coefficients();
    let (cost, rows) = evaluate(&nlp, x);
    let cost = cost.abs().max(1e-3);
    let limits = nlp.limits();
    let multipliers = report.solution.row_multipliers();
    for (i, value) in rows.iter().enumerate() {
        let bounds = (limits.row_lower[i], limits.row_upper[i]);
        let finite = [bounds.0, bounds.1].into_iter().filter(|b| b.is_finite());
        let size = finite.fold(1.0, |most: f64, b| most.max(b.abs()));
        bounded(&nlp.row_name(i), *value, bounds, multipliers[i], (size, cost));
    }
    for (j, value) in x.iter().enumerate() {
        let bounds = (limits.lower[j], limits.upper[j]);
        let multiplier = report.solution.bound_multipliers()[j];
        bounded(&nlp.variable_name(j), *value, bounds, multiplier, (value.abs().max(1.0), cost));
    }
    stationary(&nlp, x, multipliers, report.solution.bound_multipliers());
}

/// Asserts that the Lagrangian does not change with any variable, by central differences.
#[track_caller]
fn stationary(nlp: &Transcription, x: &[f64], multipliers: &[f64], bounds: &[f64]) {
    let largest = x.iter().fold(1.0, |most: f64, x| most.max(x.abs()));
    for j in 0..x.len() {
        let step = 1e-6 * x[j].abs().max(1e-3 * largest);
        let at = |x_j: f64| {
            let mut moved = x.to_vec();
            moved[j] = x_j;
            evaluate(nlp, &moved)
        };
        let ((f_up, up), (f_down, down)) = (at(x[j] + step), at(x[j] - step));
        let slope = |up: f64, down: f64| (up - down) / (2.0 * step);
        let terms = up.iter().zip(&down).zip(multipliers).map(|((up, down), y)| -y * slope(*up, *down));
        let terms: Vec<f64> = terms.chain([slope(f_up, f_down), -bounds[j]]).collect();
        let (sum, size) = terms.iter().fold((0.0, 0.0_f64), |(sum, size), t| (sum + t, size.max(t.abs())));
        // Rounding of a difference counts where all terms are small.
        let rounding =
            1e-12 * (f_up.abs() + up.iter().zip(multipliers).map(|(c, y)| (c * y).abs()).sum::<f64>()) / step;
        assert!(sum.abs() <= DUAL * size + rounding, "{}: {sum:e} of {size:e}", nlp.variable_name(j));
    }
}

#[test]
fn shipped_specs() {
    for name in
        ["van_der_pol", "kinematic_car", "low_observable_gauss", "strike_and_look", "multi_vehicle_simultaneous"]
    {
        let problem = Shipped::spec(name);
        check(&problem, &problem.solve());
    }
}

/// The random coarse routes of the low-observability flight, km, from its start to its target.
fn routes() -> Vec<Vec<[f64; 2]>> {
    let routes = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/specs/data/routes.csv"));
    let routes = routes.expect("the list of routes");
    let rows = routes.lines().filter(|line| line.starts_with(|c: char| c == '-' || c.is_ascii_digit()));
    let points = |line: &str| {
        let numbers: Vec<f64> = line.split(',').filter_map(|cell| cell.trim().parse().ok()).collect();
        let inner = numbers.chunks_exact(2).map(|p| [p[0], p[1]]);
        [[-100.0, -100.0]].into_iter().chain(inner).chain([[5.0, -15.0]]).collect()
    };
    rows.map(points).collect()
}

#[test]
fn every_route_leads_to_the_flight_with_a_limit() {
    let problem = Shipped::spec("low_observable");
    let other: Vec<usize> = (0..)
        .zip(routes())
        .par_bridge()
        .filter(|(_, points)| {
            let guess = Guess::new().route(&["x", "y"], points);
            let report = solve_from(problem.problem(), &guess, &Settings::default());
            let report = report.unwrap_or_else(|error| panic!("{error}"));
            !report.is_solved() || (report.objective / 130.907_227_498 - 1.0).abs() > 1e-6
        })
        .map(|(number, _)| number)
        .collect();
    assert!(other.is_empty(), "not from routes {other:?}");
}

#[test]
fn random_routes_by_every_method() {
    let problem = Shipped::spec("low_observable").with("signature_max", &[7.0]);
    let rows: Vec<(usize, Vec<[f64; 2]>)> = routes().into_iter().enumerate().take(12).collect();
    let is_solved = |(number, points): (usize, Vec<[f64; 2]>)| {
        let method = [Method::Auto, Method::InteriorPoint, Method::Sqp][number % 3];
        let settings = Settings { method, ..Settings::default() };
        let report = solve_from(problem.problem(), &Guess::new().route(&["x", "y"], &points), &settings);
        let report = report.unwrap_or_else(|error| panic!("{error}"));
        if report.is_solved() {
            check(&problem, &report);
        }
        report.is_solved()
    };
    let solved = rows.into_par_iter().filter(|row| is_solved(row.clone())).count();
    assert!(solved >= 8, "{solved} of 12");
}

#[test]
#[should_panic(expected = "coefficient")]
fn a_point_that_is_no_minimum_is_found_out() {
    let problem = Shipped::spec("van_der_pol");
    let report = problem.solve();
    let nlp = Transcription::new(problem.problem()).unwrap_or_else(|error| panic!("{error}"));
    let mut x = report.solution.coefficients().to_vec();
    x[3] += 1e-3;
    stationary(&nlp, &x, report.solution.row_multipliers(), report.solution.bound_multipliers());
}
