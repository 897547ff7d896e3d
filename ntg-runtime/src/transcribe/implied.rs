//! Equations that the motion keeps by itself, at the ends of phases (docs/maths.md, section 4.8).
//!
//! They have a row at the start of their phase, or none; at its end they hold as well, and what is fixed there may contradict
//! them. Takes the structure; gives their rows at the ends, which are no rows of the program.

use super::batch::batches;
use super::elements::{Elements, sites};
use super::error::SetupError;
use super::frame::Frame;
use super::points::point_set;
use super::rows::RowKind;
use ntg_nlp::Target;
use ntg_structure::{Domain, Group, Row};

/// The rows of invariants at the ends of their phases; none of anything else.
pub(crate) fn at_ends(frame: &Frame) -> Result<Elements, SetupError> {
    let mut all = Elements::default();
    let structure = frame.structure;
    if structure.shown.is_empty() {
        return Ok(all);
    }
    let invariants = invariants(frame);
    for (number, group) in structure.shown.iter().enumerate() {
        let Domain::Path { phase, part, .. } = &group.domain else { continue };
        if !part.is_whole() || !group.rows.iter().any(|row| constraint(row).is_some_and(|own| invariants[own])) {
            continue;
        }
        let group = Group { domain: Domain::End(phase.clone()), ..group.clone() };
        for batch in batches(frame, &group.call, sites(frame, &group, point_set)?)? {
            all.add(frame, structure.groups.len() + number, &group, batch)?;
        }
    }
    for block in &mut all.blocks {
        for target in &mut block.target {
            let Target::Row(row) = *target else { continue };
            let row = row as usize;
            let is_own = matches!(all.rows[row].kind, RowKind::Constraint(own) if invariants[own]);
            if !is_own || all.lower[row] != all.upper[row] {
                *target = Target::Objective;
            }
        }
    }
    Ok(all)
}

/// Which constraints are written along a phase and have rows at the starts of phases alone, or none.
fn invariants(frame: &Frame) -> Vec<bool> {
    let structure = frame.structure;
    let mut found = structure.constraints_shown();
    for group in structure.groups.iter().filter(|group| !matches!(group.domain, Domain::Start(_))) {
        for own in group.rows.iter().filter_map(constraint) {
            found[own] = false;
        }
    }
    for relaxation in &structure.relaxations {
        (found[relaxation.equation], found[relaxation.other]) = (false, false);
    }
    found
}

/// The constraint of which a row is one, or a part of one.
fn constraint(row: &Row) -> Option<usize> {
    match row {
        Row::Constraint { constraint, .. } | Row::Part { constraint, .. } => Some(*constraint),
        Row::Cost { .. } | Row::Integral { .. } => None,
    }
}
