//! Piecewise linear tables: fuel maps, losses, tariffs in blocks, gains. Answers are those of the linear and quadratic programs
//! with a row for each line at the same points, by CasADi and IPOPT, and values of the tables on paper.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Solves a spec; gives its objective and the iterations.
#[track_caller]
fn solved(text: &str) -> (f64, usize) {
    let report = Shipped::text(text).solver().solve().expect("it can be set up");
    assert_eq!(report.status, Status::Solved, "{text}: {report}");
    (report.objective, report.iterations)
}

/// An engine's fuel over its power, convex, beside a battery with losses: the gradient jumps at every node, on which the
/// engine stays for most of the time.
#[test]
fn a_convex_fuel_map_beside_a_battery() {
    let (fuel, iterations) = solved(
        "problem Hybrid {
            duration T = 600 [s]; state e in 0.4 .. 1.6 [kWh]; input pe in 0 .. 40 [kW];
            collocation gauss(points = 3, intervals = 60);
            table fuel(p [kW]) [g/s] = linear { 0: 0.1; 10: 0.7; 20: 1.5; 30: 2.4; 40: 3.6; }
            let need [kW] = 15 [kW] + 15 [kW] * sin(2 * pi * t / 200 [s]) + 5 [kW] * sin(2 * pi * t / 60 [s]);
            let pb [kW] = need - pe;
            minimize integral(fuel(pe)) / 1 [g];
            dynamics { der(e) == -(pb + pb^2 / 400 [kW]); }
            initial { e == 1 [kWh]; } final { e == 1 [kWh]; }
        }",
    );
    close(fuel, 666.010_14, 1e-6);
    assert!(iterations <= 100, "{iterations}");
}

/// A tariff in blocks of power, a loss both ways of a battery, a concave gain that is maximised, a budget, a limited heat, an even
/// loss beside a price on where it ends.
#[test]
fn tables_of_the_trade() {
    let tariff = "problem Tariff {
        duration T = 24 [h]; state e in 0 .. 8 [kWh]; input p in 0 .. 12 [kW];
        collocation gauss(points = 2, intervals = 48);
        table cost(p [kW]) [1/h] = linear { 0: 0; 2: 0.2; 4: 0.6; 7: 1.5; 12: 4; }
        let need [kW] = 3 [kW] + 2 [kW] * sin(2 * pi * (t - 9 [h]) / 24 [h])
            + 1.5 [kW] * sin(2 * pi * (t - 5 [h]) / 12 [h]);
        minimize integral(cost(p));
        dynamics { der(e) == p - need; } initial { e == 4 [kWh]; } final { e == 4 [kWh]; } }";
    let battery = "problem Battery {
        duration T = 24 [h]; state e in 0 .. 10 [kWh]; input p in -4 .. 4 [kW];
        collocation gauss(points = 3, intervals = 32);
        table loss(p [kW]) [kW] = linear {
            -4: 0.9; -3: 0.5; -2: 0.25; -1: 0.1; 0: 0; 1: 0.08; 2: 0.22; 3: 0.45; 4: 0.8; }
        let price [1/kWh] = 0.25 [1/kWh] + 0.12 [1/kWh] * sin(2 * pi * (t - 13 [h]) / 24 [h])
            + 0.05 [1/kWh] * sin(2 * pi * t / 8 [h]);
        minimize integral(price * (p + loss(p)));
        dynamics { der(e) == p; } initial { e == 2 [kWh]; } final { e == 2 [kWh]; } }";
    let gain = "problem Gain {
        duration T = 90; state w in 0 .. 30; input q in 0 .. 3; collocation gauss(points = 2, intervals = 45);
        table gain(q) = linear { 0: 0; 0.5: 1; 1: 1.8; 1.5: 2.3; 2: 2.6; 3: 2.8; }
        maximize integral((1 + 0.5 * sin(pi * t / 90)) * gain(q));
        dynamics { der(w) == 0.8 + 0.7 * cos(2 * pi * t / 90) - q; } initial { w == 10; } final { w >= 5; } }";
    let budget = "problem Budget {
        duration T = 100; state s in 0 .. 20; input p in 0 .. 4; collocation gauss(points = 2, intervals = 50);
        table fuel(p) = linear { 0: 0.1; 1: 0.5; 2: 1.1; 3: 2; 4: 3.4; }
        maximize integral((1 + 0.6 * sin(2 * pi * t / 50)) * p);
        dynamics { der(s) == p - 1.8; } temporal { integral(fuel(p)) <= 120; } initial { s == 5; } }";
    let heat = "problem Heat {
        duration T in 0.5 .. 20; state x, v; input i in -3 .. 3; collocation gauss(points = 3, intervals = 20);
        table heat(i) = linear { -3: 5; -2: 2.2; -1: 0.6; 0: 0; 1: 0.6; 2: 2.2; 3: 5; }
        minimize T;
        dynamics { der(x) == v; der(v) == i; } trajectory { heat(i) + 0.5 * abs(v) <= 3; }
        initial { x == 0; v == 0; } final { x == 4; v == 0; } guess { x = 4 * t / T; T = 4; } }";
    let even = "problem Even {
        duration T = 5; state x, v; input a in -3 .. 3; collocation gauss(points = 3, intervals = 20);
        table loss(a even) = linear { 0: 0; 0.5: 0.2; 1: 0.6; 2: 2; 3: 4.5; }
        table miss(d) = linear { -20: 86; -2: 6; -1: 2; 0: 0; 1: 1; 3: 7; 20: 100; }
        let d = final(x) - 6;
        minimize integral(loss(a)) + miss(d);
        dynamics { der(x) == v; der(v) == a; } trajectory { x in -10 .. 20; }
        initial { x == 0; v == 0; } final { v == 0; } }";
    let all = [
        (tariff, 10.181_285_9),
        (battery, -2.178_329_04),
        (gain, 187.754_619_8),
        (budget, 227.466_311_3),
        (heat, 2.761_652_92),
        (even, 2.166_016_97),
    ];
    for (text, known) in all {
        let (objective, iterations) = solved(text);
        close(objective, known, 1e-6);
        assert!(iterations <= 100, "{text}: {iterations}");
    }
}

