//! From a macro's tokens to its expansion, for both forms.
//!
//! Takes the tokens, gives the generated items or errors, and in either case the constants that
//! make cargo watch every file that was read: a build that failed is repeated when one is mended.

use ntg_compiler::model::{Given, Loader};
use ntg_compiler::source::Source;
use ntg_compiler::{Compiled, codegen};
use proc_macro2::{Span, TokenStream, TokenTree};
use quote::quote;

use crate::include::Files;
use crate::report;
use crate::span_map::SpanMap;

/// `ntg! { problem ... }`
pub(crate) fn inline(spec: TokenStream) -> TokenStream {
    let map = SpanMap::layout(spec);
    let source = Source::new(map.file().unwrap_or_else(|| "ntg!".into()), map.text.clone());
    let files = match Files::of_crate() {
        Ok(files) => files,
        Err(message) => return here(&message),
    };
    let items = match ntg_compiler::compile(&source, &files) {
        Ok(compiled) => {
            let form = parametric(&compiled, &source, &files, &[]);
            let items = codegen::generate_at(&compiled.program, &|name| map.name(name));
            quote! { #items #form }
        }
        Err(found) => report::inline(&found, &source, &map),
    };
    let watch = files.watch();
    quote! { #items #watch }
}

/// `ntg_file!("specs/x.ntg")`, `ntg_file!("specs/x.ntg", n = 50)`
pub(crate) fn file(argument: TokenStream) -> TokenStream {
    let Called { path, place, given, places } = match Called::of(argument) {
        Ok(called) => called,
        Err((message, place)) => return report::error(message, (place, place)),
    };
    let files = match Files::of_crate() {
        Ok(files) => files,
        Err(message) => return here(&message),
    };
    let text = match files.load(&path) {
        Ok(text) => text,
        Err(message) => {
            let help = "the path is relative to the folder of the crate's Cargo.toml";
            return report::error(&format!("cannot read the spec {message}\nhelp: {help}"), (place, place));
        }
    };
    let source = Source::new(path, text);
    let tables = files.beside(&source.name);
    let items = match ntg_compiler::compile_with(&source, &tables, &given) {
        Ok(compiled) => {
            let form = parametric(&compiled, &source, &tables, &given);
            let items = codegen::generate_at(&compiled.program, &|_| Span::call_site());
            quote! { #items #form }
        }
        Err(found) => report::in_file(&found, &source, place, &places),
    };
    let (watch, watch_tables) = (files.watch(), tables.watch());
    quote! { #items #watch #watch_tables }
}

/// What was read, for `Parametric`: nothing remains of it where `ntg` is built without its feature `sensitivity`.
fn parametric(compiled: &Compiled, source: &Source, files: &Files, given: &[Given]) -> TokenStream {
    let problem = codegen::type_name(&compiled.program.structure.name);
    let (name, text, files) = (&source.name, &source.text, files.texts());
    let given = given.iter().map(|Given { name, text }| quote! { (#name, #text) });
    quote! { ::ntg::parametric! { #problem, #name, #text, #files, [#(#given),*] } }
}

/// What stands between the parentheses of `ntg_file!`.
struct Called {
    path: String,
    place: Span,
    given: Vec<Given>,
    /// The names of the constants, and where they stand.
    places: Vec<(String, Span)>,
}

impl Called {
    /// The path, and the constants behind it; or what is wrong, and where.
    fn of(argument: TokenStream) -> Result<Self, (&'static str, Span)> {
        const PATH: &str = "expected the path of a spec file\nhelp: write `ntg_file!(\"specs/name.ntg\")`, \
                            relative to the crate's Cargo.toml";
        const CONSTANT: &str = "expected a constant and its value\nhelp: write `ntg_file!(\"specs/name.ntg\", n = 50)`, \
                                or with a unit `g = 3.7 [m/s^2]`";
        const TWICE: &str = "this constant is set twice\nhelp: remove one of the two";
        let mut tokens = argument.into_iter();
        let first = tokens.next();
        let place = first.as_ref().map_or_else(Span::call_site, TokenTree::span);
        let literal = syn::parse2::<syn::LitStr>(first.into_iter().collect()).map_err(|_| (PATH, place))?;
        let mut called = Self { path: literal.value(), place: literal.span(), given: vec![], places: vec![] };
        let mut last = tokens.next();
        while let Some(comma) = last.take() {
            if !is_mark(&comma, ',') {
                return Err((if called.given.is_empty() { PATH } else { CONSTANT }, comma.span()));
            }
            let Some(name) = tokens.next() else { break };
            let place = name.span();
            let is_set = matches!(name, TokenTree::Ident(_)) && tokens.next().is_some_and(|token| is_mark(&token, '='));
            let value: TokenStream = tokens
                .by_ref()
                .take_while(|token| {
                    last = is_mark(token, ',').then(|| token.clone());
                    last.is_none()
                })
                .collect();
            if !is_set || value.is_empty() {
                return Err((CONSTANT, place));
            }
            if called.given.iter().any(|given| name.to_string() == given.name) {
                return Err((TWICE, place));
            }
            called.places.push((name.to_string(), place));
            called.given.push(Given { name: name.to_string(), text: value.to_string() });
        }
        Ok(called)
    }
}

fn is_mark(token: &TokenTree, mark: char) -> bool {
    matches!(token, TokenTree::Punct(punct) if punct.as_char() == mark)
}

/// An error that belongs to no token.
fn here(message: &str) -> TokenStream {
    report::error(message, (Span::call_site(), Span::call_site()))
}
