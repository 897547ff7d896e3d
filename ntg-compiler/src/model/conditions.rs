//! `if .. else ..`: which branch is meant, chosen when compiled, before the solve, or on the way.
//!
//! Takes conditionals, gives values and shapes. What the condition is made of decides (docs/language.md, section 3):
//! indices and constants choose here, and the other branch is not looked at; a family splits where its index changes
//! the choice ([`OpenIndex`]); everything else becomes a `select`, which a width of `smooth` rounds (docs/maths.md, (2.10)).
//! Finds: branches of different kinds, conditions that decide nothing, widths that are none; notes jumps.

use super::constants::extremes;
use super::elaborator::Elaborator;
use super::kinds::Kind;
use super::mention::names_in;
use super::problem::{Form, Leaf};
use super::scope::{Allow, Context, Entity, Meaning, look_up};
use super::settle::Use;
use super::shape::Shape;
use super::value::{Flaw, OpenIndex, Value};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{NodeId, gradient};
use crate::source::Span;
use crate::syntax::ast::{Branch, Comparison, Conditional, Expr, Relation};

/// `lesser <= greater`: a part of a condition.
struct Test {
    lesser: Value,
    greater: Value,
}

/// What a condition says.
enum Decision {
    /// It holds, or fails, whatever happens.
    Known(bool),
    /// Only for a known index it says anything.
    Open(OpenIndex),
    /// A node that is not 0 where it holds.
    Sharp(NodeId),
    /// The weight of the branch, from 0 to 1.
    Smooth(NodeId),
    /// It must not be used.
    Flawed(Flaw),
}

impl<'a> Elaborator<'a> {
    /// An element of a conditional.
    pub(super) fn conditional(
        &mut self,
        cx: &Context<'a>,
        conditional: &'a Conditional,
        at: &[Form],
        span: Span,
    ) -> Value {
        let mut chosen: Vec<(Decision, Span, Value)> = Vec::new();
        let mut last: Option<&'a Expr> = Some(&conditional.otherwise);
        for branch in &conditional.branches {
            match self.decide(cx, branch) {
                Decision::Known(false) => {}
                Decision::Known(true) => {
                    last = Some(&branch.value);
                    break;
                }
                Decision::Open(open) => return self.open(OpenIndex { span, ..open }),
                decision => {
                    let value = self.element_or_zero(cx, &branch.value, at);
                    chosen.push((decision, branch.span, value));
                }
            }
        }
        let value = last.map(|expr| self.element_or_zero(cx, expr, at));
        let Some(mut value) = value else { return self.poison(span) };
        for (decision, span, then) in chosen.into_iter().rev() {
            value = self.either((decision, span), then, value);
        }
        value.at(span)
    }

    /// One value or the other, by a branch that is written at a place.
    fn either(&mut self, (decision, span): (Decision, Span), then: Value, otherwise: Value) -> Value {
        let dag = &mut self.problem.dag;
        let (a, b) = (then.node, otherwise.node);
        let mut flaw = None;
        let node = match decision {
            Decision::Sharp(condition) => {
                let node = dag.select(condition, a, b);
                self.kinks.push((node, span));
                node
            }
            Decision::Smooth(weight) => {
                // Each branch has its own mask, so that it counts for nothing where its weight is 0.
                let (zero, one) = (dag.constant(0.0), dag.constant(1.0));
                let rest = dag.sub(one, weight);
                let (first, second) = (dag.mul(weight, a), dag.mul(rest, b));
                let first = dag.select(weight, first, zero);
                let second = dag.select(rest, second, zero);
                dag.add(first, second)
            }
            Decision::Flawed(reason) => {
                flaw = Some(reason);
                b
            }
            Decision::Known(_) | Decision::Open(_) => b,
        };
        let mut value = self.alike("if", then, &otherwise, node);
        value.flaw = Flaw::join(&value.flaw, &flaw);
        value
    }

