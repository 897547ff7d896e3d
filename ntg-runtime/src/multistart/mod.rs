//! Many starts of one problem, and the local minima that they lead to (docs/maths.md, section 12).
//!
//! ```text
//! Problem, Guess -> vehicles -> starts (guess, search, routes, perturbed) -> solves -> minima
//! ```
//!
//! Takes a problem and how many starts are wanted; gives every local minimum that was found once,
//! with how often it was found. The result depends on the seed and on nothing else: neither on the
//! number of threads nor on the order in which solves end. A start that fails is counted and stops
//! nothing.

mod display;
mod lattice;
mod minima;
mod parameters;
mod random;
mod run;
mod vehicles;

use crate::report::Report;
use crate::settings::Control;
use std::fmt;
use std::sync::Arc;

pub use run::{multistart, multistart_from};

/// Where starts come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Default)]
pub enum StartKind {
    /// The given guess; then routes of a coarse search, at most [`Starts::SEARCHED`]; then, by turns,
    /// random routes, perturbed guesses, and the guess with other values of the parameters that
    /// only the guess uses. Where no output is a position there are no routes.
    #[default]
    Mixed,
    /// Random routes through one or two way-points; perturbed guesses where no output is a position.
    Routes,
    /// The guess with smooth random functions added, and other durations.
    Perturbed,
    /// Routes of a coarse search in the plane, each turned away from those before; perturbed
    /// guesses where no output is a position.
    Search,
}

/// Which starts are tried.
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// Two wells, at 1 and -1; the left one is deeper.
///     problem Wells {
///         duration T = 1;
///         output x: spline(order = 3, intervals = 1);
///         minimize (final(x)^2 - 1)^2 + 0.2 * final(x) + 0.01 * integral(der(x)^2);
///         guess { x = 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let starts = Starts { count: 24, kind: StartKind::Perturbed, ..Starts::default() };
/// let minima = Wells::default().multistart(&starts, &Settings::default())?;
/// println!("{}", minima.report); // Every minimum once, with how many starts led to it.
/// assert_eq!(minima.report.tried(), 24);
/// assert!(minima.best().expect("one was solved").x.at(1.0) < 0.0);
/// # Ok(())
/// # }
/// ```
#[derive(Clone)]
pub struct Starts {
    /// How many; at least 1. Default 16.
    pub count: usize,
    /// Decides all random numbers. Default 1.
    pub seed: u64,
    /// Where they come from. Default [`StartKind::Mixed`].
    pub kind: StartKind,
    /// Called after each start, from the thread that solved it; may cancel those that have not
    /// begun. Default none.
    pub on_start: Option<OnStart>,
}

/// A function that watches starts.
pub type OnStart = Arc<dyn Fn(&StartProgress) -> Control + Send + Sync>;

/// What is known after a start.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StartProgress {
    /// Starts that are done, in any order.
    pub done: usize,
    /// Starts in all.
    pub count: usize,
    /// Starts that were solved.
    pub solved: usize,
    /// The best objective so far, in the user's sense and unit; NaN while there is none.
    pub best: f64,
    /// Seconds since the first began.
    pub seconds: f64,
}

impl Starts {
    /// Routes of the coarse search among the starts of [`StartKind::Mixed`], at most.
    pub const SEARCHED: usize = 3;
}

impl Default for Starts {
    fn default() -> Self {
        Self { count: 16, seed: 1, kind: StartKind::Mixed, on_start: None }
    }
}

impl fmt::Debug for Starts {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { count, seed, kind, on_start } = self;
        let watched = on_start.as_ref().map(|_| "a function");
        let mut fields = f.debug_struct("Starts");
        fields.field("count", count).field("seed", seed).field("kind", kind).field("on_start", &watched).finish()
    }
}

/// Where one start came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// The guess of the spec or the program.
    Guess,
    /// The coarse search.
    Search,
    /// A random route.
    Route,
    /// A perturbed guess.
    Perturbed,
    /// The guess with other values of the parameters that only the guess uses.
    Parameters,
}

/// What became of one start.
#[derive(Clone, Debug, PartialEq)]
pub struct StartReport {
    /// Where it came from.
    pub origin: Origin,
    /// Why the solve ended, in words.
    pub status: String,
    /// The minimum it led to, as an index into [`MultiReport::minima`]; none where it was not solved.
    pub minimum: Option<usize>,
    /// The objective at its end, in the user's sense and unit; NaN where nothing was solved at all.
    pub objective: f64,
    /// Its iterations.
    pub iterations: usize,
    /// Its seconds.
    pub seconds: f64,
}

/// A local minimum.
#[derive(Clone, Debug)]
pub struct Minimum {
    /// How many starts led to it.
    pub count: usize,
    /// The first of them, as an index into [`MultiReport::starts`].
    pub first: usize,
    /// The best of their solves.
    pub report: Report,
}

/// Everything about many starts.
#[derive(Clone, Debug)]
#[non_exhaustive]
pub struct MultiReport {
    /// The problem's name.
    pub problem: String,
    /// What became of every start that was tried, in order.
    pub starts: Vec<StartReport>,
    /// The local minima, the best first.
    pub minima: Vec<Minimum>,
    /// Where nothing was solved: the start that came nearest to meeting the constraints.
    pub nearest: Option<Box<Report>>,
    /// What a person should know about the choice of starts.
    pub notes: Vec<String>,
    /// Wall-clock seconds of everything.
    pub seconds: f64,
}

/// The minima of many starts as a generated struct shows them.
#[derive(Clone, Debug)]
pub struct Minima<S> {
    /// One solution for each of [`MultiReport::minima`], the best first.
    pub solutions: Vec<S>,
    /// Everything else.
    pub report: MultiReport,
}

impl<S> Minima<S> {
    /// Shows every minimum as `show` makes a solution of its report.
    pub fn new(report: MultiReport, show: impl Fn(Report) -> S) -> Self {
        Self { solutions: report.reports().into_iter().map(show).collect(), report }
    }

    /// The best solution; none where no start was solved.
    pub fn best(&self) -> Option<&S> {
        self.solutions.first()
    }
}

impl MultiReport {
    /// A copy of the report of every minimum. Not generic, so that copies are compiled here and not for every problem.
    fn reports(&self) -> Vec<Report> {
        self.minima.iter().map(|minimum| minimum.report.clone()).collect()
    }

    /// How many starts were tried.
    pub fn tried(&self) -> usize {
        self.starts.len()
    }

    /// How many of them were solved.
    pub fn solved(&self) -> usize {
        self.starts.iter().filter(|start| start.minimum.is_some()).count()
    }

    /// The best local minimum, or where there is none the start that came nearest; none where not
    /// a single solve could begin.
    pub fn best(&self) -> Option<&Report> {
        self.minima.first().map(|minimum| &minimum.report).or(self.nearest.as_deref())
    }
}
