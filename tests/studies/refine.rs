//! Refinement brings cost and constraints to the tolerance, or says why it does not.

use ntg::prelude::*;
use ntg::runtime::multistart::multistart;
use ntg::runtime::refine::{RefineStatus, Refined, Refinement};

use crate::support::{Shipped, close};

fn wanted(refinement: Refinement) -> Settings {
    Settings { refine: Some(refinement), ..Settings::default() }
}

#[track_caller]
fn run(problem: &Shipped, settings: &Settings) -> (Report, Refined) {
    let report = solve(problem.problem(), settings).unwrap_or_else(|error| panic!("{error}"));
    let refined = report.refined.clone().unwrap_or_else(|| panic!("not refined: {report}"));
    (report, refined)
}

/// Refines to a tolerance, which must be met, in steps that make the mesh finer.
#[track_caller]
fn to(problem: &Shipped, tolerance: f64) -> (Report, Refined) {
    let (report, refined) = run(problem, &wanted(Refinement::to(tolerance)));
    assert_eq!(refined.status, RefineStatus::Met, "{report}");
    assert!(refined.rounds.windows(2).all(|pair| pair[0].variables < pair[1].variables), "{report}");
    assert!(report.violation.between <= tolerance, "{report}");
    (report, refined)
}

#[test]
fn the_oscillator_reaches_its_limit() {
    // From 1.69393 on two intervals, whatever rule integrates.
    let (report, refined) = to(&Shipped::spec("van_der_pol_gauss"), 1e-9);
    close(report.objective, 1.685_683_273_76, 1e-8);
    assert_eq!(report.iterations, refined.rounds.iter().map(|round| round.iterations).sum::<usize>());
}

/// Every other interval of a buckled rod only just misses the tolerance: what only just meets it is split with these, or each
/// round would split two. Three rounds; twelve without an end where only those were split that miss it.
#[test]
fn what_only_just_meets_the_tolerance_is_split_with_what_misses_it() {
    let spec = Shipped::text(
        "problem Elastica {
            domain s;
            duration L = 1;
            state x, y, th;
            input k;
            collocation gauss(points = 3, intervals = 20);
            minimize integral(k^2) / 2;
            dynamics { der(x) == cos(th);  der(y) == sin(th);  der(th) == k; }
            initial { x == 0;  y == 0;  th == 0; }
            final { x == 0.7;  y == 0;  th == 0; }
        }",
    );
    let (report, refined) = to(&spec, 1e-5);
    assert!(refined.rounds.len() <= 5, "{report}");
}

#[test]
fn equally_spaced_points_are_doubled() {
    let (report, _) = to(&Shipped::spec("van_der_pol"), 1e-5);
    close(report.objective, 1.685_683_273_76, 2e-5);
}

#[test]
fn the_flight_keeps_its_limits_between_the_points() {
    let (report, refined) = to(&Shipped::spec("low_observable_gauss").with("signature_max", &[7.0]), 1e-6);
    let last = &refined.rounds[refined.rounds.len() - 1];
    assert!(last.change < 1e-5 && last.quadrature < 1e-5, "{report}");
}

#[test]
fn phases_and_continuation_are_refined_together() {
    let edits = [
        ("continuation width = (20, 10, 5, 2, 1) [deg];", "continuation width = (20, 10) [deg];"),
        ("collocation uniform(breakpoints = 5 * l + 1);", "collocation gauss(points = 5);"),
    ];
    let (report, refined) = to(&Shipped::edited("low_observable_phases", &edits), 1e-4);
    assert_eq!(report.phases().len(), 2);
    let splits = |round: usize| refined.rounds[round].intervals;
    assert!(splits(refined.rounds.len() - 1) > splits(0), "{report}");
}

