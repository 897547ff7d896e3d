//! Which names a spec declares, and where each is mentioned: what definition, rename and completion are about.
//!
//! Takes a syntax tree; needs no meaning, so that it works on specs that do not compile yet.
//! A name in a template (an item of the problem or an agent that all phases copy) may stand for a declaration in
//! each of its phases: such a mention has several declarations, which are renamed together.

mod walk;

use std::collections::HashMap;

use ntg_compiler::source::Span;
use ntg_compiler::syntax::ast::{Ident, Library, Spec};

/// What a declaration declares.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// `problem`
    Problem,
    /// `agent`
    Agent,
    /// `phase`
    Phase,
    /// `scenario`
    Scenario,
    /// `domain`
    Domain,
    /// `const`
    Const,
    /// `param`, and `continuation` of a name of its own
    Param,
    /// `variable`
    Variable,
    /// `output`
    Output,
    /// `fn`
    Function,
    /// `let`
    Let,
    /// `table`
    Table,
    /// `duration T`
    Duration,
    /// The index of a family, a `for` or a sum.
    Index,
    /// A parameter of a function.
    Argument,
    /// A `let` among the steps of a value.
    Step,
    /// A term of the objective.
    Term,
    /// A constraint.
    Constraint,
}

/// A declared name.
#[derive(Clone, Debug)]
pub struct Declaration {
    /// The name and where it stands.
    pub name: Ident,
    /// What it names.
    pub kind: Kind,
    /// The scope in which it is known: an index into [`Names::scopes`].
    pub scope: usize,
    /// The whole statement.
    pub statement: Span,
    /// Its documentation.
    pub doc: Option<String>,
    /// Where it is known, if not in all of its scope: indices and arguments.
    pub within: Option<Span>,
    /// The scope that it opens: problems, agents, phases.
    pub inner: Option<usize>,
}

/// A place where a name stands.
#[derive(Clone, Debug)]
pub struct Mention {
    /// Where.
    pub span: Span,
    /// What it may stand for, as indices into [`Names::declarations`].
    pub declarations: Vec<usize>,
}

/// A problem, an agent, a phase or a scenario.
#[derive(Clone, Debug)]
pub struct Scope {
    /// The scope around it.
    pub parent: Option<usize>,
    /// Its text, braces included.
    pub span: Span,
    /// Whether its names are known outside only behind its own, as those of a scenario.
    closed: bool,
    /// Its own names.
    names: HashMap<String, Vec<usize>>, // Looked up, never iterated.
}

/// An expression whose derivative is taken.
#[derive(Clone, Debug)]
pub struct Derivative {
    /// `der(...)`, all of it.
    pub span: Span,
    /// The scope that it stands in.
    pub scope: usize,
    /// The index ranges around it, the outermost first.
    pub indices: Vec<Span>,
    /// Whether names stand in it that only a function's caller knows.
    pub in_function: bool,
}

/// All names of a spec.
#[derive(Clone, Debug, Default)]
pub struct Names {
    /// Everything declared, in the order of the text within each scope.
    pub declarations: Vec<Declaration>,
    /// Every name that stands for a declaration, the declared names too; by place.
    pub mentions: Vec<Mention>,
    /// The problem, then agents, phases and scenarios.
    pub scopes: Vec<Scope>,
    /// Every `der(...)`.
    pub derivatives: Vec<Derivative>,
}

impl Names {
    /// The names of a spec.
    pub fn of(spec: &Spec) -> Self {
        let mut names = walk::names(spec);
        names.mentions.sort_by_key(|mention| mention.span);
        names
    }

    /// The names of a library, whose text is `all`.
    pub fn of_library(library: &Library, all: Span) -> Self {
        let mut names = walk::library(library, all);
        names.mentions.sort_by_key(|mention| mention.span);
        names
    }

    /// The mention that touches a byte.
    pub fn at(&self, byte: usize) -> Option<&Mention> {
        let after = self.mentions.partition_point(|mention| mention.span.start as usize <= byte);
        self.mentions[..after].last().filter(|mention| byte <= mention.span.end as usize)
    }

    /// Everything that is renamed together with a declaration: all that some mention joins it with.
    pub fn together(&self, declaration: usize) -> Vec<usize> {
        let mut group = vec![declaration];
        let mut next = 0;
        while let Some(&of) = group.get(next) {
            for mention in self.mentions.iter().filter(|mention| mention.declarations.contains(&of)) {
                for &other in &mention.declarations {
                    if !group.contains(&other) {
                        group.push(other);
                    }
                }
            }
            next += 1;
        }
        group
    }

    /// All places at which one of the declarations is mentioned.
    pub fn places(&self, group: &[usize]) -> Vec<Span> {
        let stands = |mention: &&Mention| mention.declarations.iter().any(|one| group.contains(one));
        self.mentions.iter().filter(stands).map(|mention| mention.span).collect()
    }

    /// The innermost scope around a byte.
    pub fn scope_at(&self, byte: usize) -> usize {
        let holds = |scope: &Scope| scope.span.start as usize <= byte && byte <= scope.span.end as usize;
        (0..self.scopes.len())
            .filter(|&at| holds(&self.scopes[at]))
            .min_by_key(|&at| self.scopes[at].span.len())
            .unwrap_or(0)
    }

    /// What can be named at a byte.
    pub fn visible(&self, byte: usize) -> impl Iterator<Item = &Declaration> {
        let scope = self.scope_at(byte);
        self.declarations.iter().filter(move |declaration| match declaration.within {
            Some(within) => within.start as usize <= byte && byte <= within.end as usize,
            // A template may name what each phase declares.
            None => {
                let inside = self.is_within(declaration.scope, scope) && !self.scopes[declaration.scope].closed;
                inside || self.is_within(scope, declaration.scope)
            }
        })
    }

    /// Whether a scope is another one or stands in it.
    fn is_within(&self, mut inner: usize, outer: usize) -> bool {
        loop {
            if inner == outer {
                return true;
            }
            match self.scopes.get(inner).and_then(|scope| scope.parent) {
                Some(parent) => inner = parent,
                None => return false,
            }
        }
    }
}
