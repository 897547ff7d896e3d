//! Collects what a spec declares: scopes, names, agents and phases in order of time.
//!
//! Takes the items of the spec, fills the lists and scopes of the elaborator; no expression is
//! looked into.
//! Finds: names declared twice or named like a function, items at a level where they mean
//! nothing. The order of phases is the affair of `order.rs`.
//! Afterwards: every name can be looked up, in any order of declaration.

use super::elaborator::{
    AgentDeclaration, Definition, Elaborator, FunctionDeclaration, PhaseDeclaration, TableSignature, doc_text,
};
use super::scope::{Declared, Entity, PROBLEM, Scope, ScopeId};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{self, Item, ItemKind};

/// At which level an item stands.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Level {
    /// In the problem, which is its one agent.
    Problem,
    /// In the problem, beside agents.
    AboveAgents,
    /// In an agent.
    Agent,
    /// In a phase.
    Phase,
}

impl<'a> Elaborator<'a> {
    /// Collects everything; the first step of the pass.
    pub(super) fn declarations(&mut self, problem: &'a ast::Problem) {
        let has_agents = problem.items.iter().any(|item| matches!(item.kind, ItemKind::Agent(_)));
        self.add_scope(None, None, &problem.items);
        if has_agents {
            self.scope_items(PROBLEM, Level::AboveAgents);
        } else {
            self.agents.push(AgentDeclaration { scope: PROBLEM, item: None, phases: Vec::new() });
            self.scopes[PROBLEM].agent = Some(0);
            self.scope_items(PROBLEM, Level::Problem);
            self.lonely_phase(PROBLEM, problem.name.span);
        }
        self.hidden_outputs();
    }

    pub(super) fn add_scope(
        &mut self,
        parent: Option<ScopeId>,
        index: Option<&'a ast::Ident>,
        items: &'a [Item],
    ) -> ScopeId {
        let agent = parent.and_then(|p| self.scopes[p].agent);
        let names = Default::default();
        let libraries = Default::default();
        let (phase, order, is_library, is_broken) = (None, Vec::new(), false, false);
        self.scopes.push(Scope { parent, agent, phase, index, names, order, libraries, is_library, is_broken });
        self.items.push(items);
        self.scopes.len() - 1
    }

    fn scope_items(&mut self, scope: ScopeId, level: Level) {
        for item in self.items[scope] {
            if !allowed(&item.kind, level) {
                self.misplaced(item, level);
            } else {
                self.item(scope, item);
            }
        }
    }

    pub(super) fn item(&mut self, scope: ScopeId, item: &'a Item) {
        let doc = doc_text(&item.doc);
        match &item.kind {
            ItemKind::Const(c) => {
                let entity = Entity::Definition(self.definitions.len());
                self.declare(scope, &c.name, Declared { entity, span: c.name.span });
                let (unit, shape, is_const) = (None, c.shape.as_ref(), true);
                let (name, value, span) = (&c.name, &c.value, item.span);
                self.definitions.push(Definition { name, doc, unit, shape, value, scope, is_const, span });
            }
            ItemKind::Let(l) => {
                let entity = Entity::Definition(self.definitions.len());
                self.declare(scope, &l.name, Declared { entity, span: l.name.span });
                let (unit, shape, is_const) = (l.unit.as_ref(), l.shape.as_ref(), false);
                let (name, value, span) = (&l.name, &l.value, item.span);
                self.definitions.push(Definition { name, doc, unit, shape, value, scope, is_const, span });
            }
            ItemKind::Param(p) => self.parameter_name(&p.name),
            ItemKind::Continuation(c) => {
                // It refines a `param` of the same name, wherever that stands, or declares one.
                let refines = self.items[PROBLEM]
                    .iter()
                    .any(|other| matches!(&other.kind, ItemKind::Param(p) if p.name.text == c.name.text));
                if !refines {
                    self.parameter_name(&c.name);
                }
            }
            ItemKind::Variable(v) => {
                for name in &v.names {
                    let entity = Entity::Variable(self.variables.len());
                    self.declare(scope, &name.name, Declared { entity, span: name.name.span });
                    self.variables.push((name, None));
                }
            }
            ItemKind::Output(o) => {
                for name in &o.names {
                    self.declare(scope, &name.name, Declared { entity: Entity::Output, span: name.name.span });
                }
            }
            ItemKind::Function(function) => {
                let entity = Entity::Function(self.functions.len());
                self.declare(scope, &function.name, Declared { entity, span: function.name.span });
                self.functions.push(FunctionDeclaration { function, scope });
            }
            ItemKind::Table(table) => {
                let entity = Entity::Table(self.tables.len());
                self.declare(scope, &table.name, Declared { entity, span: table.name.span });
                self.tables.push(table);
                self.signatures.push(TableSignature { axes: Vec::new(), dimension: None });
            }
            ItemKind::Duration(duration) => {
                if let Some(name) = &duration.name {
                    self.declare(scope, name, Declared { entity: Entity::Duration(scope), span: name.span });
                }
            }
            ItemKind::Phase(phase) => self.phase_declaration(scope, phase, item),
            ItemKind::Agent(agent) => self.agent_declaration(scope, agent, item),
            ItemKind::Domain(_)
            | ItemKind::Start(_)
            | ItemKind::Scenario(_)
            | ItemKind::Shared(_)
            | ItemKind::Jump(_)
            | ItemKind::Continuous(_)
            | ItemKind::Periodic(_)
            | ItemKind::At(_)
            | ItemKind::Collocation(_)
            | ItemKind::Objective(_)
            | ItemKind::Block(_)
            | ItemKind::Guess(_) => {}
        }
    }

