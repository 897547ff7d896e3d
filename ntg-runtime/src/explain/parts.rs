//! The parts of a conflict in the user's words: name, place, time, amount.

use super::{AS_GOOD_AS_NONE, Constraints, IDLE, NOTHING, PRICE, Part, Relaxed, Search};
use crate::transcribe::layout::Time;
use crate::transcribe::names;
use crate::transcribe::rows::constraint_name;
use ntg_nlp::{Nlp, residuals};
use ntg_structure::{Place, Unit};

/// A part with what its place in the list depends on.
struct Ranked {
    part: Part,
    is_held: bool,
    /// Its largest scaled violation.
    relative: f64,
    /// The sum of its scaled violations, or of its scaled multipliers where it holds.
    share: f64,
}

impl Ranked {
    /// What gives way comes before what holds only because others do not, bounds, and what is held.
    fn rank(&self) -> (bool, bool, bool) {
        (self.is_held, self.part.is_bound, self.part.amount == 0.0)
    }
}

impl Search<'_> {
    /// The parts of a conflict in the order of [`super::Conflict::parts`], and how many were left out: what holds and is not
    /// known to be needed, `open`, is no part. Where anything is open, that is so of all bounds.
    pub(super) fn parts(&self, kept: &Constraints, open: &Constraints, relaxed: &Relaxed) -> (Vec<Part>, usize) {
        let own = kept.iter().filter_map(|c| Some((open.contains(c), self.part(*c, relaxed)?)));
        let (doubtful, mut parts): (Vec<bool>, Vec<Ranked>) = own.unzip();
        let largest = parts.iter().map(|ranked| ranked.relative).fold(0.0, f64::max);
        for ranked in parts.iter_mut().filter(|ranked| ranked.relative < AS_GOOD_AS_NONE * largest) {
            ranked.part.amount = 0.0;
        }
        let bound = |part| Ranked { part, is_held: false, relative: 0.0, share: 0.0 };
        let bounds = self.bounds(relaxed).into_iter().map(|part| (!open.is_empty(), bound(part)));
        let all: Vec<(bool, Ranked)> = doubtful.into_iter().zip(parts).chain(bounds).collect();
        let is_part = |(doubtful, ranked): &(bool, Ranked)| !doubtful || ranked.part.amount != 0.0;
        let (mut parts, left): (Vec<_>, Vec<_>) = all.into_iter().partition(is_part);
        parts.sort_by(|(_, a), (_, b)| a.rank().cmp(&b.rank()).then(b.share.total_cmp(&a.share)));
        if let (1, 1, Some(only)) = (parts.len(), kept.len(), kept.first()) {
            parts.extend(self.rivals(*only, relaxed).into_iter().map(|part| (false, bound(part))));
        }
        (parts.into_iter().map(|(_, ranked)| ranked.part).collect(), left.len())
    }

    /// Other constraints of what a constraint is about. Where the slope of it vanishes, as that of a cosine at 0, a
    /// constraint seems to contradict nothing but itself.
    fn rivals(&self, only: usize, relaxed: &Relaxed) -> Vec<Part> {
        let all = &self.nlp.model.structure.constraints;
        let own = &all[only];
        let about = subject(&own.place.text);
        let is_rival = |c: &usize| *c != only && all[*c].block == own.block && subject(&all[*c].place.text) == about;
        let rivals = (0..all.len()).filter(|c| about.is_some() && is_rival(c));
        rivals.filter_map(|c| Some(Part { amount: 0.0, ..self.part(c, relaxed)?.part })).collect()
    }

    /// One constraint at its worst row, or at the row with the largest multiplier where all hold.
    fn part(&self, constraint: usize, relaxed: &Relaxed) -> Option<Ranked> {
        let (limits, rows) = (&self.nlp.limits, &relaxed.rows);
        let missed = |row: usize| residuals::violation(rows[row], limits.row_lower[row], limits.row_upper[row]);
        let own: Vec<usize> = (0..rows.len()).filter(|row| self.constraint(*row) == Some(constraint)).collect();
        let key = |row: &usize| {
            let relative = missed(*row) * self.factors[*row];
            (if relative > NOTHING { relative } else { 0.0 }, self.multiplier(*row, relaxed))
        };
        let by_key = |a: &usize, b: &usize| key(a).partial_cmp(&key(b)).unwrap_or(std::cmp::Ordering::Equal);
        let worst = own.iter().copied().max_by(by_key)?;
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
            independent: structure.independent.clone(),
            phase: point.phase.map(|phase| names::phase(structure, layout, phase)).unwrap_or_default(),
        };
        let size = |row: &usize| if relative > 0.0 { key(row).0 } else { key(row).1 };
        let share = own.iter().map(size).sum();
        Some(Ranked { part, is_held: self.is_held(worst), relative, share })
    }

    /// Bounds of durations, starts and variables against which the violation pushes.
    fn bounds(&self, relaxed: &Relaxed) -> Vec<Part> {
        let scale = &self.nlp.limits.scale;
        let pushed = |v: &usize| relaxed.outcome.bound_multipliers[*v].abs() * scale[*v] > IDLE * PRICE;
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
                independent: self.nlp.model.structure.independent.clone(),
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

/// What the text of a constraint is about: its left side.
fn subject(text: &str) -> Option<&str> {
    let ends = ["==", "<=", ">=", " in "].into_iter().filter_map(|sign| text.find(sign));
    ends.min().map(|end| text[..end].trim())
}
