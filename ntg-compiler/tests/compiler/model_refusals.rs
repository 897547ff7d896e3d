//! Everything that has no meaning is refused in words that help: one spec for each refusal in
//! `model_refusals/`, the smallest that shows it, and its messages word for word.

use std::collections::BTreeMap;
use std::sync::OnceLock;

use crate::model_support::{Files, findings_with};
use ntg_compiler::diagnostic::Code;

/// The files that the specs name.
fn files() -> Files {
    Files(vec![
        ("falling.csv", "# two columns\n0, 1\n2, 3\n1, 4\n"),
        ("ragged.csv", "0, 1\n2, 3, 5\n"),
        ("words.csv", "0, 1\n2, three\n"),
    ])
}

/// The name of each spec and what is found in it, made once.
fn refusals() -> &'static BTreeMap<String, String> {
    static REFUSALS: OnceLock<BTreeMap<String, String>> = OnceLock::new();
    REFUSALS.get_or_init(compile_refusals)
}

fn compile_refusals() -> BTreeMap<String, String> {
    let folder = format!("{}/tests/model_refusals", env!("CARGO_MANIFEST_DIR"));
    let entries = std::fs::read_dir(folder).expect("the folder is there");
    let read = |entry: std::io::Result<std::fs::DirEntry>| {
        let path = entry.expect("a readable folder").path();
        let name = path.file_stem().expect("a name").to_string_lossy().into_owned();
        (name, findings_with(&std::fs::read_to_string(&path).expect("a readable spec"), &files()))
    };
    entries.map(read).collect()
}

#[test]
fn every_refusal_reads_as_it_should() {
    let mut settings = insta::Settings::clone_current();
    settings.set_snapshot_path("snapshots/model_refusals");
    settings.set_prepend_module_to_snapshot(false);
    settings.set_omit_expression(true);
    settings.bind(|| {
        for (name, found) in refusals() {
            insta::assert_snapshot!(name.as_str(), found);
        }
    });
}

#[test]
fn every_refusal_has_the_code_of_its_name() {
    for (name, found) in refusals() {
        let code = name.split('_').next().expect("a first word");
        if code.len() == 4 && code.ends_with(|c: char| c.is_ascii_digit()) {
            assert!(found.contains(&format!("[{code}]")), "{name}:\n{found}");
        }
        assert!(!found.contains("not even parsed"), "{name}:\n{found}");
    }
}

#[test]
fn every_code_of_the_model_has_a_refusal() {
    let all: String = refusals().values().map(String::as_str).collect();
    let ours = Code::ALL.iter().filter(|code| {
        let number: u32 = code.text()[1..].parse().expect("a number");
        (code.text().starts_with('E') && (20..90).contains(&number)) || code.text().starts_with('N')
    });
    let missing: Vec<&str> = ours.map(|code| code.text()).filter(|text| !all.contains(&format!("[{text}]"))).collect();
    assert!(missing.is_empty(), "no spec shows {missing:?}");
}
