//! Where the grammar got stuck, in the words of a person.
//!
//! Takes the place, the rules that were tried there and the tokens around it; gives one `Diagnostic`.
//! The grammar lists rules; a person thinks in few kinds of things (an expression, a name, a `;`), and often the
//! token that stands there says better what is wrong than any list.

use super::grammar::{Rule, Stuck};
use super::recover::{Body, text};
use super::scan::{Scan, Token, TokenKind};
use super::words::{ITEM_WORDS, OTHER_ITEM_WORDS, is_reserved};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;

mod brackets;
mod conditions;
mod declared;
mod expected;
mod habits;
pub(super) mod imports;
mod loops;
mod openers;
mod places;
mod ranges;
mod relations;

use expected::Expected;

/// What holds at times only.
const PART: &str = "over a part of the time write `trajectory from a to b { ... }`";

/// What stands at the place where the grammar got stuck.
struct Here<'a> {
    scan: &'a Scan,
    /// The token there, or none at the end of the text.
    index: usize,
    token: Option<&'a Token>,
    before: Option<&'a Token>,
    expected: Expected,
}

/// What is wrong where the grammar got stuck in a text that begins at byte `base`.
pub(super) fn explain(scan: &Scan, stuck: &Stuck, base: usize) -> Diagnostic {
    let at = base + stuck.at;
    let index = scan.tokens.partition_point(|token| (token.span.end as usize) <= at);
    let before = index.checked_sub(1).map(|before| &scan.tokens[before]);
    let expected = Expected::new(&stuck.expected);
    let here = Here { scan, index, token: scan.tokens.get(index), before, expected };
    here.missing_semicolon()
        .or_else(|| here.stray_doc())
        .or_else(|| here.reserved_label())
        .or_else(|| here.reserved())
        .or_else(|| here.unit())
        .or_else(|| here.unit_alone())
        .unwrap_or_else(|| here.unexpected())
}

/// A statement of another place, or one that begins with no word of the language.
pub(super) fn misplaced(scan: &Scan, body: Body, at: usize, end: usize) -> Option<Diagnostic> {
    let Some(token) = scan.tokens[at..end].iter().find(|token| token.kind != TokenKind::Doc) else {
        return Some(stray_doc(scan.tokens[at].span));
    };
    let word = text(scan, token);
    if word == ";" {
        let finding = Diagnostic::new(Code::Unexpected, token.span, "there is no statement before this `;`");
        return Some(finding.help("remove it"));
    }
    if token.kind != TokenKind::Word {
        return None;
    }
    if !matches!(body, Body::Items(_)) {
        return foreign_item(scan, body, token, word);
    }
    let is_item = ITEM_WORDS.contains(&word) || OTHER_ITEM_WORDS.contains(&word);
    if word == "problem" {
        let finding = Diagnostic::new(Code::OneProblem, token.span, "a problem does not stand in another one");
        return Some(finding.help("a spec is exactly one `problem Name { ... }`"));
    }
    (!is_item).then(|| openers::no_item(scan, token, word, at, end))
}

/// A declaration in a block of constraints, a guess or a table.
fn foreign_item(scan: &Scan, body: Body, token: &Token, word: &str) -> Option<Diagnostic> {
    let follows = scan.tokens.get(scan.tokens.partition_point(|other| other.span.start <= token.span.start));
    let is_block =
        matches!(word, "initial" | "final" | "dynamics") && follows.is_some_and(|next| text(scan, next) == "{");
    if !ITEM_WORDS.contains(&word) && !is_block {
        return None;
    }
    if body == Body::Constraints && follows.is_some_and(|next| text(scan, next) == ":") {
        return Some(places::reserved_name(token.span, word));
    }
    let place = match body {
        Body::Guess => "a guess",
        Body::Rows => "a table",
        _ => "a block of constraints",
    };
    let finding = Diagnostic::new(Code::Misplaced, token.span, format!("`{word}` may not stand in {place}"));
    Some(finding.help("write it before or after, in the problem, the agent or the phase"))
}

