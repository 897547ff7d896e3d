//! Numbers: `digits[.digits][e[+-]digits]`, nothing glued to them.

use super::{Scanner, TokenKind, name_length};
use crate::diagnostic::{Code, Diagnostic};

impl Scanner<'_> {
    /// A number, which begins at `pos` with a digit.
    pub(super) fn number(&mut self) {
        let rest = self.rest();
        let good = number_length(rest);
        let after = &rest[good..];
        let glued = name_length(after);
        let point = after.starts_with('.') && !after.starts_with("..");
        if glued > 0 {
            self.glued(good, glued);
        } else if point {
            // `1.`, `1.e5`, `1.x`, `1.5.2`: what follows the point belongs to the mistake.
            let length = good + 1 + name_length(&after[1..]);
            let number = &rest[..good];
            let help = of_point(number, &after[1..]);
            self.malformed(length, good, &help);
        } else if rest[..good].parse::<f64>().is_ok_and(f64::is_infinite) {
            let finding = Diagnostic::new(Code::NumberTooLarge, self.ahead(good), "this number is too large");
            self.report(finding.help("the largest number is about 1.8e308"));
            self.replace(self.pos, self.pos + good, "1");
            self.push(TokenKind::Number, good);
        } else {
            self.push(TokenKind::Number, good);
        }
    }

    /// Whether a `.` here begins a fraction without a digit before the point.
    pub(super) fn is_bare_fraction(&self) -> bool {
        self.rest()[1..].starts_with(|c: char| c.is_ascii_digit()) && self.before() != Some('.')
    }

    /// `.5`
    pub(super) fn bare_fraction(&mut self) {
        let length = 1 + number_length(&self.rest()[1..]);
        let help = format!("write a digit before the point, `0{}`", &self.rest()[..length]);
        self.malformed(length, length, &help);
    }

    /// `5s`, `1_000`, `0x1F`, `1e`: letters directly after the number.
    fn glued(&mut self, good: usize, glued: usize) {
        let rest = self.rest();
        let (number, letters) = (&rest[..good], &rest[good..good + glued]);
        let radix = number == "0" && letters.starts_with(['x', 'o', 'b', 'X', 'O', 'B']);
        let plain: String = rest[..good + glued].chars().filter(|c| *c != '_').collect();
        let help = if radix {
            "write the number in decimal digits".into()
        } else if letters.starts_with('_') && plain.chars().all(|c| c.is_ascii_digit()) {
            format!("write the digits without `_`: `{plain}`")
        } else if letters.eq_ignore_ascii_case("e") {
            format!("an exponent has digits: `{number}e3`")
        } else {
            format!("a unit stands in brackets, `{number} [{letters}]`; a product has its sign, `{number} * {letters}`")
        };
        self.malformed(good + glued, good, &help);
    }

    /// Refuses `length` bytes; the first `good` of them stay as a number in the clean text.
    fn malformed(&mut self, length: usize, good: usize, help: &str) {
        let message = format!("`{}` is not a number", self.snippet(length));
        self.report(Diagnostic::new(Code::MalformedNumber, self.ahead(length), message).help(help));
        let (start, end) = (self.pos, self.pos + length);
        self.blank(start + good, end);
        if self.clean[start] == b'.' {
            self.clean[start] = b'0'; // `.5` becomes `05`.
        }
        self.push(TokenKind::Number, length);
    }

    /// The next `length` bytes, shortened for a message.
    fn snippet(&self, length: usize) -> String {
        const SHOWN: usize = 30;
        let text = &self.rest()[..length];
        let mut shown: String = text.chars().take(SHOWN).collect();
        if shown.len() < text.len() {
            shown.push_str("...");
        }
        shown
    }
}

/// What to write for a number with a point behind it and what follows that.
fn of_point(number: &str, tail: &str) -> String {
    let digits: String = tail.chars().take_while(char::is_ascii_digit).collect();
    match number.find(['e', 'E']) {
        Some(_) if digits.chars().all(|digit| digit == '0') => format!("an exponent is a whole number: `{number}`"),
        Some(at) => {
            let (factor, power) = (&number[..at], &number[at + 1..]);
            format!("an exponent is a whole number; others are powers: `{factor} * 10^({power}.{digits})`")
        }
        None if number.contains('.') => "a number has one point".into(),
        None => {
            let exponent = number_length(&format!("0{tail}")) - 1;
            format!("write digits after the point, `{number}.0{}`, or none at all", &tail[..exponent])
        }
    }
}

/// How many bytes at the front of `text` are a well-formed number.
fn number_length(text: &str) -> usize {
    let digits = |from: usize| text[from..].bytes().take_while(u8::is_ascii_digit).count();
    let mut length = digits(0);
    if text[length..].starts_with('.') && digits(length + 1) > 0 {
        length += 1 + digits(length + 1);
    }
    if text[length..].starts_with(['e', 'E']) {
        let sign = usize::from(text[length + 1..].starts_with(['+', '-']));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            length += 1 + sign + exponent;
        }
    }
    length
}
