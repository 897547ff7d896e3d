//! Corners in equations: fuel, batteries with losses, work, wear; and equations whose corners nothing pushes to.
//! Answers are closed forms, the same problems with what stands for the corner written out, and with the corner in what is
//! minimised.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Solves a spec within so many iterations; gives its report.
#[track_caller]
fn solved(text: &str, within: usize) -> Report {
    let report = Shipped::text(text).solver().solve().expect("it can be set up");
    assert_eq!(report.status, Status::Solved, "{text}: {report}");
    assert!(report.iterations <= within, "{text}: {}", report.iterations);
    report
}

/// A cart goes 4 m in 6 s from rest to rest.
fn cart(states: &str, (points, intervals): (usize, usize), rest: &str) -> String {
    format!(
        "problem Cart {{
            duration T = 6; state x, v, {states}; collocation gauss(points = {points}, intervals = {intervals}, inequalities = points);
            {rest}
            initial {{ x == 0; v == 0; }} final {{ x == 4; v == 0; }}
        }}"
    )
}

const MESHES: [(usize, usize); 3] = [(2, 15), (3, 24), (4, 40)];

/// A state whose rate is the corner is the integral of the corner, point for point.
#[test]
fn what_is_counted_by_a_state_is_worth_its_integral() {
    for corner in ["abs(F)", "max(0, F * v)", "max(-0.5 * F, 2 * F)", "if F >= 0 { 2 * F } else { -F }"] {
        for mesh in MESHES {
            let by_state = solved(
                &cart(
                    "E",
                    mesh,
                    &format!(
                        "input F in -1 .. 1; minimize final(E); dynamics {{ der(x) == v; der(v) == F; der(E) == {corner}; }} \
                         initial {{ E == 0; }}"
                    ),
                ),
                60,
            );
            let rest = format!(
                "input F in -1 .. 1; minimize integral({corner}); dynamics {{ der(x) == v; der(v) == F; der(z) == 0; }} \
                 initial {{ z == 0; }}"
            );
            let by_integral = solved(&cart("z", mesh, &rest), 60);
            close(by_state.objective, by_integral.objective, 1e-6);
        }
    }
}

/// The mass that is left, by a thrust in a line and in a plane, with the helper of the compiler and by hand.
#[test]
fn the_fuel_of_a_mass_is_worth_what_its_rows_by_hand_are() {
    for mesh in MESHES {
        let line = |input: &str, rate: &str, rows: &str| {
            let rest = format!(
                "input F in -1 .. 1{input}; maximize final(m);
                 dynamics {{ der(x) == v; der(v) == F / m; der(m) == -0.1 * {rate}; }} trajectory {{ {rows} }} initial {{ m == 1; }}"
            );
            solved(&cart("m", mesh, &rest), 100).objective
        };
        close(line("", "abs(F)", ""), line(", s", "s", "s >= F; s >= -F;"), 1e-6);
        let plane = |input: &str, rate: &str, rows: &str| {
            let rest = format!(
                "state y, w; input F[2] in -1 .. 1{input}; maximize final(m);
                 dynamics {{ der(x) == v; der(v) == F[1] / m; der(y) == w; der(w) == F[2] / m; der(m) == -0.1 * {rate}; }}
                 trajectory {{ {rows} }} initial {{ y == 0; w == 0; m == 1; }} final {{ y == 2; w == 0; }}"
            );
            solved(&cart("m", mesh, &rest), 150).objective
        };
        close(plane("", "norm(F)", ""), plane(", s in 0 .. 2", "s", "s^2 >= F[1]^2 + F[2]^2;"), 1e-6);
    }
}

/// A specific thrust that is a factor of the mass vanishes along coasts as one that is none does; a distance seldom vanishes.
#[test]
fn a_rate_in_proportion_to_the_mass_has_its_helper_too() {
    for mesh in MESHES {
        let left = |input: &str, rows: &str, rate: &str| {
            let rest = format!(
                "state y, w; input a[2]{input}; maximize final(m);
                 dynamics {{ der(x) == v; der(v) == a[1]; der(y) == w; der(w) == a[2]; der(m) == -m * {rate} / 2; }}
                 trajectory {{ {rows} }} initial {{ y == 0; w == 0; m == 1; }} final {{ y == 3; w == 0; }}"
            );
            solved(&cart("m", mesh, &rest), 150).objective
        };
        let by_hand = left(", q in 0 .. 1", "q^2 >= dot(a, a);", "q");
        close(left("", "norm(a) <= 1;", "norm(a)"), by_hand, 1e-6);
        close(left("", "hypot(a[1], a[2]) <= 1;", "hypot(a[1], a[2])"), by_hand, 1e-6);
    }
}

