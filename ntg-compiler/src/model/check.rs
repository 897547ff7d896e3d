//! What can be seen only on the whole: that something is wanted, and that it is not impossible.
//!
//! Takes the finished problem.
//! Finds: boundary conditions that contradict one another or a bound, more of them than an output
//! can meet, a problem without an objective; notes an end without a start; `size` finds what is too large.
//! Only what constants decide is told here; what parameters decide is the solver's affair.

use std::collections::HashMap;

use ntg_structure::Block;

use super::constants::extremes;
use super::elaborator::Elaborator;
use super::problem::{Constraint, Domain, Duration, Instant, Leaf, Loop};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Binary, InputId, Node, NodeId, Unary};
use crate::source::Span;

/// Values that boundary conditions fix at one point: leaf, value, place of the condition.
type Fixed = HashMap<InputId, (f64, Span)>; // Looked up, never iterated.

/// How far beyond a bound a fixed value must be, relative to both, to contradict it. A value exactly
/// on its bound is no contradiction, and unit conversions round.
const SLACK: f64 = 1e-9;
/// A miss below this part of the constraint's unit is no contradiction. A law: as much as the runtime leaves to the
/// solver.
const LEAST_MISS: f64 = 1e-7;

impl Elaborator<'_> {
    /// The last step of the pass.
    pub(super) fn check(&mut self) {
        if self.has_failed() {
            return; // The rest would only repeat it.
        }
        self.check_size();
        if self.has_failed() {
            return; // The rest would take its time.
        }
        for phase in 0..self.problem.phases.len() {
            for block in [Block::Initial, Block::Final] {
                self.check_end(phase, block);
            }
            self.check_rows(phase);
        }
        for k in 0..self.problem.constraints.len() {
            if self.problem.constraints[k].domain == Domain::Mission && !self.check_against(&Fixed::new(), k) {
                self.check_windows(k);
            }
        }
        self.check_objective();
        if !self.has_failed() {
            self.check_start();
        }
    }

    /// Notes conditions at the end without any at the start: most often the start was forgotten.
    fn check_start(&mut self) {
        let of = |block: Block| self.problem.constraints.iter().find(|constraint| constraint.block == block);
        // Conditions in `temporal` may be about the start.
        let (None, None, Some(end)) = (of(Block::Initial), of(Block::Temporal), of(Block::Final)) else { return };
        let message =
            "conditions hold at the end and none at the start: the trajectory begins wherever that is cheapest";
        let note = Diagnostic::new(Code::FreeStart, end.span, message);
        self.report(note.help("write `initial { ... }`, unless any start will do"));
    }

    pub(super) fn at_end(&self, phase: usize, block: Block) -> Vec<usize> {
        let here = |constraint: &Constraint| match (&constraint.domain, block) {
            (Domain::Start(at), Block::Initial) | (Domain::End(at), Block::Final) => at.phase == phase,
            _ => false,
        };
        (0..self.problem.constraints.len()).filter(|k| here(&self.problem.constraints[*k])).collect()
    }

    /// Conditions at one end of a phase, against one another and against the bounds along the phase.
    fn check_end(&mut self, phase: usize, block: Block) {
        let rows = self.at_end(phase, block);
        let mut fixed = Fixed::new();
        for k in &rows {
            self.fix(&mut fixed, *k);
        }
        if fixed.is_empty() {
            return;
        }
        let along = (0..self.problem.constraints.len()).filter(|k| match &self.problem.constraints[*k].domain {
            Domain::Path(at, part) if block == Block::Initial => {
                at.phase == phase && part.from == Instant::START && part.with_first
            }
            Domain::Path(at, part) => at.phase == phase && part.to == Instant::END && part.with_last,
            _ => false,
        });
        let along: Vec<usize> = along.collect();
        let told = |this: &Self, k: usize| {
            let constraint = &this.problem.constraints[k];
            let bare = matches!(this.problem.dag.node(constraint.body), Node::Input(_));
            bare && constraint.bounds.lower.is_some() && constraint.bounds.lower == constraint.bounds.upper
        };
        // Two equalities of one thing were compared when they were collected.
        let rows: Vec<usize> = rows.into_iter().filter(|k| !told(self, *k)).collect();
        for k in rows.into_iter().chain(along) {
            self.check_against(&fixed, k);
        }
    }

    /// Notes a condition that fixes one leaf; tells when it was fixed to something else.
    fn fix(&mut self, fixed: &mut Fixed, k: usize) {
        let constraint = &self.problem.constraints[k];
        let (Some(lower), Some(upper)) = (constraint.bounds.lower, constraint.bounds.upper) else { return };
        let (Some(value), Node::Input(input)) =
            (self.problem.dag.is_constant(lower), self.problem.dag.node(constraint.body).clone())
        else {
            return;
        };
        let is_flat = matches!(self.problem.leaves.leaf(input), Leaf::Flat { .. });
        if lower != upper || !is_flat || !constraint.loops.is_empty() {
            return;
        }
        let span = constraint.span;
        match fixed.get(&input).copied() {
            Some((other, _)) if close(value, other, 0.0) => {}
            Some((_, first)) => {
                let message = "two boundary conditions contradict each other";
                let finding = Diagnostic::new(Code::Contradiction, span, message)
                    .label(span, "fixes it to another value")
                    .label(first, "fixes it here");
                self.report(finding.help("remove one of them"));
            }
            None => {
                fixed.insert(input, (value, span));
            }
        }
    }

    /// Tells, and says, when the fixed values put the body of a constraint outside its constant bounds.
    fn check_against(&mut self, fixed: &Fixed, k: usize) -> bool {
        let body = self.problem.constraints[k].body;
        let is_duration = |input| matches!(self.problem.leaves.leaf(input), Leaf::Duration(_));
        if !self.problem.dag.all_inputs(body, |input| fixed.contains_key(&input) || is_duration(input)) {
            return false;
        }
        let constraint = self.problem.constraints[k].clone();
        let inputs = self.problem.dag.inputs_of(&[constraint.body]);
        let mut values: HashMap<InputId, NodeId> = HashMap::new(); // Looked up, never iterated.
        let mut by: Option<Span> = None;
        for input in &inputs {
            let Some((value, span)) = fixed.get(input).copied().or_else(|| self.fixed_duration(*input)) else {
                return false;
            };
            values.insert(*input, self.problem.dag.constant(value));
            by = by.or(Some(span).filter(|span| *span != constraint.span));
        }
        let Some(by) = by else { return false };
        let body = self.problem.dag.substitute(&[constraint.body], |input| values.get(&input).copied())[0];
        let scale = self.scale(constraint.body, &values);
        let known = |node: Option<NodeId>| node.and_then(|node| self.problem.dag.is_constant(node));
        let Some(value) = known(Some(body)) else { return false };
        let (lower, upper) = (known(constraint.bounds.lower), known(constraint.bounds.upper));
        // Where a bound is 0 rounding has no size of its own; a smaller miss is left to the solver.
        let smallest = LEAST_MISS * constraint.unit.factor;
        let misses = |value: f64, bound: f64| (value - bound).abs() > smallest && !close(value, bound, scale);
        let below = lower.is_some_and(|lower| value < lower && misses(value, lower));
        let above = upper.is_some_and(|upper| value > upper && misses(value, upper));
        if !below && !above {
            return false;
        }
        let shown = (value / constraint.unit.factor * 1e6).round() / 1e6;
        let unit = match constraint.unit.symbol.as_str() {
            "" => String::new(),
            symbol => format!(" [{symbol}]"),
        };
        let (message, here) = match constraint.domain {
            Domain::Mission => ("a fixed duration contradicts a constraint", ""),
            _ => ("a boundary condition contradicts a bound", " at that end"),
        };
        let finding = Diagnostic::new(Code::Contradiction, constraint.span, message)
            .label(constraint.span, format!("what is bounded is {shown}{unit}{here}"))
            .label(by, "fixed here");
        self.report(finding.help("loosen the bound, or change what is fixed"));
        true
    }

    /// The size of the largest summand of a body: what its rounding errors are relative to.
    fn scale(&mut self, body: NodeId, values: &HashMap<InputId, NodeId>) -> f64 {
        let mut scale: f64 = 0.0;
        let mut open = vec![body];
        while let Some(node) = open.pop() {
            match *self.problem.dag.node(node) {
                Node::Binary(Binary::Add | Binary::Sub, a, b) => open.extend([a, b]),
                Node::Unary(Unary::Neg, a) => open.push(a),
                _ => {
                    let known = self.problem.dag.substitute(&[node], |input| values.get(&input).copied())[0];
                    scale = scale.max(self.problem.dag.is_constant(known).map_or(0.0, f64::abs));
                }
            }
        }
        scale
    }

    /// The value of a duration that a constant fixes, and its place.
    fn fixed_duration(&mut self, input: InputId) -> Option<(f64, Span)> {
        let Leaf::Duration(at) = self.problem.leaves.leaf(input) else { return None };
        let phase = at.phase;
        let Duration::Fixed(node) = self.problem.phases[phase].duration else { return None };
        let value = self.problem.dag.is_constant(node)?;
        let (_, span) = self.own_duration(self.phases[phase].scope)?;
        Some((value, span))
    }

    /// Tells when nothing says which of many trajectories is wanted.
    fn check_objective(&mut self) {
        if !self.problem.objective.is_empty() {
            return;
        }
        let equality = |c: &Constraint| c.bounds.lower.is_some() && c.bounds.lower == c.bounds.upper;
        let dynamic = self.problem.constraints.iter().any(|c| equality(c) && c.block == Block::Trajectory);
        let rows: i64 = self.problem.constraints.iter().filter(|c| equality(c)).map(|c| members(&c.loops)).sum();
        let mut unknowns = self.problem.variables.len() as i64;
        for (k, phase) in self.problem.phases.iter().enumerate() {
            let copies = members(
                &(*self.phase_context(k, super::scope::Allow::All, super::scope::Point::Nowhere).loops).clone(),
            );
            let outputs = phase.outputs.iter().map(|output| {
                let size = output.family.map_or(1, |(first, last)| (last - first + 1).max(0));
                size.saturating_mul(coefficients(&output.spline) as i64)
            });
            let free = i64::from(matches!(phase.duration, Duration::Free(_)));
            unknowns = unknowns.saturating_add(copies.saturating_mul(outputs.sum::<i64>() + free));
        }
        if dynamic || rows >= unknowns {
            return;
        }
        let message = "nothing is minimised, and the constraints leave the trajectory open";
        let finding = Diagnostic::new(Code::NoObjective, self.problem.span, message);
        self.report(finding.help("write `minimize ...;`, for instance the integral of a squared derivative; `minimize 0;` if any trajectory will do"));
    }
}

pub(super) fn close(a: f64, b: f64, scale: f64) -> bool {
    (a - b).abs() <= SLACK * a.abs().max(b.abs()).max(scale)
}

/// l (k - m) + m.
pub(super) fn coefficients(spline: &ntg_structure::Spline) -> usize {
    let (k, m, l) = (spline.order, spline.smoothness, spline.breakpoints.len().saturating_sub(1));
    l * k.saturating_sub(m) + m
}

/// How many members nested loops have, at most.
pub(super) fn members(loops: &[Loop]) -> i64 {
    let mut count: i64 = 1;
    for (k, over) in loops.iter().enumerate() {
        let (Some((first, _)), Some((_, last))) =
            (extremes(&over.first, &loops[..k]), extremes(&over.last, &loops[..k]))
        else {
            return 0;
        };
        count = count.saturating_mul(last.saturating_sub(first).saturating_add(1).max(0));
    }
    count
}
