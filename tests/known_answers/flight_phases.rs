//! Flights in phases: the paper's section 4 and the alternation of its equation 26.

use ntg::prelude::*;

use crate::support::{Shipped, close, joins_hold};

mod generated {
    ntg::ntg_file!("specs/low_observable_phases.ntg");
}

/// The paper's two coarse routes: their way-points, km.
const ROUTES: [(f64, f64); 2] = [(-100.0, -15.0), (0.0, -100.0)];

/// Highest derivative that is continuous: the splines' smoothness less one.
const JOIN: usize = 2;

fn from_route(spec: &str, (x, y): (f64, f64)) -> Report {
    Shipped::spec(spec).with("x_via", &[x]).with("y_via", &[y]).solve()
}

fn covert_then_exposed(report: &Report) {
    close(report.objective, 128.347_970_733, 1e-6);
    let time = |name: &str| report.solution.time(name).unwrap_or_else(|| panic!("no time {name}"));
    close(time("duration(covert)"), 597.492, 1e-5);
    close(time("duration(exposed)"), 40.0, 1e-8);
    joins_hold(report, 5, JOIN);
}

#[test]
fn the_flight_in_two_phases_from_both_routes_by_generated_code_and_interpreter() {
    for (x_via, y_via) in ROUTES {
        let problem = generated::LowObservablePhases { x_via, y_via, ..Default::default() };
        let solution = problem.solve(&Settings::default()).expect("it can be set up");
        assert!(solution.is_solved(), "{}", solution.report());
        covert_then_exposed(solution.report());
        close(solution.covert.duration() + solution.exposed.duration(), solution.duration_T(), 1e-14);
        assert_eq!(solution.exposed.start().to_bits(), solution.covert.end().to_bits());

        let interpreted = from_route("low_observable_phases", (x_via, y_via));
        assert_eq!(interpreted.solution.coefficients(), solution.untyped().coefficients());
    }
}

#[test]
fn the_cosine_form_has_the_same_optima_without_continuation() {
    for route in ROUTES {
        let whole = from_route("low_observable_cosine", route);
        close(whole.objective, 130.907_227_498, 1e-6);
        close(whole.solution.time("T").expect("a duration"), 644.6155, 1e-6);
        let phases = from_route("low_observable_phases_cosine", route);
        covert_then_exposed(&phases);
        assert_eq!((whole.history.len(), phases.history.len()), (1, 1));
    }
}

/// Durations of the legs of an alternation.
fn legs(report: &Report) -> Vec<f64> {
    joins_hold(report, 5, JOIN);
    report.phases().iter().map(|leg| leg.end - leg.start).collect()
}

#[test]
fn low_and_high_in_turn_each_as_long_as_it_may_be() {
    let report = Shipped::spec("low_observable_alternation").solve();
    close(report.objective, 99.664_134_947, 1e-7);
    for (found, known) in legs(&report).into_iter().zip([360.0017, 60.0, 60.0, 60.0]) {
        close(found, known, 1e-6);
    }
    // With longer exposures the flight is cheaper, and it takes longer ones.
    let free = [2000.0, 100.0, 2000.0, 100.0];
    let longer = Shipped::spec("low_observable_alternation").with("longest", &free).solve();
    assert!(longer.objective < 0.995 * report.objective, "{} but {}", longer.objective, report.objective);
}

#[test]
fn the_radar_never_tracks_long_enough() {
    // Another minimum, 102.753704585, lies 4e-6 above this one.
    for method in [Method::Sqp, Method::Auto] {
        let report = Shipped::spec("low_observable_lock_loss").by(method).solve();
        close(report.objective, 102.753_338_343, 1e-8);
        for (found, known) in legs(&report).into_iter().zip([331.0820, 40.0, 45.0, 40.0, 45.0, 40.0]) {
            close(found, known, 1e-6);
        }
    }
}
