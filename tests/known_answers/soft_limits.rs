//! Limits along the way that may be missed at a price (docs/maths.md, section 18).
//!
//! The least `integral(u^2)` with `der(x) == u` from 0 to `h` in the time `L` and back to 0, with a price `w` on what `x` exceeds
//! `c` by. By the Euler-Lagrange equation `x'' == w / 2` beyond the limit for the price, `x'' == w (x - c)` for that of the square,
//! and a line before it, with one slope where both meet.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// A hill: `L`, `h`, `c` and `w`.
type Hill = (f64, f64, f64, f64);

const HILLS: [Hill; 4] = [(2.0, 1.0, 0.0, 10.0), (1.3, 0.9, 0.2, 25.0), (2.7, 1.6, 0.5, 8.0), (1.8, 0.7, 0.35, 38.0)];

/// The slope at which a rise that is `curved(m, s)` above the limit after a time `s` gets to `h`, by bisection.
fn slope((duration, h, c, _): Hill, curved: impl Fn(f64, f64) -> f64) -> f64 {
    let (mut low, mut high) = (c / duration, 1e3);
    for _ in 0..200 {
        let middle = 0.5 * (low + high);
        let is_short = curved(middle, duration - c / middle) < h - c;
        (low, high) = if is_short { (middle, high) } else { (low, middle) };
    }
    high
}

/// The least objective with the price of the amount.
fn priced(hill: Hill) -> f64 {
    let (duration, h, c, w) = hill;
    let (m, s) = match c {
        0.0 => (0.0, 2.0 * (h / w).sqrt()),
        _ => {
            let m = slope(hill, |m, s| m * s + w / 4.0 * s * s);
            (m, duration - c / m)
        }
    };
    2.0 * (m * c + m * m * s + m * w * s * s + w * w * s.powi(3) / 6.0)
}

/// The least objective with the price of the square.
fn squared(hill: Hill) -> f64 {
    let (duration, h, c, w) = hill;
    let k = w.sqrt();
    let m = slope(hill, |m, s| m / k * (k * s).sinh());
    let s = if c == 0.0 { duration } else { duration - c / m };
    2.0 * (m * c + (h - c) * m * (k * s).cosh())
}

fn solved((duration, h, c, w): Hill, price: &str, collocation: &str) -> Report {
    let text = format!(
        "problem Hill {{
            duration D = {};
            state x;
            input u;
            collocation {collocation};
            minimize integral(u^2);
            dynamics {{ der(x) == u; }}
            initial {{ x == 0; }}
            final {{ x == 0; }}
            at {duration} {{ x == {h}; }}
            trajectory {{ soft({price}{w}): limit: x <= {c}; }}
        }}",
        2.0 * duration
    );
    let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
    assert!(report.status.has_solution(), "{text}\n{report}");
    report
}

#[test]
fn what_is_missed_of_a_limit_is_free_at_every_point() {
    for hill in HILLS {
        let (amount, square) = (priced(hill), squared(hill));
        // A line in each interval costs 6 to 90 % too much on this mesh.
        close(solved(hill, "", "gauss(points = 3, intervals = 8)").objective, amount, 2e-3);
        close(solved(hill, "square = ", "gauss(points = 3, intervals = 8)").objective, square, 1e-3);
        close(solved(hill, "", "gauss(points = 4, intervals = 32)").objective, amount, 1e-3);
        close(solved(hill, "square = ", "gauss(points = 4, intervals = 32)").objective, square, 1e-6);
    }
}

#[test]
fn points_that_are_too_few_for_a_price_are_told_of() {
    for hill in HILLS {
        let (report, known) = (solved(hill, "", "gauss(points = 5, intervals = 4)"), priced(hill));
        let is_right = (report.objective / known - 1.0).abs() < 1e-2;
        assert!(is_right || !report.warnings().is_empty(), "{known} is known\n{report}");
        // What the limit is missed by between the points is a price, and no limit that does not hold.
        assert!(report.violated_between().is_empty(), "{report}");
    }
}

/// Limits in parts, with two sides and with corners in them: on two meshes they cost the same.
#[test]
fn what_is_missed_in_a_part_converges_as_elsewhere() {
    let on = |intervals: usize| {
        let text = format!(
            "problem Parts {{
                duration D = 4;
                state x;
                input u;
                collocation gauss(points = 4, intervals = {intervals});
                minimize integral(u^2);
                dynamics {{ der(x) == u; }}
                initial {{ x == 0; }}
                final {{ x == 0; }}
                at 2 {{ x == 1; }}
                trajectory from 1 to 2.5 {{ soft(10): x in -1 .. 0.2; }}
                trajectory except final {{ soft(square = 3): abs(x) <= 0.3; }}
                trajectory {{ soft(2): x == 0.5; }}
            }}"
        );
        Shipped::text(&text).solve()
    };
    let (coarse, fine) = (on(8), on(64));
    close(coarse.objective, fine.objective, 2e-3);
    close(coarse.objective_fine, fine.objective, 2e-3);
}
