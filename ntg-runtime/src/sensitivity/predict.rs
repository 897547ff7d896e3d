//! Solutions for parameters nearby, to first order (docs/maths.md, equation 16.7).

use super::{Sensitivity, SensitivityError};
use crate::problem::Problem;
use crate::solution::{Inner, Solution};
use crate::transcribe::{SetupError, Transcription};
use std::sync::Arc;

impl Sensitivity {
    /// The solution for the parameters of `problem`, which is the one that was solved with a few parameters changed a
    /// little. Variables stay within their bounds; constraints are met to first order.
    ///
    /// It is shown, flown, or the start of a solve ([`Solver::resolve_from`](crate::Solver::resolve_from)), which then
    /// ends in a step or two.
    ///
    /// # Errors
    /// A changed parameter by which was not differentiated, and whatever a solve would find before its first iteration.
    pub fn predict(&self, problem: &dyn Problem) -> Result<Solution, SensitivityError> {
        let own = &self.solution.inner;
        let mut structure = own.model.structure.clone();
        let wanted = problem.structure();
        structure.parameters.clone_from(&wanted.parameters);
        let changes = self.changes(&structure)?;
        let nlp = Transcription::with(problem, structure)?;
        let (mut x, mut rows, mut bounds) = (own.x.clone(), own.row_multipliers.clone(), own.bound_multipliers.clone());
        if nlp.limits.lower.len() != x.len() || nlp.elements.rows.len() != rows.len() {
            return Err(SetupError::malformed("the problem is not the one that was solved").into());
        }
        let (variable_image, row_image) = &self.images;
        for (change, response) in changes.iter().zip(&self.responses).filter(|(change, _)| **change != 0.0) {
            let add = |to: &mut [f64], image: &[u32], of: &[f64]| {
                to.iter_mut().zip(image).for_each(|(to, at)| *to += change * of[*at as usize]);
            };
            add(&mut x, variable_image, &response.x);
            add(&mut rows, row_image, &response.rows);
            add(&mut bounds, variable_image, &response.variables);
        }
        for (x, (lower, upper)) in x.iter_mut().zip(nlp.limits.lower.iter().zip(&nlp.limits.upper)) {
            *x = x.max(*lower).min(*upper);
        }
        let inner = Inner {
            model: nlp.model.clone(),
            x,
            rows: nlp.elements.rows.clone(),
            row_multipliers: rows,
            bound_multipliers: bounds,
            sizes: own.sizes.clone(),
        };
        Ok(Solution { inner: Arc::new(inner) })
    }

    /// By how much each of the parameters changes, SI.
    fn changes(&self, structure: &ntg_structure::Structure) -> Result<Vec<f64>, SensitivityError> {
        let first = self.at.inner.model.layout.variable_first[self.solution.structure().variables.len()..].iter();
        let mut changes = vec![0.0; self.variables.len()];
        let solved = self.solution.structure().parameters.iter();
        for ((old, new), first) in solved.zip(&structure.parameters).zip(first) {
            for (member, (old, value)) in old.value.iter().zip(&new.value).enumerate() {
                let variable = *first as usize + member;
                match self.variables.iter().position(|known| *known as usize == variable) {
                    Some(known) => changes[known] = value - old,
                    None if value != old => {
                        let known = self.parameters.iter().map(|parameter| parameter.name.clone()).collect();
                        return Err(SensitivityError::UnknownParameter(new.name.clone(), known));
                    }
                    None => {}
                }
            }
        }
        Ok(changes)
    }
}
