//! Every spec of the repository has a meaning.

mod model_support;

use model_support::findings_with;
use ntg_compiler::model::Loader;

/// The folder of the specs, for the tables that they name.
struct Folder;

impl Loader for Folder {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(format!("{}/../specs/{path}", env!("CARGO_MANIFEST_DIR"))).map_err(|e| e.to_string())
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
            let found = findings_with(&text, &Folder);
            println!("{}:\n{found}\n", path.display());
            assert!(!found.contains("error"), "{}:\n{found}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 0);
}

/// The blocks of the manual that are whole specs, with the code that each is to show, if any.
fn manual() -> Vec<(Option<String>, String)> {
    let text = include_str!("../../docs/language.md");
    let mut blocks = Vec::new();
    let mut open: Option<(Option<String>, String)> = None;
    for line in text.lines() {
        match (&mut open, line.strip_prefix("```")) {
            (None, Some(info)) if info == "ntg" || info.starts_with("ntg,") => {
                let code = info.split("error=").nth(1).map(|code| code.trim().to_owned());
                open = Some((code, String::new()));
            }
            (Some(_), Some(_)) => blocks.extend(open.take()),
            (Some((_, block)), None) => *block += &format!("{line}\n"),
            _ => {}
        }
    }
    blocks
}

#[test]
fn the_manual_means_what_it_says() {
    let blocks = manual();
    assert!(blocks.len() > 5, "the manual has examples");
    for (code, block) in blocks {
        let found = findings_with(&block, &Folder);
        match code {
            None => assert!(!found.contains("error["), "{block}\n{found}"),
            Some(_) => assert!(found.contains("error["), "{block}\n{found}"),
        }
    }
}
