//! Times, paths to phases and agents, values at their ends, and integrals along them.
//!
//! Takes the expressions of docs/language.md, section 4, gives values.
//! Finds: paths that lead nowhere, integrals and event times where an expression belongs to one
//! point.
//! An expression that stands in an agent and names no path is about the whole agent: `integral`
//! adds up its phases, `initial` is at the start of the first, `final` at the end of the last.

use super::dimension::Dimension;
use super::elaborator::{Elaborator, EventMark};
use super::problem::{Form, Leaf, Loop, PhaseAt};
use super::scope::{Allow, Context, Point, ScopeId};
use super::value::{OpenIndex, Value, What};
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::{Fold, InputId, Map, NodeId};
use crate::source::Span;
use crate::syntax::ast::{Boundary, Event, Expr, Path};

/// A phase with the members that are meant.
#[derive(Clone)]
pub(super) struct Stretch {
    /// Which phase.
    pub(super) phase: usize,
    /// The member of its agent.
    pub(super) agent: Option<Form>,
    /// The member of the phase.
    pub(super) index: Option<Form>,
}

impl Stretch {
    /// As the model names it.
    pub(super) fn at(&self) -> PhaseAt {
        PhaseAt { phase: self.phase, agent: self.agent.clone(), index: self.index.clone() }
    }
}

impl<'a> Elaborator<'a> {
    /// `t`.
    pub(super) fn mission_time(&mut self, cx: &Context<'a>, span: Span) -> Value {
        let dimension = self.time;
        if cx.library.is_some() {
            let finding = Diagnostic::new(Code::TimeOutOfPlace, span, "a library knows no time of its own");
            return self.refuse(finding.help("make it an argument of the function"), span);
        }
        let phase = self.scopes[cx.scope].phase.map(|phase| cx.phase_at(phase));
        if let (Allow::All, Point::MissionAmong { index, .. }) = (cx.allow, cx.point) {
            return self.open(OpenIndex { index, cut: None, span }); // Each member has a time of its own.
        }
        let node = match (cx.allow, cx.point, phase) {
            (Allow::Guess, Point::Nowhere, None) => self.guessed_time(cx),
            (Allow::Guess, _, Some(phase)) => Some(self.leaf(Leaf::Time(phase))),
            (Allow::All, Point::Nowhere, _) => None,
            (Allow::All, _, Some(phase)) => Some(self.leaf(Leaf::Time(phase))), // Until `placed`.
            _ => None,
        };
        match node {
            Some(node) => Value::new(node, dimension, span),
            None => {
                let name = self.problem.independent.name.clone();
                self.misplaced_value(What::Time, span, &name, Some(dimension))
            }
        }
    }

    /// `t` in a guess over several phases: the start, and a part of the whole duration.
    fn guessed_time(&mut self, cx: &Context<'a>) -> Option<NodeId> {
        let agent = self.scopes[cx.scope].agent?;
        let first = self.stretches(agent, cx.agent.clone()).into_iter().next()?;
        let start = self.leaf(Leaf::Start(self.first_member(&first).at()));
        let whole = self.total_duration(agent, cx.agent.clone());
        let tau = self.leaf(Leaf::Tau);
        let gone = self.problem.dag.mul(tau, whole);
        Some(self.problem.dag.add(start, gone))
    }

    /// `tau`.
    pub(super) fn scaled_time(&mut self, cx: &Context<'a>, span: Span) -> Value {
        let node = match (cx.allow, cx.point) {
            (Allow::All, Point::MissionAmong { index, .. }) => {
                return self.open(OpenIndex { index, cut: None, span });
            }
            (Allow::Guess, _) => self.leaf(Leaf::Tau),
            (Allow::All, point) if point != Point::Nowhere => self.leaf(Leaf::Tau), // Until `placed`.
            _ => return self.misplaced_value(What::ScaledTime, span, "tau", Some(Dimension::NONE)),
        };
        Value::new(node, Dimension::NONE, span)
    }

    /// A whole expression of a place, with the place's own time and scaled time for those that vary. Not before: what
    /// `der` is applied to varies there too.
    pub(super) fn placed(&mut self, cx: &Context<'a>, value: Value) -> Value {
        let (tau, is_of_mission) = match cx.point {
            Point::Start => (0.0, false),
            Point::End => (1.0, false),
            Point::MissionStart => (0.0, true),
            Point::MissionEnd => (1.0, true),
            Point::MissionInside(instant) => (instant.tau(), true),
            Point::Nowhere | Point::Path | Point::MissionAmong { .. } => return value,
        };
        if cx.allow != Allow::All || !value.is_sound() {
            return value;
        }
        let mut places: Map<InputId, NodeId> = Map::default(); // Looked up, never iterated.
        for input in self.problem.dag.inputs_of(&[value.node]) {
            let place = match self.problem.leaves.leaf(input).clone() {
                Leaf::Tau => self.problem.dag.constant(tau),
                Leaf::Time(phase) if is_of_mission => self.time_of(phase, tau),
                _ => continue,
            };
            places.insert(input, place);
        }
        let [node] = self.problem.dag.substitute(&[value.node], |input| places.get(&input).copied())[..] else {
            return value;
        };
        Value { node, ..value }
    }

