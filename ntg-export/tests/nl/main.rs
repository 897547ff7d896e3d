//! What is written as .nl is the program that is solved: values, bounds, start, order, and the way back.

mod judged;
mod reader;

use ntg_compiler::Compiled;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_export::Expressions;
use ntg_export::judge::{Point, judge};
use ntg_export::nl::{Files, Order, Solution, SolutionError, write};
use ntg_interp::Interpreted;
use ntg_runtime::guess::start;
use ntg_runtime::nlp::Nlp;
use ntg_runtime::settings::Settings;
use ntg_runtime::status::Bounded;
use ntg_runtime::transcribe::Transcription;
use reader::Nl;
use std::path::{Path, PathBuf};

struct Beside(PathBuf);

impl Loader for Beside {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.0.join(path)).map_err(|error| error.to_string())
    }
}

fn compile(text: &str, folder: &Path) -> Compiled {
    let source = Source::new("test.ntg", text);
    ntg_compiler::compile(&source, &Beside(folder.to_owned()))
        .unwrap_or_else(|found| panic!("{}", found.iter().map(|d| d.render(&source)).collect::<Vec<_>>().join("\n")))
}

/// A program in all its forms.
struct Written {
    files: Files,
    order: Order,
}

fn written(compiled: &Compiled, nlp: &Transcription<'_>, first: &[f64]) -> Written {
    let expressions = Expressions::new(&compiled.program, nlp).expect("can be written");
    let order = Order::of(&expressions);
    Written { files: write(&expressions, &order, first), order }
}

/// Holds the file against the transcription at random points around its start.
fn compare(name: &str, compiled: &Compiled) {
    let problem = Interpreted::new(&compiled.program);
    let nlp = Transcription::new(&problem).expect("transcribes");
    let first = start(&nlp, None).expect("has a start");
    let Written { files, order } = written(compiled, &nlp, &first);
    let nl = Nl::read(&files.nl);
    let sign = if compiled.program.structure.maximize { -1.0 } else { 1.0 };
    let limits = nlp.limits();
    for (at, own) in order.variables.iter().enumerate() {
        assert_eq!((nl.start[at], nl.bounds[at]), (first[*own], (limits.lower[*own], limits.upper[*own])), "{name}");
    }
    for (at, own) in order.rows.iter().enumerate() {
        assert_eq!(nl.row_bounds[at], (limits.row_lower[*own], limits.row_upper[*own]), "{name}");
    }
    assert_eq!(files.col.lines().count(), nlp.variables(), "{name}");
    assert_eq!(files.row.lines().count(), nlp.rows() + 1, "{name}");
    let entries: usize = (0..nlp.rows()).map(|row| nl.variables_of(row).len()).sum();
    assert_eq!(nl.header[6][0], entries, "{name}: the header counts the Jacobian's entries");
    let mut random = fastrand::Rng::with_seed(3);
    let (mut work, mut out) = nlp.workspace();
    let (mut objectives, mut compared) = (vec![], 0);
    for round in 0..4 {
        let moved = |x: &f64| x + 0.03 * f64::from(round) * (random.f64() - 0.5) * if *x == 0.0 { 1.0 } else { *x };
        let x: Vec<f64> = first.iter().map(moved).collect();
        if nlp.values(&x, &mut work, &mut out).is_err() {
            continue;
        }
        compared += 1;
        let placed: Vec<f64> = order.variables.iter().map(|own| x[*own]).collect();
        let (objective, rows) = nl.values(&placed);
        let largest = out.rows.iter().fold(0.0_f64, |most, row| most.max(row.abs()));
        let near = |ours: f64, theirs: f64, size: f64| (ours - theirs).abs() <= 1e-11 * (size + ours.abs());
        objectives.push((sign * out.objective, objective));
        for (at, own) in order.rows.iter().enumerate() {
            let (ours, theirs) = (out.rows[*own], rows[at]);
            assert!(near(ours, theirs, largest), "{name}, {}: {theirs} for {ours}", nlp.row_name(*own));
        }
    }
    assert!(compared > 0, "{name} has a value at its start");
    // At a start the objective may be nothing but rounding.
    let size = objectives.iter().fold(0.0_f64, |most, (ours, _)| most.max(ours.abs()));
    for (ours, theirs) in objectives {
        assert!((ours - theirs).abs() <= 1e-11 * size, "{name}: objective {theirs} for {ours}");
    }
}

#[test]
fn every_spec_is_written_as_it_is_solved() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs");
    let mut count = 0;
    for entry in std::fs::read_dir(&folder).expect("the specs").filter_map(Result::ok) {
        let path = entry.path();
        if path.extension().is_some_and(|extension| extension == "ntg") {
            let text = std::fs::read_to_string(&path).expect("a spec");
            compare(&path.display().to_string(), &compile(&text, &folder));
            count += 1;
        }
    }
    assert!(count > 15, "the specs are where they are looked for");
}

