//! The libraries that a spec uses: read, and joined to it as scopes of their own.
//!
//! Takes the `use`s of a spec, gives one text in which the libraries stand behind the spec, so that every place in any
//! of them is a [`Span`] of that text, and their syntax trees.
//! Finds: libraries that do not exist, cannot be read, hold a problem, or use one another in a circle; names that a
//! library does not have.
//! Afterwards: [`Libraries::told`] gives every finding the places of the files that it is about.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};

use super::elaborator::Elaborator;
use super::scope::{Declared, PROBLEM, ScopeId, library_named};
use super::suggest::nearest;
use super::{Loader, loading};
use crate::diagnostic::{Code, Diagnostic, Diagnostics, InLibrary, Severity};
use crate::source::{Source, Span};
use crate::standard::{self, APPLIED, VALUES};
use crate::syntax::ast::{self, ItemKind, Use, UseTarget};
use crate::syntax::{self, FileKind};

/// A library's text and syntax tree, and what it uses itself.
pub(super) struct File {
    /// What identifies it: its path from the folder of the spec, or `std::rotation`.
    key: String,
    source: Arc<Source>,
    /// Where its text stands in the joined one.
    span: Span,
    pub(super) library: Arc<ast::Library>,
    /// For each of its `use`s, which file that is.
    uses: Vec<Option<usize>>,
    is_standard: bool,
    /// Whether its text is wrong.
    is_broken: bool,
    /// Where the spec says that it is used, itself or what uses it.
    used: Span,
}

/// All libraries of a spec.
pub(super) struct Libraries {
    /// The spec's text, and behind it those of the libraries.
    pub(super) joined: Source,
    /// Where the spec's own text ends.
    pub(super) main: u32,
    pub(super) files: Vec<File>,
    /// For each `use` of the spec, which file that is.
    pub(super) uses: Vec<Option<usize>>,
    found: Vec<Diagnostic>,
}

/// What stands beside the place in a library of the language that does not take the arguments of a call.
const MET: &str = "met here";

/// Texts of libraries of the language begin at multiples of this in the joined text, so that their places, which their
/// syntax trees hold, stay the same while someone writes a spec. A law: longer than what is typed between two pauses.
const STEP: usize = 1 << 14;
/// Syntax trees that are kept: those of all libraries for some lengths of a spec.
const KEPT: usize = 64;

/// The syntax tree of a library of the language at a place, read once.
fn parsed(key: &str, source: &Source, base: usize) -> Result<Arc<ast::Library>, Diagnostics> {
    type Known = BTreeMap<(String, usize), Arc<ast::Library>>;
    static READ: Mutex<Known> = Mutex::new(BTreeMap::new());
    let place = (key.to_owned(), base);
    if let Some(known) = lock(&READ).get(&place) {
        return Ok(known.clone());
    }
    let read = Arc::new(syntax::parse_library(source, base)?);
    let mut known = lock(&READ);
    if known.len() >= KEPT {
        known.clear();
    }
    known.insert(place, read.clone());
    Ok(read)
}

/// What another thread may have left behind in a panic is whole: trees are put in when they are read.
fn lock<T>(shared: &Mutex<T>) -> MutexGuard<'_, T> {
    shared.lock().unwrap_or_else(PoisonError::into_inner)
}

/// The folder of a path, with its slash.
fn folder(path: &str) -> &str {
    path.rfind('/').map_or("", |slash| &path[..=slash])
}

/// A path as seen from the spec, where a file in `folder` names it.
pub(super) fn joined(folder: &str, path: &str) -> String {
    if path.starts_with('/') || folder.is_empty() {
        return path.to_owned();
    }
    let mut parts: Vec<&str> = Vec::new();
    let whole = format!("{folder}{path}");
    for part in whole.split('/') {
        match (part, parts.last()) {
            ("." | "", Some(_)) | (".", None) => {}
            ("..", Some(last)) if *last != ".." => _ = parts.pop(),
            _ => parts.push(part),
        }
    }
    parts.join("/")
}

impl Libraries {
    /// Reads what a spec uses, and what that uses.
    pub(super) fn load(uses: &[Use], source: &Source, loader: &dyn Loader) -> Self {
        let main = Span::new(0, source.text.len()).end;
        let mut all = Self { joined: source.clone(), main, files: vec![], uses: vec![], found: vec![] };
        for item in uses {
            let file = all.file(item, ("", item.span), &mut vec![source.name.clone()], loader);
            all.uses.push(file);
        }
        all
    }

