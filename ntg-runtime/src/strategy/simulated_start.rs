//! A simulation first: where a spec has no objective, or leaves nothing free, so that there is one motion to find, which is mostly
//! the simulation itself (docs/maths.md, section 8.6).

use super::budget::Budget;
use super::session::{FirstPoint, Session, Task};
use crate::digits::brief;
use crate::guess::{Guess, simulated};
use crate::report::Elsewhere;
use crate::settings::{Method, Settings};
use crate::transcribe::points::Point;
use crate::transcribe::slots::AffineMap;
use crate::transcribe::{SetupError, Transcription, names};
use ntg_nlp::{Nlp, Outcome, Start};

impl Session {
    /// An attempt from a simulation for the guess `x`, where there is one motion to find; none elsewhere. Scales are those of the
    /// simulation afterwards.
    pub(super) fn solve_simulated(
        &mut self,
        nlp: &mut Transcription,
        (task, x): (Task<'_>, &[f64]),
        settings: &Settings,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Outcome>, SetupError> {
        if !is_only_motion(nlp) || settings.method != Method::Auto || !task.guess.is_none_or(Guess::is_empty) {
            return Ok(None);
        }
        let Some((limits, simulated)) = budget.near().zip(simulated(nlp, x)) else { return Ok(None) };
        nlp.set_scales(&simulated, &limits)?;
        let outcome = self.solve_measured(nlp, FirstPoint { x: &simulated, from: Start::Cold }, &limits);
        budget.spend(outcome.iterations);
        Ok(Some(outcome))
    }
}

/// Whether one motion is to be found: there is no objective, or nothing that it could choose.
fn is_only_motion(nlp: &Transcription) -> bool {
    nlp.model.structure.terms.is_empty() || has_no_freedom(nlp) && begins_as_given(nlp)
}

/// Whether all that moves is given where its agent starts: a motion between conditions at both ends may be far from the one that
/// follows from a guess of its start.
fn begins_as_given(nlp: &Transcription) -> bool {
    let layout = &nlp.model.layout;
    layout.agents.iter().all(|agent| {
        let phase = agent.phases.start;
        let (member, at) = (&layout.phases[phase], Point::start(phase));
        let declared = |output: usize| &nlp.model.structure.phases[member.phase].outputs[member.outputs[output].output];
        let is_given = |output: usize, derivative: usize| {
            let terms = layout.basis(phase, output, derivative, at.tau, at.side);
            nlp.linear.value(&AffineMap { terms, offset: 0.0 }).is_some()
        };
        let mut moving = (0..member.outputs.len()).filter(|output| !declared(*output).is_helper());
        moving.all(|output| (0..declared(output).spline.smoothness).all(|derivative| is_given(output, derivative)))
    })
}

/// Whether equations are as many as the variables that are not fixed and stand in them. What stands in none, as the helper of a
/// corner, moves nothing.
fn has_no_freedom(nlp: &Transcription) -> bool {
    let limits = nlp.limits();
    let mut stands = vec![false; limits.lower.len()];
    let mut equations = 0;
    for (row, info) in nlp.elements.rows.iter().enumerate() {
        if limits.row_lower[row] != limits.row_upper[row] {
            continue;
        }
        equations += 1;
        let (number, element, function) = info.maker;
        let block = &nlp.blocks()[number];
        let variables = block.variables(element);
        for (_, slot) in block.jacobian.iter().filter(|(of, _)| *of == function) {
            let map = &block.map(element)[slot * variables.len()..][..variables.len()];
            let own = variables.iter().zip(map).filter(|(_, c)| **c != 0.0);
            own.for_each(|(variable, _)| stands[*variable as usize] = true);
        }
    }
    let is_open = |(j, stands): (usize, &bool)| *stands && limits.lower[j] < limits.upper[j];
    stands.iter().enumerate().filter(|own| is_open(*own)).count() <= equations
}

/// How much further than this part of their sizes outputs may be from the simulation. A law: a hundred times its tolerance.
const APART: f64 = 1e-2;

/// What a simulation tells of the motion that was to be found, in words: that the mesh is too coarse, where no motion was
/// found, or another one. `x` has inputs, times and variables, and the motion.
pub(super) fn told_by_simulation(nlp: &Transcription, x: &[f64], is_found: bool) -> Option<Elsewhere> {
    if !is_only_motion(nlp) {
        return None;
    }
    let simulated = simulated(nlp, x)?;
    if !is_found {
        let words = "a simulation follows this motion to its end, but the splines on this mesh do not: it needs more intervals where it \
             changes fast, which refining the mesh finds";
        return Some(Elsewhere { apart: f64::INFINITY, words: words.to_owned() });
    }
    let (structure, layout) = (&nlp.model.structure, &nlp.model.layout);
    let apart = |v: u32| (x[v as usize] - simulated[v as usize]).abs();
    let size = |v: u32| x[v as usize].abs().max(simulated[v as usize].abs()).max(nlp.limits.scale[v as usize]);
    let mut worst: Option<(f64, String)> = None;
    for (phase, member) in layout.phases.iter().enumerate() {
        for (output, own) in member.outputs.iter().enumerate() {
            let largest = own.coefficients.iter().map(|v| apart(*v)).fold(0.0, f64::max);
            let relative = largest / own.coefficients.iter().map(|v| size(*v)).fold(f64::MIN_POSITIVE, f64::max);
            if relative > worst.as_ref().map_or(APART, |(worst, _)| *worst) {
                let unit = &structure.phases[member.phase].outputs[own.output].unit;
                let name = names::output(structure, layout, phase, output);
                let symbol = if unit.symbol.is_empty() { String::new() } else { format!(" {}", unit.symbol) };
                worst = Some((relative, format!("`{name}` by {}{symbol}", brief(largest / unit.factor))));
            }
        }
    }
    worst.map(|(apart, what)| {
        let words = format!(
            "a simulation of this motion leads elsewhere, {what}: the mesh is too coarse for it (refining it tells), or small \
             errors grow without limit"
        );
        Elsewhere { apart, words }
    })
}
