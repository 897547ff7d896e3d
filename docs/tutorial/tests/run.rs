//! What the tutorial shows is what its files hold and what its program prints.

use std::path::Path;
use std::process::Command;

fn read(path: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// The text of the one block that is marked so.
fn block(marks: &str) -> String {
    let page = read("../tutorial.md");
    let opening = format!("```{marks}\n");
    assert_eq!(page.matches(&opening).count(), 1, "blocks marked `{marks}`");
    let after = page.split(&opening).nth(1).expect("one block");
    after.split("```").next().expect("its end").to_owned()
}

#[test]
fn the_page_shows_the_spec_and_the_program_as_they_are() {
    assert_eq!(block("ntg"), read("courier.ntg"));
    assert_eq!(block("rust"), read("src/main.rs"));
}

#[test]
fn the_program_prints_what_the_page_says() {
    let output = Command::new(env!("CARGO_BIN_EXE_courier")).output().expect("the program starts");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    assert_eq!(String::from_utf8_lossy(&output.stdout), block("text,output"));
}
