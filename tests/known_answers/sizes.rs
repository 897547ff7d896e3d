//! Typical sizes that differ by many orders of magnitude: what is measured of one thing says nothing of another.

use ntg::prelude::*;

use crate::support::{Shipped, close};

/// Cells of one array from rest to rest over sizes `q`, by least acceleration: 12 a cell beside its size, on paper.
fn cells(sizes: &[f64], intervals: usize) -> Report {
    let count = sizes.len();
    let list: Vec<String> = sizes.iter().map(|size| format!("{size:e}")).collect();
    let cost: Vec<String> = (1..=count).map(|k| format!("(a[{k}] / q[{k}])^2")).collect();
    let text = format!(
        "problem Cells {{
            duration T = 1;
            param q[{count}] = ({});
            state x[{count}], v[{count}];
            input a[{count}];
            collocation gauss(points = 3, intervals = {intervals});
            minimize integral({});
            dynamics {{ der(x) == v;  der(v) == a; }}
            initial {{ x == 0;  v == 0; }}
            final {{ x == q;  v == 0; }}
        }}",
        list.join(", "),
        cost.join(" + "),
    );
    Shipped::text(&text).solve()
}

#[test]
fn members_of_an_array_may_have_any_sizes() {
    for sizes in [&[1.0, 1.0][..], &[1e6, 1.0], &[1.0, 1e8], &[1e9, 1.0, 1e-9], &[1e-12, 1e12, 1.0]] {
        for intervals in [4, 10, 24] {
            let report = cells(sizes, intervals);
            close(report.objective, 12.0 * sizes.len() as f64, 1e-6);
            for (k, size) in sizes.iter().enumerate() {
                let speed = report.solution.output(&format!("v[{}]", k + 1)).expect("an element");
                // Its own size is what the end of a cell is judged by.
                assert!(speed.at(1.0).abs() <= 1e-7 * size, "cell {k} of {sizes:?} ends with {}", speed.at(1.0));
            }
        }
    }
}

#[test]
fn limits_of_a_vector_may_have_any_sizes() {
    // Each tank is filled at its limit within one second: half a second's worth, then a whole one.
    for ratio in [1.0, 1e6, 1e10] {
        let text = format!(
            "problem Tanks {{
                duration T = 2;
                param cap[2] = ({ratio:e}, 1);
                state x[2];
                input u[2];
                collocation gauss(points = 3, intervals = 20);
                maximize integral(x[1] / cap[1] + x[2] / cap[2]);
                dynamics {{ der(x) == u; }}
                initial {{ x == 0; }}
                trajectory {{ 0 <= u <= cap;  x <= cap; }}
            }}"
        );
        close(Shipped::text(&text).solve().objective, 3.0, 1e-6);
    }
}

/// A flat output from rest to rest, at a cost with the integral of its squared second derivative, which is 12 for T = 1: an
/// integral that enters otherwise than as a sum is a variable, and stationary at a straight guess.
#[test]
fn integrals_in_products_roots_and_quotients_have_sizes_of_their_own() {
    let fixed = "duration T = 1;";
    let free = "duration T in 1 .. 5;";
    let root = 12.0_f64.sqrt();
    let costs = [
        (fixed, "integral(der(x, 2)^2) * T", 12.0),
        (fixed, "integral(der(x, 2)^2) / T", 12.0),
        (fixed, "integral(der(x, 2)^2) * T^3", 12.0),
        (fixed, "sqrt(integral(der(x, 2)^2))", root),
        (fixed, "1e9 * sqrt(integral(der(x, 2)^2))", 1e9 * root),
        // 12 / T^3, times T, at T = 5.
        (free, "integral(der(x, 2)^2) * T", 12.0 / 25.0),
    ];
    for (duration, cost, known) in costs {
        for intervals in [4, 12, 40] {
            for length in [1.0, 1e5] {
                let text = format!(
                    "problem Mean {{
                        {duration}
                        output x: spline(order = 5, intervals = {intervals}, smoothness = 3);
                        minimize {};
                        initial {{ x == 0;  der(x) == 0; }}
                        final {{ x == {length:e};  der(x) == 0; }}
                    }}",
                    cost.replace("der(x, 2)", &format!("(der(x, 2) / {length:e})")),
                );
                let report = Shipped::text(&text).solve();
                close(report.objective, known, 1e-6);
                assert!(report.iterations <= 40, "{cost} on {intervals}: {} iterations", report.iterations);
            }
        }
    }
}

