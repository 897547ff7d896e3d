//! How a solution depends on the parameters of its problem: first derivatives of everything, and predictions for small
//! changes (docs/maths.md, section 16).
//!
//! Takes a solution and its problem; gives a [`Sensitivity`]. Derivatives are those of the discretised problem at a
//! local minimum whose active constraints stay active; where that hangs by a thread, [`Sensitivity::weak`] names them.
//! Finds: unknown parameters, solutions that are none, active constraints that contradict each other as soon as they
//! move.

mod differentiator;
mod error;
mod parametric;
mod predict;
mod values;

pub use differentiator::Differentiator;
pub use error::SensitivityError;
pub use values::Gradient;

use crate::problem::{Parametric, Problem};
use crate::report::Report;
use crate::solution::{Solution, Value};
use crate::transcribe::rows::{RowKind, constraint_words};
use crate::transcribe::{Model, names};
use ntg_nlp::sensitivity::{Activity, Response, Sensitivity as Factors};
use parametric::AtSolution;
use std::sync::Arc;

/// Derivatives of a solution by parameters, to first order. All are in units of what is differentiated per declared unit
/// of the parameter, in the user's sense (`maximize`).
///
/// ```
/// use ntg_runtime::prelude::*;
/// # use ntg_runtime::problem::Parametric;
/// # fn plan(flight: &impl Parametric) -> Result<(), Box<dyn std::error::Error>> {
/// let report = solve(flight, &Settings::default())?;
/// let sensitivity = report.sensitivity(flight)?;
/// for (parameter, slope) in sensitivity.parameters().iter().zip(&sensitivity.objective().values) {
///     println!("{}: {slope}", parameter.name);
/// }
/// let at_the_end = sensitivity.at("speed", 120.0); // One number for each parameter.
/// # Ok(())
/// # }
/// ```
pub struct Sensitivity {
    /// The parametric form of the problem.
    problem: Arc<dyn Problem + Send + Sync>,
    /// The solution that was differentiated.
    solution: Solution,
    /// The same as a point of the parametric form.
    at: Solution,
    /// The model of derivatives: that of the parametric form, where times that nothing moves are 0.
    moving: Arc<Model>,
    parameters: Vec<Value>,
    /// For each of the parameters its variable in the parametric form.
    variables: Vec<u32>,
    responses: Vec<Response>,
    objective: Gradient,
    weak: Vec<Weak>,
    is_strict: bool,
    /// The variable and the row of the parametric form that each of the solution's is.
    images: (Arc<[u32]>, Arc<[u32]>),
}

/// A constraint that hardly holds what it limits, or hardly does not: its distance from the bound and its multiplier are
/// both nearly 0. A small change may make it active or inactive, and derivatives may be those to one side only.
#[derive(Clone, Debug, PartialEq)]
pub struct Weak {
    /// The constraint or the variable, in words.
    pub name: String,
    /// Where it is so first; empty for what belongs to no point.
    pub point: String,
    /// At how many points.
    pub points: usize,
}

impl Report {
    /// Derivatives of the solution by all parameters. `problem` is the one that was solved.
    ///
    /// # Errors
    /// There is no solution; or as [`Solution::sensitivity`].
    pub fn sensitivity(&self, problem: &dyn Parametric) -> Result<Sensitivity, SensitivityError> {
        match self.has_solution() {
            true => self.solution.sensitivity(problem),
            false => Err(SensitivityError::Unsolved(self.status.to_string())),
        }
    }
}

impl Solution {
    /// Derivatives of the solution by all parameters. `problem` is the one that was solved.
    ///
    /// # Errors
    /// The second-order conditions of a minimum do not hold, or active constraints contradict each other as soon as
    /// they move.
    pub fn sensitivity(&self, problem: &dyn Parametric) -> Result<Sensitivity, SensitivityError> {
        Differentiator::new(problem).differentiate(self)
    }