    fn parameter_name(&mut self, name: &'a ast::Ident) {
        let entity = Entity::Parameter(self.parameters.len());
        self.declare(PROBLEM, name, Declared { entity, span: name.span });
        self.parameters.push((name, None));
    }

    fn phase_declaration(&mut self, scope: ScopeId, phase: &'a ast::Phase, item: &'a Item) {
        let entity = Entity::Phase(self.phases.len());
        self.declare(scope, &phase.name, Declared { entity, span: phase.name.span });
        let index = phase.family.as_ref().map(|family| &family.index);
        let inner = self.add_scope(Some(scope), index, &phase.items);
        self.scopes[inner].phase = Some(self.phases.len());
        let agent = self.scopes[inner].agent.unwrap_or_default();
        let span = Span { start: item.span.start, end: phase.name.span.end };
        self.agents[agent].phases.push(self.phases.len());
        self.phases.push(PhaseDeclaration { scope: inner, agent, item: Some(phase), after: None, span });
        self.scope_items(inner, Level::Phase);
    }

    fn agent_declaration(&mut self, scope: ScopeId, agent: &'a ast::Agent, item: &'a Item) {
        let id = self.agents.len();
        self.declare(scope, &agent.name, Declared { entity: Entity::Agent(id), span: agent.name.span });
        let index = agent.family.as_ref().map(|family| &family.index);
        let inner = self.add_scope(Some(scope), index, &agent.items);
        self.scopes[inner].agent = Some(id);
        self.agents.push(AgentDeclaration { scope: inner, item: Some(agent), phases: Vec::new() });
        self.scope_items(inner, Level::Agent);
        self.lonely_phase(inner, Span { start: item.span.start, end: agent.name.span.end });
    }

    /// An agent without phases is its one phase.
    fn lonely_phase(&mut self, scope: ScopeId, span: Span) {
        let Some(agent) = self.scopes[scope].agent else { return };
        if self.agents[agent].phases.is_empty() {
            self.agents[agent].phases.push(self.phases.len());
            self.scopes[scope].phase = Some(self.phases.len());
            self.phases.push(PhaseDeclaration { scope, agent, item: None, after: None, span });
        }
    }

    /// A phase may give a common output another spline, but may not use its name for anything else.
    fn hidden_outputs(&mut self) {
        for phase in 0..self.phases.len() {
            let scope = self.phases[phase].scope;
            let Some(outer) = self.scopes[scope].parent.filter(|_| self.phases[phase].item.is_some()) else { continue };
            for name in self.scopes[scope].order.clone() {
                let inner = self.scopes[scope].names[name];
                let Some(common) = self.scopes[outer].names.get(name).copied() else { continue };
                if common.entity == Entity::Output && inner.entity != Entity::Output {
                    let finding =
                        Diagnostic::new(Code::DeclaredTwice, inner.span, format!("`{name}` is declared twice"))
                            .label(inner.span, format!("{} here", inner.entity.describe()))
                            .label(common.span, "an output of every phase")
                            .help("give one of them another name");
                    self.report(finding);
                }
            }
        }
    }

