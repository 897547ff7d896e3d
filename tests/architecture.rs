//! The floors of the house: what may not know what (ARCHITECTURE.md).

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;

/// All Rust files below a folder of the workspace, with their text.
fn files(folder: &str) -> Vec<(PathBuf, String)> {
    let mut found = Vec::new();
    let mut open = vec![Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(&folder).unwrap_or_else(|e| panic!("{}: {e}", folder.display())) {
            let path = entry.expect("a readable folder").path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|e| e == "rs") {
                let text = fs::read_to_string(&path).expect("a readable file");
                found.push((path, text));
            }
        }
    }
    assert!(!found.is_empty(), "nothing to check in {folder}");
    found
}

/// The part of a file that ships: what stands before its tests.
fn shipped(text: &str) -> &str {
    text.split("#[cfg(test)]").next().unwrap_or(text)
}

/// Asserts that no shipped line below `folder` holds one of the words, except in the named file.
#[track_caller]
fn forbid(folder: &str, words: &[&str], except: Option<&str>) {
    for (path, text) in files(folder) {
        if except.is_some_and(|name| path.ends_with(name)) {
            continue;
        }
        for (number, line) in shipped(&text).lines().enumerate() {
            let code = line.split("//").next().unwrap_or("");
            for word in words {
                assert!(!code.contains(word), "{}:{}: `{word}` does not belong here", path.display(), number + 1);
            }
        }
    }
}

/// Asserts that no `static` below `folder` can hold another value later, except in the named file.
fn forbid_statics_that_change(folder: &str, except: &str) {
    for (path, text) in files(folder).into_iter().filter(|(path, _)| !path.ends_with(except)) {
        for (number, line) in shipped(&text).lines().enumerate() {
            let is_static = line.split_whitespace().take(2).any(|word| word == "static");
            let changes = ["OnceLock<", "LazyLock<", "Mutex<", "RwLock<", "Atomic", "OnceCell<"];
            let found = changes.iter().find(|word| is_static && line.contains(**word));
            assert!(found.is_none(), "{}:{}: a global, `{}`", path.display(), number + 1, line.trim());
        }
    }
}

/// The modules of a crate from which a file takes anything: what follows `crate::`, or as many `super::` as lead to the
/// root of the crate, groups in braces included. `depth` says how many that are.
fn modules_used(text: &str, depth: usize) -> BTreeSet<String> {
    let code: String =
        shipped(text).lines().map(|line| line.split("//").next().unwrap_or("")).collect::<Vec<_>>().join("\n");
    let to_root = "super::".repeat(depth);
    let mut found = BTreeSet::new();
    for root in ["crate::", &to_root] {
        for (at, _) in code.match_indices(root) {
            // `super::` in the middle of a longer run of them leads elsewhere.
            let before = code[..at].chars().next_back();
            if before.is_some_and(|c| c.is_alphanumeric() || c == '_' || c == ':') {
                continue;
            }
            first_names(&code[at + root.len()..], &mut found);
        }
    }
    found
}

/// The first name of a path, or the first names of all paths of a group in braces.
fn first_names(path: &str, found: &mut BTreeSet<String>) {
    let name = |text: &str| text.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect::<String>();
    let Some(group) = path.strip_prefix('{') else {
        found.insert(name(path));
        return;
    };
    let (mut depth, mut begins) = (1, true);
    for (at, c) in group.char_indices() {
        match c {
            '{' => depth += 1,
            '}' if depth == 1 => return,
            '}' => depth -= 1,
            ',' if depth == 1 => begins = true,
            c if begins && (c.is_alphanumeric() || c == '_') => {
                found.insert(name(&group[at..]));
                begins = false;
            }
            _ => {}
        }
    }
}

