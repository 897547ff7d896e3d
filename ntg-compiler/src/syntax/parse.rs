//! From the grammar's pairs to the syntax tree: one function a rule, named after it.
//!
//! Takes pairs, gives nodes of `ast`.
//! Finds: what the grammar lets pass so that the message can be about the mistake: relations that are none,
//! tuples and units where none may stand, unknown settings, wrong numbers of arguments, statements in the
//! wrong scope. After a finding the node holds something harmless, which no one sees.

mod calls;
mod conditions;
mod constraints;
mod declarations;
mod expressions;
mod files;
mod guesses;
mod items;
mod lists;
mod parts;
mod settings;
mod shapes;
mod tables;
mod time;
mod units;
mod uses;

use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;

use super::ast::{Doc, Ident, Library, Spec};
use super::grammar::{Pair, Rule};
use super::scan::MAX_FINDINGS;
use parts::Parts;

/// The scope that items stand in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scope {
    Problem,
    Agent,
    Phase,
    Scenario,
    /// A file without a problem.
    Library,
}

/// The working state: where the parsed text begins in the source, and what was found.
pub(super) struct Build {
    base: usize,
    scope: Scope,
    pub(super) found: Vec<Diagnostic>,
}

impl Build {
    /// A state for text that begins at byte `base` of the source, in the problem's own scope.
    pub(super) fn new(base: usize) -> Self {
        Self { base, scope: Scope::Problem, found: vec![] }
    }

    /// The same for text inside an agent or a phase.
    pub(super) fn within(base: usize, scope: Scope) -> Self {
        Self { scope, ..Self::new(base) }
    }

    pub(super) fn spec(&mut self, pair: Pair<'_>) -> Spec {
        let mut parts = Parts::of(pair);
        let uses = self.uses(&mut parts);
        Spec { uses, problem: self.problem(parts.required(Rule::problem)) }
    }

    pub(super) fn library(&mut self, pair: Pair<'_>) -> Library {
        let mut parts = Parts::of(pair);
        let uses = self.uses(&mut parts);
        Library { uses, items: self.items(Scope::Library, parts) }
    }

    fn doc(&mut self, pair: Pair<'_>) -> Doc {
        let span = self.span(&pair);
        let lines = pair.into_inner().map(|line| {
            let text = line.as_str().trim_start_matches("///").trim_end();
            text.strip_prefix(' ').unwrap_or(text).to_owned()
        });
        Doc { text: lines.collect::<Vec<_>>().join("\n"), span }
    }

    /// A name, in the form in which equal names are equal bytes.
    fn name(&mut self, pair: &Pair<'_>) -> Ident {
        use unicode_normalization::UnicodeNormalization;
        let written = pair.as_str();
        let text = if written.is_ascii() { written.to_owned() } else { written.nfc().collect() };
        Ident { text, span: self.span(pair) }
    }

    /// The span of a pair, without the white space that pest leaves at the end of rules with
    /// optional parts.
    fn span(&self, pair: &Pair<'_>) -> Span {
        let start = self.base + pair.as_span().start();
        Span::new(start, start + pair.as_str().trim_end().len())
    }

    fn report(&mut self, code: Code, span: Span, message: impl Into<String>, help: impl Into<String>) {
        if self.found.len() < MAX_FINDINGS {
            self.found.push(Diagnostic::new(code, span, message).help(help));
        }
    }
}
