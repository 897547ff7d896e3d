//! Minimum times of flat outputs with limits on their second to fourth derivatives: a coefficient of a spline moves these by
//! far more than the motion does.

use crate::support::{Shipped, close};

/// A chain of `order` integrators from rest to rest over 50, with a limit on the last derivative, as a flat output.
fn chain(order: usize, intervals: usize) -> String {
    let rest: Vec<String> = (1..order).map(|k| format!("der(x, {k}) == 0;")).collect();
    let rest = rest.join("  ");
    format!(
        "problem Chain {{
            duration T in 1 .. 60;
            output x: spline(order = {}, intervals = {intervals}, smoothness = {order});
            minimize T;
            initial {{ x == 0;  {rest} }}
            final {{ x == 50;  {rest} }}
            trajectory {{ der(x, {order}) in -1 .. 1; }}
        }}",
        order + 2
    )
}

#[test]
fn chains_of_integrators_have_their_least_times() {
    // On paper: 2 sqrt(d) for two integrators, (32 d)^(1/3) for three, which switch at quarters of the time and not at knots.
    for intervals in [8, 24, 40] {
        let two = Shipped::text(&chain(2, intervals)).solve();
        close(two.objective, 2.0 * 50f64.sqrt(), 1e-2);
        let three = Shipped::text(&chain(3, intervals)).solve();
        close(three.objective, (32.0 * 50f64).cbrt(), 3e-2);
        for report in [two, three] {
            assert!(report.iterations <= 80, "{intervals} intervals: {} iterations", report.iterations);
        }
    }
}

#[test]
fn a_crane_and_a_unicycle_do_not_wander() {
    for intervals in [12, 20] {
        let crane = format!(
            "problem Crane {{
                duration T in 0.5 .. 60;
                output y: spline(order = 6, intervals = {intervals}, smoothness = 4);
                let x = y + 0.4 * der(y, 2);
                minimize T;
                initial {{ y == 0;  der(y) == 0;  der(y, 2) == 0;  der(y, 3) == 0; }}
                final {{ y == 4;  der(y) == 0;  der(y, 2) == 0;  der(y, 3) == 0; }}
                trajectory {{ der(x) in -1 .. 1;  der(x, 2) in -0.8 .. 0.8;  der(y, 2) in -1.5 .. 1.5; }}
            }}"
        );
        // By IPOPT on the same programs: 5.7235405 and 5.6217345.
        let crane = Shipped::text(&crane).solve();
        close(crane.objective, if intervals == 12 { 5.7235405 } else { 5.6217345 }, 1e-6);
        let unicycle = format!(
            "problem Unicycle {{
                duration T in 0.1 .. 100;
                output x, y: spline(order = 5, intervals = {intervals}, smoothness = 3);
                minimize T;
                initial {{ x == 0;  y == 0;  der(x) == 1;  der(y) == 0; }}
                final {{ x == 0;  y == 10;  der(x) == 1;  der(y) == 0; }}
                trajectory {{ der(x)^2 + der(y)^2 in 0.25 .. 4;  der(x, 2)^2 + der(y, 2)^2 <= 1; }}
            }}"
        );
        let unicycle = Shipped::text(&unicycle).solve();
        close(unicycle.objective, if intervals == 12 { 7.5007506 } else { 7.4961703 }, 1e-5);
        for report in [crane, unicycle] {
            assert!(report.iterations <= 150, "{}: {} iterations", report.problem, report.iterations);
        }
    }
}
