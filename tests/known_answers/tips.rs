//! Tips of corners: a solution at one is a minimum, or it is left to the side on which the objective is better.

use super::support::{Shipped, close};
use ntg::prelude::*;

/// A state whose rate is an input, from 0, with an objective, and conditions besides.
fn drive(intervals: usize, bounds: &str, objective: &str, besides: &str) -> Report {
    let text = format!(
        "problem Drive {{
            duration T = 2 [s];
            state x [m];
            input u in {bounds} [m/s];
            collocation gauss(points = 3, intervals = {intervals});
            dynamics {{ der(x) == u; }}
            initial {{ x == 0; }}
            {besides}
            {objective};
        }}"
    );
    Shipped::text(&text).solve()
}

/// The tip at 0 is the top of a ridge, by the end or all along.
#[test]
fn the_tip_of_a_ridge_is_left_to_the_better_side() {
    for intervals in [4, 16] {
        for (objective, known) in [
            ("minimize abs(final(x)) - 2 * max(0, final(x))", -2.0),
            ("maximize 2 * max(0, final(x)) - abs(final(x))", 2.0),
            ("minimize integral(abs(u) - 2 * max(0, u))", -2.0),
            ("minimize integral(abs(u) - 1.5 * max(0, u))", -1.0),
        ] {
            close(drive(intervals, "-1 .. 1", objective, "").objective, known, 1e-6);
        }
    }
}

/// A price of a motion that is paid for from `t = 1` on: at rest before, at full speed after.
#[test]
fn an_input_rests_at_one_tip_and_leaves_another() {
    for intervals in [4, 16, 40] {
        for (objective, sign) in [
            ("minimize integral((1 - t / 1 [s]) * abs(u))", -1.0),
            ("maximize integral((t / 1 [s] - 1) * abs(u))", 1.0),
        ] {
            close(drive(intervals, "-1 .. 1", objective, "").objective, sign * 0.5, 1e-6);
        }
    }
}

/// Thousands of kilometres and nanometres.
#[test]
fn units_change_no_answer_at_a_tip() {
    for (bound, size) in [("1e6", 1e6), ("1e-9", 1e-9)] {
        let bounds = format!("-{bound} .. {bound}");
        let report = drive(8, &bounds, "minimize integral((1 - t / 1 [s]) * abs(u))", "");
        close(report.objective, -0.5 * size, 1e-6);
    }
}

/// What is bound to the tip, and what the least is at, stay solved.
#[test]
fn a_tip_that_is_a_minimum_stays_solved() {
    for (objective, besides) in [
        ("minimize integral(abs(u) - 0.5 * max(0, u))", ""),
        ("minimize integral((3 - t / 1 [s]) * abs(u))", ""),
        ("maximize integral(abs(u))", "trajectory { u == 0; }"),
        ("maximize abs(final(x))", "final { x == 0; }"),
    ] {
        let report = drive(8, "-1 .. 1", objective, besides);
        assert_eq!(report.status, Status::Solved, "{report}");
        assert!(report.objective.abs() < 1e-9, "{report}");
    }
}