    /// A library by itself, as if a spec used it.
    pub(super) fn of_library(library: &Source, around: &Source, loader: &dyn Loader) -> Self {
        let mut all = Self::load(&[], around, loader);
        let read = Ok(library.clone());
        let item = Span::new(0, 0);
        let file = all.read((library.name.clone(), false), read, (item, item), &mut vec![], loader);
        all.uses.push(file);
        all
    }

    /// Which file a `use` means.
    fn file(
        &mut self,
        item: &Use,
        (importer, used): (&str, Span),
        open: &mut Vec<String>,
        loader: &dyn Loader,
    ) -> Option<usize> {
        let (key, is_standard) = match &item.target {
            UseTarget::Module(names) => (self.module(item, names)?, true),
            UseTarget::File(path) => (joined(folder(importer), path), false),
        };
        if let Some(at) = open.iter().position(|name| *name == key) {
            let mut circle = open[at..].to_vec();
            circle.push(key);
            let message = format!("libraries use each other in a circle: {}", circle.join(", "));
            let finding = Diagnostic::new(Code::WrongLibrary, item.target_span, message);
            self.found.push(finding.help("move what both need into a third library"));
            return None;
        }
        if let Some(known) = self.files.iter().position(|file| file.key == key) {
            return Some(known);
        }
        let read = match is_standard {
            true => Ok(Source::new(key.as_str(), standard::library(&key).unwrap_or_default())),
            false => loader.load(&key).map(|text| Source::new(key.as_str(), text)),
        };
        self.read((key, is_standard), read, (item.target_span, used), open, loader)
    }

    /// The name of a library of the language.
    fn module(&mut self, item: &Use, names: &[ast::Ident]) -> Option<String> {
        let text = names.iter().map(|name| name.text.as_str()).collect::<Vec<_>>().join("::");
        if standard::library(&text).is_some() {
            return Some(text);
        }
        let message = format!("there is no library `{text}`");
        let finding = Diagnostic::new(Code::WrongLibrary, item.target_span, message);
        let known = standard::names();
        let outer = names[..names.len() - 1].iter().map(|name| name.text.as_str()).collect::<Vec<_>>().join("::");
        let finding = match nearest(&text, known.iter().copied()) {
            _ if standard::library(&outer).is_some() => finding.help(format!(
                "names of a library stand in braces: `use {outer}::{{{}}};`",
                names[names.len() - 1].text
            )),
            _ if standard::library(&format!("std::{text}")).is_some() => {
                finding.help(format!("write `use std::{text};`"))
            }
            _ if names[0].text != "std" => finding.help(format!("a file is named in quotes: `use \"{text}.ntg\";`")),
            Some(near) => finding.help(format!("did you mean `{near}`?")),
            None => finding.help(format!("libraries of the language are {}", listed(&known))),
        };
        self.found.push(finding);
        None
    }

    fn read(
        &mut self,
        (key, is_standard): (String, bool),
        read: Result<Source, String>,
        (place, used): (Span, Span),
        open: &mut Vec<String>,
        loader: &dyn Loader,
    ) -> Option<usize> {
        let source = match read {
            Ok(source) => source,
            Err(why) => {
                let finding = Diagnostic::new(Code::WrongLibrary, place, format!("`{key}` cannot be read: {why}"));
                self.found.push(finding.help(loading::help(&why, "the file that names them")));
                return None;
            }
        };
        self.joined.text.push('\n');
        if is_standard {
            let blank = self.joined.text.len().next_multiple_of(STEP) - self.joined.text.len();
            self.joined.text.extend(std::iter::repeat_n(' ', blank));
        }
        let base = self.joined.text.len();
        self.joined.text.push_str(&source.text);
        let span = Span::new(base, self.joined.text.len());
        let mut is_broken = false;
        let parsed = match is_standard {
            true => parsed(&key, &source, base),
            false => syntax::parse_library(&source, base).map(Arc::new),
        };
        let library = match parsed {
            Ok(library) => library,
            Err(found) => {
                // A spec is refused as a whole: where it begins says enough.
                let holds_problem =
                    syntax::file_kind(&source) == FileKind::Spec && found.first().code == Code::WrongLibrary;
                if holds_problem {
                    let message = format!("`{key}` holds a problem; a library has only use, const, fn, table");
                    let finding = Diagnostic::new(Code::WrongLibrary, place, message);
                    self.found.push(finding.help("move what several problems share into a file of its own"));
                    return None;
                }
                self.found.extend(found);
                is_broken = true;
                Arc::new(ast::Library { uses: vec![], items: vec![] })
            }
        };
        let at = self.files.len();
        let uses = library.uses.clone();
        self.files.push(File {
            key: key.clone(),
            source: Arc::new(source),
            span,
            library,
            uses: vec![],
            is_standard,
            is_broken,
            used,
        });
        open.push(key.clone());
        let uses = uses.iter().map(|item| self.file(item, (&key, used), open, loader)).collect();
        open.pop();
        self.files[at].uses = uses;
        Some(at)
    }

