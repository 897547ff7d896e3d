//! What can be written on the command line.

pub(crate) mod numbers;
mod text;

use std::ffi::OsString;
use std::path::PathBuf;

use clap::{Args, FromArgMatches, Parser, Subcommand, ValueEnum};

use numbers::{number, whole};
pub(crate) use text::{Check, Completions, Explain, Fmt, New};

/// From nothing to something one can send to a colleague.
const FIVE_COMMANDS: &str = "\
A first problem:
  ntg new landing                             # a commented spec; edit it
  ntg check landing.ntg
  ntg solve landing.ntg --save landing.json
  ntg plot landing.json --xy x,y -o landing.svg
  ntg report landing.json -o landing.html";

/// Optimal control and trajectory generation from a readable problem file.
#[derive(Debug, Parser)]
#[command(name = "ntg", version, arg_required_else_help = true, after_help = FIVE_COMMANDS)]
pub(crate) struct Ntg {
    #[command(subcommand)]
    pub(crate) command: Command,
}

impl Ntg {
    /// What the words of a command line say, the command's own name first.
    pub(crate) fn of(words: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        let mut command = numbers::command();
        let matches = command.try_get_matches_from_mut(words)?;
        Self::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
    }
}

#[derive(Debug, Subcommand)]
pub(crate) enum Command {
    /// Write a commented spec to start from.
    ///
    /// Examples:
    ///   ntg new landing              # writes landing.ntg, which solves as it is
    ///   ntg new specs/landing.ntg    # the same in another folder
    ///   ntg new lander --three-dimensional    # a powered descent in space
    #[command(verbatim_doc_comment)]
    New(New),
    /// Say what is wrong with specs, or that nothing is.
    ///
    /// Exit status: 0 when all are well formed, 2 when one is not.
    ///
    /// Examples:
    ///   ntg check specs/van_der_pol.ntg
    ///   ntg check specs --format json              # all .ntg files below a folder
    ///   git show HEAD:specs/car.ntg | ntg check -
    #[command(verbatim_doc_comment)]
    Check(Check),
    /// Lay specs out in the canonical way.
    ///
    /// Only white space changes; comments, single blank lines and blocks on one line stay.
    /// A spec with syntax errors is left alone.
    /// Exit status: 0 done, 1 with --check when a spec has another layout, 2 on errors.
    ///
    /// Examples:
    ///   ntg fmt specs                # all .ntg files below a folder
    ///   ntg fmt --check specs/*.ntg  # prints what would change
    ///   ntg fmt - < draft.ntg        # for editors: standard input to standard output
    #[command(verbatim_doc_comment)]
    Fmt(Fmt),
    /// Print what a code such as E042 stands for, and what to write instead.
    ///
    /// Examples:
    ///   ntg explain E041
    ///   ntg explain                  # lists all codes
    #[command(verbatim_doc_comment)]
    Explain(Explain),
    /// Print the Rust that a spec becomes, or what is inside it.
    ///
    /// Examples:
    ///   ntg expand specs/van_der_pol.ntg                     # the generated Rust
    ///   ntg expand specs/van_der_pol.ntg --what gradient     # what each function depends on
    ///   ntg expand specs/van_der_pol.ntg --what structure    # kernels, band and border
    ///   ntg expand specs/van_der_pol.ntg --what nlp          # sizes and matrices of the optimisation problem
    #[command(verbatim_doc_comment)]
    Expand(Expand),
    /// Solve a spec and print its solution.
    ///
    /// Examples:
    ///   ntg solve specs/van_der_pol.ntg
    ///   ntg solve specs/low_observable.ntg --set sig_max=4.5 --format json
    ///   ntg solve mission.ntg --set "v_max=250 [m/s]" --set start_x=-100,-97 --save run.json
    ///   ntg solve specs/low_observable.ntg --route "x, y: -100, -100; 0, -100; 5, -15 [km]"
    ///   ntg solve specs/low_observable.ntg --starts 50 --seed 2
    ///   ntg solve specs/low_observable.ntg --guarantee     # every constraint proved for all times
    ///   ntg solve specs/gates.ntg --csv flight.csv --every 0.1s
    #[command(verbatim_doc_comment)]
    Solve(Solve),
    Certify(crate::certify::Arguments),
    Plot(crate::plot::Arguments),
    Report(crate::report::Arguments),
    Sweep(crate::sweep::Arguments),
    Merge(crate::merge::Arguments),
    Summary(crate::summary::Arguments),
    Embed(crate::embed::Embed),
    Export(crate::export::Export),
    CheckSolution(crate::export::CheckSolution),
    /// Start the language server on standard input and output; editors run `ntg lsp`.
    ///
    /// Example, in Helix's languages.toml:
    ///   language-server.ntg = { command = "ntg", args = ["lsp"] }
    #[command(verbatim_doc_comment)]
    Lsp,
    /// Print a script that completes the command's words in a shell.
    ///
    /// Examples:
    ///   ntg completions bash > ~/.local/share/bash-completion/completions/ntg
    ///   ntg completions zsh > ~/.zfunc/_ntg
    ///   ntg completions fish > ~/.config/fish/completions/ntg.fish
    #[command(verbatim_doc_comment)]
    Completions(Completions),
}