/// A gust that no point sees: the equation is missed by more than any other of its terms between the points, which is said
/// relative to these terms, whatever the mesh; refinement to a tolerance ends with the mesh that met it, although a coarse
/// one had a lower objective. Optimum: from 400 intervals, 9206.906.
#[test]
fn a_gust_between_the_points_is_measured_by_the_terms_of_its_equation() {
    let gust = |intervals: usize| {
        Shipped::text(&format!(
            "problem Gust {{
                duration T = 100;
                state x: spline(order = 4, intervals = {intervals}, smoothness = 2);
                input u in -50 .. 50: spline(order = 3, intervals = {intervals}, smoothness = 0);
                collocation gauss(points = 3);
                let gust = 20 * exp(-((t - 51.8) / 0.15)^2);
                minimize integral(u^2);
                dynamics {{ der(x, 2) == u - 9 + gust; }}
                initial {{ x == 0;  der(x) == 0; }}
                final {{ x == 10000;  der(x) == 0; }}
                guess {{ x = 10000 * tau; }}
            }}"
        ))
    };
    for intervals in [40, 80] {
        let report = gust(intervals).solve();
        assert!(report.violation.between > 0.1 && report.violation.points < 1e-6, "{report}");
        let equation = report.warnings().iter().filter(|warning| warning.message.contains("der(x, 2)")).count();
        assert_eq!(equation, 1, "{report}");
        // What it is worth of the objective is known all the same.
        close(report.objective + report.objective_correction, 9206.906, 2e-3);
    }
    let (report, _) = to(&gust(40), 1e-3);
    close(report.objective, 9206.906, 1e-4);
    assert!(report.warnings().is_empty(), "{report}");
}

#[test]
fn agents_are_refined_together() {
    let (report, _) = to(&Shipped::spec("strike_and_look"), 1e-6);
    close(report.objective, 40.500_166_977_2, 1e-8);
}

#[test]
fn limits_end_it_and_it_says_so() {
    let problem = Shipped::spec("van_der_pol_gauss");
    let (report, refined) = run(&problem, &wanted(Refinement { rounds: 2, ..Refinement::to(1e-9) }));
    assert_eq!((refined.status, refined.rounds.len()), (RefineStatus::Rounds, 2), "{report}");
    let (report, refined) = run(&problem, &wanted(Refinement { variables: 10, ..Refinement::to(1e-9) }));
    assert_eq!(refined.status, RefineStatus::Variables, "{report}");
    assert!(report.is_solved() && report.to_string().contains("limit on variables"), "{report}");
    for wrong in [Refinement::to(0.0), Refinement::to(f64::NAN), Refinement { rounds: 0, ..Refinement::to(1e-3) }] {
        let error = solve(problem.problem(), &wanted(wrong)).expect_err("it is out of range");
        assert!(error.to_string().contains("`refine`"), "{error}");
    }
}

#[test]
fn a_problem_that_is_not_solved_is_not_refined() {
    let settings = Settings { max_iterations: 1, ..wanted(Refinement::to(1e-6)) };
    let (report, refined) = run(&Shipped::spec("low_observable_gauss"), &settings);
    assert!(!report.is_solved());
    assert_eq!((refined.status, refined.rounds.len()), (RefineStatus::NotSolved, 1), "{report}");
}

#[test]
fn cancelled_rounds_leave_the_solution_before() {
    // Once the second solve begins, an iteration counts from 0 again.
    let seen = std::sync::Mutex::new(0);
    let cancel: ntg::runtime::settings::OnIteration = std::sync::Arc::new(move |progress| {
        let mut begun = seen.lock().expect("no test panics while it holds this");
        *begun += usize::from(progress.iteration == 0);
        if *begun > 1 { Control::Cancel } else { Control::Continue }
    });
    let settings = Settings { on_iteration: Some(cancel), ..wanted(Refinement::to(1e-9)) };
    let (report, refined) = run(&Shipped::spec("van_der_pol_gauss"), &settings);
    assert!(report.is_solved());
    assert_eq!((refined.status, refined.rounds.len()), (RefineStatus::Cancelled, 2), "{report}");
    close(report.objective, refined.rounds[0].objective, 1e-14);
}

