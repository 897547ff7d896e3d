//! Ranges of an index: open ones, where one formula serves all members, and those that must run over numbers.
//!
//! What is written out in the text (a list, a recurrence, a condition on an index) has no formula for an open index.
//! Whoever meets such a thing says which index it must know, and perhaps at which value the formula changes
//! ([`OpenIndex`]); the loop over that index is then split there, or made one by one.
//! Afterwards: whatever was pushed for the open index is taken back.

use super::elaborator::Elaborator;
use super::problem::{Form, Loop};
use super::scope::{Context, Meaning};
use super::value::OpenIndex;
use crate::diagnostic::{Code, Diagnostic};

/// How much there is of everything that a loop may push.
pub(super) struct Mark {
    constraints: usize,
    guesses: usize,
    named: usize,
    objective: usize,
    measurements: usize,
    variables: usize,
    outputs: Vec<usize>,
    slacks: usize,
}

/// The most members that are made one by one: beyond it, a formula for each is more than can be compiled.
const MOST_MEMBERS: i64 = 20_000;

impl<'a> Elaborator<'a> {
    pub(super) fn mark(&self) -> Mark {
        let problem = &self.problem;
        Mark {
            constraints: problem.constraints.len(),
            guesses: problem.guesses.len(),
            named: problem.named.len(),
            objective: problem.objective.len(),
            measurements: problem.measurements.len(),
            variables: problem.variables.len(),
            outputs: problem.phases.iter().map(|phase| phase.outputs.len()).collect(),
            slacks: self.slacks.len(),
        }
    }

    pub(super) fn take_back(&mut self, mark: &Mark) {
        self.problem.constraints.truncate(mark.constraints);
        self.problem.guesses.truncate(mark.guesses);
        self.problem.named.truncate(mark.named);
        self.problem.objective.truncate(mark.objective);
        self.problem.measurements.truncate(mark.measurements);
        self.problem.variables.truncate(mark.variables);
        for (phase, outputs) in mark.outputs.iter().enumerate() {
            self.problem.phases[phase].outputs.truncate(*outputs);
            self.output_axes[phase].truncate(*outputs);
            self.output_dimensions[phase].truncate(*outputs);
        }
        self.slacks.truncate(mark.slacks);
    }

    /// Calls `body` inside a loop; for parts of its range where an index must be known.
    pub(super) fn repeat(
        &mut self,
        cx: &Context<'a>,
        name: Option<&'a str>,
        over: &Loop,
        body: &mut dyn FnMut(&mut Self, &Context<'a>, &Form),
    ) {
        let mark = self.mark();
        let form = Form::index(over.index);
        let inner = named_index(cx.inside(over.clone()), name, &form);
        body(self, &inner, &form);
        let Some(open) = self.opened.take() else { return };
        if open.index != over.index {
            self.opened = Some(open);
            return;
        }
        self.take_back(&mark);
        let Some(parts) = self.parts(&open, over) else { return };
        for (first, last) in parts {
            if first == last {
                let form = Form::number(first);
                let inner = named_index(cx.clone(), name, &form);
                let inner = inner.at_member(first);
                body(self, &inner, &form);
            } else {
                let part = self.new_index(Form::number(first), Form::number(last));
                self.repeat(cx, name, &part, body);
            }
            if self.opened.is_some() {
                return; // Whoever loops over that index begins again.
            }
        }
    }

    /// Calls `body` for every element of a shape.
    pub(super) fn for_elements(
        &mut self,
        cx: &Context<'a>,
        axes: &[i64],
        at: &[Form],
        body: &mut dyn FnMut(&mut Self, &Context<'a>, &[Form]),
    ) {
        let Some((n, rest)) = axes.split_first() else { return body(self, cx, at) };
        let over = self.new_index(Form::number(1), Form::number(*n));
        self.repeat(cx, None, &over, &mut |this, cx, form| {
            let mut at = at.to_vec();
            at.push(form.clone());
            this.for_elements(cx, rest, &at, body);
        });
    }

    /// The parts of a range in which an index is known well enough; none where another index must be known first.
    pub(super) fn parts(&mut self, open: &OpenIndex, over: &Loop) -> Option<Vec<(i64, i64)>> {
        let (Some(first), Some(last)) = (over.first.as_number(), over.last.as_number()) else {
            let (outer, _) = over.first.terms.iter().chain(&over.last.terms).next()?;
            self.opened = Some(OpenIndex { index: *outer, cut: None, span: open.span });
            return None;
        };
        if let Some(cut) = open.cut.filter(|cut| (first..=last).contains(cut) && first < last) {
            let parts = [(first, cut - 1), (cut, cut), (cut + 1, last)];
            return Some(parts.into_iter().filter(|(a, b)| a <= b).collect());
        }
        if last - first >= MOST_MEMBERS {
            let message = format!("this would be written out {} times", last - first + 1);
            let finding = Diagnostic::new(Code::TooManySteps, open.span, message);
            self.report(finding.help("lists and recurrences are made one by one: use a `param` array, or a `table`"));
            return None;
        }
        Some((first..=last).map(|k| (k, k)).collect())
    }

    /// Tells of an index that must be known and never is: that of a family of phases or agents.
    pub(super) fn settle_open(&mut self) {
        let Some(open) = self.opened.take() else { return };
        let message = format!("which element of `{}` is meant must be known here", self.text(open.span));
        let finding = Diagnostic::new(Code::NotWhole, open.span, message);
        self.report(finding.help(
            "the members of a family of phases or agents share one formula: take elements by number, or from a `param` array",
        ));
    }
}

fn named_index<'a>(cx: Context<'a>, name: Option<&'a str>, form: &Form) -> Context<'a> {
    match name {
        Some(name) => cx.with(name, Meaning::Index(form.clone())),
        None => cx,
    }
}
