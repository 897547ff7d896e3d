//! How cost grows with what there is more than one of: vehicles that keep apart, scenarios that share an input, phases,
//! nodes of a table, terms of a sum.
//!
//! `bench/growth/run` prints all tables; `cargo run --release -p ntg-benches --example growth -- vehicles 2 4 8` prints one,
//! for sizes of one's own. Time is that of the processor, so that other work on the machine matters little.

use std::hint::black_box;
use std::time::Instant;

use ntg::prelude::*;
use ntg_compiler::{model::Loader, source::Source};
use ntg_interp::Interpreted;
use ntg_splines::{Axis, Extrapolation, Method as Interpolation, Table};

type Fallible<T> = Result<T, Box<dyn std::error::Error>>;

/// The iterations of a timed solve; one of a single iteration costs everything else that a solve does.
const ITERATIONS: usize = 7;
/// Everything is repeated for so many seconds on the processor, whose clock may tick every hundredth.
const SECONDS: f64 = 0.5;

/// One thing that grows: its name, its unit, its sizes, and how a size is measured.
struct Kind {
    name: &'static str,
    what: &'static str,
    unit: &'static str,
    sizes: &'static [usize],
    measure: fn(usize) -> Fallible<f64>,
}

const KINDS: &[Kind] = &[
    Kind {
        name: "vehicles",
        what: "vehicles on one clock that keep apart in pairs, one iteration",
        unit: "ms",
        sizes: &[2, 4, 8, 16, 32, 64],
        measure: |n| iteration(include_str!("../specs/swarm.ntg"), "const n = 4;", &format!("const n = {n};")),
    },
    Kind {
        name: "scenarios",
        what: "scenarios that share an input, one iteration",
        unit: "ms",
        sizes: &[4, 16, 64, 256],
        measure: |n| {
            iteration(include_str!("../bench/growth/scenarios.ntg"), "const N = 4;", &format!("const N = {n};"))
        },
    },
    Kind {
        name: "phases",
        what: "phases with durations of their own, one iteration",
        unit: "ms",
        sizes: &[5, 10, 20, 40, 100],
        measure: |n| iteration(include_str!("../bench/growth/phases.ntg"), "const N = 5;", &format!("const N = {n};")),
    },
    Kind {
        name: "monotone",
        what: "nodes along each argument of a `monotone` table, one look-up with first and second derivatives",
        unit: "ns",
        sizes: &[60, 200, 500],
        measure: |n| look_up(n, Interpolation::Monotone),
    },
    Kind {
        name: "bspline",
        what: "the same, `bspline`",
        unit: "ns",
        sizes: &[60, 200, 500],
        measure: |n| look_up(n, Interpolation::Bspline { order: 4 }),
    },
    Kind {
        name: "table",
        what: "nodes along each argument of a `bspline` table, compiling a spec",
        unit: "ms",
        sizes: &[60, 200, 500],
        measure: |n| compile(&table(n, "bspline")),
    },
    Kind {
        name: "monotone-table",
        what: "nodes along each argument of a `monotone` table, compiling a spec",
        unit: "ms",
        sizes: &[60, 200, 500],
        measure: |n| compile(&table(n, "monotone")),
    },
    Kind {
        name: "sum",
        what: "terms of a sum, compiling a spec",
        unit: "ms",
        sizes: &[25_000, 50_000, 100_000, 200_000],
        measure: |n| compile(&sum(n)),
    },
];

fn main() -> Fallible<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let Some((name, sizes)) = arguments.split_first() else {
        KINDS.iter().for_each(|kind| println!("{}", kind.name));
        return Ok(());
    };
    let kind = KINDS.iter().find(|kind| kind.name == name).ok_or_else(|| format!("`{name}` is none of the tables"))?;
    let sizes: Vec<usize> = sizes.iter().map(|size| size.parse()).collect::<Result<_, _>>()?;
    let sizes = if sizes.is_empty() { kind.sizes } else { &sizes };
    println!("| {} | {} | exponent | peak memory, MB |", kind.what, kind.unit);
    println!("|---|---|---|---|");
    let mut last: Option<(f64, f64)> = None;
    for &size in sizes {
        let (time, n) = ((kind.measure)(size)?, size as f64);
        let exponent = last.map_or(String::new(), |(m, before)| format!("{:.2}", (time / before).ln() / (n / m).ln()));
        println!("| {size} | {time:.3} | {exponent} | {} |", peak_memory());
        last = Some((n, time));
    }
    Ok(())
}

/// Milliseconds of one iteration, on a solver that is kept.
fn iteration(text: &str, before: &str, after: &str) -> Fallible<f64> {
    let source = Source::new("growth.ntg", text.replace(before, after));
    let program = ntg_compiler::compile(&source, &NoFiles).map_err(|_| "the spec does not compile")?.program;
    let problem = Interpreted::new(&program);
    let settings = Settings { method: Method::InteriorPoint, ..Settings::default() };
    let mut solver = Solver::new(problem, &settings);
    let mut run = |iterations: usize| -> Fallible<(f64, usize)> {
        solver.settings.max_iterations = iterations;
        let last = solver.solve()?.iterations;
        Ok((each(|| solver.solve().map(drop))?, last))
    };
    let (one, first) = run(1)?;
    let (all, last) = run(ITERATIONS)?;
    Ok(1e3 * (all - one) / (last - first) as f64)
}