#[test]
fn minima_of_many_starts_are_refined_one_by_one() {
    let problem = Shipped::spec("van_der_pol_gauss");
    let starts = Starts { count: 4, ..Starts::default() };
    let found = multistart(problem.problem(), &starts, &wanted(Refinement::to(1e-9)));
    let found = found.unwrap_or_else(|error| panic!("{error}"));
    assert_eq!((found.solved(), found.minima.len(), found.minima[0].count), (4, 1, 4), "{found}");
    close(found.minima[0].report.objective, 1.685_683_273_76, 1e-8);
}

#[test]
fn an_objective_of_nothing_is_settled_at_once() {
    // What is minimised can be 0, and is so but for the square of what the solver leaves.
    let problem = Shipped::text(
        "problem Follow {
            duration T = 1;
            state x, v;
            input u in -10 .. 10;
            collocation gauss(points = 4, intervals = 4);
            minimize integral((x - t^2 / 2)^2) + 0.001 * integral((u - 1)^2);
            dynamics { der(x) == v;  der(v) == u; }
            initial { x == 0;  v == 0; }
            guess { u = 0.3; }
        }",
    );
    let (report, refined) = to(&problem, 1e-6);
    assert!(report.objective.abs() < 1e-12 && refined.rounds.len() <= 2, "{report}");
}

/// A price at a moment that no point sees: the finer integral does, and says so until the points do. Twelve over the cube of
/// the time, and the price itself, `50 * 0.05 * sqrt(pi)`.
#[test]
fn a_cost_that_the_points_do_not_see_is_warned_of() {
    let priced = |intervals: usize| {
        let spec = Shipped::text(&format!(
            "problem Priced {{
                duration T = 10;
                output x: spline(order = 5, intervals = {intervals});
                minimize integral(der(x, 2)^2 + 50 * exp(-((t - 5.13) / 0.05)^2));
                initial {{ x == 0;  der(x) == 0; }}
                final {{ x == 1;  der(x) == 0; }}
            }}"
        ));
        let report = spec.solve();
        let warned = report.warnings().iter().any(|warning| warning.message.contains("finely integrated"));
        (report.objective_fine, warned)
    };
    assert!(priced(4).1);
    let (fine, warned) = priced(400);
    close(fine, 12.0 / 1000.0 + 50.0 * 0.05 * std::f64::consts::PI.sqrt(), 1e-6);
    assert!(!warned);
}

/// A toll at one place, which the way passes at the same time on every mesh: 200 over a tenth.
#[test]
fn the_best_round_is_one_whose_objective_its_own_integral_bears_out() {
    let problem = Shipped::text(
        "problem Toll {
            duration T = 10;
            state x;
            input u in 0 .. 3;
            collocation gauss(points = 3, intervals = 10);
            minimize integral((u - 1)^2) + integral(if x in 4.95 .. 5.05 { 200 } else { 0 });
            dynamics { der(x) == u; }
            initial { x == 0; }
            final { x == 10; }
        }",
    );
    let coarse = problem.solve();
    // No point is within the toll; what is at least 0 has no finer integral below.
    assert!(coarse.objective.abs() < 1e-9 && coarse.objective_fine >= 0.0, "{coarse}");
    let (report, refined) = run(&problem, &wanted(Refinement::to(1e-4)));
    assert!((report.objective - 20.0).abs() < 1.0, "{report}");
    assert_ne!(refined.status, RefineStatus::Met);
    assert!((report.objective_fine / report.objective - 1.0).abs() < 1e-3, "{report}");
}

/// Four holds of a force from rest to rest over 1 in 1: the least `int u^2` of a double integrator with samples, 12.8. With
/// every finer mesh it was that of a higher rate, down to 12.
#[test]
fn the_rate_of_a_sampled_input_stays() {
    let text = "problem Sampled {
        duration T = 1;
        state x, v;
        input u: held;
        collocation gauss(points = 3, intervals = 4);
        minimize integral(u^2);
        dynamics { der(x) == v;  der(v) == u; }
        initial { x == 0;  v == 0; }
        final { x == 1;  v == 0; }
    }";
    let (report, refined) = to(&Shipped::text(text), 1e-6);
    assert!(refined.is_met(), "{report}");
    assert!((report.objective - 12.8).abs() < 1e-5, "{report}");
}
