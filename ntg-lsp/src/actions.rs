//! Quick fixes: what the help of a finding says to write, where writing it mends the finding.
//!
//! Takes findings and their helps, gives edits. Each edit is tried before it is proposed: the compiler looks at the text with it,
//! and neither the finding nor more than there were before may be left.

use ntg_compiler::diagnostic::{Diagnostic, Severity};
use ntg_compiler::source::Span;

use crate::analysis::Analysis;

/// Most texts that are tried for one request: an editor asks wherever the cursor rests.
const MOST: usize = 12;

/// A replacement of a part of the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fix {
    /// What it mends, as an index into [`Analysis::found`].
    pub finding: usize,
    /// What is replaced.
    pub span: Span,
    /// By what.
    pub text: String,
}

/// The replacements that mend findings in a part of the text.
pub fn fixes(analysis: &Analysis, part: Span) -> Vec<Fix> {
    let mut found = vec![];
    let mut tried = 0;
    let touches = |finding: &Diagnostic| finding.span.start <= part.end && part.start <= finding.span.end;
    let here = analysis.found.iter().enumerate().filter(|(_, own)| own.libraries.is_empty() && touches(own));
    for (finding, own) in here {
        for text in proposed(own.help.as_deref().unwrap_or_default()) {
            let works = places(&analysis.source.text, own.span, text).into_iter().find(|span| {
                tried += 1;
                tried <= MOST && mends(analysis, own, *span, text)
            });
            found.extend(works.map(|span| Fix { finding, span, text: text.to_owned() }));
        }
    }
    found
}

/// What a help proposes: the code behind `write` and `did you mean`, with its alternatives.
fn proposed(help: &str) -> Vec<&str> {
    let mut found: Vec<&str> = vec![];
    let mut is_proposal = false;
    for (number, part) in help.split('`').enumerate() {
        if number % 2 == 0 {
            let so = part.trim_end();
            let goes_on = is_proposal && matches!(part.trim(), "," | "or" | ", or");
            is_proposal = so.ends_with("write") || so.ends_with("did you mean") || goes_on;
        } else if is_proposal && !part.contains("...") && !found.contains(&part) {
            found.push(part);
        }
    }
    found
}

/// What may be replaced for a finding at a span: it with the parentheses behind it, and as much around it as the proposal
/// repeats, `a^2` for `integral(a^2)` where the finding is about `a`.
fn places(text: &str, span: Span, proposal: &str) -> Vec<Span> {
    let (mut start, mut end) = (span.start as usize, span.end.max(span.start) as usize);
    if text.get(start..end).is_none() {
        return vec![];
    }
    let repeats = |start: usize, end: usize| text.get(start..end).is_some_and(|part| proposal.contains(part));
    let mut places: Vec<Span> = call(text, span).into_iter().collect();
    if repeats(start, end) {
        while let Some(more) = text[end..].chars().next().filter(|more| repeats(start, end + more.len_utf8())) {
            end += more.len_utf8();
        }
        while let Some(more) = text[..start].chars().next_back().filter(|more| repeats(start - more.len_utf8(), end)) {
            start -= more.len_utf8();
        }
    }
    places.push(Span::new(start, end));
    places
}

/// A span with the parentheses right behind it.
fn call(text: &str, span: Span) -> Option<Span> {
    let end = span.end as usize;
    let behind = text.get(end..).filter(|rest| rest.starts_with('('))?;
    let mut depth = 0;
    for (at, letter) in behind.char_indices() {
        match letter {
            '(' => depth += 1,
            ')' => depth -= 1,
            ';' | '{' | '}' => return None,
            _ => {}
        }
        if depth == 0 {
            return Some(Span::new(span.start as usize, end + at + 1));
        }
    }
    None
}

/// Whether the text without the finding has no others that it had not.
fn mends(analysis: &Analysis, finding: &Diagnostic, span: Span, text: &str) -> bool {
    let mut changed = analysis.source.text.clone();
    let range = span.start as usize..span.end.max(span.start) as usize;
    if changed.get(range.clone()).is_none_or(|now| now == text) {
        return false;
    }
    changed.replace_range(range, text);
    let after = analysis.with(changed);
    let alike = |one: &&Diagnostic| one.code == finding.code && one.message == finding.message;
    let count = |found: &[Diagnostic]| found.iter().filter(alike).count();
    let errors = |of: &Analysis| of.found.iter().filter(|own| own.severity == Severity::Error).count();
    // Behind errors of syntax wait those of meaning, which no one has seen.
    let is_new_stage = after.is_read() && !analysis.is_read();
    count(&after.found) < count(&analysis.found) && (is_new_stage || errors(&after) <= errors(analysis))
}

#[cfg(test)]
mod tests {
    use super::{places, proposed};
    use ntg_compiler::source::Span;

    #[test]
    fn what_a_proposal_repeats_is_replaced_with_what_it_is_about() {
        let replaced = |text: &'static str, about: &str, proposal: &str| -> Vec<&str> {
            let at = text.find(about).expect("there");
            let places = places(text, Span::new(at, at + about.len()), proposal);
            places.into_iter().map(|span| &text[span.start as usize..span.end as usize]).collect()
        };
        assert_eq!(replaced("minimize a^2 * 3;", "a", "integral(a^2)"), ["a^2"]);
        assert_eq!(replaced("let b = diff(x) + 1;", "diff", "der(x)"), ["diff(x)", "diff"]);
        assert_eq!(replaced("v <= v_mx;", "v_mx", "v_max"), ["v_mx"]);
        assert_eq!(replaced("x = 1;", "=", "=="), ["="]);
    }

    #[test]
    fn proposals_are_the_code_behind_write_and_did_you_mean() {
        assert_eq!(proposed("did you mean `x`?"), ["x"]);
        assert_eq!(proposed("write `der(x)` or `der(x, 2)`"), ["der(x)", "der(x, 2)"]);
        let three = "write `integral(x^2)`, `initial(x^2)` or `final(x^2)`";
        assert_eq!(proposed(three), ["integral(x^2)", "initial(x^2)", "final(x^2)"]);
        assert_eq!(proposed("the product of two vectors is `dot(a, b)`, a derivative `der(x)`"), [""; 0]);
        assert_eq!(proposed("equations of motion stand in `dynamics { der(x) == ...; }`"), [""; 0]);
        assert_eq!(proposed("write `a` where `b` stands"), ["a"]);
        assert_eq!(proposed(""), [""; 0]);
    }
}
