//! Scopes and the names in them; contexts in which expressions are given a meaning.
//!
//! The problem, each agent and each phase is a scope. A problem without agents is its one agent, an
//! agent without phases is its one phase: one scope then plays several roles. What is written in an
//! agent outside its phases is resolved in each phase (docs/language.md, section 4), so names
//! are looked up from the phase of the [`Context`] outwards, wherever the text stands.

use std::collections::HashSet;
use std::rc::Rc;

use super::element::Lazy;
use super::problem::{Form, IndexId, Instant, Loop, PhaseAt};
use super::shape::Shape;
use super::value::Value;
use crate::expr::Map;
use crate::source::Span;
use crate::syntax::ast;

/// Addresses a [`Scope`].
pub(super) type ScopeId = usize;

/// The problem's own scope.
pub(super) const PROBLEM: ScopeId = 0;

/// The problem, an agent or a phase.
pub(super) struct Scope<'a> {
    /// The scope around it.
    pub(super) parent: Option<ScopeId>,
    /// The agent it is or belongs to.
    pub(super) agent: Option<usize>,
    /// The phase it is.
    pub(super) phase: Option<usize>,
    /// The libraries that are known here by a name.
    pub(super) libraries: Map<&'a str, ScopeId>, // Looked up, never iterated.
    /// Whether it is a library, and whether that could not be read: nothing is told of its names then.
    pub(super) is_library: bool,
    pub(super) is_broken: bool,
    /// The name of its family's index.
    pub(super) index: Option<&'a ast::Ident>,
    /// Its own names.
    pub(super) names: Map<&'a str, Declared>, // Looked up, never iterated.
    /// Its own names in the order of declaration.
    pub(super) order: Vec<&'a str>,
}

/// A name's first declaration.
#[derive(Clone, Copy, Debug)]
pub(super) struct Declared {
    /// What it names.
    pub(super) entity: Entity,
    /// Where.
    pub(super) span: Span,
}

/// What a name can name; the numbers address the lists of the elaborator.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Entity {
    /// A `const` or `let`.
    Definition(usize),
    /// A `fn`.
    Function(usize),
    /// A `param`.
    Parameter(usize),
    /// A `variable`.
    Variable(usize),
    /// A `table`.
    Table(usize),
    /// A flat output; which one depends on the phase.
    Output,
    /// The independent variable.
    Independent,
    /// The duration of this scope.
    Duration(ScopeId),
    /// A phase.
    Phase(usize),
    /// An agent.
    Agent(usize),
}

impl Entity {
    /// What a person calls it.
    pub(super) fn describe(self) -> &'static str {
        match self {
            Self::Definition(_) => "a definition",
            Self::Function(_) => "a function",
            Self::Parameter(_) => "a parameter",
            Self::Variable(_) => "a variable",
            Self::Table(_) => "a table",
            Self::Output => "an output",
            Self::Independent => "the independent variable",
            Self::Duration(_) => "a duration",
            Self::Phase(_) => "a phase",
            Self::Agent(_) => "an agent",
        }
    }
}

/// At which point outputs and time are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) enum Point {
    /// At none: the expression is a number of the whole mission.
    Nowhere,
    /// All along the phase.
    Path,
    /// At the phase's start, where the expression itself lives.
    Start,
    /// At the phase's end, where the expression itself lives.
    End,
    /// At the phase's start, seen from the mission.
    MissionStart,
    /// At the phase's end, seen from the mission.
    MissionEnd,
    /// At a place inside the phase, seen from the mission.
    MissionInside(Instant),
    /// At a place for each value of an index, seen from the mission.
    MissionAmong {
        /// Index into `Problem::places`.
        places: usize,
        /// The index.
        index: IndexId,
    },
}

/// What an expression may depend on.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub(super) enum Allow {
    /// Constants alone.
    Constants,
    /// Constants, parameters and indices.
    Parameters,
    /// The same, and time, scaled time and durations as they are guessed.
    Guess,
    /// Everything that has a value at the point.
    All,
}

/// A name that an expression brings along.
pub(super) struct Local<'a> {
    pub(super) name: &'a str,
    pub(super) meaning: Meaning<'a>,
    pub(super) next: Option<Rc<Local<'a>>>,
}

/// What a local name stands for.
#[derive(Clone)]
pub(super) enum Meaning<'a> {
    /// An index.
    Index(Form),
    /// A function's argument.
    Argument(Value),
    /// A function's argument that is a vector.
    Lazy(Rc<Lazy<'a>>),
    /// Something of which only the shape is known.
    Shaped(Shape),
}

/// Where and as what an expression is given a meaning.
#[derive(Clone)]
pub(super) struct Context<'a> {
    /// Where names are looked up.
    pub(super) scope: ScopeId,
    /// Where the text stands: what `integral(e)` without a path is about.
    pub(super) lexical: ScopeId,
    /// The member of the scope's agent.
    pub(super) agent: Option<Form>,
    /// The member of the scope's phase.
    pub(super) phase: Option<Form>,
    /// Where outputs and time are taken.
    pub(super) point: Point,
    /// What may occur.
    pub(super) allow: Allow,
    /// The loops around the expression.
    pub(super) loops: Rc<Vec<Loop>>,
    /// Indices and arguments in sight, the innermost first.
    pub(super) locals: Option<Rc<Local<'a>>>,
    /// The members around the expression that are made one by one.
    pub(super) members: Rc<Vec<i64>>,
    /// Whether what an index of a family of phases or agents decides is chosen now, and the family parted there.
    pub(super) parts_families: bool,
    /// The library whose text it is: its names are looked up there, and nowhere else.
    pub(super) library: Option<ScopeId>,
}