/// The time from rest to rest over 1 with an acceleration of 1 at most, which is 2.
fn least_time(bounds: &str, unit: &str, intervals: usize) -> Report {
    Shipped::text(&format!(
        "problem Rest {{
            duration T in {bounds} [{unit}];
            state x, v;
            input u in -1 .. 1;
            collocation gauss(points = 3, intervals = {intervals});
            minimize T / 1 [{unit}];
            dynamics {{ der(x) == v / 1 [{unit}];  der(v) == u / 1 [{unit}]; }}
            initial {{ x == 0;  v == 0; }}
            final {{ x == 1;  v == 0; }}
        }}"
    ))
    .solve()
}

#[test]
fn bounds_of_a_duration_may_be_many_decades_apart() {
    for unit in ["s", "h", "ns"] {
        for bounds in ["1e-6 .. 1e6", "0.1 .. 1e5", "1 .. 1e6", "1e-3 .. 1e3", "1e-9 .. 1e3", "0 .. 10"] {
            for intervals in [10, 40] {
                let report = least_time(bounds, unit, intervals);
                close(report.objective, 2.0, 1e-6);
                assert!(report.iterations <= 60, "{bounds} {unit}, {intervals}: {} iterations", report.iterations);
                assert!(report.warnings().iter().all(|w| !w.message.contains("shortest")), "{report}");
            }
        }
    }
    // What is written is kept: the least duration is that of the spec, and not a part of its upper bound.
    let text = "problem Shortest {
        duration T in 1e-4 .. 1e6;
        output x: spline(order = 3, intervals = 4);
        minimize T;
        initial { x == 0; }
        final { x == 1; }
    }";
    close(Shipped::text(text).solve().objective, 1e-4, 1e-6);
}

/// A ramp that is followed by one output, which begins and ends at what may be rounding.
fn ramp(first: &str, last: &str) -> f64 {
    let text = format!(
        "problem Ramp {{
            duration T = 1;
            output y: spline(order = 5, intervals = 6);
            minimize integral((y - t)^2 + 1e-3 * der(y)^2);
            initial {{ y == {first}; }}
            final {{ y == {last}; }}
        }}"
    );
    Shipped::text(&text).solve().objective
}

#[test]
fn a_boundary_value_that_is_rounding_is_no_size() {
    let known = ramp("0", "0");
    close(known, 0.030_935_431_18, 1e-8);
    let near = ["cos(90 [deg])", "sin(180 [deg])", "10 * sin(2 * pi)", "1e-300", "1e-16", "1e-13", "1e-11", "1e-9"];
    for first in near {
        for last in ["0", "sin(180 [deg])", "1e-12"] {
            close(ramp(first, last), known, 1e-6);
        }
    }
}

#[test]
fn a_course_may_point_anywhere() {
    // What is flown does not hang on the direction: components that vanish do so to rounding.
    let cost = |degrees: f64| {
        let text = format!(
            "problem Course {{
                duration T = 60 [s];
                param h = {degrees} [deg];
                state x, y [m], vx, vy [m/s];
                input ax, ay [m/s^2];
                collocation gauss(points = 3, intervals = 20);
                minimize integral((x * cos(h) + y * sin(h) - 10 [m/s] * t)^2
                    + (y * cos(h) - x * sin(h) - 40 [m] * sin(t / 8 [s]))^2) / 1 [m^2*s]
                    + 10 * integral(ax^2 + ay^2) / 1 [m^2/s^3];
                dynamics {{ der(x) == vx;  der(y) == vy;  der(vx) == ax;  der(vy) == ay; }}
                initial {{ x == 0;  y == 0;  vx == 10 [m/s] * cos(h);  vy == 10 [m/s] * sin(h); }}
            }}"
        );
        Shipped::text(&text).solve().objective
    };
    let known = cost(33.0);
    for degrees in [0.0, 89.0, 90.0, 180.0, 270.0, 360.0] {
        close(cost(degrees), known, 1e-6);
    }
}

