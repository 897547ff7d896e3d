//! The libraries that a text uses: their names, for completion, hover and definition.
//!
//! Takes the text and where its files are, gives what its `use`s lead to; a text that is being typed is read line by line,
//! so that a broken statement elsewhere hides nothing.

use std::path::PathBuf;

use ntg_compiler::model::Loader;
use ntg_compiler::source::{Source, Span};
use ntg_compiler::standard;
use ntg_compiler::syntax::ast::{Ident, Item, ItemKind, Library};
use ntg_compiler::syntax::{self, FileKind};

use crate::analysis::Beside;

/// A library as it is used.
pub struct Used {
    /// What it is called in the text.
    pub name: String,
    /// The names that are used without the library's own before them.
    pub names: Vec<String>,
    /// The library's text.
    pub source: Source,
    /// Its file; none for those of the language.
    pub path: Option<PathBuf>,
    /// What it declares.
    pub library: Library,
}

/// Every library that a text uses and that can be read.
pub fn used(source: &Source, loader: &Beside) -> Vec<Used> {
    source
        .text
        .split_inclusive(';')
        .map(statement)
        .take_while(|line| line.starts_with("use"))
        .filter_map(|line| of(line, loader))
        .collect()
}

/// A statement without the comments before it.
fn statement(text: &str) -> &str {
    let mut rest = text.trim();
    while rest.starts_with("//") {
        rest = rest.split_once('\n').map_or("", |(_, rest)| rest).trim_start();
    }
    rest
}

fn of(line: &str, loader: &Beside) -> Option<Used> {
    let line = line.strip_prefix("use")?.trim_end_matches(';').trim();
    let (target, rest) = match line.strip_prefix('"') {
        Some(quoted) => quoted.split_once('"').map(|(path, rest)| (path.to_owned(), rest))?,
        None => {
            let end = line.find("::{").or_else(|| line.find(" as ")).unwrap_or(line.len());
            (line[..end].replace(' ', ""), &line[end..])
        }
    };
    let alias = rest.split_once("as ").map(|(_, alias)| alias.trim().to_owned());
    let names = rest.split_once('{').map_or(vec![], |(_, list)| {
        list.trim_end_matches('}')
            .split(',')
            .map(|name| name.trim().to_owned())
            .filter(|name| !name.is_empty())
            .collect()
    });
    let (text, path, name) = match standard::library(&target) {
        Some(text) => (text.to_owned(), None, target.rsplit("::").next()?.to_owned()),
        None => {
            let file = target.rsplit('/').next().unwrap_or(&target);
            let name = file.strip_suffix(".ntg").unwrap_or(file).to_owned();
            (loader.load(&target).ok()?, loader.0.as_ref().map(|folder| folder.join(&target)), name)
        }
    };
    let source = Source::new(target, text);
    if syntax::file_kind(&source) != FileKind::Library {
        return None;
    }
    let library = syntax::parse_library(&source, 0).ok()?;
    Some(Used { name: alias.unwrap_or(name), names, source, path, library })
}

impl Used {
    /// What it declares: each name with its statement.
    pub fn items(&self) -> impl Iterator<Item = (&Ident, &Item)> {
        self.library.items.iter().filter_map(|item| {
            let name = match &item.kind {
                ItemKind::Const(it) => &it.name,
                ItemKind::Function(it) => &it.name,
                ItemKind::Table(it) => &it.name,
                _ => return None,
            };
            Some((name, item))
        })
    }

    /// What its first line says that it is.
    pub fn about(&self) -> Option<&str> {
        let line = self.source.text.lines().next()?.trim();
        line.strip_prefix("//").map(|rest| rest.trim_start_matches('/').trim()).filter(|line| !line.is_empty())
    }

    /// A declaration without the steps or rows in its braces.
    pub fn head(&self, item: &Item) -> String {
        let text = self.source.slice(item.span);
        let brace = if matches!(item.kind, ItemKind::Const(_)) { None } else { text.find('{') };
        let end = brace.map_or(item.span.end as usize, |brace| item.span.start as usize + brace);
        self.source.snippet(Span::new(item.span.start as usize, end))
    }
}

/// The declaration that a word at a place stands for, if the text before it says a library: `air::density`.
pub fn find<'u>(uses: &'u [Used], text: &str, word: Span) -> Option<(&'u Used, &'u Ident, &'u Item)> {
    let name = &text[word.start as usize..word.end as usize];
    let library = behind(text, word.start as usize);
    let one = |used: &'u Used| used.items().find(|(own, _)| own.text == name).map(|(own, item)| (used, own, item));
    match library {
        Some(library) => uses.iter().filter(|used| used.name == library).find_map(one),
        None => uses.iter().filter(|used| used.names.iter().any(|own| own == name)).find_map(one),
    }
}

/// The library before a place, where `::` stands there.
pub fn behind(text: &str, at: usize) -> Option<&str> {
    let before = text[..at].trim_end().strip_suffix("::")?.trim_end();
    let start = before.char_indices().rev().take_while(|(_, c)| c.is_alphanumeric() || *c == '_').last()?.0;
    Some(&before[start..])
}
