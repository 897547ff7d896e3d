//! Every spec of the repository has a meaning.

use crate::model_support::findings_with;
use ntg_compiler::model::Loader;

/// A folder of specs, for the files that they name.
struct Folder(&'static str);

impl Loader for Folder {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(format!("{}/../{}/{path}", env!("CARGO_MANIFEST_DIR"), self.0))
            .map_err(|e| e.to_string())
    }
}

#[test]
fn every_spec_of_the_repository_has_a_meaning() {
    let folder = format!("{}/../specs", env!("CARGO_MANIFEST_DIR"));
    let mut seen = 0;
    for entry in std::fs::read_dir(folder).expect("the specs are there") {
        let path = entry.expect("a readable folder").path();
        if path.extension().is_some_and(|extension| extension == "ntg") {
            let text = std::fs::read_to_string(&path).expect("a readable spec");
            let found = findings_with(&text, &Folder("specs"));
            println!("{}:\n{found}\n", path.display());
            assert!(!found.contains("error"), "{}:\n{found}", path.display());
            let notes = found.matches("note[").count();
            assert!(notes <= 3, "{}: {notes} notes\n{found}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 0);
}

/// The names of the gallery's specs, sorted.
fn gallery() -> Vec<String> {
    let folder = format!("{}/../specs/gallery", env!("CARGO_MANIFEST_DIR"));
    let entries = std::fs::read_dir(folder).expect("the gallery is there");
    let files = entries.map(|entry| entry.expect("a readable folder").file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = files.filter_map(|file| file.strip_suffix(".ntg").map(str::to_owned)).collect();
    names.sort();
    names
}

#[test]
fn every_spec_of_the_gallery_has_a_meaning_a_source_and_an_optimum_and_few_notes() {
    let names = gallery();
    assert!(names.len() >= 120, "{} specs", names.len());
    for name in names {
        let path = format!("{}/../specs/gallery/{name}.ntg", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).expect("a readable spec");
        let found = findings_with(&text, &Folder("specs/gallery"));
        assert!(!found.contains("error"), "{name}:\n{found}");
        let notes = found.matches("note[").count();
        assert!(notes <= 3, "{name}: {notes} notes\n{found}");
        for needed in ["\n/// Source: ", "\n/// Optimum: "] {
            assert!(text.contains(needed), "{name}: no `{}` in its documentation", needed.trim());
        }
    }
}

#[test]
fn the_gallery_and_its_expected_optima_name_the_same_specs() {
    let text = include_str!("../../../specs/gallery/expected.json");
    let expected: serde_json::Value = serde_json::from_str(text).expect("valid JSON");
    let expected = expected.as_object().expect("an object");
    let mut names: Vec<String> = expected.keys().cloned().collect();
    names.sort();
    assert_eq!(names, gallery());
    for (name, entry) in expected {
        assert!(entry["optimum"].is_f64() || entry["optimum"].is_i64(), "{name}: no optimum");
        let tolerance = entry["tolerance"].as_f64().expect("a tolerance");
        assert!(tolerance > 0.0 && tolerance <= 0.02, "{name}: a tolerance of {tolerance}");
        assert!(entry["source"].as_str().is_some_and(|source| !source.is_empty()), "{name}: no source");
    }
}
