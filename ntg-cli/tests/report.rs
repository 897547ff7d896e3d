//! `ntg plot` and `ntg report` as a user runs them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn specs() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs")
}

fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(folder).args(arguments).output().expect("the command starts")
}

#[track_caller]
fn done(folder: &Path, arguments: &[&str]) {
    let output = ntg(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{arguments:?}: {}", String::from_utf8_lossy(&output.stderr));
}

#[track_caller]
fn refused(folder: &Path, arguments: &[&str], words: &str) {
    let output = ntg(folder, arguments);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
    assert!(said.contains(words), "{arguments:?} says: {said}");
}

/// All shipped specs, by absolute path.
fn shipped() -> Vec<String> {
    let mut found: Vec<String> = std::fs::read_dir(specs())
        .expect("the specs")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ntg"))
        .map(|path| path.to_str().expect("a path in UTF-8").to_owned())
        .collect();
    found.sort();
    assert!(found.len() > 5, "{found:?}");
    found
}

#[test]
fn every_spec_has_a_report_below_a_megabyte_that_asks_no_network_for_anything() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for spec in shipped() {
        let output = ntg(folder.path(), &["report", &spec, "-o", "page.html", "--force"]);
        assert!(matches!(output.status.code(), Some(0 | 1)), "{spec}: {}", String::from_utf8_lossy(&output.stderr));
        let page = std::fs::read_to_string(folder.path().join("page.html")).expect("a page");
        assert!(page.len() < 1_000_000, "{spec}: {} bytes", page.len());
        for word in ["<link", " src=", "@import", "fetch(", "XMLHttpRequest", "url(http", "WebSocket"] {
            assert!(!page.contains(word), "{spec}: `{word}`");
        }
        for id in ["id=\"spec\"", "id=\"outputs\"", "id=\"convergence\"", "id=\"discretisation\"", "id=\"table\""] {
            assert!(page.contains(id), "{spec} has no section {id}");
        }
        // The data are JSON and hold the charts that the page asks for.
        let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).expect("data");
        let charts: Vec<serde_json::Value> = serde_json::from_str(data).expect("a list of charts");
        assert_eq!(page.matches("data-chart=").count(), charts.len(), "{spec}");
        assert!(charts.iter().all(|chart| chart["lines"].as_array().is_some_and(|lines| !lines.is_empty())), "{spec}");
    }
}

#[test]
fn every_spec_has_a_plot() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for spec in shipped() {
        done(folder.path(), &["plot", &spec, "-o", "plot.svg", "--force"]);
        let picture = std::fs::read_to_string(folder.path().join("plot.svg")).expect("a picture");
        assert!(
            picture.starts_with("<svg") && ["t [s]", "s [m]", "\nt\n"].iter().any(|time| picture.contains(time)),
            "{spec}"
        );
        assert!(!picture.contains("NaN") && !picture.contains("inf"), "{spec}");
    }
}

#[test]
fn a_report_marks_constraints_in_the_specs_own_text() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = specs().join("low_observable.ntg");
    done(folder.path(), &["report", spec.to_str().expect("UTF-8"), "-o", "page.html"]);
    let page = std::fs::read_to_string(folder.path().join("page.html")).expect("a page");
    // The paper's grid misses the limit on the signature between its points, and says so.
    assert!(page.contains("<mark class=\"between\" tabindex=\"0\">low_observable: signature &lt;= signature_max<span"));
    assert!(page.contains("<mark class=\"inactive\" tabindex=\"0\">turn: -1 &lt;= rho_min * curvature &lt;= 1<span"));
    assert!(page.contains("<mark class=\"equality\" tabindex=\"0\">x == x_start<span"));
    assert!(page.contains("largest multiplier "));
}

