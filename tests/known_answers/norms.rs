//! Limits on the norm of a vector, as a thrust has: a guess of 0, where the norm has no gradient, is no trouble.

use crate::support::{Shipped, close};

/// A point mass from rest to rest over `(3, 4)` in the least time, with an acceleration of at most `limit` in norm: half of
/// the way it is faster and faster.
fn states(limit: &str, intervals: usize) -> String {
    format!(
        "problem Planar {{
            duration T in 0.1 .. 50;
            state p[2], v[2];
            input a[2];
            collocation gauss(points = 3, intervals = {intervals});
            minimize T;
            dynamics {{ der(p) == v;  der(v) == a; }}
            initial {{ p == 0;  v == 0; }}
            final {{ p == (3, 4);  v == 0; }}
            trajectory {{ thrust: {limit};  norm(v) <= 10; }}
        }}"
    )
}

#[test]
fn a_limit_on_a_norm_is_met_without_a_guess() {
    // Odd numbers of intervals cannot switch in the middle. Solved as it stands, the norm takes hundreds of iterations more.
    for intervals in [4, 20, 60] {
        let report = Shipped::text(&states("norm(a) <= 2", intervals)).solve();
        close(report.objective, 10f64.sqrt(), 1e-6);
        assert!(report.iterations <= 150, "{intervals} intervals: {} iterations", report.iterations);
        let thrust = report.constraints.iter().find(|constraint| constraint.name == "thrust").expect("a limit");
        // What is told is the norm, not its square.
        let worst = thrust.points.as_ref().expect("it has rows");
        assert!((worst.value - 2.0).abs() < 1e-6, "{worst:?}");
        // T = 2 sqrt(5 / a), so that dT/da = -T / (2 a).
        close(thrust.sensitivity, -report.objective / 4.0, 1e-4);
    }
}

#[test]
fn a_square_and_a_norm_are_one_limit() {
    for intervals in [6, 20] {
        let norm = Shipped::text(&states("norm(a) <= 2", intervals)).solve();
        let square = Shipped::text(&states("dot(a, a) <= 4", intervals)).solve();
        close(norm.objective, square.objective, 1e-7);
    }
    for form in ["sqrt(a[1]^2 + a[2]^2) <= 2", "hypot(a[1], a[2]) <= 2", "norm(a) / 4 <= 0.5"] {
        let report = Shipped::text(&states(form, 6)).solve();
        close(report.objective, 10f64.sqrt(), 1e-6);
        assert!(report.iterations <= 100, "{form}: {} iterations", report.iterations);
    }
}

#[test]
fn a_flat_output_may_have_such_a_limit() {
    for intervals in [8, 16] {
        let text = format!(
            "problem Flat {{
                duration T in 0.1 .. 50;
                output x, y: spline(order = 4, intervals = {intervals}, smoothness = 2);
                minimize T;
                initial {{ x == 0;  y == 0;  der(x) == 0;  der(y) == 0; }}
                final {{ x == 3;  y == 4;  der(x) == 0;  der(y) == 0; }}
                trajectory {{ norm((der(x, 2), der(y, 2))) <= 1; }}
            }}"
        );
        close(Shipped::text(&text).solve().objective, 20f64.sqrt(), 1e-6);
    }
}

/// A glide slope down to the pad: at the end the cone is its apex, where the norm has no gradient and nothing is left to
/// choose. As a limit and as the square of it, the same.
#[test]
fn a_cone_may_end_at_its_apex() {
    let descent = |slope: &str| {
        let text = format!(
            "problem Descent {{
                duration T = 10 [s];
                state r[3] [m], v[3] [m/s];
                input a[3] [m/s^2];
                collocation gauss(points = 3, intervals = 12);
                minimize integral(dot(a, a)) / 1 [m^2/s^3];
                dynamics {{ der(r) == v;  der(v) == a; }}
                trajectory {{ {slope} }}
                initial {{ r == (10, 8, 6) [m];  v == (-4, 0, 0) [m/s]; }}
                final {{ r == 0;  v == 0; }}
            }}"
        );
        let report = Shipped::text(&text).solve();
        assert!(report.iterations <= 60, "{slope}: {} iterations", report.iterations);
        report.objective
    };
    let known = descent("r[1]^2 >= tan(30 [deg])^2 * dot(r[2 .. 3], r[2 .. 3]);  r[1] >= 0;");
    close(descent("r[1] >= tan(30 [deg]) * norm(r[2 .. 3]);"), known, 1e-6);
    close(descent("norm(r[2 .. 3]) <= r[1] / tan(30 [deg]);"), known, 1e-6);
    close(descent("r[1] - tan(30 [deg]) * hypot(r[2], r[3]) >= 0;"), known, 1e-6);
}
