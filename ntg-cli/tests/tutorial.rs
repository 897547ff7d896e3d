//! The commands of the tutorial and of `ntg --help`, run in order in an empty folder.

use std::path::Path;
use std::process::Command;

/// The words of a command line; quotes keep words together.
fn words(line: &str) -> Vec<String> {
    let mut words = vec![];
    for (i, part) in line.split('"').enumerate() {
        match i % 2 {
            0 => words.extend(part.split_whitespace().map(str::to_owned)),
            _ => words.push(part.to_owned()),
        }
    }
    words
}

#[test]
fn every_command_of_the_tutorial_does_what_it_says() {
    let docs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs");
    let page = std::fs::read_to_string(docs.join("tutorial.md")).expect("the tutorial");
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::copy(docs.join("tutorial/courier.ntg"), folder.path().join("courier.ntg")).expect("the spec");
    let blocks = page.split("```sh\n").skip(1).map(|rest| rest.split("```").next().unwrap_or_default());
    let commands: Vec<&str> = blocks.flat_map(str::lines).collect();
    assert!(commands.len() >= 8, "{commands:?}");
    for line in commands {
        let words = words(line);
        assert_eq!(words[0], "ntg", "{line}");
        let output = Command::new(env!("CARGO_BIN_EXE_ntg"))
            .current_dir(&folder)
            .args(&words[1..])
            .output()
            .expect("the command starts");
        assert_eq!(output.status.code(), Some(0), "{line}: {}", String::from_utf8_lossy(&output.stderr));
    }
    for made in ["flight.svg", "flight.html", "near.json", "far.json", "flights.html", "study.csv"] {
        assert!(folder.path().join(made).is_file(), "{made}");
    }
    let study = std::fs::read_to_string(folder.path().join("study.csv")).expect("the study");
    assert_eq!(study.lines().count(), 10);
    assert_eq!(study.matches(",solved,").count(), 9, "{study}");
}

#[test]
fn five_commands_lead_from_an_empty_folder_to_a_report_and_only_the_spec_is_edited() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let ntg = |arguments: &[String]| {
        let output = Command::new(env!("CARGO_BIN_EXE_ntg"))
            .current_dir(&folder)
            .args(arguments)
            .output()
            .expect("the command starts");
        assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).expect("the command speaks UTF-8")
    };
    let help = ntg(&["--help".to_owned()]);
    let example = help.split("A first problem:\n").nth(1).expect("help teaches by example");
    let commands: Vec<&str> = example.lines().map(|line| line.split('#').next().unwrap_or_default()).collect();
    assert_eq!(commands.len(), 5, "{example}");
    for line in commands {
        let words = words(line);
        assert_eq!(words[0], "ntg", "{line}");
        ntg(&words[1..]);
        if words[1] == "new" {
            let path = folder.path().join("landing.ntg");
            let spec = std::fs::read_to_string(&path).expect("the spec");
            std::fs::write(&path, spec.replace("v_max = 4 [m/s]", "v_max = 3 [m/s]")).expect("writable");
        }
    }
    let page = std::fs::read_to_string(folder.path().join("landing.html")).expect("a report");
    assert!(page.contains("<title>Landing") && page.contains("v_max") && page.len() < 1_000_000);
}