/// A battery that loses a tenth each way, bought for by a tariff of the day.
fn battery(power: &str, energy: &str, rate: &str, intervals: usize) -> String {
    format!(
        "problem Battery {{
            duration T = 24 [h]; state E [{energy}] in 0 .. 10 [kW*h]; input p [{power}] in -4 .. 4 [kW];
            collocation gauss(points = 3, intervals = {intervals});
            let price = 0.25 + 0.12 * sin(2 * pi * (t - 13 [h]) / 24 [h]); minimize integral(price * p) / 1 [kW*h];
            dynamics {{ der(E) == {rate}; }} initial {{ E == 2 [kW*h]; }} final {{ E == 2 [kW*h]; }}
        }}"
    )
}

/// Units, and how the corner is written, change nothing.
#[test]
fn a_battery_with_losses_is_the_same_in_all_units_and_forms() {
    for intervals in [24, 50] {
        let plain = solved(&battery("kW", "kW*h", "min(0.9 * p, p / 0.9)", intervals), 60);
        for (power, energy) in [("W", "J"), ("MW", "kW*h"), ("mW", "GJ")] {
            let other = solved(&battery(power, energy, "min(0.9 * p, p / 0.9)", intervals), 90);
            close(other.objective, plain.objective, 1e-6);
        }
        const FORMS: [&str; 4] = [
            "if p >= 0 { 0.9 * p } else { p / 0.9 }",
            "0.9 * max(p, 0) + min(p, 0) / 0.9",
            "0.9 * max(p, 0) - max(-p, 0) / 0.9",
            "p - 0.1 * max(p, 0) - (1 / 0.9 - 1) * 0.5 * (abs(p) - p)",
        ];
        for rate in FORMS {
            close(solved(&battery("kW", "kW*h", rate, intervals), 60).objective, plain.objective, 1e-6);
        }
    }
}

/// Where nothing pushes the helper, the equation is posed as it is written: wear that is allowed for anyway , the length of a straight way, and of one that must be longer than straight; a drop that falls to the ground.
#[test]
fn an_equation_whose_corner_nothing_pushes_to_is_met_as_it_is_written() {
    for mesh in MESHES {
        let wear = |rate: &str, most: &str| {
            let rest = format!(
                "input F; minimize integral(F^2); dynamics {{ der(x) == v; der(v) == F; der(d) == {rate}; }} initial {{ d == 0; }} \
                 {most}"
            );
            solved(&cart("d", mesh, &rest), 100).objective
        };
        close(wear("abs(F)", "final { d <= 2.1; }"), wear("0", ""), 1e-6);
        let (points, intervals) = mesh;
        for (more, effort, length) in [("", 6.25, 5.0), ("s == 6;", 9.0, 6.0)] {
            let report = solved(
                &format!(
                    "problem Way {{
                        duration T = 4; state x, y, s; input u[2]; collocation gauss(points = {points}, intervals = {intervals});
                        minimize integral(dot(u, u)); dynamics {{ der(x) == u[1]; der(y) == u[2]; der(s) == norm(u); }}
                        initial {{ x == 0; y == 0; s == 0; }} final {{ x == 3; y == 4; {more} }}
                    }}"
                ),
                100,
            );
            close(report.objective, effort, 1e-6);
            close(report.solution.output("s").expect("it is one").at(4.0), length, 1e-6);
        }
    }
}

/// The least time with a thrust that takes from the mass: a helper would throw mass away. Full thrust to t = 2, then full brakes:
/// T = 3.2, v = -5 log(1 - t / 5) up to there.
#[test]
fn no_helper_throws_mass_away() {
    for (points, intervals) in [(3, 40), (3, 64)] {
        let report = solved(
            &format!(
                "problem Hurry {{
                    duration T in 0.5 .. 20; state x, v, m; input F in -1 .. 1; collocation gauss(points = {points}, intervals = {intervals});
                    minimize T; dynamics {{ der(x) == v; der(v) == F / m; der(m) == -0.2 * abs(F); }}
                    initial {{ x == 0; v == 0; m == 1; }} final {{ x == 4; v == 0; }}
                }}"
            ),
            250,
        );
        close(report.objective, 3.2, 1e-6);
    }
}

