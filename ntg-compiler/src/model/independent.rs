//! The independent variable: `t` in seconds, or what `domain s [m];` names.
//!
//! Takes the items of the problem; sets the dimension that starts, durations and derivatives have, and declares the
//! name, which then is what `t` would be.
//! Finds: a second `domain`, units that are none, `t` where another name is declared.

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::scope::{Declared, Entity, PROBLEM};
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::ast::{IndependentVariable, Item, ItemKind};
use ntg_structure::{Independent, Unit};

/// The independent variable where none is declared.
const TIME: &str = "t";

impl<'a> Elaborator<'a> {
    /// The dimension and unit of the independent variable, before anything is measured by them.
    pub(super) fn independent(&mut self, items: &'a [Item]) {
        let mut declared = items.iter().filter_map(domain);
        let Some((first, span)) = declared.next() else { return };
        if let Some((_, again)) = declared.next() {
            let finding = Diagnostic::new(Code::DeclaredTwice, again, "a second independent variable")
                .label(again, "declared again here")
                .label(span, "first declared here");
            self.report(finding.help("all agents and phases have one in common: remove one of them"));
        }
        self.domain = Some(first);
        let (dimension, unit) = match first.unit.as_ref().map(|unit| self.unit(unit)) {
            Some(Some((quantity, unit))) => (quantity.dimension, unit),
            Some(None) => return,
            None => (Dimension::NONE, Unit::default()),
        };
        self.time = dimension;
        self.problem.independent = Independent { name: first.name.text.clone(), unit };
    }

    /// The name of the independent variable, among those of the problem.
    pub(super) fn independent_named(&mut self, items: &'a [Item]) {
        let Some((first, _)) = items.iter().find_map(domain) else { return };
        if first.name.text != TIME {
            self.declare(PROBLEM, &first.name, Declared { entity: Entity::Independent, span: first.name.span });
        }
    }

    /// `t`, which has no meaning where another independent variable is declared.
    pub(super) fn time(&mut self, cx: &super::scope::Context<'a>, span: Span) -> Value {
        match self.domain.map(|domain| domain.name.text.as_str()).filter(|name| *name != TIME) {
            Some(name) => {
                let finding = Diagnostic::new(Code::UnknownName, span, format!("unknown name `{TIME}`"));
                self.refuse(finding.help(format!("the independent variable is `{name}`")), span)
            }
            None => self.mission_time(cx, span),
        }
    }

    /// A number in the unit of the independent variable, as one would write it.
    pub(super) fn example_of_time(&self, number: &str) -> String {
        match self.clock().symbol.as_str() {
            "" => number.to_owned(),
            unit => format!("{number} [{unit}]"),
        }
    }

    /// What starts and durations are, the unit that they are written in, and the declaration that says so.
    pub(super) fn kind_of_time(&self) -> (String, String, Option<String>) {
        match self.domain {
            Some(domain) => {
                let Independent { name, unit } = &self.problem.independent;
                let text = domain.unit.as_ref().map_or_else(String::new, |unit| format!(" {}", self.text(unit.span)));
                (self.time.describe(), unit.symbol.clone(), Some(format!("domain {name}{text}")))
            }
            None => {
                let unit = self.noted.clock.as_ref().map_or("s", |unit| unit.symbol.as_str());
                ("a time".to_owned(), unit.to_owned(), None)
            }
        }
    }
}

/// The declaration of an independent variable, and where it stands.
fn domain(item: &Item) -> Option<(&IndependentVariable, Span)> {
    match &item.kind {
        ItemKind::Domain(domain) => Some((domain, item.span)),
        _ => None,
    }
}