    /// The time at a part of a phase.
    fn time_of(&mut self, phase: PhaseAt, tau: f64) -> NodeId {
        let start = self.leaf(Leaf::Start(phase.clone()));
        if tau == 0.0 {
            return start;
        }
        let duration = self.leaf(Leaf::Duration(phase));
        let dag = &mut self.problem.dag;
        let part = dag.constant(tau);
        let gone = dag.mul(part, duration);
        dag.add(start, gone)
    }

    /// The phases of an agent; a family of phases is one stretch, its member left open.
    pub(super) fn stretches(&self, agent: usize, member: Option<Form>) -> Vec<Stretch> {
        let stretch = |phase: &usize| Stretch { phase: *phase, agent: member.clone(), index: None };
        self.agents[agent].phases.iter().map(stretch).collect()
    }

    /// The first member of a stretch that is a family, else the stretch itself.
    pub(super) fn first_member(&self, stretch: &Stretch) -> Stretch {
        let family = self.problem.phases[stretch.phase].family.as_ref();
        Stretch { index: family.map(|over| over.first.clone()), ..stretch.clone() }
    }

    /// The last member of a stretch that is a family, else the stretch itself.
    pub(super) fn last_member(&self, stretch: &Stretch) -> Stretch {
        let family = self.problem.phases[stretch.phase].family.as_ref();
        Stretch { index: family.map(|over| over.last.clone()), ..stretch.clone() }
    }

    /// The sum of a function of each stretch of an agent, members of families included.
    fn total(&mut self, stretches: &[Stretch], mut part: impl FnMut(&mut Self, &Stretch) -> NodeId) -> NodeId {
        let mut parts = Vec::new();
        for stretch in stretches {
            let node = match self.problem.phases[stretch.phase].family.clone() {
                Some(family) if stretch.index.is_none() => {
                    let (over, range) = self.total_index(stretch.phase, &family);
                    let member = Stretch { index: Some(Form::index(over.index)), ..stretch.clone() };
                    let body = part(self, &member);
                    self.problem.dag.reduce(Fold::Sum, over.index.0, range, body)
                }
                _ => part(self, stretch),
            };
            parts.push(node);
        }
        self.problem.dag.sum(&parts)
    }

    /// The index that totals over a family of phases use: one for all, since they do not nest.
    fn total_index(&mut self, phase: usize, family: &Loop) -> (Loop, u32) {
        if let Some(range) = self.total_indices.get(&phase) {
            return (self.problem.ranges[*range as usize].clone(), *range);
        }
        let over = self.new_index(family.first.clone(), family.last.clone());
        let range = self.new_range(&over);
        self.total_indices.insert(phase, range);
        (over, range)
    }

    /// The number of a new range of a reduction.
    pub(super) fn new_range(&mut self, over: &Loop) -> u32 {
        self.problem.ranges.push(over.clone());
        u32::try_from(self.problem.ranges.len() - 1).expect("fewer than 2^32 ranges fit in memory")
    }

    /// The duration of all phases of an agent.
    pub(super) fn total_duration(&mut self, agent: usize, member: Option<Form>) -> NodeId {
        let stretches = self.stretches(agent, member);
        self.total(&stretches, |this, stretch| this.leaf(Leaf::Duration(stretch.at())))
    }

    /// The name of a duration.
    pub(super) fn named_duration(&mut self, cx: &Context<'a>, scope: ScopeId, name: &str, span: Span) -> Value {
        if cx.allow < Allow::Guess {
            return self.misplaced_value(What::Mission, span, name, Some(self.time));
        }
        let Some(agent) = self.scopes[scope].agent else { return self.poison(span) };
        let node = match self.scopes[scope].phase {
            Some(phase) => self.leaf(Leaf::Duration(cx.phase_at(phase))),
            None => self.total_duration(agent, cx.agent.clone()),
        };
        Value::new(node, self.time, span)
    }

