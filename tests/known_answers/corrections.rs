//! Programs whose matrices have not the inertia of a minimum on the way.

use ntg::prelude::*;
use ntg::runtime::settings::InertiaCorrection;

use crate::support::{Shipped, close};

/// Swung up by a bounded torque as fast as can be, by both corrections in turns; by element alone the method creeps along a flat valley. Optimum: IPOPT on this
/// mesh.
#[test]
fn a_pendulum_is_swung_up_on_a_hundred_intervals() {
    let pendulum = Shipped::text(
        "problem SwingUp {
            duration T in 1 .. 80;
            state a, w;
            input u in -0.4 .. 0.4;
            collocation gauss(points = 3, intervals = 100);
            minimize T;
            dynamics { der(a) == w;  der(w) == -sin(a) + u; }
            initial { a == 0;  w == 0; }
            final { a == pi;  w == 0; }
            guess { T = 12;  a = pi * tau; }
        }",
    );
    let settings =
        Settings { max_iterations: 500, inertia_correction: InertiaCorrection::InTurns, ..Settings::default() };
    let report = solve(pendulum.problem(), &settings).expect("it can be set up");
    assert!(report.is_solved(), "{report}");
    close(report.objective, 9.853_999_4, 1e-7);
}

/// Both impulses of Hohmann's transfer between circles of radius 1 and 1.5 (Vallado, Fundamentals of Astrodynamics, section 6.3).
fn hohmann() -> f64 {
    let (radius, half) = (1.5_f64, 1.25);
    let on_ellipse = |r: f64| (2.0 / r - 1.0 / half).sqrt();
    (on_ellipse(1.0) - 1.0) + ((1.0 / radius).sqrt() - on_ellipse(radius))
}

#[test]
fn a_variable_that_nothing_depends_on_changes_nothing() {
    let transfer = |more: &str| {
        Shipped::text(&format!(
            "problem Hohmann {{
                duration T in 1.3 .. 8.8;
                state r[2], v[2];
                variable d1[2] in -1 .. 1, d2[2] in -1 .. 1;
                {more}
                collocation gauss(points = 4, intervals = 12);
                minimize norm(d1) + norm(d2);
                dynamics {{ der(r) == v;  der(v) == -r / norm(r)^3; }}
                initial {{ r == (1, 0);  v == (0, 1) + d1; }}
                trajectory {{ norm(r) >= 0.5; }}
                final {{ norm(r) == 1.5;  v + d2 == (-r[2], r[1]) / 1.5 * sqrt(1 / 1.5); }}
            }}"
        ))
        .solve()
    };
    let without = transfer("");
    close(without.objective, hohmann(), 1e-6);
    for more in ["variable nothing;", "variable nothing[3];", "variable nothing in -1 .. 1;"] {
        let with = transfer(more);
        close(with.objective, without.objective, 1e-9);
        assert!(with.iterations <= 2 * without.iterations, "{more} {} {}", with.iterations, without.iterations);
    }
}