/// Asserts that every module of a crate takes from modules on lower floors only. Modules of one floor do not know each
/// other, and every module stands on a floor.
#[track_caller]
fn assert_floors(folder: &str, floors: &[&[&str]]) {
    let floor_of = |module: &str| floors.iter().position(|floor| floor.contains(&module));
    for (path, text) in files(folder) {
        let inside = path.strip_prefix(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).expect("below");
        let names: Vec<String> =
            inside.components().map(|c| c.as_os_str().to_string_lossy().replace(".rs", "")).collect();
        if names[0] == "lib" {
            continue;
        }
        let own = floor_of(&names[0]).unwrap_or_else(|| panic!("`{}` stands on no floor of {folder}", names[0]));
        let depth = names.iter().filter(|name| *name != "mod").count();
        for used in modules_used(&text, depth).iter().filter(|used| **used != names[0]) {
            let below = floor_of(used).is_none_or(|floor| floor < own);
            assert!(below, "{} looks up to `{used}`", path.display());
        }
    }
}

#[test]
fn modules_are_found_however_they_are_imported() {
    let text = "use crate::one::A;\nuse crate::{two, three::{self, B}, four::C};\nfn f() { super::super::five::g() }\n\
                // use crate::six;\nuse super::seven;\n#[cfg(test)]\nmod tests { use crate::eight; }";
    let found: Vec<String> = modules_used(text, 2).into_iter().collect();
    assert_eq!(found, ["five", "four", "one", "three", "two"]);
    assert!(modules_used("use super::seven;", 1).contains("seven"));
}

#[test]
fn no_floor_of_the_compiler_knows_a_floor_above_it() {
    let floors = FLOORS.map(|floor| [floor]);
    let known = |module: &str| FLOORS.contains(&module);
    for (path, text) in files("ntg-compiler/src") {
        let inside = path.strip_prefix(Path::new(env!("CARGO_MANIFEST_DIR")).join("ntg-compiler/src")).expect("below");
        let names: Vec<String> =
            inside.components().map(|c| c.as_os_str().to_string_lossy().replace(".rs", "")).collect();
        let Some(floor) = floors.iter().position(|f| f[0] == names[0]) else { continue };
        let depth = names.iter().filter(|name| *name != "mod").count();
        for used in modules_used(&text, depth).iter().filter(|used| known(used)) {
            let below = FLOORS.iter().position(|f| f == used).is_some_and(|used| used <= floor);
            assert!(below, "{} looks up to `{used}`", path.display());
        }
    }
}

const FLOORS: [&str; 6] = ["source", "diagnostic", "syntax", "model", "program", "codegen"];

#[test]
fn no_floor_of_the_solver_knows_a_floor_above_it() {
    let floors: &[&[&str]] = &[
        &["contract", "options", "reductions"],
        &["closures", "erased", "sparse", "status"],
        &["check", "scaling", "sizes"],
        &["kkt", "residuals"],
        &["outcome"],
        &["posed", "remeasure", "sensitivity", "stopping"],
        &["ipm"],
        &["sqp"],
        &["method"],
    ];
    assert_floors("ntg-nlp/src", floors);
}

#[test]
fn no_floor_of_the_runtime_knows_a_floor_above_it() {
    let floors: &[&[&str]] = &[
        &["digits"],
        &["math", "problem", "settings", "status"],
        &["lanes", "transcribe"],
        &["error", "solution"],
        &["guess", "report"],
        &["explain", "sensitivity", "strategy"],
        &["refine"],
        &["solve"],
        &["multistart"],
        &["solver"],
    ];
    assert_floors("ntg-runtime/src", floors);
}

#[test]
fn the_algebra_of_expressions_imports_nothing_of_ours_but_functions_of_numbers() {
    let words: Vec<String> = FLOORS
        .iter()
        .map(|f| format!("crate::{f}"))
        .chain(["ntg_s", "ntg_r", "ntg_c", "ntg_i"].map(String::from))
        .collect();
    forbid("ntg-compiler/src/expr", &words.iter().map(String::as_str).collect::<Vec<_>>(), None);
}

#[test]
fn the_compiler_does_no_input_or_output_and_reads_no_clock() {
    forbid(
        "ntg-compiler/src",
        &["std::fs", "std::env", "std::time", "std::io", "std::net", "println!", "eprintln!", "proc_macro::"],
        None,
    );
}

