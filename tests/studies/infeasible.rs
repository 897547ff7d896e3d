//! Infeasible problems say which constraints cannot hold together, and certain contradictions are
//! found before any iteration.

use ntg::prelude::*;
use ntg::runtime::explain::{Conflict, Explanation, Near};
use ntg::runtime::transcribe::{SetupError, Why};

use crate::support::Shipped;
use std::time::Duration;

/// The conflict behind a problem without solution, with time enough on any machine. The interior-point method alone ends
/// sooner, so that most tests ask for it.
#[track_caller]
fn conflict(problem: &Shipped, method: Method) -> Conflict {
    let settings = Settings { method, time_limit: Some(Duration::from_secs(600)), ..Settings::default() };
    let report = solve(problem.problem(), &settings).unwrap_or_else(|error| panic!("{error}"));
    assert!(!report.is_solved(), "{report}");
    let found = report.explain(problem.problem(), &settings).unwrap_or_else(|error| panic!("{error}"));
    let Some(Explanation::Conflict(found)) = found else { panic!("no conflict: {report}\n{found:?}") };
    assert!(found.minimal, "{found}");
    assert!(found.parts[0].amount > 0.0 && found.violation > 0.0, "{found}");
    assert!(found.parts.iter().all(|part| part.place.line > 0), "{found}");
    found
}

fn names(found: &Conflict) -> Vec<&str> {
    let mut names: Vec<&str> = found.parts.iter().map(|part| part.name.as_str()).collect();
    names.sort_unstable();
    names
}

/// The cosine of a turn has no slope where the turn is 0, so that its first limit seems to contradict itself alone.
#[test]
fn of_two_targets_of_one_quantity_both_are_named() {
    let spec = Shipped::text(
        "problem Turn {
            duration T = 5 [s];
            output turn: spline(order = 4, intervals = 4);
            param first = 0;
            param second = 1;
            minimize integral(der(turn)^2);
            initial { turn == 0;  der(turn) == 0; }
            final { cos(turn) == first;  cos(turn) == second; }
        }",
    );
    let found = conflict(&spec, Method::InteriorPoint);
    assert_eq!(names(&found), ["cos(turn) == first", "cos(turn) == second"], "{found}");
}

/// The fifth derivative on 60 intervals is 60^5 times what the coefficients are, and its square is beyond the digits of the
/// condensed matrix. The problem has a solution, and all points to which the method comes back meet all constraints.
#[test]
fn what_no_method_solves_is_not_called_infeasible_at_a_point_that_meets_everything() {
    let spec = Shipped::text(
        "problem CrackleLimit {
            duration T in 1 .. 1000 [s];
            output x [km]: spline(order = 6, intervals = 60, smoothness = 5);
            collocation gauss(points = 1);
            minimize T;
            initial { x == 0;  der(x) == 0;  der(x, 2) == 0;  der(x, 3) == 0;  der(x, 4) == 0; }
            trajectory { der(x, 5) in -1 .. 1 [m/s^5]; }
            final { x == 1 [km];  der(x) == 0;  der(x, 2) == 0;  der(x, 3) == 0;  der(x, 4) == 0; }
            guess { x = 1 [km] * tau;  T = 60 [s]; }
        }",
    );
    let report = solve(spec.problem(), &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
    assert!(!matches!(report.status, Status::Infeasible { .. }), "{report}");
    // Bang-bang: T = (6144 x / limit)^(1/5).
    assert!(report.violation.points > 1e-6 || report.objective > 6_144_000.0_f64.powf(0.2), "{report}");
}

/// 400 m in 5 s from rest to rest, with at most 4 m/s^2: 25 m is the most. Without the limit on the acceleration the others
/// hold, sixteen of its sizes away.
#[test]
fn a_limit_far_from_where_the_others_would_hold_is_part_of_the_conflict() {
    let spec = Shipped::text(
        "problem Hopeless {
            duration T in 1 .. 5 [s];
            state r [m], v [m/s];
            input a in -4 .. 4 [m/s^2];
            collocation gauss(points = 3, intervals = 10);
            minimize T;
            dynamics { der(r) == v;  der(v) == a; }
            initial { r == 0;  v == 0; }
            final { arrive: r == 400 [m];  v == 0; }
        }",
    );
    let found = conflict(&spec, Method::Auto);
    let named = names(&found);
    for name in ["arrive", "a in -4 .. 4 [m/s^2]"] {
        assert!(named.contains(&name), "{found}");
    }
}

