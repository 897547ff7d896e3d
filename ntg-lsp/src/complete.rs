//! What may be written next: keywords, declared names, functions, and units inside brackets.

use lsp_types::{CompletionItem, CompletionItemKind};
use ntg_compiler::model::tools;
use ntg_compiler::source::Source;
use ntg_compiler::standard;
use ntg_compiler::syntax::ast::ItemKind;
use ntg_compiler::syntax::{EXPRESSION_WORDS, ITEM_WORDS, OTHER_ITEM_WORDS};

use crate::analysis::Analysis;
use crate::explained::explained;
use crate::libraries;
use crate::names::Kind;

/// The proposals at a byte.
pub fn proposals(analysis: &Analysis, byte: usize) -> Vec<CompletionItem> {
    let text = &analysis.source.text;
    let start = analysis.word(byte).start as usize;
    if is_in_comment(text, byte) || is_in_string(text, byte) {
        return vec![];
    }
    if is_in_unit(text, start) {
        return tools::unit_symbols().map(unit).collect();
    }
    if let Some(items) = of_libraries(analysis, start) {
        return items;
    }
    if let Some(words) = expected(text, start) {
        return words.iter().map(|word| keyword(word)).collect();
    }
    let mut items = names(analysis, byte);
    if text[..start].trim_end().ends_with([';', '{', '}']) || text[..start].trim().is_empty() {
        items.push(keyword("use"));
        items.extend(ITEM_WORDS.iter().chain(OTHER_ITEM_WORDS).chain(&["for", "soft"]).map(|word| keyword(word)));
    } else {
        items.extend(EXPRESSION_WORDS.iter().map(|word| keyword(word)));
        items.extend(
            [
                "else", "smooth", "spline", "held", "gauss", "uniform", "after", "through", "from", "except", "rows",
                "sigma", "until", "weight",
            ]
            .map(keyword),
        );
    }
    for used in analysis.uses() {
        items.push(CompletionItem {
            label: used.name.clone(),
            kind: Some(CompletionItemKind::MODULE),
            detail: Some(format!("the library `{}`: `{}::...`", used.source.name, used.name)),
            ..CompletionItem::default()
        });
    }
    items.extend(tools::functions().map(function));
    items
}

/// The words that alone may stand at a place: settings, methods of tables, what follows a colon.
fn expected(text: &str, start: usize) -> Option<&'static [&'static str]> {
    let before = statement(text, start);
    let first = before.split_whitespace().next()?;
    let so_far = before.trim_end();
    if so_far.ends_with(['(', ',']) {
        let open = before.rfind('(')?;
        let settings = match before[..open].trim_end().rsplit(|c: char| !c.is_alphanumeric()).next()? {
            _ if before[open..].contains(')') => return None,
            "spline" => &["order", "intervals", "smoothness", "knots"][..],
            "gauss" => &["points", "intervals", "equalities", "inequalities"],
            "uniform" => &["breakpoints"],
            "monotone" => &["extrapolate"],
            "bspline" => &["order", "intervals"],
            _ => return None,
        };
        // Within the parentheses of a value another one stands.
        return (before[open..].matches('(').count() == 1).then_some(settings);
    }
    Some(match first {
        "input" if so_far.ends_with(':') => &["held", "continuous", "spline"],
        "output" | "state" if so_far.ends_with(':') => &["spline"],
        "collocation" if so_far == before[..before.find("collocation")? + 11].trim_end() => &["gauss", "uniform"],
        "table" if so_far.ends_with('=') && !before.contains('{') => &["monotone", "linear", "bspline", "fit"],
        _ => return None,
    })
}

/// The names behind `std::` or behind a library and `::`.
fn of_libraries(analysis: &Analysis, start: usize) -> Option<Vec<CompletionItem>> {
    let text = &analysis.source.text;
    let is_use = statement(text, start).trim_start().starts_with("use");
    // In the braces of a `use` the library stands before them.
    let open = statement_of_use(text, start);
    if is_use && libraries::behind(text, start) == Some("std") {
        let module = |name: &&str| CompletionItem {
            label: name.trim_start_matches("std::").to_owned(),
            kind: Some(CompletionItemKind::MODULE),
            detail: standard::library(name)
                .and_then(|text| text.lines().next())
                .map(|line| line.trim_start_matches("// ").to_owned()),
            ..CompletionItem::default()
        };
        return Some(standard::names().iter().map(module).collect());
    }
    let library = match open {
        Some(library) => library,
        None => libraries::behind(text, start)?,
    };
    let whole = format!("use std::{library};");
    let mut uses = analysis.uses();
    if !uses.iter().any(|used| used.name == library) {
        uses = libraries::used(&Source::new("", whole), analysis.loader());
    }
    let used = uses.iter().find(|used| used.name == library)?;
    let items = used.items().map(|(name, item)| CompletionItem {
        label: name.text.clone(),
        kind: Some(match item.kind {
            ItemKind::Const(_) => CompletionItemKind::CONSTANT,
            _ => CompletionItemKind::FUNCTION,
        }),
        detail: Some(used.head(item)),
        documentation: item.doc.as_ref().map(|doc| lsp_types::Documentation::String(doc.text.clone())),
        ..CompletionItem::default()
    });
    Some(items.collect())
}

