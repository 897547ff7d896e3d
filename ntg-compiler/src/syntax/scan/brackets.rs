//! Which bracket closes which, how deep they nest, and which one was forgotten.
//!
//! A `(` or `[` never spans a `;` or a brace in this language, those of an `if` excepted, so one that does was
//! forgotten, and the rest of the spec can still be read. A forgotten `}` shows only at the end of the text; the opener to
//! blame is then the one inside which something began that may not stand there.

use super::{MAX_DEPTH, MAX_FINDINGS, Token, TokenKind};
use crate::diagnostic::{Code, Diagnostic};
use crate::source::Span;
use crate::syntax::recover::stands_for_value;
use crate::syntax::words::ITEM_WORDS;

/// Brackets that are open, and the chains of `-` and `^` inside them.
#[derive(Default)]
pub(super) struct Brackets {
    open: Vec<Frame>,
    /// The chain and the conditions outside all brackets.
    outer_chain: usize,
    outer_ifs: usize,
    /// Brackets and chains together.
    depth: usize,
    /// The last token.
    last: Option<Token>,
    /// The first word of the statement.
    first_word: Option<Span>,
    /// Openers inside which something began that may not stand there.
    suspects: Vec<Span>,
    /// Brackets that a `;` ended and that may be closed behind it.
    cut: Option<Cut>,
    too_deep: bool,
    unmatched_brace: bool,
}

/// A list whose elements are parted by `;`, as in `[a; b]`, if its closing bracket follows on the line.
struct Cut {
    /// What was open, the innermost last.
    openers: Vec<u8>,
    semicolons: Vec<Span>,
    /// How many findings there were before those about the openers.
    found: usize,
    is_told: bool,
}

struct Frame {
    opener: u8,
    span: Span,
    /// The first word of the statement that a brace opens, `trajectory` or `phase`.
    head: Option<Span>,
    /// How many unary minus signs and `^` wait for their operand.
    chain: usize,
    /// How many `if` wait for the brace of their branch.
    ifs: usize,
}

impl Brackets {
    /// Takes the next token. A closing bracket that closes nothing becomes a blank in the clean text.
    pub(super) fn token(&mut self, token: Token, text: &str, clean: &mut [u8], found: &mut Vec<Diagnostic>) {
        let byte = text.as_bytes()[token.span.start as usize];
        match token.kind {
            TokenKind::Open => self.open(byte, (token.span, text), found),
            TokenKind::Close => {
                if !self.closes_cut(byte, (token.span, text), clean, found)
                    && !self.close(byte, token.span, found)
                    && byte != b'}'
                {
                    clean[token.span.start as usize] = b' ';
                }
            }
            TokenKind::Word => self.word(token.span, text),
            TokenKind::Punctuation => self.punctuation(byte, token.span, found),
            TokenKind::Number | TokenKind::String | TokenKind::Doc => {}
        }
        self.check_depth(token.span, found);
        if token.kind != TokenKind::Doc {
            self.last = Some(token);
        }
    }

    /// Reports what is still open at the end; gives whether the grammar can make nothing of the text.
    /// With some of the text `swallowed`, what looks open may have been closed there.
    pub(super) fn finish(mut self, end: usize, swallowed: bool, found: &mut Vec<Diagnostic>) -> bool {
        if self.too_deep || swallowed {
            return self.too_deep || self.unmatched_brace || self.open.iter().any(|frame| frame.opener == b'{');
        }
        self.drop_parentheses(found);
        let missing = self.open.len();
        self.suspects.truncate(missing);
        let rest = missing - self.suspects.len();
        // What no suspicion explains is blamed on the innermost braces.
        let openers = self.open.iter().rev().map(|frame| (frame.span, frame.opener)).take(rest);
        let blamed: Vec<(Span, u8)> = self.suspects.iter().map(|span| (*span, b'{')).chain(openers).collect();
        for (span, opener) in blamed {
            let finding =
                unclosed(span, &(opener as char).to_string()).label(Span::new(end, end), "the text ends here");
            report(found, finding);
        }
        missing > 0 || self.unmatched_brace
    }

    /// Whether `MAX_DEPTH` was passed.
    pub(super) fn is_too_deep(&self) -> bool {
        self.too_deep
    }

