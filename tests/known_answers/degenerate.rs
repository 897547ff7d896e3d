//! Problems whose constraints are dependent, contradict each other by the error of the discretisation, or are all but
//! constant at most points.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// The fourth quaternion is an algebraic variable, and its value at the end is redundant up to the error of the
/// collocation: the program on the mesh has an optimum of its own, above that of Betts (2010), section 6.8, 28.6304, and the
/// report says how far constraints are violated between the points. IPOPT finds 28.9136 to 29.0112 from nine starts.
#[test]
fn equalities_that_depend_on_each_other_up_to_the_discretisation_are_met_and_told_of() {
    let spec = Shipped::spec("gallery/reorientation");
    let report = spec.solver().solve().expect("it can be set up");
    assert_eq!(report.status, Status::Solved, "{report}");
    close(report.objective, 28.894165, 1e-6);
    assert!(report.violation.points <= 1e-8 && report.violation.between >= 1e-2, "{report}");
    assert!(report.warnings().iter().any(|warning| warning.to_string().contains("between the points")), "{report}");
    assert!(report.iterations <= 100, "{} iterations", report.iterations);
}

/// A path equality of index 2 beside the motion that keeps it: multipliers that the proximal term alone finds at a linear
/// rate. Optimum: CasADi and IPOPT on this mesh, 5549.687593.
#[test]
fn a_path_equality_of_index_two_is_met_at_the_rate_of_newton() {
    let report = Shipped::spec("gallery/geodesic").solver().solve().expect("it can be set up");
    assert_eq!(report.status, Status::Solved, "{report}");
    close(report.objective, 5549.687593, 1e-9);
    assert!(report.iterations <= 20, "{} iterations", report.iterations);
}

/// A bound whose function saturates: at most points it is 1e-200, which is neither met nor missed.
#[test]
fn a_bound_that_all_but_vanishes_at_most_points_binds_nowhere() {
    let spec = Shipped::text(
        "problem Saturated {
            duration T = 1;
            output x: spline(order = 4, intervals = 4);
            minimize integral(der(x, 2)^2);
            initial { x == 0;  der(x) == 0; }
            trajectory {
                logistic(500 * (1 - x)) * (x - 3) >= -3;
                logistic(500 * (1 - x)) * (2 - x) - logistic(500 * (x - 3)) >= 0;
            }
            final { x == 2;  der(x) == 0; }
        }",
    );
    // Rest to rest over a distance of 2: 12 * 2^2.
    close(spec.solve().objective, 48.0, 1e-8);
}

/// A zone far beside the way, whose function is 1e-170 along it.
#[test]
fn a_zone_that_is_far_away_changes_nothing() {
    let spec = Shipped::text(
        "problem Far {
            duration T in 1 .. 60;
            output x, y: spline(order = 5, intervals = 6, smoothness = 3);
            collocation gauss(points = 3);
            minimize T;
            initial { x == 0;  y == 0; }
            trajectory {
                quiet: exp(-((x - 50)^2 + (y + 200)^2) / 100) <= 0.5;
                der(x)^2 + der(y)^2 <= 400;
            }
            final { x == 100;  y == 0; }
            guess { x = 100 * tau;  T = 20; }
        }",
    );
    let report = spec.solve();
    close(report.objective, 5.0, 1e-8);
    assert!(report.iterations <= 40, "{} iterations", report.iterations);
}

/// A straight line through the middle of a disc is a saddle of the violation, which nothing leaves that keeps the symmetry.
/// Shortest way: two tangents and a third of the half circle, 2 sqrt(3) + pi / 3.
#[test]
fn a_guess_through_the_middle_of_a_disc_leads_round_it() {
    let shortest = 2.0 * 3.0_f64.sqrt() + std::f64::consts::FRAC_PI_3;
    for intervals in [10, 20, 40] {
        let spec = Shipped::text(&format!(
            "problem RoundTheDisc {{
                duration T in 1 .. 20;
                output x, y: spline(order = 4, intervals = {intervals}, smoothness = 2);
                minimize T;
                initial {{ x == -2;  y == 0; }}
                trajectory {{ der(x)^2 + der(y)^2 <= 1;  x^2 + y^2 >= 1; }}
                final {{ x == 2;  y == 0; }}
                guess {{ x = -2 + 4 * tau;  y = 0;  T = 5; }}
            }}"
        ));
        close(spec.solve().objective, shortest, 1e-3);
    }
}