    /// Findings with the places of the files that they are about: their own is in the spec, or in the library `home`.
    /// Notes about libraries are told where those are checked.
    pub(super) fn told(&self, found: Vec<Diagnostic>, home: Option<usize>) -> Vec<Diagnostic> {
        let all = self.found.iter().cloned().chain(found);
        let mut told: Vec<Diagnostic> = all.filter_map(|finding| self.told_one(finding, home)).collect();
        // One call of a library of the language is one mistake, however often its body meets it.
        let mut calls: Vec<Span> = vec![];
        told.retain(|finding| {
            let is_call = finding.libraries.iter().any(|library| library.labels.iter().any(|(_, text)| text == MET));
            let is_known = is_call && calls.contains(&finding.span);
            calls.extend(is_call.then_some(finding.span));
            !is_known
        });
        told
    }

    fn told_one(&self, mut finding: Diagnostic, home: Option<usize>) -> Option<Diagnostic> {
        if self.files.is_empty() {
            return Some(finding);
        }
        let file = |span: Span| self.files.iter().position(|file| file.span.contains(span));
        let own = |span: Span| if home.is_some() { file(span) == home } else { file(span).is_none() };
        let place = file(finding.span);
        let is_note = finding.severity != Severity::Error;
        let uses_here: Vec<Span> = finding.labels.iter().map(|(span, _)| *span).filter(|span| own(*span)).collect();
        if is_note
            && !own(finding.span)
            && (uses_here.is_empty() || place.is_some_and(|file| self.files[file].is_standard))
        {
            return None;
        }
        let mut places: Vec<(usize, Span, Option<String>)> = Vec::new();
        let mut labels = Vec::new();
        for (span, text) in std::mem::take(&mut finding.labels) {
            match file(span).filter(|_| !own(span)) {
                Some(file) => places.push((file, span, Some(text))),
                // What is no text of the spec, as around a library that is checked alone.
                None if home.is_some() && file(span).is_none() => {}
                None => labels.push((span, text)),
            }
        }
        if let Some(file) = place.filter(|_| !own(finding.span)) {
            places.push((file, finding.span, None));
            let used = labels.iter().find(|(_, text)| text.starts_with("in this use")).map(|(span, _)| *span);
            finding.span = used.or_else(|| uses_here.first().copied()).unwrap_or(self.files[file].used);
            // A library of the language is right: the place to mend is the call.
            if used.is_some()
                && self.files[file].is_standard
                && matches!(finding.code, Code::DimensionMismatch | Code::NotPure | Code::WildExponent)
                && let Some(last) = places.last_mut()
            {
                last.2 = Some(MET.to_owned());
                if !finding.help.as_deref().is_some_and(|help| help.contains("` took [")) {
                    finding.help = Some("give this function arguments of the units that its body needs".to_owned());
                }
            }
            if used.is_none() && !labels.iter().any(|(span, _)| *span == finding.span) {
                labels.push((finding.span, "used here".to_owned()));
            }
        }
        // A finding about the text around a library that is checked alone stands where it meets the library.
        if home.is_some() && place.is_none() {
            finding.span = uses_here.first().copied().unwrap_or_default();
        }
        let shift =
            |span: Span, base: u32| Span { start: span.start.saturating_sub(base), end: span.end.saturating_sub(base) };
        finding.labels = labels;
        if let Some(home) = home {
            let base = self.files[home].span.start;
            finding.span = shift(finding.span, base);
            finding.labels.iter_mut().for_each(|(span, _)| *span = shift(*span, base));
        }
        let mut libraries: Vec<InLibrary> = Vec::new();
        for (file, span, label) in places {
            let (base, source) = (self.files[file].span.start, &self.files[file].source);
            let known = libraries.iter().position(|library| Arc::ptr_eq(&library.source, source));
            let at = known.unwrap_or_else(|| {
                libraries.push(InLibrary { source: source.clone(), span: None, labels: vec![] });
                libraries.len() - 1
            });
            match label {
                Some(text) => libraries[at].labels.push((shift(span, base), text)),
                None => libraries[at].span = Some(shift(span, base)),
            }
        }
        finding.libraries = libraries;
        Some(finding)
    }
}

