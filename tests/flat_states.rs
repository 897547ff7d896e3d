//! The law of flat outputs and states: one problem has one optimum, whether it is written by flat outputs, from whose
//! derivatives everything follows, or by states of first order and their equations.
//!
//! The two are different programs with different splines, so that their optima differ by the errors of two discretisations.
//! These are measured and not guessed: halving the intervals changes each optimum by at least as much as the error that is
//! left, for errors that fall at least like the length of an interval. So on the finer mesh the two differ by no more than
//! the sum of the two changes. Pairs whose two programs have the same optimum on every mesh are held to rounding: by states
//! of three points, velocities are the same cubics as by a flat output of order 5 with smoothness 2, and Gauss points
//! integrate them exactly, so that positions agree at the knots.

use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use ntg_runtime::report::Report;
use ntg_runtime::settings::Settings;
use rayon::prelude::*;

/// What the tolerance of the solver leaves of an optimum, relative.
const ROUNDING: f64 = 1e-7;
/// The most that halving may change an optimum, relative; with more the mesh would be too coarse to say anything.
const FINE: f64 = 5e-3;

/// One problem in two forms; `INTERVALS` in their texts is a number.
struct Pair {
    name: &'static str,
    /// Intervals of the coarser mesh.
    intervals: usize,
    /// Whether the two programs have the same optimum on every mesh.
    is_exact: bool,
    flat: &'static str,
    states: &'static str,
}

const PAIRS: [Pair; 8] = [
    Pair {
        name: "from rest to rest with the least energy",
        intervals: 8,
        is_exact: true,
        flat: "duration T = 1;
            output x: spline(order = 5, intervals = INTERVALS, smoothness = 2);
            collocation gauss(points = 3);
            minimize integral(der(x, 2)^2);
            initial { x == 0;  der(x) == 0; }
            final { x == 1;  der(x) == 0; }",
        states: "duration T = 1;
            state x, v;
            input u;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize integral(u^2);
            dynamics { der(x) == v;  der(v) == u; }
            initial { x == 0;  v == 0; }
            final { x == 1;  v == 0; }",
    },
    Pair {
        name: "least time with limited speed and acceleration",
        intervals: 8,
        is_exact: true,
        flat: "duration T in 0.1 .. 100;
            output x: spline(order = 5, intervals = INTERVALS, smoothness = 2);
            collocation gauss(points = 3);
            minimize T;
            initial { x == 0;  der(x) == 0; }
            trajectory { der(x, 2) in -1 .. 1;  der(x) <= 1.2; }
            final { x == 3;  der(x) == 0; }",
        states: "duration T in 0.1 .. 100;
            state x, v in .. 1.2;
            input u in -1 .. 1;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize T;
            dynamics { der(x) == v;  der(v) == u; }
            initial { x == 0;  v == 0; }
            final { x == 3;  v == 0; }",
    },
    Pair {
        name: "Bryson and Denham",
        intervals: 20,
        is_exact: false,
        flat: "duration T = 1;
            output x: spline(order = 5, intervals = INTERVALS, smoothness = 2);
            collocation gauss(points = 3);
            minimize 0.5 * integral(der(x, 2)^2);
            initial { x == 0;  der(x) == 1; }
            trajectory { x <= 1 / 9; }
            final { x == 0;  der(x) == -1; }",
        states: "duration T = 1;
            state x in .. 1 / 9, v;
            input u;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize 0.5 * integral(u^2);
            dynamics { der(x) == v;  der(v) == u; }
            initial { x == 0;  v == 1; }
            final { x == 0;  v == -1; }",
    },
    Pair {
        name: "van der Pol with a limited input",
        intervals: 20,
        is_exact: false,
        flat: "duration T = 5;
            output z: spline(order = 5, intervals = INTERVALS, smoothness = 2);
            collocation gauss(points = 3);
            let u = der(z, 2) + z - (1 - z^2) * der(z);
            minimize integral(0.5 * (z^2 + der(z)^2 + u^2));
            initial { z == 1;  der(z) == 0; }
            trajectory { u >= -0.6; }
            final { der(z) - z == 1; }",
        states: "duration T = 5;
            state z, v;
            input u in -0.6 ..;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize integral(0.5 * (z^2 + v^2 + u^2));
            dynamics { der(z) == v;  der(v) == u - z + (1 - z^2) * v; }
            initial { z == 1;  v == 0; }
            final { v - z == 1; }",
    },
    Pair {
        name: "a car changes lane",
        intervals: 10,
        is_exact: false,
        flat: "duration T = 5;
            output x, y: spline(order = 5, intervals = INTERVALS, smoothness = 2);
            collocation gauss(points = 3);
            minimize integral(der(x, 2)^2 + der(y, 2)^2);
            initial { x == 0;  y == -2;  der(x) == 8;  der(y) == 0; }
            final { x == 40;  y == 2;  der(x) == 8;  der(y) == 0; }",
        states: "duration T = 5;
            state x, y, heading, speed;
            input rate, push;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize integral(push^2 + (speed * rate)^2);
            dynamics {
                der(x) == speed * cos(heading);
                der(y) == speed * sin(heading);
                der(heading) == rate;
                der(speed) == push;
            }
            initial { x == 0;  y == -2;  heading == 0;  speed == 8; }
            final { x == 40;  y == 2;  heading == 0;  speed == 8; }
            guess { speed = 8; }",
    },
    Pair {
        name: "a crane moves its load",
        intervals: 12,
        is_exact: false,
        flat: "duration T = 6;
            output y: spline(order = 7, intervals = INTERVALS, smoothness = 4);
            collocation gauss(points = 3);
            let trolley = y + 0.4 * der(y, 2);
            minimize integral(der(trolley, 2)^2);
            initial { y == 0;  der(y) == 0;  der(y, 2) == 0;  der(y, 3) == 0; }
            trajectory { der(trolley) <= 0.9; }
            final { y == 4;  der(y) == 0;  der(y, 2) == 0;  der(y, 3) == 0; }",
        states: "duration T = 6;
            state trolley, speed in .. 0.9, load, pace;
            input push;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize integral(push^2);
            dynamics {
                der(trolley) == speed;
                der(speed) == push;
                der(load) == pace;
                der(pace) == (trolley - load) / 0.4;
            }
            initial { trolley == 0;  speed == 0;  load == 0;  pace == 0; }
            final { trolley == 4;  speed == 0;  load == 4;  pace == 0; }",
    },
    Pair {
        name: "an arm of two links",
        intervals: 8,
        is_exact: false,
        flat: "duration T = 2;
            output a, b: spline(order = 5, intervals = INTERVALS, smoothness = 2);
            collocation gauss(points = 3);
            let turn = (3 + 2 * cos(b)) * der(a, 2) + (1 + cos(b)) * der(b, 2)
                - sin(b) * der(b) * (2 * der(a) + der(b));
            let bend = (1 + cos(b)) * der(a, 2) + der(b, 2) + sin(b) * der(a)^2;
            minimize integral(turn^2 + bend^2);
            initial { a == 0;  b == 0;  der(a) == 0;  der(b) == 0; }
            final { a == 1;  b == 1.5;  der(a) == 0;  der(b) == 0; }
            guess { a = tau^2 * (3 - 2 * tau);  b = 1.5 * tau^2 * (3 - 2 * tau); }",
        states: "duration T = 2;
            state a, b, da, db;
            input turn, bend;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize integral(turn^2 + bend^2);
            dynamics {
                der(a) == da;
                der(b) == db;
                (3 + 2 * cos(b)) * der(da) + (1 + cos(b)) * der(db) - sin(b) * db * (2 * da + db) == turn;
                (1 + cos(b)) * der(da) + der(db) + sin(b) * da^2 == bend;
            }
            initial { a == 0;  b == 0;  da == 0;  db == 0; }
            final { a == 1;  b == 1.5;  da == 0;  db == 0; }
            guess { a = tau^2 * (3 - 2 * tau);  b = 1.5 * tau^2 * (3 - 2 * tau); }",
    },
    Pair {
        name: "a boat passes an island in the least time",
        intervals: 16,
        is_exact: false,
        flat: "duration T in 1 .. 60;
            output x, y: spline(order = 5, intervals = INTERVALS, smoothness = 2);
            collocation gauss(points = 3);
            minimize T;
            initial { x == 0;  y == 0;  der(x) == 0;  der(y) == 0; }
            trajectory { (x - 4)^2 + (y - 0.5)^2 >= 1.5;  der(x, 2)^2 + der(y, 2)^2 <= 1; }
            final { x == 8;  y == 0;  der(x) == 0;  der(y) == 0; }
            guess { (x, y) through (0, 0), (4, -2), (8, 0);  T = 8; }",
        states: "duration T in 1 .. 60;
            state x, y, u, v;
            input f, g;
            collocation gauss(points = 3, intervals = INTERVALS);
            minimize T;
            dynamics { der(x) == u;  der(y) == v;  der(u) == f;  der(v) == g; }
            initial { x == 0;  y == 0;  u == 0;  v == 0; }
            trajectory { (x - 4)^2 + (y - 0.5)^2 >= 1.5;  f^2 + g^2 <= 1; }
            final { x == 8;  y == 0;  u == 0;  v == 0; }
            guess { (x, y) through (0, 0), (4, -2), (8, 0);  T = 8; }",
    },
];

