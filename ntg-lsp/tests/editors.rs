//! The colours of editors follow the compiler's own lists of words.

use std::fs;
use std::path::{Path, PathBuf};

use ntg_compiler::syntax::{EXPRESSION_WORDS, ITEM_WORDS};
use serde_json::Value;

fn editors() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../editors")
}

fn json(path: &str) -> Value {
    let path = editors().join(path);
    let text = fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()));
    serde_json::from_str(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The words of a pattern `\b(one|two)\b`.
fn words(pattern: &Value) -> Vec<&str> {
    let pattern = pattern["match"].as_str().expect("a pattern");
    let list = pattern.strip_prefix(r"\b(").and_then(|rest| rest.strip_suffix(r")\b")).expect("a list of words");
    list.split('|').collect()
}

#[test]
fn the_textmate_grammar_reserves_the_compilers_words() {
    let grammar = json("vscode/syntaxes/ntg.tmLanguage.json");
    let keywords = grammar["repository"]["keywords"]["patterns"].as_array().expect("a list");
    let lists = [("declaration", ITEM_WORDS), ("control", EXPRESSION_WORDS)];
    for (name, expected) in lists {
        let is_it = |pattern: &&Value| pattern["name"].as_str().is_some_and(|full| full.contains(name));
        let pattern = keywords.iter().find(is_it).unwrap_or_else(|| panic!("no pattern for {name}"));
        assert_eq!(words(pattern), expected, "{name}");
    }
}

#[test]
fn the_extension_names_only_files_that_are_there() {
    let package = json("vscode/package.json");
    let contributes = &package["contributes"];
    for (list, key) in [("languages", "configuration"), ("grammars", "path")] {
        for entry in contributes[list].as_array().expect("a list") {
            let path = entry[key].as_str().expect("a path");
            assert!(editors().join("vscode").join(path).is_file(), "{path}");
        }
    }
    assert_eq!(contributes["languages"][0]["extensions"], serde_json::json!([".ntg"]));
    assert_eq!(contributes["grammars"][0]["scopeName"], json("vscode/syntaxes/ntg.tmLanguage.json")["scopeName"]);
    json("vscode/language-configuration.json");
}
