//! The parts of a conflict in the user's words: name, place, time, amount.

use super::{AS_GOOD_AS_NONE, Constraints, IDLE, NOTHING, Part, Relaxed, Search};
use crate::transcribe::layout::Time;
use crate::transcribe::names;
use crate::transcribe::rows::constraint_name;
use ntg_nlp::{Nlp, residuals};
use ntg_structure::{Place, Unit};

impl Search<'_> {
    /// The parts of a conflict: what its least violation misses, the worst first, and what holds only because of that.
    pub(super) fn parts(&self, kept: &Constraints, relaxed: &Relaxed) -> Vec<Part> {
        let mut parts: Vec<(f64, Part)> = kept.iter().filter_map(|c| self.part(*c, relaxed)).collect();
        let largest = parts.iter().map(|(relative, _)| *relative).fold(0.0, f64::max);
        for (relative, part) in parts.iter_mut().filter(|(relative, _)| *relative < AS_GOOD_AS_NONE * largest) {
            (*relative, part.amount) = (0.0, 0.0);
        }
        parts.extend(self.bounds(relaxed).into_iter().map(|part| (0.0, part)));
        parts.sort_by(|a, b| b.0.total_cmp(&a.0));
        parts.into_iter().map(|(_, part)| part).collect()
    }

    /// One constraint with its relative violation: at its worst row, or at the row with the largest
    /// multiplier where all hold.
    fn part(&self, constraint: usize, relaxed: &Relaxed) -> Option<(f64, Part)> {
        let (limits, rows) = (&self.nlp.limits, &relaxed.rows);
        let missed = |row: usize| residuals::violation(rows[row], limits.row_lower[row], limits.row_upper[row]);
        let own = (0..rows.len()).filter(|row| self.constraint(*row) == Some(constraint));
        let key = |row: &usize| {
            let relative = missed(*row) / limits.row_scale[*row];
            (if relative > NOTHING { relative } else { 0.0 }, relaxed.outcome.row_multipliers[*row].abs())
        };
        let worst = own.max_by(|a, b| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal))?;
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        let declared = &structure.constraints[constraint];
        let point = self.nlp.elements.rows[worst].point;
        let x = &relaxed.outcome.x;
        let relative = key(&worst).0;
        let part = Part {
            name: constraint_name(declared).to_owned(),
            is_bound: false,
            indices: self.nlp.elements.rows[worst].indices.clone(),
            place: declared.place.clone(),
            amount: if relative > 0.0 { missed(worst) / declared.unit.factor } else { 0.0 },
            unit: declared.unit.clone(),
            time: point.phase.map(|phase| layout.start(phase, x) + point.tau * layout.duration(phase, x)),
            phase: point.phase.map(|phase| names::phase(structure, layout, phase)).unwrap_or_default(),
        };
        Some((relative, part))
    }

    /// Bounds of durations, starts and variables against which the violation pushes.
    fn bounds(&self, relaxed: &Relaxed) -> Vec<Part> {
        let (_, largest) = self.weights(relaxed);
        let scale = &self.nlp.limits.scale;
        let pushed = |v: &usize| relaxed.outcome.bound_multipliers[*v].abs() * scale[*v] > IDLE * largest.max(NOTHING);
        let bounded = (self.nlp.model.layout.coefficients..self.nlp.variables()).filter(pushed);
        let part = |variable: usize| {
            let side = if relaxed.outcome.bound_multipliers[variable] > 0.0 { "lower" } else { "upper" };
            Part {
                name: format!("the {side} bound of {}", self.nlp.variable_name(variable)),
                is_bound: true,
                indices: vec![],
                place: self.place(variable),
                amount: 0.0,
                unit: Unit::default(),
                time: None,
                phase: String::new(),
            }
        };
        bounded.map(part).collect()
    }

    /// Where a duration, start or variable stands.
    fn place(&self, variable: usize) -> Place {
        let (structure, layout) = (&self.nlp.model.structure, &self.nlp.model.layout);
        let is = |time: Time| matches!(time, Time::Free(v) if v as usize == variable);
        if let Some(phase) = layout.phases.iter().find(|phase| is(phase.duration)) {
            return structure.phases[phase.phase].place.clone();
        }
        if let Some(agent) = layout.agents.iter().find(|agent| is(agent.start)) {
            return structure.agents[agent.agent].place.clone();
        }
        let last = layout.variable_first.partition_point(|first| *first as usize <= variable);
        let declared = last.checked_sub(1).and_then(|at| structure.variables.get(at));
        declared.map(|declared| declared.place.clone()).unwrap_or_default()
    }
}
