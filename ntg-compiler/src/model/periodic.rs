//! `periodic x;`: outputs that end as they begin.
//!
//! Takes the items of agents and phases, adds constraints `initial(der(x, j)) == final(der(x, j))` for the derivatives
//! that the splines keep continuous, or up to the one that is named.
//! Finds: outputs without a continuous derivative, derivatives that the splines do not have.

use ntg_structure::Block;

use super::elaborator::Elaborator;
use super::problem::{At, Bounds, Constraint, Domain, Form, Imposed, Leaf, PhaseAt};
use super::scope::{Allow, Context, Point};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{ItemKind, Periodic, Segment};

/// The two ends that are tied to each other, each with its output.
struct Ends {
    first: (PhaseAt, usize),
    last: (PhaseAt, usize),
}

impl<'a> Elaborator<'a> {
    /// All outputs that are periodic.
    pub(super) fn periodic(&mut self) {
        for scope in 0..self.scopes.len() {
            for item in self.items[scope] {
                if let ItemKind::Periodic(periodic) = &item.kind {
                    self.periodic_outputs(scope, periodic);
                }
            }
        }
    }

    fn periodic_outputs(&mut self, scope: usize, periodic: &'a Periodic) {
        let Some(agent) = self.scopes[scope].agent else { return }; // Told of as standing at the wrong level.
        let phase = self.scopes[scope].phase;
        let cx = match phase {
            Some(phase) => self.phase_context(phase, Allow::All, Point::Nowhere),
            None => self.agent_context(agent, Allow::All),
        };
        let phases = &self.agents[agent].phases;
        let (Some(first), Some(last)) = (phase.or(phases.first().copied()), phase.or(phases.last().copied())) else {
            return;
        };
        let end = |this: &Self, k: usize, last: bool| {
            let family = this.problem.phases[k].family.as_ref();
            let outer = family.map(|over| if last { over.last.clone() } else { over.first.clone() });
            PhaseAt { phase: k, agent: cx.agent.clone(), index: if phase.is_some() { cx.phase.clone() } else { outer } }
        };
        let up_to = match &periodic.up_to {
            None => None,
            Some(order) => match self.natural(&cx, order, "the order of a derivative") {
                Some(order) => Some(order),
                None => return,
            },
        };
        for segment in &periodic.outputs {
            let Some((at_first, member)) = self.junction_output(&cx, first, segment) else { continue };
            let name = &self.problem.phases[first].outputs[at_first].name;
            let outputs = &self.problem.phases[last].outputs;
            let Some(at_last) = outputs.iter().position(|output| output.name == *name) else {
                let message = format!("`{name}` is not there at the end of the last phase");
                let finding = Diagnostic::new(Code::UnknownName, segment.span, message);
                self.report(finding.help("declare it outside the phases"));
                continue;
            };
            let ends = Ends { first: (end(self, first, false), at_first), last: (end(self, last, true), at_last) };
            self.tie(&cx, &ends, segment, member, (up_to, periodic));
        }
    }

    fn tie(
        &mut self,
        cx: &Context<'a>,
        ends: &Ends,
        segment: &'a Segment,
        member: Option<i64>,
        (up_to, periodic): (Option<usize>, &'a Periodic),
    ) {
        let output = |(at, output): &(PhaseAt, usize)| &self.problem.phases[at.phase].outputs[*output];
        let (first, last) = (output(&ends.first), output(&ends.last));
        let smoothness = first.spline.smoothness.min(last.spline.smoothness);
        let order = first.spline.order.min(last.spline.order);
        let (name, declared, unit, family) = (first.name.clone(), first.span, first.unit.clone(), first.family);
        if let (Some(up_to), Some(expr)) = (up_to, &periodic.up_to)
            && up_to >= order
        {
            let message = format!("`{name}` has no derivative of order {up_to}: its spline is of order {order}");
            let finding = Diagnostic::new(Code::NoDerivative, expr.span, message).label(declared, "declared here");
            self.report(finding.help("write a smaller number, or raise the `order` of the spline"));
            return;
        }
        if up_to.is_none() && smoothness == 0 {
            let message = format!("`{name}` may jump anywhere, so nothing of it has to end as it begins");
            let finding = Diagnostic::new(Code::NoDerivative, segment.span, message).label(declared, "declared here");
            let help = format!("write `periodic {name} up to 0;`, or declare it `: continuous`");
            self.report(finding.help(help));
            return;
        }
        let mut loops = (*cx.loops).clone();
        let index = match (member, family) {
            (Some(member), _) => Some(Form::number(member)),
            (None, Some((first, last))) => {
                let over = self.new_index(Form::number(first), Form::number(last));
                let form = Form::index(over.index);
                loops.push(over);
                Some(form)
            }
            (None, None) => None,
        };
        for order in 0..up_to.map_or(smoothness, |up_to| up_to + 1) {
            let sides = [(&ends.first, At::Start), (&ends.last, At::End)];
            let [initial, last] = sides.map(|((phase, output), at)| {
                self.leaf(Leaf::Flat { phase: phase.clone(), at, output: *output, index: index.clone(), order })
            });
            let body = self.problem.dag.sub(initial, last);
            let zero = self.problem.dag.constant(0.0);
            self.origin(body, segment.span);
            let what = if order == 0 { name.clone() } else { format!("der({name}, {order})") };
            let label =
                self.path_name(self.problem.phases[ends.first.0.phase].agent, None, &format!("period of {what}"));
            self.problem.constraints.push(Constraint {
                name: Some(label),
                span: segment.span,
                block: Block::Temporal,
                unit: self.rate_unit(&unit, order),
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
}