/// Every function of the language, all reductions, and tables of every method inside and outside their range.
#[test]
fn every_operation_is_written() {
    let text = "problem Operations {
        duration T in 1 .. 3 [s];
        output x[1 .. 2]: spline(order = 5, intervals = 3);
        table clamped(a) = monotone { -1: 2;  0: 1;  0.5: 3;  2: 2.5; }
        table onward(a) = bspline(order = 4, extrapolate = linear) { -1: 2;  0: 1;  0.5: 3;  1: 2;  1.5: 4; }
        table flat(a) = linear(extrapolate = linear) { -1: 2;  0: 1;  0.5: 3; }
        table mirrored(a even, b periodic) = bspline(order = 4) {
               0,   1,   2,   3,   4;
            0: 1,   2,   0.5, 1,   1;
            1: 2,   2.5, 1,   0.3, 2;
            2: 0,   1,   2,   0.7, 0;
            3: 1.5, 1,   0.2, 2,   1.5;
        }
        minimize integral(sum(k in 1 .. 2, sqrt(1 + x[k]^2)) + atan2(x[1], 2 + x[2]^2) + hypot(x[1], 1 + x[2])
            + exp(-x[1]) + log(3 + x[2]^2) + sin(x[1]) * cos(x[2]) + tan(0.1 * x[1]) + asin(0.1 * x[1]) + acos(0.1 * x[2])
            + atan(x[1]) + sinh(x[1]) + cosh(x[2]) + tanh(x[1]) + abs(x[1]) + min(x[1], x[2]) + max(x[1], 2 * x[2])
            + (1 + x[1]^2)^1.5 + x[1]^3 + sign(x[1]) + smooth_max(x[1], x[2], 0.1) + smooth_abs(x[2], 0.2)
            + clamped(x[1]) + clamped(4 * x[2]) + onward(x[1]) + onward(3 * x[2]) + flat(x[1]) + flat(2 * x[2])
            + (if x[1] <= x[2] smooth 3 { sin(x[1]) } else { x[2]^2 }) + min(x[1], 2 * x[2])^2 * (1 + min(x[1], 2 * x[2]))
            + logistic(x[1]) + softplus(x[2]) + mirrored(x[1], 3 * x[2]) + partial(mirrored(x[1], x[2]), a));
        initial { x[1] == 1;  x[2] == -2; }
        trajectory {
            prod(k in 1 .. 2, x[k]) <= 50;
            max(k in 1 .. 2, x[k]) <= 50;
            min(k in 1 .. 2, x[k] + T / 1 [s]) >= -50;
        }
        final { x[1] == -1.5;  x[2] == 2.5; }
    }";
    compare("every operation", &compile(text, Path::new(".")));
}

/// A known optimum goes out and comes back: a solver's file in the file's order is judged in ntg's.
#[test]
fn a_solution_is_read_back_in_order_and_judged() {
    let text = "problem Move {
        duration T = 2 [s];
        output x [m]: spline(order = 6, intervals = 2);
        minimize integral(der(x, 2)^2);
        initial { x == 0;  der(x) == 0; }
        final { reach: x == 3 [m];  der(x) == 0; }
    }";
    let compiled = compile(text, Path::new("."));
    let problem = Interpreted::new(&compiled.program);
    let mut nlp = Transcription::new(&problem).expect("transcribes");
    let first = start(&nlp, None).expect("has a start");
    nlp.set_scales(&first, &Settings::default()).expect("sizes");
    let order = written(&compiled, &nlp, &first).order;
    let solved = ntg_runtime::solve(&problem, &Settings::default()).expect("solves");
    let x = start(&nlp, Some(&(&solved.solution).into())).expect("a start");
    // The cost is 12 d^2 / T^3: its derivatives by the four boundary values are closed forms.
    let multipliers = [3.0 * -9.0 / 3.0, -9.0, 9.0, -9.0];
    let own = Solution { message: "found".into(), x: x.clone(), multipliers: Some(multipliers.to_vec()) };
    let read = Solution::read(&own.text(&order), &order).expect("what was written can be read");
    assert_eq!(read, own);
    let judged = judge(&nlp, Point { x: &read.x, multipliers: read.multipliers.as_deref() }).expect("finite");
    assert!((judged.objective - 13.5).abs() < 1e-9 && judged.violation() < 1e-10, "{judged:?}");
    let [stationarity, complementarity] = judged.optimality.expect("there are multipliers");
    assert!(stationarity.relative < 1e-9 && complementarity.absolute < 1e-9, "{stationarity:?} {complementarity:?}");
    // Another point is no solution, and the row that is missed is named.
    let moved: Vec<f64> = read.x.iter().map(|x| x + 0.1).collect();
    let judged = judge(&nlp, Point { x: &moved, multipliers: read.multipliers.as_deref() }).expect("finite");
    let is_reach = |of| matches!(of, Bounded::Row(row) if nlp.row_name(row).starts_with("`reach`"));
    assert!(judged.missed.iter().any(|missed| is_reach(missed.of)), "{judged:?}");
    assert!(Solution::read("found\n\nOptions\n0\n1\n1\n1\n1\n", &order).is_err());
    // Behind the values stand the number of the objective and suffixes, as IPOPT writes them, and nothing else.
    let text = own.text(&order);
    let suffixes = "suffix 4 2 14 0 0\nipopt_zL_out\n0 0.5\n3 -1e-9\nsuffix 4 1 5 7 1\nname\n1 a b\n0 1\n\n";
    assert_eq!(Solution::read(&format!("{text}{suffixes}"), &order), Ok(own));
    let lines = text.lines().count();
    for (behind, line, expected) in [
        ("rubbish\n", 1, "`objno`, a suffix or the end"),
        ("objno 0 0 rubbish\n", 1, "`objno`, a suffix or the end"),
        ("suffix 4 many 14 0 0\n", 1, "`objno`, a suffix or the end"),
        ("suffix 4 1 14 0 0\nname\nrubbish\n", 3, "a place and a value of a suffix"),
        ("suffix 4 1 14 0 0\nname\n", 3, "a place and a value of a suffix"),
    ] {
        let refused = Solution::read(&format!("{text}{behind}"), &order);
        assert_eq!(refused, Err(SolutionError::Line(lines + line, expected)), "{behind}");
    }
}
