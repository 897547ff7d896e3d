//! `evaluate SPEC < points`: ntg's own numbers, in the order of the .nl file that `ntg export` writes.
//!
//! Takes as many numbers for each point as there are variables, SI. Without points it prints start and bounds first:
//! a line of the start, then for each point one line: objective, gradient, rows, `J`, and the Jacobian's entries as row, column,
//! value. The objective has the user's sense and SI units.

use ntg_bench_program::specs;
use ntg_export::Expressions;
use ntg_export::nl::Order;
use ntg_interp::Interpreted;
use ntg_runtime::guess::start;
use ntg_runtime::nlp::{Assembly, Nlp};
use ntg_runtime::transcribe::Transcription;
use std::io::Read;
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(spec) = std::env::args_os().nth(1) else {
        eprintln!("usage: evaluate SPEC < points");
        return ExitCode::from(2);
    };
    match run(Path::new(&spec)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::FAILURE
        }
    }
}

fn run(spec: &Path) -> Result<(), String> {
    let program = specs::program(spec)?;
    let problem = Interpreted::new(&program);
    let nlp = Transcription::new(&problem).map_err(|error| error.to_string())?;
    let first = start(&nlp, None).map_err(|error| error.to_string())?;
    let order = Order::of(&Expressions::new(&program, &nlp).map_err(|error| error.to_string())?);
    let line = |numbers: &[f64]| numbers.iter().map(|x| format!("{x:?}")).collect::<Vec<_>>().join(" ");
    let sorted = |places: &[usize], own: &[f64]| places.iter().map(|place| own[*place]).collect::<Vec<_>>();
    println!("{}", line(&sorted(&order.variables, &first)));
    let place = |places: &[usize]| {
        let mut inverse = vec![0; places.len()];
        places.iter().enumerate().for_each(|(at, own)| inverse[*own] = at);
        inverse
    };
    let (place_of_row, place_of_variable) = (place(&order.rows), place(&order.variables));
    let mut text = String::new();
    std::io::stdin().read_to_string(&mut text).map_err(|error| error.to_string())?;
    let numbers = text.split_whitespace().map(|word| word.parse().map_err(|_| format!("{word} is no number")));
    let numbers: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let sign = if program.structure.maximize { -1.0 } else { 1.0 };
    let (mut work, mut at) = nlp.workspace();
    let mut assembly = Assembly::new(nlp.variables(), nlp.rows(), nlp.blocks());
    for point in numbers.chunks_exact(nlp.variables().max(1)) {
        let mut x = vec![0.0; point.len()];
        order.variables.iter().zip(point).for_each(|(own, value)| x[*own] = *value);
        let found = nlp.derivatives(&x, 1.0, &vec![0.0; nlp.rows()], &mut work, &mut at);
        if let Err(error) = found {
            println!("not finite: {error}");
            continue;
        }
        assembly.first(nlp.blocks(), &at);
        let gradient: Vec<f64> = sorted(&order.variables, &assembly.gradient).iter().map(|g| sign * g).collect();
        let mut entries = vec![];
        for j in 0..assembly.jacobian.columns() {
            for (i, value) in assembly.jacobian.column(j) {
                entries.push(format!("{} {} {value:?}", place_of_row[i], place_of_variable[j]));
            }
        }
        let rows = sorted(&order.rows, &at.rows);
        println!("{:?} {} {} J {}", sign * at.objective, line(&gradient), line(&rows), entries.join(" "));
    }
    Ok(())
}
