//! Limits that forbid a band, which a path jumps over between two points: no solution, though what is missed is little
//! beside all that the limit varies by.

use super::support::Shipped;
use ntg::prelude::*;
use ntg_runtime::report::Resolution;

fn report(text: &str) -> Report {
    Shipped::text(text).solver().solve().expect("it can be set up")
}

/// A continuous speed cannot pass what `(v - low) (v - high) >= 0` forbids, from 3 to 12.
fn ship(low: f64, high: f64, intervals: usize) -> Report {
    report(&format!(
        "problem Ship {{ duration T = 600; state s, v; input u in -0.1 .. 0.1; collocation gauss(points = 3, intervals = {intervals});
         minimize integral(u^2); dynamics {{ der(s) == v; der(v) == u; }} initial {{ s == 0; v == 3; }}
         trajectory {{ vibration: (v - {low}) * (v - {high}) >= 0; }} final {{ v == 12; }} }}"
    ))
}

#[test]
fn a_forbidden_band_of_speeds_is_not_passed() {
    for (low, high, intervals) in [(6.0, 7.0, 12), (6.0, 7.0, 20), (6.0, 6.2, 12)] {
        let found = ship(low, high, intervals);
        assert_eq!(found.resolution(), Some(Resolution::Unresolved), "{low} .. {high}, {intervals}: {found}");
    }
}

/// Beside the band there is nothing to jump over.
#[test]
fn a_band_that_is_not_passed_is_none() {
    let found = ship(13.0, 14.0, 12);
    assert_eq!((found.is_solved(), found.resolution()), (true, Some(Resolution::Fine)), "{found}");
}

/// A ring wall in the plane.
#[test]
fn a_ring_wall_is_not_passed() {
    let found = report(
        "problem Ring { duration T in 1 .. 30; state r[2], v[2]; input a[2] in -3 .. 3;
         collocation gauss(points = 3, intervals = 20); minimize T; dynamics { der(r) == v; der(v) == a; }
         initial { r == (0.1, 0); v == 0; } trajectory { (dot(r, r) - 4) * (dot(r, r) - 6.76) >= 0; }
         final { r == (6, 0); v == 0; } }",
    );
    assert_eq!(found.resolution(), Some(Resolution::Unresolved), "{found}");
}

/// An input may jump over what is forbidden: it is not continuous.
#[test]
fn inputs_may_jump() {
    let found = report(
        "problem Switch { duration T = 2; state x; input u in 0 .. 1; collocation gauss(points = 3, intervals = 20);
         minimize integral((x - 0.5 * t)^2 + 0.1 * (u - 0.5)^2); dynamics { der(x) == u; } initial { x == 0; }
         trajectory { (u - 0.2) * (u - 0.8) >= 0; } guess { u = tau; } }",
    );
    assert_eq!((found.is_solved(), found.resolution()), (true, Some(Resolution::Coarse)), "{found}");
}

/// A path that goes round a disc on few points, more than a right angle from one to the next, misses it by little.
#[test]
fn a_path_around_a_disc_jumps_over_nothing() {
    let found = report(
        "problem Around { duration T in 1 .. 60; state x, y, q; input w in -1 .. 1;
         collocation gauss(points = 3, intervals = 10); minimize T;
         dynamics { der(x) == cos(q); der(y) == sin(q); der(q) == w; } initial { x == 0; y == 0; q == 0; }
         trajectory { (x - 3)^2 + (y + 0.3)^2 >= 1; (x - 6)^2 + (y - 0.5)^2 >= 1; } final { x == 9; y == 0; q == 0; }
         guess { x = 9 * tau; y = 0.5 * sin(2 * pi * tau); T = 10; } }",
    );
    assert_eq!((found.is_solved(), found.resolution()), (true, Some(Resolution::Coarse)), "{found}");
}
