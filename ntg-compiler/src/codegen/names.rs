//! Names as Rust identifiers.
//!
//! Takes names as a spec writes them, gives identifiers that Rust accepts: keywords become raw
//! identifiers, and a name that is taken gets `_` until it is free. The user's names come first,
//! so they change only where Rust itself leaves no choice.

use std::collections::HashSet;

use proc_macro2::{Ident, Span};

/// Rust's keywords of all editions, in order.
const KEYWORDS: [&str; 52] = [
    "Self", "abstract", "as", "async", "await", "become", "box", "break", "const", "continue", "crate", "do", "dyn",
    "else", "enum", "extern", "false", "final", "fn", "for", "gen", "if", "impl", "in", "let", "loop", "macro",
    "match", "mod", "move", "mut", "override", "priv", "pub", "ref", "return", "self", "static", "struct", "super",
    "trait", "true", "try", "type", "typeof", "unsafe", "unsized", "use", "virtual", "where", "while", "yield",
];

/// Keywords that cannot be raw identifiers. The language refuses them as names.
const NEVER_RAW: [&str; 4] = ["Self", "crate", "self", "super"];

/// Names that mean a value wherever they stand in a pattern.
const VALUES: [&str; 4] = ["None", "Some", "Ok", "Err"];

/// The identifier of a name, with a place.
pub(super) fn ident_at(name: &str, span: Span) -> Ident {
    let legal = legal(name);
    match KEYWORDS.binary_search(&legal.as_str()) {
        Ok(_) => Ident::new_raw(&legal, span),
        Err(_) => Ident::new(&legal, span),
    }
}

/// The identifier of a name that stands for nothing in the spec, or for it without a place.
pub(super) fn ident(name: &str) -> Ident {
    ident_at(name, Span::call_site())
}

/// The name itself if it can be an identifier, else with `_` for what cannot stand there.
fn legal(name: &str) -> String {
    let mut legal = String::with_capacity(name.len());
    for c in name.chars() {
        let fits = if legal.is_empty() { unicode_ident::is_xid_start(c) } else { unicode_ident::is_xid_continue(c) };
        if legal.is_empty() && !fits {
            legal.push('n');
        }
        legal.push(if fits || unicode_ident::is_xid_continue(c) { c } else { '_' });
    }
    if legal.is_empty() {
        legal.push('n');
    }
    if NEVER_RAW.contains(&legal.as_str()) {
        legal.push('_');
    }
    legal
}

/// Names in one scope: each is given out once.
#[derive(Default)]
pub(super) struct Scope {
    taken: HashSet<String>, // Looked up, never iterated.
}

impl Scope {
    /// A scope in which some names are ours.
    pub(super) fn with(ours: &[&str]) -> Self {
        Self { taken: ours.iter().chain(&VALUES).map(|name| (*name).to_owned()).collect() }
    }

    /// The name, if it is free and none of `reserved`; else the name with as many `_` after it as
    /// make it so.
    pub(super) fn take(&mut self, name: &str, reserved: impl Fn(&str) -> bool) -> String {
        let mut name = legal(name);
        while reserved(&name) || !self.taken.insert(name.clone()) {
            name.push('_');
        }
        name
    }
}

/// A name in `snake_case`: `VanDerPol` becomes `van_der_pol`.
pub(super) fn snake(name: &str) -> String {
    let mut snake = String::with_capacity(name.len() + 4);
    let mut before = '_';
    let mut chars = name.chars().peekable();
    while let Some(c) = chars.next() {
        let word_starts = c.is_uppercase()
            && before != '_'
            && (!before.is_uppercase() || chars.peek().is_some_and(|next| next.is_lowercase()));
        if word_starts {
            snake.push('_');
        }
        snake.extend(c.to_lowercase());
        before = c;
    }
    snake
}

/// A name in `CamelCase`: `low_observable` becomes `LowObservable`.
pub(super) fn camel(name: &str) -> String {
    name.split('_').filter(|word| !word.is_empty()).map(capitalised).collect()
}

/// The word with a capital first letter.
pub(super) fn capitalised(word: &str) -> String {
    let mut chars = word.chars();
    chars.next().map(|first| first.to_uppercase().chain(chars).collect()).unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keywords_are_raw_and_in_order() {
        assert!(KEYWORDS.is_sorted());
        assert_eq!(ident("type").to_string(), "r#type");
        assert_eq!(ident("ψ").to_string(), "ψ");
        assert_eq!(ident("self").to_string(), "self_");
        assert_eq!(ident("1 bad").to_string(), "n1_bad");
    }

    #[test]
    fn a_name_is_given_out_once_and_ours_never() {
        let mut scope = Scope::with(&["values"]);
        let given: Vec<String> = ["x", "values", "x", "None"].iter().map(|name| scope.take(name, |_| false)).collect();
        assert_eq!(given, ["x", "values_", "x_", "None_"]);
    }

    #[test]
    fn styles() {
        assert_eq!(snake("VanDerPol"), "van_der_pol");
        assert_eq!(snake("UAVRoute2"), "uav_route2");
        assert_eq!(camel("low_observable"), "LowObservable");
    }
}
