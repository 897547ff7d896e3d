//! Puts the phases of each agent in order of time.
//!
//! Takes the `after` of the phase declarations, gives each its predecessor and sorts.
//! Finds: `after` of something that is no phase, circles, two phases after one.
//! Afterwards: `Elaborator::phases` holds each agent's phases in order of time, and so do the
//! agents' own lists. (Whether the index in `after leg[i - 1]` is right is `mission`'s affair.)

use super::elaborator::Elaborator;
use super::scope::Entity;
use super::suggest::nearest;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast;

impl<'a> Elaborator<'a> {
    /// The second step of the pass.
    pub(super) fn order_phases(&mut self) {
        for phase in 0..self.phases.len() {
            let after = self.phases[phase].item.and_then(|item| item.after.as_ref());
            self.phases[phase].after = after.and_then(|after| self.predecessor(phase, after));
        }
        let mut order = Vec::new();
        for agent in 0..self.agents.len() {
            let chain = self.chain(agent);
            order.extend(chain);
        }
        self.renumber(&order);
    }

    /// The phase that `after` names; a family after its own member before follows nothing else.
    fn predecessor(&mut self, phase: usize, after: &ast::Segment) -> Option<usize> {
        let outer = self.scopes[self.phases[phase].scope].parent?;
        match self.scopes[outer].names.get(after.name.text.as_str()).map(|declared| declared.entity) {
            Some(Entity::Phase(other)) if other == phase => {
                if self.phases[phase].item.is_some_and(|item| item.family.is_none()) {
                    self.circle(&[phase]);
                }
                None
            }
            Some(Entity::Phase(other)) => Some(other),
            other => {
                let name = &after.name.text;
                let message = match other {
                    Some(entity) => format!("`{name}` is {}, not a phase", entity.describe()),
                    None => format!("unknown phase `{name}`"),
                };
                let names = self.in_sight(outer);
                let phases = names.iter().filter(|(_, entity)| matches!(entity, Entity::Phase(_)));
                let near = nearest(name, phases.map(|(name, _)| *name));
                let mut finding = Diagnostic::new(Code::UnknownPhase, after.name.span, message);
                let phases: Vec<String> = names
                    .iter()
                    .filter(|(name, entity)| matches!(entity, Entity::Phase(_)) && *name != self.phase_name(phase))
                    .map(|(name, _)| format!("`{name}`"))
                    .collect();
                finding = match near {
                    Some(near) => finding.help(format!("did you mean `{near}`?")),
                    None if phases.is_empty() => finding.help("leave `after` out: there is no other phase here"),
                    None => finding.help(format!("the other phases here are {}", phases.join(", "))),
                };
                self.report(finding);
                None
            }
        }
    }

    /// The phases of an agent in order of time.
    fn chain(&mut self, agent: usize) -> Vec<usize> {
        let phases = self.agents[agent].phases.clone();
        let failed_before = self.has_failed();
        let mut chain: Vec<usize> = Vec::new();
        let mut last: Option<usize> = None;
        loop {
            let next: Vec<usize> = phases.iter().copied().filter(|p| self.phases[*p].after == last).collect();
            if let [first, second, ..] = next.as_slice()
                && !failed_before
            {
                self.fork(last, *first, *second);
            }
            let Some(first) = next.first().copied() else { break };
            chain.push(first);
            last = Some(first);
        }
        let rest: Vec<usize> = phases.iter().copied().filter(|p| !chain.contains(p)).collect();
        if !rest.is_empty() && !self.has_failed() {
            let circle = self.circle_in(rest[0]);
            self.circle(&circle);
        }
        chain.extend(rest);
        chain
    }

    /// The circle that one comes to by going back from a phase.
    fn circle_in(&self, from: usize) -> Vec<usize> {
        let mut seen = vec![from];
        while let Some(before) = self.phases[seen[seen.len() - 1]].after {
            if let Some(k) = seen.iter().position(|p| *p == before) {
                seen.drain(..k);
                break;
            }
            seen.push(before);
        }
        seen
    }

    fn phase_name(&self, phase: usize) -> &'a str {
        self.phases[phase].item.map_or("", |item| &item.name.text)
    }

    fn circle(&mut self, circle: &[usize]) {
        let mut names: Vec<String> = circle.iter().map(|p| format!("`{}`", self.phase_name(*p))).collect();
        names.push(names[0].clone());
        let span = self.phases[circle[0]].span;
        let message = "these phases follow one another in a circle";
        let mut finding = Diagnostic::new(Code::PhaseCircle, span, message).label(span, names.join(" after "));
        if let Some(after) = self.phases[circle[0]].item.and_then(|item| item.after.as_ref()) {
            finding = finding.label(after.span, "the circle goes through here");
        }
        self.report(finding.help("leave out `after` at the phase that comes first"));
    }

    fn fork(&mut self, before: Option<usize>, first: usize, second: usize) {
        let (a, b) = (self.phase_name(first), self.phase_name(second));
        let message = match before {
            Some(before) => format!("two phases follow `{}`", self.phase_name(before)),
            None => "two phases begin at the start".to_owned(),
        };
        // What follows a family follows its last member.
        let family = self.phases[first].item.and_then(|item| item.family.as_ref());
        let last = family.map_or(String::new(), |family| format!("[{}]", self.text(family.last.span)));
        let finding = Diagnostic::new(Code::PhaseFork, self.phases[second].span, message)
            .label(self.phases[second].span, format!("`{b}` does"))
            .label(self.phases[first].span, format!("and so does `{a}`"))
            .help(format!("write `phase {b} after {a}{last}`, or start another agent at that event"));
        self.report(finding);
    }

    /// Sorts the list of phases, and everything that addresses it.
    fn renumber(&mut self, order: &[usize]) {
        let mut place = vec![0; self.phases.len()];
        for (new, old) in order.iter().enumerate() {
            place[*old] = new;
        }
        let mut indexed: Vec<(usize, _)> = std::mem::take(&mut self.phases).into_iter().enumerate().collect();
        indexed.sort_by_key(|(old, _)| place[*old]);
        self.phases = indexed.into_iter().map(|(_, phase)| phase).collect();
        for phase in &mut self.phases {
            phase.after = phase.after.map(|old| place[old]);
        }
        for scope in &mut self.scopes {
            scope.phase = scope.phase.map(|old| place[old]);
            for name in &scope.order {
                if let Some(declared) = scope.names.get_mut(name)
                    && let Entity::Phase(old) = declared.entity
                {
                    declared.entity = Entity::Phase(place[old]);
                }
            }
        }
        for agent in &mut self.agents {
            for phase in &mut agent.phases {
                *phase = place[*phase];
            }
            agent.phases.sort_unstable();
        }
    }
}
