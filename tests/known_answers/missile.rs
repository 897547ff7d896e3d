//! Missiles: an intercept with two minima, and a flight whose thrust jumps.

use crate::support::{Shipped, close};

#[test]
fn the_intercept_has_a_minimum_on_each_side() {
    let right = Shipped::spec("missile_intercept").solve();
    close(right.objective, 95.974_905_59, 1e-4);
    close(right.solution.time("T").expect("the duration"), 55.2340, 1e-4);
    let left = Shipped::spec("missile_intercept").with("y_via", &[0.0]).solve();
    close(left.objective, 105.651_483_76, 1e-4);
    for (report, turn) in [(&right, -1.0), (&left, 1.0)] {
        let heading = report.solution.output("heading").expect("an output");
        let turned = heading.at(report.solution.end()) - 170.0;
        assert!(turned * turn > 90.0, "turned by {turned} degrees, to the left");
        assert!(report.violation.points < 1e-8, "{report}");
    }
}

#[test]
fn boost_and_coast_with_acceleration_to_spare_and_without() {
    for (a_max, known) in [(300.0, 18.799_113_6), (30.0, 18.842_887_8)] {
        let report = Shipped::spec("missile_boost_coast").with("a_max", &[a_max]).solve();
        close(report.objective, known, 1e-6);
        close(report.solution.time("end(boost)").expect("an event"), 6.0, 1e-12);
    }
}

#[test]
fn a_target_that_pulls_up_is_met_later_and_where_it_is() {
    let straight = Shipped::spec("missile_boost_coast").solve();
    let report = Shipped::spec("missile_boost_coast").with("pull_up", &[20.0]).with("climb", &[15.0]).solve();
    let end = report.solution.end();
    assert!(end > straight.solution.end() + 0.5, "met at {end} s");
    let at_end = |name: &str| report.solution.output(name).expect("an output").at(end);
    close(at_end("x"), 20.0 - 0.25 * end, 1e-8);
    close(at_end("h"), 9.0 + 0.015 * end + 0.02 * end * end / 2.0, 1e-8);
}
