//! What was measured: `measure { place: at(time[i], r) == seen[i] sigma 5 [m]; }`.
//!
//! Takes the statements of `measure` blocks, fills `Problem::measurements`: each element adds half the square of its
//! residual over its standard deviation to a term of the objective, which has the statement's name
//! (docs/maths.md, section 17).
//! Finds: sides and deviations of different dimensions, deviations that the solve would change or that are not
//! positive, and measurements of nothing that is unknown (E095).

use ntg_structure::Unit;

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::problem::{Form, Measurement, Term};
use super::scope::{Allow, Context, Point, ScopeId};
use super::settle::Use;
use super::units;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{self, Expr, Relation, Statement};

/// A measurement as it is written, and whose it is.
#[derive(Clone, Copy)]
struct Measured<'a> {
    constraint: &'a ast::Constraint,
    left: &'a Expr,
    right: &'a Expr,
    sigma: &'a Expr,
    agent: Option<usize>,
    phase: Option<usize>,
}

impl<'a> Elaborator<'a> {
    /// The measurements of a block; a value for each, to be held against the other terms of the objective.
    pub(super) fn measure_block(&mut self, scope: ScopeId, block: &'a ast::Block) -> Vec<Value> {
        let (agent, phase) = (self.scopes[scope].agent, self.scopes[scope].phase);
        let cx = match (phase, agent) {
            (Some(phase), _) => self.phase_context(phase, Allow::All, Point::Nowhere),
            (None, Some(agent)) => self.agent_context(agent, Allow::All),
            (None, None) => Context::of(scope, Allow::All),
        };
        let before = self.problem.measurements.len();
        self.measurements(&cx, &block.statements, (agent, phase));
        self.settle_open();
        let spans: Vec<_> = self.problem.measurements[before..].iter().map(|m| (m.cost, m.span)).collect();
        let mut values: Vec<Value> =
            spans.into_iter().map(|(node, span)| Value::new(node, Dimension::NONE, span)).collect();
        values.dedup_by_key(|value| value.span);
        values
    }

    fn measurements(
        &mut self,
        cx: &Context<'a>,
        statements: &'a [Statement<ast::Constraint>],
        (agent, phase): (Option<usize>, Option<usize>),
    ) {
        for statement in statements {
            self.for_families(cx, &mut |this, cx| this.measured(cx, statement, (agent, phase)));
        }
    }

    fn measured(
        &mut self,
        cx: &Context<'a>,
        statement: &'a Statement<ast::Constraint>,
        (agent, phase): (Option<usize>, Option<usize>),
    ) {
        match statement {
            Statement::One(constraint) => {
                // What is no equality, or has no deviation, was told of.
                let Relation::Compare { left, right, .. } = &constraint.relation else { return };
                let Some(sigma) = &constraint.sigma else { return };
                self.measurement(cx, Measured { constraint, left, right, sigma, agent, phase });
            }
            Statement::For(inner) => {
                let Some((over, _)) = self.range(cx, &inner.over) else { return };
                let name = Some(inner.over.index.text.as_str());
                self.repeat(cx, name, &over, &mut |this, cx, _| {
                    inner.body.iter().for_each(|statement| this.measured(cx, statement, (agent, phase)));
                });
            }
        }
    }

    /// A measured number, or every element of a measured vector.
    fn measurement(&mut self, cx: &Context<'a>, measured: Measured<'a>) {
        let Some(shape) = self.sides(cx, &[measured.left, measured.right, measured.sigma]) else { return };
        self.for_elements(cx, shape.axes(), &[], &mut |this, cx, at| this.measured_element(cx, measured, at));
    }

    fn measured_element(&mut self, cx: &Context<'a>, measured: Measured<'a>, at: &[Form]) {
        let Measured { constraint, left, right, sigma, .. } = measured;
        let mut value = |expr: &'a Expr| {
            let value = self.usable_side(cx, expr, at, Use::Measured);
            self.event = None;
            value
        };
        let (left, right, sigma) = (value(left), value(right), value(sigma));
        let (Some(left), Some(right), Some(sigma)) = (left, right, sigma) else { return };
        if self.clash("compare", &left, &right) || self.clash("compare", &left, &sigma) {
            return;
        }
        let residual = self.problem.dag.sub(left.node, right.node);
        if !self.is_measurable(measured, residual, &sigma) {
            return;
        }
        let ratio = self.problem.dag.div(residual, sigma.node);
        let square = self.problem.dag.powi(ratio, 2);
        let half = self.problem.dag.constant(0.5);
        let cost = self.problem.dag.mul(half, square);
        self.origin(cost, constraint.span);
        let unit = [&left, &right, &sigma].into_iter().find_map(|value| value.unit.as_ref());
        let dimension = left.dimension.or(right.dimension).unwrap_or(Dimension::NONE);
        let unit = unit.map_or_else(|| units::si(&dimension), |unit| (**unit).clone());
        let term = self.measured_term(measured);
        let (loops, span) = ((*cx.loops).clone(), constraint.span);
        self.problem.measurements.push(Measurement { term, span, unit, loops, residual, sigma: sigma.node, cost });
    }

    /// Whether something unknown was measured, with a known positive deviation.
    fn is_measurable(&mut self, measured: Measured<'a>, residual: crate::expr::NodeId, sigma: &Value) -> bool {
        let (span, message, help) = if !self.kinds(sigma.node).is_fixed() {
            let message = "the standard deviation changes while the problem is solved".to_owned();
            (sigma.span, message, "make it of constants and parameters: a deviation that is sought would grow")
        } else if let Some(number) = self.problem.dag.is_constant(sigma.node).filter(|number| *number <= 0.0) {
            let message = format!("a standard deviation is positive, this is {number}");
            (sigma.span, message, "what holds exactly is a constraint, without `sigma`")
        } else if self.kinds(residual).is_fixed() {
            let message = "nothing that the problem finds was measured here".to_owned();
            (measured.constraint.span, message, "one side is made of outputs, states, variables or durations")
        } else {
            return true;
        };
        self.report(Diagnostic::new(Code::WrongMeasurement, span, message).help(help));
        false
    }

    /// The term of a statement, whose elements and members may be made one by one.
    fn measured_term(&mut self, measured: Measured<'a>) -> usize {
        let Measured { constraint, agent, phase, .. } = measured;
        let name = constraint.name.as_ref().map(|name| match agent {
            Some(agent) => self.path_name(agent, phase, &name.text),
            None => name.text.clone(),
        });
        let is_it = |term: &Term| term.span == constraint.span && term.name == name;
        if let Some(known) = self.problem.objective.iter().rposition(is_it) {
            return known;
        }
        let body = self.problem.dag.constant(0.0);
        let (span, unit) = (constraint.span, Unit::default());
        self.problem.objective.push(Term { name, span, unit, loops: vec![], body, written: None });
        self.problem.objective.len() - 1
    }
}
