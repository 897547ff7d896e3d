//! How cost grows with the number of aircraft: 2, 4, 8, 16 and 32 of them, under two rules.
//!
//! Run with `cargo run --release --example fleet_growth`; draws `pictures/fleet_growth.svg`.

#[allow(dead_code, reason = "the examples share their drawing; each uses a part of it")]
#[path = "../examples/drawing/mod.rs"]
mod drawing;

use std::path::Path;
use std::time::Instant;

use drawing::Drawn;
use drawing::growth::{Growth, growth};
use ntg::prelude::*;
use ntg_compiler::{codegen, model::Loader, source::Source};
use ntg_interp::Interpreted;

struct NoTables;

impl Loader for NoTables {
    fn load(&self, path: &str) -> Result<String, String> {
        Err(format!("`{path}` is not needed here"))
    }
}

const SIZES: [u32; 5] = [2, 4, 8, 16, 32];

fn main() -> Drawn {
    println!("                   N variables iter. solve [ms] compile [ms] code [kB]");
    let (free, strike) =
        (include_str!("../specs/multi_vehicle.ntg"), include_str!("../specs/multi_vehicle_simultaneous.ntg"));
    let free = measure("each on its own", free, &SIZES, |n| 2.0 / f64::from(n))?;
    let strike = measure("all at one time", strike, &SIZES, |n| 2.0 / f64::from(n))?;
    measure("5 km apart", include_str!("../specs/multi_vehicle_separated.ntg"), &SIZES[..3], |_| 1.0)?;
    growth(Path::new("pictures/fleet_growth.svg"), &[free, strike])
}

/// Prints a line a size. The spread may crowd many aircraft, so that they fly the routes of few.
fn measure(rule: &'static str, text: &str, sizes: &[u32], spread: fn(u32) -> f64) -> Drawn<Growth> {
    let mut found = vec![];
    for n in sizes {
        let source = Source::new("fleet.ntg", text.replace("const N = 4;", &format!("const N = {n};")));
        let began = Instant::now();
        let program = ntg_compiler::compile(&source, &NoTables).map_err(|_| "a good spec")?.program;
        let mut problem = Interpreted::new(&program);
        problem.set("spread", &[spread(*n)])?;
        let compile = 1e3 * began.elapsed().as_secs_f64();
        let code = 1e-3 * codegen::generate(&program).to_string().len() as f64;
        // The least of three: the others met something else on the machine.
        let runs = (0..3).map(|_| solve(&problem, &Settings::default())).collect::<Result<Vec<_>, _>>()?;
        let report = runs.into_iter().min_by(|a, b| a.seconds.total_cmp(&b.seconds)).ok_or("no run")?;
        if !report.is_solved() {
            return Err(format!("{rule}, {n} aircraft: {}", report.status).into());
        }
        let (solve, variables) = (1e3 * report.seconds, report.solution.coefficients().len());
        println!("{rule:>16} {n:>3} {variables:>9} {:>5} {solve:>10.1} {compile:>12.1} {code:>9.1}", report.iterations);
        found.push((f64::from(*n), solve));
    }
    Ok(Growth { rule, found })
}
