//! What a person should look at that no constraint and no residual tells: variables of an estimate at their bounds, fits
//! that the standard deviations do not bear out, outputs that ran off, expressions that are singular along the motion.
//!
//! Each hint is a sentence with the place in the spec that it is about.

use super::Estimate;
use crate::digits::{brief, brief_in};
use crate::transcribe::Transcription;
use crate::transcribe::instances::family_members;
use crate::transcribe::rows::RowKind;
use crate::transcribe::{SetupError, Singular, names, singular};
use ntg_structure::{Block, Place, Structure};

/// A value this near to a bound, in sizes of the variable, is at it: the method stays inside by its last barrier parameter.
const AT_BOUND: f64 = 1e-5;
/// How many standard deviations a fit may be worse than the model and the `sigma`s say. A law: normal errors are beyond it
/// once in three million fits.
const SURE: f64 = 5.0;
/// An output has run off where it is this many times its size at the guess. A law: sizes are what guess, bounds and ends
/// say, and three decimals beyond all of them is no motion that these are about.
const RAN_OFF: f64 = 1e3;

/// An objective that is the same all around a solution, with the place of its first term.
pub(super) fn flat_objective(structure: &Structure) -> (String, Place) {
    let message = "the objective is the same all around the solution: no point nearby is better or worse, and nothing tells where it \
                   is better farther away; if it should vary there, start from a guess at which it does";
    let place = structure.terms.first().map_or_else(Place::default, |term| term.place.clone());
    (message.to_owned(), place)
}

/// What an estimate does not say by itself.
pub(super) fn of_estimate(nlp: &Transcription, x: &[f64], estimate: Option<&Estimate>) -> Vec<(String, Place)> {
    let Some(estimate) = estimate else { return vec![] };
    let (structure, limits) = (&nlp.model.structure, &nlp.limits);
    let mut told = vec![];
    let mut free = 0;
    for (declared, first) in structure.variables.iter().zip(&nlp.model.layout.variable_first) {
        for (member, index) in family_members(declared.family).into_iter().enumerate() {
            let at = *first as usize + member;
            let (value, lower, upper) = (x[at], limits.lower[at], limits.upper[at]);
            if lower == upper {
                continue;
            }
            free += 1;
            let near = |bound: &f64| {
                bound.is_finite() && (value - bound).abs() <= AT_BOUND * limits.scale[at].max(bound.abs())
            };
            if let Some(bound) = [lower, upper].into_iter().find(near) {
                let name = names::member(&declared.name, declared.family, index);
                let bound = brief_in(bound, &declared.unit);
                let message = format!(
                    "`{name}` ends at its bound {bound}: the measurements ask for more, or tell nothing of it, and its \
                     standard deviation says nothing"
                );
                told.push((message, declared.place.clone()));
            }
        }
    }
    let freedom = estimate.count.saturating_sub(free);
    if freedom > 0 && deviations_off(estimate.chi2, freedom as f64) > SURE {
        let message = format!(
            "chi^2 is {} where about {freedom} is expected: the model does not meet the measurements as well as their \
             `sigma` says; look at the largest residuals",
            brief(estimate.chi2)
        );
        let term = structure.measurements.first().and_then(|first| structure.terms.get(first.term));
        told.push((message, term.map_or_else(Place::default, |term| term.place.clone())));
    }
    told
}

/// How far chi^2 is above what is expected, in standard deviations: its cube root is all but normal (Wilson and Hilferty,
/// 1931).
fn deviations_off(chi2: f64, freedom: f64) -> f64 {
    let spread = 2.0 / (9.0 * freedom);
    ((chi2 / freedom).cbrt() - (1.0 - spread)) / spread.sqrt()
}

/// More equations than unknowns: splines that have fewer coefficients than the points that hold an equation of motion. They
/// hold together only by chance, and no guess and no bound mends that.
pub(super) fn overdetermined(nlp: &Transcription) -> Option<(String, Place)> {
    let (structure, limits) = (&nlp.model.structure, &nlp.limits);
    let is_fixed = |row: &usize| limits.row_lower[*row] == limits.row_upper[*row];
    let equations = (0..limits.row_lower.len()).filter(is_fixed).count();
    let unknowns = limits.lower.iter().zip(&limits.upper).filter(|(lower, upper)| lower < upper).count();
    if equations <= unknowns {
        return None;
    }
    let mut of_points =
        nlp.elements.rows.iter().enumerate().filter(|(row, _)| is_fixed(row)).filter_map(|(_, info)| match info.kind {
            RowKind::Constraint(number) => Some(&structure.constraints[number]),
            _ => None,
        });
    // Boundary conditions alone say nothing of points.
    let equation = of_points.find(|constraint| constraint.block == Block::Trajectory)?;
    let message = format!(
        "the points pose {equations} equations for {unknowns} unknowns, so that they hold together only by chance: take \
         fewer points, splines with more intervals, or `collocation gauss` for equations of motion"
    );
    Some((message, equation.place.clone()))
}