#[test]
fn saved_results_are_compared_and_drawn_together() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = specs().join("low_observable.ntg");
    let spec = spec.to_str().expect("UTF-8");
    done(folder.path(), &["solve", spec, "--save", "seen.json", "--set", "signature_max=7"]);
    done(folder.path(), &["solve", spec, "--save", "hidden.json"]);
    done(folder.path(), &["report", "hidden.json", "seen.json", "-o", "both.html"]);
    let page = std::fs::read_to_string(folder.path().join("both.html")).expect("a page");
    assert!(page.contains("id=\"comparison\"") && page.contains("<th class=\"n\">signature_max</th>"));
    assert!(page.contains("130.9072") && page.contains("128.2529"));
    assert!(page.len() < 1_000_000);

    done(folder.path(), &["plot", "hidden.json", "seen.json", "--xy", "x,y", "--show", "speed", "-o", "both.svg"]);
    let picture = std::fs::read_to_string(folder.path().join("both.svg")).expect("a picture");
    assert!(picture.contains("hidden") && picture.contains("seen") && picture.contains("x [km]"));
    done(folder.path(), &["plot", "hidden.json", "--show", "signature", "-o", "signature.png"]);
    let pixels = std::fs::read(folder.path().join("signature.png")).expect("a picture");
    assert_eq!(&pixels[..8], b"\x89PNG\r\n\x1a\n");
}

#[test]
fn every_local_minimum_is_drawn_listed_and_saved() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = specs().join("missile_intercept.ntg");
    let spec = spec.to_str().expect("UTF-8");
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a file");
    done(folder.path(), &["plot", spec, "--starts", "16", "--xy", "x,y", "-o", "minima.svg"]);
    let picture = read("minima.svg");
    // Both turns, the better one first; its dashed sibling is known on paper to cost 105.65148.
    assert!(
        picture.contains("16 of 16 starts solved, 2 local minima; the best: solved, objective 95.97491"),
        "{picture}"
    );
    let (right, left) = (picture.find("95.974911, 15 of 16 starts"), picture.find("105.651512, 1 of 16 starts"));
    assert!(right.is_some() && right < left, "{picture}");

    done(folder.path(), &["solve", spec, "--starts", "16", "--save", "best.json"]);
    done(folder.path(), &["report", "best.json", "-o", "best.html"]);
    done(folder.path(), &["report", spec, "--starts", "16", "-o", "minima.html"]);
    for page in [read("best.html"), read("minima.html")] {
        assert!(page.contains("<h2>Local minima</h2>") && page.contains("16 of 16 starts were solved"));
        assert!(page.contains("95.97491 s") && page.contains("105.6515 s"));
    }
    assert!(read("minima.html").contains("id=\"comparison\"") && !read("best.html").contains("id=\"comparison\""));
    refused(folder.path(), &["plot", "best.json", "--starts", "4", "-o", "p.svg"], "--starts goes with a spec");
}

#[test]
fn one_agents_quantity_is_drawn_by_its_path() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = specs().join("strike_and_look.ntg");
    let spec = spec.to_str().expect("UTF-8");
    done(folder.path(), &["solve", spec, "--save", "both.json"]);
    done(folder.path(), &["plot", "both.json", "--show", "x", "-o", "all.svg"]);
    done(folder.path(), &["plot", "both.json", "--show", "striker.x", "-o", "one.svg"]);
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect("a picture");
    assert!(read("all.svg").contains("looker.x") && read("all.svg").contains("striker.x"));
    assert!(read("one.svg").contains("striker.x") && !read("one.svg").contains("looker.x"));
}

#[test]
fn what_cannot_be_drawn_is_refused_with_what_can() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = specs().join("van_der_pol.ntg");
    let spec = spec.to_str().expect("UTF-8");
    let here = folder.path();
    refused(here, &["plot", spec, "-o", "p.pdf"], "plots are .svg or .png files");
    refused(here, &["plot", spec, "--xy", "x,y", "-o", "p.svg"], "no agent has both `x` and `y`; there are: `z`, `u`");
    refused(
        here,
        &["plot", spec, "--show", "speed", "-o", "p.svg"],
        "there is no `speed` over time; there are: `z`, `u`",
    );
    refused(here, &["plot", spec, "--xy", "x", "-o", "p.svg"], "write two names, such as `x,y`");
    std::fs::write(here.join("odd.json"), "{}").expect("a file");
    refused(here, &["report", "odd.json", "-o", "p.html"], "is no saved solution");
    refused(here, &["report", "odd.json", "--set", "a=1", "-o", "p.html"], "--set goes with a spec");
    std::fs::write(here.join("mine.html"), "mine").expect("a file");
    refused(here, &["report", spec, "-o", "mine.html"], "give --force");
    assert_eq!(std::fs::read_to_string(here.join("mine.html")).expect("a file"), "mine");
}