#[test]
fn pest_stays_in_the_syntax_folder() {
    for room in ["model", "program", "codegen", "expr", "diagnostic"] {
        forbid(&format!("ntg-compiler/src/{room}"), &["pest::", "pest_derive", "use pest"], None);
    }
}

#[test]
fn code_generation_knows_no_calculus_and_the_algebra_no_rust() {
    forbid("ntg-compiler/src/codegen", &["gradient(", "hessian(", "forward("], None);
    forbid("ntg-compiler/src/expr", &["quote!", "TokenStream", "format_ident"], None);
    forbid("ntg-compiler/src/program", &["quote!", "TokenStream"], None);
    forbid("ntg-compiler/src/model", &["quote!", "TokenStream"], None);
}

#[test]
fn only_one_file_names_clarabel() {
    forbid("ntg-nlp/src", &["use clarabel", " clarabel::", "(clarabel::"], Some("sqp/clarabel.rs"));
    forbid("ntg-runtime/src", &["clarabel"], None);
}

#[test]
fn compiler_and_runtime_do_not_know_each_other() {
    forbid("ntg-runtime/src", &["ntg_compiler", "ntg_interp", "ntg_macros"], None);
    forbid("ntg-compiler/src", &["ntg_runtime", "ntg_interp"], None);
    forbid("ntg-nlp/src", &["ntg_structure", "ntg_splines", "ntg_runtime", "ntg_compiler"], None);
    forbid("ntg-sweep/src", &["ntg_compiler", "ntg_interp", "ntg_macros"], None);
    forbid("ntg-lsp/src", &["ntg_runtime", "ntg_interp", "ntg_macros"], None);
    forbid("ntg-c/src", &["ntg_compiler", "ntg_interp", "ntg_macros", "std::fs", "std::net", "std::thread"], None);
    forbid("ntg-report/src", &["ntg_interp", "ntg_macros", "std::fs", "std::net"], None);
    forbid("ntg-math/src", &["ntg_"], Some("lib.rs")); // Its example names it.
    forbid("ntg-structure/src", &["ntg_"], None);
    forbid("ntg-certify/src", &["ntg_interp", "ntg_macros", "ntg_check"], None);
    forbid("ntg-check/src", &["ntg_s", "ntg_r", "ntg_c", "ntg_i", "ntg_m", "f64", "f32"], Some("main.rs"));
    forbid("ntg-splines/src", &["ntg_structure", "ntg_runtime", "ntg_compiler"], None);
}

#[test]
fn there_are_no_globals_and_nothing_is_unfinished() {
    for folder in [
        "src",
        "ntg-math/src",
        "ntg-structure/src",
        "ntg-splines/src",
        "ntg-nlp/src",
        "ntg-compiler/src",
        "ntg-macros/src",
        "ntg-runtime/src",
        "ntg-interp/src",
        "ntg-report/src",
        "ntg-sweep/src",
        "ntg-lsp/src",
        "ntg-certify/src",
        "ntg-check/src",
        "ntg-cli/src",
        "ntg-python/src",
    ] {
        forbid(folder, &["static mut", "thread_local!", "todo!(", "unimplemented!(", "#[ignore"], None);
        // Libraries of the language are parsed once: what is remembered changes no answer.
        forbid_statics_that_change(folder, "ntg-compiler/src/model/library.rs");
    }
    // An allocator and the message of a call that gave no solver belong to a thread.
    forbid("ntg-c/src", &["static mut", "todo!(", "unimplemented!(", "#[ignore"], None);
}

#[test]
fn one_version_everywhere() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let version = env!("CARGO_PKG_VERSION");
    for (file, line) in [
        ("CHANGELOG.md", format!("## {version}")),
        ("CITATION.cff", format!("version: {version}")),
        ("ntg-python/Cargo.toml", format!("version = \"{version}\"")),
    ] {
        let text = fs::read_to_string(root.join(file)).expect(file);
        assert!(text.lines().any(|found| found.starts_with(&line)), "{file} has no line `{line}`");
    }
    let manifest = fs::read_to_string(root.join("Cargo.toml")).expect("Cargo.toml");
    let own = manifest.lines().filter(|line| line.starts_with("ntg") && line.contains("path = "));
    for line in own {
        assert!(line.contains(&format!("version = \"{version}\"")), "{line}");
    }
}

