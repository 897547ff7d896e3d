//! What may be written next: keywords, declared names, functions, and units inside brackets.

use lsp_types::{CompletionItem, CompletionItemKind};
use ntg_compiler::model::tools;
use ntg_compiler::source::Source;
use ntg_compiler::standard;
use ntg_compiler::syntax::ast::ItemKind;
use ntg_compiler::syntax::{EXPRESSION_WORDS, ITEM_WORDS, OTHER_ITEM_WORDS};

use crate::analysis::Analysis;
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

/// What a word of the language means, in a line.
pub fn explained(word: &str) -> Option<String> {
    let words = match word {
        "agent" => "`agent uav[i in 1 .. 3] { ... }`: an independent timeline, or a family of them",
        "phase" => "`phase leg after start { ... }`: a stretch of time with its own splines and constraints",
        "const" => "`const N = 3;`: known when the spec is compiled",
        "param" => "`param v_max = 0.25 [km/s];`: a value that a program may change without compiling again",
        "variable" => "`variable m0 in 1 .. 5 [kg];`: a free number, constant in time",
        "output" => "`output x, y [km]: spline(order = 5, intervals = 8);`: what moves",
        "use" => {
            "`use std::rotation;`, `use \"shuttle.ntg\" as shuttle;`: constants, functions and tables of a library"
        }
        "fn" => {
            "`fn blend(u, w) = ...;`, `fn lift(v [m/s]) [N] { let q = ...; ... }`: a function, written out where it is applied"
        }
        "let" => "`let speed [km/s] = hypot(der(x), der(y));`: a named expression, also reported and plotted",
        "table" => "`table thrust(t [s]) [kN] = linear { 0: 18; 6: 0; }`: data",
        "continuation" => "`continuation width = (20, 10, 5) [deg];`: a parameter solved for in turn",
        "duration" => "`duration T in 1 .. 9 [s];`, or `duration(phase)` in an expression",
        "start" => "`start in 0 .. 600 [s];` in an agent, or `start(phase)` in an expression",
        "end" => "`end(phase)`: the time at which a phase or agent ends",
        "initial" => "`initial { ... }`: what holds at the start; `initial(e)`: the value there",
        "trajectory" => "`trajectory { ... }`: what holds all the way",
        "final" => "`final { ... }`: what holds at the end; `final(e)`: the value there",
        "temporal" => "`temporal { ... }`: what belongs to no single point, such as event times",
        "minimize" => "`minimize fuel [kg]: e;`: a term of the objective; terms add up",
        "maximize" => "`maximize range: e;`: a term of the objective; terms add up",
        "collocation" => "`collocation gauss(points = 5);`, `collocation uniform(breakpoints = 41);`",
        "guess" => "`guess { (x, y) through (0, 0), (1, 5) [km];  T = 9 [s]; }`: where to begin",
        "continuous" => "`continuous x up to 1;`: how smoothly phases meet",
        "at" => "`at 2.5 [s] { ... }`: what holds at one time; `at(2.5 [s], e)`: the value there",
        "domain" => "`domain s [m];`: everything is a function of `s` instead of the time `t`",
        "scenario" => "`scenario plant[k in 1 .. 20] { ... }`: the same problem for several cases at once",
        "shared" => "`shared u until 1 [s];`: an input that all members of a scenario have in common",
        "until" => "`shared u until 1 [s];`: up to when the members of a scenario share an input",
        "weight" => "`scenario plant[k in 1 .. 20] weight p[k] { ... }`: with what each member counts",
        "periodic" => "`periodic x, y;`: outputs that end as they begin, with their derivatives",
        "soft" => "`soft(200 [1/s]): c;`: a constraint that may be missed, at a price",
        "except" => "`trajectory except final { ... }`: everywhere but at that end",
        "from" => {
            "`trajectory from a to b { ... }`: a part of the trajectory; `param a[n, 3] [m] from \"a.csv\" columns 1 .. 3;`: data"
        }
        "measure" => "`measure { at(2 [s], x) == 3 [m] sigma 0.1 [m]; }`: what was measured, by least squares",
        "sigma" => "`at(2 [s], x) == 3 [m] sigma 0.1 [m];` in `measure`: the standard deviation",
        "rows" => "`const n = rows(\"a.csv\");`: how many rows a file has",
        "jump" => "`jump m;`: an output that is not continuous at the start of the phase",
        "der" => "`der(e)`, `der(e, 2)`: derivative in real time, by the chain rule",
        "partial" => "`partial(f(s, w), s)`: partial derivative of a function or table",
        "integral" => "`integral(e)`: over real time",
        "sum" => "`sum(i in 1 .. N, e)`",
        "prod" => "`prod(i in 1 .. N, e)`",
        "if" => "`if a <= b smooth w { x } else { y }`: a value that depends on a condition",
        "else" => "`if a <= b { x } else { y }`: the value where the condition does not hold",
        "smooth" => "`if a <= b smooth w { x } else { y }`: the width over which both branches blend",
        "for" => "`for i in 1 .. N { ... }`: constraints or guesses for every index",
        "t" => "mission time",
        "tau" => "scaled time of the phase, from 0 to 1",
        "pi" => "3.14159...",
        "hypot" => "`hypot(a, b, ...)`: sqrt(a^2 + b^2 + ...)",
        "atan2" => "`atan2(y, x)`: the angle of the point (x, y)",
        "logistic" => "`logistic(u)`: 1 / (1 + exp(-u))",
        "softplus" => "`softplus(u)`: log(1 + exp(u))",
        "smooth_abs" => "`smooth_abs(u, width)`: hypot(u, width)",
        "smooth_max" => "`smooth_max(u, v, width)`",
        "spline" => "`spline(order = 5, intervals = 8, smoothness = 3)`, or `knots = (0, 0.2, 1)`",
        "gauss" => "`gauss(points = 5)`: Gauss-Legendre points in every knot interval",
        "uniform" => "`uniform(breakpoints = 41)`: equally spaced points, trapezoid rule",
        _ => return None,
    };
    Some(words.to_owned())
}
