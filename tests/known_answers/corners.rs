//! Formulas of corners, `abs`, `max`, `min`, clamps and smooth conditions, that nothing but themselves decide: what is called
//! solved has the value that the formula has there, and is a minimum of it.

use std::fmt::Write as _;

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// A formula in `x`: its text, and its value.
struct Formula(String, Box<dyn Fn(f64) -> f64>);

/// Numbers of a fixed sequence, and whether sides of corners may be curved.
struct Draw(u64, bool);

impl Draw {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) as usize % count
    }

    /// A number between two, in hundredths.
    fn number(&mut self, least: i64, most: i64) -> f64 {
        (least + self.below((most - least + 1) as usize) as i64) as f64 / 100.0
    }

    /// A line, or a curve.
    fn side(&mut self) -> Formula {
        let (slope, offset) = ([1.0, -1.0, 2.0, -0.5, 1.5][self.below(5)], self.number(-200, 200));
        if !self.1 {
            return Formula(format!("({slope} * x + ({offset}))"), Box::new(move |x| slope * x + offset));
        }
        let (bend, pace) = (self.number(-50, 50), self.number(50, 200));
        match self.below(3) {
            0 => Formula(
                format!("({slope} * x + ({bend}) * x^2 + ({offset}))"),
                Box::new(move |x| slope * x + bend * x * x + offset),
            ),
            1 => Formula(
                format!("({slope} * sin({pace} * x) + ({offset}))"),
                Box::new(move |x| slope * (pace * x).sin() + offset),
            ),
            _ => Formula(
                format!("({slope} * x * exp(-x^2 / 9) + ({offset}))"),
                Box::new(move |x| slope * x * (-x * x / 9.0).exp() + offset),
            ),
        }
    }

    fn corner(&mut self) -> Formula {
        let Formula(a, f) = self.side();
        let Formula(b, g) = self.side();
        let (c, d) = (self.number(20, 150), self.number(0, 200));
        match self.below(7) {
            0 => Formula(format!("abs{a}"), Box::new(move |x| f(x).abs())),
            1 => Formula(format!("max(0, {a})"), Box::new(move |x| f(x).max(0.0))),
            2 => Formula(format!("max({a}, {b})"), Box::new(move |x| f(x).max(g(x)))),
            3 => Formula(format!("min({a}, {b})"), Box::new(move |x| f(x).min(g(x)))),
            4 => Formula(format!("min(1, max(0, {a}))"), Box::new(move |x| f(x).clamp(0.0, 1.0))),
            5 => Formula(
                format!("(if {a} <= 0.2 smooth {c} {{ {d} }} else {{ 1 }})"),
                Box::new(move |x| {
                    let s = ((f(x) - 0.2) / c + 0.5).clamp(0.0, 1.0);
                    d + (1.0 - d) * s.powi(3) * (10.0 - 15.0 * s + 6.0 * s * s)
                }),
            ),
            _ => Formula(format!("max(0, abs{a} - {c})"), Box::new(move |x| (f(x).abs() - c).max(0.0))),
        }
    }

    fn term(&mut self) -> Formula {
        let Formula(a, f) = self.corner();
        match self.below(9) {
            0 | 1 => Formula(a, f),
            2 => Formula(format!("({a})^2"), Box::new(move |x| f(x).powi(2))),
            3 => Formula(format!("({a})^3"), Box::new(move |x| f(x).powi(3))),
            4 => Formula(format!("exp(-0.5 * {a})"), Box::new(move |x| (-0.5 * f(x)).exp())),
            5 => Formula(format!("sqrt(0.5 + ({a})^2)"), Box::new(move |x| (0.5 + f(x).powi(2)).sqrt())),
            6 => Formula(format!("tanh({a})"), Box::new(move |x| f(x).tanh())),
            7 => Formula(format!("1 / (1 + ({a})^2)"), Box::new(move |x| 1.0 / (1.0 + f(x).powi(2)))),
            _ => Formula(format!("(0.3 + 0.7 * {a}) * ({a})"), Box::new(move |x| (0.3 + 0.7 * f(x)) * f(x))),
        }
    }

    /// One or two terms, and a parabola that leaves no minimum far away.
    fn formula(&mut self) -> Formula {
        let mut text = String::new();
        let mut terms: Vec<(f64, Formula)> = vec![];
        for _ in 0..1 + self.below(2) {
            let weight = self.number(20, 150) * if self.below(3) == 0 { -1.0 } else { 1.0 };
            terms.push((weight, self.term()));
        }
        let (bowl, centre) = (self.number(10, 60), self.number(0, 200));
        for (weight, Formula(term, _)) in &terms {
            let _ = write!(text, "({weight}) * {term} + ");
        }
        let _ = write!(text, "{bowl} * (x - {centre})^2");
        let value = move |x: f64| {
            terms.iter().map(|(weight, term)| weight * (term.1)(x)).sum::<f64>() + bowl * (x - centre).powi(2)
        };
        Formula(text, Box::new(value))
    }
}