    fn open(&mut self, opener: u8, (span, text): (Span, &str), found: &mut Vec<Diagnostic>) {
        let mut head = None;
        if opener == b'{' && !self.is_list((span, text)) && !self.begins_branch(text, found) {
            self.drop_parentheses(found);
            head = self.first_word.take();
        }
        self.open.push(Frame { opener, span, head, chain: 0, ifs: 0 });
        self.depth += 1;
    }

    /// Whether a brace within other brackets holds a list, `sum(i in {1, 2, 3}, x[i])`: they are closed behind it.
    fn is_list(&self, (span, text): (Span, &str)) -> bool {
        let before = self.last.map_or("", |last| &text[last.span.start as usize..last.span.end as usize]);
        let mut depth = 0_usize;
        let rest = text[span.start as usize..].bytes().take_while(|byte| !matches!(byte, b';' | b'\n'));
        let closes = rest.into_iter().any(|byte| {
            depth = match byte {
                b'{' => depth + 1,
                b'}' => depth - 1,
                _ => depth,
            };
            depth == 0
        });
        closes && stands_for_value(before) && self.open.iter().any(|frame| frame.opener != b'{')
    }

    /// Whether a brace opens a branch of an `if`; brackets inside its condition were forgotten then.
    fn begins_branch(&mut self, text: &str, found: &mut Vec<Diagnostic>) -> bool {
        if self.last.is_some_and(|last| &text[last.span.start as usize..last.span.end as usize] == "else") {
            return true;
        }
        let inside = self.open.iter().rev().take_while(|frame| frame.opener != b'{').count();
        let waits = self.open.iter().rev().take(inside + 1).position(|frame| frame.ifs > 0);
        if waits.is_none() && (self.outer_ifs == 0 || inside < self.open.len()) {
            return false;
        }
        for _ in 0..waits.unwrap_or(inside) {
            self.drop_top(found);
        }
        *self.open.last_mut().map_or(&mut self.outer_ifs, |frame| &mut frame.ifs) -= 1;
        self.depth -= 1;
        true
    }

    /// Gives whether the bracket closes anything.
    fn close(&mut self, closer: u8, span: Span, found: &mut Vec<Diagnostic>) -> bool {
        let opener = closes(closer);
        if opener == b'{' {
            self.drop_parentheses(found);
            self.first_word = None;
        }
        let inner = self.open.iter().rev().take_while(|frame| opener == b'{' || frame.opener != b'{');
        let Some(above) = inner.map(|frame| frame.opener).position(|open| open == opener) else {
            let message = format!("this `{}` closes nothing", closer as char);
            report(
                found,
                Diagnostic::new(Code::Unopened, span, message).help("remove it, or write its opening bracket"),
            );
            self.unmatched_brace |= opener == b'{';
            return false;
        };
        for _ in 0..above {
            self.drop_top(found);
        }
        self.pop();
        true
    }

    /// Whether a bracket closes a list in which a `;` stands, which is told in place of its two halves.
    fn closes_cut(
        &mut self,
        closer: u8,
        (span, text): (Span, &str),
        clean: &mut [u8],
        found: &mut Vec<Diagnostic>,
    ) -> bool {
        if self.open.last().is_some_and(|frame| frame.opener != b'{') {
            return false;
        }
        let Some(mut cut) = self.cut.take() else { return false };
        let first = cut.semicolons[0];
        let rest = &text[first.start as usize..span.start as usize];
        let statement = text[..first.start as usize].rsplit([';', '{', '}']).next().unwrap_or_default();
        let is_loop = statement.trim_start().strip_prefix("for").is_some_and(|rest| rest.trim_start().starts_with('('));
        if rest.contains('\n') || (rest.contains('=') && !is_loop) || cut.openers.pop() != Some(closes(closer)) {
            return false;
        }
        for semicolon in &cut.semicolons {
            clean[semicolon.start as usize] = b',';
        }
        if !cut.is_told {
            found.truncate(cut.found);
            let finding = Diagnostic::new(Code::Unexpected, first, "`;` ends a statement, and parts no elements");
            report(
                found,
                finding.help(if is_loop {
                    "write `for i in 1 .. 3 { ... }`"
                } else {
                    "a vector is a list, `(a, b)`, a matrix a list of its rows, `((a, b), (c, d))`"
                }),
            );
        }
        self.cut = (!cut.openers.is_empty()).then_some(Cut { is_told: true, ..cut });
        true
    }