    /// The context of an expression that is taken along, or at an end of, a stretch.
    pub(super) fn on(&self, cx: &Context<'a>, stretch: &Stretch, point: Point) -> Context<'a> {
        Context {
            scope: self.phases[stretch.phase].scope,
            agent: stretch.agent.clone(),
            phase: stretch.index.clone(),
            point,
            ..cx.clone()
        }
    }

    /// `integral(e)`, `integral(path, e)`.
    pub(super) fn integral(
        &mut self,
        cx: &Context<'a>,
        path: Option<&'a Path>,
        (of, at): (&'a Expr, &[Form]),
        span: Span,
    ) -> Value {
        if cx.allow < Allow::All {
            let text = self.text(span);
            return self.misplaced_value(What::Mission, span, &text, None);
        }
        let Some(stretches) = self.stretches_of(cx, path, span) else { return self.poison(span) };
        let outer_event = self.event.take();
        let mut sample: Option<Value> = None;
        let node = self.total(&stretches, |this, stretch| {
            let inner = this.on(cx, stretch, Point::Path);
            let value = this.element_or_zero(&inner, of, at);
            this.no_event(of.span, "the integrand is taken at every point");
            let node = this.leaf(Leaf::Integral { phase: stretch.at(), integrand: value.node });
            sample = match sample.take() {
                Some(first) => Some(this.alike("add", first, &value, value.node)),
                None => Some(value),
            };
            node
        });
        self.event = outer_event;
        self.mark_event(span, self.text(span), false);
        let Some(sample) = sample else { return self.poison(span) };
        let time = self.time;
        let dimension = sample.dimension.map(|d| d.times(&time));
        sample.map(node, dimension, span)
    }

    /// `initial(e)`, `final(path, e)`.
    pub(super) fn boundary(
        &mut self,
        cx: &Context<'a>,
        boundary: Boundary,
        path: Option<&'a Path>,
        (of, at): (&'a Expr, &[Form]),
        span: Span,
    ) -> Value {
        if cx.allow < Allow::All {
            let text = self.text(span);
            return self.misplaced_value(What::Mission, span, &text, None);
        }
        let Some(stretches) = self.stretches_of(cx, path, span) else { return self.poison(span) };
        let open = |s: &Stretch| s.index.is_none();
        let (stretch, point) = match (boundary, stretches.as_slice()) {
            (Boundary::Initial, [first, ..]) => {
                (if open(first) { self.first_member(first) } else { first.clone() }, Point::MissionStart)
            }
            (Boundary::Final, [.., last]) => {
                (if open(last) { self.last_member(last) } else { last.clone() }, Point::MissionEnd)
            }
            (_, []) => return self.poison(span),
        };
        let inner = self.on(cx, &stretch, point);
        let value = self.element_or_zero(&inner, of, at);
        let value = self.placed(&inner, value);
        self.mark_event(span, self.text(span), false);
        value.map(value.node, value.dimension, span).shown_in(value.unit.clone())
    }

    /// `start(path)`, `end(path)`, `duration(path)`.
    pub(super) fn event_time(&mut self, cx: &Context<'a>, event: Event, path: &'a Path, span: Span) -> Value {
        let text = self.text(span);
        if cx.allow < Allow::Guess {
            return self.misplaced_value(What::Mission, span, &text, Some(self.time));
        }
        let Some(stretches) = self.stretches_of(cx, Some(path), span) else { return self.poison(span) };
        let (Some(first), Some(last)) = (stretches.first(), stretches.last()) else { return self.poison(span) };
        let node = match event {
            Event::Start => {
                let first = if first.index.is_none() { self.first_member(first) } else { first.clone() };
                self.leaf(Leaf::Start(first.at()))
            }
            Event::End => {
                let last = if last.index.is_none() { self.last_member(last) } else { last.clone() };
                let start = self.leaf(Leaf::Start(last.at()));
                let duration = self.leaf(Leaf::Duration(last.at()));
                self.problem.dag.add(start, duration)
            }
            Event::Duration => self.total(&stretches, |this, stretch| this.leaf(Leaf::Duration(stretch.at()))),
        };
        self.mark_event(span, text, true);
        Value::new(node, self.time, span)
    }

    /// Tells of an event time, boundary value or integral where an expression belongs to a point.
    pub(super) fn no_event(&mut self, around: Span, why: &str) {
        let Some(EventMark { span, text, is_time }) = self.event.take() else { return };
        let message = format!("`{text}` belongs to no single point, but {why}");
        let mut finding = Diagnostic::new(Code::EventAlong, span, message);
        if span != around {
            finding = finding.label(around, "this is taken at every point");
        }
        let help = if is_time {
            format!("give the time a name, `let event = {text};`, and use the name here")
        } else {
            let rest = self.text(around).strip_prefix(&text).map(|rest| rest.trim_start().to_owned());
            let is_limited = rest.is_some_and(|rest| ["<=", ">=", "==", "in "].iter().any(|op| rest.starts_with(op)));
            let alone = "where nothing else in it changes along the way, it belongs in `temporal { }`; else ";
            let alone = if is_limited { alone } else { "" };
            format!("{alone}declare `variable v;`, write `v == {text};` in `temporal`, and use `v` here")
        };
        self.report(finding.help(help));
    }
}
