//! A problem around a library, in which its functions are tried.
//!
//! Takes a library, gives the text of a spec with a parameter of the stated size and unit for each argument, and a
//! `let` for each function. A function whose arguments state nothing takes any, so it is tried where it is used.

use std::fmt::Write;

use crate::source::{Source, Span};
use crate::syntax::ast::*;

/// What the library is called in the trial.
pub(super) const NAME: &str = "library_";

/// The problem.
pub(super) fn around(library: &Library) -> Source {
    let mut text = String::from("problem Trial { duration T = 1 [s];\n");
    let put =
        |text: &mut String, words: std::fmt::Arguments<'_>| text.write_fmt(words).expect("strings take everything");
    for (k, item) in library.items.iter().enumerate() {
        let ItemKind::Function(function) = &item.kind else { continue };
        let is_stated = function.parameters.iter().all(|argument| argument.unit.is_some() || argument.shape.is_some());
        let sizes: Option<Vec<String>> = function.parameters.iter().map(size).collect();
        let Some(sizes) = sizes.filter(|_| is_stated) else { continue };
        let mut arguments: Vec<String> = vec![];
        for (j, (argument, size)) in function.parameters.iter().zip(sizes).enumerate() {
            let unit = argument.unit.as_ref().map_or(String::new(), |unit| format!(" [{}]", factors(&unit.factors)));
            put(&mut text, format_args!("param a_{k}_{j}{size} = 1{unit};\n"));
            arguments.push(format!("a_{k}_{j}"));
        }
        let call = format!("{NAME}::{}({})", function.name.text, arguments.join(", "));
        put(&mut text, format_args!("let f_{k} = {call};\n"));
    }
    text.push_str("output x: spline(order = 2, intervals = 1); minimize integral(x^2) / 1 [s]; }\n");
    Source::new("trial", text)
}

/// The problem, which uses the library under test.
pub(super) fn using(mut spec: Spec) -> Spec {
    let nowhere = Span::new(0, 0);
    let alias = Some(Ident { text: NAME.to_owned(), span: nowhere });
    let target = UseTarget::File(String::new());
    spec.uses = vec![Use { target, target_span: nowhere, names: vec![], alias, span: nowhere }];
    spec
}

/// The size of an argument, if it is written in numbers.
fn size(argument: &Argument) -> Option<String> {
    let Some(shape) = &argument.shape else { return Some(String::new()) };
    let axes: Option<Vec<String>> =
        shape.axes.iter().map(|axis| axis.last.signed_literal().map(|number| number.value.to_string())).collect();
    axes.map(|axes| format!("[{}]", axes.join(", ")))
}

/// A unit as it is written.
fn factors(factors: &[UnitFactor]) -> String {
    let mut text = String::new();
    for (k, factor) in factors.iter().enumerate() {
        let base = match &factor.base {
            UnitBase::One => "1".to_owned(),
            UnitBase::Symbol(symbol) => symbol.text.clone(),
            UnitBase::Group(inner) => format!("({})", self::factors(inner)),
        };
        let sign = match (k, factor.op) {
            (0, _) => "",
            (_, MulOp::Multiply) => "*",
            (_, MulOp::Divide) => "/",
        };
        let power = if factor.power == 1 { String::new() } else { format!("^{}", factor.power) };
        text.push_str(&format!("{sign}{base}{power}"));
    }
    text
}
