//! The objective by terms, as discretised and on the finer grid.

use super::TermReport;
use crate::transcribe::Transcription;
use ntg_nlp::Evaluation;
use ntg_structure::{Row, Structure, Term};

/// An objective below this, in its unit, is what a solve to tolerances of 1e-8 leaves of zero. A fit.
const ZERO: f64 = 1e-9;

/// The difference of an objective and its finer integral, relative to the larger of both; 0 where both are next to nothing
/// or the objective is no number, 1 where only the finer integral is none.
pub fn cost_apart(objective: f64, fine: f64) -> f64 {
    if objective.is_finite() && !fine.is_finite() {
        return 1.0;
    }
    let size = objective.abs().max(fine.abs());
    let apart = (fine - objective).abs() / size;
    if size > ZERO && apart.is_finite() { apart } else { 0.0 }
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
