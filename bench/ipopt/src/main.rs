//! `ipopt-compare`: ntg and IPOPT on the same nonlinear programs from the same starts.
//!
//! ```text
//! ipopt-compare [SPEC or FOLDER ...] --library LIBIPOPT [--json FILE]
//! ```
//!
//! Every spec has a process of its own, which is ended where a solver does not keep its limit.
//! `bench/ipopt/run` installs IPOPT, builds this and runs it.

mod children;
mod library;
mod one;
mod solve;
mod table;
mod trace;

use clap::Parser;
use library::{Ipopt, Value as Setting};
use ntg_bench_program::specs;
use ntg_runtime::settings::Method;
use one::Ask;
use serde_json::{Map, Value, json};
use std::path::PathBuf;
use std::process::ExitCode;

/// ntg and IPOPT on ntg's own nonlinear programs, from ntg's own starts.
///
/// IPOPT has the same elements, bounds, start and variable sizes, exact derivatives, and its defaults but for the
/// tolerance. Without a path all specs below `specs` are compared.
#[derive(Clone, Debug, Parser)]
#[command(name = "ipopt-compare")]
struct Arguments {
    /// Specs, and folders of specs.
    paths: Vec<PathBuf>,
    /// IPOPT's shared library; CasADi's wheel has one.
    #[arg(long, env = "NTG_BENCH_IPOPT", default_value = "libipopt.so.3")]
    library: PathBuf,
    /// Seconds for each solver on each spec, on the wall.
    #[arg(long, default_value_t = 20.0)]
    time_limit: f64,
    /// Tolerance of both.
    #[arg(long, default_value_t = 1e-8)]
    tolerance: f64,
    /// ntg's method: auto, newton or sqp.
    #[arg(long, default_value = "auto")]
    method: String,
    /// An option of IPOPT, as in `mu_strategy=adaptive`.
    #[arg(long = "ipopt", value_name = "NAME=VALUE")]
    options: Vec<String>,
    /// Write all numbers to this file as JSON.
    #[arg(long)]
    json: Option<PathBuf>,
    /// Take IPOPT's numbers from a file that --json has written, where it has the spec.
    #[arg(long)]
    reuse: Option<PathBuf>,
    /// Intervals of every spline, times those of the spec.
    #[arg(long, default_value_t = 1.0)]
    mesh: f64,
    /// Which start: 0 is the spec's own guess; in any other one each variable is moved at random by up to a tenth of its size.
    #[arg(long, default_value_t = 0)]
    start: u64,
    /// How many specs at once.
    #[arg(long, default_value_t = 1)]
    jobs: usize,
    /// What IPOPT itself prints, 0 to 12; to standard output.
    #[arg(long, default_value_t = 0)]
    print_level: i32,
    /// One spec, one solver: prints JSON. What every process does. `trace` prints the iterations of ntg's first attempt.
    #[arg(long, hide = true, value_parser = ["ntg", "ipopt", "trace"])]
    one: Option<String>,
}

impl Arguments {
    fn ask(&self) -> Result<Ask, String> {
        let method = match self.method.as_str() {
            "auto" => Method::Auto,
            "newton" | "interior-point" => Method::InteriorPoint,
            "augmented-lagrangian" => Method::AugmentedLagrangian,
            "sqp" => Method::Sqp,
            other => return Err(format!("there is no method {other}; write auto, newton or sqp")),
        };
        if !(self.time_limit.is_finite() && self.time_limit > 0.0) {
            return Err("--time-limit is a positive number of seconds".into());
        }
        let options = self.options.iter().map(|text| setting(text)).collect::<Result<_, _>>()?;
        if !(self.mesh.is_finite() && self.mesh > 0.0) {
            return Err("--mesh is a positive factor".into());
        }
        let Self { tolerance, time_limit: seconds, print_level, mesh, start, .. } = *self;
        Ok(Ask { tolerance, seconds, method, options, print_level, mesh, start })
    }
}

/// `NAME=VALUE`, with the kind of value that it looks like.
fn setting(text: &str) -> Result<(String, Setting), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("--ipopt {text}: write NAME=VALUE"))?;
    let value = match (value.parse::<i32>(), value.parse::<f64>()) {
        (Ok(whole), _) => Setting::Whole(whole),
        (_, Ok(real)) => Setting::Real(real),
        _ => Setting::Word(value.to_owned()),
    };
    Ok((name.to_owned(), value))
}

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(message) => {
            eprintln!("error: {message}");
            ExitCode::from(2)
        }
    }
}

fn run(arguments: &Arguments) -> Result<(), String> {
    let ask = arguments.ask()?;
    if let (Some(solver), [spec]) = (&arguments.one, &arguments.paths[..]) {
        if solver == "trace" {
            return trace::trace(spec, &ask);
        }
        let found = match solver.as_str() {
            "ntg" => one::by_ntg(spec, &ask),
            _ => one::by_ipopt(spec, &ask, &Ipopt::load(arguments.library.as_os_str())?),
        };
        println!("{found}");
        return Ok(());
    }
    // That it is there is known before the first minute has passed.
    Ipopt::load(arguments.library.as_os_str())?;
    let default = [PathBuf::from("specs")];
    let paths = if arguments.paths.is_empty() { &default[..] } else { &arguments.paths };
    let specs = specs::below(paths)?;
    let known = known(arguments)?;
    println!("{}", table::head());
    let all = children::all(arguments, &specs, &known, |name, found| println!("{}", table::line(name, found)))?;
    println!("\n{}", table::summary(&all));
    if let Some(path) = &arguments.json {
        let document = json!({
            "tolerance": arguments.tolerance,
            "time_limit": arguments.time_limit,
            "method": arguments.method,
            "ipopt_options": arguments.options,
            "totals": table::totals(&all),
            "specs": all,
        });
        let text = format!("{document:#}\n");
        std::fs::write(path, text).map_err(|error| format!("cannot write {}: {error}", path.display()))?;
    }
    Ok(())
}

/// IPOPT's numbers of an earlier run, by spec.
fn known(arguments: &Arguments) -> Result<Map<String, Value>, String> {
    let Some(path) = &arguments.reuse else { return Ok(Map::new()) };
    let failed = |error: String| format!("cannot use {}: {error}", path.display());
    let text = std::fs::read_to_string(path).map_err(|error| failed(error.to_string()))?;
    let document: Value = serde_json::from_str(&text).map_err(|error| failed(error.to_string()))?;
    Ok(document["specs"].as_object().cloned().unwrap_or_default())
}