/// The formula in an integral that is minimised, or limited, at an end, and limited along the way.
const PLACES: [&str; 4] = [
    "minimize integral(FORMULA);",
    "variable c; minimize c; temporal { integral(FORMULA) <= c; }",
    "minimize final(FORMULA);",
    "variable c; minimize c; trajectory { FORMULA <= c; }",
];

#[test]
fn a_corner_is_what_it_is_wherever_it_stands() {
    // Minima at corners that no helper stands for: `tanh(abs(x))`, `1 / (1 + min(1, max(0, x))^2)`.
    let (unsolved, tried) = unsolved_of(Draw(7, false));
    assert!(20 * unsolved <= 3 * tried, "{unsolved} of {tried} unsolved");
}

#[test]
fn a_corner_of_curved_sides_is_what_it_is_wherever_it_stands() {
    let (unsolved, tried) = unsolved_of(Draw(11, true));
    assert!(20 * unsolved <= 3 * tried, "{unsolved} of {tried} unsolved");
}

/// How many of how many problems with formulas that are drawn are unsolved; what is solved has the value of its formula, and
/// is a minimum of it.
fn unsolved_of(mut draw: Draw) -> (usize, usize) {
    let (mut tried, mut unsolved) = (0, 0);
    for _ in 0..150 {
        let Formula(text, value) = draw.formula();
        let start = draw.number(-300, 300);
        for place in PLACES {
            let place = place.replace("FORMULA", &text);
            let spec = Shipped::text(&format!(
                "problem Corner {{ duration T = 1; output x in -6 .. 6: spline(order = 1, intervals = 1, smoothness = 0);
                 {place} guess {{ x = {start}; }} }}"
            ));
            let report = spec.solver().solve().expect("it can be set up");
            tried += 1;
            if report.status != Status::Solved {
                unsolved += 1;
                continue;
            }
            let x = report.solution.output("x").expect("x").at(0.5);
            let (found, size) = (value(x), 1.0 + value(x).abs());
            assert!((report.objective - found).abs() <= 1e-4 * size, "{place}: {} for {found}", report.objective);
            let beside = (-200..=200).map(|k| value((x + 1e-5 * f64::from(k)).clamp(-6.0, 6.0)));
            let least = beside.fold(f64::INFINITY, f64::min);
            assert!(found - least <= 1e-5 * size, "{place}: x = {x} has {found}, beside it {least}");
        }
    }
    (unsolved, tried)
}

/// Price by the hour, nothing at night: what floats at night costs nothing, and stays within its bounds.
#[test]
fn a_weight_that_vanishes_by_the_clock_leaves_the_rest_exact() {
    let price = |limit: &str| {
        let spec = Shipped::text(&format!(
            "problem Night {{
                duration T = 24; state e in 0 .. 10; input p {limit}; collocation gauss(points = 2, intervals = 24);
                table price(t) = linear {{ 0: 0; 6: 0; 8: 0.3; 20: 0.3; 22: 0; 24: 0; }}
                dynamics {{ der(e) == p; }}
                initial {{ e == 5; }} final {{ e == 5; }}
                minimize integral(price(t) * max(0, 1 + sin(2 * pi * t / 24) + p));
            }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "{report}");
        (report.objective, report.iterations)
    };
    let (objective, iterations) = price("in -3 .. 3");
    close(objective, 0.2320052, 1e-6);
    assert!(iterations <= 40, "{iterations}");
}

/// What is pushed by less and less far away is at its corner all the same where a limit keeps it from there.
#[test]
fn a_push_that_fades_far_away_is_one_within_limits() {
    let best = |objective: &str, rows: &str| {
        let spec = Shipped::text(&format!(
            "problem Fading {{
                duration T = 1; state s[2], w[2]; input a[2]; collocation gauss(points = 3, intervals = 16);
                dynamics {{ der(s) == w; der(w) == a; }} trajectory {{ {rows} }}
                initial {{ s == 0; w == 0; }} final {{ s == (0.6, 0.8); w == 0; }} {objective};
            }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "{objective}: {report}");
        assert!(report.iterations <= 120, "{objective}: {}", report.iterations);
        report.objective
    };
    for (corner, rows) in
        [("norm(a)", "norm(a) <= 8;"), ("abs(a[1]) + abs(a[2])", "-6.4 <= a[1] <= 6.4; abs(a[2]) <= 6.4;")]
    {
        let least = best(&format!("minimize integral({corner})"), rows);
        close(best(&format!("maximize exp(-integral({corner}) / 2)"), rows), (-least / 2.0).exp(), 1e-6);
        close(best(&format!("maximize 1 / (1 + integral({corner}))"), rows), 1.0 / (1.0 + least), 1e-6);
        close(best(&format!("minimize tanh(integral({corner}) / 4)"), rows), (least / 4.0).tanh(), 1e-6);
    }
}

