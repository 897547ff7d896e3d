//! Angles as inputs without a guess: what formulas know by its sine and cosine alone is turned by little at once, and comes
//! back without whole turns from point to point.

use crate::support::{Shipped, close};
use ntg::prelude::*;
use ntg_runtime::report::Resolution;

/// Zermelo's boat in a linear shear: A. E. Bryson and Y.-C. Ho, *Applied Optimal Control*, 1975, section 2.7.
fn zermelo(turns: &str, extra: &str, intervals: usize) -> String {
    format!(
        "problem Zermelo {{
            duration T in 0 .. 50;
            state x, y;
            input th;
            collocation gauss(points = 3, intervals = {intervals});
            minimize T;
            dynamics {{ der(x) == cos({turns}) - y;  der(y) == sin({turns}); }}
            initial {{ x == 3.66;  y == -1.86; }}
            {extra}
            final {{ x == 0;  y == 0; }}
        }}"
    )
}

/// A boat that is to go as far west as it can, and heads east in the guess, where nothing pulls it to either side.
fn west(intervals: usize) -> String {
    format!(
        "problem West {{
            duration T = 1;
            state x, y;
            input th;
            collocation gauss(points = 3, intervals = {intervals});
            minimize final(x);
            dynamics {{ der(x) == cos(th);  der(y) == sin(th); }}
            initial {{ x == 0;  y == 0; }}
        }}"
    )
}

/// Round a disc of radius 2 to a place on the other side.
fn round_a_disc(intervals: usize) -> String {
    format!(
        "problem Round {{
            duration T in 0 .. 100;
            state x, y;
            input psi;
            collocation gauss(points = 3, intervals = {intervals});
            minimize T;
            dynamics {{ der(x) == cos(psi);  der(y) == sin(psi); }}
            initial {{ x == 0;  y == 0; }}
            trajectory {{ (x - 5)^2 + (y - 0.3)^2 >= 4; }}
            final {{ x == 10;  y == 0.5; }}
        }}"
    )
}

/// The length of the two tangents to a disc and of the arc between them, on one side of the line of sight.
fn length_round_a_disc(from: [f64; 2], to: [f64; 2], centre: [f64; 2], radius: f64) -> f64 {
    let beside = [from, to].map(|p| [p[0] - centre[0], p[1] - centre[1]]);
    let far = beside.map(|p| p[0].hypot(p[1]));
    let between = ((beside[0][0] * beside[1][0] + beside[0][1] * beside[1][1]) / (far[0] * far[1])).acos();
    let free: f64 = far.iter().map(|d| (radius / d).acos()).sum();
    far.iter().map(|d| (d * d - radius * radius).sqrt()).sum::<f64>() + radius * (between - free)
}

fn solved(text: &str, most: usize) -> Report {
    let report = Shipped::text(text).solve();
    assert!(report.is_solved(), "{:?}: {text}", report.status);
    assert!(report.iterations <= most, "{} iterations: {text}", report.iterations);
    assert_ne!(report.resolution(), Some(Resolution::Unresolved), "{text}");
    report
}

#[test]
fn a_heading_needs_no_guess() {
    for intervals in [8, 15, 25, 40] {
        // Without the limit on turns 18 to 1463 iterations, of headings that were hundreds of turns apart.
        let report = solved(&zermelo("th", "", intervals), 100);
        close(report.objective, 5.457_865, 1e-5);
    }
}

#[test]
fn a_multiple_of_an_angle_is_an_angle() {
    for turns in ["th / 2", "3 * th + 0.4", "-th", "x * 0 + th"] {
        let report = solved(&zermelo(turns, "", 15), 150);
        close(report.objective, 5.457_865, 1e-5);
    }
    // A bound is kept, whatever a turn would do.
    let report = solved(&zermelo("th", "trajectory { th in 0.5 .. 5; }", 15), 150);
    close(report.objective, 5.457_865, 1e-5);
}

#[test]
fn a_heading_that_is_worst_in_the_guess_turns_round() {
    for intervals in [8, 25, 60] {
        close(solved(&west(intervals), 60).objective, -1.0, 1e-9);
    }
}

#[test]
fn a_way_round_a_disc_is_found_without_a_guess() {
    let known = length_round_a_disc([0.0, 0.0], [10.0, 0.5], [5.0, 0.3], 2.0);
    for intervals in [15, 40] {
        close(solved(&round_a_disc(intervals), 200).objective, known, 1e-4);
    }
}

#[test]
fn what_formulas_know_otherwise_is_no_angle() {
    let angle = |turns: &str, extra: &str| {
        let shipped = Shipped::text(&zermelo(turns, extra, 4));
        let mut angles = shipped.problem().structure().angles;
        angles.retain(|angle| !angle.moves);
        assert!(angles.len() < 2 && angles.iter().all(|angle| (angle.phase, angle.output) == (0, 2)));
        angles.first().map(|angle| (angle.radian, angle.turn))
    };
    let turn = std::f64::consts::TAU;
    assert_eq!(angle("th", ""), Some((1.0, Some(turn))));
    assert_eq!(angle("th / 2", ""), Some((2.0, Some(2.0 * turn))));
    assert_eq!(angle("y - 4 * (x + th)", ""), Some((0.25, Some(turn / 4.0))));
    // A turn of the slow argument is two of the fast one; arguments of 2 and 3 times the angle have none that is as plain.
    assert_eq!(angle("th", "trajectory { cos(2 * th) >= -1; }"), Some((0.5, Some(turn))));
    assert_eq!(angle("2 * th", "trajectory { cos(3 * th) >= -1; }"), Some((1.0 / 3.0, None)));
    assert_eq!(angle("th", "trajectory { th <= 3; }"), Some((1.0, Some(turn))));
    for extra in ["trajectory { th + x <= 9; }", "trajectory { exp(th) <= 9; }", "trajectory { th^2 <= 9; }"] {
        assert_eq!(angle("th", extra), None, "{extra}");
    }
    assert_eq!(angle("th * x", ""), None);
    assert_eq!(angle("th^2", ""), None);
    assert_eq!(angle("th", "minimize integral(th^2);"), None);
    assert_eq!(angle("th", "minimize integral(sin(th)^2);"), Some((1.0, Some(turn))));
}
