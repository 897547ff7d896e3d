//! What the derivatives of a solution by all its parameters cost beside the solve that found it, for the shipped specs.
//!
//! Run with `cargo run --release -p ntg-benches --example sensitivities [SPEC ...]`; prints medians of the turns, of
//! processor time. "First" makes everything that a kept solver and a kept differentiator have. The form in which parameters
//! are variables is made once a program, before anything is timed. "By one parameter" is by each parameter in turn.

mod timing;

use std::path::{Path, PathBuf};

use cpu_time::ThreadTime;
use ntg::prelude::*;
use ntg::runtime::sensitivity::Differentiator;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use timing::{median, milliseconds};

/// Everything is timed by turns for so many seconds in all, and at least so many times.
const SECONDS: f64 = 1.0;
const TURNS: usize = 5;
struct BesideSpecs;

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

/// The shipped specs by name, whatever there is.
fn shipped() -> Result<Vec<String>, std::io::Error> {
    let files: Result<Vec<_>, _> = std::fs::read_dir(folder())?.collect();
    let paths = files?.into_iter().map(|file| file.path());
    let specs = paths.filter(|path| path.extension().is_some_and(|ending| ending == "ntg"));
    let mut names: Vec<String> = specs.filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned())).collect();
    names.sort();
    Ok(names)
}

impl Loader for BesideSpecs {
    fn load(&self, path: &str) -> Result<String, String> {
        let path = folder().join(path);
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!(
        "| spec | parameters | first solve, ms | all derivatives | part | kept solve, ms | all derivatives | part | by one parameter | part |"
    );
    println!("|---|---|---|---|---|---|---|---|---|---|");
    let named: Vec<String> = std::env::args().skip(1).collect();
    let names = if named.is_empty() { shipped()? } else { named };
    names.iter().try_for_each(|name| row(name))
}

fn row(name: &str) -> Result<(), Box<dyn std::error::Error>> {
    let text = BesideSpecs.load(&format!("{name}.ntg"))?;
    let Ok(compiled) = ntg_compiler::compile(&Source::new(name, text), &BesideSpecs) else {
        return Err(format!("{name} does not compile").into());
    };
    let problem = Interpreted::new(&compiled.program);
    // Points between those of the program cost as much again, and belong to the report.
    let settings = Settings { samples: 1, ..Settings::default() };
    let (mut solver, mut differentiator) = (Solver::new(problem.clone(), &settings), Differentiator::new(&problem));
    let report = solver.solve()?;
    let by = match differentiator.differentiate(&report.solution) {
        Ok(by) => by,
        Err(error) => {
            println!("| {name} | | | {error} | | | | | | |");
            return Ok(());
        }
    };
    let count = by.parameters().len();
    let names: Vec<String> = by.parameters().iter().map(|parameter| parameter.name.clone()).collect();
    let mut each = names.iter().cycle();
    let mut times: [Vec<f64>; 5] = Default::default();
    let began = ThreadTime::now();
    while began.elapsed().as_secs_f64() < SECONDS || times[0].len() < TURNS {
        let [first_solve, first, kept_solve, kept, by_one] = &mut times;
        first_solve.push(milliseconds(|| solve(&problem, &settings))?);
        first.push(milliseconds(|| report.sensitivity(&problem))?);
        kept_solve.push(milliseconds(|| solver.solve())?);
        kept.push(milliseconds(|| differentiator.differentiate(&report.solution))?);
        let one: Vec<&str> = each.next().map(String::as_str).into_iter().collect();
        by_one.push(milliseconds(|| differentiator.differentiate_by(&report.solution, &one))?);
    }
    let [first_solve, first, kept_solve, kept, by_one] = times.map(median);
    println!(
        "| {name} | {count} | {first_solve:.2} | {first:.2} | {:.2} | {kept_solve:.2} | {kept:.2} | {:.2} | {by_one:.2} | {:.2} |",
        first / first_solve,
        kept / kept_solve,
        by_one / kept_solve
    );
    Ok(())
}