/// A weight that is solved for and may be 0 goes into the corner: work at a speed that begins and ends at rest.
#[test]
fn a_weight_that_may_vanish_stands_inside_its_corner() {
    let work = |work: &str| {
        let spec = Shipped::text(&format!(
            "problem Train {{
                duration T = 400 [s];  state x [m], v in 0 .. 60 [m/s];  input f in -0.2 .. 0.37 [m/s^2];
                collocation gauss(points = 3, intervals = 30);
                dynamics {{ der(x) == v;  der(v) == f - 0.02 [m/s^2]; }}
                initial {{ x == 0;  v == 0; }}  final {{ x == 5 [km];  v == 0; }}  minimize integral({work});
            }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert!(report.is_solved() && report.iterations <= 80, "{work}: {report}");
        report.objective
    };
    let inside = work("max(0, f * v)");
    close(work("max(0, f) * v"), inside, 1e-6);
    close(work("v * max(0, f)"), inside, 1e-6);
    close(work("-v * min(0, -f)"), inside, 1e-6);
    close(work("(abs(f) * v + f * v) / 2"), inside, 1e-6);
}

/// Sides may be negative where a corner is not: (18.3) asks for a function that rises for all of them.
#[test]
fn a_limit_on_a_function_of_a_corner_is_no_limit_on_its_sides() {
    let most = |limit: &str| {
        let spec = Shipped::text(&format!(
            "problem Limit {{ duration T = 1; output x in -9 .. 9: spline(order = 1, intervals = 1, smoothness = 0);
             minimize integral(-x); trajectory {{ {limit} }} guess {{ x = -3; }} }}"
        ));
        let report = spec.solver().solve().expect("it can be set up");
        assert_eq!(report.status, Status::Solved, "{limit}: {report}");
        -report.objective
    };
    close(most("max(0, x - 2)^2 <= 1;"), 3.0, 1e-6);
    close(most("abs(x)^1.5 <= 8;"), 4.0, 1e-6);
    close(most("100 / (1 + abs(x)) >= 20;"), 4.0, 1e-6);
    close(most("max(0, x) * max(1, x) <= 4;"), 2.0, 1e-6);
    close(most("max(x, -x - 8)^3 <= 8;"), 2.0, 1e-6);
}

/// What a store takes and gives at a loss has two corners, of which one is pushed away from its tip; in sum it is convex. The same
/// with an input for each: a linear program.
#[test]
fn a_store_with_losses_is_one_corner() {
    let prices = [31.0, 24.0, 11.0, 9.0, 27.0, 45.0, 52.0, 38.0, 22.0, 14.0, 33.0, 60.0]
        .map(|price| price.to_string())
        .join(", ");
    let day = |declared: &str, taken: &str| {
        Shipped::text(&format!(
            "problem Day {{
                param price[12] = ({prices});  param loss = 0.95;  duration T = 12;
                state E in 0 .. 5;  {declared}  collocation gauss(points = 2, intervals = 12);
                let tariff = sum(i in 1 .. 12, price[i] * (if t in i - 1 .. i {{ 1 }} else {{ 0 }}));
                minimize {taken};
                initial {{ E == 1; }}
                final {{ E == 1; }}
            }}"
        ))
        .solve()
    };
    let known = day(
        "input up in 0 .. 2, down in 0 .. 2;  dynamics { der(E) == up - down; }",
        "integral(tariff * (up / loss - loss * down))",
    );
    assert!(known.is_solved(), "{known}");
    let one = "input e in -2 .. 2;  dynamics { der(E) == e; }";
    for taken in [
        "integral(tariff * (max(e, 0) / loss - loss * max(-e, 0)))",
        "integral(tariff * (max(e, 0) / 0.95 + 0.95 * min(e, 0)))",
        "integral(tariff * max(e, 0) / loss - loss * tariff * max(-e, 0))",
        "integral(tariff * (max(2 * e, 0) / (2 * loss) - loss * max(0, -3 * e) / 3))",
        "integral(tariff * max(e, 0)) / loss - loss * integral(tariff * max(-e, 0))",
    ] {
        let report = day(one, taken);
        assert!(report.is_solved(), "{taken}: {report}");
        close(report.objective, known.objective, 1e-6);
    }
}