/// A table is the function it is, within its nodes and outside, convex, concave or neither, wherever it stands.
#[test]
fn a_table_is_what_it_is_wherever_it_stands() {
    const PLACES: [&str; 4] = [
        "minimize integral(FORMULA);",
        "variable c; minimize c; temporal { integral(FORMULA) <= c; }",
        "minimize final(FORMULA);",
        "variable c; minimize c; trajectory { FORMULA <= c; }",
    ];
    let tables: [&[(f64, f64)]; 5] = [
        &[(-2.0, 3.0), (-1.0, 1.0), (0.0, 0.0), (1.0, 0.5), (3.0, 4.0)],
        &[(-2.0, 0.0), (0.0, 1.0), (1.0, 3.0), (3.0, 9.0)],
        &[(-2.0, 1.0), (0.0, 0.0), (3.0, 0.0)],
        &[(-2.0, -3.0), (-1.0, 0.0), (1.0, 2.0), (3.0, 2.5)],
        &[(-2.0, 0.0), (-1.0, 2.0), (0.0, 1.0), (1.0, 3.0), (3.0, 1.0)],
    ];
    let (mut tried, mut unsolved) = (0, 0);
    for nodes in tables {
        let text: String = nodes.iter().map(|(x, y)| format!("{x}: {y};")).collect();
        let table = |x: f64| {
            let x = x.clamp(nodes[0].0, nodes[nodes.len() - 1].0);
            let cell = nodes.windows(2).find(|pair| x <= pair[1].0).expect("within");
            cell[0].1 + (x - cell[0].0) * (cell[1].1 - cell[0].1) / (cell[1].0 - cell[0].0)
        };
        for (bounds, sign, bowl, centre, start) in [
            ((-2.0, 3.0), 1.0, 0.1, 0.7, 2.2),
            ((-2.0, 3.0), 1.0, 0.3, -1.6, 0.4),
            ((-2.0, 3.0), -1.0, 0.4, 0.4, -1.3),
            ((-4.0, 5.0), 1.0, 0.2, 4.2, 1.3),
            ((-4.0, 5.0), -1.0, 0.6, -3.1, -0.7),
            ((0.5, 5.0), 1.0, 0.5, 2.5, 4.1),
        ] {
            for place in PLACES {
                let formula = format!("({sign}) * f(x) + {bowl} * (x - ({centre}))^2");
                let place = place.replace("FORMULA", &formula);
                let (low, high): (f64, f64) = bounds;
                let spec = Shipped::text(&format!(
                    "problem Place {{ duration T = 1;
                     output x in {low} .. {high}: spline(order = 1, intervals = 1, smoothness = 0);
                     table f(x) = linear {{ {text} }} {place} guess {{ x = {start}; }} }}"
                ));
                let report = spec.solver().solve().expect("it can be set up");
                tried += 1;
                if report.status != Status::Solved {
                    unsolved += 1;
                    continue;
                }
                let value = |x: f64| sign * table(x) + bowl * (x - centre).powi(2);
                let x = report.solution.output("x").expect("x").at(0.5);
                let found = value(x);
                let size = 1.0 + found.abs();
                assert!((report.objective - found).abs() <= 1e-4 * size, "{place}: {} for {found}", report.objective);
                let beside = (-200..=200).map(|k| value((x + 1e-5 * f64::from(k)).clamp(low, high)));
                let least = beside.fold(f64::INFINITY, f64::min);
                assert!(found - least <= 1e-5 * size, "{text} {place}: x = {x} has {found}, beside it {least}");
            }
        }
    }
    // Minima at corners that are no largest of lines: a level end that is pushed up to.
    assert!(10 * unsolved <= tried, "{unsolved} of {tried} unsolved");
}