#[test]
fn a_signature_that_the_target_does_not_allow() {
    // At the target the radar stands 37 degrees below the horizon, where even nose-in shows 3.2.
    let found = conflict(&Shipped::spec("low_observable").with("signature_max", &[2.0]), Method::Auto);
    assert_eq!(names(&found), ["arrival", "low_observable"], "{found}");
    assert!(found.settled && found.to_string().starts_with("near the last point"), "{found}");
}

/// 10 m in 2 s with 3 m/s^2 at most: all constraints are linear, and the first attempt's end is the only one. All attempts
/// together took 372 iterations.
#[test]
fn where_all_constraints_are_linear_one_attempt_tells() {
    let report = Shipped::text(
        "problem TooFar {
            duration T = 2 [s];
            state x [m], v [m/s];
            input a in -3 .. 3 [m/s^2];
            collocation gauss(points = 3, intervals = 10);
            minimize integral(a^2);
            dynamics { der(x) == v;  der(v) == a; }
            initial { x == 0;  v == 0; }
            final { x == 10 [m];  v == 0; }
        }",
    )
    .solver()
    .solve()
    .expect("it can be set up");
    assert!(matches!(report.status, Status::Infeasible { .. }) && report.iterations <= 100, "{report}");
}

#[test]
fn the_least_violation_is_the_distance_that_is_missing() {
    // A car that drives at most 2 m/s for 3 s comes 4 m short of 10 m, whatever else holds.
    let short = Shipped::text(
        "problem Short {
            duration T = 3 [s];
            param far = 10 [m];
            output x [m]: spline(order = 4, intervals = 3);
            collocation gauss(points = 4);
            minimize integral(der(x, 2)^2);
            initial { x == 0; }
            trajectory { fast: der(x) <= 2 [m/s]; gentle: -50 [m/s^2] <= der(x, 2) <= 50 [m/s^2]; same: 2 * der(x) <= 90 [m/s]; }
            final { goal: x == far; }
        }",
    );
    let found = conflict(&short, Method::Auto);
    assert_eq!(names(&found), ["fast", "goal", "x == 0"], "{found}");
    let missed: f64 = found.parts.iter().map(|part| part.amount).fold(0.0, f64::max);
    assert!((missed - 4.0).abs() < 1e-4, "{found}");
}

#[test]
fn a_constraint_said_twice_is_named_once_and_others_not_at_all() {
    let edits = [(
        "        low_observable: signature <= signature_max;",
        "        low_observable: signature <= signature_max;
        again: signature <= signature_max;
        weaker: signature <= signature_max + 3;
        high: altitude + 0 * x >= 1 [km];
        wide: -500 [km] <= x <= 500 [km];",
    )];
    let found =
        conflict(&Shipped::edited("low_observable", &edits).with("signature_max", &[2.0]), Method::InteriorPoint);
    let names = names(&found);
    assert!(names == ["again", "arrival"] || names == ["arrival", "low_observable"], "{found}");
}

#[test]
fn a_speed_range_too_slow_for_the_time() {
    // 135 km in 150 s at no more than 0.25 km/s.
    let edits = [("duration T in 100 .. 3000 [s];", "duration T in 100 .. 150 [s];")];
    let found =
        conflict(&Shipped::edited("low_observable", &edits).with("signature_max", &[7.0]), Method::InteriorPoint);
    let names = names(&found);
    for needed in ["speed_limits", "arrival", "the upper bound of the duration of the trajectory"] {
        assert!(names.contains(&needed), "{needed}: {found}");
    }
    assert!(names.iter().any(|name| name.contains("_start")), "{found}");
    assert!(!names.contains(&"turn") && !names.contains(&"low_observable"), "{found}");
}