    fn misplaced(&mut self, item: &'a Item, level: Level) {
        let (place, help) = match (level, &item.kind) {
            (Level::AboveAgents, _) => ("beside agents", "move it into the agent that it belongs to"),
            (Level::Problem, ItemKind::Jump(_) | ItemKind::Continuous(_)) => {
                ("outside a phase", "write it in the later of the two phases that meet")
            }
            (Level::Problem, _) => ("here", "remove it"),
            (Level::Agent, ItemKind::Jump(_) | ItemKind::Continuous(_)) => {
                ("outside a phase", "write it in the later of the two phases that meet")
            }
            (Level::Agent, ItemKind::Agent(_)) => ("in an agent", "agents do not nest: move it into the problem"),
            (Level::Agent, _) => ("in an agent", "move it into the problem, where all agents see it"),
            (Level::Phase, ItemKind::Phase(_)) => ("in a phase", "phases do not nest: move it out of this one"),
            (Level::Phase, ItemKind::Start(_)) => ("in a phase", "move it out of the phase: it starts the whole agent"),
            (Level::Phase, _) => ("in a phase", "move it into the problem, where all phases see it"),
        };
        let word = keyword(&item.kind);
        let span = Span::new(item.span.start as usize, item.span.start as usize + word.len());
        let message = format!("`{word}` means nothing {place}");
        self.report(Diagnostic::new(Code::WrongLevel, span, message).help(help));
        // Where such a name is used nothing is wrong but its place, which was told.
        match &item.kind {
            ItemKind::Param(param) => self.lost.push(&param.name.text),
            ItemKind::Continuation(continuation) => self.lost.push(&continuation.name.text),
            ItemKind::Table(table) => self.lost.push(&table.name.text),
            ItemKind::Variable(variables) => {
                self.lost.extend(variables.names.iter().map(|name| name.name.text.as_str()))
            }
            ItemKind::Output(outputs) => self.lost.extend(outputs.names.iter().map(|name| name.name.text.as_str())),
            ItemKind::Let(definition) => self.lost.push(&definition.name.text),
            _ => {}
        }
    }
}

/// Whether an item means something at a level.
fn allowed(kind: &ItemKind, level: Level) -> bool {
    match kind {
        ItemKind::Const(_)
        | ItemKind::Function(_)
        | ItemKind::Objective(_)
        | ItemKind::Collocation(_)
        | ItemKind::Guess(_) => true,
        ItemKind::Table(table) => !table.is_param || matches!(level, Level::Problem | Level::AboveAgents),
        ItemKind::Param(_) | ItemKind::Variable(_) | ItemKind::Continuation(_) | ItemKind::Domain(_) => {
            matches!(level, Level::Problem | Level::AboveAgents)
        }
        ItemKind::Scenario(_) | ItemKind::Shared(_) => matches!(level, Level::Problem | Level::Agent),
        ItemKind::Let(_) | ItemKind::Output(_) | ItemKind::Duration(_) | ItemKind::Periodic(_) | ItemKind::At(_) => {
            level != Level::AboveAgents
        }
        ItemKind::Block(block) => {
            level != Level::AboveAgents || matches!(block.place, ast::BlockPlace::Temporal | ast::BlockPlace::Measure)
        }
        ItemKind::Start(_) | ItemKind::Phase(_) => matches!(level, Level::Problem | Level::Agent),
        ItemKind::Agent(_) => level == Level::AboveAgents,
        ItemKind::Jump(_) | ItemKind::Continuous(_) => level == Level::Phase,
    }
}

/// The word that an item begins with.
fn keyword(kind: &ItemKind) -> &'static str {
    match kind {
        ItemKind::Const(_) => "const",
        ItemKind::Param(_) => "param",
        ItemKind::Variable(_) => "variable",
        ItemKind::Output(output) => match output.role {
            ast::Role::Output => "output",
            ast::Role::State => "state",
            ast::Role::Input => "input",
        },
        ItemKind::Function(_) => "fn",
        ItemKind::Let(_) => "let",
        ItemKind::Table(table) if table.is_param => "param",
        ItemKind::Table(_) => "table",
        ItemKind::Continuation(_) => "continuation",
        ItemKind::Domain(_) => "domain",
        ItemKind::Scenario(_) => "scenario",
        ItemKind::Shared(_) => "shared",
        ItemKind::Duration(_) => "duration",
        ItemKind::Start(_) => "start",
        ItemKind::Phase(_) => "phase",
        ItemKind::Agent(_) => "agent",
        ItemKind::Jump(_) => "jump",
        ItemKind::Continuous(_) => "continuous",
        ItemKind::Periodic(_) => "periodic",
        ItemKind::At(_) => "at",
        ItemKind::Collocation(_) => "collocation",
        ItemKind::Objective(objective) => match objective.sense {
            ast::Sense::Minimize => "minimize",
            ast::Sense::Maximize => "maximize",
        },
        ItemKind::Block(block) => match block.place {
            ast::BlockPlace::Initial => "initial",
            ast::BlockPlace::Trajectory => "trajectory",
            ast::BlockPlace::Final => "final",
            ast::BlockPlace::Temporal => "temporal",
            ast::BlockPlace::Dynamics => "dynamics",
            ast::BlockPlace::Measure => "measure",
        },
        ItemKind::Guess(_) => "guess",
    }
}
