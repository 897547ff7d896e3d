//! The low-observability flight: one phase, from both of the paper's coarse routes.

use ntg::prelude::*;

use crate::support::{Shipped, close};

mod grid {
    ntg::ntg_file!("specs/low_observable.ntg");
}

/// The paper's two coarse routes: their way-points, km.
const ROUTES: [(f64, f64); 2] = [(-100.0, -15.0), (0.0, -100.0)];

/// What IPOPT finds for the limit of 4.2 where the limit's edge is 20, 10, 5 and 2 degrees wide (tolerance 1e-8).
const STEPS: [f64; 4] = [134.06846, 131.69749, 131.27243, 131.02446];

#[test]
fn steps_of_a_continuation_are_near_their_optima_and_the_last_one_is_there() {
    let report = Shipped::spec("low_observable").solve();
    assert_eq!(report.history.len(), STEPS.len() + 1);
    for (step, known) in report.history.iter().zip(STEPS) {
        assert!(step.status.is_solved(), "{}", step.status);
        close(step.objective, known, 1e-3);
    }
    close(report.history[STEPS.len()].objective, 130.907_227_498, 1e-9);
    let steps: usize = report.history.iter().map(|step| step.iterations).sum();
    assert_eq!(report.iterations, steps);
}

#[test]
fn the_flight_on_the_papers_grid_from_both_routes() {
    for (x_via, y_via) in ROUTES {
        let on = grid::LowObservable { x_via, y_via, ..Default::default() };
        let solve = |problem: grid::LowObservable| {
            let solution = problem.solve(&Settings::default()).expect("it can be set up");
            assert!(solution.is_solved(), "{}", solution.report());
            solution
        };
        let unlimited = solve(grid::LowObservable { signature_max: 7.0, ..on.clone() });
        close(unlimited.objective(), 128.252_905_291, 1e-6);
        close(unlimited.duration_T(), 638.1103, 1e-6);
        let limited = solve(on.clone());
        close(limited.objective(), 130.907_227_498, 1e-6);
        close(limited.duration_T(), 644.6155, 1e-6);
        let detected = solve(grid::LowObservable { w_detection: 400.0, ..on });
        close(detected.objective(), 135.037_709_597, 1e-6);
    }
}

#[test]
fn the_flight_with_gauss_points_from_both_routes() {
    let flight = || Shipped::spec("low_observable_gauss");
    for (x_via, y_via) in ROUTES {
        let limited = flight().with("x_via", &[x_via]).with("y_via", &[y_via]).solve();
        close(limited.objective, 130.981_63, 1e-5);
        let worst = limited.violation.between;
        assert!(worst < 1e-3, "Gauss points hold between them: {worst:e}");
    }
    close(flight().with("signature_max", &[7.0]).solve().objective, 128.381_655, 1e-5);
    close(flight().with("w_detection", &[400.0]).solve().objective, 135.150_71, 1e-5);
}

#[test]
fn solving_is_deterministic_and_works_from_several_threads() {
    let solve = || {
        let report = solve(&grid::LowObservable::default(), &Settings::default()).expect("it can be set up");
        (report.iterations, report.solution.coefficients().to_vec())
    };
    let alone = solve();
    let threads: Vec<_> = (0..4).map(|_| std::thread::spawn(solve)).collect();
    for thread in threads {
        assert_eq!(thread.join().expect("a solve does not panic"), alone);
    }
}

#[test]
fn an_infeasible_signature_names_the_constraint_and_the_place() {
    let settings = Settings { max_iterations: 300, ..Settings::default() };
    let report = solve(&grid::LowObservable { signature_max: 1.6, ..Default::default() }, &settings).expect("setup");
    assert!(!report.is_solved());
    let words = report.to_string();
    assert!(words.contains("low_observable") && words.contains("t = "), "{words}");
}
