//! What the derivatives of a solution by all its parameters cost beside the solve that found it, for the shipped specs.
//!
//! Run with `cargo run --release -p ntg-benches --example sensitivities [SPEC ...]`; prints medians of the turns. The form
//! in which parameters are variables is made once a program, before anything is timed.

use std::path::Path;
use std::time::Instant;

use ntg::prelude::*;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;

const TURNS: usize = 5;
const SPECS: [&str; 18] = [
    "gates",
    "halo_orbit",
    "kinematic_car",
    "launch",
    "low_observable",
    "low_observable_alternation",
    "low_observable_gauss",
    "low_observable_lock_loss",
    "low_observable_phases",
    "missile_boost_coast",
    "missile_intercept",
    "multi_vehicle",
    "multi_vehicle_separated",
    "probe",
    "radar_net",
    "robust",
    "round_the_mast",
    "swarm",
];

struct BesideSpecs;

impl Loader for BesideSpecs {
    fn load(&self, path: &str) -> Result<String, String> {
        let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs").join(path);
        std::fs::read_to_string(&path).map_err(|error| format!("{}: {error}", path.display()))
    }
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("| spec | parameters | a solve, ms | all derivatives, ms | part of a solve |");
    println!("|---|---|---|---|---|");
    let named: Vec<String> = std::env::args().skip(1).collect();
    let names = if named.is_empty() { SPECS.map(str::to_owned).to_vec() } else { named };
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
    let report = solve(&problem, &settings)?;
    let by = match report.sensitivity(&problem) {
        Ok(by) => by,
        Err(error) => {
            println!("| {name} | | | {error} | |");
            return Ok(());
        }
    };
    let (mut solves, mut derivatives) = (vec![], vec![]);
    for _ in 0..TURNS {
        let clock = Instant::now();
        solve(&problem, &settings)?;
        solves.push(clock.elapsed().as_secs_f64());
        let clock = Instant::now();
        report.sensitivity(&problem)?;
        derivatives.push(clock.elapsed().as_secs_f64());
    }
    let (solve, all) = (median(solves), median(derivatives));
    let count = by.parameters().len();
    println!("| {name} | {count} | {:.2} | {:.2} | {:.3} |", 1e3 * solve, 1e3 * all, all / solve);
    Ok(())
}

fn median(mut seconds: Vec<f64>) -> f64 {
    seconds.sort_by(f64::total_cmp);
    seconds[seconds.len() / 2]
}
