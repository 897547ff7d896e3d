//! Poles of the equations of motion: curves that jump over one between two points are no motion, however well the points are met.

use ntg::prelude::*;
use ntg::runtime::report::Resolution;

use crate::support::Shipped;

fn report(problem: &str, (points, intervals): (usize, usize)) -> Report {
    let text = format!("problem Pole {{ collocation gauss(points = {points}, intervals = {intervals}); {problem} }}");
    let settings = Settings { max_iterations: 500, ..Settings::default() };
    solve(Shipped::text(&text).problem(), &settings).expect("it can be set up")
}

/// A substrate that is used up: growth by `S / (K + S)` has a pole at `S = -K`, beyond which it has the other sign.
fn growth(k: f64, rate: f64, duration: f64) -> String {
    format!(
        "duration T = {duration}; state X, S; input u in 0 .. 1;
        dynamics {{ der(X) == {rate} * S / ({k} + S) * X - u * X;  der(S) == -{rate} * S / ({k} + S) * X; }}
        initial {{ X == 0.5;  S == 1; }}
        maximize final(X) + integral(u * X);"
    )
}

fn uptake(k: f64, duration: f64) -> String {
    format!(
        "duration T = {duration}; state S, P; input u in 0 .. 1;
        dynamics {{ der(S) == -u * S / ({k} + S);  der(P) == u * S / ({k} + S) - 0.05 * u; }}
        initial {{ S == 1;  P == 0; }}
        maximize final(P);"
    )
}

#[test]
fn a_substrate_below_its_pole_is_no_solution_on_any_mesh() {
    let mut poles = 0;
    for k in [0.3, 0.05, 0.01] {
        for mesh in [(2, 8), (3, 5), (3, 12), (4, 20), (2, 20)] {
            for problem in [growth(k, 1.0, 10.0), growth(k, 4.0, 20.0), uptake(k, 6.0), uptake(k, 20.0)] {
                let report = report(&problem, mesh);
                let samples = report.solution.output("S").expect("it is an output").sample(400);
                let least = samples.iter().map(|(_, value)| *value).fold(f64::INFINITY, f64::min);
                if report.is_solved() && least < -k {
                    assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{k} on {mesh:?}: {least}\n{report}");
                    poles += usize::from(!report.poles.is_empty());
                }
            }
        }
    }
    assert!(poles >= 10, "{poles} are told by their poles: elsewhere the test says nothing of them");
}

#[test]
fn a_pole_is_told_by_its_divisor_and_its_time() {
    let report = report(&uptake(0.01, 6.0), (3, 8));
    let [pole] = report.poles.as_slice() else { panic!("{:?}\n{report}", report.poles) };
    assert_eq!((pole.place.text.as_str(), pole.place.line), ("-u * S / (0.01 + S)", 2));
    assert!(pole.point.starts_with("t = "), "{pole:?}");
    let told = report.warnings().into_iter().find(|warning| warning.message.contains("is singular in the motion"));
    assert!(told.is_some_and(|warning| warning.message.contains("keep its argument away from that by a bound")));
}

#[test]
fn what_has_a_value_or_an_integral_where_a_divisor_is_0_is_no_pole() {
    let through = |formula: &str| {
        format!(
            "duration T = 2; state x, y; input u in -2 .. 2;
            dynamics {{ der(x) == u;  der(y) == {formula}; }}
            initial {{ x == -1.037;  y == 0; }}
            final {{ x == 1; }}
            minimize integral(u^2);"
        )
    };
    let removable =
        ["sin(x) / x", "(1 - cos(x)) / x^2", "x * (1 / x)", "(exp(x) - 1) / x", "x^2 / x", "(x - sin(x)) / x^3"];
    let others = ["1 / (1 + x^2)", "(x + 3) / (x + 2)", "cos(x) * tan(x)", "if x >= 0.5 { 1 / x } else { 0 }"];
    for formula in removable.into_iter().chain(others) {
        for mesh in [(3, 7), (4, 20)] {
            let report = report(&through(formula), mesh);
            assert!(
                report.poles.is_empty() && report.has_solution(),
                "{formula} on {mesh:?}: {:?}\n{report}",
                report.poles
            );
        }
    }
    // Poles of each order, so weak beside the rest of the motion that nothing else tells of them.
    let poles = [
        "1e-4 / x",
        "1e-6 / x^2",
        "1e-8 / x^3",
        "1e-5 * x^-1",
        "1e-8 * (x - 0.1)^-2",
        "1e-4 * x / (x - 0.2)",
        "1e-4 * tan(x + 1.5707963)",
    ];
    for formula in poles {
        let report = report(&through(&format!("1 + {formula}")), (3, 7));
        assert_eq!(report.poles.len(), 1, "{formula}\n{report}");
        assert_eq!(report.resolution(), Some(Resolution::Unresolved), "{formula}\n{report}");
    }
}

#[test]
fn the_top_of_a_bell_is_no_pole() {
    let of = |width: f64| {
        format!(
            "duration T = 1; state x, v; input u in -50 .. 50; minimize integral(u^2);
            dynamics {{ der(x) == v;  der(v) == u - 100 * exp(-((x - 0.5) / {width})^2); }}
            initial {{ x == 0;  v == 0; }}
            final {{ x == 1;  v == 0; }}"
        )
    };
    for width in [0.02, 0.03] {
        let report = report(&of(width), (3, 5));
        assert!(report.has_solution() && report.poles.is_empty(), "{width}: {:?}\n{report}", report.poles);
        assert!(!report.to_string().contains("singular"), "{report}");
    }
}

#[test]
fn what_is_no_number_is_not_told_as_one() {
    let mut report = report(&uptake(0.3, 6.0), (3, 12));
    assert!(report.is_solved(), "{report}");
    report.objective_correction = f64::NAN;
    let said = report.to_string();
    assert!(!said.contains("NaN"), "{said}");
    assert!(said.contains("how far the objective is off is no number: somewhere they have no value"), "{said}");
}
