//! Agents and phases with their families, durations and discretisation.
//!
//! Takes the declarations, fills `Problem::agents` and `Problem::phases`; outputs come from
//! `outputs.rs`.
//! Finds: families without members, phases without a duration or with two, durations that are not
//! positive, numbers of points that make no rule.
//! Afterwards: every phase has a duration, and names and paths can be given a meaning.

use super::elaborator::Elaborator;
use super::problem::{Agent, Bounds, Collocation, Constraint, Domain, Duration, Form, Imposed, Loop, Phase, Start};
use super::scope::{Allow, Context, PROBLEM, Point, ScopeId};
use super::settle::Use;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::source::Span;
use crate::syntax::ast::{self, CollocationKind, Extent, ItemKind};

/// The discretisation of a spec that does not choose one.
const DEFAULT: Collocation = Collocation::Gauss { points: 5, equalities: 5, ends: true };

/// The most points in an interval, or along a phase: beyond it, nothing could be solved any more.
const MAX_POINTS: i64 = 1_000_000;

/// The most Gauss points in one interval.
const MAX_GAUSS: i64 = 64;

impl<'a> Elaborator<'a> {
    /// Makes agents and phases with their families; durations follow when outputs are known.
    pub(super) fn skeleton(&mut self) {
        for k in 0..self.agents.len() {
            let item = self.agents[k].item;
            let family = item.and_then(|item| item.family.as_ref()).and_then(|family| self.family(PROBLEM, family));
            let scope = self.agents[k].scope;
            let span = item.map_or(Span::default(), |item| item.name.span);
            // An agent without phases has one, and a duration's name is then that phase's.
            let has_phases = self.agents[k].phases.iter().any(|phase| self.phases[*phase].item.is_some());
            let duration_name = self.duration_name(scope).filter(|_| has_phases);
            self.problem.agents.push(Agent {
                name: item.map(|item| item.name.text.clone()),
                family,
                start: Start::Fixed(None),
                duration_name,
                phases: self.agents[k].phases.clone(),
                span,
            });
        }
        for k in 0..self.phases.len() {
            let (item, agent, scope) = (self.phases[k].item, self.phases[k].agent, self.phases[k].scope);
            let outer = self.agents[agent].scope;
            let family = item.and_then(|item| item.family.as_ref()).and_then(|family| self.family(outer, family));
            let zero = self.problem.dag.constant(0.0);
            let collocation = self.collocation(scope);
            self.problem.phases.push(Phase {
                name: item.map(|item| item.name.text.clone()),
                agent,
                family,
                after: self.phases[k].after,
                duration: Duration::Fixed(zero),
                duration_name: self.duration_name(scope),
                outputs: Vec::new(),
                collocation,
                span: self.phases[k].span,
            });
            self.check_after(k);
        }
    }

    /// A family of agents or phases: its ends are constants.
    fn family(&mut self, scope: ScopeId, range: &'a ast::IndexRange) -> Option<Loop> {
        let cx = Context::of(scope, Allow::Constants);
        let first = self.whole(&cx, &range.first, "the first index of a family");
        let last = self.whole(&cx, &range.last, "the last index of a family");
        let (first, last) = (first?, last?);
        if last < first {
            let message = "a family of phases or agents has one member at least";
            let finding = Diagnostic::new(Code::EmptyFamily, range.span, message);
            self.report(finding.help(format!("write `{} in 1 .. N` with `N` at least 1", range.index.text)));
        }
        // Go on as if there was one, so that its index means something.
        let last = last.max(first);
        Some(self.new_index(Form::number(first), Form::number(last)))
    }

