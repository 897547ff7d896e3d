//! What the documents show is what the compiler takes.
//!
//! Every block of docs/language.md, docs/tutorial.md and docs/coming-from.md that is marked `ntg` compiles; one marked `ntg,error=E020` is
//! refused with that code. All that `ntg fmt` takes have its layout. The README's spec is a file under specs/, word for word.

use std::fs;
use std::path::{Path, PathBuf};

use ntg_compiler::compile;
use ntg_compiler::diagnostic::Code;
use ntg_compiler::model::Loader;
use ntg_compiler::source::Source;
use ntg_compiler::syntax;

/// The files that specs of the manual name.
struct ManualFiles;

impl Loader for ManualFiles {
    fn load(&self, path: &str) -> Result<String, String> {
        match path {
            "gates.csv" => Ok("# x, y, z in m\n4, 2, 1.5\n8, 0, 3\n10, 5, 2\n".to_owned()),
            "run.csv" => Ok("# time s, place m\n0, 1.01\n0.5, 0.55\n1, -0.35\n1.5, -0.75\n2.5, 0.1\n".to_owned()),
            _ => Err(format!("the manual's specs have no file `{path}`")),
        }
    }
}

/// A fenced block: what stands behind the fence, and its text.
struct Block {
    marks: String,
    text: String,
}

fn blocks(document: &str) -> Vec<Block> {
    let mut found: Vec<Block> = vec![];
    let mut open = false;
    for line in document.lines() {
        match (line.strip_prefix("```"), open) {
            (Some(marks), false) => found.push(Block { marks: marks.to_owned(), text: String::new() }),
            (None, true) => {
                let block = found.last_mut().expect("a block was opened");
                block.text.push_str(line);
                block.text.push('\n');
            }
            _ => {}
        }
        open ^= line.starts_with("```");
    }
    assert!(!open, "a fence is not closed");
    found.retain(|block| block.marks == "ntg" || block.marks.starts_with("ntg,"));
    found
}

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).to_owned()
}

fn read(path: &str) -> String {
    fs::read_to_string(root().join(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The codes of everything that is wrong with a spec, and how a person would read it.
fn errors(text: &str) -> (Vec<Code>, String) {
    let source = Source::new("manual.ntg", text);
    match compile(&source, &ManualFiles) {
        Ok(_) => (vec![], String::new()),
        Err(found) => {
            let words: Vec<String> = found.iter().map(|finding| finding.render(&source)).collect();
            (found.iter().map(|finding| finding.code).collect(), words.join("\n"))
        }
    }
}

#[test]
fn every_spec_of_the_manual_compiles_or_fails_as_it_says() {
    let pages = ["docs/language.md", "docs/tutorial.md", "docs/coming-from.md"].map(|page| blocks(&read(page)));
    assert!(pages[0].len() > 10, "only {} specs were found", pages[0].len());
    assert!(pages.iter().all(|blocks| !blocks.is_empty()));
    for block in pages.into_iter().flatten() {
        let (codes, words) = errors(&block.text);
        match block.marks.strip_prefix("ntg,error=") {
            None => assert!(codes.is_empty(), "{}\n{words}", block.text),
            Some(expected) => {
                assert_eq!(
                    codes.iter().map(|code| code.text()).collect::<Vec<_>>(),
                    [expected],
                    "{}\n{words}",
                    block.text
                );
            }
        }
    }
}

#[test]
fn every_spec_of_the_documents_has_the_layout_of_the_formatter() {
    let mut count = 0;
    for entry in fs::read_dir(root().join("docs")).expect("the documents") {
        let path = entry.expect("an entry").path();
        if path.extension().is_none_or(|extension| extension != "md") {
            continue;
        }
        let page = path.display().to_string();
        for block in blocks(&fs::read_to_string(&path).expect("a page")) {
            // What is shown for an error of syntax has no layout.
            let Ok(formatted) = syntax::format(&Source::new(page.as_str(), block.text.as_str())) else { continue };
            assert_eq!(block.text, formatted, "{page}: `ntg fmt` lays this out otherwise");
            count += 1;
        }
    }
    assert!(count > 40, "only {count} specs were found");
}

#[test]
fn the_readme_shows_a_spec_of_the_repository() {
    let blocks = blocks(&read("README.md"));
    assert_eq!(blocks.len(), 1);
    assert_eq!(blocks[0].text, read("specs/van_der_pol.ntg"));
}

#[test]
fn the_pictures_that_documents_show_exist() {
    for (document, folder) in [("README.md", ""), ("docs/language.md", "docs/"), ("docs/tutorial.md", "docs/")] {
        let text = read(document);
        for after in text.split("](").skip(1) {
            let target = after.split([')', '#']).next().unwrap_or_default();
            if target.ends_with(".svg") || target.ends_with(".png") {
                assert!(root().join(format!("{folder}{target}")).is_file(), "{document} shows {target}");
            }
        }
    }
}

#[test]
fn the_cart_of_those_who_come_from_elsewhere_takes_two_seconds() {
    let blocks = blocks(&read("docs/coming-from.md"));
    let source = Source::new("cart.ntg", &blocks[0].text);
    let compiled = compile(&source, &ManualFiles).expect("the page's spec");
    let problem = ntg_interp::Interpreted::new(&compiled.program);
    let report = ntg::runtime::solve(&problem, &ntg::prelude::Settings::default()).expect("a solve");
    assert!(report.is_solved(), "{report}");
    // Full push for half the way, full brake for the other: 1 = T^2 / 4.
    assert!((report.objective - 2.0).abs() < 1e-7, "{}", report.objective);
}
