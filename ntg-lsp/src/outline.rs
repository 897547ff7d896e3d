//! The document as an outline, and its layout.

use lsp_types::{DocumentSymbol, Position, Range, SymbolKind, TextEdit};
use ntg_compiler::syntax;

use crate::analysis::Analysis;
use crate::names::{Declaration, Kind};

/// Problem, agents and phases with what they declare.
pub fn symbols(analysis: &Analysis) -> Vec<DocumentSymbol> {
    let declarations = &analysis.names().declarations;
    let problem = declarations.iter().find(|declaration| declaration.kind == Kind::Problem);
    problem.map(|problem| symbol(analysis, problem)).into_iter().collect()
}

fn symbol(analysis: &Analysis, declaration: &Declaration) -> DocumentSymbol {
    let inside = declaration.inner.map(|scope| {
        let own = analysis.names().declarations.iter().filter(|inner| {
            inner.scope == scope && !matches!(inner.kind, Kind::Problem | Kind::Index | Kind::Argument | Kind::Step)
        });
        let mut own: Vec<&Declaration> = own.collect();
        own.sort_by_key(|inner| inner.name.span);
        own.into_iter().map(|inner| symbol(analysis, inner)).collect()
    });
    let range = |span| analysis.lines.range(&analysis.source.text, span);
    #[expect(deprecated, reason = "the protocol's type still has the field that it deprecates")]
    DocumentSymbol {
        name: declaration.name.text.clone(),
        detail: None,
        kind: kind(declaration.kind),
        tags: None,
        deprecated: None,
        range: range(declaration.statement.to(declaration.name.span)),
        selection_range: range(declaration.name.span),
        children: inside,
    }
}

fn kind(kind: Kind) -> SymbolKind {
    match kind {
        Kind::Problem => SymbolKind::CLASS,
        Kind::Agent | Kind::Phase | Kind::Scenario => SymbolKind::MODULE,
        Kind::Const => SymbolKind::CONSTANT,
        Kind::Param => SymbolKind::PROPERTY,
        Kind::Output => SymbolKind::FIELD,
        Kind::Function | Kind::Table => SymbolKind::FUNCTION,
        Kind::Constraint | Kind::Term => SymbolKind::EVENT,
        Kind::Variable | Kind::Duration | Kind::Domain | Kind::Let | Kind::Index | Kind::Argument | Kind::Step => {
            SymbolKind::VARIABLE
        }
    }
}

/// The edit that lays a document out: of the lines that change, so that an editor keeps its place in the others.
/// `None` for a spec that does not parse.
pub fn layout(analysis: &Analysis) -> Option<Vec<TextEdit>> {
    let old = &analysis.source.text;
    let new = syntax::format(&analysis.source).ok()?;
    if new == *old {
        return Some(vec![]);
    }
    let (old_lines, new_lines) = (lines(old), lines(&new));
    let same = |a: &&(&str, &str)| a.0 == a.1;
    let pairs: Vec<(&str, &str)> = old_lines.iter().copied().zip(new_lines.iter().copied()).collect();
    let before = pairs.iter().take_while(same).count();
    let room = pairs.len() - before;
    let ends: Vec<(&str, &str)> = old_lines.iter().rev().copied().zip(new_lines.iter().rev().copied()).collect();
    let after = ends.iter().take_while(same).count().min(room);
    let bytes = |lines: &[&str]| lines.iter().map(|line| line.len()).sum::<usize>();
    let place = |byte| analysis.lines.position(old, byte);
    let start: Position = place(bytes(&old_lines[..before]));
    let end = place(bytes(&old_lines[..old_lines.len() - after]));
    let new_text = new_lines[before..new_lines.len() - after].concat();
    Some(vec![TextEdit { range: Range { start, end }, new_text }])
}

/// Lines with their line breaks.
fn lines(text: &str) -> Vec<&str> {
    text.split_inclusive('\n').collect()
}
