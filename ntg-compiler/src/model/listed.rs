//! Units in lists of names: which unit a name takes that has none of its own.
//!
//! Takes a declaration whose names have got their units. A name without one took the next to its right, else the last
//! of the list (`syntax::parse`). Finds: names that take another unit than they did before version 2, names behind the last
//! unit, names for which a reader may take the unit in the bounds of another name, and names for which a reader may take
//! these bounds.

use ntg_structure::Unit;

use super::dimension::Dimension;
use super::elaborator::{Definition, Elaborator};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{self, DeclaredName, Role};

/// What a name of a list is measured in; no dimension where its unit was refused.
pub(super) type Measured = (Option<Dimension>, Unit);

impl Elaborator<'_> {
    /// Notes names in a list of outputs that take the next unit, where earlier versions gave them the last one.
    pub(super) fn units_taken(&mut self, output: &ast::Output) {
        let Some(last) = output.names.iter().rev().find_map(|name| name.unit.as_ref()) else { return };
        for name in output.names.iter().filter(|_| output.role == Role::Output) {
            let Some(unit) = name.unit.as_ref().filter(|unit| unit.span.start > name.span.end) else { continue };
            let (taken, before) = (self.text(unit.span), self.text(last.span));
            if taken == before {
                continue;
            }
            let text = &name.name.text;
            let message = format!("`{text}` takes the next unit, {taken}; before version 2 it was {before}");
            let note = Diagnostic::new(Code::UnitTaken, name.name.span, message).label(unit.span, "the next unit");
            self.report(note.help(format!("write it out: `{text} {taken}`")));
        }
    }

    /// Refuses names for which the unit in another name's bounds stands nearer than the unit that they take, and gives
    /// their places in the list: what they are measured in is not known.
    pub(super) fn units_in_doubt(&mut self, names: &[DeclaredName], measured: &[Measured]) -> Vec<usize> {
        self.note_taken(names);
        self.note_sizes(names);
        let mut in_doubt = vec![];
        for (i, name) in names.iter().enumerate() {
            let Some(rival) = rival(names, i) else {
                if self.stands_behind(name) {
                    in_doubt.push(i);
                }
                continue;
            };
            let ((Some(own), unit), (Some(other), bounds)) = (&measured[i], &measured[rival]) else { continue };
            if own == other && unit == bounds {
                continue;
            }
            let brackets = |unit: &Unit| format!("[{}]", if unit.symbol.is_empty() { "1" } else { &unit.symbol });
            let (text, near) = (&name.name.text, &names[rival].name.text);
            let (unit, bounds) = (brackets(unit), brackets(bounds));
            let message = format!("the unit of `{text}` can be read two ways: {bounds} or {unit}");
            let mut finding = Diagnostic::new(Code::UnitInDoubt, name.name.span, message)
                .label(name.name.span, "no unit of its own")
                .label(names[rival].span, format!("{bounds}, from bounds, which are about `{near}` alone"));
            if let Some(taken) = &name.unit {
                finding = finding.label(taken.span, format!("{unit}, of the list"));
            }
            self.report(finding.help(format!("write the unit that is meant: `{text} {bounds}`, or `{text} {unit}`")));
            in_doubt.push(i);
        }
        if in_doubt.is_empty() {
            self.note_unbounded(names);
        }
        in_doubt
    }

    /// Refuses a name behind the last unit of its list: a pure number looks the same.
    fn stands_behind(&mut self, name: &DeclaredName) -> bool {
        let Some(unit) = name.unit.as_ref().filter(|unit| is_bare(name) && unit.span.end <= name.span.start) else {
            return false;
        };
        let (text, last) = (&name.name.text, self.text(unit.span));
        if last == "[1]" {
            return false;
        }
        let message = format!("the unit of `{text}` can be read two ways: {last} or [1]");
        let finding = Diagnostic::new(Code::UnitInDoubt, name.name.span, message)
            .label(unit.span, "the last unit of the list")
            .label(name.name.span, "behind it, without one of its own");
        self.report(finding.help(format!("write the unit that is meant: `{text} {last}`, or `{text} [1]`")));
        true
    }

    /// Notes a unit of one symbol that is also the name of a whole number, once in each list: it looks like a size.
    fn note_sizes(&mut self, names: &[DeclaredName]) {
        let looks_like_size = |name: &&DeclaredName| {
            let symbol = name.unit.as_ref().filter(|unit| name.span.contains(unit.span)).and_then(only_symbol);
            let named = |own: &&Definition<'_>| Some(own.name.text.as_str()) == symbol && own.is_const;
            name.shape.is_none() && self.definitions.iter().find(named).is_some_and(|own| is_size(own.value))
        };
        let Some((name, unit)) = names.iter().find(looks_like_size).and_then(|name| Some((name, name.unit.as_ref()?)))
        else {
            return;
        };
        let (text, symbol) = (&name.name.text, only_symbol(unit).unwrap_or_default());
        let message = format!("`[{symbol}]` is a unit here, and no size, although there is a constant `{symbol}`");
        let note = Diagnostic::new(Code::UnitLikeSize, unit.span, message);
        self.report(note.help(format!("as a size write `{text}[1 .. {symbol}]`")));
    }

    /// Notes names right before one with bounds that have neither bounds nor a unit of their own: the bounds look as if they
    /// were about all of them.
    fn note_unbounded(&mut self, names: &[DeclaredName]) {
        for bounded in (1..names.len()).filter(|i| names[*i].bounds.is_some()) {
            let before = names[..bounded].iter().rev().take_while(|name| is_bare(name)).count();
            let unbounded = &names[bounded - before..bounded];
            let Some(first) = unbounded.first() else { continue };
            let texts: Vec<String> = unbounded.iter().map(|name| format!("`{}`", name.name.text)).collect();
            let (near, whole) = (&names[bounded], self.text(names[bounded].span));
            let (text, verb) = (&near.name.text, if before == 1 { "has" } else { "have" });
            let bounds = whole.find(" in ").map_or("", |at| &whole[at..]).to_owned();
            let message = format!("{} {verb} no bounds: these are about `{text}` alone", texts.join(", "));
            let note = Diagnostic::new(Code::UnboundedInList, first.name.span, message).label(near.span, "the bounds");
            let both = unbounded.iter().map(|name| format!("{}{bounds}", self.text(name.span)));
            let help = format!("if they are meant to have them: `{}, {whole}`", both.collect::<Vec<_>>().join(", "));
            self.report(note.help(help));
        }
    }
}

