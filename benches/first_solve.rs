//! What a first solve costs beside one by a solver that is kept: transcription, analysis of the program, and the plan of
//! the finer grid are made once.
//!
//! Run with `cargo run --release -p ntg-benches --example first_solve`; prints the table of `docs/performance.md`. Both are
//! timed by turns, on generated code, on the processor.

mod timing;

use cpu_time::ThreadTime;
use ntg::prelude::*;
use ntg::runtime::problem::WithStructure;
use ntg::runtime::structure::Points;
use timing::{median, milliseconds};

mod specs {
    pub(crate) mod oscillator {
        ntg::ntg_file!("../specs/van_der_pol.ntg");
    }
    pub(crate) mod car {
        ntg::ntg_file!("../specs/kinematic_car.ntg");
    }
    pub(crate) mod flight {
        ntg::ntg_file!("../specs/low_observable.ntg");
    }
    pub(crate) mod phases {
        ntg::ntg_file!("../specs/low_observable_phases.ntg");
    }
    pub(crate) mod fleet {
        ntg::ntg_file!("../specs/multi_vehicle_separated.ntg");
    }
}
use specs::{
    car::KinematicCar, fleet::MultiVehicleSeparated, flight::LowObservable, oscillator::VanDerPol,
    phases::LowObservablePhases,
};

/// Both are timed for so many seconds in all.
const SECONDS: f64 = 1.0;
/// Points for each interval of the flight, but for the last one's end.
const POINTS: usize = 5;

fn main() -> Result<(), Error> {
    println!("| problem | iterations | kept, ms | first, ms | ratio |");
    println!("|---|---|---|---|---|");
    row("van der Pol", &VanDerPol::default())?;
    row("kinematic car", &KinematicCar::default())?;
    let flight = LowObservable { signature_max: 7.0, ..LowObservable::default() };
    for l in [8, 32, 128] {
        row(&format!("flight without a limit (B1), l = {l}"), &refined(&flight, l))?;
    }
    row("flight in two phases (B3)", &LowObservablePhases::default())?;
    row("four aircraft that keep apart", &MultiVehicleSeparated::default())
}

/// The flight without a continuation, on `l` intervals.
fn refined(flight: &LowObservable, l: usize) -> WithStructure<'_> {
    WithStructure::new(flight).edited(|structure| {
        structure.continuations.clear();
        let phase = &mut structure.phases[0];
        phase.points = vec![Points::Uniform { points: POINTS * l + 1 }];
        for output in &mut phase.outputs {
            output.spline.breakpoints = (0..=l).map(|i| i as f64 / l as f64).collect();
        }
    })
}

fn row(name: &str, problem: &dyn Problem) -> Result<(), Error> {
    let (settings, problem) = (Settings::default(), WithStructure::new(problem));
    let mut solver = Solver::new(problem.clone(), &settings);
    let iterations = solver.solve()?.iterations;
    let (mut kept, mut first) = (vec![], vec![]);
    let began = ThreadTime::now();
    while began.elapsed().as_secs_f64() < SECONDS || kept.len() < 5 {
        kept.push(milliseconds(|| solver.solve().map(drop))?);
        first.push(milliseconds(|| solve(&problem, &settings).map(drop))?);
    }
    let (kept, first) = (median(kept), median(first));
    println!("| {name} | {iterations} | {kept:.3} | {first:.3} | {:.2} |", first / kept);
    Ok(())
}
