//! What to write instead of ranges, bounds and durations as other languages have them, with the ends as they were written.

use super::Here;
use crate::syntax::grammar::Rule;
use crate::syntax::recover::text;
use crate::syntax::scan::TokenKind;

/// Bounds that are none.
const NO_BOUNDS: [&str; 6] = ["inf", "Inf", "INF", "infinity", "Infinity", "oo"];

/// The most tokens of a text that is shown again.
const MOST_SHOWN: usize = 24;

impl Here<'_> {
    pub(super) fn advice_on_ranges(&self, this: &str, before: &str) -> Option<String> {
        let first = self.first_word().unwrap_or_default();
        let has = |rule| self.expected.has(rule);
        let bounded = matches!(first, "state" | "input" | "output" | "variable");
        let course = "a course from one value to another is `a + (b - a) * tau`, a vector `(1, 0, 0)`";
        Some(match this {
            "[" if before == "in" => self.range_from(self.index),
            "[" if has(Rule::indices) || !self.expected.has_expression() => return None,
            "[" | ".." if self.is_within("guess") => course.into(),
            _ if matches!(before, ")" | "]") && has(Rule::dots) && self.opener_behind_in().is_some() => {
                self.range_from(self.opener_behind_in()?)
            }
            ".." if first == "duration" && has(Rule::semicolon) => self.with_in(),
            "=" if first == "variable" && self.rest_has("..") => self.with_in(),
            _ if first == "duration" && has(Rule::equals) && has(Rule::kw_in) => {
                "write `duration T = 5;` for a fixed one, `duration T in 1 .. 9;` for a free one".into()
            }
            ";" | "in" | "<=" | ">=" if matches!(first, "param" | "const") && has(Rule::equals) => {
                let name = self.word(self.statement_start() + 1);
                format!("it has a value, `{first} {name} = 1;`; what is sought between bounds is a `variable`")
            }
            "<=" | ">=" if bounded && has(Rule::kw_in) => {
                "bounds are written `in 0 .. 1`, with one end `in 0 ..` or `in .. 1`".into()
            }
            "=" if matches!(first, "state" | "input" | "output") && has(Rule::kw_in) => {
                let behind_size =
                    if before == "]" { self.size_before().and_then(|open| open.checked_sub(1)) } else { None };
                let name = self.word(behind_size.unwrap_or(self.index - 1));
                format!(
                    "a value at the start is a condition, `initial {{ {name} == 0; }}`; bounds are written `in 0 .. 1`"
                )
            }
            "(" if bounded && self.word(self.index + 2) == "=" => {
                "bounds are written `in 0 .. 1`, a unit `[m]`, a value at the start in `initial { }`".into()
            }
            _ if before == ":" && has(Rule::course) => {
                "write `held` for one value in each interval, `continuous` for no jumps, or a `spline(...)`".into()
            }
            _ if before == ":" && has(Rule::kw_spline) => {
                "bounds are written `in 0 .. 1`; behind the colon stands a `spline(...)`".into()
            }
            "," | ";" if has(Rule::dots) && has(Rule::operator) => {
                "a range is written `in 0 .. 1`, with one end `in 0 ..` or `in .. 1`".into()
            }
            _ => return None,
        })
    }

    /// `param a = 1, b = 2;`, `let a, b = 3;`: what has a value has a statement of its own.
    pub(super) fn advice_on_lists(&self, this: &str) -> Option<String> {
        let first = self.first_word()?;
        let is_name = |at: usize| self.scan.tokens.get(at).is_some_and(|token| token.kind == TokenKind::Word);
        let lists = matches!(first, "state" | "input" | "output" | "variable") && self.expected.has(Rule::comma);
        if lists && is_name(self.index) && this != "in" && self.word(self.index + 1) == "in" {
            return Some(format!("names of a list are parted by commas: `, {this} in ...`"));
        }
        if !matches!(first, "param" | "const" | "let" | "continuation") {
            return None;
        }
        if this != "," || !is_name(self.index + 1) {
            return None;
        }
        let has_value = self.expected.has(Rule::semicolon) && self.word(self.index + 2) == "=";
        if !has_value && !self.expected.has(Rule::equals) {
            return None;
        }
        let (one, other) = (self.word(self.statement_start() + 1), self.word(self.index + 1));
        Some(format!(
            "what has a value has a statement of its own: `{first} {one} = ...;  {first} {other} = ...;`; lists of names \
             are for `state`, `input`, `output` and `variable`"
        ))
    }

    /// A list in brackets or parentheses as a range.
    fn range_from(&self, open: usize) -> String {
        let range = self.ends(open).map(|(lower, upper, unit)| format!("in {lower}..{upper}{unit}"));
        format!("a range is written without brackets: `{}`", range.as_deref().unwrap_or("in 0 .. 1"))
    }

    /// The two elements of a list, blanks around them, and the unit behind it.
    fn ends(&self, open: usize) -> Option<(String, String, String)> {
        let (mut depth, mut comma) = (0_usize, None);
        for at in open..open + MOST_SHOWN {
            match self.word(at) {
                "(" | "[" => depth += 1,
                ")" | "]" if depth > 1 => depth -= 1,
                ")" | "]" => {
                    let lower = self.end(open + 1, comma?);
                    let upper = self.end(comma? + 1, at);
                    let unit = if self.word(at + 1) == "[" {
                        self.written(at + 1, self.past(at + 1, "]"))
                    } else {
                        String::new()
                    };
                    let space = |end: &str, before: bool| match (end.is_empty(), before) {
                        (true, _) => String::new(),
                        (false, true) => format!("{end} "),
                        (false, false) => format!(" {end}"),
                    };
                    let unit = if unit.is_empty() { unit } else { format!(" {unit}") };
                    return Some((space(&lower, true), space(&upper, false), unit));
                }
                "," if depth == 1 && comma.is_none() => comma = Some(at),
                "" | ";" | "{" | "}" | "," => return None,
                _ => {}
            }
        }
        None
    }

    /// An end of a range; nothing where it bounds nothing.
    fn end(&self, from: usize, to: usize) -> String {
        let is_none = (from..to).any(|at| NO_BOUNDS.contains(&self.word(at)));
        if is_none { String::new() } else { self.written(from, to) }
    }

    /// The statement with `in` in place of its `=`.
    fn with_in(&self) -> String {
        let first = self.statement_start();
        let statement = self.written(first, self.past(first, ";"));
        format!("a range is written with `in`: `{}`", statement.replacen('=', "in", 1))
    }

    /// Whether a word stands between here and the end of the statement.
    fn rest_has(&self, wanted: &str) -> bool {
        let rest = (self.index..self.index + MOST_SHOWN).map(|at| self.word(at));
        rest.take_while(|word| !matches!(*word, "" | ";")).any(|word| word == wanted)
    }

    /// The parenthesis that was closed before this place or before the unit here, if it stands behind `in`.
    fn opener_behind_in(&self) -> Option<usize> {
        let mut depth = 0_usize;
        for at in (1..self.index).rev() {
            match self.word(at) {
                ")" | "]" => depth += 1,
                "[" if depth == 1 && self.word(at - 1) == ")" => depth = 0,
                "(" | "[" if depth == 1 => return (self.word(at - 1) == "in").then_some(at),
                "(" | "[" => depth = depth.checked_sub(1)?,
                ";" | "{" | "}" => return None,
                _ => {}
            }
        }
        None
    }

    /// The bracket that opens what closes just before.
    fn size_before(&self) -> Option<usize> {
        (self.statement_start()..self.index).rev().find(|at| self.word(*at) == "[")
    }

    /// The token behind the next such word.
    fn past(&self, from: usize, wanted: &str) -> usize {
        let end = self.scan.tokens.len();
        (from..end.min(from + MOST_SHOWN))
            .find(|at| self.word(*at) == wanted)
            .map_or(end.min(from + MOST_SHOWN), |at| at + 1)
    }

    /// The text of some tokens, one blank in place of every white space.
    pub(super) fn written(&self, from: usize, to: usize) -> String {
        let tokens = &self.scan.tokens;
        let (Some(first), Some(last)) = (tokens.get(from), tokens.get(to.saturating_sub(1))) else {
            return String::new();
        };
        if to <= from {
            return String::new();
        }
        let text = &self.scan.clean[first.span.start as usize..last.span.end as usize];
        text.split_whitespace().collect::<Vec<_>>().join(" ")
    }

    /// The text of a token; nothing behind the last.
    pub(super) fn word(&self, at: usize) -> &str {
        self.scan.tokens.get(at).map_or("", |token| text(self.scan, token))
    }

    /// The first token of the statement.
    pub(super) fn statement_start(&self) -> usize {
        let before = (0..self.index.min(self.scan.tokens.len())).rev();
        before.into_iter().find(|at| matches!(self.word(*at), ";" | "{" | "}")).map_or(0, |at| at + 1)
    }

    /// Whether the innermost open brace is that of such a block.
    pub(super) fn is_within(&self, block: &str) -> bool {
        self.block_around() == Some(block)
    }

    /// The word before the innermost open brace, with which its statement begins.
    pub(super) fn block_around(&self) -> Option<&str> {
        let mut depth = 0_usize;
        let mut brace = None;
        for at in (0..self.index.min(self.scan.tokens.len())).rev() {
            match (self.word(at), brace) {
                (";" | "{" | "}", Some(_)) => return Some(self.word(at + 1)),
                ("}", None) => depth += 1,
                ("{", None) if depth == 0 => brace = Some(at),
                ("{", None) => depth -= 1,
                _ => {}
            }
        }
        brace.map(|_| self.word(0))
    }
}
