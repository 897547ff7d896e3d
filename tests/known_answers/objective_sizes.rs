//! Sizes of objectives: what a weight, a measurement or a small optimum says of the others.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// The least velocity over 1 km in 20000 s with a thrust of 20 mm/s^2: two pulses and a coast between them, whose ends are
/// knots.
#[test]
fn an_objective_that_is_small_beside_what_it_may_be_is_exact() {
    let (a, distance) = (0.02_f64, 1000.0_f64);
    for time in [2000.0_f64, 20000.0, 60000.0] {
        let pulse = 0.5 * (time - (time * time - 4.0 * distance / a).sqrt());
        let first = pulse / time;
        let coast: Vec<String> =
            (0..=12).map(|k| format!("{}", first + (1.0 - 2.0 * first) * f64::from(k) / 12.0)).collect();
        let text = format!(
            "problem Transfer {{
                duration T = {time} [s];
                state r[2] [m], v[2] [m/s];
                input a[2] [m/s^2];
                collocation gauss(points = 3, knots = (0, {}, 1), inequalities = points);
                minimize dv [m/s]: integral(norm(a));
                dynamics {{ der(r) == v;  der(v) == a; }}
                trajectory {{ norm(a) <= {a} [m/s^2]; }}
                initial {{ r == 0;  v == 0; }}
                final {{ r == (600.0, 800.0) [m];  v == 0; }}
            }}",
            coast.join(", ")
        );
        let report = Shipped::text(&text).solve();
        close(report.objective, 2.0 * a * pulse, 1e-4);
    }
}

/// A line through 0 with the least effort, its end held by a heavy weight: `w / (1 + 2 w)` in any unit of the objective.
#[test]
fn a_heavy_weight_hides_nothing_of_the_rest_of_the_objective() {
    // By sequential quadratic programming heavier ones end as acceptable.
    for (method, powers) in [(Method::Auto, &[0, 4, 8, 10, 12, 14][..]), (Method::Sqp, &[0, 4, 8, 10][..])] {
        for &power in powers {
            let spec = Shipped::text(&format!(
                "problem Heavy {{ duration T = 1; state x; input u; collocation gauss(points = 2, intervals = 4);
                 dynamics {{ der(x) == u; }} initial {{ x == 0; }}
                 minimize integral(u^2) / 2 + 1e{power} * (final(x) - 1)^2; }}"
            ));
            let report = spec.by(method).solver().solve().expect("it can be set up");
            assert_eq!(report.status, Status::Solved, "1e{power}, {method:?}: {report}");
            let weight = 10.0_f64.powi(power);
            close(report.objective, weight / (1.0 + 2.0 * weight), 1e-6);
        }
    }
}

/// The speed of a walk, by its length to 1 m, by itself to 1 m/s, and by a clock that all but knows the time: the clock
/// decides the time, and halfway between both says the rest.
#[test]
fn a_tight_measurement_leaves_the_others_what_they_say() {
    for sigma in ["1 [s]", "1e-2 [s]", "1e-4 [s]", "1e-6 [s]"] {
        let spec = Shipped::text(&format!(
            "problem Walk {{ duration T in 0.5 .. 9 [s]; state x [m]; variable v [m/s];
             collocation gauss(points = 2, intervals = 1); dynamics {{ der(x) == v; }} initial {{ x == 0; }}
             measure {{ final(x) == 10 [m] sigma 1 [m]; v == 4 [m/s] sigma 1 [m/s]; T == 2 [s] sigma {sigma}; }}
             guess {{ v = 4 [m/s];  T = 2.1 [s]; }} }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "{sigma}: {report}");
        if sigma != "1 [s]" {
            // (2 v - 10)^2 / 2 + (v - 4)^2 / 2 at v = 4.8.
            close(report.objective, 0.4, 1e-2);
        }
        if sigma == "1e-6 [s]" {
            close(report.objective, 0.4, 1e-6);
        }
    }
}

/// A point and its weight in an objective whose other term is 0 at the solution and has any weight.
#[test]
fn a_weight_on_what_ends_at_nothing_hides_no_other_term() {
    for power in [0, 4, 8, 10, 12] {
        let spec = Shipped::text(&format!(
            "problem Beside {{ duration T = 1; variable k in 0 .. 10; output x: spline(order = 4, intervals = 10);
             initial {{ x == 0; }} final {{ x == 1; }}
             minimize (k - 3)^2 + 1e{power} * integral(der(x, 2)^2); guess {{ k = 8; }} }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "1e{power}: {report}");
        close(report.objective + 1.0, 1.0, 1e-6);
    }
}

/// The least time to a place with a limit of speed, and a little weight on jerk, by splines of a high order on many short
/// intervals: slopes by coefficients are then 1e8 times those by the time. Whatever the mesh, the answer is one.
#[test]
fn a_tighter_solve_keeps_the_scale_of_the_one_from_which_it_goes_on() {
    for intervals in [20, 60, 100, 120, 130, 150] {
        let spec = Shipped::text(&format!(
            "problem Axis {{ duration T in 0.5 .. 10; output x: spline(order = 7, intervals = {intervals});
             trajectory {{ der(x) <= 4; }} initial {{ x == 0; der(x) == 0; }} final {{ x == 7; der(x) == 0; }}
             minimize T + 1e-4 * integral(der(x, 3)^2); guess {{ x = 7 * tau; T = 8; }} }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert!(report.is_solved(), "{intervals}: {report}");
        close(report.objective, 2.171, 1e-2);
    }
}

/// What pushes with a soft start, on meshes whose simulation runs off to 1e24: whatever the end, an objective within bounds
/// does not fall without limit.
#[test]
fn an_objective_within_bounds_is_not_unbounded() {
    for intervals in [10, 12, 15, 16, 20, 24] {
        let spec = Shipped::text(&format!(
            "problem Push {{ duration T = 1; state x; input f in 0 .. 5; collocation gauss(points = 3, intervals = {intervals});
             dynamics {{ der(x) == 0.01 * softplus((f - 3) / 0.01); }} initial {{ x == 0; }} final {{ x == 1; }}
             minimize integral(f); }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_ne!(report.status, Status::Unbounded, "{intervals}: {report}");
    }
}

/// A stock that grows by what is left in it, `k0 e^(T - 1)` at best: an end that another scale of the objective refutes was
/// "optimal to 1e-6" with 1e5 times too little.
#[test]
fn what_is_called_a_solution_is_near_the_optimum_over_decades() {
    let mut solutions = 0;
    for (k0, duration, intervals) in [(1e-4, 26.0, 25), (1e-2, 14.0, 14), (1.0, 10.0, 20)] {
        let spec = Shipped::text(&format!(
            "problem Growth {{
                duration T = {duration};
                state k;
                input u in 0 .. 1;
                collocation gauss(points = 3, intervals = {intervals});
                maximize integral((1 - u) * k);
                dynamics {{ der(k) == u * k; }}
                initial {{ k == {k0}; }}
            }}"
        ));
        let report = solve(spec.problem(), &Settings::default()).expect("it can be set up");
        let known = k0 * f64::exp(duration - 1.0);
        assert!(!report.has_solution() || (report.objective / known - 1.0).abs() < 0.05, "{known}\n{report}");
        solutions += usize::from(report.has_solution());
    }
    assert!(solutions > 0, "ten time constants have one");
}
