//! What is between the points, measured anew by another form of the problem.
//!
//! Takes a report of a problem whose constraints are held at more points or with other bounds, and the problem itself;
//! gives the report with violations between the points, and with costs on the finer grid, of the problem itself.

use super::{
    ConstraintReport, Report,
    constraints::{Means, keep},
    cost,
    fine::Plan,
    fine::Wanted,
    user,
};
use crate::error::Error;
use crate::problem::Problem;
use crate::transcribe::Transcription;
use ntg_structure::Block;
use std::sync::Arc;

impl Report {
    /// Measures what is between the points of `problem` at this solution, with so many stretches for each point. Where
    /// the variables are not those of the solution, nothing changes.
    ///
    /// # Errors
    /// The problem cannot be set up with its present parameters.
    pub fn measure_between(&mut self, problem: &dyn Problem, samples: usize) -> Result<(), Error> {
        let inner = Arc::clone(&self.solution.inner);
        let nlp = Transcription::new(problem)?;
        if nlp.model.layout.variables != inner.x.len() || self.constraints.len() != own_constraints(&nlp) {
            return Ok(());
        }
        let all_sizes = &self.sizes;
        let own: &mut Vec<ConstraintReport> = &mut self.constraints;
        own.iter_mut().for_each(|own| (own.between, own.mean_between) = (None, 0.0));
        let mut means = Means::new(nlp.model.structure.constraints.len());
        let terms = Plan::new(&nlp, samples)?.evaluate(&nlp, (&inner.x, Wanted::Violated), |checked| {
            // Those of helpers come last, and have no report.
            let Some(own) = own.get_mut(checked.constraint) else { return };
            means.add(&nlp, checked, || all_sizes.between(&nlp, checked.constraint, checked.indices).size);
            let sizes = (|| all_sizes.between(&nlp, checked.constraint, checked.indices), own.unit.factor);
            let value = (checked.value, checked.bounds, sizes);
            let indices = nlp.model.structure.constraints[checked.constraint].shown_indices(checked.indices);
            keep(&nlp, &inner.x, &mut own.between, value, (&checked.point, indices));
        })?;
        means.write(&nlp, own);
        self.objective_fine = user(&nlp, terms.iter().sum());
        let declared = nlp.model.structure.terms.iter().zip(terms);
        for (own, (term, fine)) in self.terms.iter_mut().zip(declared) {
            own.fine = cost::shown(&nlp.model.structure, term, fine);
        }
        let relative = self.constraints.iter().filter_map(|own| own.between.as_ref()).map(|worst| worst.relative);
        self.violation.between = relative.fold(0.0, crate::math::max);
        Ok(())
    }
}

/// How many constraints are the spec's own and not those of helpers.
fn own_constraints(nlp: &Transcription) -> usize {
    nlp.model.structure.constraints.iter().filter(|constraint| constraint.block != Block::Corner).count()
}
