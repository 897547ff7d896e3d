//! Constants, parameters, variables, outputs, functions, named expressions, objectives.

use super::Build;
use super::parts::Parts;
use crate::syntax::ast::{
    Const, Continuation, Function, Let, Objective, Output, OutputName, Param, Sense, Size, Spline, Unit, Variable,
};
use crate::syntax::grammar::{Pair, Rule};

impl Build {
    pub(super) fn constant(&mut self, pair: Pair<'_>) -> Const {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        Const { name, value: self.expression(parts.required(Rule::expression)) }
    }

    pub(super) fn param(&mut self, pair: Pair<'_>) -> Param {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let size = parts.optional(Rule::array_size).map(|pair| self.expression(Parts::of(pair).any()));
        Param { name, size, default: self.values(parts.required(Rule::values)) }
    }

    pub(super) fn variable(&mut self, pair: Pair<'_>) -> Variable {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        let bounds = parts.optional(Rule::bounds).map(|pair| self.bounds(pair));
        Variable { name, unit, bounds }
    }

    pub(super) fn output(&mut self, pair: Pair<'_>) -> Output {
        let mut parts = Parts::of(pair);
        let mut names = vec![];
        while let Some(pair) = parts.optional(Rule::output_name) {
            names.push(self.output_name(pair));
        }
        // Names without a unit take the last one of the list.
        let last: Option<Unit> = names.iter().rev().find_map(|name| name.unit.clone());
        for name in names.iter_mut().filter(|name| name.unit.is_none()) {
            name.unit.clone_from(&last);
        }
        Output { names, spline: self.spline(parts.required(Rule::spline)) }
    }

    fn output_name(&mut self, pair: Pair<'_>) -> OutputName {
        let span = self.span(&pair);
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let size = parts.optional(Rule::size).map(|pair| self.size(pair));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        OutputName { name, size, unit, span }
    }

    fn size(&mut self, pair: Pair<'_>) -> Size {
        let mut parts = Parts::of(pair);
        let first = self.expression(parts.required(Rule::expression));
        let last = self.expression(parts.required(Rule::expression));
        let span = first.span.to(last.span);
        Size { first, last, span }
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
        while let Some(pair) = parts.optional(Rule::name) {
            parameters.push(self.name(&pair));
        }
        Function { name, parameters, body: self.expression(parts.required(Rule::expression)) }
    }

    pub(super) fn named(&mut self, pair: Pair<'_>) -> Let {
        let mut parts = Parts::of(pair);
        let name = self.name(&parts.required(Rule::name));
        let family = parts.optional(Rule::family).map(|pair| self.family(pair));
        let unit = parts.optional(Rule::unit).map(|pair| self.unit(pair));
        Let { name, family, unit, value: self.expression(parts.required(Rule::expression)) }
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
