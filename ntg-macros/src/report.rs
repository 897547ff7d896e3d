//! Findings as rustc's errors.
//!
//! Takes diagnostics, gives `compile_error!`s. The inline form underlines the tokens themselves,
//! from the first to the last; the file form, where rustc can underline the path only, carries a
//! picture of the place with `path:line:column`.
//!
//! Warnings and notes are for `ntg check`: what a macro says about them cannot be silenced where
//! it is meant, and fails builds that deny warnings.

use ntg_compiler::diagnostic::{Diagnostic, Diagnostics, Severity};
use ntg_compiler::source::Source;
use proc_macro2::{Span, TokenStream};
use quote::{quote, quote_spanned};

use crate::span_map::SpanMap;

/// The findings in an inline spec, each under its own tokens.
pub(crate) fn inline(found: &Diagnostics, source: &Source, map: &SpanMap) -> TokenStream {
    errors(found)
        .map(|finding| {
            let range = finding.span.start as usize..finding.span.end as usize;
            error(&in_words(finding, source), map.ends(range))
        })
        .collect()
}

/// The findings in a spec file, all under the path in the macro's call, or under the constant there that they are about.
pub(crate) fn in_file(found: &Diagnostics, source: &Source, path: Span, constants: &[(String, Span)]) -> TokenStream {
    let place = |finding: &Diagnostic| {
        let about =
            |name: &str| [format!("`{name}`"), format!("`{name} = ")].iter().any(|text| finding.message.contains(text));
        constants.iter().find(|(name, _)| about(name)).map_or(path, |(_, place)| *place)
    };
    errors(found).map(|finding| error(&as_picture(finding, source), (place(finding), place(finding)))).collect()
}

/// An error in words under the tokens `first ..= last`.
pub(crate) fn error(message: &str, (first, last): (Span, Span)) -> TokenStream {
    // rustc underlines a macro's call from the first token of its path to its closing bracket.
    let path = quote_spanned! { first=> ::core::compile_error! };
    let message = quote_spanned! { last=> { #message } };
    quote! { #path #message }
}

fn errors(found: &Diagnostics) -> impl Iterator<Item = &Diagnostic> {
    found.iter().filter(|finding| finding.severity == Severity::Error)
}

/// The headline; below it the labels, with their places unless they are the finding's own, and
/// the help.
fn in_words(finding: &Diagnostic, source: &Source) -> String {
    let mut text = headline(finding);
    for (span, label) in &finding.labels {
        let place = source.place(span.start);
        let (line, column, snippet) = (place.line, place.column, source.snippet(*span));
        text.push_str(&match *span == finding.span {
            true => format!("\nhere: {label}"),
            false => format!("\nnote: {label}: `{snippet}` in line {line}, column {column}"),
        });
    }
    for library in &finding.libraries {
        let name = &library.source.name;
        let own = library.span.map(|span| (span, "this is about"));
        for (span, label) in own.into_iter().chain(library.labels.iter().map(|(span, text)| (*span, text.as_str()))) {
            let place = library.source.place(span.start);
            let (line, column, snippet) = (place.line, place.column, library.source.snippet(span));
            text.push_str(&format!("\nnote: {label}: `{snippet}` in {name}, line {line}, column {column}"));
        }
    }
    if let Some(help) = &finding.help {
        text.push_str(&format!("\nhelp: {help}"));
    }
    text
}

/// The headline; below it the picture that the command line shows, without its own headline.
fn as_picture(finding: &Diagnostic, source: &Source) -> String {
    let picture = finding.render(source);
    let below = picture.lines().skip_while(|line| !line.trim_start().starts_with("-->"));
    let below: Vec<&str> = below.collect();
    format!("{}\n{}", headline(finding), below.join("\n"))
}

fn headline(finding: &Diagnostic) -> String {
    format!("{} [{}]", finding.message, finding.code)
}
