//! What to write instead of conditions, and of functions with steps, as other languages have them.

use super::Here;
use crate::syntax::grammar::Rule;
use crate::syntax::recover::text;

/// Words between conditions in other languages.
const JOINING: [&str; 5] = ["and", "or", "not", "xor", "where"];

/// How a whole conditional is written.
const FORM: &str = "write `if a <= b { ... } else { ... }`";

/// What constraints have in the place of a condition.
const PART: &str = "over a part of the time write `trajectory from a to b { ... }`, or a phase";

impl Here<'_> {
    pub(super) fn advice_on_conditions(&self, this: &str, before: &str) -> Option<String> {
        let has = |rule| self.expected.has(rule);
        let is_relation = matches!(this, "==" | "<=" | ">=" | "<" | ">" | "!=" | "=");
        if matches!(this, "if") && has(Rule::semicolon) && has(Rule::operator) {
            return Some(format!("a constraint has no condition: {PART}"));
        }
        if (is_relation || this == "in") && has(Rule::right_brace) && this != "=" && !self.opened_behind_if() {
            let part = self.part_behind_if().unwrap_or_else(|| PART.to_owned());
            return Some(format!("an `if` is a value and holds no constraints: {part}"));
        }
        let advice = match (this, before) {
            (_, word) | (word, _) if JOINING.contains(&word) && has(Rule::semicolon) => {
                Some("write two statements: all of them hold")
            }
            (_, word) | (word, _) if JOINING.contains(&word) && (has(Rule::relation) || has(Rule::left_brace)) => {
                Some("a condition is one relation: write one `if` inside the other, or `a in lo .. hi`")
            }
            ("then", _) if has(Rule::left_brace) => Some(FORM),
            ("elseif" | "elif" | "elsif", _) => Some("write `else if`"),
            (_, "}") if has(Rule::kw_else) => Some("an `if` is a value and has an `else`: one is needed either way"),
            ("{", _) if has(Rule::relation) && self.is_behind("if") => {
                Some("a condition compares: `if a <= b { ... }`")
            }
            ("{", "=") if self.is_behind("fn") => {
                Some("without `=` before the braces: `fn f(x) { let y = 2 * x; y^2 }`")
            }
            ("{", _) if has(Rule::expression) && before == "smooth" => {
                Some("write the width over which the branches blend: `smooth 2 [m]`")
            }
            (";", _) if has(Rule::right_brace) => {
                Some("the value of a block is its last expression, without a `;` behind it")
            }
            ("=", _) if has(Rule::right_brace) => Some("a step begins with `let`"),
            (_, "return") => Some("the last expression of a block is its value: leave `return` out"),
            (":", _) if has(Rule::argument) || (has(Rule::comma) && self.is_behind("fn")) => {
                Some("units stand in brackets behind the name, sizes before them: `fn f(r[3] [m], k)`")
            }
            (":" | "-", _) if has(Rule::left_brace) && self.is_behind("fn") => Some(
                "the size and the unit of the value stand in brackets behind the arguments: `fn f(x) [3] [m] = ...`",
            ),
            _ if is_relation && self.opened_behind_if() => {
                Some("a condition stands without parentheses: `if a <= b { ... }`")
            }
            _ => None,
        };
        advice.map(str::to_owned)
    }

    /// The part of a trajectory that is meant by `if t >= 6 [h] {`, which is still open.
    fn part_behind_if(&self) -> Option<String> {
        let brace = (0..self.index).rev().find(|at| self.word(*at) == "{")?;
        let start = (0..brace).rev().find(|at| self.word(*at) == "if")?;
        if self.word(start + 1) != "t" {
            return None;
        }
        let bound = self.written(start + 3, brace);
        let part = match self.word(start + 2) {
            ">=" | ">" => format!("from {bound}"),
            "<=" | "<" => format!("to {bound}"),
            _ => return None,
        };
        Some(format!("write `trajectory {part} {{ ... }}`"))
    }

    /// Whether the statement has that word before the place.
    pub(super) fn is_behind(&self, word: &str) -> bool {
        let before = self.scan.tokens[..self.index].iter().rev().map(|token| text(self.scan, token));
        before.take_while(|text| !matches!(*text, ";" | "}")).any(|text| text == word)
    }

    /// Whether the innermost open parenthesis stands behind `if`.
    fn opened_behind_if(&self) -> bool {
        let mut depth = 0_usize;
        for at in (1..self.index.min(self.scan.tokens.len())).rev() {
            match text(self.scan, &self.scan.tokens[at]) {
                ")" | "]" | "}" => depth += 1,
                "(" if depth == 0 => return text(self.scan, &self.scan.tokens[at - 1]) == "if",
                ";" | "{" if depth == 0 => return false,
                "(" | "[" | "{" => depth = depth.saturating_sub(1),
                _ => {}
            }
        }
        false
    }
}
