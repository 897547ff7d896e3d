//! Renaming: every place where a name stands, changed at once, or a reason why not.

use lsp_types::TextEdit;

use crate::analysis::Analysis;
use crate::names::Kind;

/// The edits that give the name at a byte another one.
///
/// # Errors
/// A sentence for the user: there is no name, or the new one does not do.
pub fn edits(analysis: &Analysis, byte: usize, new: &str) -> Result<Vec<TextEdit>, String> {
    let mention = analysis.names().at(byte).ok_or("there is no name here that this spec declares")?;
    let first = *mention.declarations.first().ok_or("this name is not declared")?;
    let places = analysis.names().places(&analysis.names().together(first));
    let mut text = analysis.source.text.clone();
    for place in places.iter().rev() {
        text.replace_range(place.start as usize..place.end as usize, new);
    }
    // The compiler knows best which names do: the renamed spec must have the same errors, and the same mentions.
    let renamed = analysis.with(text);
    let kind = analysis.names().declarations[first].kind;
    let worse = renamed.found.iter().find(|_| renamed.errors() > analysis.errors());
    if let Some(finding) = worse {
        return Err(format!("`{new}` does not do: {}", finding.message));
    }
    let is_free = matches!(kind, Kind::Term | Kind::Constraint | Kind::Problem);
    if !is_free && renamed.names().mentions.len() != analysis.names().mentions.len() {
        return Err(format!("`{new}` does not do: it would change what other names stand for"));
    }
    if !is_free && joined(&renamed) != joined(analysis) {
        return Err(format!("`{new}` does not do: another thing has that name here"));
    }
    let range = |place| analysis.lines.range(&analysis.source.text, place);
    Ok(places.into_iter().map(|place| TextEdit { range: range(place), new_text: new.to_owned() }).collect())
}

/// What each mention stands for, in order of place: what a renaming must not change.
fn joined(analysis: &Analysis) -> Vec<&[usize]> {
    analysis.names().mentions.iter().map(|mention| mention.declarations.as_slice()).collect()
}