#[test]
fn robots_on_crossing_lines_leave_them() {
    // Components that are 0 all along the guess have the size of the others of their array, where distances are singular:
    // robots that meet at the crossing.
    let text = "problem Crossing {
        duration T in 1 .. 60 [s];
        output p[2, 2] [m]: spline(order = 4, intervals = 12, smoothness = 2);
        minimize T;
        trajectory {
            for i in 1 .. 2 { dot(der(p[i]), der(p[i])) <= 1 [m^2/s^2]; }
            norm(p[1] - p[2]) >= 1 [m];
        }
        initial { p[1] == (-5, 0) [m];  p[2] == (0, -5) [m]; }
        final { p[1] == (5, 0) [m];  p[2] == (0, 5) [m]; }
    }";
    let report = Shipped::text(text).solve();
    assert!(report.objective < 10.2, "one waits for the other: {}", report.objective);
}

/// A store that buys and sells by a tariff, with a price on less than a reserve: a linear program. At its first points the
/// reserve is kept, and what is missed of it is next to 0, which is no size. Optimum: CasADi and IPOPT on this mesh,
/// -2.868687499.
fn store(unit: &str, joules: f64, price: f64, method: Method) -> Shipped {
    let n = |kilowatt_hours: f64| format!("{:e} [{unit}]", kilowatt_hours * 3.6e6 / joules);
    let (most, half, reserve) = (n(10.0), n(5.0), n(3.0));
    let spec = Shipped::text(&format!(
        "problem Store {{
            domain t [h];
            duration D = 24 [h];
            state E in 0 .. {most};
            input c in 0 .. 4 [kW], d in 0 .. 4 [kW];
            collocation gauss(points = 1, intervals = 48);
            table price(time [h]) [1/kWh] =
                linear {{ 0: 0.1; 6: 0.1; 8: 0.35; 12: 0.2; 17: 0.25; 19: 0.5; 22: 0.2; 24: 0.1; }}
            minimize cost: integral(price(t) * (c - d));
            dynamics {{ der(E) == 0.9 * c - d / 0.9; }}
            initial {{ E == {half}; }}
            final {{ E >= {half}; }}
            trajectory {{ soft({price} [1/(kWh*h)]): reserve: E >= {reserve}; }}
        }}"
    ));
    spec.by(method)
}

#[test]
fn what_is_missed_of_a_reserve_has_the_size_of_the_reserve_in_any_unit() {
    for (unit, joules) in [("J", 1.0), ("Wh", 3.6e3), ("kWh", 3.6e6), ("GWh", 3.6e12)] {
        for method in [Method::Auto, Method::Sqp] {
            close(store(unit, joules, 0.02, method).solve().objective, -2.871_354_166, 1e-6);
        }
    }
}

#[test]
fn a_saved_point_at_a_bound_tells_no_size() {
    // Where the reserve is dear it is kept all day: what is missed lies at its bound.
    let dear = store("kWh", 3.6e6, 2.0, Method::Auto).solve();
    close(dear.objective, -2.485_173_57, 1e-5);
    let kept = Guess::raw(dear.solution.coefficients().to_vec());
    for method in [Method::Auto, Method::Sqp] {
        close(store("kWh", 3.6e6, 0.02, method).solve_from(&kept).objective, -2.871_354_166, 1e-6);
    }
}

