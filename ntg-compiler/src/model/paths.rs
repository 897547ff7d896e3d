//! Paths to phases and agents, and the stretches of time that they or a scope mean.
//!
//! Takes `uav[2].strike` and the like, gives contexts and [`Stretch`]es.
//! Finds: paths that lead nowhere, members that are missing or outside a family.

use super::elaborator::Elaborator;
use super::problem::{Form, Loop};
use super::scope::{Context, Entity, PROBLEM, ScopeId, look_up};
use super::suggest::nearest;
use super::time::Stretch;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{Expr, Index, Path, Segment};

impl<'a> Elaborator<'a> {
    /// The context inside a path, `uav[2].strike`; what is wrong with it is told.
    pub(super) fn enter_path(&mut self, cx: &Context<'a>, segments: &'a [Segment]) -> Option<Context<'a>> {
        let mut inner: Option<Context<'a>> = None;
        let mut outer: Option<&'a Segment> = None;
        for segment in segments {
            let text = segment.name.text.as_str();
            let entity = match &inner {
                None => look_up(&self.scopes, cx.names(), text).map(|(_, declared)| declared.entity),
                Some(inner) => self.scopes[inner.scope].names.get(text).map(|declared| declared.entity),
            };
            let around = inner.unwrap_or_else(|| cx.clone());
            inner = Some(self.enter_segment(cx, around, entity, (outer, segment))?);
            outer = Some(segment);
        }
        inner
    }

    fn enter_segment(
        &mut self,
        cx: &Context<'a>,
        around: Context<'a>,
        entity: Option<Entity>,
        (outermost, segment): (Option<&'a Segment>, &'a Segment),
    ) -> Option<Context<'a>> {
        let (scope, family, agent) = match entity {
            Some(Entity::Phase(phase)) => {
                let family = self.problem.phases.get(phase)?.family.clone();
                (self.phases[phase].scope, family, false)
            }
            Some(Entity::Agent(agent)) => {
                let family = self.problem.agents.get(agent)?.family.clone();
                (self.agents[agent].scope, family, true)
            }
            other => {
                self.no_path(around.scope, other, segment, outermost);
                return None;
            }
        };
        let index = self.path_index(cx, family, segment)?;
        let mut inner = Context { scope, ..around };
        if agent {
            (inner.agent, inner.phase) = (index, None);
        } else {
            inner.phase = index;
        }
        Some(inner)
    }

    fn path_index(&mut self, cx: &Context<'a>, family: Option<Loop>, segment: &'a Segment) -> Option<Option<Form>> {
        let name = &segment.name.text;
        match (family, segment.indices.as_slice()) {
            (None, []) => Some(None),
            (Some(family), [index]) => {
                let index = self.one_index(index)?;
                let form = self.form(cx, index)?;
                if let (Some(first), Some(last)) = (family.first.as_number(), family.last.as_number())
                    && !self.check_index(cx, &form, (first, last), name, index.span)
                {
                    return None;
                }
                Some(Some(form))
            }
            (Some(_), indices) => {
                let message = match indices.len() {
                    0 => format!("`{name}` is a family: say which member"),
                    n => format!("`{name}` takes one index, not {n}"),
                };
                let finding = Diagnostic::new(Code::WrongIndices, segment.span, message);
                self.report(finding.help(format!("write `{name}[1]` or `{name}[i]`")));
                None
            }
            (None, _) => {
                let message = format!("`{name}` is no family");
                let finding = Diagnostic::new(Code::WrongIndices, segment.span, message);
                self.report(finding.help(format!("write `{name}` alone")));
                None
            }
        }
    }

    /// An index that names one member; told where it is a slice.
    pub(super) fn one_index(&mut self, index: &'a Index) -> Option<&'a Expr> {
        if index.last.is_some() {
            let message = format!("one member is meant here, `{}` are several", self.text(index.span));
            self.report(Diagnostic::new(Code::WrongIndices, index.span, message).help("write one index"));
            return None;
        }
        Some(&index.first)
    }

    /// Tells of a segment that is no phase or agent; `outer` is the segment before it.
    fn no_path(&mut self, scope: ScopeId, entity: Option<Entity>, segment: &Segment, outer: Option<&Segment>) {
        let name = &segment.name.text;
        let is_path = |entity: &Entity| matches!(entity, Entity::Phase(_) | Entity::Agent(_));
        let names = match outer {
            Some(_) => self.scopes[scope].order.iter().map(|n| (*n, self.scopes[scope].names[n].entity)).collect(),
            None => self.in_sight(scope),
        };
        let paths: Vec<&str> = names.iter().filter(|(_, entity)| is_path(entity)).map(|(name, _)| *name).collect();
        let message = match (entity, outer) {
            (Some(entity), _) => format!("`{name}` is {}, not a phase or agent", entity.describe()),
            (None, Some(outer)) => format!("there is no phase `{name}` in `{}`", outer.name.text),
            (None, None) => format!("unknown phase or agent `{name}`"),
        };
        let finding = Diagnostic::new(Code::UnknownPhase, segment.name.span, message);
        let of_array = entity.filter(|entity| !is_path(entity)).is_some();
        let after = self.source.text.get(segment.span.end as usize..).unwrap_or_default();
        if of_array && outer.is_none() && after.starts_with(".T") && !after[2..].starts_with(char::is_alphanumeric) {
            return self.report(finding.help(format!("the transpose is `transpose({name})`")));
        }
        let own = after.strip_prefix('.').map(|own| own.split(|c: char| !(c.is_alphanumeric() || c == '_')).next());
        if let (
            true,
            None,
            Some(Some("dot" | "ddot" | "d" | "dt" | "der" | "diff" | "deriv" | "derivative" | "prime")),
        ) = (of_array, outer, own)
        {
            let order = if own == Some(Some("ddot")) { ", 2" } else { "" };
            return self.report(finding.help(format!("the derivative is `der({name}{order})`")));
        }
        // The coordinates of a vector as a structure would have them.
        if let (true, None, Some(Some(letter @ ("x" | "y" | "z" | "w")))) = (of_array, outer, own) {
            let index = match letter {
                "x" => 1,
                "y" => 2,
                "z" => 3,
                _ => 4,
            };
            return self.report(finding.help(format!("an element of a vector is `{name}[{index}]`")));
        }
        let finding = match nearest(name, paths.iter().copied()) {
            Some(near) => finding.help(format!("did you mean `{near}`?")),
            None if paths.is_empty() => match outer {
                Some(outer) => finding.help(format!("`{0}` has no phases: write `{0}` alone", outer.name.text)),
                None if after.trim_start().trim_start_matches(',').trim_start().starts_with("t)") => {
                    finding.help(format!("an integral is over time without saying so: write `integral({name})`"))
                }
                None => finding.help("this problem has one phase: leave the name out"),
            },
            None => finding.help(format!("phases and agents are `{}`", paths.join("`, `"))),
        };
        self.report(finding);
    }

    /// The stretches that a path, or the scope that the text stands in, consists of, each with the
    /// scope in which names are resolved.
    pub(super) fn stretches_of(
        &mut self,
        cx: &Context<'a>,
        path: Option<&'a Path>,
        span: Span,
    ) -> Option<Vec<Stretch>> {
        let (scope, inner) = match path {
            Some(path) => {
                let inner = self.enter_path(cx, &path.segments)?;
                (inner.scope, inner)
            }
            None => (cx.lexical, cx.clone()),
        };
        let Some(agent) = self.scopes[scope].agent else {
            let names: Vec<&str> = self.scopes[PROBLEM].order.clone();
            let agents =
                names.iter().filter(|name| matches!(self.scopes[PROBLEM].names[*name].entity, Entity::Agent(_)));
            let agents: Vec<String> = agents.map(|name| format!("`{name}`")).collect();
            let message = "which agent is meant?";
            let help = format!("name it as the first argument; agents are {}", agents.join(", "));
            self.report(Diagnostic::new(Code::WhichAgent, span, message).help(help));
            return None;
        };
        match self.scopes[scope].phase {
            Some(phase) => Some(vec![Stretch { phase, agent: inner.agent, index: inner.phase }]),
            None => Some(self.stretches(agent, inner.agent)),
        }
    }
}
