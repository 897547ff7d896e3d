//! The objective: terms that add up, all minimised or all maximised.
//!
//! Takes the `minimize` and `maximize` items of all scopes, and `measure` blocks (`measure.rs`), fills
//! `Problem::objective`.
//! Finds: both senses in one problem, terms of different dimensions.

use ntg_structure::Unit;

use super::elaborator::Elaborator;
use super::problem::{Loop, Term};
use super::scope::{Allow, Context, Point};
use super::settle::Use;
use super::units;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::Fold;
use crate::source::Span;
use crate::syntax::ast::{self, BlockPlace, Expr, ItemKind, Sense};

impl<'a> Elaborator<'a> {
    /// All terms, scope by scope.
    pub(super) fn objective(&mut self) {
        let mut first: Option<(Sense, Span)> = None;
        let mut sum: Option<Value> = None;
        let mut declared: Option<Unit> = None;
        for scope in 0..self.scopes.len() {
            for item in self.items[scope] {
                if let ItemKind::Block(block) = &item.kind
                    && block.place == BlockPlace::Measure
                {
                    let (sense, before) = *first.get_or_insert((Sense::Minimize, item.span));
                    if sense == Sense::Maximize {
                        self.both_senses(item.span, before);
                        continue;
                    }
                    for value in self.measure_block(scope, block) {
                        sum = Some(match sum {
                            Some(first) => self.alike("add", first, &value, value.node),
                            None => value,
                        });
                    }
                    continue;
                }
                let ItemKind::Objective(objective) = &item.kind else { continue };
                let (sense, before) = *first.get_or_insert((objective.sense, item.span));
                if sense != objective.sense {
                    self.both_senses(item.span, before);
                    continue;
                }
                let Some(value) = self.term(scope, objective, item.span) else { continue };
                if objective.unit.is_some() && declared.is_none() {
                    declared = value.unit.as_ref().map(|unit| (**unit).clone());
                }
                sum = Some(match sum {
                    Some(first) => self.alike("add", first, &value, value.node),
                    None => value,
                });
            }
        }
        self.problem.maximize = matches!(first, Some((Sense::Maximize, _)));
        self.objective_dimension = sum.as_ref().map(Value::dimension_or_none);
        let dimension = sum.map(|value| value.dimension_or_none()).unwrap_or(super::dimension::Dimension::NONE);
        self.problem.objective_unit = declared.unwrap_or_else(|| units::si(&dimension));
    }

    fn both_senses(&mut self, span: Span, before: Span) {
        let message = "a problem is minimised or maximised, not both";
        let finding = Diagnostic::new(Code::MixedSenses, span, message);
        let is_measured = |span: Span| self.source.slice(span).starts_with("measure");
        let finding = match (is_measured(span), is_measured(before)) {
            (false, false) => finding
                .label(span, "this term has the other sense")
                .label(before, "the first term")
                .help("change the sign of this term and write the other word"),
            (measured, _) => finding
                .label(if measured { before } else { span }, "this is maximised")
                .label(if measured { span } else { before }, "what is measured is met by minimising")
                .help("a problem with `measure` is minimised: change the sign of the term and write `minimize`"),
        };
        self.report(finding);
    }

    fn term(&mut self, scope: usize, objective: &'a ast::Objective, span: Span) -> Option<Value> {
        let (agent, phase) = (self.scopes[scope].agent, self.scopes[scope].phase);
        let cx = match (phase, agent) {
            (Some(phase), _) => self.phase_context(phase, Allow::All, Point::Nowhere),
            (None, Some(agent)) => self.agent_context(agent, Allow::All),
            (None, None) => Context::of(scope, Allow::All),
        };
        let (mut value, loops) = self.term_of_families(&cx, &objective.value)?;
        if let Some(unit) = &objective.unit {
            let what = objective.name.as_ref().map_or("this term".to_owned(), |name| format!("`{}`", name.text));
            value = self.declared_unit(value, unit, &what);
            if !value.is_sound() {
                return None;
            }
        }
        let unit = match (&objective.unit, &value.unit) {
            (Some(_), Some(unit)) => (**unit).clone(),
            _ => units::si(&value.dimension_or_none()),
        };
        let body = match objective.sense {
            Sense::Minimize => value.node,
            Sense::Maximize => self.problem.dag.neg(value.node),
        };
        self.origin(body, objective.value.span);
        let name = objective.name.as_ref().map(|name| match agent {
            Some(agent) => self.path_name(agent, phase, &name.text),
            None => name.text.clone(),
        });
        self.problem.objective.push(Term { name, span, unit, loops, body, written: None });
        Some(value.at(objective.value.span))
    }

    /// The value of a term with the loops under which it adds up; where the members of a family must be parted, the sum
    /// over its parts.
    fn term_of_families(&mut self, cx: &Context<'a>, expr: &'a Expr) -> Option<(Value, Vec<Loop>)> {
        let cx = &cx.parting();
        let value = self.usable(cx, expr, Use::Objective);
        self.event = None;
        let Some(open) = self.opened.filter(|open| cx.loops.iter().any(|over| over.index == open.index)) else {
            self.settle_open();
            return value.map(|value| (value, (*cx.loops).clone()));
        };
        self.opened = None;
        let mut total: Option<Value> = None;
        for (inner, _) in self.parted(cx, &open) {
            let (value, loops) = self.term_of_families(&inner, expr)?;
            let node = loops.iter().rev().fold(value.node, |node, over| self.folded(Fold::Sum, over, node));
            let value = Value { node, ..value };
            total = Some(match total {
                None => value,
                Some(so_far) => {
                    let node = self.problem.dag.add(so_far.node, value.node);
                    self.alike("add", so_far, &value, node)
                }
            });
        }
        total.map(|total| (total, vec![]))
    }
}