#[test]
fn files_stay_small_enough_to_have_one_purpose() {
    /// Lines beyond which a file is two rooms (CONTRIBUTING, sizes).
    const MOST_LINES: usize = 600;
    for folder in [
        "src",
        "ntg-math/src",
        "ntg-structure/src",
        "ntg-splines/src",
        "ntg-nlp/src",
        "ntg-compiler/src",
        "ntg-macros/src",
        "ntg-runtime/src",
        "ntg-interp/src",
        "ntg-report/src",
        "ntg-sweep/src",
        "ntg-lsp/src",
        "ntg-certify/src",
        "ntg-check/src",
        "ntg-c/src",
        "ntg-cli/src",
        "ntg-python/src",
    ] {
        for (path, text) in files(folder) {
            let lines = text.lines().count();
            assert!(lines <= MOST_LINES, "{} has {lines} lines", path.display());
        }
    }
}

#[test]
fn the_checker_of_certificates_can_be_read_in_an_afternoon() {
    /// Lines of code: without comments, blank lines and tests.
    const MOST_LINES: usize = 1500;
    let code = |text: &str| {
        let lines = shipped(text).lines().map(str::trim).filter(|line| !line.is_empty() && !line.starts_with("//"));
        lines.count()
    };
    let lines: usize = files("ntg-check/src").iter().map(|(_, text)| code(text)).sum();
    assert!(lines <= MOST_LINES, "ntg-check has {lines} lines of code");
}

#[test]
fn every_code_is_documented_once() {
    let manual =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/errors.md")).expect("docs/errors.md");
    for code in ntg_compiler::diagnostic::Code::ALL {
        let heading = format!("## {} ", code.text());
        assert_eq!(manual.matches(&heading).count(), 1, "docs/errors.md has one entry `{heading}...`");
    }
}

#[test]
fn every_section_of_the_manual_that_code_cites_exists() {
    let manual =
        fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("docs/maths.md")).expect("docs/maths.md");
    for folder in [
        "ntg-splines/src",
        "ntg-nlp/src",
        "ntg-compiler/src",
        "ntg-runtime/src",
        "ntg-interp/src",
        "ntg-structure/src",
        "ntg-certify/src",
    ] {
        for (path, text) in files(folder) {
            for (at, _) in text.match_indices("maths.md, section ") {
                let number: String = text[at + "maths.md, section ".len()..]
                    .chars()
                    .take_while(|c| c.is_ascii_digit() || *c == '.')
                    .collect();
                let number = number.trim_end_matches('.');
                let found = manual.lines().any(|l| {
                    l.starts_with('#') && l.split_whitespace().nth(1).is_some_and(|n| n.trim_end_matches('.') == number)
                });
                assert!(found, "{} cites section {number} of docs/maths.md", path.display());
            }
        }
    }
}

/// Where macros and programs have other features of a crate, cargo builds it for each, and the compiler with it:
/// `benches/Cargo.toml` keeps them the same.
#[test]
fn no_crate_is_built_twice() {
    let tree = Command::new(env!("CARGO"))
        .args(["tree", "--offline", "--workspace", "--edges", "normal,build,dev", "--prefix", "none"])
        .args(["--format", "{p}|{f}"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .expect("cargo runs");
    assert!(tree.status.success(), "{}", String::from_utf8_lossy(&tree.stderr));
    let tree = String::from_utf8(tree.stdout).expect("names are text");
    let mut features = BTreeMap::new();
    for (package, its) in tree.lines().filter_map(|line| line.trim_end_matches(" (*)").split_once('|')) {
        let first = features.entry(package).or_insert(its);
        assert_eq!(*first, its, "macros and programs have other features of {package}");
    }
    assert!(features.keys().any(|package| package.starts_with("pest ")), "{features:?}");
}