/// A car that moves sideways, with a guess that goes straight there. Optimum: found from three perturbed guesses, by IPOPT
/// from two of them.
#[test]
fn a_car_parks_sideways_from_a_straight_guess() {
    close(Shipped::spec("gallery/unicycle_parking").solve().objective, 9.466_932_5, 1e-6);
}

/// `x == 150 [m] * sin(pi)` has a bound of 1.8e-14 m, which rounding alone misses by a third.
#[test]
fn a_bound_that_is_what_rounding_left_of_0_is_0() {
    let report = Shipped::spec("gallery/formation_4").solve();
    close(report.objective, 0.001_164_772_794, 1e-6);
    let words: Vec<String> = report.warnings().iter().map(ToString::to_string).collect();
    assert_eq!(words, Vec::<String>::new());
    assert!(report.violation.points < 1e-9 && report.violation.between < 1e-9, "{report}");
}

/// A limit on the tilt is cos(90 deg), which is 6e-17: rounding of 0. With it the components of the quaternion had a size
/// of 5e-9, and steps a length of 1e8.
#[test]
fn the_descent_with_six_degrees_of_freedom_is_solved() {
    let solved = Shipped::spec("powered_descent_6dof").solve();
    close(solved.objective, 1.474_034_854, 1e-6);
}

/// `V^2 cos^2 + V^2 sin^2` varies by rounding, 1e-17 of its value. Scaled by that variation its rounding decided every
/// search, and the constraints were never met.
#[test]
fn an_objective_that_is_constant_but_for_rounding_leaves_the_constraints_to_be_met() {
    let report = Shipped::spec("gallery/obstacle_feasible").solve();
    close(report.objective, 4.571_044, 1e-9);
    assert!(report.violation.points < 1e-8, "{report}");
}

/// The filter cuts step after step along strongly curved rows; without the watchdog the transfer takes 603 iterations.
#[test]
fn a_transfer_of_many_revolutions_is_not_crawled_through() {
    let report = Shipped::spec("gallery/many_revolutions").solve();
    close(report.objective, 293.071_095, 1e-6);
    assert!(report.iterations <= 250, "{} iterations", report.iterations);
}

/// The slope of `norm(u)` is not finite at the guess, `u = 0`. From rest to rest in `T` at least energy each axis takes
/// `12 d^2 / T^3`; here `d = 1`, `T = 4`. A limit is posed as its square, and there is nothing to tell; in an equation of
/// motion the guess is left for a point beside it.
#[test]
fn a_guess_at_which_a_norm_has_no_slope_is_left() {
    let push = |state: &str, dynamics: &str, limit: &str| {
        Shipped::text(&format!(
            "problem Push {{
                duration T = 4;
                state r[2], v[2]{state};
                input u[2];
                collocation gauss(points = 3, intervals = 20);
                minimize integral(dot(u, u));
                dynamics {{ der(r) == v;  der(v) == u;  {dynamics} }}
                initial {{ r == 0;  v == 0; }}
                {limit}
                final {{ r == (1, 1);  v == 0; }}
            }}"
        ))
        .solve()
    };
    for (report, told) in [
        (push("", "", "trajectory { norm(u) <= 1; }"), 0),
        (push(", m", "der(m) == -norm(u);", "final { m == 0; }"), 0),
    ] {
        close(report.objective, 0.375, 1e-9);
        assert_eq!(report.singular.len(), told, "{:?}", report.singular);
    }
}

/// The first attempt ends acceptable; a further one solves it.
#[test]
fn terrain_after_an_acceptable_end() {
    let report = Shipped::spec("gallery/terrain_linear").solve();
    assert_eq!(report.status, Status::Solved);
    close(report.objective, 409.179_599, 1e-6);
}

/// The first attempt runs to its limit; one with shifts of the diagonal finds the best known optimum.
#[test]
fn an_alpine_rider_with_shifts() {
    let report = Shipped::spec("gallery/alpine_rider").solve();
    close(report.objective, 2_059.895, 1e-5);
}

/// The first attempt runs to its limit; the augmented Lagrangian finds the published optimum.
#[test]
fn a_low_thrust_spiral_by_the_augmented_lagrangian() {
    let report = Shipped::spec("gallery/low_thrust_spiral").solve();
    close(report.objective, 45.721_763_9, 1e-7);
}

