//! Units that names of a list take from their neighbours, where the rest of the spec contradicts them.
//!
//! `state S, I, used [day];` makes populations of S and I, and then every equation clashes, far from the mistake. Takes the
//! problem and what was found in it. Where several clashes of dimensions, one of them about such a name by itself, are gone
//! as soon as the names of a list have another unit, they are one mistake at the declaration, which then names the unit
//! that fits. Specs without such clashes are not looked at twice.

use super::dimension::Dimension;
use super::units;
use crate::diagnostic::{Code, Diagnostic, Severity};
use crate::source::Source;
use crate::syntax::ast::{DeclaredName, Item, ItemKind, Problem, Unit};
use crate::syntax::parse_quantity;

/// Clashes that one declaration explains, at least: one alone is as likely the equation's.
const CLASHES: usize = 2;
/// Units that are tried for the names of a list.
const TRIED: usize = 12;

/// What was found, with clashes that come of units taken from a list told once, at the list. `again` gives what would be
/// found in another problem.
pub(super) fn told_once(
    problem: &Problem,
    source: &Source,
    mut found: Vec<Diagnostic>,
    again: &dyn Fn(&Problem) -> Vec<Diagnostic>,
) -> Vec<Diagnostic> {
    if found.iter().filter(|finding| finding.code == Code::DimensionMismatch).count() < CLASHES {
        return found;
    }
    let mut told = vec![];
    let mut mended = problem.clone();
    for unit in lenders(problem) {
        let borrowers = borrowers(problem, &unit);
        if !is_compared_by_itself(&borrowers, source, &found) {
            continue;
        }
        let tried = candidates(problem, &unit, source).into_iter().filter_map(|text| {
            let after = again(&with_unit(&mended, &unit, &text)?);
            let gone = found.iter().filter(|finding| is_clash(finding) && !after.contains(finding)).count();
            let is_new = |finding: &&Diagnostic| finding.severity == Severity::Error && !found.contains(finding);
            (gone >= CLASHES && after.iter().find(is_new).is_none()).then_some((gone, text, after))
        });
        // The first of equals: `max_by_key` would give the last.
        let best = tried.fold(None, |best: Option<(usize, String, Vec<Diagnostic>)>, next| match best {
            Some(known) if known.0 >= next.0 => Some(known),
            _ => Some(next),
        });
        let Some((_, text, after)) = best else { continue };
        let first = found.iter().find(|finding| is_clash(finding) && !after.contains(finding)).cloned();
        let finding = mistaken(&borrowers, (&unit, &text), source, first.as_ref());
        mended = with_unit(&mended, &unit, &text).unwrap_or(mended);
        found = after;
        told.push(finding);
    }
    found.extend(told);
    found
}

fn is_clash(finding: &Diagnostic) -> bool {
    finding.code == Code::DimensionMismatch
}

/// The finding at the list.
fn mistaken(
    borrowers: &[DeclaredName],
    (unit, fits): (&Unit, &str),
    source: &Source,
    first: Option<&Diagnostic>,
) -> Diagnostic {
    let names: Vec<String> = borrowers.iter().map(|name| format!("`{}`", name.name.text)).collect();
    let taken = source.slice(unit.span);
    let verb = if names.len() == 1 { "takes" } else { "take" };
    let message = format!("{} {verb} the unit {taken} of the list, which does not fit", names.join(", "));
    let place = borrowers.first().map_or(unit.span, |name| name.name.span);
    let mut finding = Diagnostic::new(Code::UnitInDoubt, place, message)
        .label(place, "no unit of its own")
        .label(unit.span, "taken from here");
    if let Some(first) = first {
        finding = finding.label(first.span, first.message.clone());
    }
    let own: Vec<String> = borrowers.iter().map(|name| format!("{} [{fits}]", source.slice(name.span))).collect();
    finding.help(format!("write the unit that is meant: `{}`", own.join(", ")))
}