/// A `///` that stands before nothing that could be documented.
pub(super) fn stray_doc(span: Span) -> Diagnostic {
    let finding = Diagnostic::new(Code::Comment, span, "this `///` documents nothing");
    finding.help("write `//`, or move it before a declaration or constraint")
}

/// Whether a token is the first on its line.
pub(super) fn begins_line(scan: &Scan, index: usize) -> bool {
    let start = scan.tokens[index].span.start as usize;
    let before = index.checked_sub(1).map_or(0, |before| scan.tokens[before].span.end as usize);
    scan.clean[before..start].contains('\n')
}

impl Here<'_> {
    /// A statement that goes straight into the next one.
    fn missing_semicolon(&self) -> Option<Diagnostic> {
        let before = self.before?;
        if !self.expected.has(Rule::semicolon) {
            return None;
        }
        let next_statement = match self.token {
            None => true,
            Some(token) if token.kind == TokenKind::Doc => true,
            Some(token) => {
                let word = text(self.scan, token);
                // An operator, a comma or an opening bracket on the next line goes on with the statement, wrongly.
                let begins = token.kind == TokenKind::Word && begins_line(self.scan, self.index);
                word == "}" || ITEM_WORDS.contains(&word) || begins || self.begins_relation()
            }
        };
        let end = before.span.end;
        next_statement.then(|| {
            let finding = Diagnostic::new(Code::MissingSemicolon, Span { start: end, end }, "a `;` is missing here");
            finding.help("every statement ends with `;`")
        })
    }

    fn stray_doc(&self) -> Option<Diagnostic> {
        self.token.filter(|token| token.kind == TokenKind::Doc).map(|token| stray_doc(token.span))
    }

    /// A reserved word where a name stands.
    fn reserved(&self) -> Option<Diagnostic> {
        let token = self.token.filter(|token| token.kind == TokenKind::Word)?;
        let word = text(self.scan, token);
        let starts_statement = ITEM_WORDS.contains(&word) && begins_line(self.scan, self.index);
        if !is_reserved(word) || starts_statement || !self.expected.wants_a_name() {
            return None;
        }
        let finding = Diagnostic::new(Code::ReservedWord, token.span, format!("`{word}` is a reserved word"));
        if let Some(help) = self.behind_a_point(word).or_else(|| self.instead_of_reserved(word)) {
            return Some(finding.help(help));
        }
        Some(match word {
            "t" | "tau" | "pi" if self.expected.has(Rule::name) => finding
                .help(format!("`{word}` has a meaning in every expression; choose another name, such as `{word}_`")),
            _ => finding.help(format!("choose another name, such as `{word}_`")),
        })
    }

    /// Something in brackets that is no unit.
    fn unit(&self) -> Option<Diagnostic> {
        if !self.expected.is_inside_unit() {
            return None;
        }
        let finding = Diagnostic::new(Code::MalformedUnit, self.span(), self.message());
        if self.token.is_some_and(|token| text(self.scan, token) == "..") {
            return Some(finding.help("a family names its index, `let x[i in 1 .. N]`; sizes stand in `output` only"));
        }
        let this = self.word(self.index);
        if this == "**" {
            return Some(finding.help("write `^` for a power: `[m/s^2]`"));
        }
        if this == "-" || (this == "]" && self.index > 0 && self.word(self.index - 1) == "[") {
            return Some(finding.help("a pure number has no unit, or `[1]`"));
        }
        let has_power = self.scan.tokens[..self.index].iter().rev().map(|token| text(self.scan, token));
        let has_power = has_power.take_while(|word| *word != "[").any(|word| word == "^");
        if self.token.is_some_and(|token| token.kind == TokenKind::Number) && !has_power {
            return Some(
                finding.help("a number stands before the brackets, `1000 [m]`; in them it is a power, `[m^2]`"),
            );
        }
        if this == "in" {
            return Some(finding.help("a range has both of its ends: `[i in 1 .. 3]`"));
        }
        if this == "." || self.token.is_some_and(|token| token.kind == TokenKind::Word) {
            return Some(finding.help("a product of units has its sign: `[N*m]`"));
        }
        Some(finding.help("write units as in `[km]`, `[m/s^2]`, `[kg*m^2]`, `[1]`, with whole powers"))
    }

    /// Everything else: what was expected, and what was found.
    fn unexpected(&self) -> Diagnostic {
        let finding = Diagnostic::new(Code::Unexpected, self.span(), self.message());
        match self.advice() {
            Some(help) => finding.help(help),
            None => finding,
        }
    }

    fn span(&self) -> Span {
        let end = self.scan.clean.len();
        let after_text =
            self.before.map_or(Span::new(end, end), |before| Span { start: before.span.end, end: before.span.end });
        self.token.map_or(after_text, |token| token.span)
    }

    fn message(&self) -> String {
        format!("expected {}, found {}", self.expected, self.found())
    }

    fn found(&self) -> String {
        const SHOWN: usize = 30;
        let Some(token) = self.token else { return "the end of the text".into() };
        let word = text(self.scan, token);
        let short: String = word.chars().take(SHOWN).collect();
        let dots = if short.len() < word.len() { "..." } else { "" };
        format!("`{short}{dots}`")
    }

    /// The word that the statement begins with.
    fn first_word(&self) -> Option<&str> {
        let tokens = &self.scan.tokens[..self.index.min(self.scan.tokens.len())];
        let start = tokens.iter().rposition(|token| matches!(text(self.scan, token), ";" | "{" | "}"));
        let first = tokens.get(start.map_or(0, |start| start + 1));
        first.map(|token| text(self.scan, token))
    }

    /// What to write instead, where the tokens tell.
    fn advice(&self) -> Option<String> {
        let word = |token: Option<&Token>| token.map_or("", |token| text(self.scan, token));
        let (this, before) = (word(self.token), word(self.before));
        let is_word = self.token.is_some_and(|token| token.kind == TokenKind::Word);
        let after_number = self.before.is_some_and(|token| token.kind == TokenKind::Number);
        match self.first_word() {
            Some("scenario") => {
                return Some("a scenario names the index of its members: `scenario plant[k in 1 .. 20] { ... }`, or with `weight p[k]`".into());
            }
            Some("domain") => {
                return Some("write the name of the independent variable and its unit: `domain s [m];`".into());
            }
            Some("jump") if this == ";" && before == "jump" => {
                return Some("write what may jump at the start of the phase: `jump x, y;`".into());
            }
            Some("continuous") if this == ";" && before == "continuous" => {
                return Some("write what has no jumps, and up to which derivative: `continuous x up to 1;`".into());
            }
            Some("shared") => return Some("write the inputs, and until when: `shared u until 1 [s];`".into()),
            _ => {}
        }
        if self.is_deviation(this) {
            return Some("how uncertain a measurement is stands behind it: `sigma 1 [cm]`".into());
        }
        if self.first_word() == Some("soft") && self.expected.has(Rule::relation) {
            return Some("a soft constraint is `soft(w): c`, with two prices `soft(linear = v, square = w): c`".into());
        }
        if this == "at" && self.expected.has(Rule::part) && self.first_word() != Some("measure") {
            return Some("one time has a block of its own: `at 2.5 [s] { ... }`".into());
        }
        let advice = self.advice_on_kinds(this, before).or_else(|| self.advice_on_periodic(this, before));
        let advice =
            advice.or_else(|| self.advice_on_loops(this, before)).or_else(|| self.advice_on_times(this, before));
        if let Some(advice) = advice.or_else(|| self.advice_on_constraints(this, before)) {
            return Some(advice);
        }
        if let Some(advice) = self.advice_on_lists(this).or_else(|| self.advice_on_units(this, before)) {
            return Some(advice);
        }
        let in_declaration =
            matches!(self.first_word(), Some("state" | "input" | "output" | "variable" | "param" | "const"));
        if let Some(advice) = self.advice_on_ranges(this, before).or_else(|| self.advice_on_heads(this, before)) {
            return Some(advice);
        }
        if in_declaration && this == "(" && self.before.is_some_and(|token| token.kind == TokenKind::Word) {
            return Some(format!("a size stands in brackets: `{before}[3]`"));
        }
        if in_declaration && this == ":" && after_number {
            return Some("a range is written `1 .. 3`".into());
        }
        let is_called = word(self.scan.tokens.get(self.index + 1)) == "(";
        let may_be_unit = is_word && !is_called && !matches!(this, "from" | "spline" | "column" | "columns");
        if in_declaration
            && matches!(this, "bounds" | "bounded" | "between" | "min" | "max" | "lb" | "ub" | "lower" | "upper")
        {
            return Some("bounds are written `in 0 .. 1`".into());
        }
        if in_declaration && may_be_unit && self.expected.has(Rule::semicolon) && self.expected.has(Rule::comma) {
            return Some(format!("a unit stands in brackets, `[{this}]`"));
        }
        if this == "=" && before == ":" {
            return Some("write `==` for what shall hold, `=` for what is defined".into());
        }
        if this == "(" && before == "]" {
            return Some("a value at a time is `at(time, x)`; a delay is not in the language".into());
        }
        if this == "**" {
            return Some("write `^` for a power".into());
        }
        let earlier = self.index.checked_sub(2).and_then(|at| self.scan.tokens.get(at));
        if (this == "."
            && self.expected.has(Rule::semicolon)
            && (self.expected.has(Rule::alias) || self.expected.has(Rule::kw_as)))
            || (this == "(" && word(earlier) == ".")
        {
            if self.first_word() == Some("use") {
                return Some(format!("write {}", imports::as_use(self.scan, self.statement_start())));
            }
            return Some("functions of the language stand alone, `sin(x)`, those of a library behind `::`: `use std::rotation;`, `rotation::matrix(q)`".into());
        }
        if let Some(advice) = self.advice_on_conditions(this, before) {
            return Some(advice);
        }
        if after_number && matches!(this, "(" | "{" | "<") && self.expected.has(Rule::operator) {
            return Some(format!(
                "a unit stands in brackets, `{before} [kg]`; a product has its sign, `{before} * ...`"
            ));
        }
        if after_number && is_word {
            return Some(format!(
                "a unit stands in brackets, `{before} [{this}]`; a product has its sign, `{before} * {this}`"
            ));
        }
        if this == "+" && self.expected.has_expression() {
            return Some("a number without a sign is positive: remove the `+`".into());
        }
        if this == "=" && self.first_word() == Some("variable") {
            return Some("a `variable` is sought, between bounds or without: `variable z in 0 .. 3;`; a number that is given is a `param`".into());
        }
        if this == "[" && before == "]" {
            return Some("several indices stand in one bracket: `A[1, 2]`".into());
        }
        let is_unit = matches!(before, "*" | "/") && word(earlier).ends_with(|c: char| c.is_ascii_digit() || c == ']');
        if this == "[" && is_unit {
            return Some("a unit stands behind its number without a sign, in one bracket: `9.81 [m/s^2]`".into());
        }
        if this == "[" && self.expected.has_expression() {
            return Some("a vector is a list in parentheses, `(1, 0, 0)`; brackets are units and indices".into());
        }
        if before == "." && matches!(this, "*" | "/" | "^") {
            return Some("there is no product element by element: write it for an index, `a[i] * b[i]`".into());
        }
        if this == "==" && self.expected.has(Rule::equals) {
            return Some("here a value is given, with one `=`".into());
        }
        if this == "=" && self.expected.has(Rule::semicolon) {
            return Some(
                "constraints stand in `initial { }`, `trajectory { }`, `final { }` or `temporal { }`, with `==`".into(),
            );
        }
        if this == "," && self.is_decimal_comma() && self.expected.has(Rule::semicolon) {
            return Some("the decimal point is `.`; a list stands in parentheses, `(1, 2)`".into());
        }
        if this == "," && self.expected.has(Rule::semicolon) {
            return Some("a list stands in parentheses, `(1, 2)`".into());
        }
        if matches!(this, ")" | "]") && before == "," {
            return Some("remove the comma before it".into());
        }
        self.advice_on_habits(this, before).map(str::to_owned)
    }
}
