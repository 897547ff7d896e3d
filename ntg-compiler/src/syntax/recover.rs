//! Going on after a mistake: the spec is read once more, statement by statement.
//!
//! Takes the scan of a spec that the grammar could not match as a whole.
//! Finds: what is wrong with each statement, in blocks too; words that begin no statement; more or
//! less than one problem. A statement that the scan has found fault with already is not blamed again.
//! Afterwards: there is at least one finding if the grammar was right to give up.

use super::FileKind;
use super::explain::{self, explain};
use super::grammar::{self, Rule, Stuck};
use super::parse::{Build, Scope};
use super::scan::{MAX_FINDINGS, Scan, Token, TokenKind};
use super::words::ITEM_WORDS;
use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::source::{Source, Span};

/// Everything that is wrong with the statements of a spec.
pub(super) fn recover(scan: &Scan) -> Vec<Diagnostic> {
    let mut walk = Walk { scan, closers: closers(scan), found: vec![] };
    walk.spec();
    walk.found
}

/// Everything that is wrong with the statements of a library.
pub(super) fn recover_library(scan: &Scan) -> Vec<Diagnostic> {
    let mut walk = Walk { scan, closers: closers(scan), found: vec![] };
    let first = walk.uses();
    if let Some(problem) = first.filter(|at| walk.text(*at) == "problem") {
        let span = scan.tokens[problem].span;
        let finding = Diagnostic::new(Code::WrongLibrary, span, "a library holds no problem");
        walk.found.push(finding.help("it has only `use`, `const`, `fn` and `table`; a spec uses it and is not used"));
        return walk.found;
    }
    let begin = walk.after_uses();
    walk.body(Body::Items(Scope::Library), begin, scan.tokens.len());
    walk.found
}

/// What a text holds, by its first word that is no `use`.
pub(super) fn file_kind(scan: &Scan) -> FileKind {
    let mut walk = Walk { scan, closers: closers(scan), found: vec![] };
    let begins = |walk: &Walk<'_>, word: &str| (0..scan.tokens.len()).any(|at| walk.text(at) == word);
    match walk.uses().map(|at| walk.text(at)) {
        Some("const" | "fn" | "table" | "param" | "let") if !begins(&walk, "problem") => FileKind::Library,
        _ => FileKind::Spec,
    }
}

/// Adds the scan's findings to the later ones, and drops later ones that stand in a statement in
/// which the scan found something: they would say the same again.
pub(super) fn join(scan: &Scan, later: Vec<Diagnostic>) -> Vec<Diagnostic> {
    let blamed = |finding: &Diagnostic| {
        let statement = statement_around(scan, finding.span.start);
        scan.found.iter().any(|known| {
            // Behind a missing semicolon another statement begins.
            let other = finding.code == Code::MissingSemicolon && known.span.start >= finding.span.start;
            known.code != Code::Comment && !other && statement.contains(known.span)
        })
    };
    let mut found: Vec<Diagnostic> = later.into_iter().filter(|finding| !blamed(finding)).collect();
    found.extend(scan.found.iter().cloned());
    found.sort_by_key(|finding| (finding.span, finding.code));
    found.dedup_by_key(|finding| (finding.span, finding.code));
    found
}

/// The findings of a spec that cannot be read; there is one at least.
pub(super) fn failure(found: Vec<Diagnostic>, source: &Source) -> Diagnostics {
    match Diagnostics::or(found) {
        Err(findings) => findings,
        Ok(()) => Diagnostic::new(Code::Unexpected, source.span(), "this cannot be read as a spec").into(),
    }
}

/// What the statements between two braces are.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Body {
    Items(Scope),
    Constraints,
    Guess,
    Rows,
}

impl Body {
    fn rule(self) -> Rule {
        match self {
            Self::Items(_) => Rule::item,
            Self::Constraints => Rule::statement,
            Self::Guess => Rule::guess_statement,
            Self::Rows => Rule::row,
        }
    }
}

struct Walk<'a> {
    scan: &'a Scan,
    /// For each token that opens a brace, the token that closes it.
    closers: Vec<usize>,
    found: Vec<Diagnostic>,
}

