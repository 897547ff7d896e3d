//! Values clamped between two bounds: saturations and dead zones, however they are written.

use crate::support::{Shipped, close};
use ntg::prelude::*;

/// A double integrator by a law of its input `w`, with `A` and `d` in any units, as numbers or as parameters that may change.
fn cart(
    (kind, law): (&str, &str),
    (metre, second): (f64, f64),
    (points, intervals): (usize, usize),
    rest: &str,
) -> Report {
    let text = format!(
        "problem Cart {{
            {kind} A = {} [m/s^2];
            {kind} d = {} [m/s^2];
            const L = {metre} [m];
            {rest}
            state x [m], v [m/s];
            input w in -1.125 * A .. 1.125 * A;
            dynamics {{ der(x) == v;  der(v) == {law}; }}
            initial {{ x == 0; v == 0; }}
            collocation gauss(points = {points}, intervals = {intervals});
        }}",
        4.0 * metre / (second * second),
        0.5 * metre / (second * second),
    );
    Shipped::text(&text).solve()
}

/// At `L` and at rest as soon as can be.
fn soonest(second: f64) -> String {
    let (least, most) = (0.1 * second, 10.0 * second);
    format!("duration T in {least} .. {most} [s];  minimize T / {second} [s];  final {{ x == L; v == 0; }}")
}

const UNITS: [(f64, f64); 4] = [(1.0, 1.0), (1e-3, 1.0), (1.0, 60.0), (1e5, 10.0)];

/// Beyond the dead zone `A` is left of `A + d`: `x = A (T / 2)^2`.
#[test]
fn a_dead_zone_is_passed_at_both_ends() {
    for (metre, second) in UNITS {
        for mesh in [(2, 6), (2, 30), (4, 10)] {
            for law in [
                ("const", "w - max(-d, min(d, w))"),
                ("param", "w - min(d, max(-d, w))"),
                ("param", "max(0, w - d) - max(0, -w - d)"),
            ] {
                let farthest = format!("duration T = {second} [s];  maximize final(x) / L;  final {{ v == 0; }}");
                close(cart(law, (metre, second), mesh, &farthest).objective, 1.0, 1e-6);
                close(cart(law, (metre, second), mesh, &soonest(second)).objective, 1.0, 1e-6);
            }
        }
    }
}

/// An input may go beyond what has an effect.
#[test]
fn a_saturation_is_met_from_either_side() {
    for (metre, second) in UNITS {
        for mesh in [(2, 30), (4, 8)] {
            for law in [
                ("param", "max(-A, min(A, 3 * w))"),
                ("const", "min(A, max(-A, 3 * w))"),
                ("param", "A * max(-1, min(1, 3 * w / A))"),
            ] {
                close(cart(law, (metre, second), mesh, &soonest(second)).objective, 1.0, 1e-6);
            }
        }
    }
}

/// Where the bounds are the wrong way round, the outer one alone counts, also where parameters are set so.
#[test]
fn bounds_the_wrong_way_round_leave_the_outer_one() {
    for (clamp, known) in [("max(lo, min(hi, w))", 2.0), ("min(hi, max(lo, w))", 1.0)] {
        for (lo, set) in [(2.0, None), (-1.0, Some(2.0))] {
            let text = format!(
                "problem Turned {{
                    param lo = {lo};  param hi = 1;
                    duration T = 1 [s];
                    state x;  input w in -3 .. 3;
                    maximize final(x) - integral(w^2) / 1000 [s];
                    dynamics {{ der(x) == ({clamp}) / 1 [s]; }}
                    initial {{ x == 0; }}
                    collocation gauss(points = 2, intervals = 4);
                }}"
            );
            let spec = Shipped::text(&text);
            let spec = if let Some(lo) = set { spec.with("lo", &[lo]) } else { spec };
            close(spec.solve().objective, known, 1e-6);
        }
    }
}
