//! What can be written on the command line.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

/// Optimal control and trajectory generation from a readable problem file.
#[derive(Debug, Parser)]
#[command(name = "ntg", version, about, arg_required_else_help = true)]
pub(crate) struct Ntg {
    #[command(subcommand)]
    pub(crate) command: Command,
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Say what is wrong with a spec, or that nothing is.
    Check(Check),
    /// Print the Rust that a spec becomes, or what is inside it.
    Expand(Expand),
    /// Solve a spec and print its solution.
    ///
    /// Examples:
    ///   ntg solve specs/van_der_pol.ntg
    ///   ntg solve specs/low_observable.ntg --set sig_max=4.5 --format json
    ///   ntg solve mission.ntg --set "v_max=250 [m/s]" --set start_x=-100,-97 --save run.json
    ///   ntg solve specs/low_observable.ntg --route "x, y: -100, -100; 0, -100; 5, -15 [km]"
    #[command(verbatim_doc_comment)]
    Solve(Solve),
    Plot(crate::plot::Arguments),
    Report(crate::report::Arguments),
}

#[derive(Args, Debug)]
pub(crate) struct Check {
    /// The spec files.
    #[arg(required = true)]
    pub(crate) specs: Vec<PathBuf>,
}

#[derive(Args, Debug)]
pub(crate) struct Expand {
    /// The spec file.
    pub(crate) spec: PathBuf,
    /// What to print.
    #[arg(long, value_enum, default_value_t = What::Rust)]
    pub(crate) what: What,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum What {
    /// The generated Rust.
    Rust,
    /// Kernels, elements, band and border of the optimisation problem.
    Structure,
}

#[derive(Args, Debug)]
pub(crate) struct Solve {
    /// The spec file.
    pub(crate) spec: PathBuf,
    /// Set a parameter in its declared unit, or with a unit: `v_max=0.2`, `v_max="200 [m/s]"`,
    /// one member `start_x[2]=-97`, a whole array `start_x=-100,-97`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) set: Vec<String>,
    /// How many points of the solution to print.
    #[arg(long, default_value_t = 101, value_parser = clap::value_parser!(u32).range(2..=1_000_000))]
    pub(crate) samples: u32,
    /// How to print.
    #[arg(long, value_enum, default_value_t = Format::Text)]
    pub(crate) format: Format,
    /// Start from a saved solution.
    #[arg(long, value_name = "FILE")]
    pub(crate) guess: Option<PathBuf>,
    /// Start from a coarse route, flown at constant speed: outputs, then way-points, numbers in
    /// declared units or with a unit at the end. May be given several times, for several vehicles.
    #[arg(long, value_name = "OUTPUTS: POINT; POINT ...", allow_hyphen_values = true)]
    pub(crate) route: Vec<String>,
    /// Save the solution, for `--guess` and other programs. An existing file is kept unless
    /// `--force` is given.
    #[arg(long, value_name = "FILE")]
    pub(crate) save: Option<PathBuf>,
    /// Let `--save` replace an existing file.
    #[arg(long)]
    pub(crate) force: bool,
    /// Give up after that many seconds.
    #[arg(long, value_name = "SECONDS")]
    pub(crate) time_limit: Option<f64>,
    /// Give up after that many iterations.
    #[arg(long, value_name = "N")]
    pub(crate) max_iterations: Option<usize>,
    /// Largest scaled residual of the optimality conditions.
    #[arg(long, value_name = "RESIDUAL")]
    pub(crate) tolerance: Option<f64>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}
