//! Continuity where one phase follows another.
//!
//! Takes the order of phases, adds constraints that hold every output and its derivatives up to
//! order m - 1 (the smaller m of the two splines) continuous in real time.
//! Finds: `jump` and `continuous` of what is no output, derivatives that the splines do not have.

use ntg_structure::{Block, Unit};

use super::elaborator::Elaborator;
use super::problem::{At, Bounds, Constraint, Domain, Form, Imposed, Leaf, Loop, PhaseAt};
use super::scope::{Allow, Context, Point};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{ItemKind, Path, Segment};

/// Where two phases meet.
struct Junction {
    before: PhaseAt,
    after: PhaseAt,
    loops: Vec<Loop>,
    span: Span,
}

impl<'a> Elaborator<'a> {
    /// All junctions of all agents.
    pub(super) fn continuity(&mut self) {
        for phase in 0..self.phases.len() {
            let limits = self.limits(phase);
            let span = self.phases[phase]
                .item
                .and_then(|item| item.after.as_ref())
                .map_or(self.phases[phase].span, |s| s.span);
            let agent = self.agent_context(self.phases[phase].agent, Allow::All);
            let member = agent.agent.clone();
            let loops = (*agent.loops).clone();
            let family = self.problem.phases[phase].family.clone();
            let at = |phase: usize, index: Option<Form>| PhaseAt { phase, agent: member.clone(), index };
            if let Some(before) = self.phases[phase].after {
                let last = self.problem.phases[before].family.as_ref().map(|over| over.last.clone());
                let first = family.as_ref().map(|over| over.first.clone());
                let junction =
                    Junction { before: at(before, last), after: at(phase, first), loops: loops.clone(), span };
                self.join(&junction, &limits);
            }
            if let Some(family) = family
                && family.first.constant < family.last.constant
            {
                let second = Form::number(family.first.constant + 1);
                let over = self.new_index(second, family.last.clone());
                let after = Form::index(over.index);
                let before = Form { constant: -1, ..after.clone() };
                let loops = loops.into_iter().chain([over]).collect();
                let junction = Junction { before: at(phase, Some(before)), after: at(phase, Some(after)), loops, span };
                self.join(&junction, &limits);
            }
        }
    }

    /// For each output and member of a phase: how many derivatives (the value included) are
    /// continuous at its start, where the phase says so.
    fn limits(&mut self, phase: usize) -> Vec<(usize, Option<i64>, usize)> {
        let mut limits = Vec::new();
        if self.phases[phase].item.is_none() {
            return limits;
        }
        let cx = self.phase_context(phase, Allow::Constants, Point::Nowhere);
        for item in self.items[self.phases[phase].scope] {
            match &item.kind {
                ItemKind::Jump(jump) => {
                    for path in &jump.outputs {
                        if let Some((output, member)) = self.junction_path(&cx, phase, path) {
                            limits.push((output, member, 0));
                        }
                    }
                }
                ItemKind::Continuous(continuous) => {
                    let Some(up_to) = self.natural(&cx, &continuous.up_to, "the order of a derivative") else {
                        continue;
                    };
                    for path in &continuous.outputs {
                        let Some((output, member)) = self.junction_path(&cx, phase, path) else { continue };
                        let declared = &self.problem.phases[phase].outputs[output];
                        if up_to < declared.spline.order {
                            limits.push((output, member, up_to + 1));
                            continue;
                        }
                        let message = format!(
                            "`{}` has no derivative of order {up_to}: its spline is of order {}",
                            declared.name, declared.spline.order
                        );
                        let finding = Diagnostic::new(Code::NoDerivative, continuous.up_to.span, message)
                            .label(declared.span, "declared here");
                        self.report(finding.help("write a smaller number, or raise the `order` of the spline"));
                    }
                }
                _ => {}
            }
        }
        limits
    }

    /// What a path leads to in a phase that it is written in: paths into scenarios are names of arrays by now.
    fn junction_path(&mut self, cx: &Context<'a>, phase: usize, path: &'a Path) -> Option<(usize, Option<i64>)> {
        let (first, rest) = path.segments.split_first()?;
        if rest.is_empty() {
            return self.junction_output(cx, phase, first);
        }
        let text = self.text(path.span);
        let message = format!("there is no output `{text}` in this phase");
        let finding = Diagnostic::new(Code::UnknownName, path.span, message);
        self.report(finding.help("write the name of an output of this phase alone"));
        None
    }