/// The worst of two counters: the other one has wear to spare, and nothing pushes its helper.
#[test]
fn a_counter_with_room_is_counted_as_it_is_written() {
    for (points, intervals) in MESHES {
        let of = |cost: &str| {
            let text = format!(
                "problem Worst {{
                    duration T = 6; state x[2], v[2], E[2]; input u[2] in -1 .. 1;
                    collocation gauss(points = {points}, intervals = {intervals}, inequalities = points);
                    minimize {cost};
                    dynamics {{ der(x) == v; der(v) == u; for i in 1 .. 2 {{ der(E[i]) == abs(u[i]); }} }}
                    initial {{ x == 0; v == 0; E == 0; }} final {{ x == (4, 1); v == 0; }}
                }}"
            );
            solved(&text, 250)
        };
        let worst = of("max(final(E[1]), final(E[2]))");
        close(worst.objective, of("integral(abs(u[1]))").objective, 1e-6);
        let second = |report: &Report| report.solution.output("E[2]").expect("it is one").at(6.0);
        assert!(second(&worst) <= worst.objective + 1e-6, "{worst}");
    }
}

/// Work that is to be little and mass that it would be good to lose, by one thrust: one helper, which the work pushes.
#[test]
fn equations_share_the_helper_of_their_corner() {
    for mesh in MESHES {
        let of = |burnt: &str, rows: &str| {
            let rest = format!(
                "state m; input F in -1 .. 1, s in 0 .. 1; minimize final(E);
                 dynamics {{ der(x) == v; der(v) == F / m; der(E) == {burnt}; der(m) == -0.05 * {burnt}; }}
                 trajectory {{ {rows} }} initial {{ E == 0; m == 1; }}"
            );
            solved(&cart("E", mesh, &rest), 60).objective
        };
        close(of("abs(F)", "s == 0;"), of("s", "s >= F; s >= -F;"), 1e-6);
    }
}

/// A budget that is spent exactly, and a variable that is what an integral is.
#[test]
fn equations_of_the_whole_mission_are_as_the_limits_are() {
    for mesh in MESHES {
        let of = |rest: &str| {
            let rest = format!(
                "input F in -1 .. 1; {rest} dynamics {{ der(x) == v; der(v) == F; der(z) == 0; }} initial {{ z == 0; }}"
            );
            solved(&cart("z", mesh, &rest), 60).objective
        };
        let spent = of("minimize integral(F^2); temporal { integral(abs(F)) == 1.8; }");
        close(spent, of("minimize integral(F^2); temporal { integral(abs(F)) <= 1.8; }"), 1e-6);
        let known = of("variable B; minimize B; temporal { B == integral(abs(F)); }");
        close(known, of("minimize integral(abs(F));"), 1e-6);
    }
}

/// A way in a plane whose length is counted, and is more than that of a line.
pub(super) const WAY: &str = "problem Way {
    param l = 6; duration T = 4; state x, y, s; input u[2]; collocation gauss(points = 3, intervals = 10);
    minimize integral(dot(u, u)); dynamics { der(x) == u[1]; der(y) == u[2]; der(s) == norm(u); }
    initial { x == 0; y == 0; s == 0; } final { x == 3; y == 4; s == l; }
}";

/// A solve that stops before the equations are met as they are written has no solution: with a helper beside its corner the way
/// is worth 6.25.
#[test]
fn no_solution_is_told_where_iterations_end_before_the_equations_are_met() {
    let all = solved(WAY, 60).iterations;
    for most in 1..all {
        let mut solver = Shipped::text(WAY).solver();
        solver.settings.max_iterations = most;
        let report = solver.solve().expect("it can be set up");
        assert!(!report.has_solution() || (report.objective - 9.0).abs() < 1e-5, "{most}: {report}");
    }
}

