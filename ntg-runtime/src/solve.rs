//! One solve of one problem.

use crate::error::Error;
use crate::guess::Guess;
use crate::problem::Problem;
use crate::refine::refine;
use crate::report::Report;
use crate::settings::{Between, Refinement, Settings};
use crate::strategy::{Session, Task};

/// Solves a problem from the spec's own guess.
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
/// let problem = Move { distance: 3.0 }; // Any problem, whatever made it: results go by name.
/// let report = solve(&problem, &Settings::default())?;
/// assert!(report.is_solved(), "{report}");
/// assert!((report.objective - 12.0 * 9.0 / 8.0).abs() < 1e-6);
/// let x = report.solution.output("x").expect("an output of the spec");
/// assert!((x.at(1.0) - 1.5).abs() < 1e-6);
/// # Ok(())
/// # }
/// ```
///
/// # Errors
/// [`Error`] if the problem cannot be set up; a solve that ends without solution is a report.
pub fn solve(problem: &dyn Problem, settings: &Settings) -> Result<Report, Error> {
    let report = solve_and_refine(&mut Session::default(), Task { problem, guess: None }, settings)?;
    report.confirmed(problem, settings)
}

/// Solves a problem from a program's guess.
///
/// # Errors
/// As [`solve`], and where the guess does not fit the problem.
pub fn solve_from(problem: &dyn Problem, guess: &Guess, settings: &Settings) -> Result<Report, Error> {
    let report = solve_and_refine(&mut Session::default(), Task { problem, guess: Some(guess) }, settings)?;
    report.confirmed(problem, settings)
}

/// Solves a problem on its own mesh, and on finer ones where the settings say so.
pub(crate) fn solve_and_refine(session: &mut Session, task: Task<'_>, settings: &Settings) -> Result<Report, Error> {
    settings.validate()?;
    let settings = &settings.remembering();
    let report = session.solve(task, settings)?.advised_of_time(settings);
    refined(task.problem, report, settings)
}

/// A report on finer meshes where the settings say so; refused where they do not allow violations between the points.
pub(crate) fn refined(problem: &dyn Problem, report: Report, settings: &Settings) -> Result<Report, Error> {
    let by_violation = settings.between == Between::Refine && !report.violated_between().is_empty();
    let report = match settings.refine.or(by_violation.then(|| Refinement::to(settings.between_tolerance.min(0.1)))) {
        Some(wanted) => refine(problem, report, &wanted, settings)?,
        None => report,
    };
    Ok(if settings.between == Between::Refuse { report.refused() } else { report.advised() })
}