    pub(super) fn junction_output(
        &mut self,
        cx: &Context<'a>,
        phase: usize,
        segment: &'a Segment,
    ) -> Option<(usize, Option<i64>)> {
        let name = &segment.name.text;
        let outputs = &self.problem.phases[phase].outputs;
        let Some(output) = outputs.iter().position(|output| output.name == *name) else {
            let names: Vec<&str> = outputs.iter().map(|output| output.name.as_str()).collect();
            let near =
                super::suggest::nearest(name, names.iter().copied()).map(|near| format!("did you mean `{near}`?"));
            let finding = Diagnostic::new(
                Code::UnknownName,
                segment.name.span,
                format!("there is no output `{name}` in this phase"),
            );
            let help = near.unwrap_or_else(|| format!("outputs are `{}`", names.join("`, `")));
            self.report(finding.help(help));
            return None;
        };
        let family = outputs[output].family;
        match (family, segment.indices.as_slice()) {
            (_, []) => Some((output, None)),
            (Some(ends), [index]) if self.output_axes[phase][output].len() == 1 => {
                let index = self.one_index(index)?;
                let form = self.form(cx, index)?;
                if !self.check_index(cx, &form, ends, name, index.span) {
                    return None;
                }
                Some((output, Some(form.as_number()?)))
            }
            (_, _) => {
                let axes = self.output_axes[phase][output].len();
                self.wrong_indices(segment, axes);
                None
            }
        }
    }

    /// The constraints of one junction.
    fn join(&mut self, junction: &Junction, limits: &[(usize, Option<i64>, usize)]) {
        let (p, q) = (junction.before.phase, junction.after.phase);
        for output in 0..self.problem.phases[q].outputs.len() {
            let here = &self.problem.phases[q].outputs[output];
            let Some(there) = self.problem.phases[p].outputs.iter().position(|o| o.name == here.name) else { continue };
            let default = here.spline.smoothness.min(self.problem.phases[p].outputs[there].spline.smoothness);
            let limit = |member: Option<i64>| {
                let said = limits.iter().rev().find(|(o, m, _)| *o == output && (m.is_none() || *m == member));
                said.map_or(default, |(.., limit)| *limit)
            };
            match here.family {
                None => {
                    let limit = limit(None);
                    self.join_output(junction, (there, output), limit, None);
                }
                Some((first, last)) => {
                    // Runs of members with one limit are one family each.
                    let mut start = first;
                    while start <= last {
                        let here = limit(Some(start));
                        let end = (start..=last).take_while(|m| limit(Some(*m)) == here).last().unwrap_or(start);
                        self.join_output(junction, (there, output), here, Some((start, end)));
                        start = end + 1;
                    }
                }
            }
        }
    }

    fn join_output(&mut self, junction: &Junction, outputs: (usize, usize), limit: usize, members: Option<(i64, i64)>) {
        let mut loops = junction.loops.clone();
        let index = members.map(|(first, last)| {
            let over = self.new_index(Form::number(first), Form::number(last));
            let form = Form::index(over.index);
            loops.push(over);
            form
        });
        let highest = |phase: usize, output: usize| self.problem.phases[phase].outputs[output].spline.order;
        let orders = limit.min(highest(junction.before.phase, outputs.0)).min(highest(junction.after.phase, outputs.1));
        for order in 0..orders {
            let before = (junction.before.clone(), At::End, outputs.0);
            let after = (junction.after.clone(), At::Start, outputs.1);
            let [before, after] = [before, after]
                .map(|(phase, at, output)| self.leaf(Leaf::Flat { phase, at, output, index: index.clone(), order }));
            let body = self.problem.dag.sub(after, before);
            let zero = self.problem.dag.constant(0.0);
            self.origin(body, junction.span);
            let output = &self.problem.phases[junction.after.phase].outputs[outputs.1];
            let what = if order == 0 { output.name.clone() } else { format!("der({}, {order})", output.name) };
            let unit = self.rate_unit(&output.unit, order);
            let agent = self.phases[junction.after.phase].agent;
            let name = self.path_name(agent, Some(junction.after.phase), &format!("continuity of {what}"));
            self.problem.constraints.push(Constraint {
                name: Some(name),
                span: junction.span,
                block: Block::Continuity,
                unit,
                loops: loops.clone(),
                sides: 0,
                written: None,
                domain: Domain::Mission,
                imposed: Imposed::Everywhere,
                body,
                bounds: Bounds { lower: Some(zero), upper: Some(zero) },
            });
        }
    }

    /// The unit of a derivative of something shown in `unit`.
    pub(super) fn rate_unit(&self, unit: &Unit, order: usize) -> Unit {
        if order == 0 || self.time.is_none() {
            return unit.clone();
        }
        let Unit { symbol: time, factor } = &self.problem.independent.unit;
        let time = if time.contains(['*', '/', '^']) { format!("({time})") } else { time.clone() };
        let time = if order == 1 { time } else { format!("{time}^{order}") };
        let symbol = if unit.symbol.is_empty() { "1" } else { &unit.symbol };
        Unit { symbol: format!("{symbol}/{time}"), factor: unit.factor / factor.powi(order as i32) }
    }
}
