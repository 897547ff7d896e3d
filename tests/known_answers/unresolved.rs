//! Solutions of the points alone: whoever does not see them believes a wrong number.

use ntg::prelude::*;
use ntg::runtime::report::Resolution;

use crate::support::Shipped;

fn resolution(text: &str) -> (Resolution, Report) {
    let report = Shipped::text(text).solve();
    (report.resolution(), report)
}

/// A wheel that turns `turns` times beside a controlled speed: too few points alias it.
fn spinner(turns: f64, first_angle: f64, intervals: usize) -> String {
    let rate = std::f64::consts::TAU * turns / 10.0;
    format!(
        "problem Spin {{
            duration T = 10;
            state th, y;
            input u;
            collocation gauss(points = 3, intervals = {intervals});
            minimize integral(u^2);
            dynamics {{ der(th) == {rate};  der(y) == 10 * sin(th) + u; }}
            initial {{ th == {first_angle};  y == 0; }}
            final {{ y == 1; }}
        }}"
    )
}

#[test]
fn an_aliased_oscillation_is_seen_whatever_its_angle() {
    for first_angle in [0.0, 1000.0 * std::f64::consts::TAU] {
        for intervals in [10, 25, 80] {
            let (found, report) = resolution(&spinner(159.0, first_angle, intervals));
            assert_eq!(found, Resolution::Unresolved, "{intervals} from {first_angle}");
            assert!(report.to_string().starts_with("Spin: solved at the points, and not between them"), "{report}");
            assert!(report.advice.contains("intervals"), "{}", report.advice);
        }
        // Three points in a sixth of a turn see it.
        let (found, _) = resolution(&spinner(3.0, first_angle, 20));
        assert_eq!(found, Resolution::Fine, "from {first_angle}");
    }
}

#[test]
fn an_offset_hides_nothing() {
    // A body in air whose temperature swings eighty times; measured from 0 or in kelvin.
    let mut means = vec![];
    for offset in [0.0, 300.0, 3000.0] {
        let text = format!(
            "problem Heat {{
                duration T = 10;
                state b, q;
                collocation gauss(points = 3, intervals = 15);
                minimize integral((b - {offset})^2);
                dynamics {{ der(b) == 5 * ({offset} + 10 * sin(50 * t) - b);  der(q) == b - {offset}; }}
                initial {{ b == {offset};  q == 0; }}
            }}"
        );
        let (found, report) = resolution(&text);
        assert_eq!(found, Resolution::Unresolved, "from {offset}");
        means.push(report.constraints.iter().map(|constraint| constraint.mean_between).fold(0.0, f64::max));
    }
    assert!(means.iter().all(|mean| (mean / means[0] - 1.0).abs() < 0.2), "{means:?}");
}

#[test]
fn a_jump_over_an_obstacle_is_no_solution() {
    let text = "problem Post {
        duration T = 10;
        state x, y, vx, vy;
        input ax, ay;
        collocation gauss(points = 3, intervals = 10);
        minimize integral(ax^2 + ay^2);
        dynamics { der(x) == vx;  der(y) == vy;  der(vx) == ax;  der(vy) == ay; }
        initial { x == 0;  y == 0;  vx == 0;  vy == 0; }
        final { x == 10;  y == 0;  vx == 0;  vy == 0; }
        trajectory { post: (x - 5)^2 + y^2 >= 1; }
    }";
    let (found, report) = resolution(text);
    let around = (report.solution.output("y").expect("an output").at(5.0)).abs() > 0.9;
    assert!(around || found == Resolution::Unresolved, "{report}");
}

#[test]
fn one_jump_of_an_input_is_no_reason() {
    // A thrust that turns round in one interval of twenty.
    let text = "problem Turn {
        duration T in 0.1 .. 10;
        state x, v;
        input th;
        collocation gauss(points = 3, intervals = 21);
        minimize T;
        dynamics { der(x) == v;  der(v) == cos(th); }
        initial { x == 0;  v == 0; }
        final { x == 1;  v == 0; }
        trajectory { th in 0 .. 3.2; }
        guess { th = 1.6;  T = 2; }
    }";
    let (found, report) = resolution(text);
    assert!(report.is_solved() && found < Resolution::Unresolved, "{report}");
}
