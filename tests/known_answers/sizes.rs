//! Typical sizes that differ by many orders of magnitude: what is measured of one thing says nothing of another.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Cells of one array from rest to rest over sizes `q`, by least acceleration: 12 a cell beside its size, on paper.
fn cells(sizes: &[f64], intervals: usize) -> Report {
    let count = sizes.len();
    let list: Vec<String> = sizes.iter().map(|size| format!("{size:e}")).collect();
    let cost: Vec<String> = (1..=count).map(|k| format!("(a[{k}] / q[{k}])^2")).collect();
    let text = format!(
        "problem Cells {{
            duration T = 1;
            param q[{count}] = ({});
            state x[{count}], v[{count}];
            input a[{count}];
            collocation gauss(points = 3, intervals = {intervals});
            minimize integral({});
            dynamics {{ der(x) == v;  der(v) == a; }}
            initial {{ x == 0;  v == 0; }}
            final {{ x == q;  v == 0; }}
        }}",
        list.join(", "),
        cost.join(" + "),
    );
    Shipped::text(&text).solve()
}

#[test]
fn members_of_an_array_may_have_any_sizes() {
    for sizes in [&[1.0, 1.0][..], &[1e6, 1.0], &[1.0, 1e8], &[1e9, 1.0, 1e-9], &[1e-12, 1e12, 1.0]] {
        for intervals in [4, 10, 24] {
            let report = cells(sizes, intervals);
            close(report.objective, 12.0 * sizes.len() as f64, 1e-6);
            for (k, size) in sizes.iter().enumerate() {
                let speed = report.solution.output(&format!("v[{}]", k + 1)).expect("an element");
                // Its own size is what the end of a cell is judged by.
                assert!(speed.at(1.0).abs() <= 1e-7 * size, "cell {k} of {sizes:?} ends with {}", speed.at(1.0));
            }
        }
    }
}

#[test]
fn limits_of_a_vector_may_have_any_sizes() {
    // Each tank is filled at its limit within one second: half a second's worth, then a whole one.
    for ratio in [1.0, 1e6, 1e10] {
        let text = format!(
            "problem Tanks {{
                duration T = 2;
                param cap[2] = ({ratio:e}, 1);
                state x[2];
                input u[2];
                collocation gauss(points = 3, intervals = 20);
                maximize integral(x[1] / cap[1] + x[2] / cap[2]);
                dynamics {{ der(x) == u; }}
                initial {{ x == 0; }}
                trajectory {{ 0 <= u <= cap;  x <= cap; }}
            }}"
        );
        close(Shipped::text(&text).solve().objective, 3.0, 1e-6);
    }
}

/// A flat output from rest to rest, at a cost with the integral of its squared second derivative, which is 12 for T = 1: an
/// integral that enters otherwise than as a sum is a variable, and stationary at a straight guess.
#[test]
fn integrals_in_products_roots_and_quotients_have_sizes_of_their_own() {
    let fixed = "duration T = 1;";
    let free = "duration T in 1 .. 5;";
    let root = 12.0_f64.sqrt();
    let costs = [
        (fixed, "integral(der(x, 2)^2) * T", 12.0),
        (fixed, "integral(der(x, 2)^2) / T", 12.0),
        (fixed, "integral(der(x, 2)^2) * T^3", 12.0),
        (fixed, "sqrt(integral(der(x, 2)^2))", root),
        (fixed, "1e9 * sqrt(integral(der(x, 2)^2))", 1e9 * root),
        // 12 / T^3, times T, at T = 5.
        (free, "integral(der(x, 2)^2) * T", 12.0 / 25.0),
    ];
    for (duration, cost, known) in costs {
        for intervals in [4, 12, 40] {
            for length in [1.0, 1e5] {
                let text = format!(
                    "problem Mean {{
                        {duration}
                        output x: spline(order = 5, intervals = {intervals}, smoothness = 3);
                        minimize {};
                        initial {{ x == 0;  der(x) == 0; }}
                        final {{ x == {length:e};  der(x) == 0; }}
                    }}",
                    cost.replace("der(x, 2)", &format!("(der(x, 2) / {length:e})")),
                );
                let report = Shipped::text(&text).solve();
                close(report.objective, known, 1e-6);
                assert!(report.iterations <= 40, "{cost} on {intervals}: {} iterations", report.iterations);
            }
        }
    }
}

/// The time from rest to rest over 1 with an acceleration of 1 at most, which is 2.
fn least_time(bounds: &str, unit: &str, intervals: usize) -> Report {
    Shipped::text(&format!(
        "problem Rest {{
            duration T in {bounds} [{unit}];
            state x, v;
            input u in -1 .. 1;
            collocation gauss(points = 3, intervals = {intervals});
            minimize T / 1 [{unit}];
            dynamics {{ der(x) == v / 1 [{unit}];  der(v) == u / 1 [{unit}]; }}
            initial {{ x == 0;  v == 0; }}
            final {{ x == 1;  v == 0; }}
        }}"
    ))
    .solve()
}

#[test]
fn bounds_of_a_duration_may_be_many_decades_apart() {
    for unit in ["s", "h", "ns"] {
        for bounds in ["1e-6 .. 1e6", "0.1 .. 1e5", "1 .. 1e6", "1e-3 .. 1e3", "1e-9 .. 1e3", "0 .. 10"] {
            for intervals in [10, 40] {
                let report = least_time(bounds, unit, intervals);
                close(report.objective, 2.0, 1e-6);
                assert!(report.iterations <= 60, "{bounds} {unit}, {intervals}: {} iterations", report.iterations);
                assert!(report.warnings().iter().all(|w| !w.message.contains("shortest")), "{report}");
            }
        }
    }
    // What is written is kept: the least duration is that of the spec, and not a part of its upper bound.
    let text = "problem Shortest {
        duration T in 1e-4 .. 1e6;
        output x: spline(order = 3, intervals = 4);
        minimize T;
        initial { x == 0; }
        final { x == 1; }
    }";
    close(Shipped::text(text).solve().objective, 1e-4, 1e-6);
}
