//! What to write instead of loops and ranges as other languages have them.

use super::Here;
use crate::syntax::grammar::Rule;
use crate::syntax::scan::TokenKind;

/// How a loop is written.
const LOOP: &str = "write `for i in 1 .. 3 { ... }`";

impl Here<'_> {
    pub(super) fn advice_on_loops(&self, this: &str, before: &str) -> Option<String> {
        let first = self.first_word()?;
        let has = |rule| self.expected.has(rule);
        let opens = has(Rule::left_brace) || has(Rule::head_end);
        if matches!(this, "to" | "until" | "through") && has(Rule::dots) {
            return self.with_dots();
        }
        if this == ".." && !has(Rule::dots) {
            return self.without_parentheses();
        }
        if this == "{" && before == "in" {
            return Some("a range is written `1 .. 3`".into());
        }
        if this == "{" && matches!(before, "sum" | "prod" | "min" | "max") {
            return Some(format!("the index comes first, in parentheses: `{before}(i in 1 .. 3, r[i])`"));
        }
        if this == "=" && (self.is_behind("sum") || self.is_behind("prod")) && has(Rule::comma) {
            return Some("the index comes first: `sum(i in 1 .. 3, r[i])`".into());
        }
        if first == "while" && self.is_in_relations() {
            return Some(format!("a constraint has no condition: {}, or a phase", super::PART));
        }
        if this == "for" && matches!(self.word(self.index + 1), "t" | "time") && self.is_in_relations() {
            return Some(super::PART.into());
        }
        if this == "for" && has(Rule::semicolon) && self.is_in_relations() {
            let end = self.statement_end();
            return Some(format!("the loop stands around it: `{} {{ ... }}`", self.written(self.index, end)));
        }
        let collects = this == "for" || (this == "[" && self.expected.has_expression() && self.collects());
        if let Some(fold) = ["min", "max"].into_iter().find(|fold| this == "for" && self.is_behind(fold)) {
            return Some(format!("the index comes first: `{fold}(i in 1 .. 3, r[i])`"));
        }
        if first == "let" && collects && !self.is_behind("sum") && !self.is_behind("prod") {
            return Some(self.for_each(self.word(self.statement_start() + 1)));
        }
        if matches!(first, "forall" | "foreach" | "loop" | "repeat") && self.is_in_relations() {
            return Some(LOOP.into());
        }
        if first != "for" {
            return None;
        }
        match this {
            "{" if has(Rule::dots) => Some(format!("a range is written `1 .. {}`", self.last_of(before))),
            "(" if before == "for" => Some(LOOP.into()),
            "," if has(Rule::dots) => Some("a range is written `1 .. 3`".into()),
            "," if opens => {
                Some("each index has a loop of its own: `for i in 1 .. 3 { for j in 1 .. 3 { ... } }`".into())
            }
            _ if opens => {
                let head = self.written(self.statement_start(), self.index);
                Some(format!("what is repeated stands in braces: `{head} {{ ... }}`"))
            }
            "=" => None,
            _ if has(Rule::kw_in) => Some(LOOP.into()),
            _ => None,
        }
    }

    /// How a definition with a value for each index is written.
    pub(super) fn for_each(&self, name: &str) -> String {
        format!("a value for each index is written `let {name}[i in 1 .. 3] = ...;`")
    }

    /// Whether a list is made by a `for`.
    fn collects(&self) -> bool {
        (self.index..self.statement_end()).any(|at| self.word(at) == "for")
    }

    /// The upper end of the range that is meant by `n`, `2` or `range(3)`.
    fn last_of(&self, before: &str) -> String {
        let single = self.index.checked_sub(2).is_some_and(|at| self.word(at) == "in");
        let called = self.index.checked_sub(4).is_some_and(|at| self.word(at) == "range");
        let is_number = self.before.is_some_and(|token| token.kind == TokenKind::Number);
        let is_constant = (1..self.scan.tokens.len()).any(|at| self.word(at - 1) == "const" && self.word(at) == before);
        match (single && (is_number || is_constant), called) {
            (true, _) => before.to_owned(),
            (_, true) => self.word(self.index - 2).to_owned(),
            _ => "3".to_owned(),
        }
    }

    /// `in 1 to 3`
    fn with_dots(&self) -> Option<String> {
        let start = (0..self.index).rev().find(|at| matches!(self.word(*at), "in" | ";" | "{" | "}"))?;
        let end = (self.index..self.scan.tokens.len()).find(|at| matches!(self.word(*at), ";" | "{" | "}" | ","))?;
        let (lower, upper) = (self.written(start + 1, self.index), self.written(self.index + 1, end));
        Some(format!("a range is written `{lower} .. {upper}`"))
    }

    /// `in (1 .. 3)`
    fn without_parentheses(&self) -> Option<String> {
        let open = (1..self.index).rev().find(|at| matches!(self.word(*at), "(" | ";" | "{" | "}"))?;
        let close = (self.index..self.scan.tokens.len()).find(|at| matches!(self.word(*at), ")" | ";" | "{" | "}"))?;
        if self.word(open) != "(" || self.word(close) != ")" || self.word(open - 1) != "in" {
            return None;
        }
        Some(format!("a range is written without brackets: `in {}`", self.written(open + 1, close)))
    }
}