#[test]
fn durations_that_contradict_their_sum_are_found_before_any_iteration() {
    let phases = "param longest = 150 [s];
        phase covert { duration in 100 .. 1000 [s]; }
        phase exposed after covert { duration in 60 .. 80 [s]; }
        duration T in 100 [s] .. longest;";
    let edits = [("duration T in 100 .. 3000 [s];", phases), ("        T = 900 [s];\n", "")];
    let problem = Shipped::edited("low_observable", &edits);
    let error = solve(problem.problem(), &Settings::default()).expect_err("the phases alone last 160 s");
    let Error::Setup(error) = error else { panic!("{error}") };
    let SetupError::Contradiction { value, bound, why, .. } = &error else { panic!("{error}") };
    assert_eq!((*value, *bound, *why), (160.0, 150.0, Why::Bounds), "{error}");
    assert!(error.to_string().contains("at least 160 s, and its bound is 150 s [E057] (line"), "{error}");
}

#[test]
fn phases_that_contradict_each_other_are_named_with_their_phase() {
    // At no more than 0.25 km/s nobody comes from 40 km away to within 1 km of the target in 60 s.
    let phases = "phase away {
            duration in 100 .. 1000 [s];
            final { still_far: hypot(x - x_target, y - y_target) >= 40 [km]; }
        }
        phase dash after away { duration in 20 .. 60 [s]; }
        duration T in 100 .. 1100 [s];";
    let edits = [
        ("duration T in 100 .. 3000 [s];", phases),
        ("        T = 900 [s];\n", "        duration(away) = 600 [s]; duration(dash) = 50 [s];\n"),
    ];
    let found = conflict(&Shipped::edited("low_observable_cosine", &edits), Method::InteriorPoint);
    let expected =
        ["arrival", "away.still_far", "dash.speed_limits", "the upper bound of the duration of phase `dash`"];
    assert_eq!(names(&found), expected, "{found}");
    let speed = found.parts.iter().find(|part| part.name == "dash.speed_limits").expect("it is named");
    assert_eq!(speed.phase, "dash", "{found}");
}

#[test]
fn a_position_that_a_phase_forbids_is_found_before_any_iteration() {
    let edits = [("        turn: -1", "        east_only: x >= -50 [km];\n        turn: -1")];
    let problem = Shipped::edited("low_observable", &edits);
    let error = solve(problem.problem(), &Settings::default()).expect_err("the flight begins at -100 km");
    assert!(error.to_string().contains("east_only"), "{error}");
}

#[test]
fn a_solved_problem_has_no_conflict_and_one_that_ended_early_none_either() {
    let problem = Shipped::spec("van_der_pol");
    let report = problem.solve();
    assert_eq!(report.explain(problem.problem(), &Settings::default()), Ok(None));

    let problem = Shipped::spec("low_observable").with("signature_max", &[7.0]);
    let early = Settings { max_iterations: 1, ..Settings::default() };
    let report = solve(problem.problem(), &early).unwrap_or_else(|error| panic!("{error}"));
    let found = report.explain(problem.problem(), &Settings::default());
    assert_eq!(found, Ok(Some(Explanation::Consistent(Near::End))), "{report}");
}

#[test]
fn the_cosine_of_a_limit_that_the_target_does_not_allow() {
    let found = conflict(&Shipped::spec("low_observable_cosine").with("signature_max", &[2.0]), Method::Auto);
    assert_eq!((names(&found), found.near), (vec!["arrival", "not_too_near"], Near::End), "{found}");
    assert!(found.settled, "{found}");
    assert!(found.to_string().starts_with("near the last point these cannot hold together"), "{found}");
}

#[test]
fn a_conflict_where_a_solve_was_stopped_is_told_as_such() {
    // The flight has a solution, but two iterations lead to a point around which the limit on the signature, flat
    // there, cannot be met.
    let problem = Shipped::spec("low_observable");
    let early = Settings { max_iterations: 2, method: Method::Sqp, ..Settings::default() };
    let report = solve(problem.problem(), &early).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(report.status, Status::IterationLimit);
    let found = report.explain(problem.problem(), &early).unwrap_or_else(|error| panic!("{error}"));
    let Some(Explanation::Conflict(found)) = found else { panic!("nothing to be careful about: {found:?}") };
    assert!(!found.settled, "{found}");
    assert!(found.to_string().starts_with("the solve was stopped before its end"), "{found}");
}

