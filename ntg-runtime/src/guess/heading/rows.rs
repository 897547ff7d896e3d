//! The rows that may tell an angle: equations along phases, and boundary conditions.

use crate::guess::equations::is_equation_along;
use crate::guess::start::Curve;
use crate::transcribe::rows::RowKind;
use crate::transcribe::slots::Source;
use crate::transcribe::{Quantity, Transcription};
use ntg_nlp::{Block as Elements, Nlp};
use ntg_structure::{At, Degree, Domain};
use std::collections::BTreeSet;

/// The slots of a function of a block that depend on an element's variables, with what they stand for.
pub(super) fn slots<'a>(
    nlp: &'a Transcription,
    (block, function): (usize, usize),
) -> impl Iterator<Item = (usize, usize, Option<&'a Source>)> {
    let sources = nlp.elements.batches.get(block).map_or(&[][..], |group| group.batch.sources());
    let entries = nlp.elements.blocks[block].jacobian.iter().enumerate();
    entries
        .filter(move |(_, (of, _))| *of == function)
        .map(move |(entry, (_, slot))| (entry, *slot, sources.get(*slot)))
}

/// The first variable of a slot of an element.
pub(super) fn variable(block: &Elements, element: usize, slot: usize) -> Option<u32> {
    let variables = block.variables(element);
    let map = &block.map(element)[slot * variables.len()..][..variables.len()];
    variables.iter().zip(map).find(|(_, c)| **c != 0.0).map(|(variable, _)| *variable)
}

/// The rows of equations along phases in which the value of an output stands and its derivatives do not.
pub(super) fn rows(nlp: &Transcription, output: &Quantity) -> Vec<usize> {
    let (structure, own) = (&nlp.model.structure, BTreeSet::from_iter(output.coefficients.iter().copied()));
    let is_one = |(number, element, function): (usize, usize, usize)| {
        let Some(group) = nlp.elements.batches.get(number) else { return false };
        let declared = &structure.groups[group.group];
        if !is_equation_along(structure, declared, function) || group.degree[function] <= Degree::Linear {
            return false;
        }
        let block = &nlp.elements.blocks[number];
        let is_own = |slot: usize| variable(block, element, slot).is_some_and(|variable| own.contains(&variable));
        let mut of_own = slots(nlp, (number, function)).filter(|(_, slot, _)| is_own(*slot)).peekable();
        let is_value = |source: Option<&Source>| matches!(source, Some(Source::Flat { derivative: 0, .. }));
        let is_rate = |source: Option<&Source>| matches!(source, Some(Source::Flat { derivative: 1.., .. }));
        of_own.peek().is_some()
            && of_own.all(|(_, _, source)| is_value(source))
            && slots(nlp, (number, function)).any(|(_, _, source)| is_rate(source))
    };
    let rows = nlp.elements.rows.iter().enumerate();
    let own = rows.filter(|(_, info)| matches!(info.kind, RowKind::Constraint(_)) && info.point.phase.is_some());
    own.filter(|(_, info)| is_one(info.maker)).map(|(row, _)| row).collect()
}

/// The boundary conditions at one end in which values alone stand, that of an angle among them.
pub(super) struct Boundary {
    pub(super) equations: Vec<usize>,
    pub(super) limits: Vec<usize>,
}

/// The boundary conditions of an output at the start and at the end of its time.
pub(super) fn boundaries(nlp: &Transcription, output: &Quantity) -> [Boundary; 2] {
    let (structure, limits) = (&nlp.model.structure, nlp.limits());
    let [(first, of_first), (last, of_last)] = [output.members[0], output.members[output.members.len() - 1]];
    [(first, of_first, At::Start, 0.0), (last, of_last, At::End, 1.0)].map(|(phase, output, at, tau)| {
        let is_one = |row: &usize| {
            let (number, _, function) = nlp.elements.rows[*row].maker;
            let point = &nlp.elements.rows[*row].point;
            let is_there = (point.phase, point.tau) == (Some(phase), tau);
            let Some(group) = nlp.elements.batches.get(number) else { return false };
            let is_along = matches!(structure.groups[group.group].domain, Domain::Path { .. });
            let is_value = |source: Option<&Source>| matches!(source, Some(Source::Flat { derivative: 0, .. }));
            let is_own = |source: Option<&Source>| {
                let Some(Source::Flat { phase: own, at: place, output: of, .. }) = source else { return false };
                (*own, *of) == (phase, output) && (*place == at || *place == At::Here && is_there)
            };
            !is_along
                && group.degree[function] > Degree::Linear
                && slots(nlp, (number, function)).any(|(_, _, source)| is_own(source))
                && slots(nlp, (number, function)).all(|(_, _, source)| is_value(source))
        };
        let is_equation = |row: &usize| limits.row_lower[*row] == limits.row_upper[*row];
        let (equations, limits) = (0..nlp.elements.rows.len()).filter(is_one).partition(is_equation);
        Boundary { equations, limits }
    })
}

/// The coefficients of outputs that nobody guesses and that may jump.
pub(super) fn unknown_inputs(nlp: &Transcription, guessed: &[Curve]) -> BTreeSet<u32> {
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let guessed: BTreeSet<_> = guessed.iter().map(|curve| (curve.phase, curve.output)).collect();
    let mut found = BTreeSet::new();
    for (phase, member) in layout.phases.iter().enumerate() {
        for (output, own) in member.outputs.iter().enumerate() {
            let is_input = structure.phases[member.phase].outputs[own.output].spline.smoothness == 0;
            if is_input && !guessed.contains(&(phase, output)) {
                found.extend(own.coefficients.iter().copied());
            }
        }
    }
    found
}