    /// What the condition of a branch says in a context.
    fn decide(&mut self, cx: &Context<'a>, branch: &'a Branch) -> Decision {
        let tests = match self.tests(cx, &branch.condition) {
            Ok(tests) => tests,
            Err(flaw) => return Decision::Flawed(flaw),
        };
        if let Some(width) = &branch.smooth {
            return self.weight(cx, branch, &tests, width);
        }
        let mut condition = self.problem.dag.constant(1.0);
        for test in &tests {
            let holds = match self.by_index(cx, test) {
                Some(Decision::Known(holds)) => self.problem.dag.constant(f64::from(u8::from(holds))),
                Some(decision) => return decision,
                None => self.problem.dag.less_eq(test.lesser.node, test.greater.node),
            };
            condition = self.problem.dag.mul(condition, holds);
        }
        if let Some(known) = self.problem.dag.is_constant(condition) {
            return Decision::Known(known != 0.0);
        }
        if !self.kinds(condition).is_fixed() {
            if matches!(&branch.condition, Relation::Compare { comparison: Comparison::Equal, .. }) {
                let message = "`==` in a condition compares indices, constants and parameters";
                let finding = Diagnostic::new(Code::WrongCondition, branch.span, message);
                self.report(
                    finding.help("along the way two numbers are never equal: write `a in lo .. hi` or `a <= b`"),
                );
                return Decision::Flawed(Flaw::Reported);
            }
            if cx.allow > Allow::Guess {
                self.note_jump_of_branch(branch);
            }
        }
        Decision::Sharp(condition)
    }

