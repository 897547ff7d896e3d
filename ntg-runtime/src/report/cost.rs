//! The objective by terms, as discretised and on the finer grid.

use super::TermReport;
use crate::transcribe::{Transcription, Workspace};
use ntg_nlp::scaling::beside;
use ntg_nlp::{Evaluation, Nlp};
use ntg_structure::{Degree, Row, Structure, Term};

/// An objective below this part of what it varies by beside the solution is 0. A law: the tolerance of an acceptable end.
const ZERO: f64 = 1e-6;

/// An objective, to be compared with another value of it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Cost {
    /// In the user's sense and unit.
    pub value: f64,
    /// What is below this is 0, in the same unit (docs/maths.md, equation 9.2a); infinite where the objective depends on nothing.
    pub zero: f64,
}

impl Cost {
    /// The difference from another value, as its finer integral or the objective on another mesh, relative to the larger of both;
    /// 0 where both are next to nothing or the objective is no number, 1 where only the other one is none.
    pub fn apart(self, other: f64) -> f64 {
        if self.value.is_finite() && !other.is_finite() {
            return 1.0;
        }
        let size = self.value.abs().max(other.abs());
        let apart = (other - self.value).abs() / size;
        if size > self.zero && apart.is_finite() { apart } else { 0.0 }
    }
}

/// Whether the objective depends on nothing, or there is none.
fn is_constant(nlp: &Transcription) -> bool {
    nlp.elements.batches.iter().all(|group| {
        let rows = nlp.model.structure.groups[group.group].rows.iter().zip(&group.degree);
        rows.into_iter().all(|(row, degree)| !matches!(row, Row::Cost { .. }) || *degree == Degree::Constant)
    })
}

/// What of an objective is 0 at a solution, SI. `objective` is its value there; `at` and `work` are overwritten. Where nothing is known
/// of it beside the solution, as it has no value there, nothing counts as 0.
pub(super) fn zero(
    nlp: &Transcription,
    (x, objective): (&[f64], f64),
    work: &mut Workspace,
    at: &mut Evaluation,
) -> f64 {
    if is_constant(nlp) {
        return f64::INFINITY;
    }
    let mut near = x.to_vec();
    beside(x, &nlp.limits, &nlp.limits.scale, &mut near);
    let varies = nlp.values(&near, work, at).map_or(0.0, |()| (at.objective - objective).abs());
    if varies.is_finite() { ZERO * varies } else { 0.0 }
}

/// One entry for each term, in the user's sense and the term's unit. `at` holds the program's values.
pub(super) fn terms(nlp: &Transcription, at: &Evaluation, fine: &[f64]) -> Vec<TermReport> {
    let structure = &nlp.model.structure;
    let mut sums = vec![0.0; structure.terms.len()];
    for (index, group) in nlp.elements.batches.iter().enumerate() {
        let (block, values) = (&nlp.elements.blocks[index], &at.blocks[index].values);
        for (row, meaning) in structure.groups[group.group].rows.iter().enumerate() {
            let Row::Cost { term } = meaning else { continue };
            let range = row * block.elements..(row + 1) * block.elements;
            let sum: f64 = block.weight[range.clone()].iter().zip(&values[range]).map(|(w, v)| w * v).sum();
            if let Some(total) = sums.get_mut(*term) {
                *total += sum;
            }
        }
    }
    let terms = structure.terms.iter().zip(sums).zip(fine);
    let report = terms.map(|((term, value), fine)| TermReport {
        name: term.name.clone().unwrap_or_else(|| statement(&term.place.text)),
        value: shown(structure, term, value),
        fine: shown(structure, term, *fine),
        unit: term.unit.clone(),
    });
    report.collect()
}

/// The text of a statement as a name: without the sign that ends it.
pub(super) fn statement(text: &str) -> String {
    text.trim_end().trim_end_matches(';').trim_end().to_owned()
}

/// A minimised value of a term in the user's sense and unit.
pub(super) fn shown(structure: &Structure, term: &Term, minimised: f64) -> f64 {
    let sign = if structure.maximize { -1.0 } else { 1.0 };
    sign * minimised / term.unit.factor
}

#[cfg(test)]
mod tests {
    #[test]
    fn a_term_without_a_name_is_called_by_its_text_without_the_semicolon() {
        assert_eq!(super::statement("minimize worst;"), "minimize worst");
        assert_eq!(super::statement("minimize integral(u^2) ;"), "minimize integral(u^2)");
        assert_eq!(super::statement("maximize final(x...)"), "maximize final(x...)");
    }
}