/// Without a guess the input has the size of its bound, 1, and the objective its variation there. Where consumption is 1e4
/// times as large, any point is stationary by these. Optimum: IPOPT on this mesh, from five starts.
#[test]
fn an_input_of_ten_thousand_times_its_bound_is_measured_by_its_own_size() {
    let spec = |unit: f64| {
        Shipped::text(&format!(
            "problem Ramsey {{
                duration T = 60;
                state k in {low} ..;
                input c in {low} ..;
                collocation gauss(points = 3, intervals = 30);
                minimize integral(exp(-0.03 * t) / c) * 1e4;
                dynamics {{ der(k) == 1500 * {unit}^0.7 * k^0.3 - 0.06 * k - c; }}
                initial {{ k == 20000 * {unit}; }}
                final {{ k >= 20000 * {unit}; }}
            }}",
            low = unit,
        ))
    };
    for unit in [1.0, 1e-3, 1e3] {
        let report = spec(unit).solve();
        close(report.objective, 7.601260400 / unit, 1e-8);
    }
}

/// The guess says nothing about the sizes of two of the states, and the equations at the guess say 1e-10, for an exponential
/// has not yet begun to act there: they grow to 3.
#[test]
fn states_that_outgrow_the_sizes_at_the_guess_are_found() {
    let report = Shipped::spec("gallery/park_ramirez").solve();
    // One of several local minima; the best one known is 32.13168.
    assert!(report.objective > 30.7 && report.objective < 32.2, "{report}");
    assert!(report.iterations <= 500, "{} iterations", report.iterations);
}

/// A spin that is to be turned over, from a guess without inputs: steps converge at a linear rate to where the violations
/// are least nearby, for a thousand iterations if they are let. The least time at a bounded rate `Omega` is `pi / Omega`.
#[test]
fn a_spin_is_turned_over_though_the_guess_leads_to_a_least_violation() {
    let spec = Shipped::text(
        "problem Spin {
            domain t [ns];
            duration T in 1 .. 1000 [ns];
            state r[3];
            input u[2] [1/ns];
            collocation gauss(points = 3, intervals = 30);
            param Omega = 0.1 [1/ns];
            minimize T;
            dynamics {
                der(r[1]) == u[2] * r[3];  der(r[2]) == -u[1] * r[3];  der(r[3]) == u[1] * r[2] - u[2] * r[1];
            }
            initial { r == (0, 0, 1); }
            trajectory { norm(u)^2 <= Omega^2; }
            final { r == (0, 0, -1); }
        }",
    );
    let report = spec.solve();
    close(report.objective, 1e-8 * std::f64::consts::PI, 1e-6);
    assert!(report.iterations <= 500, "{} iterations", report.iterations);
}

/// At the guess, 0 throughout, the row has no slope, and no linear model of it has a solution: sequential quadratic
/// programming begins once more, beside the guess. The least `int x'^2` with `int x^2 = 1` between zeros is `pi^2`.
#[test]
fn a_row_without_a_slope_at_the_guess_does_not_end_sequential_quadratic_programming() {
    let spec = Shipped::text(
        "problem Eigenvalue {
            duration T = 1;
            state x;
            input u;
            collocation gauss(points = 3, intervals = 10);
            minimize integral(u^2);
            dynamics { der(x) == u; }
            initial { x == 0; }
            temporal { integral(x^2) == 1; }
            final { x == 0; }
        }",
    );
    let report = spec.by(Method::Sqp).solve();
    close(report.objective, std::f64::consts::PI.powi(2), 1e-6);
    assert!(report.iterations <= 50, "{} iterations", report.iterations);
}

/// All `a >= 1`, `b = a + 3` are optima. In the middle of them the barrier is at infinity, where a difference of 1e13s has
/// no digits left: -2.825 was called solved.
#[test]
fn an_unbounded_set_of_optima_does_not_cost_the_digits_of_the_objective() {
    for first in [1.0, 1e-3, 1e3] {
        let report = Shipped::text(&format!(
            "problem Valley {{
                duration T = 1;
                variable a, b;
                state x;
                input u in 0 .. 1;
                collocation gauss(points = 3, intervals = 10);
                minimize a - b;
                dynamics {{ der(x) == u; }}
                initial {{ x == 0; }}
                final {{ a >= {first};  b <= 3 + a; }}
            }}"
        ))
        .solve();
        close(report.objective, -3.0, 1e-6);
    }
}

/// 1300 products of multipliers and distances of 1e-6 each are a thousandth of the objective.
#[test]
fn many_small_products_of_multipliers_and_distances_are_not_small_together() {
    for price in ["1", "1e5", "1e6", "1e-6"] {
        let report = Shipped::text(&format!(
            "problem Contact {{
                duration T = 10;
                output x: spline(order = 5, intervals = 320, smoothness = 2);
                minimize {price} * integral(3 * x + 0.5 * der(x, 2)^2);
                initial {{ x == 1;  der(x) == -2; }}
                trajectory {{ x >= 0; }}
                final {{ x == 0;  der(x) == 0; }}
            }}"
        ))
        .solve();
        close(report.objective / price.parse::<f64>().expect("a number"), 2.866039558, 1e-6);
    }
}

