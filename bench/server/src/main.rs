//! Answers bench/run's questions, one line of JSON each.
//!
//! ```text
//! {"case": "b1", "by": "ntg", "route": [[-100, -100], [0, -100], [5, -15]], "intervals": 32, "seconds": 0.1, "solves": 5}
//! ```
//!
//! `by` is `ntg`, `ripopt`, or `start` for a description of the program and its first point. `route` is
//! the coarse route in km, by default the spec's own guess; `intervals` are those of every spline.

mod answer;
mod by_ntg;
mod by_ripopt;
mod cases;
mod start;

use answer::Run;
use ntg::prelude::Guess;
use ntg::runtime::problem::WithStructure;
use ntg_bench_program::adapted;
use serde_json::{Value, json};
use std::io::{BufRead, Write};

fn main() -> std::io::Result<()> {
    let mut out = std::io::stdout().lock();
    for line in std::io::stdin().lock().lines() {
        let answer = answer(&line?).unwrap_or_else(|error| json!({ "error": error }));
        writeln!(out, "{answer}")?;
        out.flush()?;
    }
    Ok(())
}

fn answer(line: &str) -> Result<Value, String> {
    let asked: Value = serde_json::from_str(line).map_err(|error| error.to_string())?;
    let name = asked["case"].as_str().ok_or("no case")?;
    let problem = cases::problem(name).ok_or_else(|| format!("there is no case `{name}`"))?;
    let mut problem = WithStructure::new(problem.as_ref());
    if let Some(intervals) = asked["intervals"].as_u64() {
        problem = adapted::with_intervals(&problem, intervals as usize);
    }
    let guess = route(&asked["route"])?.map(|route| Guess::new().route(&["x", "y"], &route));
    let run = Run {
        seconds: asked["seconds"].as_f64().unwrap_or(0.0),
        solves: asked["solves"].as_u64().unwrap_or(1).max(1) as usize,
    };
    match asked["by"].as_str() {
        Some("ntg") => by_ntg::answer(problem, guess.as_ref(), run).map(|answer| answer.json()),
        Some("ripopt") => by_ripopt::answer(&problem, guess.as_ref(), run).map(|answer| answer.json()),
        Some("start") => start::describe(&problem, guess.as_ref()),
        _ => Err("`by` is ntg, ripopt or start".into()),
    }
}

/// Way-points, km.
fn route(asked: &Value) -> Result<Option<Vec<[f64; 2]>>, String> {
    let Some(points) = asked.as_array() else { return Ok(None) };
    let point = |point: &Value| Some([point[0].as_f64()?, point[1].as_f64()?]);
    points.iter().map(point).collect::<Option<Vec<_>>>().map(Some).ok_or_else(|| "a route is pairs of numbers".into())
}
