//! The guess: values, routes, loops around them.

use super::Build;
use super::lists::{List, give_units, own_unit};
use super::parts::Parts;
use crate::diagnostic::Code;
use crate::syntax::ast::{Assign, Event, Guess, GuessKind, Path, Point, Route, Statement, Target};
use crate::syntax::grammar::{Pair, Rule};

impl Build {
    pub(super) fn guess(&mut self, pair: Pair<'_>) -> Guess {
        let mut parts = Parts::of(pair);
        parts.required(Rule::guess_head);
        Guess { statements: parts.map(|pair| self.guess_statement(pair)).collect() }
    }

    pub(in crate::syntax) fn guess_statement(&mut self, pair: Pair<'_>) -> Statement<GuessKind> {
        let inner = Parts::of(pair).any();
        match inner.as_rule() {
            Rule::guess_repeated => Statement::For(self.repeated(inner, Self::guess_statement)),
            Rule::route => Statement::One(GuessKind::Route(self.route(inner))),
            _ => Statement::One(GuessKind::Assign(self.assign(inner))),
        }
    }

    fn assign(&mut self, pair: Pair<'_>) -> Assign {
        let mut parts = Parts::of(pair);
        let target = match parts.optional(Rule::event) {
            Some(pair) => self.event(pair),
            None => Target::Path(self.path(parts.required(Rule::path))),
        };
        let value = self.expression(parts.required(Rule::expression));
        let start = match &target {
            Target::Path(path) => path.span,
            Target::Event { span, .. } => *span,
        };
        let span = start.to(value.span);
        Assign { target, value, span }
    }

    fn event(&mut self, pair: Pair<'_>) -> Target {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let event = match parts.required(Rule::event_word).as_str() {
            "start" => Event::Start,
            "end" => Event::End,
            _ => Event::Duration,
        };
        Target::Event { event, path: parts.optional(Rule::path).map(|pair| self.path(pair)), span }
    }

    fn route(&mut self, pair: Pair<'_>) -> Route {
        let mut span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let mut outputs: Vec<Path> = vec![];
        while let Some(pair) = parts.optional(Rule::path) {
            outputs.push(self.path(pair));
        }
        let mut lists: Vec<List> = parts.map(|pair| self.list(pair)).collect();
        share_route_unit(&mut lists);
        for list in &lists {
            self.unused_unit(list);
        }
        if let Some(last) = lists.last() {
            span.end = last.span.end; // Without the semicolon.
        }
        let points: Vec<Point> =
            lists.into_iter().map(|list| Point { coordinates: list.elements, span: list.span }).collect();
        // One output may be a vector, whose elements are then the coordinates.
        let several = outputs.len() > 1;
        let is_wrong = |point: &&Point| several && point.coordinates.len() != outputs.len();
        // Points of one kind of wrong are one mistake.
        let mut told = vec![];
        for point in points.iter().filter(is_wrong) {
            let (have, want) = (point.coordinates.len(), outputs.len());
            if told.contains(&have) {
                continue;
            }
            told.push(have);
            let message =
                format!("this point has {}, the route has {}", plural(have, "coordinate"), plural(want, "output"));
            self.report(Code::Misplaced, point.span, message, "give each point one coordinate for each output");
        }
        Route { outputs, points, span }
    }
}

/// The unit after the last point reaches the bare literals of all points.
fn share_route_unit(points: &mut [List]) {
    let Some(last) = points.last() else { return };
    let unit = match (&last.unit, &last.elements[..]) {
        (Some(unit), _) => unit.clone(),
        (None, [only]) if !last.is_tuple => match own_unit(only) {
            Some(unit) => unit,
            None => return,
        },
        _ => return,
    };
    let reached = give_units(points.iter_mut().flat_map(|point| &mut point.elements), &unit);
    if let Some(last) = points.last_mut() {
        last.unit_is_used |= reached;
    }
}

fn plural(count: usize, word: &str) -> String {
    if count == 1 { format!("one {word}") } else { format!("{count} {word}s") }
}
