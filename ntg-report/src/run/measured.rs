//! When and of which quantity each measured number is, so that it can be drawn beside what was found.
//!
//! Takes a run with its estimate and the problem that was solved; fills the times, quantities and measured values of
//! residuals. Afterwards: a residual has a time where all that it is made of is taken at one; it has a quantity where one
//! side of its statement is nothing but an output or named expression at that time.

use std::collections::BTreeSet;

use ntg_compiler::source::Source;
use ntg_compiler::syntax::ast::{self, ExprKind};
use ntg_runtime::solution::{PhaseTimes, Solution, Trajectory};
use ntg_runtime::structure::{At, Call, Loop, PhaseRef, Slot, Structure};

use super::Run;

/// A statement of `measure`, as far as it is about one quantity.
#[derive(Clone, Debug)]
pub(crate) struct Sides {
    /// Where it stands: line and column.
    pub(super) place: (usize, usize),
    /// The quantity that is taken at a time, as written.
    pub(super) quantity: Option<String>,
    /// Whether that is the left side.
    pub(super) left: bool,
}

/// The statements of `measure` in a block.
pub(super) fn sides(statements: &[ast::Statement<ast::Constraint>], source: &Source, found: &mut Vec<Sides>) {
    for statement in statements {
        match statement {
            ast::Statement::For(inner) => sides(&inner.body, source, found),
            ast::Statement::One(constraint) => {
                let ast::Relation::Compare { left, right, .. } = &constraint.relation else { continue };
                let of = |side: &ast::Expr| {
                    let path = taken(side)?;
                    source.text.get(path.span.start as usize..path.span.end as usize).map(str::to_owned)
                };
                let start = source.place(constraint.span.start);
                let (quantity, is_left) = match (of(left), of(right)) {
                    (Some(quantity), _) => (Some(quantity), true),
                    (None, quantity) => (quantity, false),
                };
                found.push(Sides { place: (start.line, start.column), quantity, left: is_left });
            }
        }
    }
}

/// The quantity of `at(t, q)`, `initial(q)` and `final(q)`.
fn taken(side: &ast::Expr) -> Option<&ast::Path> {
    let of = match &side.kind {
        ExprKind::Call(call) if call.function.text == "at" => call.arguments.get(1)?,
        ExprKind::Boundary { of, path: None, .. } => of,
        _ => return None,
    };
    match &of.kind {
        ExprKind::Path(path) => Some(path),
        _ => None,
    }
}

/// What is needed to place a measured number.
struct Found<'a> {
    run: &'a Run,
    structure: &'a Structure,
    phases: Vec<PhaseTimes>,
    trajectories: Vec<Trajectory>,
}

/// Fills in the residuals of a run. Times are in SI units here.
pub(super) fn fill(run: &mut Run, solution: &Solution, sides: &[Sides]) {
    let Some(mut estimate) = run.estimate.take() else { return };
    let structure = solution.structure();
    let (phases, trajectories) = (solution.phases(), solution.trajectories());
    let found = Found { run, structure, phases, trajectories };
    let mut terms: Vec<usize> = vec![];
    for measurement in &structure.measurements {
        if !terms.contains(&measurement.term) {
            terms.push(measurement.term);
        }
    }
    for (term, reported) in terms.into_iter().zip(&mut estimate.measurements) {
        let place = &structure.terms[term].place;
        let said = sides.iter().find(|sides| sides.place == (place.line as usize, place.column as usize));
        let parts = structure.measurements.iter().filter(|measurement| measurement.term == term);
        let members = parts.flat_map(|part| members(&part.loops).into_iter().map(move |indices| (part, indices)));
        for ((part, indices), residual) in members.zip(&mut reported.residuals) {
            let Some(t) = found.time(&part.residual, &indices) else { continue };
            residual.t = Some(t);
            let Some((path, value, factor)) = said.and_then(|said| found.quantity(said, &part.residual, &indices, t))
            else {
                continue;
            };
            let unit = part.unit.factor / factor;
            let missed = residual.value * unit;
            // What is met exactly does not tell its deviation.
            residual.sigma = Some((missed / residual.ratio).abs()).filter(|sigma| sigma.is_finite());
            let is_left = said.is_some_and(|said| said.left);
            residual.measured = Some(if is_left { value - missed } else { value + missed });
            residual.of = path;
        }
    }
    run.estimate = Some(estimate);
}

/// All members of nested loops, the last index running fastest.
fn members(loops: &[Loop]) -> Vec<Vec<i64>> {
    let mut all = vec![vec![]];
    for over in loops {
        let inner = |outer: Vec<i64>| {
            let ends = over.first.at(&outer)..=over.last.at(&outer);
            ends.map(move |value| outer.iter().copied().chain([value]).collect::<Vec<i64>>())
        };
        all = all.into_iter().flat_map(inner).collect();
    }
    all
}

