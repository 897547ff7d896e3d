//! Scenarios and other independent variables, against the same problems written by hand.

use ntg::prelude::*;

use crate::support::{Shipped, close};

const HEAD: &str =
    "duration T = 3 [s]; collocation gauss(points = 3, intervals = 6); const S = 4; variable worst in 0 .. 100;";

const PLANT: &str = "initial { x == 1 [m];  der(x) == 0; }  final { x^2 / 1 [m^2] + der(x)^2 / 1 [m^2/s^2] <= worst; }";

fn scenario(shared: &str) -> String {
    format!(
        "problem P {{ {HEAD}
            scenario a[k in 1 .. S] {{
                state x [m];  input u in -1 .. 1 [m/s^2]: continuous;  {shared}
                dynamics {{ der(x, 2) == u - (1 + 0.2 * k) * x * 1 [1/s^2]; }}
                minimize effort: 0.1 * integral(u^2) * 1 [s^3/m^2];
                {PLANT}
                guess {{ x = 1 [m] * (1 - tau); }}
            }}
            minimize worst;
        }}"
    )
}

/// The same by hand: `u` outside or as an array, and what rows tie it by.
fn by_hand(input: &str, u: &str, rows: &str) -> String {
    format!(
        "problem P {{ {HEAD}
            state x[1 .. S] [m];  input {input} in -1 .. 1 [m/s^2]: continuous;
            dynamics {{ for k in 1 .. S {{ der(x[k], 2) == {u} - (1 + 0.2 * k) * x[k] * 1 [1/s^2]; }} }}
            minimize effort: sum(k in 1 .. S, 0.1 * integral({u}^2) * 1 [s^3/m^2] / S);
            {rows}
            initial {{ for k in 1 .. S {{ x[k] == 1 [m];  der(x[k]) == 0; }} }}
            final {{ for k in 1 .. S {{ x[k]^2 / 1 [m^2] + der(x[k])^2 / 1 [m^2/s^2] <= worst; }} }}
            guess {{ for k in 1 .. S {{ x[k] = 1 [m] * (1 - tau); }} }}
            minimize worst;
        }}"
    )
}

#[test]
fn an_input_that_all_members_share_is_in_the_program_once() {
    let (shared, common) = (Shipped::text(&scenario("shared u;")), Shipped::text(&by_hand("u", "u", "")));
    let (shared, common) = (shared.precisely().solve(), common.precisely().solve());
    close(shared.objective, common.objective, 1e-8);
    let size = |report: &Report| (report.solution.coefficients().len(), report.solution.rows());
    assert_eq!(size(&shared), size(&common));
}

#[test]
fn an_input_that_is_shared_up_to_a_time_is_tied_by_rows_up_to_there() {
    let tied = by_hand("u[1 .. S]", "u[k]", "trajectory to 1.5 [s] { for k in 2 .. S { u[k] == u[1]; } }");
    let (shared, tied) = (Shipped::text(&scenario("shared u until 1.5 [s];")), Shipped::text(&tied));
    let (shared, tied) = (shared.precisely().solve(), tied.precisely().solve());
    close(shared.objective, tied.objective, 1e-7);
    let [first, last] = ["a_u[1]", "a_u[4]"].map(|name| shared.solution.output(name).expect("an output"));
    for i in 0..=30 {
        let t = 0.05 * f64::from(i);
        assert!((first.at(t) - last.at(t)).abs() < 1e-14, "at {t}");
    }
    assert!((first.at(2.5) - last.at(2.5)).abs() > 1e-3);
    assert!(shared.solution.coefficients().len() < tied.solution.coefficients().len());
}

#[test]
fn a_tree_has_a_common_trunk_and_branches() {
    // Freely chosen inputs are at least as good as those that are shared longer.
    let worth = |shared: &str| Shipped::text(&scenario(shared)).precisely().solve().objective;
    let (free, half, all) = (worth(""), worth("shared u until 1.5 [s];"), worth("shared u;"));
    assert!(free < half - 1e-6 && half < all - 1e-6, "{free}, {half}, {all}");
}

#[test]
fn equalities_on_what_is_shared_are_rows_once() {
    let text = scenario("shared u;").replace(
        "guess {",
        "initial { u == 0.5 [m/s^2]; } final { held: u == k * 0.1 [m/s^2] - k * 0.1 [m/s^2]; } guess {",
    );
    let report = Shipped::text(&text).precisely().solve();
    close(report.solution.output("a_u[3]").expect("an output").at(0.0), 0.5, 1e-9);
}

#[test]
fn limits_by_parameters_hold_for_each_member_though_they_are_equal_at_first() {
    let text = scenario("shared u;")
        .replace("variable worst", "param most[S] = (1, 1, 1, 1) [m/s^2]; variable worst")
        .replace("guess {", "trajectory { limit: u <= most[k]; } guess {");
    let mut solver = Shipped::text(&text).precisely().solver();
    let before = solver.solve().expect("it can be set up").objective;
    let highest = |report: &Report| {
        let u = report.solution.output("a_u[1]").expect("an output");
        u.sample(100).into_iter().map(|(_, value)| value).fold(f64::NEG_INFINITY, f64::max)
    };
    solver.problem.set("most", &[1.0, 1.0, 0.2, 1.0]).expect("a parameter");
    let after = solver.solve().expect("it can be set up");
    assert!(highest(&after) < 0.2 + 1e-3 && after.objective > before, "{after}");
}

