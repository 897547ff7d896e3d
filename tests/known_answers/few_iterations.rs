//! Where a solve ends before it is done, the report is that of its last point.

use ntg::prelude::{Settings, solve};

use crate::support::{Shipped, close};

#[test]
fn the_objective_of_the_last_point_is_the_sum_of_its_terms() {
    // Durations, flat outputs, an objective that is maximised, a unit of its own.
    for name in
        ["breakwell", "belly_flop", "catalyst_mixing", "bryson_max_range", "brachistochrone_wall", "alpine_rider"]
    {
        let spec = Shipped::spec(&format!("gallery/{name}"));
        for most in 1..=4 {
            let settings = Settings { max_iterations: most, ..Settings::default() };
            let report = solve(spec.problem(), &settings).expect("it can be set up");
            let sum: f64 = report.terms.iter().map(|term| term.value).sum();
            assert!(sum.is_finite() && report.objective.is_finite(), "{name} after {most} iterations: {report}");
            if sum.abs() > 1e-9 {
                close(report.objective, sum, 1e-9);
            }
        }
    }
}
