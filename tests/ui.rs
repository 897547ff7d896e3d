//! What rustc says about mistakes in specs, word for word, in both forms of the macro.
//!
//! Each file of `tests/ui` is compiled as a program of its own, against the library that cargo has built for this test, so
//! that nothing is built for it. `UPDATE_EXPECT=1 cargo test --workspace --test ui` rewrites the expectations: read the
//! difference.

use std::collections::BTreeSet;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::LazyLock;

use serde_json::Value;

/// A test for each case, and a list of them.
macro_rules! cases {
    ($($name:ident)*) => {
        const CASES: &[&str] = &[$(stringify!($name)),*];

        $(#[test]
        fn $name() {
            expect_test::expect_file![root().join("tests/ui").join(stringify!($name)).with_extension("stderr")]
                .assert_eq(&words_of_rustc(stringify!($name)));
        })*
    };
}

cases! {
    fail_agents
    fail_constants
    fail_constants_form
    fail_file
    fail_missing_table
    fail_missions_file
    fail_names
    fail_no_path
    fail_phases
    fail_rust
    fail_syntax
    fail_temporal
    fail_through_a_macro
    fail_typed
    fail_units
    fail_unreadable
}

#[test]
fn every_file_of_the_folder_is_a_case() {
    let files = std::fs::read_dir(root().join("tests/ui")).expect("the folder is there");
    let mut names: Vec<String> = files
        .map(|file| file.expect("it can be listed").path())
        .filter(|path| path.extension().is_some_and(|e| e == "rs"))
        .map(|path| path.file_stem().expect("a name").to_string_lossy().into_owned())
        .collect();
    names.sort();
    assert_eq!(names, CASES);
}

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Where cargo has put `ntg` and what it stands on: words for rustc.
///
/// Cargo is asked for this very test with the features of the whole workspace, as `cargo test` builds it. It finds that all
/// is built and says where.
static LIBRARIES: LazyLock<Vec<OsString>> = LazyLock::new(|| {
    let built = Command::new(env!("CARGO"))
        .args(["test", "--no-run", "--workspace", "--test", "ui", "--message-format", "json", "--target-dir"])
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).parent().expect("it lies in the target folder"))
        .current_dir(root())
        .output()
        .expect("cargo runs");
    assert!(built.status.success(), "{}", String::from_utf8_lossy(&built.stderr));
    let messages = String::from_utf8(built.stdout).expect("cargo writes UTF-8");
    let messages = messages.lines().map(|line| serde_json::from_str::<Value>(line).expect("a line is a message"));
    let (mut ntg, mut folders) = (vec![], BTreeSet::new());
    for message in messages.filter(|message| message["reason"] == "compiler-artifact") {
        for file in message["filenames"].as_array().expect("artifacts are files") {
            let file = Path::new(file.as_str().expect("paths are text"));
            folders.extend(file.parent().map(Path::to_owned));
            if message["target"]["name"] == "ntg" && file.extension().is_some_and(|e| e == "rlib") {
                ntg.push(file.to_owned());
            }
        }
    }
    assert_eq!(ntg.len(), 1, "{ntg:?}");
    let word = |flag: &str, path: PathBuf| {
        let mut word = OsString::from(flag);
        word.push(path);
        word
    };
    let libraries = ntg.into_iter().map(|file| word("--extern=ntg=", file));
    libraries.chain(folders.into_iter().map(|folder| word("-L", folder))).collect()
});

/// What rustc says about a case, without the sums at its end.
fn words_of_rustc(case: &str) -> String {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| "rustc".into());
    let output = Command::new(rustc)
        .args(["--edition=2024", "--crate-type=bin", "--emit=metadata", "--diagnostic-width=140", "--verbose", "-o"])
        .arg(Path::new(env!("CARGO_TARGET_TMPDIR")).join(case).with_extension("rmeta"))
        .args(&*LIBRARIES)
        .arg(Path::new("tests/ui").join(case).with_extension("rs"))
        .current_dir(root())
        .env("CARGO_MANIFEST_DIR", root().join("tests")) // The folder from which cases name specs.
        .output()
        .expect("rustc runs");
    assert!(!output.status.success(), "{case} compiles");
    let said = String::from_utf8(output.stderr).expect("rustc writes UTF-8");
    let sums = ["error: aborting due to ", "Some errors have detailed explanations", "For more information about"];
    let lines = said.lines().filter(|line| !sums.iter().any(|sum| line.starts_with(sum)));
    let words: Vec<&str> = lines.map(str::trim_end).collect();
    format!("{}\n", words.join("\n").trim_end())
}
