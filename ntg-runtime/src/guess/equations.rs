//! Which functions of a group are equations that a motion is to keep.

use ntg_structure::{Block, Domain, Group, Row, Structure};

/// Whether a function of a group is an equation that holds along whole phases, is posed as it stands, and is written in the spec.
pub(super) fn is_equation_along(structure: &Structure, group: &Group, function: usize) -> bool {
    let is_equation = match &group.rows[function] {
        Row::Constraint { constraint, lower: Some(lower), upper: Some(upper) } => {
            lower == upper
                && structure.is_posed(*constraint)
                && structure.constraints[*constraint].block != Block::Corner
        }
        _ => false,
    };
    is_equation && matches!(group.domain, Domain::Path { .. })
}
