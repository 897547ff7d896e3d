//! `ntg certify` and `ntg solve --guarantee`, as a user runs them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn ntg(arguments: &[&str]) -> Output {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("..");
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(root).args(arguments).output().expect("ntg runs")
}

fn text(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

fn scratch(name: &str) -> PathBuf {
    std::env::temp_dir().join(format!("ntg-certify-{}-{name}", std::process::id()))
}

#[test]
fn the_gap_of_the_papers_grid_is_refuted_with_a_witness_and_mended_by_the_guarantee() {
    let spec = "specs/low_observable.ntg";
    let found = ntg(&["certify", spec]);
    assert_eq!(found.status.code(), Some(1), "{}", text(&found));
    assert!(text(&found).contains("REFUTED: missed by 8.388e-2"), "{}", text(&found));

    let path = scratch("mended.cert");
    let file = path.to_str().expect("a path");
    let mended = ntg(&["certify", spec, "--guarantee", "--format", "json", "-o", file]);
    assert_eq!(mended.status.code(), Some(0), "{}", text(&mended));
    let document: serde_json::Value = serde_json::from_str(&text(&mended)).expect("JSON");
    assert_eq!(document["proved"], true);
    let cost = document["guarantee"]["cost"].as_f64().expect("a number");
    assert!(cost > 0.0 && cost < 1e-3, "the guarantee costs {cost}");
    let certificate = std::fs::read_to_string(&path).expect("a certificate");
    assert_eq!(
        ntg_check::verify(&certificate).map(|checked| (checked["proved"], checked.contains_key("refuted"))),
        Ok((4, false))
    );

    let kept = ntg(&["certify", spec, "-o", file]);
    assert_eq!(kept.status.code(), Some(2), "an existing file is kept");
    std::fs::remove_file(path).expect("the file is there");
}

#[test]
fn equations_of_motion_have_a_proved_residual() {
    let flat = ntg(&["certify", "specs/van_der_pol.ntg"]);
    assert!(text(&flat).contains("every constraint is proved for all times"), "{}", text(&flat));
    let found = ntg(&["certify", "specs/gallery/vanderpol.ntg"]);
    assert_eq!(found.status.code(), Some(0), "{}", text(&found));
    let head = "every limit is proved for all times, and by how much equations are missed at most";
    assert!(text(&found).contains(head), "{}", text(&found));
    assert!(text(&found).contains(" at most, proved"), "{}", text(&found));
}

#[test]
fn a_tube_bounds_the_true_state_and_is_proved_again() {
    let path = scratch("tube.cert");
    let file = path.to_str().expect("a path");
    let found = ntg(&["certify", "specs/gallery/vanderpol.ntg", "--tube", "-o", file]);
    assert_eq!(found.status.code(), Some(0), "{}", text(&found));
    assert!(text(&found).contains("Tube: how far the true state is"), "{}", text(&found));
    assert!(text(&found).lines().any(|line| line.starts_with("  x2  within ")), "{}", text(&found));
    let certificate = std::fs::read_to_string(&path).expect("a certificate");
    assert!(certificate.contains("| // Tube: how far the true state is"), "{certificate}");
    let checked = ntg_check::verify(&certificate).expect("a sound certificate");
    assert_eq!(checked["tubes"], 1);
    std::fs::remove_file(path).expect("the file is there");

    let flat = ntg(&["certify", "specs/van_der_pol.ntg", "--tube", "--format", "json"]);
    let document: serde_json::Value = serde_json::from_str(&text(&flat)).expect("JSON");
    assert_eq!(document["tube"]["whole"], true);
    assert_eq!(document["tube"]["phases"][0]["ending"], "flat");
}

#[test]
fn a_guaranteed_solve_says_proved_beside_each_constraint() {
    let saved = scratch("gates.json");
    let file = saved.to_str().expect("a path");
    let solved = ntg(&["solve", "specs/gates.ntg", "--guarantee", "--format", "json", "--save", file]);
    assert_eq!(solved.status.code(), Some(0), "{}", String::from_utf8_lossy(&solved.stderr));
    let document: serde_json::Value = serde_json::from_str(&text(&solved)).expect("JSON");
    let constraints = document["constraints"].as_array().expect("a list");
    let verdict = |name: &str| {
        let own = constraints.iter().find(|c| c["name"].as_str().is_some_and(|own| own.ends_with(name)));
        own.and_then(|c| c["proof"]["verdict"].as_str()).map(str::to_owned)
    };
    for name in ["engine", "upright", "ground", "forwards"] {
        assert_eq!(verdict(name).as_deref(), Some("proved"), "{name}");
    }
    assert_eq!(verdict("squarely").as_deref(), Some("within"));
    let run: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(&saved).expect("a run")).expect("JSON");
    assert!(run["lets"]["speed"]["bands"].as_array().is_some_and(|bands| bands.len() >= 6));
    let page = scratch("gates.html");
    let report = ntg(&["report", file, "-o", page.to_str().expect("a path")]);
    assert_eq!(report.status.code(), Some(0), "{}", String::from_utf8_lossy(&report.stderr));
    let html = std::fs::read_to_string(&page).expect("a page");
    assert!(html.contains("for all times") && html.contains("proved from"));
    std::fs::remove_file(saved).and(std::fs::remove_file(page)).expect("both files are there");
}

/// Solved at the points alone.
const EPIDEMIC: &str = include_str!("specs/epidemic.ntg");

#[test]
fn a_guarantee_of_limits_makes_no_solution_of_what_leaves_its_equations() {
    let path = scratch("epidemic.ntg");
    std::fs::write(&path, EPIDEMIC).expect("written");
    let file = path.to_str().expect("a path");
    let (alone, guaranteed) = (ntg(&["solve", file]), ntg(&["solve", file, "--guarantee"]));
    assert_eq!((alone.status.code(), guaranteed.status.code()), (Some(3), Some(3)), "{}", text(&guaranteed));
    std::fs::remove_file(path).expect("the file is there");
}