/// A limit on one element of an array says nothing of the others: what the corner of `p[2]` can be is not known, and not
/// limited by the bounds of `p[1]`.
///
/// With `n` for `night`, `p1 = -n / 2` and `p2 = c - n / 2`, `c = 58 / 24` from the end of `e[2]`, by the integrals 6 of `n` and 4.5
/// of its square; no corner is met.
#[test]
fn a_limit_on_one_element_is_none_on_the_others() {
    let (objective, _) = solved(
        "problem Two {
            duration T = 24; state e[2] in 0 .. 100; input p[2]; collocation gauss(points = 3, intervals = 24);
            let night = max(0, cos(2 * pi * t / 24))^2;
            trajectory { p[1] in -1 .. 1; }
            dynamics { for i in 1 .. 2 { der(e[i]) == p[i]; } }
            initial { e == 5; } final { e[2] == 60; }
            minimize integral(sum(i in 1 .. 2, night * max(-10, p[i] - 5) + p[i]^2));
        }",
    );
    close(objective, 58.0 * 58.0 / 24.0 - 62.25, 1e-6);
}

/// A table whose nodes lie on one line has no corner where its ends are not reached, or go on: its value in an equation was
/// refused before the solve (E057), as if the line had to be 0. With `q` at the end, 7/4, the value is 2.3 q, the rate of its
/// sine 2.3 cos(2.3 q).
#[test]
fn a_straight_table_is_its_line_in_equations() {
    let ends = "linear(extrapolate = linear) { -5: -11.5; 0: 0; 10: 23; }";
    let within = "linear { -5: -11.5; 0: 0; 10: 23; }";
    let level = "linear { -5: 3; 0: 3; 10: 3; }";
    let line: f64 = 2.3 * 1.75;
    for (table, said, known) in [
        (ends, "final(a, tab(t))", line),
        (ends, "final(a, der(sin(tab(t))))", 2.3 * line.cos()),
        (ends, "at(a, start(a) + 0.25 * duration(a), exp(0.1) * (tab(t) + t))", 0.1_f64.exp() * 0.25 * (line + 1.75)),
        (ends, "tab(r) + partial(tab(r), r)", 6.9),
        (within, "tab(r) + partial(tab(r), r)", 6.9),
        (level, "final(a, tab(t) + der(tab(t)))", 3.0),
        ("linear(extrapolate = linear) { 0: 0; 5: 11.5; 10: 25; }", "final(a, tab(t))", line),
    ] {
        let report = Shipped::text(&format!(
            "problem Straight {{
                table tab(z) = {table}
                state x: spline(order = 4, intervals = 1);
                dynamics {{ der(x) == 0.5 + 0.6 * t - 0.3 * t^2; }}
                phase a {{ duration A in 0.5 .. 3;  final {{ q == t; }} }}
                variable q, r in 0 .. 4, s;
                temporal {{ q == 1.75;  r == 2;  s == {said}; }}
            }}"
        ));
        let report = report.solver().solve().unwrap_or_else(|error| panic!("{table} {said}: {error}"));
        assert_eq!(report.status, Status::Solved, "{table} {said}: {report}");
        close(report.solution.variable("s").expect("s"), known, 1e-8);
    }
}