impl Walk<'_> {
    fn spec(&mut self) {
        let tokens = &self.scan.tokens;
        let begin = self.after_uses();
        let Some(first) = self.uses() else {
            let at = tokens.first().map_or(Span::new(0, 0), |token| token.span);
            return self.one_problem(at, "there is no problem here");
        };
        if explain::imports::IMPORTING.contains(&self.text(first)) {
            let message = format!("`{}` begins no statement", self.text(first));
            let finding = Diagnostic::new(Code::Unexpected, tokens[first].span, message);
            let target = explain::imports::as_use(self.scan, first);
            return self.found.push(finding.help(format!("libraries are used: {target}")));
        }
        if matches!(self.text(first), "const" | "fn" | "table") {
            let finding = Diagnostic::new(Code::OneProblem, tokens[first].span, "this is a library: it has no problem");
            return self
                .found
                .push(finding.help("a spec is exactly one `problem Name { ... }`, and may `use` this file"));
        }
        if self.text(first) != "problem" {
            return self.one_problem(tokens[first].span, "a spec begins with `problem`");
        }
        let Some(brace) = self.next_brace(first, tokens.len()) else {
            return self.head(Rule::whole_problem_head, begin, tokens.len());
        };
        self.head(Rule::whole_problem_head, begin, brace);
        let closer = self.closers[brace];
        self.body(Body::Items(Scope::Problem), brace + 1, closer);
        if let Some(more) = tokens.get(closer + 1) {
            self.one_problem(more.span, "the problem ends before this");
        }
    }

    /// Looks at the `use`s at the head of a file; gives the first word behind them.
    fn uses(&mut self) -> Option<usize> {
        self.found.clear();
        let end = self.scan.tokens.len();
        let mut at = 0;
        loop {
            let first = (at..end).find(|index| self.scan.tokens[*index].kind != TokenKind::Doc)?;
            if self.text(first) != "use" {
                return Some(first);
            }
            let stop = (first..end).find(|index| self.text(*index) == ";").map_or(end, |semicolon| semicolon + 1);
            let (from, to) = (self.start(at), self.start(stop));
            match grammar::front(Rule::use_item, &self.scan.clean[from..to]) {
                Ok(_) => at = stop,
                Err(stuck) => {
                    let finding = explain(self.scan, &stuck, from);
                    // Without its `;` the next statement is not lost.
                    let next = (first + 1..stop).find(|index| matches!(self.text(*index), "use" | "problem"));
                    self.found.push(finding);
                    at = next.unwrap_or(stop);
                }
            }
        }
    }

    /// The first token behind the `use`s, documentation included.
    fn after_uses(&self) -> usize {
        let end = self.scan.tokens.len();
        let mut at = 0;
        loop {
            let first = (at..end).find(|index| self.scan.tokens[*index].kind != TokenKind::Doc);
            let Some(first) = first.filter(|first| self.text(*first) == "use") else { return at };
            let stop = (first..end).find(|index| self.text(*index) == ";").map_or(end, |semicolon| semicolon + 1);
            at = (first + 1..stop).find(|index| matches!(self.text(*index), "use" | "problem")).unwrap_or(stop);
        }
    }

    fn one_problem(&mut self, span: Span, message: &str) {
        let help = "a spec is exactly one `problem Name { ... }`";
        self.found.push(Diagnostic::new(Code::OneProblem, span, message).help(help));
    }

    /// The statements from token `at` to before token `end`, which closes their brace.
    fn body(&mut self, body: Body, mut at: usize, end: usize) {
        let first = at;
        while at < end && self.found.len() < MAX_FINDINGS {
            let (start, stop) = (self.start(at), self.start(end));
            at = match grammar::front(body.rule(), &self.scan.clean[start..stop]) {
                Ok(pair) => {
                    let length = pair.as_str().len();
                    let mut build = match body {
                        Body::Items(scope) => Build::within(start, scope),
                        _ => Build::new(start),
                    };
                    match body {
                        Body::Items(_) => drop(build.item(pair)),
                        Body::Constraints => drop(build.statement(pair)),
                        Body::Guess => drop(build.guess_statement(pair)),
                        Body::Rows => drop(build.row(pair, at == first)),
                    }
                    self.found.append(&mut build.found);
                    self.token_from(start + length).max(at + 1)
                }
                Err(stuck) => self.broken(body, at, end, &stuck),
            };
        }
    }

    /// Reports what is wrong with the statement at token `at`; gives the token to go on from.
    fn broken(&mut self, body: Body, at: usize, end: usize, stuck: &Stuck) -> usize {
        if let Some(next) = self.broken_block(body, at, end) {
            return next;
        }
        if self.is_leftover(at) {
            return self.next_statement(body, at, end);
        }
        let finding = match explain::misplaced(self.scan, body, at, end) {
            Some(finding) => finding,
            None => explain(self.scan, stuck, self.start(at)),
        };
        let semicolon_missing = finding.code == Code::MissingSemicolon;
        self.found.push(finding);
        let stuck_at = self.token_from(self.start(at) + stuck.at);
        if semicolon_missing && stuck_at > at { stuck_at.min(end) } else { self.next_statement(body, at, end) }
    }

    /// A statement with braces: its head and its statements are looked at one by one.
    fn broken_block(&mut self, body: Body, at: usize, end: usize) -> Option<usize> {
        let words = (at..end).find(|index| self.scan.tokens[*index].kind != TokenKind::Doc)?;
        let brace = self.next_brace(words, end)?;
        let (rule, inner) = self.block_kind(body, words)?;
        let from = if matches!(rule, Rule::whole_for_head) { words } else { at };
        if from > at {
            let documents_nothing = explain::stray_doc(self.scan.tokens[at].span);
            self.found.push(documents_nothing);
        }
        self.head(rule, from, brace);
        let closer = self.closers[brace];
        self.body(inner, brace + 1, closer);
        Some(closer + 1)
    }

    /// Which head a statement with braces has, and what stands in it.
    fn block_kind(&self, body: Body, word: usize) -> Option<(Rule, Body)> {
        let inner = match (self.text(word), body) {
            ("for", Body::Constraints | Body::Guess) => (Rule::whole_for_head, body),
            ("phase", Body::Items(_)) => (Rule::whole_phase_head, Body::Items(Scope::Phase)),
            ("agent", Body::Items(_)) => (Rule::whole_agent_head, Body::Items(Scope::Agent)),
            ("initial" | "trajectory" | "final" | "temporal" | "dynamics" | "measure", Body::Items(_)) => {
                (Rule::whole_block_head, Body::Constraints)
            }
            ("scenario", Body::Items(_)) => (Rule::whole_scenario_head, Body::Items(Scope::Scenario)),
            ("at", Body::Items(_)) => (Rule::whole_at_head, Body::Constraints),
            ("guess", Body::Items(_)) => (Rule::whole_guess_head, Body::Guess),
            ("table", Body::Items(_)) => (Rule::whole_table_head, Body::Rows),
            ("param", Body::Items(_)) if self.text(word + 1) == "table" => (Rule::whole_table_head, Body::Rows),
            _ => return None,
        };
        Some(inner)
    }

    /// Reports what is wrong between token `from` and the brace at token `to`.
    fn head(&mut self, rule: Rule, from: usize, to: usize) {
        let (start, stop) = (self.start(from), self.start(to));
        if let Err(stuck) = grammar::front(rule, &self.scan.clean[start..stop]) {
            let finding = explain(self.scan, &stuck, start);
            self.found.push(finding);
        }
    }

    /// The token after the statement's `;` or closing brace, or the first one that begins a line with a
    /// word that only a declaration begins with.
    fn next_statement(&self, body: Body, at: usize, end: usize) -> usize {
        let mut index = at;
        let mut has_branches = false;
        while index < end {
            match self.text(index) {
                ";" => return index + 1,
                "if" => has_branches = true,
                "{" if has_branches || self.is_list(index) => index = self.closers[index],
                "{" => {
                    return (self.closers[index] + 1 + usize::from(self.text(self.closers[index] + 1) == ";")).min(end);
                }
                word if index > at && matches!(body, Body::Items(_)) => {
                    let before = self.text(index - 1) == "param";
                    if ITEM_WORDS.contains(&word) && !before && explain::begins_line(self.scan, index) {
                        return index;
                    }
                }
                _ => {}
            }
            index += 1;
        }
        end
    }

    /// The first `{` before the statement's `;` that opens a block.
    fn next_brace(&self, from: usize, end: usize) -> Option<usize> {
        let mut index = from;
        while index < end && self.text(index) != ";" {
            match self.text(index) {
                "{" if self.is_list(index) => index = self.closers[index],
                "{" => return Some(index),
                _ => {}
            }
            index += 1;
        }
        None
    }

    /// Whether a brace stands where a value does and holds no statements: `{1, 2, 3}`.
    fn is_list(&self, brace: usize) -> bool {
        let before = brace.checked_sub(1).map_or("", |before| self.text(before));
        let closer = self.closers[brace];
        stands_for_value(before) && closer > brace && (brace..closer).all(|at| self.text(at) != ";")
    }

    /// Whether a statement is what ends a loop or a condition in other languages, `end for;`, and the loop is blamed already.
    fn is_leftover(&self, at: usize) -> bool {
        let ends = matches!(self.text(at), "end" | "endfor" | "endif" | "endwhile" | "done" | "od" | "fi" | "next");
        let opens = |word: &str| matches!(word, "for" | "foreach" | "forall" | "while" | "if" | "do" | "loop" | "then");
        let mut earlier = (0..at).rev().take_while(|index| self.text(*index) != "{");
        ends && self.text(at + 1) != "(" && !self.found.is_empty() && earlier.any(|index| opens(self.text(index)))
    }

    /// The first token that begins at `byte` or after it.
    fn token_from(&self, byte: usize) -> usize {
        self.scan.tokens.partition_point(|token| (token.span.start as usize) < byte)
    }

    fn start(&self, token: usize) -> usize {
        self.scan.tokens.get(token).map_or(self.scan.clean.len(), |token| token.span.start as usize)
    }

    fn text(&self, token: usize) -> &str {
        self.scan.tokens.get(token).map_or("", |token| text(self.scan, token))
    }
}

