//! What to write instead of kinds, of `periodic` in a declaration, of definitions without a value.

use super::Here;
use crate::syntax::grammar::Rule;
use crate::syntax::scan::{Token, TokenKind};

/// Kinds of numbers in other languages.
const KINDS: [&str; 17] = [
    "real", "Real", "Reals", "float", "Float", "double", "int", "Int", "integer", "Integer", "bool", "boolean",
    "number", "scalar", "vector", "matrix", "complex",
];

/// Functions that people write without parentheses.
const APPLIED: [&str; 12] = ["sin", "cos", "tan", "asin", "acos", "atan", "sqrt", "exp", "log", "abs", "norm", "tanh"];

impl Here<'_> {
    /// `state real x;`, `input u: real;`, `duration T [s] = 5;`, `let z;`
    pub(super) fn advice_on_kinds(&self, this: &str, before: &str) -> Option<String> {
        let first = self.first_word()?;
        let has = |rule| self.expected.has(rule);
        let is_word = self.token.is_some_and(|token| token.kind == TokenKind::Word);
        let declares = matches!(
            first,
            "state" | "input" | "output" | "variable" | "param" | "const" | "let" | "duration" | "fn" | "continuation"
        );
        let next = self.word(self.index + 1);
        let is_leading = self.index == self.statement_start() + 2 && is_word;
        let kind = [(this, true), (next, this == ":"), (before, is_leading)];
        if let Some((kind, _)) = kind.into_iter().find(|(word, stands)| *stands && KINDS.contains(word))
            && declares
        {
            return Some(format!(
                "kinds are not declared: every number is real, a vector has its size, `r[3]`; leave `{kind}` out"
            ));
        }
        Some(match (first, this) {
            ("variable", ":") => "bounds are written `in 0 .. 1`, a unit `[m]`".into(),
            ("duration" | "start", "[") if has(Rule::equals) => {
                let close = (self.index..self.scan.tokens.len()).find(|at| self.word(*at) == "]")?;
                let unit = self.written(self.index, close + 1);
                format!("its unit stands behind its number: `= 5 {unit}`, or `in 1 .. 9 {unit}`")
            }
            ("duration", ",") if has(Rule::semicolon) => {
                "the whole has one duration, and each phase its own: `phase a { duration in 1 .. 9; }`".into()
            }
            ("state", "continuous") if before == ":" => "a state has no jumps anyway: leave it out".into(),
            ("state" | "output", "held" | "continuous") if before == ":" => {
                format!("`{this}` is for an `input`; behind the colon stands a `spline(...)`")
            }
            ("let", ";") if has(Rule::equals) => format!(
                "a definition has a value, `let {before} = ...;`; what is sought is an `output`, an `input` or a `variable`"
            ),
            ("let", "in") if has(Rule::equals) => {
                "what is sought between bounds is a `variable`, along the way an `input` or an `output`".into()
            }
            ("let", "=") if self.word(self.statement_start() + 2) == "[" && !has(Rule::equals) => {
                self.for_each(self.word(self.statement_start() + 1))
            }
            ("let", "]") if before == "[" => "without a size leave the brackets out".into(),
            ("let", _) if before == "let" && this != "(" => "a definition has a name: `let a = ...;`".into(),
            (_, "(") if before == ")" && has(Rule::operator) && self.value_of_called().is_none() => {
                "a product has its sign, `a * b`".into()
            }
            ("let", "(") if before == "let" => {
                "what has a value has a statement of its own: `let a = ...;  let b = ...;`".into()
            }
            (_, "(") if before == ")" && has(Rule::operator) => self.value_of_called()?,
            (_, "(")
                if self.index > 2
                    && self.word(self.index - 2) == "^"
                    && APPLIED.contains(&self.word(self.index - 3)) =>
            {
                format!("a power stands behind its argument: `{}(x)^{before}`", self.word(self.index - 3))
            }
            _ if self.is_product_of(before) => "a product has its sign, `a * b`".into(),
            _ if APPLIED.contains(&before) && is_word && has(Rule::operator) => format!("write `{before}({this})`"),
            _ => return None,
        })
    }

    /// `x 2`
    fn is_product_of(&self, before: &str) -> bool {
        let is = |token: Option<&Token>, kind| token.is_some_and(|token| token.kind == kind);
        let declares = matches!(before, "param" | "const" | "in" | "to" | "from" | "sigma" | "at") || before.is_empty();
        is(self.token, TokenKind::Number)
            && is(self.before, TokenKind::Word)
            && !declares
            && self.expected.has(Rule::operator)
    }

    /// `der(x)(0)`
    fn value_of_called(&self) -> Option<String> {
        let (mut depth, mut open) = (0_usize, self.index);
        while open > 0 {
            open -= 1;
            match self.word(open) {
                ")" => depth += 1,
                "(" if depth == 1 => break,
                "(" => depth -= 1,
                ";" | "{" | "}" => return None,
                _ => {}
            }
        }
        let called = open.checked_sub(1).filter(|at| self.word(*at) == "der")?;
        let value = self.written(called, self.index);
        Some(format!(
            "at the start write `initial({value})`, at the end `final({value})`, at a time `at(time, {value})`"
        ))
    }

    /// `periodic` anywhere but at the head of a statement of its own, or with what it does not take.
    pub(super) fn advice_on_periodic(&self, this: &str, before: &str) -> Option<String> {
        let start = self.statement_start();
        let first = self.first_word()?;
        match first {
            "state" | "input" | "output" if this == "periodic" || before == "periodic" => {
                let name = self.word(start + 1);
                Some(format!("what ends as it begins has a statement of its own: `periodic {name};`"))
            }
            "table" if matches!(this, "periodic" | "even") && before == "]" => {
                let open = (start..self.index).rev().find(|at| self.word(*at) == "[").filter(|open| *open > start)?;
                let (name, unit) = (self.word(open - 1), self.written(open, self.index));
                Some(format!("`{this}` stands before the unit: `{name} {this} {unit}`"))
            }
            "periodic" if self.is_in_relations() => {
                Some("`periodic x;` stands outside of the blocks of constraints".into())
            }
            "periodic" if matches!(before, "up" | "to") => {
                Some("up to which derivative it holds is written `periodic x up to 1;`".into())
            }
            "periodic" => Some("write what ends as it begins: `periodic x, y;`".into()),
            _ => None,
        }
    }

    /// What to write where a reserved word stands in a place that tells what was meant.
    pub(super) fn instead_of_reserved(&self, word: &str) -> Option<String> {
        let start = self.statement_start();
        let name = self.word(start + 1);
        match (self.first_word()?, word) {
            ("periodic", "der" | "integral" | "initial" | "final") => {
                Some("write the output alone, `periodic x;`: its derivatives end as they begin too".into())
            }
            ("periodic", _) => Some("write what ends as it begins, by its name: `periodic x, y;`".into()),
            ("let", "for") => Some(self.for_each(name)),
            ("param" | "const", "for") => Some("a list has its elements in parentheses: `(1, 2, 3)`".into()),
            _ => None,
        }
    }
}