/// More is to be counted than the cheapest way makes, whose corners are at their tips: by Cauchy-Schwarz `|u|` is constant where
/// signs are free. Units of time and of what is counted change nothing.
#[test]
fn more_is_made_than_is_cheapest_by_going_to_both_sides() {
    let line = |rate: &str, ends: &str, (points, intervals): (usize, usize), unit: &str| {
        format!(
            "problem More {{
                duration T = 3 [{unit}]; state x, d; input u [1/{unit}]; collocation gauss(points = {points}, intervals = {intervals});
                minimize integral(u^2) / 1 [1/{unit}]; dynamics {{ der(x) == u; der(d) == {rate}; }}
                initial {{ x == 0; d == 0; }} final {{ {ends} }}
            }}"
        )
    };
    for mesh in MESHES {
        for unit in ["s", "h", "ms"] {
            close(solved(&line("abs(u)", "x == 0; d == 6;", mesh, unit), 100).objective, 12.0, 1e-6);
            close(solved(&line("abs(u)", "x == 0; d >= 6;", mesh, unit), 100).objective, 12.0, 1e-6);
            close(solved(&line("1.5 * abs(u) + 0.5 * u", "x == 0; d == 9;", mesh, unit), 100).objective, 12.0, 1e-6);
        }
        let plane = format!(
            "problem Away {{
                duration T = 3; state d; input u[2]; collocation gauss(points = {}, intervals = {});
                minimize integral(dot(u, u)); dynamics {{ der(d) == norm(u); }} initial {{ d == 0; }} final {{ d == 3; }}
            }}",
            mesh.0, mesh.1
        );
        close(solved(&plane, 100).objective, 3.0, 1e-6);
    }
}

/// A cart that has to go 8 m to be 4 m further: what it costs is the same on all meshes.
#[test]
fn more_is_made_by_turning_round_at_one_cost_on_all_meshes() {
    let cost = |mesh| {
        let rest = "input u; minimize integral(u^2); dynamics { der(x) == v; der(v) == u; der(d) == abs(v); } \
                    initial { d == 0; } final { d == 8; }";
        solved(&cart("d", mesh, rest), 250).objective
    };
    let finest = cost(MESHES[2]);
    MESHES[..2].iter().for_each(|mesh| close(cost(*mesh), finest, 1e-2));
}

/// Corners within corners, and branches that differ by what is solved for, are worth what stands for them by hand: a dead zone, the
/// greatest of some magnitudes, a magnitude of a thrust with a least consumption, a drive with losses both ways, a store whose
/// losses grow as it fills.
#[test]
fn corners_of_corners_and_branches_by_unknowns_are_worth_their_rows_by_hand() {
    for mesh in MESHES {
        let by = |goal: &str, inputs: &str, rate: &str, rows: &str| {
            let rest = format!(
                "input F in -1 .. 1{inputs}; minimize {goal}; dynamics {{ der(x) == v; der(v) == F; der(E) == {rate}; }}
                 trajectory {{ {rows} }} initial {{ E == 0; }}"
            );
            solved(&cart("E", mesh, &rest), 60).objective
        };
        let soft = "final(E) + 0.01 * integral(F^2)";
        let dead = by(soft, "", "max(0, abs(F) - 0.3)", "");
        close(dead, by(soft, ", s in 0 .. 2", "s", "s >= F - 0.3; s >= -F - 0.3;"), 1e-6);
        let least = by(soft, "", "max(0.05, abs(F))", "");
        close(least, by(soft, ", s in 0.05 .. 2", "s", "s >= F; s >= -F;"), 1e-6);
        let drive = by("final(E)", "", "if F >= 0 { F * v / 0.9 } else { 0.6 * F * v }", "");
        close(drive, by("final(E)", "", "max(F * v / 0.9, 0.6 * F * v)", ""), 1e-6);

        let pair = |rate: &str, rows: &str, input: &str| {
            let rest = format!(
                "state y, w; input F[2] in -1 .. 1{input}; minimize final(E) + 0.001 * integral(dot(F, F));
                 dynamics {{ der(x) == v; der(v) == F[1]; der(y) == w; der(w) == F[2]; der(E) == {rate}; }}
                 trajectory {{ {rows} }} initial {{ E == 0; y == 0; w == 0; }} final {{ y == 2; w == 0; }}"
            );
            solved(&cart("E", mesh, &rest), 80).objective
        };
        let rows = "for i in 1 .. 2 { s >= F[i]; s >= -F[i]; }";
        close(pair("max(i in 1 .. 2, abs(F[i]))", "", ""), pair("s", rows, ", s in 0 .. 2"), 1e-6);
        let store = |rate: &str| solved(&battery("kW", "kW*h", rate, 5 * mesh.1), 120).objective;
        let branches = "if p >= 0 { p * (0.95 - 0.01 * E / 1 [kW*h]) } else { p * (1.05 + 0.01 * E / 1 [kW*h]) }";
        close(store(branches), store("min(p * (0.95 - 0.01 * E / 1 [kW*h]), p * (1.05 + 0.01 * E / 1 [kW*h]))"), 1e-6);
    }
}

