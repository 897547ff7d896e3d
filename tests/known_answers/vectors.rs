//! Specs with vectors, states and equations of motion.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// The Moon's share of both masses, as in the spec.
const MU: f64 = 0.01215;

#[test]
fn a_periodic_orbit_keeps_its_jacobi_constant_and_closes() {
    let report = Shipped::spec("halo_orbit").solve();
    let output = |k: usize| report.solution.output(&format!("r[{k}]")).expect("an element");
    let state = |t: f64, order: usize| [1, 2, 3].map(|k| output(k).derivative(t, order));
    let jacobi = |t: f64| {
        let ([x, y, z], v) = (state(t, 0), state(t, 1));
        let distance = |from: f64| ((x - from).powi(2) + y * y + z * z).sqrt();
        let speed: f64 = v.iter().map(|v| v * v).sum();
        x * x + y * y + 2.0 * (1.0 - MU) / distance(-MU) + 2.0 * MU / distance(1.0 - MU) - speed
    };
    let period = report.objective;
    let start = jacobi(0.0);
    for k in 1..=40 {
        close(jacobi(period * f64::from(k) / 40.0), start, 1e-9);
    }
    for order in 0..2 {
        for (first, last) in state(0.0, order).into_iter().zip(state(period, order)) {
            close(1.0 + last, 1.0 + first, 1e-9);
        }
    }
}

#[test]
fn a_swarm_in_rows_of_coordinates_is_as_far_apart_as_it_must_be() {
    let report = Shipped::spec("swarm").solve();
    // Everyone gives way as everyone else does: the middle is passed at one quarter of a turn each.
    let place = |i: usize, t: f64| {
        [0, 1, 2].map(|k| report.solution.output(&format!("r[{i}, {}]", k + 1)).expect("an element").derivative(t, 0))
    };
    let end = report.phases()[0].end;
    for step in 0..=50 {
        let t = end * f64::from(step) / 50.0;
        for i in 1..=4 {
            for j in i + 1..=4 {
                let apart: f64 = place(i, t).iter().zip(place(j, t)).map(|(a, b)| (a - b).powi(2)).sum();
                assert!(apart > 1.0 - 1e-6, "{i} and {j} are {apart} m^2 apart at {t} s");
            }
        }
    }
    close(report.objective, 26.521_856, 1e-6);
}

/// Slacks that are not yet their distances are no violations: while vehicles are far apart the barrier parameter falls, and
/// where a search is stuck nothing is restored that is not missed.
#[test]
fn more_vehicles_take_few_more_iterations() {
    for (n, most) in [(4, 34), (6, 60), (8, 60), (10, 55)] {
        let report = Shipped::edited("swarm", &[("const n = 4;", &format!("const n = {n};"))]).solve();
        assert!(report.status.has_solution() && report.iterations <= most, "{n}: {report}");
    }
}
