//! Characters that the language does not use: rustc would refuse most of them inline.

use super::Scanner;
use crate::diagnostic::{Code, Diagnostic};

impl Scanner<'_> {
    /// Refuses a character, says what to write instead, and writes that into the clean text where it fits.
    pub(super) fn unknown_character(&mut self, c: char) {
        let start = self.pos;
        // A run of the same character is one mistake.
        let count = self.rest().chars().take_while(|next| *next == c).count();
        let mut length = count * c.len_utf8();
        let (instead, mut help) = advice(c);
        if c == '\'' {
            help = self.prime(count);
            if let Some(quoted) = self.quoted() {
                help = format!("a string stands in double quotes: `\"{quoted}\"`");
                length = quoted.len() + 2;
            }
        }
        if c == '°' && self.text[self.pos + c.len_utf8()..].starts_with('/') {
            help = "write `deg`, as in `30 [deg/s]`".to_owned();
        }
        if c == '°' && self.text[self.pos + c.len_utf8()..].starts_with(['C', 'F']) {
            help = "temperatures count from absolute zero: write `293.15 [K]` for 20 degrees Celsius".to_owned();
        }
        if c == '|' && count == 2 {
            help = "write `norm(v)` for the length of a vector; two constraints are two statements".to_owned();
        }
        if c == '@' {
            help = self.at_sign().map_or(help, str::to_owned);
        }
        let name = if c.is_control() || c.is_whitespace() || is_unseen(c) {
            format!("the character U+{:04X}", c as u32)
        } else {
            format!("`{}`", c.to_string().repeat(count.min(8)))
        };
        let message = format!("{name} is not part of the language");
        // Strings in single quotes are one habit, and told once in a statement.
        let is_told =
            |known: &&Diagnostic| known.message == message && c == '\'' && length > 1 && self.is_of_statement(known);
        if self.found.last().filter(is_told).is_some() {
            self.replace(start, start + length, instead);
            self.pos += length;
            return;
        }
        self.report(Diagnostic::new(Code::UnknownCharacter, self.ahead(length), message).help(help));
        self.replace(start, start + length, instead);
        self.pos += length;
    }

    /// Whether a finding stands in the statement that goes on here.
    fn is_of_statement(&self, known: &Diagnostic) -> bool {
        !self.text[known.span.start as usize..self.pos].contains([';', '{', '}'])
    }

    /// Macros begin with `@` in Julia.
    fn at_sign(&self) -> Option<&'static str> {
        let rest = &self.text[self.pos + 1..];
        Some(match &rest[..super::name_length(rest)] {
            "variable" | "variables" | "infinite_variable" => {
                "what moves is a `state`, an `input` or an `output`, a number that is sought a `variable z in 0 .. 1;`"
            }
            "constraint" | "constraints" | "NLconstraint" => {
                "constraints stand in `initial { }`, `trajectory { }`, `final { }` or `temporal { }`"
            }
            "objective" | "NLobjective" => "write `minimize e;` or `maximize e;`",
            "infinite_parameter" => "the time is `t`, how long it takes is `duration T = 5;`",
            "parameter" | "finite_parameter" | "parameters" => "write `param p = 1;`",
            "expression" => "write `let e = ...;`",
            _ => return None,
        })
    }

    /// What stands between two primes of a line, the first of which follows no name.
    fn quoted(&self) -> Option<&str> {
        let follows = self.text[..self.pos].ends_with(|c| unicode_ident::is_xid_continue(c) || matches!(c, ')' | ']'));
        let line = self.text[self.pos + 1..].lines().next().filter(|_| !follows)?;
        line.split_once('\'').map(|(quoted, _)| quoted).filter(|quoted| !quoted.is_empty())
    }

    /// Primes after a name mean a derivative to every engineer.
    fn prime(&self, count: usize) -> String {
        let before = self.text[..self.pos].rsplit(|c| !unicode_ident::is_xid_continue(c)).next();
        match (before.filter(|name| name.starts_with(unicode_ident::is_xid_start)), count) {
            (Some(name), 1) if self.text[self.pos + 1..].trim_start().starts_with(['*', '@']) => format!(
                "write `dot({name}, b)` for a product of vectors, `transpose({name})` for a matrix, `der({name})` for the derivative"
            ),
            (Some(name), _) => {
                let of = if count == 1 { format!("der({name})") } else { format!("der({name}, {count})") };
                match self.text[self.pos + count..].trim_start() {
                    rest if rest.starts_with("(0)") => {
                        format!("write `initial({of})`, inside `initial {{ }}` `{of}` alone")
                    }
                    rest if ["(T)", "(tf)", "(t_f)"].iter().any(|end| rest.starts_with(end)) => {
                        format!("write `final({of})`, inside `final {{ }}` `{of}` alone")
                    }
                    _ => format!("write `{of}` for the derivative"),
                }
            }
            (None, _) => "derivatives are written `der(x)`, strings in double quotes".into(),
        }
    }
}

