//! From a macro's tokens to its expansion, for both forms.
//!
//! Takes the tokens, gives the generated items or errors, and in either case the constants that
//! make cargo watch every file that was read: a build that failed is repeated when one is mended.

use ntg_compiler::codegen;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use proc_macro2::{Span, TokenStream};
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
        Ok(compiled) => codegen::generate_at(&compiled.program, &|name| map.name(name)),
        Err(found) => report::inline(&found, &source, &map),
    };
    let watch = files.watch();
    quote! { #items #watch }
}

/// `ntg_file!("specs/x.ntg")`
pub(crate) fn file(argument: TokenStream) -> TokenStream {
    let place = argument.clone().into_iter().next().map_or_else(Span::call_site, |token| token.span());
    let Ok(literal) = syn::parse2::<syn::LitStr>(argument) else {
        let message = "expected the path of a spec file\nhelp: write `ntg_file!(\"specs/name.ntg\")`, \
                       relative to the crate's Cargo.toml";
        return report::error(message, (place, place));
    };
    let (path, place) = (literal.value(), literal.span());
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
    let items = match ntg_compiler::compile(&source, &tables) {
        Ok(compiled) => codegen::generate_at(&compiled.program, &|_| Span::call_site()),
        Err(found) => report::in_file(&found, &source, place),
    };
    let (watch, watch_tables) = (files.watch(), tables.watch());
    quote! { #items #watch #watch_tables }
}

/// An error that belongs to no token.
fn here(message: &str) -> TokenStream {
    report::error(message, (Span::call_site(), Span::call_site()))
}
