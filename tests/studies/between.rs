//! Constraints that a solution violates between the points are named, refused or refined away, as the settings say.

use ntg::prelude::*;
use ntg::runtime::settings::Between;

use crate::support::Shipped;

/// A throw under a ceiling that is asked for at three points: between them the curve is free and rises above it.
fn arch() -> Shipped {
    Shipped::text(
        "problem Arch {
            duration T = 2 [s];
            output x [m]: spline(order = 6, intervals = 2);
            collocation gauss(points = 3);
            minimize integral(der(x, 2)^2);
            initial { x == 0; der(x) == 1 [m/s]; }
            trajectory { ceiling: x <= 0.1 [m]; }
            final { x == 0; der(x) == -1 [m/s]; }
        }",
    )
}

#[test]
fn a_ceiling_that_is_missed_between_the_points_is_a_warning_by_name_and_time() {
    let report = arch().solve();
    assert!(report.is_solved(), "{report}");
    let warnings = report.warnings();
    let [warning] = &warnings[..] else { panic!("one constraint is missed: {warnings:?}") };
    assert_eq!(warning.constraint, "ceiling");
    let between = report.constraint("ceiling").and_then(|c| c.between.clone()).expect("it is checked");
    assert!(between.relative > 0.01 && warning.time == between.time && warning.time.is_some(), "{warning:?}");
    assert!(warning.message.starts_with("`ceiling` is violated between the points by "), "{warning}");
    assert!(report.to_string().contains(&format!("warning: {warning}")), "{report}");
    let deaf = Settings { between_tolerance: 2.0 * between.relative, ..Settings::default() };
    let report = solve(arch().problem(), &deaf).expect("it is set up");
    assert!(report.warnings().is_empty(), "{report}");
}

#[test]
fn what_is_missed_between_the_points_is_refused() {
    let settings = Settings { between: Between::Refuse, ..Settings::default() };
    let report = solve(arch().problem(), &settings).expect("it is set up");
    let Status::ViolatedBetween { constraints } = &report.status else { panic!("{report}") };
    assert!(constraints[0].starts_with("`ceiling`") && !report.has_solution(), "{report}");
    assert!(!report.advice.is_empty());
}

#[test]
fn what_is_missed_between_the_points_is_refined_away() {
    let settings = Settings { between: Between::Refine, ..Settings::default() };
    let report = solve(arch().problem(), &settings).expect("it is set up");
    assert!(report.is_solved() && report.violation.between <= 0.01, "{report}");
    assert!(report.refined.as_ref().is_some_and(|refined| refined.rounds.len() > 1), "{report}");
    assert!(report.warnings().is_empty(), "{report}");
    let wrong = Settings { between_tolerance: 0.0, ..Settings::default() };
    let error = solve(arch().problem(), &wrong).expect_err("it is out of range");
    assert_eq!(error.to_string(), "setting `between_tolerance`: 0 is not positive and finite");
}
