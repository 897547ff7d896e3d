//! What to write instead of forms of other languages that the grammar gets stuck in.

use super::Here;
use crate::syntax::grammar::Rule;
use crate::syntax::scan::{Token, TokenKind};

impl Here<'_> {
    /// Ranges, slices, definitions and splines as other languages write them.
    pub(super) fn advice_on_habits(&self, this: &str, before: &str) -> Option<&'static str> {
        let is = |kind: TokenKind, token: Option<&Token>| token.is_some_and(|token| token.kind == kind);
        let first = self.first_word().unwrap_or_default();
        Some(match (before, this) {
            ("[" | ",", ":") => {
                "a range is written `1 .. 3`; indices that are left out at the end give the rest: `A[1]` is a row"
            }
            ("end", "]") => "the last element is written by its number or its constant: `r[3]`, `r[n]`",
            (_, ":") if self.expected.has(Rule::equals) => "a definition is written with one `=`",
            (_, ":") if self.expected.has(Rule::dots) => "a range is written `1 .. 3`",
            (_, "=") if self.expected.has(Rule::kw_in) && first == "for" => "write `for i in 1 .. 3 { ... }`",
            (_, "{") if self.expected.has(Rule::dots) => "a range is written `1 .. 3`",
            (_, ";") if first == "output" && self.expected.has(Rule::colon) => {
                "an output says its spline, `output z: spline(order = 5, intervals = 8);`; a `state` needs none"
            }
            ("(", _)
                if is(TokenKind::Number, self.token)
                    && matches!(first, "output" | "state" | "input" | "collocation") =>
            {
                "settings have names: `spline(order = 5, intervals = 8)`"
            }
            _ if is(TokenKind::Word, self.token)
                && is(TokenKind::Word, self.before)
                && self.expected.has(Rule::operator) =>
            {
                "a product has its sign, `a * b`"
            }
            _ => return None,
        })
    }
}