/// The slots of a call and of its reductions.
fn slots(call: &Call) -> Vec<&Slot> {
    call.slots.iter().chain(call.reductions.iter().flat_map(|reduction| slots(&reduction.body))).collect()
}

impl Found<'_> {
    /// The one time at which everything is taken.
    fn time(&self, call: &Call, indices: &[i64]) -> Option<f64> {
        let mut found: Option<f64> = None;
        for slot in slots(call) {
            let Slot::Flat { phase, at, .. } = slot else { continue };
            let tau = match at {
                At::Here => return None,
                At::Start => 0.0,
                At::End => 1.0,
                At::Inside(instant) => instant.tau(),
                At::Among { places, index } => self.structure.places.get(*places)?.at(*indices.get(*index)?)?.tau(),
            };
            let own = self.phases.get(self.phase(phase, indices)?)?;
            let t = own.start + tau * (own.end - own.start);
            match found {
                Some(other) if (other - t).abs() > 1e-9 * (other.abs() + t.abs()) => return None,
                _ => found = Some(t),
            }
        }
        found
    }

    /// The number of a phase among those of all agents, each agent's in order of time.
    fn phase(&self, wanted: &PhaseRef, indices: &[i64]) -> Option<usize> {
        let index = |index: &Option<ntg_runtime::structure::Affine>| index.as_ref().map(|index| index.at(indices));
        let wanted = (wanted.phase, index(&wanted.agent), index(&wanted.index));
        let members = |family: Option<ntg_runtime::structure::Family>| -> Vec<Option<i64>> {
            family.map_or(vec![None], |family| (family.first..=family.last).map(Some).collect())
        };
        let mut number = 0;
        for (agent, declared) in self.structure.agents.iter().enumerate() {
            for member in members(declared.family) {
                for (phase, own) in self.structure.phases.iter().enumerate().filter(|(_, own)| own.agent == agent) {
                    for index in members(own.family) {
                        if wanted == (phase, member, index) {
                            return Some(number);
                        }
                        number += 1;
                    }
                }
            }
        }
        None
    }

    /// The path of what was measured, its value at the time, and SI units in its unit.
    fn quantity(&self, said: &Sides, call: &Call, indices: &[i64], t: f64) -> Option<(String, f64, f64)> {
        let text = said.quantity.as_ref()?;
        let slots = slots(call);
        let flats = slots.iter().filter_map(|slot| match slot {
            Slot::Flat { phase, output, index, derivative, .. } => Some((phase, *output, index, *derivative)),
            _ => None,
        });
        let flats: BTreeSet<_> = flats.collect();
        let (phase, ..) = *flats.first()?;
        let prefix = self.prefix(phase, indices)?;
        if let [(phase, output, index, 0)] = flats.iter().copied().collect::<Vec<_>>()[..] {
            let declared = self.structure.phases.get(phase.phase)?.outputs.get(output)?;
            let member = index.as_ref().map(|index| index.at(indices));
            let element = declared.family.zip(member).map_or_else(String::new, |(family, member)| family.index(member));
            let path = format!("{prefix}{}{element}", declared.name);
            let own = self.trajectories.iter().find(|trajectory| trajectory.name() == path);
            if let Some(own) = own.filter(|_| text.starts_with(&declared.name)) {
                return Some((path, own.at(t), own.unit().factor));
            }
        }
        let element = indices.last().map(|index| format!("{prefix}{text}[{index}]"));
        let path = [Some(format!("{prefix}{text}")), element]
            .into_iter()
            .flatten()
            .find(|path| self.run.lets.get(path).is_some_and(|series| !series.t.is_empty()))?;
        let series = &self.run.lets[&path];
        Some((path, between(&series.t, &series.value, t), series.factor))
    }

    /// The path of an agent with its point; empty where there are none.
    fn prefix(&self, phase: &PhaseRef, indices: &[i64]) -> Option<String> {
        let agent = &self.structure.agents[self.structure.phases.get(phase.phase)?.agent];
        let Some(name) = &agent.name else { return Some(String::new()) };
        let member = agent.family.zip(phase.agent.as_ref());
        let member = member.map_or_else(String::new, |(family, index)| family.index(index.at(indices)));
        Some(format!("{name}{member}."))
    }
}

/// The value between samples.
fn between(t: &[f64], value: &[f64], at: f64) -> f64 {
    let high = t.partition_point(|t| *t < at).min(t.len().saturating_sub(1));
    let low = high.saturating_sub(1);
    let share = if t[high] > t[low] { ((at - t[low]) / (t[high] - t[low])).clamp(0.0, 1.0) } else { 0.0 };
    value[low] + share * (value[high] - value[low])
}