/// There are no files.
struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("{path}: there are no files"))
    }
}

/// Solves a form of a pair on a mesh.
fn solved(name: &str, form: &str, intervals: usize) -> Report {
    let text = format!("problem Pair {{ {} }}", form.replace("INTERVALS", &intervals.to_string()));
    let source = Source::new("pair.ntg", text);
    let compiled = ntg_compiler::compile(&source, &NoFiles).unwrap_or_else(|findings| panic!("{name}: {findings:?}"));
    let report = ntg_runtime::solve(&Interpreted::new(&compiled.program), &Settings::default()).expect("can be set up");
    assert!(report.is_solved(), "{name}, {intervals} intervals: {} after {}", report.status, report.iterations);
    report
}

/// What breaks the law for a pair, if something does.
fn broken(pair: &Pair) -> Option<String> {
    let on_both = |form| [1, 2].map(|times| solved(pair.name, form, times * pair.intervals));
    let ([flat, flat_fine], [states, states_fine]) = (on_both(pair.flat), on_both(pair.states));
    let size = flat_fine.objective.abs();
    let changes = [(&flat, &flat_fine), (&states, &states_fine)].map(|(a, b)| (a.objective - b.objective).abs());
    let tolerance = if pair.is_exact { 0.0 } else { changes[0] + changes[1] };
    let holds = |a: &Report, b: &Report| (a.objective - b.objective).abs() <= tolerance + ROUNDING * size;
    let is_fine = changes.iter().all(|change| *change <= FINE * size);
    let all = [&flat, &flat_fine, &states, &states_fine].map(|report| (report.objective, report.iterations));
    let is_same = holds(&flat_fine, &states_fine) && (!pair.is_exact || holds(&flat, &states));
    (!is_same || !is_fine).then(|| format!("{}: {all:?}, {changes:?}", pair.name))
}

#[test]
fn flat_outputs_and_states_have_one_optimum() {
    let broken: Vec<String> = PAIRS.par_iter().filter_map(broken).collect();
    assert!(broken.is_empty(), "{}", broken.join("\n"));
}