    /// As [`Solution::sensitivity`], by some parameters alone: `v_max`, all members of an array `start`, one member
    /// `start[2]`.
    ///
    /// # Errors
    /// As [`Solution::sensitivity`]; and unknown names.
    pub fn sensitivity_by(&self, problem: &dyn Parametric, names: &[&str]) -> Result<Sensitivity, SensitivityError> {
        Differentiator::new(problem).differentiate_by(self, names)
    }

    /// The parameters of these names, member by member, with the variables that they are.
    fn parameters(&self, first: &[u32], names: Option<&[&str]>) -> Result<(Vec<Value>, Vec<u32>), SensitivityError> {
        let (mut parameters, mut variables, mut all) = (vec![], vec![], vec![]);
        for (declared, first) in self.structure().parameters.iter().zip(first) {
            for (member, value) in declared.value.iter().enumerate() {
                let name = declared.element(member);
                let is_own = |wanted: &str| is_called(wanted, &name) || wanted == declared.name;
                let is_wanted = |names: &[&str]| names.iter().any(|wanted| is_own(wanted));
                if names.is_some() {
                    all.extend([declared.name.clone(), name.clone()]);
                }
                if names.is_none_or(is_wanted) {
                    variables.push(first + u32::try_from(member).unwrap_or(u32::MAX));
                    parameters.push(Value { name, value: declared.unit.typed(*value), unit: declared.unit.clone() });
                }
            }
        }
        match names.into_iter().flatten().find(|name| all.iter().all(|known| !is_called(name, known))) {
            Some(unknown) => {
                let known = self.structure().parameters.iter().map(|parameter| parameter.name.clone()).collect();
                Err(SensitivityError::UnknownParameter((*unknown).to_owned(), known))
            }
            None => Ok((parameters, variables)),
        }
    }
}

impl Sensitivity {
    /// By what is differentiated, with present values: all parameters or those that were asked for, arrays member by
    /// member.
    pub fn parameters(&self) -> &[Value] {
        &self.parameters
    }

    /// Derivatives of the optimal objective. They do not hang on the minimum's being strict.
    pub fn objective(&self) -> &Gradient {
        &self.objective
    }

    /// Constraints that may become active or inactive with the smallest change.
    pub fn weak(&self) -> &[Weak] {
        &self.weak
    }

    /// Whether the solution is a strict minimum. Where it is not, other solutions are as good, the derivatives of the
    /// objective are right all the same, and all others are those of the solution that moves least.
    pub fn is_strict(&self) -> bool {
        self.is_strict
    }

    /// The solution that was differentiated.
    pub fn solution(&self) -> &Solution {
        &self.solution
    }
}

/// Whether a name is written for a parameter or an element of one: blanks in its brackets do not count.
fn is_called(written: &str, name: &str) -> bool {
    let letters = |text: &str| text.chars().filter(|c| !c.is_whitespace()).collect::<String>();
    written == name || (written.contains('[') && letters(written) == letters(name))
}

/// What is weakly active, each constraint once.
fn weak<W>(program: &AtSolution<'_>, factors: &Factors<W>) -> Vec<Weak> {
    let (structure, layout) = (&program.nlp.model.structure, &program.nlp.model.layout);
    let mut found: Vec<Weak> = vec![];
    let mut add = |name: String, point: String| match found.iter_mut().find(|known| known.name == name) {
        Some(known) => known.points += 1,
        None => found.push(Weak { name, point, points: 1 }),
    };
    let is_weak = |activity: &Activity| matches!(activity, Activity::Weak { .. });
    for (row, _) in factors.rows().iter().enumerate().filter(|(_, activity)| is_weak(activity)) {
        let info = &program.nlp.elements.rows[row];
        if let RowKind::Constraint(constraint) = info.kind {
            let name = constraint_words(&structure.constraints[constraint], &info.indices);
            add(name, names::point(structure, layout, &info.point, &program.x));
        }
    }
    for (variable, _) in factors.variables().iter().enumerate().filter(|(_, activity)| is_weak(activity)) {
        add(program.nlp.variable_name(variable), String::new());
    }
    found
}
