//! Where the time of an iteration goes: the flight without a limit (B1) with 8 to 512 intervals, from near its
//! solution, on a solver that is kept.
//!
//! Run with `cargo run --release --bin iteration`; prints the table of `docs/performance.md`.

use std::time::Instant;

use ntg::prelude::*;
use ntg::runtime::guess::Guess;
use ntg::runtime::nlp::Nlp;
use ntg::runtime::problem::WithStructure;
use ntg::runtime::structure::Points;
use ntg::runtime::transcribe::Transcription;

ntg::ntg_file!("../specs/low_observable.ntg");

/// Points for each interval, but for the last one's end.
const POINTS: usize = 5;

fn main() -> Result<(), Error> {
    println!("| l | points | variables | iterations | before and after, µs | an iteration, µs | evaluation, µs |");
    println!("|---|---|---|---|---|---|---|");
    let flight = LowObservable { signature_max: 7.0, ..LowObservable::default() };
    for l in [8, 16, 32, 64, 128, 256, 512] {
        row(&flight, l)?;
    }
    Ok(())
}

fn row(flight: &LowObservable, l: usize) -> Result<(), Error> {
    let problem = WithStructure::new(flight).edited(|structure| {
        structure.continuations.clear();
        let phase = &mut structure.phases[0];
        phase.points = vec![Points::Uniform { points: POINTS * l + 1 }];
        for output in &mut phase.outputs {
            output.spline.breakpoints = (0..=l).map(|i| i as f64 / l as f64).collect();
        }
    });
    // Near the solution nothing but the interior-point method itself runs: no coarser knots, no other method.
    let settings = Settings { method: Method::InteriorPoint, ..Settings::default() };
    let solution = solve(&problem, &Settings::default())?.solution;
    let near = Guess::from(&solution);
    let mut solver = Solver::new(problem.clone(), &settings);
    let (all, iterations) = least(l, || solver.solve_from(&near).map(|report| report.iterations))?;
    solver.settings.max_iterations = 1;
    let (one, _) = least(l, || solver.solve_from(&near).map(|report| report.iterations))?;

    let nlp = Transcription::new(&problem).map_err(Error::from)?;
    let (mut work, mut out) = nlp.workspace();
    let (x, multipliers) = (solution.coefficients(), vec![1.0; nlp.rows()]);
    let (evaluation, _) = least(l, || {
        let finite = nlp.derivatives(x, 1.0, &multipliers, &mut work, &mut out);
        Ok(usize::from(finite.is_ok()))
    })?;
    let each = (all - one) / (iterations - 1) as f64;
    let (points, n, rest) = (POINTS * l + 1, x.len(), one - each);
    println!("| {l} | {points} | {n} | {iterations} | {rest:.0} | {each:.1} | {evaluation:.1} |");
    Ok(())
}

/// The least time in microseconds of many runs, and the result of the last.
fn least(l: usize, mut run: impl FnMut() -> Result<usize, Error>) -> Result<(f64, usize), Error> {
    let (mut least, mut result) = (f64::INFINITY, 0);
    for _ in 0..(20_000 / l).max(50) {
        let began = Instant::now();
        result = run()?;
        least = least.min(1e6 * began.elapsed().as_secs_f64());
    }
    Ok((least, result))
}