/// The norm of a vector that is integrated in what is minimised, or stands in an equation, where a solve finds no end: an input that is its width is
/// solved more surely than the helper that stands for it (docs/maths.md, section 18).
pub(super) fn integrated_norm(nlp: &Transcription) -> Option<(String, Place)> {
    let structure = &nlp.model.structure;
    let helpers = structure.phases.iter().flat_map(|phase| &phase.outputs).filter(|output| output.is_helper());
    let norm = helpers
        .filter_map(|helper| helper.doc.strip_prefix("Stands for `")?.strip_suffix("`."))
        .find(|text| ["norm(", "hypot(", "sqrt("].iter().any(|root| text.starts_with(root)) && text.ends_with(')'))?;
    let of_equation = structure.relaxations.iter().flat_map(|own| &own.corners).find(|corner| corner.text == norm);
    let (told, place, whole) = match of_equation {
        Some(corner) => ("stands in an equation", corner, "the equation"),
        None => {
            let term = structure.terms.iter().find(|term| term.place.text.contains(norm));
            ("is integrated in what is minimised", &term.or(structure.terms.first())?.place, "the objective")
        }
    };
    let message = format!(
        "`{norm}` {told}: an input of its own is often solved where this is not, `input s;` with the limit of the norm as its \
         bound, `{norm} <= s` in `trajectory`, and `s` in {whole}"
    );
    Some((message, place.clone()))
}

/// Outputs that have left their sizes far behind, the farthest first.
pub(super) fn ran_off(nlp: &Transcription, x: &[f64]) -> Vec<(String, Place)> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let mut found: Vec<(f64, String, Place)> = vec![];
    for (phase, member) in layout.phases.iter().enumerate() {
        let declared = &structure.phases[member.phase];
        for (output, own) in member.outputs.iter().enumerate() {
            let origin = |c: u32| nlp.origin.get(c as usize).copied().unwrap_or(0.0);
            let sizes =
                own.coefficients.iter().map(|c| ((x[*c as usize] - origin(*c)).abs(), nlp.limits.scale[*c as usize]));
            let far =
                sizes.map(|(value, size)| (value / size, value)).fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
            if far.0 > RAN_OFF && !declared.outputs[own.output].is_helper() {
                let unit = &declared.outputs[own.output].unit;
                let message = format!(
                    "`{}` ran off to {}, {} times its size at the start: bounds keep it where it has a meaning, and so \
                     does a guess nearer to the motion",
                    names::output(structure, layout, phase, output),
                    brief_in(far.1, unit),
                    brief(far.0.round())
                );
                found.push((far.0, message, declared.place.clone()));
            }
        }
    }
    found.sort_by(|a, b| b.0.total_cmp(&a.0));
    /// Sentences that a person reads.
    const TOLD: usize = 2;
    found.into_iter().take(TOLD).map(|(_, message, place)| (message, place)).collect()
}

/// Expressions that are singular along the motion that was found: where it misses equations between the points or falls
/// without limit, they are the reason. At the points themselves they may have values.
pub(super) fn poles(nlp: &Transcription, x: &[f64]) -> Result<Vec<(String, Place)>, SetupError> {
    /// Places looked at to a point of the transcription.
    const SAMPLES: usize = 2;
    Ok(singular::poles(nlp, x, SAMPLES)?.into_iter().map(|pole| (in_motion(&pole), pole.place)).collect())
}

/// What a person should know of a pole in the motion that was found.
pub(super) fn in_motion(pole: &Singular) -> String {
    let point = if pole.point.is_empty() { String::new() } else { format!(" at {}", pole.point) };
    format!(
        "`{}` (line {}, column {}) is singular in the motion that was found{point}: no points tell of what happens there; \
         keep its argument away from that by a bound, or write the formula without it",
        pole.place.text, pole.place.line, pole.place.column
    )
}

#[cfg(test)]
mod tests {
    use super::deviations_off;

    #[test]
    fn chi_squared_is_judged_by_its_own_spread() {
        // One in three million is 5 standard deviations: of 100 degrees of freedom 185.6, of one 25.7 (tables of chi^2).
        assert!((deviations_off(185.6, 100.0) - 5.0).abs() < 0.1);
        assert!(deviations_off(100.0, 100.0).abs() < 0.1);
        assert!(deviations_off(4.0, 1.0) < 2.5 && deviations_off(40.0, 1.0) > 5.0);
    }
}
