//! What to write instead of forms of other languages that the grammar gets stuck in.

use super::Here;
use crate::syntax::grammar::Rule;
use crate::syntax::scan::{Token, TokenKind};

/// What is called or taken of something, and stands before it.
const TAKEN_OF: [&str; 7] = ["der", "integral", "initial", "final", "start", "end", "duration"];

impl Here<'_> {
    /// Ranges, slices, definitions and splines as other languages write them.
    pub(super) fn advice_on_habits(&self, this: &str, before: &str) -> Option<&'static str> {
        let is = |kind: TokenKind, token: Option<&Token>| token.is_some_and(|token| token.kind == kind);
        let first = self.first_word().unwrap_or_default();
        let has = |rule| self.expected.has(rule);
        Some(match (before, this) {
            ("(", ":") => "all elements are the name alone, `r`, some of them `r[1 .. 2]`",
            ("[" | ",", ":") => {
                "a range is written `1 .. 3`; indices that are left out at the end give the rest: `A[1]` is a row"
            }
            ("end", "]") => "the last element is written by its number or its constant: `r[3]`, `r[n]`",
            (_, ":") if matches!(first, "param" | "const") && has(Rule::equals) => {
                "a value is given with `=`, its unit stands behind it: `param m = 1 [kg];`"
            }
            _ if is(TokenKind::Number, self.token) && matches!(first, "param" | "const") && has(Rule::equals) => {
                "a value is given with `=`, its unit stands behind it: `param m = 1 [kg];`"
            }
            (_, ":") if has(Rule::equals) => "a definition is written with one `=`",
            (_, ":") if has(Rule::dots) => "a range is written `1 .. 3`",
            (_, ":") if first == "table" || self.is_within("table") => "a row ends with `;`: `0: 1;  2: 3;`",
            (_, ":") if has(Rule::relation) => "what shall hold is written with `==`, `<=` or `>=`",
            ("sigma", "=" | "==" | ":") => {
                "how uncertain a measurement is stands behind it without a sign: `sigma 1 [cm]`"
            }
            (_, "=") if has(Rule::kw_in) && first == "for" => "write `for i in 1 .. 3 { ... }`",
            (_, "{") if has(Rule::dots) => "a range is written `1 .. 3`",
            (_, ";") if first == "output" && has(Rule::colon) => {
                "an output says its spline, `output z: spline(order = 5, intervals = 8);`; a `state` needs none"
            }
            ("(", _) if is(TokenKind::Number, self.token) && first == "collocation" => {
                "settings have names: `gauss(points = 3, intervals = 20)`"
            }
            ("(", _) if is(TokenKind::Number, self.token) && matches!(first, "output" | "state" | "input") => {
                "settings have names: `spline(order = 5, intervals = 8)`"
            }
            ("(", _) if first == "table" && this != ")" => {
                "values stand in braces, a row for each node: `= monotone { 0: 1;  2: 3; }`"
            }
            ("held" | "continuous", "in") => {
                "bounds stand behind the name, before the colon: `input u in 0 .. 1: held;`"
            }
            ("=" | "==" | "<=" | ">=" | "(" | "," | "+" | "-" | "*" | "/", "{") if first != "fn" => {
                "a list stands in parentheses, `(1, 2, 3)`; braces are blocks of statements"
            }
            _ if is(TokenKind::String, self.token) && matches!(first, "param" | "const") && before == "(" => {
                "numbers of a file are taken by columns, `param a[n] [m] from \"a.csv\" column 1;`, and `rows(\"a.csv\")` is how \
                 many rows it has"
            }
            _ if is(TokenKind::String, self.token) && self.expected.has_expression() => {
                "a number stands without quotes, its unit in brackets: `1 [kg]`"
            }
            (_, "*") if first == "use" => {
                "name what is used, `use std::atmosphere::{density, sound};`, or use the library and write `atmosphere::density(h)`"
            }
            ("except", "start" | "begin" | "beginning" | "first" | "start_time") => {
                "write `trajectory except initial { ... }`"
            }
            ("except", _) => "without its last point it is written `trajectory except final { ... }`",
            ("lambda", _) | ("-", ">") => "a function is declared by `fn`: `fn f(x) = x^2;`",
            (_, "for" | "in") if self.is_behind("sum") || self.is_behind("prod") => {
                "the index comes first: `sum(i in 1 .. 3, r[i])`"
            }
            (_, "dt" | "dtau") if has(Rule::operator) && self.is_written("integral") => {
                "an integral is over time without saying so: leave the differential out"
            }
            ("+" | "-" | "*" | "/" | "^", ";" | "," | ")" | "]") => {
                "something is missing behind the sign: a number, a name, or an expression in parentheses"
            }
            ("=", ";") => "a value is missing here: `= 1`, with its unit behind it `= 1 [m]`",
            (")", "[") => "an element is taken of a name: `der(r[1])`, or of what has one by `let`",
            (_, "==" | "<=" | ">=" | "<" | ">" | "!=") if has(Rule::operator) => {
                "a value is a number: comparisons stand in blocks of constraints, or behind `if`: `if a <= b { 1 } else { 0 }`"
            }
            _ if is(TokenKind::Word, self.token)
                && is(TokenKind::Word, self.before)
                && !matches!(this, "for" | "in" | "if")
                && has(Rule::operator) =>
            {
                "a product has its sign, `a * b`"
            }
            _ => return None,
        })
    }

    /// Heads of statements and blocks as other languages write them.
    pub(super) fn advice_on_heads(&self, this: &str, before: &str) -> Option<String> {
        let first = self.first_word().unwrap_or_default();
        let has = |rule| self.expected.has(rule);
        // A head is looked at without its brace.
        let opens = has(Rule::left_brace) || has(Rule::head_end);
        let is_block = matches!(first, "initial" | "trajectory" | "final" | "temporal" | "dynamics" | "measure");
        Some(match this {
            _ if first == "trajectory" && opens && (self.is_behind("from") || self.is_behind("to")) => {
                "a part of it is written `trajectory from a to b { ... }`".into()
            }
            "during" | "on" | "in" | "between" | "when" | "while" | "until" | "(" | "[" | "at"
                if first == "trajectory" && opens =>
            {
                super::PART.into()
            }
            _ if is_block && opens => {
                format!("what holds there stands in braces: `{first} {{ ... }}`")
            }
            "=" | "==" if first == "at" && opens => {
                let end = (self.index..self.index + 12).find(|at| self.word(*at) == "{").unwrap_or(self.index + 1);
                format!("write the time alone: `at {} {{ ... }}`", self.written(self.index + 1, end))
            }
            _ if first == "phase" && (opens || has(Rule::name)) && !self.expected.has_expression() => {
                "a phase has a name and says which it follows: `phase coast after boost { ... }`".into()
            }
            "=" if matches!(first, "minimize" | "maximize") && before != first && has(Rule::semicolon) => {
                format!("the name of a term stands before a colon: `{first} {before}: ...;`")
            }
            ":" if matches!(before, "minimize" | "maximize") => {
                format!("write `{before} e;`, or with a name `{before} name: e;`")
            }
            "{" if matches!(first, "minimize" | "maximize") => {
                format!("write `{first} e;`; several terms are a sum, or statements of their own")
            }
            "," if matches!(first, "minimize" | "maximize") && has(Rule::semicolon) => {
                format!("several terms are a sum, or statements of their own: `{first} a;  {first} b;`")
            }
            "(" if first == "let" && has(Rule::equals) => {
                format!("a function is declared by `fn`: `fn {before}(x) = ...;`")
            }
            "=" if before == first && matches!(first, "param" | "const" | "continuation") => {
                format!("a value has a name: `{first} p = 3;`")
            }
            "=" if first == "fn" && has(Rule::right_parenthesis) => {
                "an argument has no default: it is given wherever the function is called".into()
            }
            _ if first == "fn"
                && has(Rule::equals)
                && has(Rule::left_brace)
                && !matches!(this, "[" | "-")
                && !(this == ":" && (self.index..self.index + 4).any(|at| self.word(at) == "=")) =>
            {
                let head = self.written(self.statement_start(), self.index);
                format!("what a function is stands behind one `=`: `{head} = ...;`")
            }
            _ if before == first
                && matches!(first, "state" | "input" | "output" | "variable")
                && (this == "-" || self.token.is_some_and(|token| token.kind == TokenKind::Number)) =>
            {
                format!("bounds stand behind the name: `{first} z in -1 .. 1;`")
            }
            _ if before == "mut" && first == "let" => "what is defined never changes: leave `mut` out".into(),
            _ if first == "fn" && has(Rule::left_parenthesis) => "write `fn f(a) = a / 2;`".into(),
            "{" if first == "table" && has(Rule::method) => {
                "say how it goes between the nodes: `= monotone { 0: 1;  2: 3; }`".into()
            }
            "=" if first == "table" && has(Rule::left_parenthesis) => {
                format!("a table names its arguments: `table {before}(x) = ...`")
            }
            "[" | "(" | "{" if before == first && matches!(first, "state" | "input" | "output" | "variable") => {
                format!(
                    "names stand side by side: `{first} x, y [m]`; a vector has its size behind it: `{first} r[2] [m]`"
                )
            }
            "," if self.is_within("guess") && has(Rule::equals) => {
                "a route is that of a list in parentheses: `(x, y) through (0, 0), (1, 2);`".into()
            }
            "(" if self.is_within("guess") && has(Rule::equals) => {
                format!("write `{before} = ...`: the right side may hold `t` and `tau`")
            }
            _ if TAKEN_OF.contains(&before) && this != "]" && has(Rule::left_parenthesis) => self.taken_of(before),
            "," if has(Rule::semicolon) && has(Rule::operator) && !self.is_decimal_comma() => {
                match self.block_around()? {
                    "initial" | "trajectory" | "final" | "temporal" | "dynamics" | "measure" | "guess" | "at" => {
                        "every statement ends with `;`".into()
                    }
                    _ => return None,
                }
            }
            _ => return None,
        })
    }

    /// Whether a word stands earlier in the statement.
    fn is_written(&self, word: &str) -> bool {
        (self.statement_start()..self.index).any(|at| self.word(at) == word)
    }

    /// `der x`, `duration;`
    fn taken_of(&self, word: &str) -> String {
        match (word, self.token.filter(|token| token.kind == TokenKind::Word)) {
            (_, Some(_)) => format!("write `{word}({})`", self.word(self.index)),
            ("duration" | "end" | "start", None) => {
                format!("write `{word}(phase)`; of the whole, the name in `duration T = ...;`, or `final(t)`")
            }
            _ => format!("write `{word}(x)`"),
        }
    }

    /// `9,81`
    pub(super) fn is_decimal_comma(&self) -> bool {
        let number = |token: Option<&Token>| token.copied().filter(|token| token.kind == TokenKind::Number);
        let (left, right) = (number(self.before), number(self.scan.tokens.get(self.index + 1)));
        left.zip(right).is_some_and(|(left, right)| left.span.end + 1 == right.span.start)
    }

    /// `h.final`, `boost.duration`, `math.pi`: what other languages have behind a point.
    pub(super) fn behind_a_point(&self, word: &str) -> Option<String> {
        let mut at = self.index.checked_sub(1).filter(|at| self.word(*at) == ".")?;
        let mut path = Vec::new();
        while self.word(at) == "." && at > 0 {
            path.push(self.word(at - 1));
            match at.checked_sub(2) {
                Some(next) if self.word(next) == "." => at = next,
                _ => break,
            }
        }
        path.reverse();
        let argument = self.word(self.index + 2);
        Some(match word {
            "pi" | "t" | "tau" => format!("write `{word}` alone"),
            "initial" | "final" if self.word(self.index + 1) == "(" && self.word(self.index + 3) == ")" => {
                format!("write `{word}({}, {argument})`", path.join("."))
            }
            "initial" | "final" => format!("write `{word}({})`", path.join(", ")),
            "start" | "end" | "duration" => format!("write `{word}({})`", path.join(".")),
            _ => return None,
        })
    }
}
