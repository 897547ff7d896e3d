//! The libraries that a file uses, and names inside libraries.

use unicode_normalization::UnicodeNormalization;

use super::Build;
use super::parts::Parts;
use crate::syntax::ast::{Ident, Use, UseTarget};
use crate::syntax::grammar::{Pair, Rule};

impl Build {
    pub(super) fn uses(&mut self, parts: &mut Parts<'_>) -> Vec<Use> {
        let mut uses = vec![];
        while let Some(pair) = parts.optional(Rule::use_item) {
            uses.push(self.use_item(pair));
        }
        uses
    }

    pub(in crate::syntax) fn use_item(&mut self, pair: Pair<'_>) -> Use {
        let mut span = self.span(&pair);
        let mut parts = Parts::of(pair);
        if let Some(doc) = parts.optional(Rule::doc) {
            span.start = self.span(&doc).end;
        }
        let place = parts.any();
        let target_span = self.span(&place);
        let target = match place.as_rule() {
            Rule::string => UseTarget::File(place.as_str().trim_matches('"').to_owned()),
            _ => UseTarget::Module(Parts::of(place).map(|name| self.name(&name)).collect()),
        };
        let names = parts.optional(Rule::use_names).into_iter().flat_map(Parts::of);
        let names = names.filter(|pair| pair.as_rule() == Rule::name).map(|name| self.name(&name)).collect();
        let alias = parts.optional(Rule::alias).map(|pair| self.name(&Parts::of(pair).required(Rule::name)));
        Use { target, target_span, names, alias, span }
    }

    /// A name behind those of its library: one name, `air::density`, without blanks.
    pub(super) fn qualified(&mut self, qualifier: Option<Pair<'_>>, name: &Pair<'_>) -> Ident {
        let own = self.name(name);
        let Some(qualifier) = qualifier else { return own };
        let span = self.span(&qualifier).to(own.span);
        let mut text: String =
            Parts::of(qualifier).map(|part| part.as_str().nfc().collect::<String>() + "::").collect();
        text.push_str(&own.text);
        Ident { text, span }
    }
}
