//! The law of a layout: what is laid out says what it said.
//!
//! Takes a text and its layout, gives an error at the first token or comment that is another one in the layout, or
//! none. White space is free between tokens, at the ends of lines and inside of comments, nowhere else.

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::source::{Source, Span};
use crate::syntax::scan::scan;

/// Refuses a layout that has other tokens or other comments than the text.
pub(super) fn kept(text: &str, layout: &str) -> Result<(), Diagnostics> {
    let (before, after) = (Words::of(text), Words::of(layout));
    let changed = before.tokens.first_change(&after.tokens).or(before.comments.first_change(&after.comments));
    let Some(span) = changed else { return Ok(()) };
    let message = "what stands here would not be what it is, if the spec were laid out";
    let finding = Diagnostic::new(Code::LayoutChanges, span.unwrap_or(Span::new(text.len(), text.len())), message);
    let help = "the spec is left as it is; write comments here on lines of their own, and report this spec";
    Diagnostics::or(vec![finding.help(help)])
}

/// The words of a text, without the white space that a layout may change.
struct Words {
    tokens: Row,
    comments: Row,
}

impl Words {
    fn of(text: &str) -> Self {
        let scan = scan(&Source::new("", text));
        let word = |span: Span| &text[span.start as usize..span.end as usize];
        let tokens = scan.tokens.iter().map(|token| (word(token.span).trim_end().to_owned(), token.span));
        let comments = scan.comments.iter().map(|span| {
            let words: Vec<&str> = word(*span).split_whitespace().collect();
            (words.join(" "), *span)
        });
        Self { tokens: Row(tokens.collect()), comments: Row(comments.collect()) }
    }
}

/// Texts and where they stand.
struct Row(Vec<(String, Span)>);

impl Row {
    /// The place of the first one that another row has otherwise; no place where only the other one goes on.
    fn first_change(&self, other: &Self) -> Option<Option<Span>> {
        let same = self.0.iter().zip(&other.0).take_while(|(one, other)| one.0 == other.0).count();
        (same < self.0.len().max(other.0.len())).then(|| self.0.get(same).map(|(_, span)| *span))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn white_space_is_free() {
        let text = "/// A.  \nproblem P { /* a\n   b */ const a=1;// c\n}";
        assert!(kept(text, "/// A.\nproblem P {\n    /* a\nb */ const a = 1;  // c\n}\n").is_ok());
    }

    #[test]
    fn statements_in_comments_and_comments_lost_are_told_at_their_place() {
        let text = "problem P {\n    /// A.\n    const a = 1; // b\n}\n";
        for (layout, place) in [
            ("problem P {\n    /// A. const a = 1;\n    // b\n}\n", "/// A."),
            ("problem P {\n    /// A.\n    const a = 1;\n}\n", "// b"),
            ("problem P {\n    /// A.\n    // const a = 1; // b\n}\n", "const"),
            ("problem P {\n    /// A.\n    const a = 1; // b }\n", "}"),
            ("problem P {\n    /// A.\n    const a = 11; // b\n}\n", "1"),
        ] {
            let found = kept(text, layout).expect_err(layout);
            let span = found.first().span;
            assert_eq!(&text[span.start as usize..span.end as usize], place, "{layout}");
            assert_eq!(found.first().code, Code::LayoutChanges);
        }
    }
}