/// The library whose names are listed in the braces around a place.
fn statement_of_use(text: &str, byte: usize) -> Option<&str> {
    let before = &text[..byte];
    let brace = before.rfind('{').filter(|brace| !before[*brace..].contains(['}', ';']))?;
    libraries::behind(text, brace)
}

fn names(analysis: &Analysis, byte: usize) -> Vec<CompletionItem> {
    let mut items: Vec<CompletionItem> = vec![];
    for declaration in analysis.names().visible(byte) {
        let label = &declaration.name.text;
        let is_named = !matches!(declaration.kind, Kind::Problem | Kind::Term | Kind::Constraint);
        if is_named && items.iter().all(|item| item.label != *label) {
            items.push(CompletionItem {
                label: label.clone(),
                kind: Some(kind(declaration.kind)),
                detail: Some(analysis.source.snippet(declaration.statement)),
                documentation: declaration.doc.clone().map(lsp_types::Documentation::String),
                ..CompletionItem::default()
            });
        }
    }
    items
}

fn kind(kind: Kind) -> CompletionItemKind {
    match kind {
        Kind::Problem | Kind::Agent | Kind::Phase | Kind::Scenario => CompletionItemKind::MODULE,
        Kind::Const => CompletionItemKind::CONSTANT,
        Kind::Param => CompletionItemKind::PROPERTY,
        Kind::Variable | Kind::Duration | Kind::Domain | Kind::Index | Kind::Argument | Kind::Step => {
            CompletionItemKind::VARIABLE
        }
        Kind::Output => CompletionItemKind::FIELD,
        Kind::Function | Kind::Table => CompletionItemKind::FUNCTION,
        Kind::Let | Kind::Term | Kind::Constraint => CompletionItemKind::VALUE,
    }
}

fn keyword(word: &str) -> CompletionItem {
    let detail = explained(word);
    CompletionItem {
        label: word.to_owned(),
        kind: Some(CompletionItemKind::KEYWORD),
        detail,
        ..CompletionItem::default()
    }
}

fn function(name: &str) -> CompletionItem {
    let detail = explained(name);
    CompletionItem {
        label: name.to_owned(),
        kind: Some(CompletionItemKind::FUNCTION),
        detail,
        ..CompletionItem::default()
    }
}

fn unit(symbol: &str) -> CompletionItem {
    let detail = tools::unit(symbol).map(|(words, factor)| format!("{words}: {factor}"));
    CompletionItem {
        label: symbol.to_owned(),
        kind: Some(CompletionItemKind::UNIT),
        detail,
        ..CompletionItem::default()
    }
}

/// The text of the statement before a byte.
fn statement(text: &str, byte: usize) -> &str {
    let before = &text[..text.floor_char_boundary(byte)];
    before.rfind([';', '{', '}']).map_or(before, |start| &before[start + 1..])
}

/// Whether a byte stands in a `//` comment, or in a block comment that began before it.
pub fn is_in_comment(text: &str, byte: usize) -> bool {
    let mut rest = &text[..text.floor_char_boundary(byte)];
    loop {
        let Some(start) = rest.find("//").into_iter().chain(rest.find("/*")).min() else { return false };
        let end = if rest[start..].starts_with("//") {
            rest[start..].find('\n')
        } else {
            rest[start + 2..].find("*/").map(|end| end + 4)
        };
        match end {
            Some(end) => rest = &rest[start + end..],
            None => return true,
        }
    }
}

fn is_in_string(text: &str, byte: usize) -> bool {
    let line = statement(text, byte).rsplit('\n').next().unwrap_or("");
    line.matches('"').count() % 2 == 1
}

/// Whether what stands at a byte is in the brackets of a unit: behind a number or a list, or behind a declared name
/// and a blank, as everyone writes it.
pub fn is_in_unit(text: &str, byte: usize) -> bool {
    let before = statement(text, byte);
    let Some(open) = before.rfind('[') else { return false };
    let inside = &before[open + 1..];
    if inside.contains(']') || inside.contains("..") || inside.contains(" in ") {
        return false;
    }
    let outside = before[..open].trim_end();
    let word: String = outside
        .chars()
        .rev()
        .take_while(|c| c.is_alphanumeric() || matches!(c, '_' | '.'))
        .collect::<Vec<_>>()
        .into_iter()
        .rev()
        .collect();
    let is_number = word.starts_with(|c: char| c.is_ascii_digit());
    let is_declared = outside.len() < open && !before[..open].contains('=');
    is_number || is_declared || outside.ends_with(')') || outside.ends_with(']')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn where_few_words_may_stand_they_alone_are_proposed() {
        let at = |text: &str| expected(text, text.len()).unwrap_or_default();
        assert_eq!(at("problem P { input u[3] [N]: "), ["held", "continuous", "spline"]);
        assert_eq!(at("problem P { output x [m]:"), ["spline"]);
        assert_eq!(at("output x: spline(order = 5, ").first(), Some(&"order"));
        assert_eq!(at("collocation gauss(").first(), Some(&"points"));
        assert_eq!(at("collocation "), ["gauss", "uniform"]);
        assert_eq!(at("table f(x) = ").first(), Some(&"monotone"));
        for elsewhere in [
            "let a = norm(",
            "output x: spline(order = ",
            "output x: spline(order = half(",
            "minimize a: ",
            "state x, ",
        ] {
            assert!(at(elsewhere).is_empty(), "{elsewhere}");
        }
    }
}