/// A tank that runs empty (Torricelli), `T = 2 (sqrt h0 - sqrt h1) / k`: a first height of one unit is a height.
#[test]
fn a_tank_may_be_full_to_one_unit() {
    for unit in ["mm", "m", "km"] {
        for full in [0.5_f64, 1.0, 2.0] {
            let report = Shipped::text(&format!(
                "problem Tank {{
                    duration T in 0.1 .. 60 [s];
                    state h [{unit}];
                    collocation gauss(points = 3, intervals = 25);
                    minimize T;
                    dynamics {{ der(h) == -1 [{unit}/s] * sqrt(h / 1 [{unit}] + 1e-9); }}
                    initial {{ h == {full} [{unit}]; }}
                    trajectory {{ h >= 0; }}
                    final {{ h <= 0.0001 [{unit}]; }}
                }}"
            ))
            .solve();
            close(report.objective, 2.0 * (full.sqrt() - 1e-2), 1e-6);
            assert!(report.iterations < 100, "{unit} {full}: {}", report.iterations);
        }
    }
}

/// Guesses from 1 down to next to nothing, as people write who have been told not to begin at 0.
fn small_guesses() -> impl Iterator<Item = String> {
    ["1", "0.1", "1e-2", "1e-3", "1e-4", "1e-5", "1e-6", "1e-7", "1e-8", "1e-9", "1e-10", "1e-12"]
        .into_iter()
        .map(Into::into)
}

/// Solves a text with each small guess in place of `GUESS`: the optimum within some iterations.
#[track_caller]
fn from_small_guesses(text: &str, optimum: f64, iterations: usize) {
    for guess in small_guesses() {
        let report = Shipped::text(&text.replace("GUESS", &guess)).solve();
        close(1.0 + report.objective, 1.0 + optimum, 1e-6);
        assert!(report.iterations <= iterations, "{guess}: {} iterations", report.iterations);
    }
}

/// Nothing but the objective tells the size of the state, which is at rest at the solution.
#[test]
fn a_guess_next_to_0_is_no_size_of_a_state() {
    from_small_guesses(
        "problem O { duration T = 2; state x; input u; collocation gauss(points = 3, intervals = 6);
         minimize integral(sqrt(1 + (x - 1)^2) + u^2); dynamics { der(x) == u; } guess { x = GUESS; u = 0; } }",
        2.0,
        30,
    );
    from_small_guesses(
        "problem Q { duration T = 3; state x, v; input f in -2 .. 2; collocation gauss(points = 3, intervals = 10);
         minimize integral((x - 1)^2 + 0.1 * f^2); dynamics { der(x) == v; der(v) == x - x^3 + f; }
         initial { v == 0; } guess { x = GUESS; v = GUESS; f = GUESS; } }",
        0.0,
        40,
    );
}

/// Variables: a convex one, one whose objective is -1e-12 at the guess, and a fit of which nothing is known.
#[test]
fn a_guess_next_to_0_is_no_size_of_a_variable() {
    let of = |cost: &str| {
        format!(
            "problem S {{ duration T = 1; output d: spline(order = 2, intervals = 1); variable b;
             minimize {cost} + integral(der(d)^2); initial {{ d == 0; }} final {{ d == 0; }} guess {{ b = GUESS; }} }}"
        )
    };
    from_small_guesses(&of("sqrt(1 + (b - 1)^2)"), 1.0, 30);
    // Newton steps away from a maximum double the distance: forty doublings from 1e-12, and as many after each restart.
    from_small_guesses(&of("b^4 - b^2"), -0.25, 160);
    from_small_guesses(
        "problem F { duration T = 5; state x; variable k, c; collocation gauss(points = 3, intervals = 10);
         dynamics { der(x) == -k * x + c; }
         measure { at(1, x) == 1.2 sigma 0.1; at(2, x) == 0.7 sigma 0.1; at(4, x) == 0.45 sigma 0.1;
                   initial(x) == 2 sigma 0.1; }
         guess { x = GUESS; k = GUESS; c = GUESS; } }",
        0.182_484_744,
        100,
    );
}

/// Boundary values and limits tell sizes beside which the guess is nothing.
#[test]
fn a_guess_next_to_0_is_nothing_beside_what_equations_tell() {
    from_small_guesses(
        "problem Cart { duration T in 0.1 .. 20; state x, v, a, w; input f in -10 .. 10;
         collocation gauss(points = 3, intervals = 15); minimize T + 0.01 * integral(f^2);
         dynamics { der(x) == v; der(v) == f + 0.3 * sin(a); der(a) == w; der(w) == -9.81 * sin(a) - f * cos(a); }
         initial { x == 0; v == 0; a == 0; w == 0; } final { x == 3; v == 0; a == 0; w == 0; }
         guess { a = GUESS; w = GUESS; v = GUESS; } }",
        2.395_272_485,
        60,
    );
}

