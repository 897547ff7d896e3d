//! What is shown beside a word: its declaration, documentation, value, unit, dimension; for `der(...)` what it
//! expands to.

use ntg_compiler::model::problem::{Bounds, Problem};
use ntg_compiler::model::{self, tools};
use ntg_compiler::source::Span;
use ntg_compiler::syntax;
use ntg_structure::Unit;

use crate::analysis::Analysis;
use crate::complete;
use crate::explained::explained;
use crate::libraries;
use crate::names::{Declaration, Derivative, Kind};
use crate::words;

/// A name that no spec has, for asking the compiler about an expression.
const PROBE: &str = "ntg_probe";

/// The answer in Markdown, and the place that it is about.
pub fn hover(analysis: &Analysis, byte: usize) -> Option<(String, Span)> {
    let word = analysis.word(byte);
    let text = analysis.source.slice(word);
    if complete::is_in_comment(&analysis.source.text, byte) {
        return None;
    }
    if complete::is_in_unit(&analysis.source.text, word.start as usize) {
        let (words, factor) = tools::unit(text)?;
        return Some((format!("`[{text}]`: {words}, {factor} in SI units"), word));
    }
    if text == "der" {
        let of = |derivative: &&Derivative| derivative.span.start == word.start;
        let derivative = analysis.names().derivatives.iter().find(of)?;
        return Some((expansion(analysis, derivative), derivative.span));
    }
    let uses = analysis.uses();
    if let Some((used, _, item)) = libraries::find(&uses, &analysis.source.text, word) {
        let mut parts = vec![format!("```ntg\n{}\n```", used.head(item))];
        parts.extend(item.doc.as_ref().map(|doc| doc.text.clone()));
        parts.push(format!("of the library `{}`", used.source.name));
        return Some((parts.join("\n\n"), word));
    }
    if let Some(mention) = analysis.names().at(byte) {
        let declared = mention.declarations.iter().filter_map(|at| analysis.names().declarations.get(*at));
        let texts: Vec<String> = declared.map(|declaration| about(analysis, declaration)).collect();
        return Some((texts.join("\n\n---\n\n"), mention.span));
    }
    if let Some(used) = uses.iter().find(|used| used.name == text) {
        let about = used.about().map(|line| format!("\n\n{line}")).unwrap_or_default();
        return Some((format!("the library `{}`{about}", used.source.name), word));
    }
    explained(text).map(|words| (words, word))
}

/// A declaration as it is written, its documentation, and what it means.
fn about(analysis: &Analysis, declaration: &Declaration) -> String {
    let written = analysis.source.snippet(head(analysis, declaration));
    let mut parts = vec![format!("```ntg\n{written}\n```")];
    parts.extend(declaration.doc.clone());
    if let Some(problem) = &analysis.problem {
        parts.extend(facts(analysis, problem, declaration));
    }
    parts.join("\n\n")
}

/// The statement; of one with braces, what stands before them.
fn head(analysis: &Analysis, declaration: &Declaration) -> Span {
    let statement = declaration.statement;
    let is_block = matches!(declaration.kind, Kind::Problem | Kind::Agent | Kind::Phase | Kind::Scenario);
    match analysis.source.slice(statement).find('{') {
        Some(brace) if is_block => Span { start: statement.start, end: statement.start + brace as u32 },
        _ => statement,
    }
}

