//! Strings, which hold the path of a table's file and nothing else.

use super::{Scanner, TokenKind, name_length};
use crate::diagnostic::{Code, Diagnostic};

impl Scanner<'_> {
    /// `"tables/drag.csv"`. What rustc's lexer would refuse or take for something else inline
    /// (a prefix, a suffix, an escape) is refused in files too.
    pub(super) fn string(&mut self) {
        let rest = self.rest();
        let line = rest.find(['\n', '\r']).map_or(rest, |end| &rest[..end]);
        let Some(inner) = line[1..].find('"') else {
            let finding = Diagnostic::new(Code::Unclosed, self.ahead(1), "this string is never closed");
            self.report(finding.help("write `\"` at its end, on the same line"));
            self.blank(self.pos, self.pos + line.len());
            self.pos += line.len();
            self.swallowed = true;
            return;
        };
        let length = inner + 2;
        let suffix = name_length(&rest[length..]);
        if self.before().is_some_and(|c| c == '_' || unicode_ident::is_xid_continue(c)) {
            self.bad_string(length, "a string stands directly after a word", "write a blank between the two");
        } else if suffix > 0 {
            self.bad_string(length + suffix, "a word stands directly after a string", "write a blank between the two");
        }
        if line[1..=inner].contains('\\') {
            self.bad_string(length, "a string holds no backslash", "write `/` in paths, on every system");
        }
        self.push(TokenKind::String, length);
    }

    fn bad_string(&mut self, length: usize, message: &str, help: &str) {
        self.report(Diagnostic::new(Code::MalformedString, self.ahead(length), message).help(help));
    }
}