    /// Tells when the index in `after leg[i - 1]` means something that is not supported.
    fn check_after(&mut self, k: usize) {
        let Some(item) = self.phases[k].item else { return };
        let Some(after) = &item.after else { return };
        let own = after.name.text == item.name.text;
        let wanted = match (own, &item.family, self.phases[k].after) {
            (true, Some(range), _) => format!("{}[{} - 1]", item.name.text, range.index.text),
            (false, _, Some(before)) => match self.problem.phases.get(before).and_then(|p| p.family.clone()) {
                Some(family) => format!("{}[{}]", after.name.text, family.last.constant),
                None => after.name.text.clone(),
            },
            _ => return,
        };
        let written: String = self.source.slice(after.span).split_whitespace().collect();
        let same = written == wanted.replace(' ', "");
        let cx = self.phase_context(k, Allow::Constants, Point::Nowhere);
        let cx = Context { scope: self.phases[k].scope, ..cx };
        let index = match after.indices.as_slice() {
            [index] if !same => self.form(&cx, &index.first),
            _ => None,
        };
        let means = match (own, &index, self.problem.phases[k].family.clone()) {
            (true, Some(form), Some(family)) => form.constant == -1 && form.terms == [(family.index, 1)],
            (false, Some(form), _) => self.phases[k].after.is_some_and(|before| {
                // In a circle of phases the one before is not known yet.
                let family = self.problem.phases.get(before).and_then(|phase| phase.family.as_ref());
                family.is_some_and(|family| form.as_number() == Some(family.last.constant))
            }),
            _ => false,
        };
        if !same && !means && !self.has_failed() {
            let message = format!("a phase cannot follow `{}` here", self.text(after.span));
            let finding = Diagnostic::new(Code::WrongAfter, after.span, message);
            self.report(finding.help(format!("write `after {wanted}`")));
        }
    }

    fn duration_name(&self, scope: ScopeId) -> Option<String> {
        self.items[scope].iter().find_map(|item| match &item.kind {
            ItemKind::Duration(duration) => duration.name.as_ref().map(|name| name.text.clone()),
            _ => None,
        })
    }

