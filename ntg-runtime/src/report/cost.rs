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

/// What is known of an objective by its value beside a solution.
#[derive(Clone, Copy, Debug)]
pub(super) struct Beside {
    /// What of it is 0, SI; infinite where it depends on nothing. Where it has no value beside the solution, nothing counts as 0.
    pub(super) zero: f64,
    /// Whether it is the same there, though it depends on something.
    pub(super) is_flat: bool,
}

/// What is known beside a solution. `objective` is the value there; `at` and `work` are overwritten.
pub(super) fn beside_solution(
    nlp: &Transcription,
    (x, objective): (&[f64], f64),
    work: &mut Workspace,
    at: &mut Evaluation,
) -> Beside {
    if is_constant(nlp) {
        return Beside { zero: f64::INFINITY, is_flat: false };
    }
    let mut near = x.to_vec();
    beside(x, &nlp.limits, &nlp.limits.scale, &mut near);
    let varies = nlp.values(&near, work, at).map(|()| (at.objective - objective).abs());
    let known = varies.ok().filter(|varies| varies.is_finite());
    Beside { zero: ZERO * known.unwrap_or(0.0), is_flat: known == Some(0.0) }
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
