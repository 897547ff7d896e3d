//! Objectives that are functions of integrals: mean values, epigraphs, powers. Said in several ways they have one optimum,
//! and take about as many iterations.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// A harvest in a season that repeats: optimum and iterations.
fn harvested(duration: &str, objective: &str) -> (f64, usize) {
    let spec = Shipped::text(&format!(
        "problem Harvest {{
            param year = 6.283185307179586;
            duration T {duration};
            state x in 0.05 .. 2;
            input u in 0 .. 1.2;
            collocation gauss(points = 3, intervals = 24);
            periodic x;
            dynamics {{ der(x) == x * (1 - x) * (1 + 0.5 * sin(2 * pi * tau)) - u * x; }}
            guess {{ x = 0.5;  u = 0.5; }}
            {objective}
        }}"
    ));
    let report = spec.solver().solve().expect("it can be set up");
    assert_eq!(report.status, Status::Solved, "{objective}: {report}");
    (report.objective, report.iterations)
}

/// Optimum: CasADi and IPOPT on this mesh, 0.2369532580.
#[test]
fn a_mean_value_may_be_divided_by_a_number_or_by_a_duration() {
    for by in ["year", "T"] {
        let mean = format!("maximize integral(u * x) / {by} - 0.05 * integral(u^2) / {by};");
        let (objective, iterations) = harvested("= year", &mean);
        close(objective, 0.236953258, 1e-8);
        assert!(iterations <= 20, "/ {by}: {iterations} iterations");
    }
    let (objective, iterations) = harvested("in 3 .. 9", "maximize integral(u * x - 0.05 * u^2) / T;");
    close(objective, 0.2373355689, 1e-8);
    assert!(iterations <= 20, "{iterations} iterations");
}

/// Integrals that are variables have no curvature of their own: where two of them stand in one power, that of the objective
/// is of rank one.
#[test]
fn a_power_of_integrals_has_the_optimum_of_its_base() {
    let base = "integral(u * x) / year - 0.05 * integral(u^2) / year";
    for exponent in [0.99_f64, 1.01] {
        let (objective, iterations) = harvested("= year", &format!("maximize ({base})^{exponent};"));
        close(objective, 0.236953258_f64.powf(exponent), 1e-8);
        assert!(iterations <= 25, "^{exponent}: {iterations} iterations");
    }
}

/// A bound above everything that is to be small takes the place of what is minimised.
#[test]
fn an_epigraph_of_integrals_has_the_optimum_of_what_is_below_it() {
    let direct = harvested("in 3 .. 9", "minimize T + integral((x - 0.4)^2 + u^2);");
    let epigraph = harvested("in 3 .. 9", "variable J; minimize J; temporal { J >= T + integral((x - 0.4)^2 + u^2); }");
    close(epigraph.0, direct.0, 1e-7);
    assert!(epigraph.1 <= 2 * direct.1 + 10, "{} iterations for {}", epigraph.1, direct.1);
}

#[test]
fn lengths_of_curves_are_held_from_a_straight_input() {
    // Dido's problem: the largest area under a curve of a length. The input has no guess, so that the length has no slope at
    // the start, and a linear objective no curvature. An arc of radius r and half angle a: 2 r a = length, 2 r sin a = 1.
    for length in [1.2, 1.4] {
        let angle = (0..60).fold((1e-6, std::f64::consts::PI), |(low, high): (f64, f64), _| {
            let middle = 0.5 * (low + high);
            if middle / middle.sin() < length { (middle, high) } else { (low, middle) }
        });
        let radius = 0.5 / angle.0.sin();
        let area = radius * radius * (angle.0 - angle.0.sin() * angle.0.cos());
        for intervals in [5, 10, 40] {
            let text = format!(
                "problem Dido {{
                    duration T = 1;
                    state x;
                    input u;
                    collocation gauss(points = 3, intervals = {intervals});
                    maximize integral(x);
                    dynamics {{ der(x) == u; }}
                    temporal {{ integral(sqrt(1 + u^2)) == {length}; }}
                    initial {{ x == 0; }}
                    final {{ x == 0; }}
                    guess {{ x = 2 * tau * (1 - tau); }}
                }}"
            );
            let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
            assert!(report.is_solved(), "{text}\n{report}");
            // The arc but for what few intervals miss of it.
            close(report.objective, area, 1e-3);
            assert!(report.iterations < 60, "{length} {intervals}: {}", report.iterations);
        }
    }
}

/// A function of an integral that has no value at 1, in SI, is no reason to have none at the guess: the least effort from rest to
/// rest, 12 d^2 / T^3, is `Iref` in any unit.
#[test]
fn a_function_of_an_integral_may_be_steep_in_si() {
    for (length, time, way, duration) in
        [("m", "s", 3.0, 5.0), ("mm", "s", 3.0, 5.0), ("km", "day", 0.01, 9.0), ("m", "h", 2.0, 1.0)]
    {
        let least = 12.0 * way * way / (duration * duration * duration);
        for (form, known) in
            [("exp(ratio)", 1.0_f64.exp()), ("cosh(ratio)", 1.0_f64.cosh()), ("1e4 * exp(ratio)", 1e4 * 1.0_f64.exp())]
        {
            let report = Shipped::text(&format!(
                "problem Steep {{
                    duration T = {duration} [{time}];  state x [{length}], v [{length}/{time}];  input u [{length}/{time}^2];
                    collocation gauss(points = 3, intervals = 20);
                    param Iref = {least} [{length}^2/{time}^3];
                    let ratio = integral(u^2) / Iref;
                    minimize {form};
                    dynamics {{ der(x) == v;  der(v) == u; }}
                    initial {{ x == 0;  v == 0; }}
                    final {{ x == {way} [{length}];  v == 0; }}
                }}"
            ))
            .solve();
            assert!(report.is_solved(), "{length}, {time}, {form}: {report}");
            close(report.objective, known, 1e-7);
        }
    }
}

/// The mean of what time does is a number, whose slope by a free duration is rounding of 0: what the end misses is measured by the
/// end, not by that. The state moves by 1/2 or 1, at a steady rate: `u = d / T`, cost `d^2 / T + (T - 2)^2`.
#[test]
fn an_end_beside_a_mean_is_measured_by_the_end() {
    for (mean, moved) in [("integral(t) / T^2", 0.5_f64), ("integral(der(t^2)) / T^2", 1.0)] {
        let report = Shipped::text(&format!(
            "problem Mean {{
                duration T in 0.5 .. 3;
                state x; input u;
                collocation gauss(points = 3, intervals = 4);
                dynamics {{ der(x) == u; }}
                minimize integral(u^2) + (T - 2)^2;
                initial {{ x == 1; }}
                final {{ x == 1 + {mean}; }}
            }}"
        ));
        let report = report.solve();
        assert_eq!(report.status, Status::Solved, "{mean}: {report}");
        assert!(report.violation.points < 1e-12 && report.warnings().is_empty(), "{mean}: {report}");
        let best = |t: f64| moved * moved / t + (t - 2.0).powi(2);
        let least = (0..=100_000).map(|k| best(2.0 + 2e-6 * f64::from(k))).fold(f64::INFINITY, f64::min);
        close(report.objective, least, 1e-8);
    }
}
