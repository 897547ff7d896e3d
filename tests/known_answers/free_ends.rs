//! Ends that nothing fixes and durations that may be 0: when to stop is what is asked.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Solves a spec in which `UPPER`, `RATE` and `SIZE` stand for numbers.
fn solved(text: &str, upper: &str, rate: f64, size: f64) -> Report {
    let numbers = [("UPPER", upper.to_string()), ("RATE", format!("{rate:e}")), ("SIZE", format!("{size:e}"))];
    let text = numbers.iter().fold(text.to_string(), |text, (name, number)| text.replace(name, number));
    let report = solve(Shipped::text(&text).problem(), &Settings::default()).expect("it can be set up");
    assert!(report.is_solved() && report.iterations < 300, "{text}\n{report}");
    report
}

/// Upper bounds that mean nothing, rates per second, sizes of the state.
fn cases() -> impl Iterator<Item = (&'static str, f64, f64)> {
    let uppers = ["", "1e3", "1e5"].into_iter();
    let rates = move |upper| [1.0, 1e-2].map(move |rate| (upper, rate));
    uppers.flat_map(rates).flat_map(|(upper, rate)| [1e-9, 1e-6, 1.0, 1e6].map(move |size| (upper, rate, size)))
}

/// `exp(-t) + 0.1 t` is least at `log(10)`.
#[test]
fn what_cools_is_waited_for_as_long_as_it_is_worth() {
    let text = "problem Cooling {
        duration T in 0 .. UPPER;
        state x;
        collocation gauss(points = 4, intervals = 10);
        minimize final(x) + 0.1 * SIZE * RATE * T;
        dynamics { der(x) == -RATE * x; }
        initial { x == SIZE; }
    }";
    for (upper, rate, size) in cases() {
        let report = solved(text, upper, rate, size);
        close(report.objective / size, 0.1 + 0.1 * 10.0_f64.ln(), 1e-6);
    }
}

/// Growth `a x (1 - x)`, discounted at `0.8 a`, is stopped where `1 - x` is 0.8, and one at `0.1 a` where it is 0.1.
/// Without an upper bound it may run off to where nothing is left of it, which is told: those are left out.
#[test]
fn growth_is_stopped_where_it_is_slower_than_the_discount() {
    let text = "problem Forest {
        duration T in 0 .. UPPER;
        state x;
        collocation gauss(points = 4, intervals = 10);
        maximize final(x) * exp(-DISCOUNT * RATE * T);
        dynamics { der(x) == RATE * x * (1 - x / SIZE); }
        initial { x == 0.01 * SIZE; }
    }";
    for discount in [0.8_f64, 0.1] {
        let text = text.replace("DISCOUNT", &discount.to_string());
        let end = 1.0 - discount;
        let time: f64 = (end * 0.99 / (0.01 * discount)).ln();
        for (upper, rate, size) in cases().filter(|(upper, ..)| !upper.is_empty()) {
            close(solved(&text, upper, rate, size).objective / size, end * (-discount * time).exp(), 1e-4);
        }
    }
}

/// The second phase alone is worth its time: `exp(-2 b) + 15e-5 b` is least where the slope is 0.
#[test]
fn of_two_phases_the_dearer_one_vanishes() {
    let text = "problem Phases {
        state x;
        collocation gauss(points = 4, intervals = 8);
        phase a { duration in 0 .. UPPER;  dynamics { der(x) == -RATE * x; } }
        phase b after a { duration in 0 .. UPPER;  dynamics { der(x) == -2 * RATE * x; } }
        minimize final(x) + 0.2 * SIZE * RATE * duration(a) + 0.15 * SIZE * RATE * duration(b);
        initial { x == SIZE; }
    }";
    let time = 0.5 * (2.0_f64 / 0.15).ln();
    for (upper, rate, size) in cases() {
        let report = solved(text, upper, rate, size);
        close(report.objective / size, 0.075 + 0.15 * time, 1e-4);
    }
}