/// Four charges on a sphere that begin next to a plane: the tetrahedron (Thomson's problem), `6 / sqrt(8 / 3)`; the square is
/// a saddle. Members that are 6e-17 are rounding of 0.
#[test]
fn charges_beside_a_plane_leave_it() {
    for height in ["0.1", "1e-2", "1e-3", "1e-4", "1e-5"] {
        let report = Shipped::text(&format!(
            "problem Charges {{ const n = 4; duration T = 1; output d: spline(order = 2, intervals = 1); variable p[n, 3];
             minimize sum(i in 1 .. n, sum(j in i + 1 .. n, 1 / norm(p[i] - p[j]))) + integral(der(d)^2);
             initial {{ d == 0; }} final {{ d == 0; }} temporal {{ for i in 1 .. n {{ norm(p[i]) == 1; }} }}
             guess {{ for i in 1 .. n {{ p[i] = (cos(2 * pi * i / n), sin(2 * pi * i / n), {height} * i); }} }} }}"
        ))
        .solve();
        close(report.objective, 6.0 / (8.0_f64 / 3.0).sqrt(), 1e-8);
        assert!(report.iterations < 100, "{height}: {}", report.iterations);
    }
}

/// At rest a limit on a norm has no slope, and tells the size of its vector all the same: a saddle at which nothing moves is left in
/// any unit.
#[test]
fn a_norm_tells_the_size_of_its_vector() {
    for (length, speed) in [("mm", "m/s"), ("m", "m/s"), ("km", "m/s"), ("km", "km/s"), ("Mm", "mm/s")] {
        for limit in ["norm(u) <= 20 [m/s]", "hypot(u[1], u[2]) <= 20 [m/s]", "dot(u, u) <= 400 [m^2/s^2]"] {
            let report = Shipped::text(&format!(
                "problem Away {{
                    duration T = 1 [s];  state x, y [{length}];  input u[2] [{speed}];
                    collocation gauss(points = 3, intervals = 10);
                    maximize final(x^2 + y^2);
                    dynamics {{ der(x) == u[1];  der(y) == u[2]; }}
                    trajectory {{ {limit}; }}
                    initial {{ x == 0;  y == 0; }}
                }}"
            ))
            .solve();
            assert!(report.is_solved(), "{length}, {speed}, {limit}: {report}");
            close(report.objective, 400.0, 1e-4);
        }
    }
}

/// A variable that nobody guesses is as large as what it limits, in any unit: `p in 0 ..` was one unit, and linear programs were
/// infeasible. From rest to rest at least acceleration: 4 d / T^2.
#[test]
fn a_variable_that_limits_an_acceleration_is_as_large() {
    for (length, time, way, duration) in [
        ("m", "s", 1.0, 1.0),
        ("m", "day", 7e6, 30.0),
        ("km", "h", 3000.0, 5.0),
        ("mm", "s", 2.0, 1e-3),
        ("Mm", "min", 1.0, 9.0),
    ] {
        for form in ["p >= der(x, 2);  p + der(x, 2) >= 0", "-p <= der(x, 2) <= p", "abs(der(x, 2)) <= p"] {
            for spline in ["order = 5, intervals = 8, smoothness = 2", "order = 3, intervals = 20"] {
                let report = Shipped::text(&format!(
                    "problem Rest {{
                        duration T = {duration} [{time}];  output x [{length}]: spline({spline});
                        variable p in 0 [{length}/{time}^2] ..;
                        trajectory {{ {form}; }}
                        minimize p / 1 [{length}/{time}^2];
                        initial {{ x == 0;  der(x) == 0; }}
                        final {{ x == {way} [{length}];  der(x) == 0; }}
                    }}"
                ))
                .solve();
                assert!(report.is_solved(), "{length}, {time}, {form}, {spline}: {report}");
                // A curve that must bend within an interval needs more.
                let least = 4.0 * way / (duration * duration);
                let is_known = report.objective > (1.0 - 1e-6) * least && report.objective < 1.1 * least;
                assert!(is_known, "{length}, {time}, {form}, {spline}: {report}");
            }
        }
    }
}

