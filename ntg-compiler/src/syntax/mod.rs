//! From text to what was written.
//!
//! ```text
//! Source --scan--> tokens, clean text --grammar--> pairs --parse--> ast::Spec
//!                                        \--(it failed)--> recover, explain --> Diagnostics
//! ```
//!
//! The grammar stops at the first thing that it does not understand. Only then does `recover` walk the spec
//! statement by statement, so that one run reports all that is wrong and a good spec pays nothing for it.
//!
//! Afterwards: see `ast`. The grammar's rules and pairs never leave this folder.

pub mod ast;
mod explain;
mod format;
mod grammar;
mod parse;
mod recover;
mod scan;
mod spans;
mod words;

use crate::diagnostic::{Code, Diagnostic, Diagnostics};
use crate::source::Source;
use ast::{Expr, Library, Spec, Values};
use parse::Build;

pub use format::{WIDTH, format};
pub use scan::{Comment, MAX_DEPTH};
pub use words::{EXPRESSION_WORDS, ITEM_WORDS, OTHER_ITEM_WORDS};

/// Reads a spec.
///
/// # Errors
/// Everything that is wrong with the text as text, in source order (at most about a hundred findings).
pub fn parse(source: &Source) -> Result<Spec, Diagnostics> {
    check_size(source)?;
    let scan = scan::scan(source);
    if scan.hopeless {
        return Err(recover::failure(scan.found, source));
    }
    match grammar::spec(&scan.clean) {
        Ok(pair) => {
            let mut build = Build::new(0);
            let spec = build.spec(pair);
            Diagnostics::or(recover::join(&scan, build.found))?;
            Ok(spec)
        }
        Err(stuck) => {
            let mut found = recover::recover(&scan);
            if found.is_empty() && scan.found.is_empty() {
                found.push(explain::explain(&scan, &stuck, 0));
            }
            Err(recover::failure(recover::join(&scan, found), source))
        }
    }
}

/// Whether a word can be a name.
pub fn is_name(word: &str) -> bool {
    let mut letters = word.chars();
    letters.next().is_some_and(unicode_ident::is_xid_start)
        && letters.all(unicode_ident::is_xid_continue)
        && !words::is_reserved(word)
        && !words::NEVER_NAMES.contains(&word)
}

/// What a file holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A problem.
    Spec,
    /// Constants, functions and tables alone.
    Library,
}

/// What a file holds, by the first word that is no `use`.
pub fn file_kind(source: &Source) -> FileKind {
    recover::file_kind(&scan::scan(source))
}

/// Reads a library. Its places are counted from byte `base`, so that those of several files can be told apart.
///
/// # Errors
/// Everything that is wrong with the text as a library, in places counted from `base` too.
pub fn parse_library(source: &Source, base: usize) -> Result<Library, Diagnostics> {
    check_size(source)?;
    let scan = scan::scan(source);
    let found = if scan.hopeless {
        scan.found
    } else {
        match grammar::library(&scan.clean) {
            Ok(pair) => {
                let mut build = Build::new(base);
                let library = build.library(pair.clone());
                if scan.found.is_empty() && build.found.is_empty() {
                    return Ok(library);
                }
                // Findings are told in places of the file itself.
                let mut build = Build::new(0);
                build.library(pair);
                recover::join(&scan, build.found)
            }
            Err(stuck) => {
                let mut found = recover::recover_library(&scan);
                if found.is_empty() && scan.found.is_empty() {
                    found.push(explain::explain(&scan, &stuck, 0));
                }
                recover::join(&scan, found)
            }
        }
    };
    let shifted = recover::failure(found, source).into_iter().map(|finding| finding.shifted(base)).collect();
    Err(Diagnostics::or(shifted).expect_err("a failure has findings"))
}

/// Reads one expression, such as an objective given on the command line.
///
/// # Errors
/// Everything that is wrong with the text as an expression.
pub fn parse_expression(source: &Source) -> Result<Expr, Diagnostics> {
    alone(source, grammar::expression, Build::expression)
}

/// Reads one value or a list, with or without parentheses: `250 [m/s]`, `-100, -97 [km]`, `(1, 2) [km]`.
///
/// # Errors
/// Everything that is wrong with the text as a list of values.
pub fn parse_quantity(source: &Source) -> Result<Values, Diagnostics> {
    alone(source, grammar::values, Build::value_list)
}

/// The comments that document nothing, in source order; a syntax tree does not hold them.
pub fn comments(source: &Source) -> Vec<Comment> {
    let scan = scan::scan(source);
    let text = |span| source.slice(span).to_owned();
    scan.comments.into_iter().map(|span| Comment { text: text(span), span }).collect()
}

/// Reads a text that is no spec but one thing of the language.
fn alone<T>(
    source: &Source,
    rule: for<'c> fn(&'c str) -> Result<grammar::Pair<'c>, grammar::Stuck>,
    node: for<'c> fn(&mut Build, grammar::Pair<'c>) -> T,
) -> Result<T, Diagnostics> {
    check_size(source)?;
    let scan = scan::scan(source);
    if scan.hopeless {
        return Err(recover::failure(scan.found, source));
    }
    match rule(&scan.clean) {
        Ok(pair) => {
            let mut build = Build::new(0);
            let node = node(&mut build, pair);
            Diagnostics::or(recover::join(&scan, build.found))?;
            Ok(node)
        }
        Err(stuck) => {
            let found = vec![explain::explain(&scan, &stuck, 0)];
            Err(recover::failure(recover::join(&scan, found), source))
        }
    }
}

/// Spans count bytes in 32 bits.
fn check_size(source: &Source) -> Result<(), Diagnostics> {
    if u32::try_from(source.text.len()).is_ok() {
        return Ok(());
    }
    let finding = Diagnostic::new(Code::SourceTooLarge, source.span(), "this spec is larger than 4 GiB");
    Err(finding.help("move long tables into files").into())
}
