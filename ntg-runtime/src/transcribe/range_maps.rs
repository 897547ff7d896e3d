//! The range transformations of a block's elements (docs/maths.md, equation 4.5).
//!
//! Takes the slots of the elements as they are laid out for evaluation; gives every element the variables on which its
//! slots depend, its map and its offsets. A basis function that vanishes at a point makes no variable of the element.

use super::slot_maps::SlotMaps;
use ntg_nlp::Block;

/// What one slot of an element takes of one variable.
struct Term {
    slot: usize,
    variable: u32,
    coefficient: f64,
}

/// Fills variables, maps and offsets of a block from the slots of its elements.
pub(super) fn range_maps(block: &mut Block, maps: &SlotMaps) {
    block.variable_start = vec![0];
    block.map_start = vec![0];
    block.offset = vec![0.0; block.slots * block.elements];
    let mut runs = vec![0; maps.bundles.len()]; // The run of the element in each bundle;
    let mut members = vec![0; maps.constants.len()]; // its member in each constant.
    let (mut terms, mut variables): (Vec<Term>, Vec<u32>) = (vec![], vec![]);
    for element in 0..block.elements {
        terms.clear();
        for (bundle, run) in maps.bundles.iter().zip(&mut runs) {
            *run += usize::from(bundle.runs[*run].end == element);
            let begin = run.checked_sub(1).map_or(0, |before| bundle.runs[before].end);
            let (points, first) = (bundle.runs[*run].end - begin, bundle.runs[*run].first + element - begin);
            for &(slot, table) in &bundle.slots {
                let functions = maps.tables[table][first..].iter().step_by(points);
                let active = bundle.variables[*run * bundle.width..][..bundle.width].iter().zip(functions);
                let active = active.filter(|(_, function)| **function != 0.0);
                terms.extend(active.map(|(&variable, &coefficient)| Term { slot, variable, coefficient }));
            }
        }
        for (constant, member) in maps.constants.iter().zip(&mut members) {
            *member += usize::from(constant.members[*member].0 == element);
            let (slot, map) = (constant.slot, &constant.members[*member].1);
            block.offset[slot * block.elements + element] = map.offset;
            terms.extend(map.terms.iter().map(|&(variable, coefficient)| Term { slot, variable, coefficient }));
        }
        variables.clear();
        variables.extend(terms.iter().map(|term| term.variable));
        variables.sort_unstable();
        variables.dedup();
        let first = block.map.len();
        block.map.resize(first + block.slots * variables.len(), 0.0);
        for Term { slot, variable, coefficient } in &terms {
            let at = variables.partition_point(|v| v < variable);
            block.map[first + slot * variables.len() + at] += coefficient;
        }
        block.variables.extend_from_slice(&variables);
        block.variable_start.push(block.variables.len());
        block.map_start.push(block.map.len());
    }
}

/// Fills those of a block whose elements are one variable each.
pub(super) fn identities(block: &mut Block, variables: Vec<u32>) {
    let count = variables.len();
    block.variable_start = (0..=count).collect();
    block.map_start = block.variable_start.clone();
    block.map = vec![1.0; count];
    block.offset = vec![0.0; count];
    block.variables = variables;
}
