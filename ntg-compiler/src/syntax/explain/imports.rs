//! The `use` that an `import` of another language means.

use crate::standard;
use crate::syntax::recover::text;
use crate::syntax::scan::{Scan, TokenKind};

/// Words by which other languages use libraries.
pub(in crate::syntax) const IMPORTING: [&str; 5] = ["import", "include", "from", "using", "require"];

/// What to write for the import at a token.
pub(in crate::syntax) fn as_use(scan: &Scan, at: usize) -> String {
    let line = line_of(scan, at);
    if let Some(file) = line.iter().find(|word| word.starts_with('"')) {
        return format!("`use {file};`");
    }
    let is_name = |word: &&&str| word.starts_with(unicode_ident::is_xid_start) && !IMPORTING.contains(*word);
    let names: Vec<&str> = line.iter().filter(is_name).copied().take_while(|word| *word != "as").collect();
    let known = names.iter().position(|name| standard::library(&format!("std::{name}")).is_some());
    let Some(known) = known else {
        let list: Vec<String> = standard::names().iter().map(|name| format!("`use {name};`")).collect();
        return format!("{}, or a file by its name, `use \"own.ntg\";`", list.join(", "));
    };
    match &names[known + 1..] {
        [] => format!("`use std::{};`", names[known]),
        inner => format!("`use std::{}::{{{}}};`", names[known], inner.join(", ")),
    }
}

/// The words from a token to the end of its statement or of its line.
fn line_of(scan: &Scan, at: usize) -> Vec<&str> {
    let tokens = scan.tokens[at..].iter().filter(|token| token.kind != TokenKind::Doc);
    let start = scan.tokens[at].span.start as usize;
    let line = tokens.take_while(|token| !scan.clean[start..token.span.start as usize].trim_start().contains('\n'));
    line.map(|token| text(scan, token)).take_while(|word| !matches!(*word, ";" | "{")).collect()
}
