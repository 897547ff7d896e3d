//! Two statements of a block without a `;` between them: `x == 0 z == 0`.

use super::Here;
use crate::syntax::grammar::Rule;
use crate::syntax::scan::TokenKind;

/// What declares the names that follow.
const DECLARING: [&str; 11] =
    ["state", "input", "output", "variable", "param", "const", "let", "duration", "table", "continuation", "for"];
/// Functions with which a side of a constraint begins.
const BEGINNING: [&str; 8] = ["der", "integral", "initial", "final", "norm", "dot", "at", "sqrt"];

impl Here<'_> {
    /// Whether a complete relation stands before this token, and with it another one begins.
    pub(super) fn begins_relation(&self) -> bool {
        let is_word = self.token.is_some_and(|token| token.kind == TokenKind::Word);
        if !is_word || !self.expected.has(Rule::operator) || !self.is_in_relations() {
            return false;
        }
        // Something that is no part of the language stands between, and is told of.
        let between = self.before.zip(self.token).map(|(before, token)| (before.span.end, token.span.start));
        let told = |(from, to): (u32, u32)| self.scan.found.iter().any(|f| from <= f.span.start && f.span.end <= to);
        if between.is_some_and(told) {
            return false;
        }
        let this = self.word(self.index);
        // Behind its constraint neither begins another one: `x >= 0 for i in 1 .. 3;`, `x <= 1 soft 3;`
        let rest = |sign: &str| (self.index..self.statement_end() + 1).any(|at| self.word(at) == sign);
        if (this == "for" && rest("{")) || (this == "soft" && rest(":")) {
            return self.relates(self.statement_start(), self.index);
        }
        if this == "for" || this == "soft" {
            return false;
        }
        let begins = match self.word(self.index + 1) {
            "(" => BEGINNING.contains(&this) || self.is_declared(this),
            _ => self.is_declared(this),
        };
        begins && self.relates(self.statement_start(), self.index) && self.relates(self.index + 1, self.statement_end())
    }

    /// Whether the innermost open brace is that of a block of relations.
    pub(super) fn is_in_relations(&self) -> bool {
        let block = self.block_around();
        matches!(
            block,
            Some("initial" | "trajectory" | "final" | "temporal" | "dynamics" | "measure" | "at" | "guess" | "for")
        )
    }

    /// Whether another word stands where `sigma` does behind a measurement.
    pub(super) fn is_deviation(&self, this: &str) -> bool {
        let is_word =
            matches!(this, "std" | "sd" | "stddev" | "stdev" | "error" | "uncertainty" | "noise" | "weight" | "with");
        is_word && self.expected.has(Rule::semicolon) && matches!(self.block_around(), Some("measure" | "for"))
    }

    /// Whether something is held against something among these tokens.
    fn relates(&self, from: usize, to: usize) -> bool {
        (from..to).any(|at| matches!(self.word(at), "==" | "<=" | ">=" | "=" | "in"))
    }

    /// The token that ends the statement.
    pub(super) fn statement_end(&self) -> usize {
        let last = self.scan.tokens.len();
        (self.index..last).find(|at| matches!(self.word(*at), ";" | "{" | "}")).unwrap_or(last)
    }

    /// Whether a statement that declares names has this one.
    pub(super) fn is_declared(&self, name: &str) -> bool {
        let (mut declares, mut begins, mut depth) = (false, true, 0_usize);
        for at in 0..self.scan.tokens.len() {
            let word = self.word(at);
            if begins {
                declares = DECLARING.contains(&word);
            }
            begins = matches!(word, ";" | "{" | "}");
            // What follows a `:` or `=` is no declared name.
            declares &= !matches!(word, ":" | "=");
            match word {
                // Units, sizes and arguments.
                "[" | "(" => depth += 1,
                "]" | ")" => depth = depth.saturating_sub(1),
                _ if declares && depth == 0 && word == name => return true,
                _ => {}
            }
        }
        false
    }
}
