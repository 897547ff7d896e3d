//! Inflections and plateaus: an input that nothing feels where the guess is moves something further away.

use crate::support::{Shipped, close};

/// A vehicle of laws of thrust that have no slope at rest, in any units, farthest from where it stands.
fn farthest(law: &str, (metre, second): (f64, f64), (points, intervals): (usize, usize), end: &str) -> f64 {
    let text = format!(
        "problem Vehicle {{
            duration T = {} [s];
            const A = {} [m/s^2];
            state x [m], v [m/s];
            input n in -1 .. 1;
            maximize final(x) / {metre} [m];
            dynamics {{ der(x) == v;  der(v) == A * ({law}); }}
            initial {{ x == 0; v == 0; }}
            final {{ {end} }}
            collocation gauss(points = {points}, intervals = {intervals});
        }}",
        2.0 * second,
        metre / (second * second),
    );
    Shipped::text(&text).solve().objective
}

/// `A T^2 / 2` under full thrust, of the largest value of the law.
#[test]
fn a_thrust_without_slope_at_rest_is_used() {
    for units in [(1.0, 1.0), (1e-3, 1e3), (1e3, 60.0), (1e5, 0.1)] {
        for mesh in [(2, 6), (3, 20)] {
            for (law, most) in
                [("n * abs(n)", 1.0), ("n^3", 1.0), ("tan(n)^3", 1_f64.tan().powi(3)), ("n^5 + n^3", 2.0)]
            {
                close(farthest(law, units, mesh, ""), 2.0 * most, 1e-6);
            }
        }
    }
}

/// `A T^2 / 4`: half of the time forwards, half of it back. The end that is given binds all inputs together.
#[test]
fn a_thrust_without_slope_turns_where_it_has_to() {
    for units in [(1.0, 1.0), (1e-3, 1e3), (1e3, 60.0)] {
        for mesh in [(2, 6), (2, 30), (4, 10)] {
            for law in ["n * abs(n)", "n^3"] {
                close(farthest(law, units, mesh, "v == 0;"), 1.0, 1e-6);
            }
        }
    }
}

/// A stroke of a valve that does nothing below a tenth of it. The guess is 0, in the middle of what does nothing.
#[test]
fn a_dead_band_is_passed() {
    for metre in [1.0, 1e-3, 1e4] {
        let text = format!(
            "problem Tank {{
                duration T = 2 [s];
                state level [m];
                input stroke in -1 .. 1;
                maximize final(level) / {metre} [m];
                dynamics {{ der(level) == {metre} [m/s] * (if stroke <= -0.1 {{ stroke + 0.1 }} else {{
                    if stroke <= 0.1 {{ 0 }} else {{ stroke - 0.1 }} }}); }}
                initial {{ level == 0; }}
                collocation gauss(points = 2, intervals = 10);
            }}"
        );
        close(Shipped::text(&text).solve().objective, 1.8, 1e-6);
    }
}

/// What a solution does not feel, and has no reason to, stays as it is: a heading at rest, an input that costs its square alone.
#[test]
fn what_nothing_depends_on_costs_nothing() {
    let text = "problem Rest {
        duration T = 2;
        state x, y;  input speed in 0 .. 1, psi, idle;
        minimize integral(speed + idle^2);
        dynamics { der(x) == speed * cos(psi);  der(y) == speed * sin(psi); }
        initial { x == 0; y == 0; }
        collocation gauss(points = 2, intervals = 10);
    }";
    let report = Shipped::text(text).solve();
    assert!(report.objective.abs() < 1e-6 && report.iterations < 60, "{report}");
}
