//! Derivatives of times by parameters, beside differences of solves.

use crate::support::{Shipped, close};

/// The derivative of the mission time by a parameter, and the difference of two solves beside it, in declared units.
#[track_caller]
fn of_time(spec: Shipped, (name, value, change): (&str, f64, f64)) -> (f64, f64) {
    let mut solver = spec.solver();
    let mut time = |value: f64, is_wanted: bool| {
        Shipped::set(&mut solver, name, value);
        let report = solver.solve().unwrap_or_else(|error| panic!("{error}"));
        assert!(report.is_solved(), "{report}");
        let sensitivity = is_wanted.then(|| report.solution.sensitivity_by(&solver.problem, &[name]));
        let derivative = sensitivity.map(|found| {
            let found = found.unwrap_or_else(|error| panic!("{error}"));
            found.of("T").expect("a time").values[0]
        });
        (report.solution.end(), derivative)
    };
    let derivative = time(value, true).1.expect("it was asked for");
    (derivative, (time(value + change, false).0 - time(value - change, false).0) / (2.0 * change))
}

/// Of the points of an arc at its limit few hold the solution, and what an interior-point method leaves of distances and
/// multipliers does not tell which: 6 to 16 % were missed.
#[test]
fn along_an_arc_at_its_limit() {
    for intervals in [8, 10, 20] {
        let text = format!(
            "problem Flat {{
                duration T in 1 .. 60 [s];
                output x, y [m]: spline(order = 5, intervals = {intervals}, smoothness = 3);
                param w = 1 [m^2/s^4];
                param limit = 2 [m/s];
                minimize w * T + integral(der(x, 2)^2 + der(y, 2)^2);
                initial {{ x == 0; y == 0; der(x) == 0.1 [m/s]; der(y) == 0; }}
                trajectory {{ top: hypot(der(x), der(y)) <= limit; }}
                final {{ x == 20 [m]; der(x) == 0.1 [m/s]; y == 2 [m]; }}
                guess {{ x = 20 [m] * tau; y = 2 [m] * tau; T = 20 [s]; }}
            }}"
        );
        for (name, value) in [("w", 1.0), ("limit", 2.0)] {
            let (derivative, difference) = of_time(Shipped::text(&text), (name, value, 1e-3 * value));
            close(derivative, difference, 1e-2);
        }
    }
}

/// The square of a sum over a family has second derivatives, and phases have durations: 42 % were missed.
#[test]
fn where_a_term_is_the_square_of_a_sum_over_phases() {
    let text = "problem Legs {
        const N = 3;
        duration T in 1 .. 60 [s];
        output x [m]: spline(order = 4, intervals = 2);
        phase leg[i in 1 .. N] after leg[i - 1] { duration in 0.1 .. 20 [s]; }
        param d = 20 [m];
        minimize 1e-4 [1/s^2] * T^2 + 1e-3 [s/m^2] * integral(der(x)^2);
        initial { x == 0; }
        final { x == d; }
        guess { x = d * tau; for i in 1 .. N { duration(leg[i]) = 5 [s]; } }
    }";
    // T^3 = 5 d^2, in metres and seconds.
    let (derivative, difference) = of_time(Shipped::text(text), ("d", 20.0, 0.01));
    close(derivative, 2.0 / 3.0 * (5.0_f64 / 20.0).cbrt(), 1e-5);
    close(difference, derivative, 1e-5);
    for (spec, name, value) in
        [("low_observable_alternation", "altitude", 12.0), ("low_observable_lock_loss", "y_target", -60.0)]
    {
        let (derivative, difference) = of_time(Shipped::spec(spec).precisely(), (name, value, 0.01));
        close(derivative, difference, 2e-2);
    }
}
