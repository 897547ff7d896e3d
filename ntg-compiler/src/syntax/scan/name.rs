//! Names and keywords.

use super::{Scanner, TokenKind, name_length};
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::words::NEVER_NAMES;

impl Scanner<'_> {
    /// A word; those that no generated code could bear are refused.
    pub(super) fn name(&mut self) {
        let rest = self.rest();
        let first = rest.chars().next().map_or(0, char::len_utf8);
        let length = first + name_length(&rest[first..]);
        let word = &rest[..length];
        if word.starts_with('_') {
            let finding = Diagnostic::new(Code::MalformedName, self.ahead(length), "a name does not begin with `_`");
            let bare = word.trim_start_matches('_');
            let bare = if bare.starts_with(unicode_ident::is_xid_start) { bare } else { "x" };
            self.report(finding.help(format!("write `{bare}`, or another name that begins with a letter")));
            self.replace(self.pos, self.pos + 1, "z");
        } else if NEVER_NAMES.contains(&word) {
            let message = format!("`{word}` cannot be a name: Rust keeps it for itself");
            let finding = Diagnostic::new(Code::MalformedName, self.ahead(length), message);
            self.report(finding.help(format!("choose another name, such as `{}_`", word.to_lowercase())));
        }
        self.push(TokenKind::Word, length);
    }
}
