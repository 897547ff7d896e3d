//! What to write instead of a bracket that stands where none may: a unit behind what is no number, or before one.

use super::Here;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::grammar::Rule;
use crate::syntax::scan::TokenKind;

impl Here<'_> {
    /// `norm(v) [m/s]`, `3 [m] [s]`, `[m/s] 3`, `m * [N]`, `let z = e in [kJ];`
    pub(super) fn advice_on_units(&self, this: &str, before: &str) -> Option<String> {
        if matches!(this, "in" | "as" | "to") && self.first_word() == Some("let") && self.expected.has(Rule::semicolon)
        {
            return self.as_shown_in();
        }
        if this != "[" {
            return None;
        }
        let close = self.closer(self.index)?;
        let unit = self.written(self.index, close + 1);
        let is_compound = (self.index..close).any(|at| matches!(self.word(at), "*" | "/" | "^"));
        if self.expected.has_expression() {
            let follows = self.scan.tokens.get(close + 1);
            if follows.is_some_and(|token| token.kind == TokenKind::Number) {
                return Some(format!("a unit stands behind its number: `{} {unit}`", self.word(close + 1)));
            }
            let is_term = matches!(before, "minimize" | "maximize");
            if is_term && follows.is_some_and(|token| token.kind == TokenKind::Word) {
                return Some(format!("a term with a unit has a name: `{before} name {unit}: ...;`"));
            }
            let is_factor = matches!(before, "*" | "/") && !self.is_behind_number(1);
            return is_factor.then(|| format!("a unit stands behind a number: `1 {unit}`"));
        }
        let shown = format!("a quantity has its unit already; `let z {unit} = ...;` shows it in another");
        match before {
            "]" if self.is_behind_number(1) => Some(format!(
                "one bracket holds the whole unit: `[{}*{}]`",
                self.bracket_before()?,
                self.written(self.index + 1, close)
            )),
            "]" | ")" if is_compound => Some(shown),
            ")" => Some(format!("{shown}; an element is taken of a name, `der(r[1])`, or of what has one by `let`")),
            _ => None,
        }
    }

    /// `0 .. [kg/m^3]`, `h <= [km]`, `param g = [m/s^2];`: a unit whose number was forgotten.
    pub(super) fn unit_alone(&self) -> Option<Diagnostic> {
        let (this, before) = (self.word(self.index), self.index.checked_sub(1).map(|at| self.word(at))?);
        if this != "[" || !self.expected.has_expression() {
            return None;
        }
        let close = self.closer(self.index)?;
        let unit = self.written(self.index, close + 1);
        let behind = self.word(close + 1);
        let ends = matches!(behind, ";" | "," | ")" | ":" | "<=" | ">=" | "==" | "" | "}" | "{" | "sigma");
        let span = self.scan.tokens[self.index].span.to(self.scan.tokens[close].span);
        let what = if before == ".." || behind == ".." { "bound" } else { "number" };
        let finding = Diagnostic::new(Code::Unexpected, span, format!("a {what} is missing before its unit"));
        match before {
            ".." if ends => {
                let lower = self.lower_end(self.index - 1);
                Some(finding.help(match lower.is_empty() {
                    true => format!("write it: `.. 1 {unit}`"),
                    false => {
                        format!("write it between the dots and the unit; with no upper bound, `{lower} {unit} ..`")
                    }
                }))
            }
            "in" if behind == ".." => Some(finding.help(format!("write it: `in 0 {unit} ..`, or leave the unit out"))),
            "in" | "=" | "==" | "<=" | ">=" if ends => Some(finding.help(format!("write it: `{before} 1 {unit}`"))),
            _ => None,
        }
    }

    /// What stands before the dots of a range, without its unit.
    fn lower_end(&self, dots: usize) -> String {
        let start = (0..dots).rev().find(|at| matches!(self.word(*at), "in" | ";" | "{" | "(" | ","));
        let start = start.map_or(dots, |start| start + 1);
        let unit = (start..dots).find(|at| self.word(*at) == "[" && self.word(dots - 1) == "]");
        self.written(start, unit.unwrap_or(dots))
    }

    /// `let z = e in [kJ];` as `let z [kJ] = e;`
    fn as_shown_in(&self) -> Option<String> {
        let start = self.statement_start();
        let rest =
            (self.index + 1..self.scan.tokens.len()).find(|at| matches!(self.word(*at), ";" | "{" | "}" | ".."))?;
        if self.word(rest) != ";" || self.word(start + 2) != "=" || rest == self.index + 1 {
            return None;
        }
        let unit = self.written(self.index + 1, rest);
        let unit = if unit.starts_with('[') { unit } else { format!("[{unit}]") };
        let value = self.written(start + 3, self.index);
        let name = self.word(start + 1);
        Some(format!("the unit in which it is shown stands behind its name: `let {name} {unit} = {value};`"))
    }

    /// The bracket that closes one in which nothing stands but what a unit is made of.
    fn closer(&self, open: usize) -> Option<usize> {
        let close = (open + 1..self.scan.tokens.len()).find(|at| {
            let kind = self.scan.tokens[*at].kind;
            let is_part = matches!(kind, TokenKind::Word | TokenKind::Number);
            !is_part && !matches!(self.word(*at), "*" | "/" | "^" | "-" | "(" | ")")
        })?;
        let has_symbol = (open..close).any(|at| self.scan.tokens[at].kind == TokenKind::Word);
        (self.word(close) == "]" && has_symbol).then_some(close)
    }

    /// Whether the bracket or sign just before, or the token before that, follows a number.
    fn is_behind_number(&self, back: usize) -> bool {
        let mut at = self.index - back;
        if self.word(at) == "]" {
            while at > 0 && self.word(at) != "[" {
                at -= 1;
            }
        }
        let is_number = |at: usize| self.scan.tokens.get(at).is_some_and(|token| token.kind == TokenKind::Number);
        at > 0 && (is_number(at - 1) || self.word(at - 1) == "]")
    }

    /// What stands in the bracket that closes just before.
    fn bracket_before(&self) -> Option<String> {
        let open = (0..self.index).rev().find(|at| self.word(*at) == "[")?;
        Some(self.written(open + 1, self.index - 1))
    }
}
