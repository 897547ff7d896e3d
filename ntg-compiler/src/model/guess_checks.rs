//! Guesses that cannot be what was meant.
//!
//! Takes the `guess` blocks of a scope as they are written, and known guesses of durations and variables.
//! Finds: targets with the very same words twice, outside of loops (E021); what is guessed as a whole and again by
//! its elements is guessed once each. Guesses outside of known bounds (N010), where the solver begins at the bound.

use std::collections::HashMap;

use super::elaborator::Elaborator;
use super::problem::{Bounds, Duration, GuessScope};
use super::scope::ScopeId;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::source::Span;
use crate::syntax::ast::{GuessKind, ItemKind, Statement, Target};

impl Elaborator<'_> {
    /// Tells of a guessed duration that is not positive, or not within its bounds.
    pub(super) fn guessed_duration(&mut self, scope: &GuessScope, node: NodeId, (name, value): (Span, Span)) {
        self.positive(node, value);
        let phase = match scope {
            GuessScope::Phase(at) => Some(at.phase),
            GuessScope::Agent(agent, _) => match self.agents[*agent].phases.as_slice() {
                [only] => Some(*only),
                _ => None,
            },
        };
        // The name of the whole is that of all members of a family.
        let is_whole = matches!(scope, GuessScope::Agent(..));
        let declared = phase.and_then(|phase| self.problem.phases.get(phase));
        let declared = declared.filter(|phase| phase.family.is_none() || !is_whole).map(|phase| &phase.duration);
        if let Some(Duration::Free(bounds)) = declared
            && self.problem.dag.is_constant(node).is_some_and(|value| value > 0.0)
        {
            let bounds = bounds.clone();
            self.guessed_within(&bounds, node, (name, value));
        }
    }

    /// Notes a known guess outside of known bounds.
    pub(super) fn guessed_within(&mut self, bounds: &Bounds, node: NodeId, (name, value): (Span, Span)) {
        let known = |node: Option<NodeId>| node.and_then(|node| self.problem.dag.is_constant(node));
        let Some(guess) = known(Some(node)) else { return };
        let side = match (known(bounds.lower), known(bounds.upper)) {
            (Some(lower), _) if guess < lower => "below its lower",
            (_, Some(upper)) if guess > upper => "above its upper",
            _ => return,
        };
        let message = format!("`{}` is guessed {side} bound", self.text(name));
        let finding = Diagnostic::new(Code::GuessOutside, value, message);
        self.report(finding.help("the search begins at that bound: guess a value within, or widen the bounds"));
    }

    /// Tells of what is guessed twice in a scope.
    pub(super) fn guessed_twice(&mut self, scope: ScopeId) {
        let mut known: HashMap<String, Span> = HashMap::new(); // Looked up, never iterated.
        for item in self.items[scope] {
            let ItemKind::Guess(guess) = &item.kind else { continue };
            for statement in &guess.statements {
                let Statement::One(GuessKind::Assign(assign)) = statement else { continue };
                let span = match &assign.target {
                    Target::Path(path) => path.span,
                    Target::Event { span, .. } => *span,
                };
                let text: String = self.source.slice(span).split_whitespace().collect();
                if let Some(first) = known.get(&text).copied() {
                    let finding = Diagnostic::new(Code::DeclaredTwice, span, format!("`{text}` is guessed twice"));
                    let finding = finding.label(span, "guessed again here").label(first, "guessed here");
                    self.report(finding.help("remove one of them"));
                } else {
                    known.insert(text, span);
                }
            }
        }
    }
}
