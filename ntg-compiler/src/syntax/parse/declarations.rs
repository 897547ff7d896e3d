//! Constants, parameters, variables, outputs, functions, named expressions, objectives.

use super::Build;
use super::parts::Parts;
use super::shapes::Indices;
use crate::syntax::ast::{
    Argument, Const, Continuation, Course, DeclaredName, Function, Let, Objective, Output, Param, Role, Sense, Spline,
    Unit, Values, Variable,
};
use crate::syntax::grammar::{Pair, Rule};

impl Build {
    pub(super) fn constant(&mut self, pair: Pair<'_>) -> Const {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let shape = parts.optional(Rule::array_size).map(|pair| self.shape(pair, Indices::Refused));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        let value = match parts.optional(Rule::file) {
            Some(pair) => self.file(pair, unit),
            None => {
                self.unit_without_file(unit);
                self.value_or_tuple(parts.required(Rule::values))
            }
        };
        Const { name, shape, value }
    }

    pub(super) fn param(&mut self, pair: Pair<'_>) -> Param {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let shape = parts.optional(Rule::array_size).map(|pair| self.shape(pair, Indices::Refused));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        let default = match parts.optional(Rule::file) {
            Some(pair) => {
                let value = self.file(pair, unit);
                let span = value.span;
                Values { elements: vec![value], is_tuple: false, span }
            }
            None => {
                self.unit_without_file(unit);
                self.values(parts.required(Rule::values))
            }
        };
        Param { name, shape, default }
    }

    pub(super) fn variable(&mut self, pair: Pair<'_>) -> Variable {
        Variable { names: self.declared_names(&mut Parts::of(pair)) }
    }

    pub(super) fn output(&mut self, pair: Pair<'_>) -> Output {
        let mut parts = Parts::of(pair);
        let names = self.declared_names(&mut parts);
        let course = Course::Spline(self.spline(parts.required(Rule::spline)));
        Output { role: Role::Output, names, course }
    }

    /// `state` or `input`.
    pub(super) fn process(&mut self, pair: Pair<'_>, role: Role) -> Output {
        let mut parts = Parts::of(pair);
        let names = self.declared_names(&mut parts);
        let course = match parts.next() {
            None => Course::Collocated,
            Some(pair) if pair.as_rule() == Rule::spline => Course::Spline(self.spline(pair)),
            Some(pair) if pair.as_str() == "held" => Course::Held,
            Some(_) => Course::Continuous,
        };
        Output { role, names, course }
    }

    /// The names of a list. One without unit and bounds takes the next unit to its right, else the last one of the list.
    fn declared_names(&mut self, parts: &mut Parts<'_>) -> Vec<DeclaredName> {
        let mut names = vec![];
        while let Some(pair) = parts.optional(Rule::declared) {
            names.push(self.declared_name(pair));
        }
        let last: Option<Unit> = names.iter().rev().find_map(|name| name.unit.clone());
        let mut next = last;
        for name in names.iter_mut().rev() {
            match &name.unit {
                Some(unit) => next = Some(unit.clone()),
                None if name.bounds.is_none() => name.unit.clone_from(&next),
                None => {}
            }
        }
        names
    }

    fn declared_name(&mut self, pair: Pair<'_>) -> DeclaredName {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let shape = parts.optional(Rule::shape).map(|pair| self.shape(pair, Indices::Refused));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        let bounds = parts.optional(Rule::bounds).map(|pair| self.bounds(pair));
        DeclaredName { name, shape, unit, bounds, span }
    }

    fn spline(&mut self, pair: Pair<'_>) -> Spline {
        let span = self.span(&pair);
        let mut settings = self.settings("spline", Parts::of(pair).next());
        let spline = Spline {
            order: settings.value(self, "order"),
            intervals: settings.value(self, "intervals"),
            knots: settings.values(self, "knots"),
            smoothness: settings.value(self, "smoothness"),
            span,
        };
        settings.finish(self);
        spline
    }

    pub(super) fn function(&mut self, pair: Pair<'_>) -> Function {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let mut parameters = vec![];
        while let Some(pair) = parts.optional(Rule::argument) {
            parameters.push(self.argument(pair));
        }
        let shape = parts.optional(Rule::shape).map(|pair| self.shape(pair, Indices::Refused));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        let body = match parts.optional(Rule::value_block) {
            Some(block) => self.value_block(block),
            None => self.expression(parts.required(Rule::expression)),
        };
        Function { name, parameters, shape, unit, body }
    }

    fn argument(&mut self, pair: Pair<'_>) -> Argument {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let shape = parts.optional(Rule::shape).map(|pair| self.shape(pair, Indices::Refused));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        Argument { name, shape, unit }
    }

    pub(super) fn named(&mut self, pair: Pair<'_>) -> Let {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let shape = parts.optional(Rule::shape).map(|pair| self.shape(pair, Indices::First));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        Let { name, shape, unit, value: self.expression(parts.required(Rule::expression)) }
    }

    pub(super) fn continuation(&mut self, pair: Pair<'_>) -> Continuation {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        Continuation { name, values: self.values(parts.required(Rule::values)) }
    }

    pub(super) fn objective(&mut self, pair: Pair<'_>) -> Objective {
        let mut parts = Parts::of(pair);
        let sense = match parts.required(Rule::sense).as_str() {
            "maximize" => Sense::Maximize,
            _ => Sense::Minimize,
        };
        let (mut name, mut unit) = (None, None);
        if let Some(pair) = parts.optional(Rule::objective_name) {
            let mut parts = Parts::of(pair);
            name = Some(self.name(&parts.required(Rule::name)));
            unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        }
        Objective { sense, name, unit, value: self.expression(parts.required(Rule::expression)) }
    }
}