#[test]
fn a_least_way_along_a_length_is_that_in_seconds() {
    let spec = |head: &str, unit: &str| {
        Shipped::text(&format!(
            "problem P {{ {head} duration S = 10 [{unit}]; state v in 1 .. 9 [m/s]; input a in -3 .. 2 [m/s^2];
                collocation gauss(points = 3, intervals = 20);
                minimize time: integral(1 / v) * 1 [m/{unit}];
                dynamics {{ der(v) == a / v * 1 [m/{unit}]; }}
                initial {{ v == 1 [m/s]; }} final {{ v == 1 [m/s]; }} guess {{ v = 3 [m/s]; a = 0; }} }}"
        ))
    };
    let (along, timed) = (spec("domain s [m];", "m").precisely().solve(), spec("", "s").precisely().solve());
    assert_eq!(along.objective.to_bits(), timed.objective.to_bits());
    // Full thrust and full brakes; the switch is where v^2 = 1 + 4 s = 1 + 6 (10 - s).
    let peak = f64::sqrt(1.0 + 24.0);
    close(along.objective, (peak - 1.0) / 2.0 + (peak - 1.0) / 3.0, 2e-3);
    assert!(along.to_string().contains("S           10 m"), "{along}");
    assert!(along.to_string().contains("s = ") || !along.to_string().contains(" at "), "{along}");
}

/// Both optima by CasADi and IPOPT: the lap on 400 intervals with Radau points and linear inputs, which lies a few parts in
/// a million below, the twenty plants on the spec's own mesh.
#[test]
fn the_lap_and_the_twenty_plants_have_the_optima_of_another_transcription() {
    close(Shipped::spec("racing").solve().objective, 28.0446, 1e-5);
    close(Shipped::spec("robust").solve().objective, 0.036_766_960_8, 1e-6);
}

/// Each member of an array, and so of a scenario, begins in the middle of its own bounds.
#[test]
fn what_is_not_guessed_begins_in_the_middle_of_the_members_own_bounds() {
    let begins = |guess: &str| {
        let spec = Shipped::text(&format!(
            "problem P {{
                duration T = 1 [s];
                scenario a[k in 1 .. 3] {{
                    output x [m]: spline(order = 3, intervals = 2);
                    minimize integral(der(x)^2) * 1 [s/m^2];
                    trajectory {{ x in k * 1 [m] .. (k + 2) * 1 [m]; }}
                    {guess}
                }}
            }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        (report.iterations, report.solution.coefficients().to_vec())
    };
    let (own, told) = (begins(""), begins("guess { x = (k + 1) * 1 [m]; }"));
    assert_eq!(own.0, told.0);
    // Constants are optimal: what is begun with stays.
    for (a, b) in own.1.into_iter().zip(told.1) {
        close(a, b, 1e-12);
    }
}

/// Every member has measurements of its own; they tell of what is common to all.
#[test]
fn members_of_a_scenario_are_measured() {
    let measured = |items: &str| {
        let head = "duration T = 2 [s];  collocation gauss(points = 3, intervals = 4);
            variable drag in 0 .. 2 [1/s];  param seen[2] = (1.2, 1.9) [m];  guess { drag = 0.5 [1/s]; }";
        Shipped::text(&format!("problem P {{ {head} {items} }}")).solve()
    };
    let short = measured(
        "scenario run[k in 1 .. 2] {
            state x [m], v [m/s];
            dynamics { der(x) == v;  der(v) == -drag * v; }
            initial { x == 0;  v == k * 1 [m/s]; }
            measure { place: final(x) == seen[k] sigma 0.1 [m]; }
        }",
    );
    let long = measured(
        "state x[1 .. 2] [m], v[1 .. 2] [m/s];
        dynamics { for k in 1 .. 2 { der(x[k]) == v[k];  der(v[k]) == -drag * v[k]; } }
        initial { for k in 1 .. 2 { x[k] == 0;  v[k] == k * 1 [m/s]; } }
        measure { for k in 1 .. 2 { place: final(x[k]) == seen[k] sigma 0.1 [m]; } }",
    );
    let [short_estimate, long_estimate] =
        [&short, &long].map(|report| report.estimate.clone().expect("measurements were made"));
    assert_eq!(short_estimate.count, 2);
    assert_eq!(short_estimate.measurements[0].residuals, long_estimate.measurements[0].residuals);
    assert_eq!(short_estimate.deviations[0].sigma.to_bits(), long_estimate.deviations[0].sigma.to_bits());
    // x(2) = k s with s = (1 - exp(-2 drag)) / drag: the best s is (1.2 + 2 * 1.9) / 5 = 1.
    let drag = short_estimate.deviations[0].variable.value;
    close((1.0 - (-2.0 * drag).exp()) / drag, 1.0, 1e-4);
}

/// With `u = c` throughout, `u^2` and the price `1 - c` weigh alike: `c = 1/2`, a cost of 3/4 for each member by its weight.
#[test]
fn prices_of_soft_constraints_count_by_the_weights_of_the_members() {
    for (weight, expected) in [("weight 0.375", 0.5625), ("weight 0.5 * k", 1.125), ("", 0.75)] {
        let spec = format!(
            "problem P {{
                duration T = 1;
                collocation gauss(points = 3, intervals = 8);
                scenario a[k in 1 .. 2] {weight} {{
                    state x;
                    input u;
                    dynamics {{ der(x) == u; }}
                    minimize integral(u^2);
                    initial {{ x == 0; }}
                    final {{ soft(1): x == 1; }}
                }}
            }}"
        );
        close(Shipped::text(&spec).solve().objective, expected, 1e-6);
    }
}