    /// A context of an agent as a whole.
    pub(super) fn agent_context(&self, agent: usize, allow: Allow) -> Context<'a> {
        let cx = Context::of(self.agents[agent].scope, allow);
        match self.problem.agents.get(agent).and_then(|agent| agent.family.clone()) {
            Some(over) => Context { agent: Some(Form::index(over.index)), ..cx.inside(over) },
            None => cx,
        }
    }

    /// A context of a scope for the first members of its families: what is alike in all of them.
    pub(super) fn first_members(&self, scope: ScopeId, allow: Allow) -> Context<'a> {
        let first = |family: Option<&Loop>| family.map(|over| over.first.clone());
        let (agent, phase) = (self.scopes[scope].agent, self.scopes[scope].phase);
        Context {
            agent: first(agent.and_then(|k| self.problem.agents.get(k)).and_then(|agent| agent.family.as_ref())),
            phase: first(phase.and_then(|k| self.problem.phases.get(k)).and_then(|phase| phase.family.as_ref())),
            ..Context::of(scope, allow)
        }
    }

    /// A context of a phase.
    pub(super) fn phase_context(&self, phase: usize, allow: Allow, point: Point) -> Context<'a> {
        let outer = self.agent_context(self.phases[phase].agent, allow);
        let cx = Context { scope: self.phases[phase].scope, lexical: self.phases[phase].scope, point, ..outer };
        match self.problem.phases.get(phase).and_then(|phase| phase.family.clone()) {
            Some(over) => Context { phase: Some(Form::index(over.index)), ..cx.inside(over) },
            None => cx,
        }
    }

    /// The discretisation that holds in a scope: its own, or that of the scope around it.
    fn collocation(&mut self, scope: ScopeId) -> Collocation {
        let mut next = Some(scope);
        while let Some(id) = next {
            let mut found = self.items[id].iter().filter_map(|item| match &item.kind {
                ItemKind::Collocation(collocation) => Some((collocation, item.span)),
                _ => None,
            });
            let (first, second) = (found.next(), found.next());
            if let Some((_, again)) = second {
                let finding = Diagnostic::new(Code::DeclaredTwice, again, "`collocation` is chosen twice");
                self.report(finding.help("remove one of them"));
            }
            if let Some((collocation, span)) = first {
                return self.points(id, collocation, span).unwrap_or(DEFAULT);
            }
            next = self.scopes[id].parent;
        }
        DEFAULT
    }

    fn points(&mut self, scope: ScopeId, collocation: &'a ast::Collocation, span: Span) -> Option<Collocation> {
        let cx = Context::of(scope, Allow::Constants);
        let mut number = |expr: &'a Option<ast::Expr>, least: i64, most: i64| -> Option<Option<usize>> {
            let Some(expr) = expr else { return Some(None) };
            let value = self.whole(&cx, expr, "a number of points")?;
            if (least..=most).contains(&value) {
                return Some(usize::try_from(value).ok());
            }
            let message = format!("a number of points from {least} to {most} is needed here, not {value}");
            let finding = Diagnostic::new(Code::WrongPoints, expr.span, message);
            self.report(finding.help("write another number of points"));
            None
        };
        match collocation.kind {
            CollocationKind::Gauss => {
                let points = number(&collocation.points, 1, MAX_GAUSS)?;
                let equalities = number(&collocation.equalities, 1, MAX_GAUSS)?;
                let points = points.unwrap_or(5);
                let ends = !self.at_points_only(collocation)?;
                Some(Collocation::Gauss { points, equalities: equalities.unwrap_or(points), ends })
            }
            CollocationKind::Uniform => match number(&collocation.points, 2, MAX_POINTS)? {
                Some(points) => Some(Collocation::Uniform { points }),
                None => {
                    let finding = Diagnostic::new(Code::WrongPoints, span, "how many breakpoints?");
                    self.report(finding.help("write `collocation uniform(breakpoints = 41);`"));
                    None
                }
            },
        }
    }

    /// Whether `inequalities = points` is written.
    fn at_points_only(&mut self, collocation: &'a ast::Collocation) -> Option<bool> {
        let Some(expr) = &collocation.inequalities else { return Some(false) };
        let word = self.text(expr.span);
        if word == "points" || word == "ends" {
            return Some(word == "points");
        }
        let message = format!("inequalities do not hold at `{word}`");
        let help =
            "write `inequalities = points` to leave the ends of intervals out; `inequalities = ends` is the rule";
        self.report(Diagnostic::new(Code::WrongPoints, expr.span, message).help(help));
        None
    }

    /// Durations of all phases, starts and total durations of all agents.
    pub(super) fn durations(&mut self) {
        for phase in 0..self.phases.len() {
            let cx = self.phase_context(phase, Allow::Parameters, Point::Nowhere);
            let scope = self.phases[phase].scope;
            match self.own_duration(scope) {
                Some((duration, span)) => {
                    let duration = self.duration(&cx, &duration.extent, "a duration", span);
                    self.problem.phases[phase].duration = duration;
                }
                None => {
                    let span = self.phases[phase].span;
                    let message = match self.phases[phase].item {
                        Some(item) => format!("the phase `{}` has no duration", item.name.text),
                        None => "how long does this take? There is no duration".to_owned(),
                    };
                    let finding = Diagnostic::new(Code::WrongDuration, span, message);
                    self.report(
                        finding.help("write `duration T = 5;` for a fixed one, `duration T in 1 .. 9;` for a free one"),
                    );
                }
            }
        }
        for agent in 0..self.agents.len() {
            self.agent_times(agent);
        }
    }

    /// The duration that stands in a scope; tells of a second one.
    pub(super) fn own_duration(&mut self, scope: ScopeId) -> Option<(&'a ast::Duration, Span)> {
        let mut found = self.items[scope].iter().filter_map(|item| match &item.kind {
            ItemKind::Duration(duration) => Some((duration, item.span)),
            _ => None,
        });
        let (first, second) = (found.next(), found.next());
        let name = |duration: &ast::Duration| duration.name.as_ref().map(|name| name.text.clone());
        // Of two with one name it is told already that it is declared twice.
        let is_told = |one: &ast::Duration, other: &ast::Duration| name(one).is_some() && name(one) == name(other);
        if let (Some((one, span)), Some((other, again))) = (first, second)
            && !is_told(one, other)
        {
            self.report(
                Diagnostic::new(Code::WrongDuration, again, "a second duration in one place")
                    .label(again, "the second")
                    .label(span, "the first")
                    .help("remove one of them"),
            );
        }
        first
    }

    fn duration(&mut self, cx: &Context<'a>, extent: &'a Extent, what: &str, span: Span) -> Duration {
        let none = self.problem.dag.constant(1.0);
        match extent {
            Extent::Fixed(expr) => {
                let [time] = self.of_each_member(cx, &mut |this, cx| {
                    let Some(value) = this.bound(cx, expr, what).and_then(|value| this.as_time(value, what)) else {
                        return [None];
                    };
                    this.note_clock(&value);
                    this.positive(value.node, expr.span);
                    [Some(value.node)]
                });
                Duration::Fixed(time.unwrap_or(none))
            }
            Extent::Free(bounds) => {
                let [lower, upper] = self.of_each_member(cx, &mut |this, cx| {
                    let (nodes, joined) = this.bounds(cx, bounds, what);
                    if let Some(time) = joined.and_then(|joined| this.as_time(joined.at(bounds.span), what)) {
                        this.note_clock(&time);
                        this.no_negative_time(nodes.lower, nodes.upper, bounds);
                    }
                    if let Some(upper) = nodes.upper {
                        this.positive(upper, bounds.upper.as_ref().map_or(span, |e| e.span));
                    }
                    [nodes.lower, nodes.upper]
                });
                Duration::Free(Bounds { lower, upper })
            }
        }
    }

    /// Tells when a value is no time.
    pub(super) fn as_time(&mut self, value: Value, what: &str) -> Option<Value> {
        let Some(dimension) = value.dimension.filter(|d| *d != self.time) else { return Some(value) };
        if !value.is_sound() {
            return None;
        }
        let (kind, unit, domain) = self.kind_of_time();
        let message = match domain {
            Some(domain) => format!("{what} is {kind} here, as `{domain}` says, but this is {}", dimension.describe()),
            None => format!("{what} is {kind}, but this is {}", dimension.describe()),
        };
        let text = self.text(value.span);
        let help = match text.parse::<f64>() {
            Ok(_) if !unit.is_empty() => format!("give it a unit: `{text} [{unit}]`"),
            _ if unit.is_empty() => "write a number without a unit, such as `5`".to_owned(),
            _ => format!("write {}, such as `5 [{unit}]`", kind.split(" [").next().unwrap_or_default()),
        };
        self.report(Diagnostic::new(Code::WrongUnit, value.span, message).help(help));
        None
    }

    /// Tells of a lower bound below 0, where the upper one has not been told of.
    fn no_negative_time(&mut self, lower: Option<NodeId>, upper: Option<NodeId>, bounds: &ast::Bounds) {
        let is = |node: Option<NodeId>, told: fn(f64) -> bool| {
            node.and_then(|node| self.problem.dag.is_constant(node)).is_some_and(told)
        };
        let Some(written) = bounds.lower.as_ref().filter(|_| is(lower, |value| value < 0.0)) else { return };
        if !is(upper, |value| value <= 0.0) {
            let finding = Diagnostic::new(Code::WrongDuration, written.span, "a duration is greater than 0");
            self.report(finding.help("write the shortest that is meant, or leave this bound out"));
        }
    }

    /// Tells of a duration that is known not to be positive.
    pub(super) fn positive(&mut self, node: NodeId, span: Span) {
        if self.problem.dag.is_constant(node).is_some_and(|value| value <= 0.0) {
            let finding = Diagnostic::new(Code::WrongDuration, span, "a duration is greater than 0");
            self.report(finding.help("write a positive time"));
        }
    }

    /// Start of an agent, and the bounds on the sum of its phases' durations.
    fn agent_times(&mut self, agent: usize) {
        let cx = self.agent_context(agent, Allow::Parameters);
        let scope = self.agents[agent].scope;
        let starts: Vec<(&'a Extent, Span)> = self.items[scope]
            .iter()
            .filter_map(|item| match &item.kind {
                ItemKind::Start(extent) => Some((extent, item.span)),
                _ => None,
            })
            .collect();
        if let [_, (_, again), ..] = starts.as_slice() {
            self.report(
                Diagnostic::new(Code::WrongDuration, *again, "a second start in one place").help("remove one of them"),
            );
        }
        if let Some((extent, _)) = starts.first() {
            self.problem.agents[agent].start = self.start(&cx, extent);
        }
        if self.scopes[scope].phase.is_none()
            && let Some((duration, span)) = self.own_duration(scope)
        {
            self.total_bounds(agent, &cx, duration, span);
        }
    }

    fn start(&mut self, cx: &Context<'a>, extent: &'a Extent) -> Start {
        match extent {
            Extent::Fixed(expr) => {
                let [time] = self.of_each_member(cx, &mut |this, cx| {
                    let value = this.bound(cx, expr, "a start time");
                    [value.and_then(|value| this.as_time(value, "a start time")).map(|value| value.node)]
                });
                Start::Fixed(time)
            }
            Extent::Free(bounds) => {
                let [lower, upper] = self.of_each_member(cx, &mut |this, cx| {
                    let (nodes, joined) = this.bounds(cx, bounds, "a start time");
                    if let Some(joined) = joined {
                        this.as_time(joined.at(bounds.span), "a start time");
                    }
                    [nodes.lower, nodes.upper]
                });
                Start::Free(Bounds { lower, upper })
            }
        }
    }

    /// `duration T in a .. b;` beside phases bounds their sum.
    fn total_bounds(&mut self, agent: usize, cx: &Context<'a>, duration: &'a ast::Duration, span: Span) {
        let bounds = match self.duration(cx, &duration.extent, "a duration", span) {
            Duration::Fixed(node) => Bounds { lower: Some(node), upper: Some(node) },
            Duration::Free(bounds) => bounds,
        };
        if bounds == Bounds::default() {
            return;
        }
        let body = self.total_duration(agent, cx.agent.clone());
        self.origin(body, span);
        let name = duration.name.as_ref().map(|name| self.path_name(agent, None, &name.text));
        self.problem.constraints.push(Constraint {
            name,
            span,
            block: ntg_structure::Block::Temporal,
            unit: self.time_unit(),
            loops: (*cx.loops).clone(),
            sides: 0,
            written: None,
            domain: Domain::Mission,
            imposed: Imposed::Everywhere,
            body,
            bounds,
        });
    }

    /// The unit in which times are shown where none is declared.
    pub(super) fn time_unit(&self) -> ntg_structure::Unit {
        if self.domain.is_some() {
            return self.problem.independent.unit.clone();
        }
        super::units::si(&self.time)
    }

    /// A name with the path of its agent and phase.
    pub(super) fn path_name(&self, agent: usize, phase: Option<usize>, name: &str) -> String {
        let agent = self.agents[agent].item.map(|item| item.name.text.as_str());
        let phase = phase.and_then(|phase| self.phases[phase].item).map(|item| item.name.text.as_str());
        agent.into_iter().chain(phase).chain([name]).collect::<Vec<_>>().join(".")
    }

    /// What an expression is worth that must be usable at a place.
    pub(super) fn usable(&mut self, cx: &Context<'a>, expr: &'a ast::Expr, place: Use<'_>) -> Option<Value> {
        if !self.is_number(cx, expr) {
            return None;
        }
        let value = self.value(cx, expr);
        self.settle(value, place)
    }

    /// The same for an element of an expression, or for a number that stands for every element.
    pub(super) fn usable_side(
        &mut self,
        cx: &Context<'a>,
        expr: &'a ast::Expr,
        at: &[Form],
        place: Use<'_>,
    ) -> Option<Value> {
        let spread = at.is_empty() || self.shape(cx, expr)?.is_number();
        let value = self.element(cx, expr, if spread { &[] } else { at });
        let value = self.placed(cx, value);
        self.settle(value, place)
    }
}
