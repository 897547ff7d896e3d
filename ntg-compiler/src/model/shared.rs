//! What scenarios have in common: inputs that are the same for all members, all the way or up to some time.
//!
//! Takes the `shared` items, whose outputs are arrays with the scenario's members first; fills `Problem::shared`.
//! Finds: times that are no end of an interval (E093).

use ntg_structure::Shared;

use super::elaborator::Elaborator;
use super::scope::{Allow, Point};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{self, Expr, ItemKind, Segment};

/// How far a scaled time may be from a breakpoint that is meant: some roundings.
const ROUNDING: f64 = 1e-9;

impl<'a> Elaborator<'a> {
    /// All inputs that are shared.
    pub(super) fn shared(&mut self) {
        for scope in 0..self.scopes.len() {
            for item in self.items[scope] {
                let ItemKind::Shared(shared) = &item.kind else { continue };
                let Some(agent) = self.scopes[scope].agent else { continue }; // Told of as standing at the wrong level.
                self.shared_in(agent, shared);
            }
        }
    }

    fn shared_in(&mut self, agent: usize, shared: &'a ast::Shared) {
        let phases = self.agents[agent].phases.clone();
        let ends = match &shared.until {
            None => phases.iter().map(|phase| (*phase, 1.0)).collect(),
            Some(until) => match self.ends(agent, until) {
                Some(ends) => ends,
                None => return,
            },
        };
        for input in &shared.inputs {
            for (phase, tau) in &ends {
                let outputs = &self.problem.phases[*phase].outputs;
                if let Some(output) = outputs.iter().position(|output| output.name == input.name.text) {
                    let until = shared.until.as_ref().map_or(input.span, |until| until.span);
                    self.share((*phase, output), input, (*tau, until));
                }
            }
        }
    }

    /// How far each phase is before a time: 1 for those before, then a part of one.
    fn ends(&mut self, agent: usize, until: &'a Expr) -> Option<Vec<(usize, f64)>> {
        let cx = self.agent_context(agent, Allow::All).at(Point::Nowhere);
        let stretches = self.members_of(self.stretches(agent, cx.agent.clone()));
        let spot = self.spot(&cx, until, &stretches).ok()?;
        let last = stretches[spot.number].phase;
        if self.problem.phases[last].family.is_some() {
            let message =
                format!("`{}` lies in a family of phases, whose members have one spline", self.text(until.span));
            let finding = Diagnostic::new(Code::UnknownPlace, until.span, message);
            self.report(finding.help("let it be the start or the end of a phase of its own"));
            return None;
        }
        let before = stretches[..spot.number].iter().map(|stretch| (stretch.phase, 1.0));
        let mut ends: Vec<(usize, f64)> = before.chain([(last, spot.instant.tau())]).collect();
        ends.dedup();
        ends.retain(|(_, tau)| *tau > 0.0);
        Some(ends)
    }

    /// One output of one phase.
    fn share(&mut self, (phase, output): (usize, usize), input: &'a Segment, (tau, span): (f64, Span)) {
        let breakpoints = &self.problem.phases[phase].outputs[output].spline.breakpoints;
        let near = breakpoints.iter().copied().find(|point| (point - tau).abs() <= ROUNDING);
        let Some(tau) = near else {
            self.no_breakpoint(phase, output, (tau, span));
            return;
        };
        let axes = self.output_axes[phase][output].clone();
        let count =
            |ends: &super::shape::Ends| ends.extent().and_then(|extent| usize::try_from(extent).ok()).unwrap_or(0);
        let elements: usize = axes.iter().skip(1).map(count).product();
        let chosen = match input.indices.is_empty() {
            true => None,
            false => match self.element_shared(phase, input, axes.get(1..).unwrap_or_default()) {
                Some(element) => Some(element),
                None => return,
            },
        };
        let until = |element: usize| if chosen.is_none_or(|chosen| chosen == element) { tau } else { 0.0 };
        let own: Vec<f64> = (0..elements).map(until).collect();
        match self.problem.shared.iter_mut().find(|known| (known.phase, known.output) == (phase, output)) {
            Some(known) => known.until.iter_mut().zip(own).for_each(|(known, own)| *known = known.max(own)),
            None => self.problem.shared.push(Shared { phase, output, until: own }),
        }
    }

    /// Which element of a member is meant by the indices behind its name, counted from 0.
    fn element_shared(&mut self, phase: usize, input: &'a Segment, axes: &[super::shape::Ends]) -> Option<usize> {
        if axes.len() != input.indices.len() || input.indices.iter().any(|index| index.last.is_some()) {
            self.wrong_indices(input, axes.len());
            return None;
        }
        let cx = self.phase_context(phase, Allow::Constants, Point::Nowhere);
        let mut element = 0;
        for (index, ends) in input.indices.iter().zip(axes) {
            let value = self.whole(&cx, &index.first, "an index")?;
            let (first, last) = ends.numbers()?;
            if !(first..=last).contains(&value) {
                let message = format!("`{}` has no element {value}: they are {first} .. {last}", input.name.text);
                let finding = Diagnostic::new(Code::WrongIndices, index.span, message);
                self.report(finding.help("write the index of an element"));
                return None;
            }
            element = element * usize::try_from(last - first + 1).ok()? + usize::try_from(value - first).ok()?;
        }
        Some(element)
    }

    /// Tells that a time is no end of an interval, and which are near.
    fn no_breakpoint(&mut self, phase: usize, output: usize, (tau, span): (f64, Span)) {
        let declared = &self.problem.phases[phase].outputs[output];
        let (name, breakpoints) = (declared.name.clone(), declared.spline.breakpoints.clone());
        let after = breakpoints.partition_point(|point| *point < tau).min(breakpoints.len() - 1);
        let text = self.text(span);
        let message = format!("`{text}` is no end of an interval of `{name}`");
        let words = |tau: f64| self.place_in_words(phase, tau);
        let help = format!(
            "the nearest ends are {} and {}; breakpoints of your own are `knots` in `collocation`",
            words(breakpoints[after.saturating_sub(1)]),
            words(breakpoints[after])
        );
        let finding = Diagnostic::new(Code::UnknownPlace, span, message).label(declared.span, "declared here");
        self.report(finding.help(help));
    }
}
