//! No command replaces a file that it reads, whatever the name that is given for it, and with `--force` neither.

mod shell;

use std::path::Path;
use std::process::{Command, Stdio};

use shell::{ntg, said};

const SPEC: &str = "use \"own.csv\" as own;
problem P {
    table f(a) = linear from \"data.csv\";
    param p = 1;
    duration T = 1;
    output x: spline(order = 3, intervals = 3);
    minimize integral(der(x, 2)^2 + f(t));
    initial { x == own::zero; }
    final { x == p; }
}
";

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let files = [
        // A spec by another ending, so that its ending alone does not keep it; a library that ends as a table does.
        ("spec.csv.ntg", SPEC),
        ("own.csv", "const zero = 0;\n"),
        ("data.csv", "0, 0\n1, 1\n"),
        ("sets.csv", "p\n1\n2\n"),
    ];
    for (name, text) in files {
        std::fs::write(folder.path().join(name), text).expect("a file can be written");
    }
    folder
}

fn texts(folder: &Path) -> Vec<(std::ffi::OsString, Vec<u8>)> {
    let entries = std::fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry"));
    let mut all: Vec<_> =
        entries.map(|entry| (entry.file_name(), std::fs::read(entry.path()).expect("a file"))).collect();
    all.sort();
    all
}

/// Other names of a file.
fn names(folder: &Path, file: &str) -> Vec<String> {
    let (stem, extension) = file.rsplit_once('.').expect("an ending");
    let whole = folder.join(file).display().to_string();
    let mut names = vec![file.to_owned(), format!("./{file}"), whole];
    #[cfg(unix)]
    {
        let soft = format!("soft-{stem}.{extension}");
        if !folder.join(&soft).is_symlink() {
            std::os::unix::fs::symlink(file, folder.join(&soft)).expect("a link");
        }
        names.push(soft);
    }
    let hard = format!("hard-{stem}.{extension}");
    if !folder.join(&hard).exists() {
        std::fs::hard_link(folder.join(file), folder.join(&hard)).expect("a link");
    }
    names.push(hard);
    names
}

#[test]
fn no_result_takes_the_place_of_what_is_read() {
    let folder = folder();
    let here = folder.path();
    said(&ntg(here, &["solve", "spec.csv.ntg", "--save", "run.json"]), 0);
    std::fs::copy(here.join("run.json"), here.join("run.svg")).expect("a copy");
    let spec = "spec.csv.ntg";
    // A command without the name of its output, and what it reads.
    let commands: &[(&[&str], &str)] = &[
        (&["sweep", spec, "--from", "sets.csv", "-o"], "sets.csv"),
        (&["sweep", spec, "--from", "sets.csv", "-o"], "data.csv"),
        (&["solve", spec, "--csv"], "data.csv"),
        (&["solve", spec, "--csv"], "own.csv"),
        (&["solve", spec, "--save"], "data.csv"),
        (&["solve", spec, "--guess", "run.json", "--save"], "run.json"),
        (&["certify", spec, "-o"], "data.csv"),
        (&["export", spec, "-o"], "data.csv"),
        (&["export", spec, "--guess", "run.json", "-o"], "run.json"),
        (&["report", "run.json", "-o"], "run.json"),
        (&["report", "run.json", spec, "-o"], "data.csv"),
        (&["merge", "--from", "sets.csv", "--"], "sets.csv"),
    ];
    for (command, file) in commands {
        for name in names(here, file) {
            let before = texts(here);
            let mut words = [*command, &[&name]].concat();
            words.insert(1, "--force");
            let err = said(&ntg(here, &words), 2);
            assert!(err.contains(&format!("`{name}` is read by this command")), "{words:?}: {err}");
            assert!(texts(here) == before, "{words:?} left the files as they were");
        }
    }
    // A picture that is a saved run by its contents is read as a spec, and kept.
    let before = texts(here);
    said(&ntg(here, &["plot", "run.svg", "-o", "run.svg", "--force"]), 2);
    assert!(texts(here) == before);
}

#[test]
fn two_results_are_two_files() {
    let folder = folder();
    for second in ["a.csv", "./a.csv"] {
        let err = said(&ntg(folder.path(), &["solve", "spec.csv.ntg", "--save", "a.csv", "--csv", second]), 2);
        assert!(err.contains("would be written twice; give each result a name of its own"), "{err}");
    }
    said(&ntg(folder.path(), &["solve", "spec.csv.ntg", "--save", "a.json", "--csv", "a.csv", "--force"]), 0);
}

#[test]
fn a_spec_from_standard_input_is_kept_where_it_has_a_name() {
    let folder = folder();
    let text = SPEC.replace("use \"own.csv\" as own;\n", "").replace("own::zero", "0");
    std::fs::write(folder.path().join("spec.txt"), &text).expect("a file can be written");
    let input = std::fs::File::open(folder.path().join("spec.txt")).expect("a file");
    let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
    command.current_dir(folder.path()).args(["solve", "-", "--save", "spec.txt", "--force"]);
    let output = command.stdin(Stdio::from(input)).output().expect("the command runs");
    if cfg!(target_os = "linux") {
        assert!(said(&output, 2).contains("`spec.txt` is read by this command as `-`"));
        assert_eq!(std::fs::read_to_string(folder.path().join("spec.txt")).expect("a file"), text);
    }
}

#[test]
fn an_embedded_crate_keeps_the_tables_of_its_spec() {
    let folder = folder();
    let spec = SPEC.replace("data.csv", "README.md");
    std::fs::write(folder.path().join("spec.csv.ntg"), spec).expect("a file can be written");
    std::fs::rename(folder.path().join("data.csv"), folder.path().join("README.md")).expect("another name");
    let before = texts(folder.path());
    let err = said(&ntg(folder.path(), &["embed", "spec.csv.ntg", "-o", ".", "--force"]), 2);
    assert!(err.contains("`./README.md` is read by this command"), "{err}");
    assert!(texts(folder.path()) == before);
}