impl<'a> Context<'a> {
    /// A context of a scope for numbers, without indices.
    pub(super) fn of(scope: ScopeId, allow: Allow) -> Self {
        Self {
            scope,
            lexical: scope,
            agent: None,
            phase: None,
            point: Point::Nowhere,
            allow,
            loops: Rc::default(),
            locals: None,
            members: Rc::default(),
            parts_families: false,
            library: None,
        }
    }

    /// The scope in which names are looked up.
    pub(super) fn names(&self) -> ScopeId {
        self.library.unwrap_or(self.scope)
    }

    /// The same context with another point.
    pub(super) fn at(&self, point: Point) -> Self {
        Self { point, ..self.clone() }
    }

    /// The same context with other permissions.
    pub(super) fn allowing(&self, allow: Allow) -> Self {
        Self { allow, ..self.clone() }
    }

    /// The same context with one more name.
    pub(super) fn with(&self, name: &'a str, meaning: Meaning<'a>) -> Self {
        let next = self.locals.clone();
        Self { locals: Some(Rc::new(Local { name, meaning, next })), ..self.clone() }
    }

    /// The same context where an index has a value.
    pub(super) fn knowing(&self, index: IndexId, value: i64) -> Self {
        let mut locals = Vec::new();
        let mut next = self.locals.as_deref();
        while let Some(local) = next {
            let meaning = match &local.meaning {
                Meaning::Index(form) => Meaning::Index(form.with(index, value)),
                other => other.clone(),
            };
            locals.push((local.name, meaning));
            next = local.next.as_deref();
        }
        let loops = self.loops.iter().filter(|over| over.index != index).map(|over| Loop {
            index: over.index,
            first: over.first.with(index, value),
            last: over.last.with(index, value),
        });
        let bare = Self { locals: None, loops: Rc::new(loops.collect()), ..self.clone() };
        locals.into_iter().rev().fold(bare, |context, (name, meaning)| context.with(name, meaning))
    }

    /// The same context inside one more loop.
    pub(super) fn inside(&self, over: Loop) -> Self {
        let mut loops = (*self.loops).clone();
        loops.push(over);
        Self { loops: Rc::new(loops), ..self.clone() }
    }

    /// The same context for one member of a range that is made by itself.
    pub(super) fn at_member(&self, member: i64) -> Self {
        let mut members = (*self.members).clone();
        members.push(member);
        Self { members: Rc::new(members), ..self.clone() }
    }

    /// The local name, if there is one.
    pub(super) fn local(&self, name: &str) -> Option<&Meaning<'a>> {
        let mut next = self.locals.as_deref();
        while let Some(local) = next {
            if local.name == name {
                return Some(&local.meaning);
            }
            next = local.next.as_deref();
        }
        None
    }

    /// The phase `phase` with the members of this context.
    pub(super) fn phase_at(&self, phase: usize) -> PhaseAt {
        PhaseAt { phase, agent: self.agent.clone(), index: self.phase.clone() }
    }
}

/// The first names that may be meant at a place: of the scope and of those around it, without repetition.
pub(super) fn visible<'s, 'a: 's>(scopes: &'s [Scope<'a>], scope: ScopeId, most: usize) -> Vec<(&'a str, Entity)> {
    let mut names: Vec<(&str, Entity)> = Vec::new();
    let mut known: HashSet<&str> = HashSet::new();
    let mut next = Some(scope);
    while let Some(id) = next {
        for name in &scopes[id].order {
            if names.len() == most {
                return names;
            }
            if known.insert(name) {
                names.push((name, scopes[id].names[name].entity));
            }
        }
        next = scopes[id].parent;
    }
    names
}

/// What a name means in a scope, and in which scope it was found.
pub(super) fn look_up(scopes: &[Scope<'_>], scope: ScopeId, name: &str) -> Option<(ScopeId, Declared)> {
    if name.as_bytes().contains(&b':')
        && let Some((library, inner)) = name.split_once("::")
    {
        let id = library_named(scopes, scope, library)?;
        return scopes[id].names.get(inner).map(|declared| (id, *declared));
    }
    let mut next = Some(scope);
    while let Some(id) = next {
        if let Some(declared) = scopes[id].names.get(name) {
            return Some((id, *declared));
        }
        next = scopes[id].parent;
    }
    None
}

/// The library that is known by a name in a scope.
pub(super) fn library_named(scopes: &[Scope<'_>], scope: ScopeId, name: &str) -> Option<ScopeId> {
    let mut next = Some(scope);
    while let Some(id) = next {
        if let Some(library) = scopes[id].libraries.get(name) {
            return Some(*library);
        }
        next = scopes[id].parent;
    }
    None
}
