//! What to write instead of times, ends, names and prices of constraints as newcomers have them.

use super::Here;
use super::openers::BLOCKS;
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::grammar::Rule;
use crate::syntax::recover::text;
use crate::syntax::scan::TokenKind;
use crate::syntax::words::is_reserved;

/// The name of a constraint or of a term that is a word of the language.
pub(super) fn reserved_name(span: Span, word: &str) -> Diagnostic {
    let finding = Diagnostic::new(Code::ReservedWord, span, format!("`{word}` is a reserved word"));
    let name = format!("choose another name, such as `{word}_`");
    match word {
        "start" | "initial" => finding.help(format!("{name}; what holds at the start stands in `initial {{ }}`")),
        "end" | "final" => finding.help(format!("{name}; what holds at the end stands in `final {{ }}`")),
        _ => finding.help(name),
    }
}

impl Here<'_> {
    /// `final: x == 1;` in a block, `minimize duration: T;`
    pub(super) fn reserved_label(&self) -> Option<Diagnostic> {
        let label = self.before.filter(|token| token.kind == TokenKind::Word)?;
        let word = text(self.scan, label);
        if self.word(self.index) != ":" || !is_reserved(word) {
            return None;
        }
        let in_front = self.word((self.index - 1).checked_sub(1)?);
        let names_a_term = matches!(in_front, "minimize" | "maximize");
        let names_a_constraint = matches!(in_front, ";" | "{" | "}" | ":") && self.is_in_relations();
        (names_a_term || names_a_constraint).then(|| reserved_name(label.span, word))
    }

    /// `start { ... }`, `at end { ... }`, `x(end)`, `at 3 [s]: ...`
    pub(super) fn advice_on_times(&self, this: &str, before: &str) -> Option<String> {
        let first = self.first_word()?;
        let has = |rule| self.expected.has(rule);
        let opens = has(Rule::left_brace) || has(Rule::head_end);
        let is_word = self.token.is_some_and(|token| token.kind == TokenKind::Word);
        if first == "start" && has(Rule::equals) && has(Rule::kw_in) && (is_word || matches!(this, "{" | ":" | "(")) {
            return Some("what holds at the start stands in `initial { ... }`; when it begins is `start = 5;`".into());
        }
        if this == ")" && self.index > 2 && self.word(self.index - 2) == "(" {
            let name = self.word(self.index - 3);
            match before {
                "end" | "final" => return Some(format!("write `final({name})`")),
                "start" | "initial" => return Some(format!("write `initial({name})`")),
                _ => {}
            }
        }
        if first != "at" || self.is_in_relations() {
            return None;
        }
        let start = self.statement_start();
        let time = self.word(start + 1);
        let names_time = matches!(time, "t" | "time");
        let head = |from: usize, to: usize| format!("`at {} {{ ... }}`", self.written(from, to));
        let brace = || (self.index..self.statement_end() + 1).find(|at| matches!(self.word(*at), "{" | ";"));
        Some(match (this, before) {
            ("{", "end" | "final") => "what holds at the end stands in `final { ... }`".into(),
            ("{", "start" | "initial") => "what holds at the start stands in `initial { ... }`".into(),
            (_, "at") => "write the time: `at 2.5 [s] { ... }`".into(),
            ("==" | "<=" | ">=", ")") if time == "(" => {
                "a value at one time is held to something in `temporal { }`, or with `x` alone in `at time { ... }`"
                    .into()
            }
            (">=", _) if names_time && opens => {
                format!("write `trajectory from {} {{ ... }}`", self.written(self.index + 1, brace()?))
            }
            ("<=", _) if names_time && opens => {
                format!("write `trajectory to {} {{ ... }}`", self.written(self.index + 1, brace()?))
            }
            ("=" | "==" | "<=" | ">=", _) if !names_time && opens => {
                "a time that is not known before the solve is the end of a phase: `phase a { final { x == 1; } }`"
                    .into()
            }
            ("=" | "==", _) => return None,
            (_, "time" | "t") if opens => format!("write the time alone: {}", head(self.index, brace()?)),
            (",", _) if opens => format!("each time has a block of its own: {}", head(start + 1, self.index)),
            _ if opens => format!("what holds there stands in braces: {}", head(start + 1, self.index)),
            _ => return None,
        })
    }

    /// Prices behind their constraints, signs that are none, constraints that compare nothing.
    pub(super) fn advice_on_constraints(&self, this: &str, before: &str) -> Option<String> {
        let first = self.first_word().unwrap_or_default();
        let has = |rule| self.expected.has(rule);
        if first == "guess" && has(Rule::left_brace) {
            return Some("guesses stand in braces: `guess { x = ...; }`".into());
        }
        if matches!(first, "minimize" | "maximize")
            && matches!(this, "subject" | "s" | "st" | "such" | "where" | "with" | "under")
            && has(Rule::semicolon)
        {
            return Some(format!("the objective ends with `;`; {BLOCKS}"));
        }
        if !self.is_in_relations() {
            return None;
        }
        let guesses = self.is_within("guess");
        Some(match (before, this) {
            (_, "in" | "<=" | ">=") if guesses && has(Rule::equals) => {
                format!("a guess is one value, `{before} = ...;`; bounds stand where it is declared")
            }
            ("{" | ";" | "}", "der" | "initial" | "final" | "integral") if guesses => {
                "guess the function itself, such as `x = 1 - tau;`: its derivatives and ends follow".into()
            }
            _ if guesses => return None,
            ("==", "=") => "write `==`".into(),
            ("<", ">") => "say which side is meant, with `<=` or `>=`".into(),
            ("==" | "<=" | ">=", ";") => {
                format!("write what it is held against: `{} 1;`", self.written(self.statement_start(), self.index))
            }
            (_, "during" | "on" | "when" | "while" | "until" | "before" | "after" | "from" | "to" | "at")
                if has(Rule::semicolon) && !self.is_within("measure") =>
            {
                super::PART.into()
            }
            (_, "soft") if has(Rule::semicolon) => {
                let constraint = self.written(self.statement_start(), self.index);
                format!("the price stands in front: `soft(w): {constraint};`")
            }
            (_, "<=" | ">=" | "==") if first == "soft" && has(Rule::right_parenthesis) => {
                "the price stands in the parentheses, and the constraint behind them: `soft(w): x <= 1;`".into()
            }
            (")", ":") if has(Rule::relation) && first != "soft" && self.is_behind("soft") => {
                format!("the price stands before the name: `soft(w): {first}: ...;`")
            }
            (_, "sigma" | ";") if has(Rule::relation) && self.is_within("measure") => {
                "a measurement is an equality: `at(2 [s], x) == 3 [m] sigma 0.1 [m];`".into()
            }
            (_, ";") if has(Rule::relation) && first != "soft" => {
                "a constraint compares: `a == b`, `a <= b` or `a in lo .. hi`".into()
            }
            (_, "between") if has(Rule::relation) => format!("a range is written `{before} in 0 .. 1`"),
            (_, ",") if has(Rule::relation) && !has(Rule::right_parenthesis) && !has(Rule::semicolon) => {
                "each constraint is a statement of its own: `a <= b;  c <= d;`".into()
            }
            _ => return None,
        })
    }
}
