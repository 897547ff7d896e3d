//! Where results go: through links, into devices and pipes, with the permissions of what they replace; and what is said
//! where they cannot go there.
#![cfg(unix)]

mod shell;

use std::fs::{self, OpenOptions, Permissions};
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::process::Command;

use shell::{ntg, said};
use tempfile::TempDir;

const SPEC: &str = "problem Cart {
    param goal = 1;
    duration T = 1;
    output z: spline(order = 4, intervals = 1);
    minimize integral(der(z, 2)^2);
    initial { z == 0; }
    final { z == goal; }
}
";

/// Every command that writes a file, without the name of the file; what the name ends with.
const WRITERS: &[(&[&str], &str)] = &[
    (&["solve", "cart.ntg", "--save"], "json"),
    (&["solve", "cart.ntg", "--csv"], "csv"),
    (&["solve", "cart.ntg", "--parquet"], "parquet"),
    (&["plot", "run.json", "-o"], "svg"),
    (&["report", "run.json", "-o"], "html"),
    (&["export", "cart.ntg", "-o"], "nl"),
    (&["certify", "cart.ntg", "-o"], "json"),
    (&["sweep", "cart.ntg", "--set", "goal=1:2:2", "-o"], "csv"),
    (&["new"], "ntg"),
];

fn folder() -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("cart.ntg"), SPEC).expect("a file can be written");
    said(&ntg(folder.path(), &["solve", "cart.ntg", "--save", "run.json"]), 0);
    folder
}

fn forced<'a>(command: &[&'a str], name: &'a str) -> Vec<&'a str> {
    [command, &[name, "--force"]].concat()
}

#[test]
fn a_link_leads_to_what_is_written_and_permissions_stay() {
    let folder = folder();
    let here = folder.path();
    for (number, (command, ending)) in WRITERS.iter().enumerate() {
        let (file, link) = (format!("file{number}.{ending}"), format!("link{number}.{ending}"));
        fs::write(here.join(&file), "old").expect("a file");
        fs::set_permissions(here.join(&file), Permissions::from_mode(0o600)).expect("permissions");
        symlink(&file, here.join(&link)).expect("a link");
        let words = forced(command, &link);
        said(&ntg(here, &words), 0);
        assert!(here.join(&link).is_symlink(), "{words:?}");
        let about = fs::metadata(here.join(&file)).expect("a file");
        assert_eq!(about.permissions().mode() & 0o777, 0o600, "{words:?}");
        assert_ne!(fs::read(here.join(&file)).expect("a file"), b"old", "{words:?}");
    }
}

#[test]
fn what_is_read_only_stays() {
    let folder = folder();
    let here = folder.path();
    for (number, (command, ending)) in WRITERS.iter().enumerate() {
        let file = format!("file{number}.{ending}");
        fs::write(here.join(&file), "old").expect("a file");
        fs::set_permissions(here.join(&file), Permissions::from_mode(0o444)).expect("permissions");
        let words = forced(command, &file);
        let err = said(&ntg(here, &words), 2);
        assert!(err.contains(&format!("cannot write `{file}`: it is read-only")), "{words:?}: {err}");
        assert_eq!(fs::read(here.join(&file)).expect("a file"), b"old", "{words:?}");
    }
}

#[test]
fn a_pipe_is_written_into_and_stays_one() {
    let folder = folder();
    let here = folder.path();
    for (number, (command, ending)) in WRITERS.iter().enumerate() {
        let pipe = here.join(format!("pipe{number}.{ending}"));
        assert!(Command::new("mkfifo").arg(&pipe).status().expect("mkfifo runs").success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read(pipe).expect("the pipe can be read")
        });
        let words = forced(command, pipe.to_str().expect("text"));
        let output = ntg(here, &words);
        // Should nothing have been written, the reader has an end all the same.
        if !fs::metadata(&pipe).expect("it is there").file_type().is_fifo() {
            panic!("{words:?} replaced the pipe");
        }
        drop(OpenOptions::new().read(true).write(true).open(&pipe));
        said(&output, 0);
        assert!(!reader.join().expect("the reader ends").is_empty(), "{words:?}");
    }
}

#[test]
fn a_link_to_nothing_yet_is_followed_and_one_to_nowhere_is_refused_before_the_solve() {
    let folder = folder();
    let here = folder.path();
    symlink("later.json", here.join("link.json")).expect("a link");
    said(&ntg(here, &["solve", "cart.ntg", "--save", "link.json"]), 0);
    assert!(here.join("link.json").is_symlink() && here.join("later.json").is_file());
    symlink("nowhere/later.json", here.join("lost.json")).expect("a link");
    let output = ntg(here, &["solve", "cart.ntg", "--save", "lost.json"]);
    assert!(said(&output, 2).contains("`nowhere` is no folder; make it first"));
    assert!(output.stdout.is_empty(), "nothing was solved");
    symlink("circle.json", here.join("circle.json")).expect("a link");
    let output = ntg(here, &["solve", "cart.ntg", "--save", "circle.json"]);
    assert!(said(&output, 2).contains("its links lead in a circle"));
    // A link does not lead around the rule that results replace no specs.
    symlink("cart.ntg", here.join("result.json")).expect("a link");
    said(&ntg(here, &["plot", "run.json", "-o", "result.json", "--force"]), 2);
    assert_eq!(fs::read_to_string(here.join("cart.ntg")).expect("a spec"), SPEC);
}

#[test]
fn files_in_the_place_of_folders_are_named() {
    let folder = folder();
    for command in [&["embed", "cart.ntg", "-o", "run.json"][..], &["solve", "cart.ntg", "--save", "run.json/a.json"]] {
        let err = said(&ntg(folder.path(), command), 2);
        assert!(err.contains("`run.json` is a file, and no folder; give another name"), "{err}");
    }
    let err = said(&ntg(folder.path(), &["solve", "cart.ntg", "--save", ".", "--force"]), 2);
    assert!(err.contains("`.` is a folder; name a file in it"), "{err}");
}
