//! Whatever stands in the editor, every question has an answer: truncations of all specs, and lost pieces.

use std::fs;
use std::path::Path;

use ntg_compiler::source::Span;
use ntg_lsp::analysis::{Analysis, Beside};
use ntg_lsp::{actions, complete, hover, outline, rename, signature};
use proptest::prelude::*;

/// All shipped specs, and one with every form of the language.
fn specs() -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    let mut paths: Vec<_> =
        fs::read_dir(root.join("specs")).expect("readable").map(|entry| entry.expect("readable").path()).collect();
    paths.retain(|path| path.extension().is_some_and(|extension| extension == "ntg"));
    paths.push(root.join("ntg-compiler/tests/syntax_specs/everything.ntg"));
    paths.sort();
    paths.iter().map(|path| fs::read_to_string(path).expect("readable")).collect()
}

/// Asks everything at a byte.
fn ask(text: &str, byte: usize) {
    let analysis = Analysis::new("spec.ntg", text.to_owned(), Beside(None));
    let places = [byte, byte.saturating_sub(3), 0, text.len(), text.len() + 9];
    for place in places {
        let place = text.floor_char_boundary(place);
        let position = analysis.lines.position(text, place);
        assert!(analysis.lines.byte(text, position) <= text.len());
        let _ = hover::hover(&analysis, place);
        let _ = complete::proposals(&analysis, place);
        let _ = signature::help(&analysis, place);
    }
    let _ = actions::fixes(&analysis, Span::new(text.floor_char_boundary(byte), text.floor_char_boundary(byte)));
    let _ = outline::symbols(&analysis);
    let _ = outline::layout(&analysis);
    let _ = rename::edits(&analysis, text.floor_char_boundary(byte), "other_name");
    for mention in &analysis.names().mentions {
        assert!(text.get(mention.span.start as usize..mention.span.end as usize).is_some());
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(60))]

    #[test]
    fn truncations_of_specs_are_answered(spec in any::<prop::sample::Index>(), at in any::<prop::sample::Index>()) {
        let specs = specs();
        let text = &specs[spec.index(specs.len())];
        let end = text.floor_char_boundary(at.index(text.len() + 1));
        ask(&text[..end], end);
        // The rest of the spec behind the cursor, with a piece missing.
        let resume = text.floor_char_boundary((end + 40).min(text.len()));
        ask(&format!("{}{}", &text[..end], &text[resume..]), end);
    }

    #[test]
    fn any_text_is_answered(text in "\\PC{0,80}", at in any::<prop::sample::Index>()) {
        ask(&text, at.index(text.len() + 1));
    }
}
