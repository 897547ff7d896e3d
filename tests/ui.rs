//! What rustc says about mistakes in specs, word for word, in both forms of the macro.
//!
//! `TRYBUILD=overwrite cargo test --test ui` rewrites the expectations: read the difference.

use std::path::Path;

#[test]
fn mistakes_are_underlined_where_they_are() {
    link_specs();
    let cases = trybuild::TestCases::new();
    cases.compile_fail("tests/ui/fail_*.rs");
}

/// Each case is built as a crate of its own, whose folder the paths of `ntg_file!` start from: the
/// broken specs are put there first.
fn link_specs() {
    let built = Path::new(env!("CARGO_TARGET_TMPDIR")).with_file_name("tests").join("trybuild/ntg/ui");
    std::fs::create_dir_all(&built).expect("the build folder can be written");
    let specs = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/ui/specs");
    for entry in std::fs::read_dir(specs).expect("tests/ui/specs is there") {
        let path = entry.expect("it can be listed").path();
        let name = path.file_name().expect("a file has a name");
        std::fs::copy(&path, built.join(name)).expect("a spec can be copied");
    }
}
