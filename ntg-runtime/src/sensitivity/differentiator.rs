//! What derivatives of several solutions of one problem share.

use super::parametric::{AtSolution, Limit};
use super::{Gradient, Sensitivity, SensitivityError, moving, weak};
use crate::problem::{Parametric, Problem};
use crate::solution::{Inner, Solution};
use crate::transcribe::{Kept, Workspace};
use ntg_nlp::Multipliers;
use ntg_nlp::sensitivity::{Moving, Sensitivity as Factors};
use std::sync::Arc;

/// Differentiates solutions of one problem, one after another: for other values of parameters, on the same mesh. The
/// transcription of the parametric form and the analysis of its matrix are kept between them. [`Solution::sensitivity`]
/// makes both anew, and gives the same bits.
///
/// ```
/// use ntg_runtime::prelude::*;
/// # use ntg_runtime::problem::Parametric;
/// # use ntg_runtime::sensitivity::Differentiator;
/// # fn plan(flight: &impl Parametric, solutions: &[Solution]) -> Result<(), Box<dyn std::error::Error>> {
/// let mut differentiator = Differentiator::new(flight);
/// for solution in solutions {
///     println!("{:?}", differentiator.differentiate(solution)?.objective());
/// }
/// # Ok(())
/// # }
/// ```
pub struct Differentiator {
    /// The parametric form of the problem.
    problem: Arc<dyn Problem + Send + Sync>,
    /// None before the first solution, and after one that cannot be differentiated.
    kept: Option<KeptForm>,
}

/// What is kept between solutions.
struct KeptForm {
    transcription: Kept,
    factors: Factors<Workspace>,
}

impl Differentiator {
    /// For solutions of `problem`, whatever the values of its parameters.
    pub fn new(problem: &dyn Parametric) -> Self {
        Self { problem: problem.parametric(), kept: None }
    }

    /// Derivatives of a solution by all parameters.
    ///
    /// # Errors
    /// As [`Solution::sensitivity`].
    pub fn differentiate(&mut self, solution: &Solution) -> Result<Sensitivity, SensitivityError> {
        self.differentiated(solution, None)
    }

    /// As [`Differentiator::differentiate`], by some parameters alone, named as in [`Solution::sensitivity_by`].
    ///
    /// # Errors
    /// As [`Solution::sensitivity_by`].
    pub fn differentiate_by(&mut self, solution: &Solution, names: &[&str]) -> Result<Sensitivity, SensitivityError> {
        self.differentiated(solution, Some(names))
    }

    fn differentiated(&mut self, solution: &Solution, names: Option<&[&str]>) -> Result<Sensitivity, SensitivityError> {
        let (transcription, earlier) = self.kept.take().map(|kept| (kept.transcription, kept.factors)).unzip();
        let program = AtSolution::new(&*self.problem, transcription, &solution.inner)?;
        let (parameters, variables) = match solution.parameters(&program.parameters, names) {
            Ok(found) => found,
            Err(error) => {
                let transcription = program.nlp.keep();
                self.kept = earlier.map(|factors| KeptForm { transcription, factors });
                return Err(error);
            }
        };
        let multipliers = Multipliers { rows: &program.row_multipliers, bounds: &program.bound_multipliers };
        let mut factors = Factors::again(earlier, &program.nlp, &program.x, multipliers)?;
        let lagrangian = factors.lagrangian(&program.row_multipliers);
        let mut responses = vec![];
        let structure = solution.structure();
        let sign = if structure.maximize { -1.0 } else { 1.0 };
        let mut objective = Gradient { unit: structure.objective_unit.clone(), values: vec![] };
        for (variable, parameter) in variables.iter().zip(&parameters) {
            let held = program.held(*variable);
            let rates = |limits: &[Limit], multipliers: &[f64]| -> Vec<f64> {
                limits.iter().zip(multipliers).map(|(limit, multiplier)| limit.rate(*multiplier, &held)).collect()
            };
            let rows = rates(&program.rows, &program.row_multipliers);
            let bounds = rates(&program.variables, &program.bound_multipliers);
            // Equation 16.3.
            let by_rows: f64 = program.row_multipliers.iter().zip(&rows).map(|(y, rate)| y * rate).sum();
            let active = factors.variables().iter().map(|activity| f64::from(u8::from(activity.is_active())));
            let by_bounds: f64 = lagrangian.iter().zip(&bounds).zip(active).map(|((y, rate), is)| is * y * rate).sum();
            let factor = sign * parameter.unit.factor / structure.objective_unit.factor;
            objective.values.push(factor * (by_rows + by_bounds));
            responses.push(factors.response(Moving { rows: &rows, variables: &bounds })?);
        }
        let weak = weak(&program, &factors);
        let is_strict = factors.is_strict();
        let AtSolution { nlp, x, image, row_image, .. } = program;
        let inner =
            Inner { model: nlp.model.clone(), x, rows: vec![], row_multipliers: vec![], bound_multipliers: vec![] };
        let moving = Arc::new(moving(&nlp.model));
        self.kept = Some(KeptForm { transcription: nlp.keep(), factors });
        Ok(Sensitivity {
            problem: Arc::clone(&self.problem),
            solution: solution.clone(),
            at: Solution { inner: Arc::new(inner) },
            moving,
            parameters,
            variables,
            responses,
            objective,
            weak,
            is_strict,
            images: (image, row_image),
        })
    }
}