/// What the compiler knows about a declaration.
fn facts(analysis: &Analysis, problem: &Problem, declaration: &Declaration) -> Option<String> {
    let name = declaration.name.text.as_str();
    match declaration.kind {
        Kind::Param => {
            let parameter = problem.parameters.iter().find(|p| p.name == name)?;
            let values: Vec<String> = parameter.value.iter().map(|v| shown(*v / parameter.unit.factor)).collect();
            let value = if parameter.array { format!("({})", values.join(", ")) } else { values.concat() };
            let size = if parameter.array { format!("{} values, ", parameter.value.len()) } else { String::new() };
            Some(format!("value: {value}{}, {size}{}", bracketed(&parameter.unit), dimension(&parameter.unit)))
        }
        Kind::Variable => {
            let variables = || problem.variables.iter();
            let variable = variables().find(|v| v.span == declaration.name.span);
            let variable = variable.or_else(|| variables().find(|v| v.name == name))?;
            let bounds = bounds(problem, &variable.bounds, &variable.unit);
            Some(format!("a free number{bounds}: {}", dimension(&variable.unit)))
        }
        Kind::Output => {
            let outputs = || problem.phases.iter().flat_map(|phase| &phase.outputs);
            let here = outputs().find(|o| o.span == declaration.name.span);
            let output = here.or_else(|| outputs().find(|o| o.name == name))?;
            let spline = &output.spline;
            let intervals = spline.breakpoints.len().saturating_sub(1);
            let coefficients = intervals * (spline.order - spline.smoothness) + spline.smoothness;
            let size = output.family.map_or(String::new(), |(first, last)| format!("{first} .. {last}, each "));
            Some(format!(
                "{size}{}; a spline of order {} on {intervals} intervals, {} continuous derivatives: {coefficients} coefficients",
                dimension(&output.unit),
                spline.order,
                spline.smoothness.saturating_sub(1),
            ))
        }
        Kind::Let => {
            let named = problem.named.iter().find(|n| n.span == declaration.name.span);
            let named = named.or_else(|| problem.named.iter().find(|n| n.name == name))?;
            let is = words::expression(problem, named.body);
            let unit = match named.unit.factor {
                1.0 => String::new(),
                _ => format!(", shown in{}", bracketed(&named.unit)),
            };
            Some(format!("{}{unit}\n\nin SI units:\n```ntg\n{is}\n```", dimension(&named.unit)))
        }
        Kind::Const => {
            let probe = probe(analysis, name, declaration.scope, &[])?;
            Some(format!("value: {}", probe.expression))
        }
        Kind::Duration => {
            let unit = &problem.independent.unit;
            Some(match dimension(unit).as_str() {
                "" => "a duration".to_owned(),
                words => format!("a duration: {words}"),
            })
        }
        Kind::Domain => Some(format!("the independent variable: {}", dimension(&problem.independent.unit))),
        Kind::Table => {
            let table = problem.tables.iter().find(|t| t.name == name)?;
            Some(format!("a table of {} values: {}", table.values.len(), dimension(&table.unit)))
        }
        _ => None,
    }
}

/// What a derivative in time becomes by the chain rule.
fn expansion(analysis: &Analysis, derivative: &Derivative) -> String {
    let written = analysis.source.snippet(derivative.span);
    let text = analysis.source.slice(derivative.span);
    let known =
        (!derivative.in_function).then(|| probe(analysis, text, derivative.scope, &derivative.indices)).flatten();
    match known {
        Some(probe) => format!(
            "```ntg\n{written}\n```\nderivative in real time, {}; in SI units:\n```ntg\n{}\n```",
            probe.dimension, probe.expression
        ),
        None => format!("```ntg\n{written}\n```\nderivative in real time, by the chain rule"),
    }
}

/// What the compiler says about an expression.
struct Probe {
    expression: String,
    dimension: String,
}

/// Asks the compiler about an expression of a scope, by naming it in a copy of the spec.
fn probe(analysis: &Analysis, text: &str, scope: usize, indices: &[Span]) -> Option<Probe> {
    let scope = analysis.names().scopes.get(scope)?;
    let family = match indices {
        [] => String::new(),
        [one] => format!("[{}]", analysis.source.slice(*one)),
        _ => return None,
    };
    let mut copy = analysis.source.clone();
    let brace = copy.slice(scope.span).rfind('}')? + scope.span.start as usize;
    copy.text.insert_str(brace, &format!("\nlet {PROBE}{family} = {text};\n"));
    let spec = syntax::parse(&copy).ok()?;
    let (problem, _) = model::build(&spec, &copy, analysis.loader());
    let problem = problem?;
    if let Some(named) = problem.named.iter().find(|named| named.name == PROBE) {
        let expression = words::expression(&problem, named.body);
        return Some(Probe { expression, dimension: dimension(&named.unit) });
    }
    None
}

fn dimension(unit: &Unit) -> String {
    tools::unit(&unit.symbol).map_or_else(|| format!("a quantity in [{}]", unit.symbol), |(words, _)| words)
}

fn bracketed(unit: &Unit) -> String {
    if unit.symbol.is_empty() { String::new() } else { format!(" [{}]", unit.symbol) }
}

fn bounds(problem: &Problem, bounds: &Bounds, unit: &Unit) -> String {
    let end = |node: Option<_>| node.and_then(|node| problem.dag.is_constant(node)).map(|v| shown(v / unit.factor));
    match (end(bounds.lower), end(bounds.upper)) {
        (None, None) => String::new(),
        (lower, upper) => {
            format!(" in {} .. {}{}", lower.unwrap_or_default(), upper.unwrap_or_default(), bracketed(unit))
        }
    }
}

/// A number with as many digits as people read; conversions of units leave rounding behind.
fn shown(value: f64) -> String {
    let rounded: f64 = format!("{value:.12e}").parse().unwrap_or(value);
    rounded.to_string()
}
