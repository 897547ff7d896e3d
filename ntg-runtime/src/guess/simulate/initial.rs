//! Where a simulation begins: what the equalities about the start of a phase say.

use super::call::AtPlaces;
use super::motion::{Equations, Member};
use crate::transcribe::Transcription;
use crate::transcribe::elements::domain_sites;
use crate::transcribe::points::Point;
use crate::transcribe::slots::Source;
use nalgebra::{DMatrix, DVector};
use ntg_structure::{At, Domain, Group, Points};

/// Most Newton iterations. A choice: linear conditions take one.
const ITERATIONS: usize = 10;
/// Conditions times unknowns; with more a simulation begins where the guess does. A choice: a thousand of each take seconds.
const LARGEST: usize = 1_000_000;
/// Residuals beside the sizes of what they are made of. A choice: that of a guess.
const EXACT: f64 = 1e-10;

/// The values of a phase at its start, nearest to guessed ones: those below the highest derivatives satisfy the
/// equalities about the start in which nothing later takes part.
pub(super) fn initial(nlp: &Transcription, equations: &Equations, x: &[f64], sizes: &[f64]) -> Vec<f64> {
    let frame = nlp.frame();
    let mut values = equations.guessed(nlp);
    let position = |output: usize| equations.outputs.iter().position(|moving| *moving == output);
    let size_of = |output: usize| position(output).map_or(1.0, |i| sizes[i]);
    let unknown: Vec<(usize, usize)> = {
        let is_below = |(output, derivative): &&(usize, usize)| {
            position(*output).is_some_and(|i| *derivative < equations.orders[i])
        };
        equations.columns.keys().filter(is_below).copied().collect()
    };
    // Equations of states that hold at the ends of intervals hold at the start.
    let is_at_start = |group: &Group| match &group.domain {
        Domain::Start(_) => true,
        Domain::Path { phase, points, part } => {
            let points = frame.structure.phases[phase.phase].points.get(*points);
            part.is_whole() && points == Some(&Points::Breakpoints)
        }
        _ => false,
    };
    // What a slot is: one of the unknown values, known, or something that only comes later.
    let column = |member: &Member, source: Source| match source {
        Source::Flat { phase, at, output, derivative } => {
            let at_start = match at {
                At::Start => true,
                At::Here => is_at_start(member.group),
                _ => false,
            };
            match phase == equations.phase {
                true if at_start => unknown.iter().position(|known| *known == (output, derivative)).map(Some).ok_or(()),
                true => Err(()),
                false if phase < equations.phase => Ok(None),
                false => Err(()),
            }
        }
        _ => Ok(None),
    };
    let mut conditions = vec![];
    for group in &frame.structure.groups {
        let starts = match &group.domain {
            Domain::Path { .. } if !is_at_start(group) => continue,
            Domain::Path { .. } => vec![Point::start(equations.phase)],
            _ => vec![],
        };
        let start = |_: &_, _: &[f64], of: usize| if of == equations.phase { starts.clone() } else { vec![] };
        let Ok(sites) = domain_sites(&frame, &group.loops, &group.domain, start) else { continue };
        for site in sites {
            let Some(mut member) = Member::new(&frame, group, site) else { continue };
            let rows = std::mem::take(&mut member.rows);
            let says = |row: usize| {
                let columns: Result<Vec<_>, ()> =
                    member.sources_of(row).map(|source| column(&member, source)).collect();
                columns.is_ok_and(|columns| columns.iter().any(Option::is_some))
            };
            member.rows = rows.into_iter().filter(|(row, _)| says(*row)).collect();
            if member.rows.is_empty() {
                continue;
            }
            if let Some(call) = AtPlaces::new(&frame, &group.call, vec![member.site.clone()], x) {
                conditions.push((member, call));
            }
        }
    }
    let count: usize = conditions.iter().map(|(member, _)| member.rows.len()).sum();
    let is_small = (1..=LARGEST).contains(&(count * unknown.len()));
    for _ in 0..if is_small { ITERATIONS } else { 0 } {
        let mut residual = DVector::zeros(count);
        let mut jacobian = DMatrix::zeros(count, unknown.len());
        let mut equation = 0;
        for (member, call) in &mut conditions {
            let columns: Vec<Option<usize>> =
                member.sources.iter().map(|source| column(member, *source).ok().flatten()).collect();
            for (slot, column) in columns.iter().enumerate() {
                if let Some(column) = column {
                    call.slots[slot] = values[equations.columns[&unknown[*column]]];
                }
            }
            call.evaluate(&frame);
            for (row, wanted) in &member.rows {
                residual[equation] = call.out.values[*row] - wanted;
                for (entry, (_, slot)) in call.pattern.iter().enumerate().filter(|(_, (r, _))| r == row) {
                    if let Some(column) = columns[*slot] {
                        jacobian[(equation, column)] += call.out.jacobian[entry] * size_of(unknown[column].0);
                    }
                }
                equation += 1;
            }
        }
        for row in 0..count {
            let largest = jacobian.row(row).amax();
            if largest > 0.0 {
                jacobian.row_mut(row).unscale_mut(largest);
                residual[row] /= largest;
            }
        }
        if !residual.iter().chain(jacobian.iter()).all(|value: &f64| value.is_finite()) || residual.amax() < EXACT {
            break;
        }
        let Ok(step) = jacobian.svd(true, true).solve(&residual, 1e-10) else { break };
        for (at, step) in unknown.iter().zip(step.iter()) {
            values[equations.columns[at]] -= step * size_of(at.0);
        }
    }
    values
}