/// Whether a clash is about such a name and nothing else on one side: `S == 0.9`.
fn is_compared_by_itself(borrowers: &[DeclaredName], source: &Source, found: &[Diagnostic]) -> bool {
    let is_name = |text: &str| {
        let bare = text.split('[').next().unwrap_or(text).trim();
        borrowers.iter().any(|name| name.name.text == bare) && (bare == text || text.ends_with(']'))
    };
    let mut sides = found.iter().filter(|finding| is_clash(finding)).flat_map(|finding| &finding.labels);
    sides.any(|(span, _)| is_name(source.slice(*span)))
}

/// The units that names of a list lend to others, each once, in the order of the text.
fn lenders(problem: &Problem) -> Vec<Unit> {
    let mut lenders: Vec<Unit> = vec![];
    each_list(&problem.items, &mut |names| {
        for unit in names.iter().filter(|name| is_borrowed(name)).filter_map(|name| name.unit.as_ref()) {
            if !lenders.contains(unit) {
                lenders.push(unit.clone());
            }
        }
    });
    lenders
}

fn is_borrowed(name: &DeclaredName) -> bool {
    name.unit.as_ref().is_some_and(|unit| !name.span.contains(unit.span))
}

/// The names that take this very unit.
fn borrowers(problem: &Problem, unit: &Unit) -> Vec<DeclaredName> {
    let mut borrowers = vec![];
    each_list(&problem.items, &mut |names| {
        borrowers.extend(names.iter().filter(|name| is_borrowed(name) && name.unit.as_ref() == Some(unit)).cloned());
    });
    borrowers
}

/// Units that may have been meant: none, the rates and totals of the one that was taken, those that other names have.
fn candidates(problem: &Problem, unit: &Unit, source: &Source) -> Vec<String> {
    let mut texts = vec!["1".to_owned()];
    if let Ok(taken) = units::quantity(unit) {
        let own = taken.dimension;
        let near = [own.times(&Dimension::TIME), own.over(&Dimension::TIME)];
        texts.extend(near.iter().map(ToString::to_string));
    }
    each_list(&problem.items, &mut |names| {
        for own in names.iter().filter(|name| !is_borrowed(name)).filter_map(|name| name.unit.as_ref()) {
            texts.push(source.slice(own.span).trim_matches(['[', ']']).trim().to_owned());
        }
    });
    let mut each: Vec<String> = vec![];
    for text in texts {
        if !each.contains(&text) && each.len() < TRIED {
            each.push(text);
        }
    }
    each
}

/// The problem with another unit for the names that took this one; none where the text is no unit.
fn with_unit(problem: &Problem, taken: &Unit, text: &str) -> Option<Problem> {
    let values = parse_quantity(&Source::new("unit", format!("1 [{text}]"))).ok()?;
    let other = values.elements.first()?.signed_literal()?.unit.clone()?;
    // Places of the trial are those of the spec.
    let other = Unit { span: taken.span, ..other };
    let mut trial = problem.clone();
    change_lists(&mut trial.items, &mut |names| {
        for name in names.iter_mut().filter(|name| is_borrowed(name) && name.unit.as_ref() == Some(taken)) {
            name.unit = Some(other.clone());
        }
    });
    Some(trial)
}

/// Every list of declared names, also those of agents, phases and scenarios.
fn each_list(items: &[Item], visit: &mut dyn FnMut(&[DeclaredName])) {
    for item in items {
        match &item.kind {
            ItemKind::Variable(list) => visit(&list.names),
            ItemKind::Output(list) => visit(&list.names),
            ItemKind::Phase(inner) => each_list(&inner.items, visit),
            ItemKind::Agent(inner) => each_list(&inner.items, visit),
            ItemKind::Scenario(inner) => each_list(&inner.items, visit),
            _ => {}
        }
    }
}

fn change_lists(items: &mut [Item], change: &mut dyn FnMut(&mut [DeclaredName])) {
    for item in items {
        match &mut item.kind {
            ItemKind::Variable(list) => change(&mut list.names),
            ItemKind::Output(list) => change(&mut list.names),
            ItemKind::Phase(inner) => change_lists(&mut inner.items, change),
            ItemKind::Agent(inner) => change_lists(&mut inner.items, change),
            ItemKind::Scenario(inner) => change_lists(&mut inner.items, change),
            _ => {}
        }
    }
}
