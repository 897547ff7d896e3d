//! What the bounds on durations and starts leave possible for constraints of the mission.
//!
//! Takes the finished problem, encloses each such constraint's body between two numbers.
//! Finds: constraints that no durations within their bounds can meet, such as a total of 10 s over two
//! phases of at most 2 s each. What parameters decide is the solver's affair.

use super::check::close;
use super::elaborator::Elaborator;
use super::problem::{Bounds, Duration, Form, Leaf, Loop, PhaseAt, Start};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Binary, Fold, Node, NodeId, Unary};

/// All numbers from the first to the second.
type Window = (f64, f64);

/// Nothing is known.
const ANYTHING: Window = (f64::NEG_INFINITY, f64::INFINITY);

impl Elaborator<'_> {
    /// Tells when a constraint lies outside everything that durations and starts can make of it.
    pub(super) fn check_windows(&mut self, k: usize) {
        let constraint = &self.problem.constraints[k];
        let known = |node: Option<NodeId>| node.and_then(|node| self.problem.dag.is_constant(node));
        let (lower, upper) = (known(constraint.bounds.lower), known(constraint.bounds.upper));
        let (least, most) = self.window(constraint.body, 0);
        let short = lower.is_some_and(|lower| most < lower && !close(most, lower, 0.0));
        let long = upper.is_some_and(|upper| least > upper && !close(least, upper, 0.0));
        if !short && !long {
            return;
        }
        let shown = |value: f64| (value / constraint.unit.factor * 1e6).round() / 1e6;
        let unit = match constraint.unit.symbol.as_str() {
            "" => String::new(),
            symbol => format!(" [{symbol}]"),
        };
        let what = if short { format!("at most {}", shown(most)) } else { format!("at least {}", shown(least)) };
        let span = constraint.span;
        let message = "the bounds of the durations contradict this constraint";
        let finding =
            Diagnostic::new(Code::Contradiction, span, message).label(span, format!("what is bounded is {what}{unit}"));
        self.report(finding.help("widen the bounds of a duration, or loosen this constraint"));
    }

    /// Numbers between which an expression of the mission lies.
    fn window(&self, node: NodeId, depth: usize) -> Window {
        /// Deeper expressions are left to the solver.
        const DEEPEST: usize = 100;
        if depth > DEEPEST {
            return ANYTHING;
        }
        let of = |node: NodeId| self.window(node, depth + 1);
        match *self.problem.dag.node(node) {
            Node::Const(number) => (number.value(), number.value()),
            Node::Input(input) => match self.problem.leaves.leaf(input) {
                Leaf::Duration(at) => self.duration_window(at.phase),
                Leaf::Start(at) => self.start_window(at),
                Leaf::Variable { variable, index: None } => {
                    self.bounds_window(&self.problem.variables[*variable].bounds)
                }
                _ => ANYTHING,
            },
            Node::Unary(Unary::Neg, a) => {
                let (least, most) = of(a);
                (-most, -least)
            }
            Node::Binary(Binary::Add, a, b) => plus(of(a), of(b)),
            Node::Binary(Binary::Sub, a, b) => {
                let (least, most) = of(b);
                plus(of(a), (-most, -least))
            }
            Node::Binary(Binary::Mul, a, b) => match (self.problem.dag.is_constant(a), self.problem.dag.is_constant(b))
            {
                (Some(factor), _) => times(factor, of(b)),
                (_, Some(factor)) => times(factor, of(a)),
                _ => ANYTHING,
            },
            Node::Reduce { fold: Fold::Sum, range, body, .. } => match count(&self.problem.ranges[range as usize]) {
                Some(members) => times(members, of(body)),
                None => ANYTHING,
            },
            _ => ANYTHING,
        }
    }

    fn bounds_window(&self, bounds: &Bounds) -> Window {
        let known = |node: Option<NodeId>| node.and_then(|node| self.problem.dag.is_constant(node));
        let end = |node: Option<NodeId>, open: f64| known(node).unwrap_or(open);
        (end(bounds.lower, ANYTHING.0), end(bounds.upper, ANYTHING.1))
    }

    /// How long a phase, or each of its members, may last.
    fn duration_window(&self, phase: usize) -> Window {
        let (least, most) = match &self.problem.phases[phase].duration {
            Duration::Fixed(node) => self.problem.dag.is_constant(*node).map_or(ANYTHING, |value| (value, value)),
            Duration::Free(bounds) => self.bounds_window(bounds),
        };
        (least.max(0.0), most)
    }

    /// When a phase may start.
    fn start_window(&self, at: &PhaseAt) -> Window {
        let phase = &self.problem.phases[at.phase];
        let mut window = match &self.problem.agents[phase.agent].start {
            Start::Fixed(None) => (0.0, 0.0),
            Start::Fixed(Some(node)) => self.problem.dag.is_constant(*node).map_or(ANYTHING, |value| (value, value)),
            Start::Free(bounds) => self.bounds_window(bounds),
        };
        if let Some(family) = &phase.family {
            let (least, most) = self.duration_window(at.phase);
            // A member that an index leaves open may be any of them.
            let (first, last) = match at.index.as_ref().and_then(Form::as_number) {
                Some(index) => ((index - family.first.constant) as f64, (index - family.first.constant) as f64),
                None => (0.0, count(family).unwrap_or(f64::INFINITY)),
            };
            window = plus(window, (product(first, least), product(last, most)));
        }
        let mut next = phase.after;
        while let Some(before) = next {
            let phase = &self.problem.phases[before];
            let members = phase.family.as_ref().map_or(Some(1.0), count);
            window = plus(window, members.map_or(ANYTHING, |members| times(members, self.duration_window(before))));
            next = phase.after;
        }
        window
    }
}

/// How many members a loop with constant ends has.
fn count(over: &Loop) -> Option<f64> {
    let (first, last) = (over.first.as_number()?, over.last.as_number()?);
    Some((last - first + 1).max(0) as f64)
}

fn plus(a: Window, b: Window) -> Window {
    (a.0 + b.0, a.1 + b.1)
}

fn times(factor: f64, (least, most): Window) -> Window {
    let (a, b) = (product(factor, least), product(factor, most));
    (a.min(b), a.max(b))
}

/// A product in which zero times anything is zero.
fn product(a: f64, b: f64) -> f64 {
    if a == 0.0 || b == 0.0 { 0.0 } else { a * b }
}