#[derive(Args, Debug)]
pub(crate) struct Expand {
    /// The spec file.
    pub(crate) spec: PathBuf,
    /// Set a number that the spec declares by `const`, in its unit or with a unit: `n=50`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) set: Vec<String>,
    /// What to print.
    #[arg(long, value_enum, default_value_t = What::Rust)]
    pub(crate) what: What,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum What {
    /// The generated Rust.
    Rust,
    /// What each function depends on, and how: active variables, degree, entries of its derivatives.
    Gradient,
    /// Kernels, elements, band and border of the optimisation problem.
    Structure,
    /// The optimisation problem: sizes, bounds, pictures of its Jacobian and its Hessian.
    Nlp,
}

#[derive(Args, Debug)]
pub(crate) struct Solve {
    /// The spec file.
    pub(crate) spec: PathBuf,
    /// Set a parameter in its declared unit, or with a unit: `v_max=0.2`, `v_max="200 [m/s]"`,
    /// one member `start_x[2]=-97`, a whole array `start_x=-100,-97`; or a number that the spec declares by `const`,
    /// such as a size: `n=50`.
    #[arg(long = "set", value_name = "NAME=VALUE", allow_hyphen_values = true)]
    pub(crate) set: Vec<String>,
    /// How many points of the solution to print.
    #[arg(long, default_value_t = 101, value_parser = whole::<u32>(2..=1_000_000))]
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
    #[command(flatten)]
    pub(crate) sampled: crate::samples::Arguments,
    /// Let `--save`, `--csv` and `--parquet` replace an existing file.
    #[arg(long)]
    pub(crate) force: bool,
    /// Give up after that many seconds, those counted in which the spec is read and compiled.
    #[arg(long, value_name = "SECONDS", value_parser = number)]
    pub(crate) time_limit: Option<f64>,
    /// Give up after that many iterations.
    #[arg(long, value_name = "N", value_parser = whole::<usize>(1..=u64::MAX))]
    pub(crate) max_iterations: Option<usize>,
    #[command(flatten)]
    pub(crate) starts: Starts,
    /// Solve again on finer and finer meshes, until cost and constraints are exact to that relative
    /// error; with `--starts`, every minimum.
    #[arg(long, value_name = "ERROR", value_parser = number)]
    pub(crate) refine: Option<f64>,
    /// Prove every constraint for all times; where one fails between the points, tighten it or hold it at more points
    /// and solve again, until all is proved.
    #[arg(long, conflicts_with_all = ["count", "refine"])]
    pub(crate) guarantee: bool,
    /// Differentiate the solution by all parameters, or by some: `--sensitivity=v_max,start[2],B[1,2]`.
    #[arg(long, value_name = "PARAMETERS", num_args = 0..=1, require_equals = true, default_missing_value = "",
        conflicts_with = "guarantee")]
    pub(crate) sensitivity: Option<Vec<String>>,
    /// What becomes of a solution that violates constraints between the points of the transcription.
    #[arg(long, value_enum, default_value_t = Between::Report)]
    pub(crate) between: Between,
    /// The largest violation between the points of which nothing is said, relative to the constraint's bound; 0.01
    /// without it.
    #[arg(long, value_name = "VIOLATION", value_parser = number)]
    pub(crate) between_tolerance: Option<f64>,
    /// Largest scaled residual of the optimality conditions.
    #[arg(long, value_name = "RESIDUAL", value_parser = number)]
    pub(crate) tolerance: Option<f64>,
    /// The typical size of an output or a variable, in its declared unit, where the automatic one is wrong: `x=100`.
    #[arg(long, value_name = "NAME=SIZE")]
    pub(crate) scale: Vec<String>,
    /// Which method solves the problem.
    #[arg(long, value_enum, default_value_t = Method::Auto)]
    pub(crate) method: Method,
    /// What the interior-point method makes small where it restores feasibility.
    #[arg(long, value_enum, default_value_t = Restoration::Absolute)]
    pub(crate) restoration: Restoration,
    /// How the interior-point method corrects the inertia of its matrix.
    #[arg(long, value_enum, default_value_t = InertiaCorrection::ByElement)]
    pub(crate) inertia_correction: InertiaCorrection,
}

/// What a restoration of feasibility makes small.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Restoration {
    /// The sum of violations.
    Absolute,
    /// The sum of their squares.
    Squared,
}

/// How the matrix of a step is given the inertia of a minimum.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum InertiaCorrection {
    /// The second derivatives of each element are made positive semidefinite.
    ByElement,
    /// A multiple of the identity is added.
    ByShift,
}

/// What becomes of violations between the points.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Between {
    /// A warning names the constraints.
    Report,
    /// It is no solution.
    Refuse,
    /// The mesh is refined until the tolerance is met.
    Refine,
}

/// Which starts are wanted.
#[derive(Args, Clone, Copy, Debug)]
pub(crate) struct Starts {
    /// Solve from many starts (the guess, a coarse search over the plane, random routes, perturbed
    /// guesses) and find the local minima, the best first.
    #[arg(long = "starts", value_name = "N", value_parser = whole::<u32>(1..=1_000_000))]
    pub(crate) count: Option<u32>,
    /// The seed of the random starts: the same seed gives the same starts.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "count", value_parser = whole::<u64>(0..=u64::MAX))]
    pub(crate) seed: u64,
    /// Where starts come from.
    #[arg(long = "start-kind", value_enum, default_value_t = Kind::Mixed, requires = "count")]
    pub(crate) kind: Kind,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Kind {
    /// The guess, the coarse search, random routes and perturbed guesses.
    Mixed,
    /// Random routes.
    Routes,
    /// Perturbed guesses.
    Perturbed,
    /// The coarse search.
    Search,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(crate) enum Format {
    /// For people.
    Text,
    /// For programs.
    Json,
}

/// Which method solves the problem.
#[derive(Clone, Copy, Debug, ValueEnum)]
pub(crate) enum Method {
    /// The structured interior-point method, and what helps where it fails.
    Auto,
    /// Sequential quadratic programming.
    Sqp,
    /// The structured interior-point method alone.
    #[value(alias = "newton")]
    InteriorPoint,
    /// The same on the augmented Lagrangian.
    AugmentedLagrangian,
}