    /// The comparisons that a condition consists of.
    fn tests(&mut self, cx: &Context<'a>, condition: &'a Relation) -> Result<Vec<Test>, Flaw> {
        let mut flaw = None;
        let mut side = |expr: &'a Expr| {
            let value = if self.is_number(cx, expr) { self.value(cx, expr) } else { self.poison(expr.span) };
            flaw = Flaw::join(&flaw, &value.flaw);
            value
        };
        let pairs: Vec<(Value, Value)> = match condition {
            Relation::Compare { left, comparison, right, .. } => {
                let (left, right) = (side(left), side(right));
                match comparison {
                    Comparison::AtMost => vec![(left, right)],
                    Comparison::AtLeast => vec![(right, left)],
                    Comparison::Equal => vec![(left.clone(), right.clone()), (right, left)],
                }
            }
            Relation::In { value, bounds } => {
                let value = side(value);
                let lower = bounds.lower.as_ref().map(&mut side);
                let upper = bounds.upper.as_ref().map(&mut side);
                let below = lower.map(|lower| (lower, value.clone()));
                below.into_iter().chain(upper.map(|upper| (value, upper))).collect()
            }
            // Refused when it was read.
            Relation::Between { .. } => return Err(Flaw::Reported),
        };
        if let Some(flaw) = flaw {
            return Err(flaw);
        }
        for (lesser, greater) in &pairs {
            if self.clash("compare", lesser, greater) {
                return Err(Flaw::Reported);
            }
        }
        Ok(pairs.into_iter().map(|(lesser, greater)| Test { lesser, greater }).collect())
    }

    /// What a comparison between indices and constants says; none where it is made of more, or of the index of a
    /// family of phases or agents where its members share one formula, as a duration.
    fn by_index(&mut self, cx: &Context<'a>, test: &Test) -> Option<Decision> {
        let difference = self.problem.dag.sub(test.lesser.node, test.greater.node);
        if self.kinds(difference) != Kind::INDEX {
            return None;
        }
        let inputs = self.problem.dag.inputs_of(&[difference]);
        let forms: Vec<Form> = inputs
            .iter()
            .filter_map(|input| match self.problem.leaves.leaf(*input) {
                Leaf::Index(form) => Some(form.clone()),
                _ => None,
            })
            .collect();
        let indices = || forms.iter().flat_map(|form| form.terms.iter().map(|(index, _)| *index));
        let of_family = |form: &Option<Form>| {
            form.iter().any(|form| form.terms.iter().any(|(index, _)| indices().any(|other| other == *index)))
        };
        let bound = |index| cx.loops.iter().any(|over| over.index == index);
        let is_shared = !cx.parts_families && (of_family(&cx.agent) || of_family(&cx.phase));
        if is_shared || !indices().all(bound) {
            return None;
        }
        let span = test.lesser.span.to(test.greater.span);
        let open = |cut| indices().next().map(|index| Decision::Open(OpenIndex { index, cut, span }));
        let ([input], [form]) = (inputs.as_slice(), forms.as_slice()) else { return open(None) };
        let slope = gradient(&mut self.problem.dag, difference, &[*input]).ok().map(|slopes| slopes[0]);
        let slope = slope.and_then(|slope| self.problem.dag.is_constant(slope));
        let zero = self.problem.dag.constant(0.0);
        let offset = self.problem.dag.substitute(&[difference], |_| Some(zero))[0];
        let (Some(slope), Some(offset)) = (slope, self.problem.dag.is_constant(offset)) else { return open(None) };
        let (least, most) = extremes(form, &cx.loops)?;
        let holds = |k: i64| slope * k as f64 + offset <= 0.0;
        if holds(least) == holds(most) {
            return Some(Decision::Known(holds(least)));
        }
        let cut = match form.terms.as_slice() {
            [(_, factor)] => Some(((-offset / slope - form.constant as f64) / *factor as f64).floor() as i64),
            _ => None,
        };
        open(cut)
    }

    /// How much a branch with `smooth` counts.
    fn weight(&mut self, cx: &Context<'a>, branch: &'a Branch, tests: &[Test], width: &'a Expr) -> Decision {
        if matches!(&branch.condition, Relation::Compare { comparison: Comparison::Equal, .. }) {
            let finding = Diagnostic::new(Code::WrongCondition, branch.span, "`==` cannot be smoothed");
            self.report(finding.help("write `a in lo .. hi smooth w`"));
            return Decision::Flawed(Flaw::Reported);
        }
        let allow = cx.allow.min(Allow::Parameters);
        let value =
            if self.is_number(cx, width) { self.value(&cx.allowing(allow), width) } else { self.poison(width.span) };
        if let Some(flaw @ Flaw::Open(_)) = value.flaw {
            return Decision::Flawed(flaw);
        }
        let Some(value) = self.settle(value, Use::Bound("the width of `smooth`")) else {
            return Decision::Flawed(Flaw::Reported);
        };
        let compared = tests.iter().find_map(|test| test.lesser.dimension.or(test.greater.dimension));
        if let (Some(wanted), Some(given)) = (compared, value.dimension)
            && wanted != given
        {
            let (wanted, given) = (wanted.describe(), given.describe());
            let message = format!("the width of `smooth` is {given}, what is compared is {wanted}");
            let finding = Diagnostic::new(Code::DimensionMismatch, width.span, message)
                .label(width.span, format!("this is {given}"))
                .label(branch.span, format!("{wanted} is compared here"));
            self.report(finding.help("the width says over how much of what is compared the branches blend"));
            return Decision::Flawed(Flaw::Reported);
        }
        if self.problem.dag.is_constant(value.node).is_some_and(|width| width <= 0.0) {
            let finding = Diagnostic::new(Code::WrongCondition, width.span, "the width of `smooth` must be positive");
            self.report(finding.help("without `smooth` the value jumps from one branch to the other"));
            return Decision::Flawed(Flaw::Reported);
        }
        let mut weight = self.problem.dag.constant(1.0);
        for test in tests {
            let part = self.step_down(test, value.node);
            weight = self.problem.dag.mul(weight, part);
        }
        Decision::Smooth(weight)
    }

    /// 1 where a comparison holds by half the width and more, 0 where it fails by as much, between them `1 - f(s)` with
    /// `f(s) = s^3 (10 - 15 s + 6 s^2)`, whose first and second derivatives vanish at both ends.
    fn step_down(&mut self, test: &Test, width: NodeId) -> NodeId {
        let dag = &mut self.problem.dag;
        let excess = dag.sub(test.lesser.node, test.greater.node);
        let scaled = dag.div(excess, width);
        let [zero, half, one] = [0.0, 0.5, 1.0].map(|c| dag.constant(c));
        let shifted = dag.add(scaled, half);
        let above = dag.max(shifted, zero);
        let s = dag.min(above, one);
        let [six, ten, fifteen] = [6.0, 10.0, 15.0].map(|c| dag.constant(c));
        let inner = dag.mul(six, s);
        let inner = dag.sub(inner, fifteen);
        let inner = dag.mul(s, inner);
        let inner = dag.add(ten, inner);
        let cube = dag.powi(s, 3);
        let f = dag.mul(cube, inner);
        dag.sub(one, f)
    }

    fn note_jump_of_branch(&mut self, branch: &Branch) {
        let place = match &branch.condition {
            Relation::Compare { left, right, .. } => format!("{} == {}", self.text(left.span), self.text(right.span)),
            Relation::In { value, .. } => format!("the ends of the range of `{}`", self.text(value.span)),
            Relation::Between { .. } => return,
        };
        let message = format!("`if` may jump at {place}");
        let finding = Diagnostic::new(Code::GradientJumps, branch.span, message);
        self.report(finding.help(
            "derivatives are those of the branch taken: the solver does not see the jump, and neither seeks nor avoids \
             it; write `smooth width` behind the condition",
        ));
    }

    /// The shape of a conditional: that of the branch that is chosen when compiled, else that of all branches.
    pub(super) fn conditional_shape(&mut self, cx: &Context<'a>, conditional: &'a Conditional) -> Option<Shape> {
        let mut joined = Shape::Any;
        let mut first: Option<Span> = None;
        let mut candidates: Vec<&'a Expr> = Vec::new();
        let mut last = Some(&conditional.otherwise);
        for branch in &conditional.branches {
            match self.known_choice(cx, branch) {
                Some(false) => {}
                Some(true) => {
                    last = Some(&branch.value);
                    break;
                }
                None => candidates.push(&branch.value),
            }
        }
        let is_open = !candidates.is_empty();
        candidates.extend(last.take());
        for expr in candidates {
            let around = self.may_not_be_chosen;
            self.may_not_be_chosen |= is_open;
            let shape = self.shape(cx, expr);
            self.may_not_be_chosen = around;
            let shape = shape?;
            let Some(both) = joined.joined(&shape) else {
                let help = match std::mem::take(&mut self.recurs) {
                    true => "a family that needs its own members states their size: `let w[i in 1 .. n, 3] = ...`",
                    false => "all branches of an `if` have one size",
                };
                self.misfit_shapes((first.unwrap_or(expr.span), &joined), (expr.span, &shape), help);
                return None;
            };
            if shape != Shape::Any && first.is_none() {
                first = Some(expr.span);
            }
            joined = both;
        }
        Some(joined)
    }

    /// Which branch indices and constants choose, before anything else is elaborated.
    fn known_choice(&mut self, cx: &Context<'a>, branch: &'a Branch) -> Option<bool> {
        if branch.smooth.is_some() {
            return None;
        }
        let mut names = Vec::new();
        for side in branch.condition.sides() {
            names.extend(names_in(side)?);
        }
        let is_plain = |name: &str| match cx.local(name) {
            Some(Meaning::Index(_)) => true,
            Some(_) => false,
            None if self.index_in_sight(cx, name).is_some() => true,
            None => match look_up(&self.scopes, cx.names(), name).map(|(_, declared)| declared.entity) {
                Some(Entity::Definition(definition)) => self.definitions[definition].is_const,
                _ => false,
            },
        };
        if !names.into_iter().all(is_plain) {
            return None;
        }
        match self.decide(cx, branch) {
            Decision::Known(holds) => Some(holds),
            _ => None,
        }
    }
}
