//! Objectives that fall without limit.

use ntg::prelude::*;

use crate::support::Shipped;

/// Variables and linear constraints, with a ray along which the objective falls.
const PROGRAMS: [&str; 3] = [
    "variable a; variable b; minimize -b;
     temporal { -1000 * a - 3000 * b <= 19001;  -2000 * a <= 11001;  -2000 * a + 2000 * b <= -2000;  a - b == 3; }",
    "variable a; variable b in -2 ..; minimize -a; temporal { -a + 2 * b == -4; }",
    "variable a; variable b in .. 5; variable c; minimize -0.0001 * (a + b);
     temporal { a - 2 * b - 2 * c == 6;  -2 * b - c == -1; }",
];

#[test]
fn an_objective_without_a_minimum_is_told_of_as_one() {
    for program in PROGRAMS {
        let text = format!(
            "problem Ray {{
                duration T = 1;
                output z: spline(order = 2, intervals = 1);
                minimize integral(z^2);
                initial {{ z == 0; }}
                {program}
            }}"
        );
        let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
        assert_eq!(report.status, Status::Unbounded, "{text}\n{report}");
    }
}