    fn word(&mut self, span: Span, text: &str) {
        let word = |span: Span| &text[span.start as usize..span.end as usize];
        if word(span) == "if" {
            *self.open.last_mut().map_or(&mut self.outer_ifs, |frame| &mut frame.ifs) += 1;
            self.depth += 1;
        }
        if !self.at_statement_start(text) {
            return;
        }
        self.first_word = Some(span);
        let Some(frame) = self.open.last() else { return };
        let Some(head) = frame.head.map(word) else { return };
        let this = word(span);
        let misplaced = match head {
            "phase" => matches!(this, "phase" | "agent" | "problem"),
            "agent" => matches!(this, "agent" | "problem"),
            "problem" | "scenario" => this == "problem",
            "fn" => this != "let" && ITEM_WORDS.contains(&this),
            _ => {
                let block =
                    matches!(this, "initial" | "final") && text[span.end as usize..].trim_start().starts_with('{');
                block || ITEM_WORDS.contains(&this)
            }
        };
        if misplaced && self.suspects.last() != Some(&frame.span) {
            self.suspects.push(frame.span);
        }
    }

    fn at_statement_start(&self, text: &str) -> bool {
        self.last.is_none_or(|last| matches!(text.as_bytes()[last.span.start as usize], b';' | b'{' | b'}'))
    }

    fn punctuation(&mut self, byte: u8, span: Span, found: &mut Vec<Diagnostic>) {
        let operand_before =
            self.last.is_some_and(|last| matches!(last.kind, TokenKind::Word | TokenKind::Number | TokenKind::Close));
        let nests = byte == b'^' || (byte == b'-' && !operand_before);
        if byte == b';' {
            let open = self.open.iter().rev().map(|frame| frame.opener).take_while(|opener| *opener != b'{');
            let mut openers: Vec<u8> = open.collect();
            openers.reverse();
            match &mut self.cut {
                _ if !openers.is_empty() => {
                    self.cut = Some(Cut { openers, semicolons: vec![span], found: found.len(), is_told: false });
                }
                Some(cut) => cut.semicolons.push(span),
                None => {}
            }
            self.drop_parentheses(found);
            self.first_word = None;
            self.depth -= std::mem::take(self.open.last_mut().map_or(&mut self.outer_ifs, |frame| &mut frame.ifs));
        }
        let chain = self.open.last_mut().map_or(&mut self.outer_chain, |frame| &mut frame.chain);
        if nests {
            *chain += 1;
            self.depth += 1;
        } else {
            self.depth -= std::mem::take(chain);
        }
    }

    /// Reports every `(` and `[` above the innermost brace: nothing can close it any more.
    fn drop_parentheses(&mut self, found: &mut Vec<Diagnostic>) {
        while self.open.last().is_some_and(|frame| frame.opener != b'{') {
            self.drop_top(found);
        }
    }

    fn drop_top(&mut self, found: &mut Vec<Diagnostic>) {
        if let Some(frame) = self.pop() {
            let opener = (frame.opener as char).to_string();
            report(found, unclosed(frame.span, &opener));
        }
    }

    fn pop(&mut self) -> Option<Frame> {
        let frame = self.open.pop()?;
        self.depth -= 1 + frame.chain + frame.ifs;
        Some(frame)
    }

    fn check_depth(&mut self, span: Span, found: &mut Vec<Diagnostic>) {
        if self.depth > MAX_DEPTH && !self.too_deep {
            self.too_deep = true;
            let message = format!("this is nested more than {MAX_DEPTH} deep");
            let help = "give the inner parts names of their own with `let`";
            report(found, Diagnostic::new(Code::TooDeep, span, message).help(help));
        }
    }
}

/// What a bracket closes.
fn closes(closer: u8) -> u8 {
    match closer {
        b')' => b'(',
        b']' => b'[',
        _ => b'{',
    }
}

fn unclosed(span: Span, opener: &str) -> Diagnostic {
    let closer = match opener {
        "(" => ")",
        "[" => "]",
        _ => "}",
    };
    let finding = Diagnostic::new(Code::Unclosed, span, format!("this `{opener}` is never closed"));
    finding.help(format!("write `{closer}` where it ends"))
}

fn report(found: &mut Vec<Diagnostic>, finding: Diagnostic) {
    if found.len() < MAX_FINDINGS {
        found.push(finding);
    }
}