impl<'a> Elaborator<'a> {
    /// Makes a scope for each library, and gives every file the names that it uses.
    pub(super) fn libraries(&mut self, all: &'a Libraries, uses: &'a [Use]) {
        self.main = Some(all.main);
        let scopes: Vec<ScopeId> = all.files.iter().map(|file| self.library_scope(file)).collect();
        self.link(PROBLEM, uses, &all.uses, &scopes);
        for (file, scope) in all.files.iter().zip(&scopes) {
            self.link(*scope, &file.library.uses, &file.uses, &scopes);
        }
    }

    fn library_scope(&mut self, file: &'a File) -> ScopeId {
        let scope = self.add_scope(None, None, &file.library.items);
        self.scopes[scope].is_library = true;
        self.scopes[scope].is_broken = file.is_broken;
        if !file.is_standard {
            self.folders.insert(scope, folder(&file.key).to_owned());
        }
        for item in &file.library.items {
            if matches!(item.kind, ItemKind::Const(_) | ItemKind::Function(_) | ItemKind::Table(_)) {
                self.item(scope, item);
            }
        }
        scope
    }

    fn link(&mut self, scope: ScopeId, uses: &'a [Use], files: &[Option<usize>], scopes: &[ScopeId]) {
        for (item, file) in uses.iter().zip(files) {
            let Some(library) = file.map(|file| scopes[file]) else {
                self.lost.extend(item.names.iter().map(|name| name.text.as_str()));
                if item.names.is_empty() {
                    let name = self.library_name(item);
                    self.lost.extend(name);
                }
                continue;
            };
            for name in &item.names {
                self.used_name(scope, library, name);
            }
            if item.names.is_empty()
                && let Some(name) = self.library_name(item)
                && self.scopes[scope].libraries.insert(name, library).is_some_and(|before| before != library)
            {
                let finding =
                    Diagnostic::new(Code::DeclaredTwice, item.span, format!("two libraries are called `{name}`"));
                self.report(finding.help("give one of them another name: `use \"other.ntg\" as other;`"));
            }
        }
    }

    /// A name that a file takes from a library.
    fn used_name(&mut self, scope: ScopeId, library: ScopeId, name: &'a ast::Ident) {
        match self.scopes[library].names.get(name.text.as_str()).copied() {
            Some(Declared { entity, .. }) => self.declare(scope, name, Declared { entity, span: name.span }),
            None if self.scopes[library].is_broken => {}
            None => {
                self.lost.push(&name.text);
                let finding =
                    Diagnostic::new(Code::UnknownName, name.span, format!("the library has no `{}`", name.text));
                let names = self.scopes[library].order.clone();
                self.report(match nearest(&name.text, names.iter().copied()) {
                    Some(near) => finding.help(format!("did you mean `{near}`?")),
                    None => finding.help(format!("it has {}", listed(&names))),
                });
            }
        }
    }