/// Whether a character has neither a sign nor a width: marks of order, joiners, soft hyphens.
fn is_unseen(c: char) -> bool {
    matches!(c, '\u{ad}' | '\u{200b}'..='\u{200f}' | '\u{202a}'..='\u{202e}' | '\u{2060}'..='\u{2064}' | '\u{feff}')
}

/// What to put into the clean text, never longer than the character, and what to tell. A sign or a power is
/// not put in: long chains of them would nest without having been counted.
fn advice(c: char) -> (&'static str, String) {
    let (instead, help) = match c {
        '≤' | '⩽' | '≦' => ("<=", "write `<=`"),
        '≥' | '⩾' | '≧' => (">=", "write `>=`"),
        '≡' | '≔' => ("==", "write `==` for what shall hold, `=` for what is defined"),
        '≠' => ("==", "a constraint is written with `==`, `<=` or `>=`"),
        '×' | '·' | '∗' | '⋅' => ("*", "write `*`"),
        '÷' | '∕' => ("/", "write `/`"),
        '−' | '–' | '—' => ("", "write the sign `-` of the keyboard"),
        '²' => ("", "write `^2`"),
        '³' => ("", "write `^3`"),
        '°' => ("", "write the unit in brackets, `30 [deg]`"),
        '√' => ("", "write `sqrt(...)`"),
        '∞' => ("", "leave the bound out, `1 ..` or `.. 5`"),
        '∫' => ("", "write `integral(...)`"),
        '∂' => ("", "write `partial(f(x, y), x)`, or `der(x)` for a derivative in time"),
        '∈' => ("in", "write `in`"),
        '∑' => ("", "write `sum(i in 1 .. N, ...)`"),
        '∏' => ("", "write `prod(i in 1 .. N, ...)`"),
        '…' | '‥' => ("..", "write `..`"),
        '“' | '”' | '„' => ("", "write `\"`"),
        '‘' | '’' | '′' => ("", "derivatives are written `der(x)`"),
        '%' => ("", "write a share as a number, `0.05`; comments begin with `//`"),
        '#' => ("", "comments begin with `//`"),
        '@' => ("*", "write `*`, which is the product of matrices too"),
        '~' | '≈' | '≃' | '≅' => (
            "",
            "say which side is meant, with `<=` or `>=`; how uncertain a measurement is stands behind it: `x == 2 [cm] sigma 1 [cm]`",
        ),
        '±' => (
            "",
            "bounds are two numbers, `x in 1 .. 3`; how uncertain a measurement is stands behind it: `x == 2 [cm] sigma 1 [cm]`",
        ),
        '!' => ("", "write each constraint with `==`, `<=` or `>=`"),
        '\\' => ("", "write the equation: `A * x == b`, with `x` a state, an input or an output"),
        '?' => ("", "write `if a <= b { ... } else { ... }`"),
        '&' => ("", "write two statements: all of them hold"),
        '|' => ("", "write `abs(x)` for a magnitude"),
        _ if c.is_whitespace() => ("", "write an ordinary blank"),
        _ => ("", "remove it"),
    };
    (instead, help.into())
}