/// The symbol of a unit that is one symbol and nothing else.
fn only_symbol(unit: &ast::Unit) -> Option<&str> {
    match unit.factors.as_slice() {
        [ast::UnitFactor { base: ast::UnitBase::Symbol(name), power: 1, .. }] => Some(&name.text),
        _ => None,
    }
}

/// Whether a constant is written as a whole number from 2 on, without a unit.
fn is_size(value: &ast::Expr) -> bool {
    matches!(&value.kind, ast::ExprKind::Number(number)
        if number.unit.is_none() && number.value >= 2.0 && number.value.fract() == 0.0)
}

/// Whether a name has neither bounds nor a unit of its own.
fn is_bare(name: &DeclaredName) -> bool {
    name.bounds.is_none() && name.unit.as_ref().is_none_or(|unit| !name.span.contains(unit.span))
}

/// The name with bounds and no unit of its own that stands nearer to a bare name than the unit which that one takes.
fn rival(names: &[DeclaredName], i: usize) -> Option<usize> {
    let name = &names[i];
    if !is_bare(name) {
        return None;
    }
    let is_bounded = |at: &usize| names[*at].bounds.is_some() && names[*at].unit.is_none();
    let source = name.unit.as_ref().and_then(|unit| names.iter().position(|other| other.span.contains(unit.span)));
    match source {
        Some(right) if right > i => (i + 1..right).find(is_bounded),
        Some(left) => (left + 1..i).rev().find(is_bounded),
        None => (i + 1..names.len()).find(is_bounded).or_else(|| (0..i).rev().find(is_bounded)),
    }
}