/// Nanoseconds of a look-up in a table of `n` by `n` nodes, along a path across it.
fn look_up(n: usize, method: Interpolation) -> Fallible<f64> {
    let nodes: Vec<f64> = (0..n).map(|i| 10.0 * i as f64 / (n - 1) as f64).collect();
    let values = nodes.iter().flat_map(|x| nodes.iter().map(|y| height(*x, *y)));
    let axes = vec![Axis::plain(nodes.clone()), Axis::plain(nodes.clone())];
    let table = Table::new(axes, values.collect(), method, Extrapolation::Clamp).map_err(|error| error.to_string())?;
    let path: Vec<[f64; 2]> =
        (0..1000).map(|i| [0.01 * f64::from(i), 5.0 + 4.9 * (0.01 * f64::from(i)).sin()]).collect();
    let seconds = each(|| {
        for place in &path {
            for order in [[0, 0], [1, 0], [0, 1], [2, 0], [1, 1], [0, 2]] {
                black_box(table.eval(black_box(place), &order));
            }
        }
        Ok::<(), Error>(())
    })?;
    Ok(1e9 * seconds / path.len() as f64)
}

/// Milliseconds of compiling a spec.
fn compile(text: &str) -> Fallible<f64> {
    let source = Source::new("growth.ntg", text.to_owned());
    let compiled = || ntg_compiler::compile(&source, &NoFiles).map_err(|_| "the spec does not compile");
    Ok(1e3 * each(|| compiled().map(|compiled| drop(black_box(compiled))))?)
}

/// The seconds that one run takes, the mean of as many as [`SECONDS`] allow.
fn each<E: Into<Box<dyn std::error::Error>>>(mut run: impl FnMut() -> Result<(), E>) -> Fallible<f64> {
    let (began, mut runs) = (processor_seconds(), 0_u32);
    loop {
        if let Err(error) = run() {
            return Err(error.into());
        }
        runs += 1;
        let spent = processor_seconds() - began;
        if spent >= SECONDS {
            return Ok(spent / f64::from(runs));
        }
    }
}

/// Hills.
fn height(x: f64, y: f64) -> f64 {
    x.sin() * (0.7 * y).cos() + 0.05 * x * y + 0.1 * (3.0 * x + y).sin()
}

/// A spec with a table of `n` by `n` nodes.
fn table(n: usize, method: &str) -> String {
    let nodes: Vec<f64> = (0..n).map(|i| 10.0 * i as f64 / (n - 1) as f64).collect();
    let list = |values: &mut dyn Iterator<Item = f64>| {
        values.map(|value| format!("{value:.8}")).collect::<Vec<_>>().join(", ")
    };
    let row = |x: &f64| format!("{x:.8}: {};", list(&mut nodes.iter().map(|y| height(*x, *y))));
    let rows: Vec<String> = nodes.iter().map(row).collect();
    let nodes = list(&mut nodes.iter().copied());
    format!(
        "problem Terrain {{\n duration T = 1;\n output x: spline(order = 5, intervals = 4);\n \
         table h(x, y) = {method} {{\n{nodes};\n{}\n}}\n minimize integral(h(x, 1 + x) + der(x)^2);\n}}\n",
        rows.join("\n")
    )
}

/// A spec with a sum of `n` terms.
fn sum(n: usize) -> String {
    let term = |i: usize| format!("{}*x^{}*{:.6}", i % 7 + 1, i % 3 + 1, 1.0 + 1e-6 * i as f64);
    let terms: Vec<String> = (0..n).map(term).collect();
    format!(
        "problem Sum {{\n duration T = 1;\n output x: spline(order = 5, intervals = 4);\n minimize integral({});\n}}\n",
        terms.join(" + ")
    )
}

/// Seconds that this thread has been on a processor; of the wall where the system does not say.
fn processor_seconds() -> f64 {
    thread_local!(static BEGAN: Instant = Instant::now());
    let on_processor = std::fs::read_to_string("/proc/thread-self/schedstat").ok();
    let nanoseconds = on_processor.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| BEGAN.with(|began| began.elapsed().as_secs_f64()), |ns| 1e-9 * ns)
}

/// The most memory that the process has had, in MB; a dash where the system does not say.
fn peak_memory() -> String {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let peak =
        status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse::<f64>().ok());
    peak.map_or_else(|| "–".to_owned(), |kb| format!("{:.0}", kb / 1024.0))
}

struct NoFiles;

impl Loader for NoFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("`{path}` is not needed here"))
    }
}
