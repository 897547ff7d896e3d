//! What the text of a spec says of its quantities and the compiled problem does not: which arrays are vectors, and
//! which named expressions only serve others.

use std::collections::BTreeSet;

use indexmap::IndexMap;
use ntg_compiler::source::Source;
use ntg_compiler::syntax::{self, ast};

use super::measured::{self, Sides};

/// What was read.
#[derive(Debug, Default)]
pub(crate) struct Reading {
    /// Arrays whose last index counts elements of a vector, with their number.
    pub(crate) vectors: IndexMap<String, usize>,
    /// Parameters of one index that the spec never uses as a whole: lists of numbers, and no vectors.
    pub(crate) lists: BTreeSet<String>,
    /// Named expressions that nobody asked to see: without documentation and unit, and in no constraint or objective.
    pub(crate) helpers: BTreeSet<String>,
    /// The statements of `measure`.
    pub(crate) measured: Vec<Sides>,
}

/// Reads a spec; nothing where it cannot be read.
pub(crate) fn read(source: &Source) -> Reading {
    let Ok(spec) = syntax::parse(source) else { return Reading::default() };
    let mut found = Found::default();
    found.items(&spec.problem.items, source);
    let helpers = found.plain.iter().filter(|name| !found.wanted.contains(*name)).cloned().collect();
    let is_list = |name: &String| !is_used_whole(&source.text, name);
    let lists = found.parameters.into_iter().filter(is_list).collect();
    Reading { vectors: found.vectors, helpers, lists, measured: found.measured }
}

/// Whether a name stands somewhere without an index behind it. Its declaration has its size there.
fn is_used_whole(text: &str, name: &str) -> bool {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    code.into_iter().any(|line| {
        line.match_indices(name).any(|(at, _)| {
            let (before, behind) = (&line[..at], &line[at + name.len()..]);
            !before.ends_with(is_part) && !behind.starts_with(is_part) && !behind.trim_start().starts_with('[')
        })
    })
}

#[derive(Default)]
struct Found {
    vectors: IndexMap<String, usize>,
    /// Named expressions without documentation and unit.
    plain: BTreeSet<String>,
    /// Parameters with one index.
    parameters: BTreeSet<String>,
    /// Words of constraints and objectives.
    wanted: BTreeSet<String>,
    measured: Vec<Sides>,
}

impl Found {
    fn items(&mut self, items: &[ast::Item], source: &Source) {
        for item in items {
            match &item.kind {
                ast::ItemKind::Output(output) => {
                    for name in &output.names {
                        self.shape(&name.name.text, name.shape.as_ref());
                    }
                }
                ast::ItemKind::Param(param) if param.shape.as_ref().is_some_and(|shape| shape.axes.len() == 1) => {
                    self.parameters.insert(param.name.text.clone());
                }
                ast::ItemKind::Let(declared) => {
                    self.shape(&declared.name.text, declared.shape.as_ref());
                    if let ast::ExprKind::Tuple(elements) = &declared.value.kind
                        && declared.shape.is_none()
                    {
                        self.vectors.insert(declared.name.text.clone(), elements.len());
                    }
                    if item.doc.is_none() && declared.unit.is_none() {
                        self.plain.insert(declared.name.text.clone());
                    }
                }
                ast::ItemKind::Agent(agent) => self.items(&agent.items, source),
                ast::ItemKind::Phase(phase) => self.items(&phase.items, source),
                ast::ItemKind::Objective(_) | ast::ItemKind::Block(_) | ast::ItemKind::At(_) => {
                    if let ast::ItemKind::Block(block) = &item.kind
                        && block.place == ast::BlockPlace::Measure
                    {
                        measured::sides(&block.statements, source, &mut self.measured);
                    }
                    let words = source.text.get(item.span.start as usize..item.span.end as usize).unwrap_or_default();
                    let words = words.split(|c: char| !(c.is_alphanumeric() || c == '_'));
                    self.wanted.extend(words.filter(|word| !word.is_empty()).map(str::to_owned));
                }
                _ => {}
            }
        }
    }

    fn shape(&mut self, name: &str, shape: Option<&ast::Shape>) {
        let Some(last) = shape.and_then(|shape| shape.axes.last()) else { return };
        let number = |expr: &ast::Expr| match &expr.kind {
            ast::ExprKind::Number(number) => Some(number.value),
            _ => None,
        };
        let begins = last.first.as_ref().is_none_or(|first| number(first) == Some(1.0));
        for size in [2, 3] {
            if begins && number(&last.last) == Some(size as f64) {
                self.vectors.insert(name.to_owned(), size);
            }
        }
    }
}
