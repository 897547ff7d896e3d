//! Names of libraries in an editor: what may stand behind `std::`, what a name says, where it is declared.

use std::path::Path;

use ntg_lsp::analysis::{Analysis, Beside};
use ntg_lsp::complete::proposals;
use ntg_lsp::hover::hover;
use ntg_lsp::libraries;

/// A text with its place marked by `|`.
fn at(text: &str) -> (Analysis, usize) {
    let byte = text.find('|').expect("a mark");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/library");
    (Analysis::new("spec.ntg", text.replace('|', ""), Beside(Some(folder))), byte)
}

fn labels(text: &str) -> Vec<String> {
    let (analysis, byte) = at(text);
    proposals(&analysis, byte).into_iter().map(|item| item.label).collect()
}

const BODY: &str =
    "problem P { duration T = 5 [s]; output h [m]: spline(order = 5, intervals = 2); minimize integral(h^2);";

#[test]
fn behind_std_stand_the_libraries_of_the_language() {
    let labels = labels("use std::|");
    assert!(
        ["rotation", "atmosphere", "gravity"].iter().all(|name| labels.iter().any(|label| label == name)),
        "{labels:?}"
    );
    assert!(!labels.iter().any(|label| label == "let"), "{labels:?}");
}

#[test]
fn behind_a_library_stand_its_names_and_nothing_else() {
    for text in [
        format!("use std::atmosphere;\n{BODY} let a = atmosphere::|"),
        format!("use std::atmosphere as air;\n{BODY} let a = air::den| }}"),
        "use std::atmosphere::{|".to_owned(),
    ] {
        let labels = labels(&text);
        assert!(labels.iter().any(|label| label == "density"), "{text}: {labels:?}");
        assert!(!labels.iter().any(|label| label == "sqrt" || label == "h"), "{text}: {labels:?}");
    }
    assert!(labels(&format!("use \"wind.ntg\";\n{BODY} let a = wind::|")).contains(&"gust".to_owned()));
    assert!(labels(&format!("use \"wind.ntg\";\n{BODY} let a = |")).contains(&"wind".to_owned()));
}

#[test]
fn a_name_of_a_library_shows_its_declaration_and_documentation() {
    let (analysis, byte) = at(&format!("use std::atmosphere;\n{BODY} let a = atmosphere::den|sity(h); }}"));
    assert!(analysis.found.is_empty(), "{:?}", analysis.found);
    let (text, _) = hover(&analysis, byte).expect("something is known");
    assert!(text.contains("fn density(h [m]) [kg/m^3]") && text.contains("Density over geometric height"), "{text}");
    let (analysis, byte) =
        at(&format!("use std::rotation::{{about_x}};\n{BODY} let a = norm(about|_x(1) * (1, 0, 0)); }}"));
    let (text, _) = hover(&analysis, byte).expect("something is known");
    assert!(text.contains("fn about_x(a) [3, 3]"), "{text}");
}

#[test]
fn a_name_of_a_file_leads_into_that_file() {
    let (analysis, byte) = at(&format!("use \"wind.ntg\";\n{BODY} let a = wind::gu|st(h); }}"));
    assert!(analysis.found.is_empty(), "{:?}", analysis.found);
    let uses = analysis.uses();
    let (used, name, _) = libraries::find(&uses, &analysis.source.text, analysis.word(byte)).expect("it is declared");
    assert!(used.path.as_ref().is_some_and(|path| path.ends_with("tests/library/wind.ntg")));
    assert_eq!(used.source.slice(name.span), "gust");
}

#[test]
fn a_library_itself_has_names_and_findings() {
    let (analysis, byte) = at("/// At the ground.\nconst calm = 2 [m/s];\nfn gust(h [m]) [m/s] = ca|lm + h;\n");
    assert_eq!(analysis.errors(), 1, "{:?}", analysis.found);
    let (text, _) = hover(&analysis, byte).expect("something is known");
    assert!(text.contains("const calm = 2 [m/s]"), "{text}");
}