#[test]
fn the_search_for_reasons_can_be_cancelled() {
    let problem = Shipped::spec("low_observable").with("signature_max", &[2.0]);
    let report = solve(problem.problem(), &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
    let cancel: ntg::runtime::settings::OnIteration = std::sync::Arc::new(|_| Control::Cancel);
    let settings = Settings { on_iteration: Some(cancel), ..Settings::default() };
    assert_eq!(report.explain(problem.problem(), &settings), Ok(Some(Explanation::Unknown)));
}

/// The names of a conflict in its own order.
fn listed(found: &Conflict) -> Vec<&str> {
    found.parts.iter().map(|part| part.name.as_str()).collect()
}

/// A sounding rocket that burns for 10 s with its least thrust of 2 kN: 10 kg of propellant at least.
fn rocket(dry: f64) -> Shipped {
    Shipped::text(&format!(
        "problem Rocket {{
            duration T = 10 [s];
            output h [m]: spline(order = 4, intervals = 6);
            output v [m/s]: spline(order = 4, intervals = 6);
            output m [kg]: spline(order = 4, intervals = 6);
            output F [kN]: spline(order = 3, intervals = 6);
            collocation gauss(points = 3);
            maximize final(h);
            initial {{ h == 0;  v == 0;  m == 50 [kg]; }}
            trajectory {{
                der(h) == v;
                m * der(v) == F - m * 9.81 [m/s^2];
                der(m) == -F / 2000 [m/s];
                throttle: F in 2 .. 4 [kN];
                dry: m >= {dry} [kg];
            }}
            guess {{ h = 100 [m] * tau; v = 100 [m/s] * tau; m = 50 [kg] - 10 [kg] * tau; F = 2 [kN]; }}
        }}"
    ))
}

#[test]
fn a_dry_mass_that_the_least_thrust_does_not_leave_is_named_before_the_equations_of_motion() {
    let found = conflict(&rocket(45.0), Method::InteriorPoint);
    let names = listed(&found);
    assert_eq!(names[..2], ["dry", "throttle"], "{found}");
    assert!(names[2..].contains(&"der(m) == -F / 2000 [m/s]") && names[2..].contains(&"m == 50 [kg]"), "{found}");
    assert!(!names.iter().any(|name| name.contains("der(v)") || name.contains("der(h)")), "{found}");
}

#[test]
fn a_limit_that_contradicts_a_target_stands_beside_it_at_the_top() {
    let problem = Shipped::text(
        "problem Far {
            duration T = 3 [s];
            output x, y [m]: spline(order = 4, intervals = 3);
            output v [m/s]: spline(order = 4, intervals = 3);
            collocation gauss(points = 3);
            minimize integral(der(v)^2);
            initial { x == 0; y == 0; v == 1 [m/s]; }
            trajectory { east: der(x) == v * cos(0.1 * y / 1 [m]); north: der(y) == 0; fast: v in -2 .. 2 [m/s]; }
            final { goal: x * x == 100 [m^2]; }
            guess { x = 10 [m] * tau; v = 3 [m/s]; }
        }",
    );
    let found = conflict(&problem, Method::InteriorPoint);
    let mut top = listed(&found)[..2].to_vec();
    top.sort_unstable();
    assert_eq!(top, ["fast", "goal"], "{found}");
    assert!(listed(&found)[2..].contains(&"east"), "{found}");
}

#[test]
fn two_targets_that_contradict_each_other_are_the_conflict() {
    let problem = Shipped::text(
        "problem Both {
            duration T = 1 [s];
            output x, y [m]: spline(order = 4, intervals = 3);
            minimize integral(der(x, 2)^2 + der(y, 2)^2);
            initial { x == 0; y == 0; der(x) == 1 [m/s]; }
            final { ring: x * x + y * y == 1 [m^2]; line: x + y == 3 [m]; }
        }",
    );
    let found = conflict(&problem, Method::InteriorPoint);
    assert_eq!(names(&found), ["line", "ring"], "{found}");
}

#[test]
fn an_explanation_takes_no_longer_than_the_solve_has_left() {
    let problem = Shipped::spec("low_observable").with("signature_max", &[2.0]);
    let report = solve(problem.problem(), &Settings::default()).unwrap_or_else(|error| panic!("{error}"));
    let spent = Settings { time_limit: Some(Duration::from_nanos(1)), ..Settings::default() };
    assert_eq!(report.explain(problem.problem(), &spent), Ok(Some(Explanation::Unknown)));
}
