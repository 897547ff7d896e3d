//! Two problems on meshes of up to 100 000 intervals, beside what a processor and a graphics card are published to take.
//!
//! Run with `cargo run --release -p ntg-benches --example fine_meshes [N ...]`; prints the tables of `docs/performance.md`,
//! section "Fine meshes". Generated code on one core, on the processor. "Kept" is a solve by a solver that is kept, and
//! "first" one that transcribes the spec, analyses its matrix and plans its finer grid as well. Both hold the check between
//! the points, and the report.
//!
//! Source of the published times: arXiv 2510.03932, `code/gpu-test.jl` of control-toolbox/OC-GPU-paper (commit 20a4f0e):
//! MadNLP with ExaModels, tolerance 1e-7; MUMPS on the processor, cuDSS on an H100. They leave out modelling.

mod timing;

use cpu_time::ThreadTime;
use ntg::prelude::*;
use ntg::runtime::problem::WithStructure;
use timing::{median, milliseconds};

mod specs {
    pub(crate) mod goddard {
        ntg::ntg_file!("../bench/growth/goddard.ntg");
    }
    pub(crate) mod quadrotor {
        ntg::ntg_file!("../bench/growth/quadrotor.ntg");
    }
}

/// Both kinds of solve are timed for so many seconds in all, and at least three times.
const SECONDS: f64 = 2.0;
const TURNS: usize = 3;

/// Intervals, and published milliseconds on the processor and on an H100.
type Published = (usize, f64, f64);
const GODDARD: [Published; 10] = [
    (100, 7.738, 107.823),
    (200, 15.637, 115.552),
    (500, 39.242, 148.288),
    (750, 58.258, 142.089),
    (1000, 76.186, 160.535),
    (2000, 168.722, 206.995),
    (5000, 443.280, 382.383),
    (7500, 654.841, 549.268),
    (10_000, 920.491, 722.610),
    (20_000, 2004.0, 1118.048),
];
const QUADROTOR: [Published; 10] = [
    (100, 11.405, 58.282),
    (200, 17.899, 63.167),
    (500, 97.482, 98.962),
    (750, 148.847, 116.741),
    (1000, 203.412, 132.041),
    (2000, 434.968, 199.469),
    (5000, 1174.0, 319.701),
    (7500, 1842.0, 443.139),
    (10_000, 2516.0, 597.242),
    (20_000, 5420.0, 1171.388),
];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let only: Vec<usize> = std::env::args().skip(1).map(|size| size.parse()).collect::<Result<_, _>>()?;
    table("Goddard", &specs::goddard::Goddard::default(), &GODDARD, &only)?;
    table("quadrotor", &specs::quadrotor::Quadrotor::default(), &QUADROTOR, &only)?;
    Ok(())
}

fn table(name: &str, problem: &dyn Problem, published: &[Published], only: &[usize]) -> Result<(), Error> {
    println!("| {name}, intervals | iterations | kept, ms | exponent | first, ms | published: CPU, ms | H100, ms |");
    println!("|---|---|---|---|---|---|---|");
    let mut last: Option<(f64, f64)> = None;
    for (n, cpu, card) in published.iter().filter(|(n, ..)| only.is_empty() || only.contains(n)) {
        let (iterations, kept, first) = times(&on_mesh(problem, *n))?;
        let size = *n as f64;
        let exponent =
            last.map_or(String::new(), |(m, before)| format!("{:.2}", (kept / before).ln() / (size / m).ln()));
        println!("| {n} | {iterations} | {kept:.2} | {exponent} | {first:.2} | {cpu:.1} | {card:.1} |");
        last = Some((size, kept));
    }
    println!();
    Ok(())
}

/// The problem on `n` intervals.
fn on_mesh(problem: &dyn Problem, n: usize) -> WithStructure<'_> {
    WithStructure::new(problem).edited(|structure| {
        let breakpoints: Vec<f64> = (0..=n).map(|i| i as f64 / n as f64).collect();
        for output in &mut structure.phases[0].outputs {
            output.spline.breakpoints.clone_from(&breakpoints);
        }
    })
}

/// Iterations, and milliseconds of a kept and of a first solve.
fn times(problem: &WithStructure<'_>) -> Result<(usize, f64, f64), Error> {
    let settings = Settings { tolerance: 1e-7, ..Settings::default() };
    let mut solver = Solver::new(problem.clone(), &settings);
    let report = solver.solve()?;
    assert!(report.status.is_solved(), "{}", report.status);
    let (mut kept, mut first) = (vec![], vec![]);
    let began = ThreadTime::now();
    while began.elapsed().as_secs_f64() < SECONDS || kept.len() < TURNS {
        kept.push(milliseconds(|| solver.solve().map(drop))?);
        first.push(milliseconds(|| solve(problem, &settings).map(drop))?);
    }
    Ok((report.iterations, median(kept), median(first)))
}
