//! What a program says about the start, in declared units.

use crate::solution::Solution;
use std::fmt;
use std::sync::Arc;

/// A guess that a program makes. Values are in declared units, durations in seconds; names are
/// those of the spec, with a path where there are several agents or phases (`uav[2].x`).
///
/// ```
/// use ntg_runtime::guess::Guess;
///
/// let guess = Guess::new()
///     .route(&["x", "y"], &[[-100.0, -100.0], [-100.0, -15.0], [5.0, -15.0]])
///     .output("z", |tau| 12.0 * (1.0 - tau))
///     .duration("T", 900.0);
/// # let _ = guess;
/// ```
///
/// ```
/// use ntg::prelude::*;
///
/// ntg! {
///     /// From rest to rest with the least effort: a cubic, with cost 12 distance^2 / T^3.
///     problem Move {
///         duration T = 2 [s];
///         param distance = 1 [m];
///         output x [m]: spline(order = 6, intervals = 2);
///         minimize integral(der(x, 2)^2);
///         initial { x == 0;  der(x) == 0; }
///         final   { reach: x == distance;  der(x) == 0; }
///     }
/// }
///
/// # fn main() -> Result<(), Box<dyn std::error::Error>> {
/// let problem = Move { distance: 5.0 };
/// let guess = Guess::new().output("x", |tau| 5.0 * tau); // In declared units, over scaled time 0 .. 1.
/// let far = problem.solve_from(&guess, &Settings::default())?;
/// assert!(far.is_solved());
///
/// // The quickest start of all is what was found for a problem nearby.
/// let problem = Move { distance: 5.1 };
/// let again = problem.solve_from(&Guess::from(far.untyped()), &Settings::default())?;
/// assert!((again.objective() - 12.0 * 5.1 * 5.1 / 8.0).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
#[derive(Clone, Default)]
pub struct Guess {
    pub(super) base: Base,
    pub(super) statements: Vec<Statement>,
}

/// What the statements refine.
#[derive(Clone, Default)]
pub(super) enum Base {
    /// The spec's own guess and the defaults.
    #[default]
    Spec,
    /// An earlier solution, on the same knots or on others.
    Solution(Solution),
    /// All variables of the nonlinear program, SI.
    Variables(Vec<f64>),
    /// The same, of an earlier solution of a program with these variables.
    Saved(Vec<f64>),
}

/// One statement.
#[derive(Clone)]
pub(super) enum Statement {
    Route { outputs: Vec<String>, points: Vec<Vec<f64>> },
    Output { output: String, value: Arc<dyn Fn(f64) -> f64 + Send + Sync> },
    Coefficients { output: String, values: Vec<f64> },
    Duration { of: String, seconds: f64 },
    Start { agent: String, seconds: f64 },
    Variable { name: String, value: f64 },
}

impl Guess {
    /// Nothing beyond the spec's own guess.
    pub fn new() -> Self {
        Self::default()
    }

    /// All variables of the nonlinear program as [`Solution::coefficients`] gives them, SI.
    pub fn raw(variables: Vec<f64>) -> Self {
        Self { base: Base::Variables(variables), statements: vec![] }
    }

    /// Whether it is a point near a solution already, and not a rough sketch.
    pub(crate) fn is_near(&self) -> bool {
        !matches!(self.base, Base::Spec)
            || self.statements.iter().any(|statement| matches!(statement, Statement::Coefficients { .. }))
    }

    /// As [`Guess::raw`], of an earlier solution: a solve begins near it, and from anywhere where that fails.
    pub fn saved(variables: Vec<f64>) -> Self {
        Self { base: Base::Saved(variables), statements: vec![] }
    }

    /// Whether it is an earlier solution.
    pub(crate) fn is_solution(&self) -> bool {
        matches!(self.base, Base::Solution(_) | Base::Saved(_))
    }

    /// Whether it is the spec's own guess and no more.
    pub(crate) fn is_empty(&self) -> bool {
        matches!(self.base, Base::Spec) && self.statements.is_empty()
    }

    /// Outputs along a polygon, at constant speed over the agent's whole time, ends exact.
    pub fn route<const N: usize>(self, outputs: &[&str; N], points: &[[f64; N]]) -> Self {
        let outputs = outputs.iter().map(|name| (*name).to_owned()).collect();
        self.polygon(outputs, points.iter().map(|p| p.to_vec()).collect())
    }

    /// As [`Guess::route`], for outputs that are known only when the program runs. A point with
    /// another number of values than there are outputs is refused when the solve begins.
    pub fn polygon(self, outputs: Vec<String>, points: Vec<Vec<f64>>) -> Self {
        self.and(Statement::Route { outputs, points })
    }

    /// An output as a function of scaled time: of the agent's whole time, or of one phase where
    /// the name has the phase's path (`covert.x`).
    pub fn output(self, name: &str, value: impl Fn(f64) -> f64 + Send + Sync + 'static) -> Self {
        self.and(Statement::Output { output: name.to_owned(), value: Arc::new(value) })
    }

    /// The spline coefficients of an output; the name needs the phase's path where there are
    /// several phases.
    pub fn coefficients(self, output: &str, values: &[f64]) -> Self {
        self.and(Statement::Coefficients { output: output.to_owned(), values: values.to_vec() })
    }

    /// A duration in seconds: of a phase by its name or path, or by the name of the duration.
    pub fn duration(self, name: &str, seconds: f64) -> Self {
        self.and(Statement::Duration { of: name.to_owned(), seconds })
    }

    /// When an agent starts, in seconds.
    pub fn start(self, agent: &str, seconds: f64) -> Self {
        self.and(Statement::Start { agent: agent.to_owned(), seconds })
    }

    /// A declared variable.
    pub fn variable(self, name: &str, value: f64) -> Self {
        self.and(Statement::Variable { name: name.to_owned(), value })
    }

    /// The outputs that routes guess together.
    pub(crate) fn routes(&self) -> impl Iterator<Item = &[String]> {
        self.statements.iter().filter_map(|statement| match statement {
            Statement::Route { outputs, .. } => Some(&outputs[..]),
            _ => None,
        })
    }

    fn and(mut self, statement: Statement) -> Self {
        self.statements.push(statement);
        self
    }
}

impl From<&Solution> for Guess {
    /// Starts from an earlier solution, of this problem or of one that shares names with it.
    fn from(solution: &Solution) -> Self {
        Self { base: Base::Solution(solution.clone()), statements: vec![] }
    }
}

impl fmt::Debug for Guess {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let base = match &self.base {
            Base::Spec => "the spec's guess",
            Base::Solution(_) => "a solution",
            Base::Variables(_) => "raw variables",
            Base::Saved(_) => "the variables of a solution",
        };
        f.debug_struct("Guess").field("base", &base).field("statements", &self.statements.len()).finish()
    }
}