/// The clean text of a token.
pub(super) fn text<'a>(scan: &'a Scan, token: &Token) -> &'a str {
    &scan.clean[token.span.start as usize..token.span.end as usize]
}

/// Whether a value stands behind this, so that a brace there can be no block.
pub(super) fn stands_for_value(before: &str) -> bool {
    let sums = matches!(before, "sum" | "prod" | "min" | "max" | "norm");
    let is_sign = matches!(before, "==" | "<=" | ">=" | "=" | "(" | "[" | "," | "+" | "-" | "*" | "/" | "^" | "..");
    sums || is_sign || matches!(before, "in" | "through" | "{")
}

/// For each token, itself, or the token that closes the brace that it opens.
fn closers(scan: &Scan) -> Vec<usize> {
    let mut closers: Vec<usize> = (0..scan.tokens.len()).collect();
    let mut open = vec![];
    for (index, token) in scan.tokens.iter().enumerate() {
        match text(scan, token) {
            "{" => open.push(index),
            "}" => {
                if let Some(opener) = open.pop() {
                    closers[opener] = index;
                }
            }
            _ => {}
        }
    }
    closers
}

/// The stretch between the `;` or braces on both sides of a byte.
fn statement_around(scan: &Scan, byte: u32) -> Span {
    let ends = |token: &&Token| matches!(text(scan, token), ";" | "{" | "}");
    let here = scan.tokens.partition_point(|token| token.span.end <= byte);
    let before = scan.tokens[..here].iter().rev().find(ends).map_or(0, |token| token.span.end);
    let after = scan.tokens[here..].iter().find(ends).map_or(scan.clean.len(), |token| token.span.end as usize);
    Span::new(before as usize, after)
}
