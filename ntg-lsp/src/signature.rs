//! What stands in the parentheses around a place: the arguments of a function, a table or a setting, and which is next.
//!
//! Takes the text before the place alone, since behind it nothing is written yet.

use lsp_types::{Documentation, ParameterInformation, ParameterLabel, SignatureHelp, SignatureInformation};

use crate::analysis::Analysis;
use crate::complete;
use crate::explained::explained;
use crate::libraries;
use crate::names::Kind;

/// The signatures of what is called around a byte; none where nothing is.
pub fn help(analysis: &Analysis, byte: usize) -> Option<SignatureHelp> {
    let text = &analysis.source.text;
    let byte = text.floor_char_boundary(byte);
    if complete::is_in_comment(text, byte) {
        return None;
    }
    let (end, commas) = around(text, byte)?;
    let word = analysis.word(end);
    let name = analysis.source.slice(word);
    let uses = analysis.uses();
    let found: Vec<(String, Option<String>)> = if let Some((used, _, item)) = libraries::find(&uses, text, word) {
        vec![(used.head(item), item.doc.as_ref().map(|doc| doc.text.clone()))]
    } else if let Some((written, doc)) = declared(analysis, byte, name) {
        vec![(written, doc)]
    } else {
        let words = explained(name)?;
        calls(&words, name).map(|call| (call.to_owned(), Some(words.clone()))).collect()
    };
    let wanted = commas + 1;
    let signatures: Vec<SignatureInformation> =
        found.into_iter().filter_map(|(label, doc)| signature(label, name, doc)).collect();
    let count = |one: &SignatureInformation| one.parameters.as_ref().map_or(0, Vec::len);
    // Of several the first that has so many arguments.
    let active = signatures.iter().position(|one| count(one) >= wanted).or(signatures.len().checked_sub(1))?;
    // `hypot(a, b, ...)` goes on with its last one.
    let parameter = commas.min(count(&signatures[active]).saturating_sub(1));
    let narrow = |number| u32::try_from(number).ok();
    Some(SignatureHelp { signatures, active_signature: narrow(active), active_parameter: narrow(parameter) })
}

/// Where the name before the parenthesis around a byte ends, and how many commas stand between the two.
fn around(text: &str, byte: usize) -> Option<(usize, usize)> {
    let start = text[..byte].rfind([';', '{', '}']).map_or(0, |at| at + 1);
    let (mut depth, mut commas) = (0, 0);
    for (at, letter) in text[start..byte].char_indices().rev() {
        match letter {
            ')' | ']' => depth += 1,
            '(' | '[' if depth > 0 => depth -= 1,
            ',' if depth == 0 => commas += 1,
            '[' => commas = 0,
            '(' => {
                let before = text[start..start + at].trim_end();
                if before.ends_with(|c: char| c.is_alphanumeric() || c == '_') {
                    return Some((start + before.len(), commas));
                }
                // Parentheses without a name are an expression of what stands around them.
                commas = 0;
            }
            _ => {}
        }
    }
    None
}

/// A function or table of the text as it is declared, without its value, and its documentation.
fn declared(analysis: &Analysis, byte: usize, name: &str) -> Option<(String, Option<String>)> {
    let mut visible = analysis.names().visible(byte);
    let is_called = |kind| matches!(kind, Kind::Function | Kind::Table);
    let own = visible.find(|own| own.name.text == name && is_called(own.kind))?;
    let text = analysis.source.slice(own.statement);
    let end = text.find(['=', '{']).unwrap_or(text.len());
    let head = text[..end].split_whitespace().collect::<Vec<_>>().join(" ");
    Some((head.trim_end_matches(';').to_owned(), own.doc.clone()))
}

/// The calls of a name among words about it: `der(e)` and `der(e, 2)`.
fn calls<'t>(words: &'t str, name: &'t str) -> impl Iterator<Item = &'t str> {
    words.split('`').skip(1).step_by(2).filter_map(move |code| {
        let start = code.find(&format!("{name}("))?;
        let alone = !code[..start].ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let (_, inside) = inside(&code[start..])?;
        alone.then(|| &code[start..start + name.len() + inside.len() + 2])
    })
}

/// What stands in the first parentheses of a text, and where it begins.
fn inside(text: &str) -> Option<(usize, &str)> {
    let open = text.find('(')?;
    let mut depth = 0;
    for (at, letter) in text[open..].char_indices() {
        match letter {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return Some((open + 1, &text[open + 1..open + at]));
        }
    }
    None
}

/// A label with its arguments; none of what has no parentheses.
fn signature(label: String, name: &str, doc: Option<String>) -> Option<SignatureInformation> {
    let from = label.find(name)?;
    let (start, arguments) = inside(&label[from..])?;
    let units = |end: usize| label[..end].chars().map(char::len_utf16).sum::<usize>() as u32;
    let (mut parameters, mut depth, mut begin) = (vec![], 0, 0);
    let ends = arguments.char_indices().chain(std::iter::once((arguments.len(), ',')));
    for (at, letter) in ends {
        match letter {
            '(' | '[' => depth += 1,
            ')' | ']' => depth -= 1,
            ',' if depth == 0 => {
                let own = &arguments[begin..at];
                let first = from + start + begin + (own.len() - own.trim_start().len());
                let label = ParameterLabel::LabelOffsets([units(first), units(from + start + at)]);
                parameters.push(ParameterInformation { label, documentation: None });
                begin = at + 1;
            }
            _ => {}
        }
    }
    let documentation = doc.map(Documentation::String);
    Some(SignatureInformation { label, documentation, parameters: Some(parameters), active_parameter: None })
}