/// The shortest way over a corner, in any unit of length and of time: the helper of the norm has the size of the way.
#[test]
fn a_distance_that_is_minimised_has_its_own_size() {
    for (metre, second) in [(1e-6, 1.0), (1e-3, 1e3), (1.0, 1.0), (1e3, 1.0), (1e5, 1e-2), (1e7, 1e4)] {
        let report = Shipped::text(&format!(
            "problem Way {{
                const L = {metre};
                duration T = {second};
                state x, y;
                input p, q;
                collocation gauss(points = 3, intervals = 12);
                dynamics {{ der(x) == p;  der(y) == q; }}
                initial {{ x == 0;  y == 0; }}
                at T / 2 {{ x == 0;  y == 8 * L; }}
                final {{ x == 6 * L;  y == 8 * L; }}
                minimize integral(norm((p, q)));
            }}"
        ))
        .solve();
        close(report.objective, 14.0 * metre, 1e-6);
        assert!(report.iterations <= 60, "{metre} {second}\n{report}");
    }
}

/// A cantilever under its own weight: `q L^4 / (8 E I)` at its end, and as an energy `q^2 L^5 / (40 E I)`.
#[test]
fn what_only_the_objective_decides_has_the_size_of_its_minimum() {
    for (unit, metres) in [("m", 1.0), ("mm", 1e-3), ("nm", 1e-9), ("Mm", 1e6)] {
        for states in [false, true] {
            let (declared, dynamics, bend) = match states {
                false => ("output w [m]: spline(order = 5, intervals = 2, smoothness = 3);", "", "der(w, 2)"),
                true => (
                    "state w [m], slope [1];  input bend [1/m];",
                    "dynamics { der(w) == slope;  der(slope) == bend; }",
                    "bend",
                ),
            };
            let slope = if states { "slope" } else { "der(w)" };
            let report = Shipped::text(&format!(
                "problem Beam {{
                    domain s [{unit}];
                    duration L = 0.42 [{unit}];
                    {declared}
                    collocation gauss(points = 4, intervals = 2);
                    minimize integral(3.07 [N*m^2] / 2 * {bend}^2) - integral(0.0144 [N/m] * w);
                    {dynamics}
                    initial {{ w == 0;  {slope} == 0; }}
                }}"
            ))
            .solve();
            let length: f64 = 0.42 * metres;
            close(report.objective, -(0.0144_f64.powi(2) * length.powi(5) / (40.0 * 3.07)), 1e-6);
            let end = report.solution.output("w").expect("an output").at(length);
            close(end, 0.0144 * length.powi(4) / (8.0 * 3.07), 1e-6);
        }
    }
}

/// A battery earns `5 - (-1) + 4 - 2` from a guess that is far beyond its limits.
#[test]
fn a_guess_beyond_its_bounds_is_no_size() {
    for guess in [0.0, 1.0, 9.0, 1e2, 1e5, 1e9, -1e5] {
        let report = Shipped::text(&format!(
            "problem Storage {{
                duration T = 4;
                state E in 0 .. 1;
                input charge in 0 .. 1: held;
                input sell in 0 .. 1: held;
                collocation gauss(points = 2, intervals = 4);
                let price = if t <= 1 {{ -1 }} else if t <= 2 {{ 5 }} else if t <= 3 {{ 2 }} else {{ 4 }};
                maximize integral(price * (sell - charge));
                dynamics {{ der(E) == charge - sell; }}
                initial {{ E == 0; }}
                final {{ E == 0; }}
                guess {{ charge = {guess:e}; }}
            }}"
        ))
        .solve();
        close(report.objective, 8.0, 1e-7);
    }
}
