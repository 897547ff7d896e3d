//! Durations, starts, phases, agents, how phases meet, and collocation.

use super::parts::Parts;
use super::{Build, Scope};
use crate::diagnostic::Code;
use crate::syntax::ast::{
    Agent, Collocation, CollocationKind, Continuous, Duration, Extent, IndependentVariable, Jump, Path, Periodic,
    Phase, Scenario, Segment, Shared,
};
use crate::syntax::grammar::{Pair, Rule};
use crate::syntax::words::nearest;

impl Build {
    /// `domain s [m];`
    pub(super) fn domain(&mut self, pair: Pair<'_>) -> IndependentVariable {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::domain_name));
        IndependentVariable { name, unit: parts.optional(Rule::unit).map(|pair| self.unit(pair)) }
    }

    pub(super) fn duration(&mut self, pair: Pair<'_>) -> Duration {
        let mut parts = Parts::of(pair);
        let name = parts.optional(Rule::name).map(|pair| self.name(&pair));
        Duration { name, extent: self.extent(parts.required(Rule::extent)) }
    }

    pub(super) fn start(&mut self, pair: Pair<'_>) -> Extent {
        self.extent(Parts::of(pair).required(Rule::extent))
    }

    fn extent(&mut self, pair: Pair<'_>) -> Extent {
        let inner = Parts::of(pair).any();
        match inner.as_rule() {
            Rule::bounds => Extent::Free(self.bounds(inner)),
            _ => Extent::Fixed(self.expression(inner)),
        }
    }

    pub(super) fn phase(&mut self, pair: Pair<'_>) -> Phase {
        let mut parts = Parts::of(pair);
        let mut head = Parts::of(parts.required(Rule::phase_head));
        let name = self.name(&head.required(Rule::name));
        let family = head.optional(Rule::family).map(|pair| self.family(pair));
        let after = head.optional(Rule::after).map(|pair| self.segment(Parts::of(pair).any()));
        Phase { name, family, after, items: self.items(Scope::Phase, parts) }
    }

    pub(super) fn agent(&mut self, pair: Pair<'_>) -> Agent {
        let mut parts = Parts::of(pair);
        let mut head = Parts::of(parts.required(Rule::agent_head));
        let name = self.name(&head.required(Rule::name));
        let family = head.optional(Rule::family).map(|pair| self.family(pair));
        Agent { name, family, items: self.items(Scope::Agent, parts) }
    }

    /// `scenario plant[k in 1 .. S] weight p[k] { items }`
    pub(super) fn scenario(&mut self, pair: Pair<'_>) -> Scenario {
        let mut parts = Parts::of(pair);
        let head = parts.required(Rule::scenario_head);
        let span = self.span(&head);
        let mut inner = Parts::of(head);
        let name = self.name(&inner.required(Rule::name));
        let family = self.family(inner.required(Rule::family));
        let weight = inner.optional(Rule::expression).map(|pair| self.expression(pair));
        Scenario { name, family, weight, items: self.items(Scope::Scenario, parts), head: span }
    }

    /// `shared u until 1 [s];`
    pub(super) fn shared(&mut self, pair: Pair<'_>) -> Shared {
        let mut parts = Parts::of(pair);
        let inputs = self.segments(&mut parts);
        Shared { inputs, until: parts.optional(Rule::expression).map(|pair| self.expression(pair)) }
    }

    pub(super) fn jump(&mut self, pair: Pair<'_>) -> Jump {
        Jump { outputs: self.paths(&mut Parts::of(pair)) }
    }

    pub(super) fn continuous(&mut self, pair: Pair<'_>) -> Continuous {
        let mut parts = Parts::of(pair);
        let outputs = self.paths(&mut parts);
        Continuous { outputs, up_to: self.expression(parts.required(Rule::expression)) }
    }

    pub(super) fn periodic(&mut self, pair: Pair<'_>) -> Periodic {
        let mut parts = Parts::of(pair);
        let outputs = self.segments(&mut parts);
        Periodic { outputs, up_to: parts.optional(Rule::expression).map(|pair| self.expression(pair)) }
    }

    fn paths(&mut self, parts: &mut Parts<'_>) -> Vec<Path> {
        let mut paths = vec![];
        while let Some(pair) = parts.optional(Rule::path) {
            paths.push(self.path(pair));
        }
        paths
    }

    fn segments(&mut self, parts: &mut Parts<'_>) -> Vec<Segment> {
        let mut segments = vec![];
        while let Some(pair) = parts.optional(Rule::segment) {
            segments.push(self.segment(pair));
        }
        segments
    }

    pub(super) fn collocation(&mut self, pair: Pair<'_>) -> Collocation {
        let mut parts = Parts::of(pair);
        let name = parts.required(Rule::name);
        let (owner, kind) = match name.as_str() {
            "gauss" => ("gauss", CollocationKind::Gauss),
            "uniform" => ("uniform", CollocationKind::Uniform),
            word => {
                let help = match nearest(word, ["gauss", "uniform"].into_iter()) {
                    Some(meant) => format!("did you mean `{meant}`?"),
                    None => "write `gauss(points = 5)` or `uniform(breakpoints = 41)`".into(),
                };
                let span = self.span(&name);
                self.report(Code::Setting, span, format!("`{word}` is no kind of collocation"), help);
                let kind = CollocationKind::Gauss;
                let (points, equalities, inequalities, intervals, knots) = (None, None, None, None, None);
                return Collocation { kind, points, equalities, inequalities, intervals, knots };
            }
        };
        let mut settings = self.settings(owner, parts.next());
        let mut points = settings.value(self, "points");
        let (mut equalities, mut inequalities) = (None, None);
        if kind == CollocationKind::Gauss {
            equalities = settings.value(self, "equalities");
            inequalities = settings.value(self, "inequalities");
        } else if let Some(breakpoints) = settings.value(self, "breakpoints") {
            if let Some(points) = &points {
                let message = "`points` and `breakpoints` are two words for the same";
                self.report(Code::Setting, points.span, message, "remove one of the two");
            }
            points = Some(breakpoints);
        }
        let intervals = settings.value(self, "intervals");
        let knots = settings.values(self, "knots");
        settings.finish(self);
        Collocation { kind, points, equalities, inequalities, intervals, knots }
    }
}