    /// What a library is called where it is used.
    fn library_name(&mut self, item: &'a Use) -> Option<&'a str> {
        let name = match (&item.alias, &item.target) {
            (Some(alias), _) => return Some(&alias.text),
            (None, UseTarget::Module(names)) => return names.last().map(|name| name.text.as_str()),
            (None, UseTarget::File(path)) => {
                let file = path.rsplit('/').next().unwrap_or(path);
                file.strip_suffix(".ntg").unwrap_or(file)
            }
        };
        if syntax::is_name(name) {
            return Some(name);
        }
        let finding =
            Diagnostic::new(Code::WrongLibrary, item.target_span, format!("the file name `{name}` is no name"));
        let better: String = name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect();
        let better = if syntax::is_name(&better) { better } else { "library".to_owned() };
        self.report(finding.help(format!("add `as {better}`")));
        None
    }

    /// Whether a name is one of a library that could not be had or read, of which enough was told.
    pub(super) fn is_of_broken_library(&self, scope: ScopeId, name: &str) -> bool {
        let front = name.split("::").next().unwrap_or(name);
        if self.lost.contains(&front) {
            return true;
        }
        let library = name.rsplit_once("::").and_then(|(library, _)| library_named(&self.scopes, scope, library));
        library.is_some_and(|library| self.scopes[library].is_broken)
    }

    /// Keeps a library that no `use` names from being told of again.
    pub(super) fn tell_library_once(&mut self, scope: ScopeId, name: &'a str) {
        if let Some((library, _)) = name.rsplit_once("::")
            && library_named(&self.scopes, scope, library).is_none()
        {
            self.lost.push(library);
        }
    }

    /// What to write for a name that no library has, or that a library has.
    pub(super) fn library_help(&self, scope: ScopeId, name: &str) -> Option<String> {
        if let Some((library, inner)) = name.rsplit_once("::") {
            let Some(known) = library_named(&self.scopes, scope, library) else {
                let standard = format!("std::{library}");
                return Some(match standard::library(&standard) {
                    Some(_) => format!("write `use {standard};` before the problem"),
                    None => match nearest(library, self.scopes[scope].libraries.keys().copied()) {
                        Some(near) => format!("did you mean `{near}::{inner}`?"),
                        None => format!(
                            "no library is called `{library}` here: write `use \"{library}.ntg\";` before the problem"
                        ),
                    },
                });
            };
            let names = &self.scopes[known].order;
            let any = || [VALUES, APPLIED].iter().find_map(|kinds| standard::holder(inner, kinds));
            if let Some((library, own)) = any().filter(|_| names.iter().all(|name| *name != inner)) {
                return Some(format!("`{library}` has it: {}", taken_from(library, own)));
            }
            return Some(match nearest(inner, names.iter().copied()) {
                Some(near) => format!("did you mean `{library}::{near}`?"),
                None => format!("`{library}` has {}", listed(names)),
            });
        }
        let mut known: Vec<(&str, ScopeId)> = Vec::new();
        let mut next = Some(scope);
        while let Some(id) = next {
            known.extend(self.scopes[id].libraries.iter().map(|(name, id)| (*name, *id)));
            next = self.scopes[id].parent;
        }
        known.sort_unstable();
        if known.iter().any(|(library, _)| *library == name) {
            return Some(format!("`{name}` is a library: write `{name}::` and one of its names"));
        }
        let holder = known.iter().find(|(_, id)| self.scopes[*id].names.contains_key(name));
        holder.map(|(library, _)| format!("write `{library}::{name}`"))
    }

    /// What to write for a name that a library of the language has, where the spec does not use it.
    pub(super) fn in_standard(&self, name: &str, kinds: &[&str]) -> Option<String> {
        let (library, own) = standard::holder(name, kinds)?;
        Some(format!("`{library}` has it: {}", taken_from(library, own)))
    }

    /// What a table is called in results: behind the name of its library's file.
    pub(super) fn shown_name(&self, scope: ScopeId, name: &str) -> String {
        let library = self.scopes.iter().find_map(|other| {
            let mut known: Vec<&str> =
                other.libraries.iter().filter(|(_, id)| **id == scope).map(|(name, _)| *name).collect();
            known.sort_unstable();
            known.first().map(|library| (*library).to_owned())
        });
        let library = library.filter(|library| library != super::trial::NAME);
        library.map_or_else(|| name.to_owned(), |library| format!("{library}::{name}"))
    }
}

/// How a spec takes a name from a library of the language.
fn taken_from(library: &str, name: &str) -> String {
    let module = library.rsplit("::").next().unwrap_or(library);
    format!("write `use {library};` before the problem and `{module}::{name}` here")
}

/// Names for a message.
fn listed(names: &[&str]) -> String {
    let list: Vec<String> = names.iter().map(|name| format!("`{name}`")).collect();
    list.join(", ")
}
