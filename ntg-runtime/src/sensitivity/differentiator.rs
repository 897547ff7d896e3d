//! What derivatives of several solutions of one problem share.

use super::parametric::{AtSolution, Form};
use super::{Gradient, Sensitivity, SensitivityError, weak};
use crate::problem::{Parametric, Problem};
use crate::solution::{Inner, Solution, Value};
use crate::transcribe::{Kept, Workspace};
use ntg_nlp::Multipliers;
use ntg_nlp::sensitivity::{Moving, Sensitivity as Factors};
use ntg_structure::Structure;
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
    form: Form,
    transcription: Kept,
    /// None before the first solution.
    factors: Option<Factors<Workspace>>,
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
        let (form, nlp, earlier) = match self.kept.take() {
            Some(KeptForm { form, transcription, factors }) if form.fits(&transcription, &solution.inner) => {
                (form, transcription.of(&*self.problem), (factors, true))
            }
            other => {
                let (form, nlp) = Form::new(&*self.problem, &solution.inner)?;
                (form, nlp, (other.and_then(|kept| kept.factors), false))
            }
        };
        let (parameters, variables) = match solution.parameters(&form.parameters, names) {
            Ok(found) => found,
            Err(error) => {
                self.kept =
                    Some(KeptForm { form, transcription: nlp.keep(), factors: earlier.0.filter(|_| earlier.1) });
                return Err(error);
            }
        };
        let program = form.at(nlp, &solution.inner);
        let multipliers = Multipliers { rows: &program.row_multipliers, bounds: &program.bound_multipliers };
        let mut factors = Factors::again(earlier, &program.nlp, &program.x, multipliers)?;
        let rates = form.rates(&program, &variables);
        let moving: Vec<Moving> =
            rates.iter().map(|rates| Moving { rows: &rates.rows, variables: &rates.variables }).collect();
        let objective = objective(&program, &mut factors, (solution.structure(), &parameters), &moving);
        let responses = factors.responses(&moving)?;
        let weak = weak(&program, &factors);
        let is_strict = factors.is_strict();
        let AtSolution { nlp, x, .. } = program;
        let at = Solution { inner: Arc::new(Inner::point(nlp.model.clone(), x)) };
        let (moving, images) = (Arc::clone(&form.moving), (Arc::clone(&form.image), Arc::clone(&form.row_image)));
        self.kept = Some(KeptForm { form, transcription: nlp.keep(), factors: Some(factors) });
        Ok(Sensitivity {
            problem: Arc::clone(&self.problem),
            solution: solution.clone(),
            at,
            moving,
            parameters,
            variables,
            responses,
            objective,
            weak,
            is_strict,
            images,
        })
    }
}

/// Equation 16.3.
fn objective<W>(
    program: &AtSolution<'_>,
    factors: &mut Factors<W>,
    (structure, parameters): (&Structure, &[Value]),
    moving: &[Moving<'_>],
) -> Gradient {
    let lagrangian = factors.lagrangian(&program.row_multipliers);
    let sign = if structure.maximize { -1.0 } else { 1.0 };
    let slope = |(moving, parameter): (&Moving<'_>, &Value)| {
        let by_rows: f64 = moving.rows.iter().map(|(row, rate)| program.row_multipliers[*row] * rate).sum();
        let active = moving.variables.iter().filter(|(variable, _)| factors.variables()[*variable].is_active());
        let by_bounds: f64 = active.map(|(variable, rate)| lagrangian[*variable] * rate).sum();
        sign * parameter.unit.factor / structure.objective_unit.factor * (by_rows + by_bounds)
    };
    Gradient { unit: structure.objective_unit.clone(), values: moving.iter().zip(parameters).map(slope).collect() }
}