/// 31 points hold an equation of a state of 14 coefficients. With 40 intervals there are enough.
#[test]
fn more_equations_than_unknowns_are_told_where_they_cannot_be_met() {
    let report = |intervals: usize| {
        let text = format!(
            "problem Oscillator {{
                duration T = 6;
                collocation uniform(breakpoints = 31);
                state x, v: spline(order = 5, intervals = {intervals});
                input u: spline(order = 2, intervals = {intervals});
                minimize integral(u^2);
                dynamics {{ der(x) == v;  der(v) == u - x; }}
                initial {{ x == 1;  v == 0; }}
                final {{ x == 0;  v == 1; }}
            }}"
        );
        Shipped::text(&text).solver().solve().expect("it can be set up")
    };
    let few = report(10);
    assert!(matches!(few.status, Status::Infeasible { .. }), "{few}");
    // 2 * 31 equations of motion and 4 ends; 2 * 14 + 11 coefficients.
    assert!(few.to_string().contains("the points pose 66 equations for 39 unknowns"), "{few}");
    let enough = report(40);
    assert_eq!(enough.status, Status::Solved, "{enough}");
    assert!(!enough.to_string().contains("unknowns"), "{enough}");
}

/// A column of the matrix without an entry would make it singular, and every step that of a convexified one.
#[test]
fn a_variable_that_nothing_depends_on_changes_nothing() {
    for (name, head) in [
        ("goddard", "problem Goddard {"),
        ("hanging_chain", "problem HangingChain {"),
        ("low_thrust_spiral", "problem LowThrustSpiral {"),
    ] {
        let name = format!("gallery/{name}");
        let without = Shipped::spec(&name).solve();
        let with = Shipped::edited(&name, &[(head, &format!("{head} variable nothing[2];"))]).solve();
        close(with.objective, without.objective, 1e-12);
        assert_eq!(with.iterations, without.iterations, "{name}");
    }
}

/// Least squares of 0 with room in everything else: all multipliers are 0, and the centre of the barrier is at infinity.
#[test]
fn a_least_value_of_0_is_found_beside_variables_that_nothing_holds() {
    for points in [2, 3, 4] {
        for intervals in [10, 15, 20, 22, 24, 30] {
            for at in ["", ", inequalities = points"] {
                let report = Shipped::text(&format!(
                    "problem Room {{
                        duration T = 3;  state x, d;  input u, s;
                        collocation gauss(points = {points}, intervals = {intervals}{at});
                        minimize integral(u^2);
                        dynamics {{ der(x) == u;  der(d) == s; }}
                        initial {{ x == 0;  d == 0; }}
                        trajectory {{ s >= u;  s >= -u; }}
                        final {{ x == 0;  d >= 6; }}
                    }}"
                ))
                .solve();
                assert!(report.objective.abs() < 1e-12, "{report}");
                assert!(report.iterations <= 40, "{points} {intervals}{at}: {} iterations", report.iterations);
            }
        }
    }
}

/// From rest to rest with the least jerk, 720 w^2 / T^5: in whatever order the ends are written, and however short the time is.
#[test]
fn the_order_of_conditions_at_an_end_does_not_matter() {
    let conditions = ["der(x) == 0;", "der(x, 2) == 0;", "x == 1.613 [m];"];
    for [a, b, c] in [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]] {
        for (clock, time, order) in [("us", 0.7996, 6), ("us", 0.33, 7), ("ns", 1.1, 6), ("s", 0.7996, 6)] {
            let report = Shipped::text(&format!(
                "problem Rest {{
                    duration T = {time} [{clock}];
                    output x [m]: spline(order = {order}, intervals = 1);
                    minimize integral(der(x, 3)^2) / 1 [m^2/{clock}^5];
                    initial {{ x == 0;  der(x) == 0;  der(x, 2) == 0; }}
                    final {{ {} {} {} }}
                }}",
                conditions[a], conditions[b], conditions[c]
            ))
            .solve();
            assert!(report.is_solved(), "{a}, {b}, {c}, {time} {clock}: {report}");
            close(report.objective, 720.0 * 1.613 * 1.613 / f64::powi(time, 5), 1e-6);
        }
    }
}