/// An input that saturates costs what the same input costs within these limits, in all units: neither the form with helpers nor
/// the equation as it is written has a smooth solution, which is at tips of the corners along whole arcs.
#[test]
fn an_input_that_saturates_is_one_with_limits() {
    for (points, intervals) in MESHES {
        let cost = |input: &str, rate: &str, unit: &str| {
            let text = format!(
                "problem Saturated {{
                    duration T = 6 [s]; state x [{unit}], v [{unit}/s], E [m^2/s^3]; input u [{unit}/s^2] {input};
                    collocation gauss(points = {points}, intervals = {intervals}, inequalities = points);
                    minimize final(E); dynamics {{ der(x) == v; der(v) == {rate}; der(E) == u^2; }}
                    initial {{ x == 0 [m]; v == 0 [m/s]; E == 0 [m^2/s^3]; }} final {{ x == 4 [m]; v == 0 [m/s]; }}
                }}"
            );
            solved(&text, 60).objective
        };
        for unit in ["m", "mm", "km"] {
            let limited = cost("in -0.6 .. 0.6 [m/s^2]", "u", unit);
            close(cost("in -3 .. 3 [m/s^2]", "max(-0.6 [m/s^2], min(0.6 [m/s^2], u))", unit), limited, 1e-6);
        }
    }
}

/// A tank that flows over above 2, held near a level above.
const TANK: &str = "problem Tank {
    param goal = 2.5; duration T = 10; state h; input q in 0 .. 1; collocation gauss(points = 3, intervals = 20);
    minimize integral((h - goal)^2 + 0.1 * q^2); dynamics { der(h) == q - max(0, h - 2); } initial { h == 1; }
}";

/// An input that saturates, at its limits along arcs.
const SATURATED: &str = "problem Saturated {
    param most = 0.58; duration T = 6; state x, v, E; input u in -3 .. 3; collocation gauss(points = 3, intervals = 24);
    minimize final(E); dynamics { der(x) == v; der(v) == max(-most, min(most, u)); der(E) == u^2; }
    initial { x == 0; v == 0; E == 0; } final { x == 4; v == 0; }
}";

/// Solutions follow parameters in either form, from the last one and anew, and their derivatives are those of the objective.
#[test]
fn solutions_and_derivatives_follow_parameters_in_both_forms() {
    let battery = battery("kW", "kW*h", "min(r * p, p / r)", 24).replacen("duration", "param r = 0.9; duration", 1);
    let all = [(TANK, "goal", [2.5, 2.51]), (&battery, "r", [0.9, 0.9001]), (SATURATED, "most", [0.58, 0.5801])];
    for (text, name, values) in all {
        let mut solver = Shipped::text(text).solver();
        let mut found = vec![];
        for value in values {
            Shipped::set(&mut solver, name, value);
            let report = solver.solve().expect("it can be set up");
            assert_eq!(report.status, Status::Solved, "{report}");
            let sensitivity = report.sensitivity(&solver.problem).expect("it has one");
            assert!(sensitivity.is_strict() || name != "most", "{name}");
            let slope = sensitivity.objective().values[0];
            found.push((report.objective, slope));
        }
        let [(first, slope_before), (last, slope_after)] = found[..] else { panic!("two solves") };
        close((last - first) / (values[1] - values[0]), 0.5 * (slope_before + slope_after), 1e-2);
        Shipped::set(&mut solver, name, values[0]);
        let back = solver.resolve().expect("it can be set up");
        assert_eq!(back.status, Status::Solved, "{back}");
        close(back.objective, first, 1e-6);
    }
    close(solved(WAY, 60).objective, 9.0, 1e-6);
}
