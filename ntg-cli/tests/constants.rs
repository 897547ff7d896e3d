//! Constants that are set on the command line, and files beside a spec, as a user runs them.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

const SPEC: &str = "problem P {
    const n = rows(\"data/run.csv\");
    const pieces = 2;
    const time[n] [s] from \"data/run.csv\" column 1;
    param seen[n] [m] from \"data/run.csv\" column 2;
    param noise = 1 [m];
    duration T = 4 [s];
    output x [m]: spline(order = 2, intervals = pieces);
    variable offset [m];
    temporal { initial(x) == offset; }
    measure { for i in 1 .. n { track: at(time[i], x) == seen[i] sigma noise; } }
}
";

fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
    command.current_dir(folder).args(arguments).output().expect("the command runs")
}

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::create_dir(folder.path().join("data")).expect("a folder can be made");
    std::fs::write(folder.path().join("spec.ntg"), SPEC).expect("a file can be written");
    let run = "# time s, place m\n0, 1\n1, 2\n2, 2\n3, 4\n4, 5\n";
    std::fs::write(folder.path().join("data/run.csv"), run).expect("a file can be written");
    folder
}

#[track_caller]
fn said(output: &Output, status: i32) -> (String, String) {
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    let (out, err) = (text(&output.stdout), text(&output.stderr));
    assert_eq!(output.status.code(), Some(status), "{out}\n{err}");
    (out, err)
}

fn solved(folder: &Path, arguments: &[&str]) -> Value {
    let all = [&["solve", "spec.ntg", "--format", "json"], arguments].concat();
    let (out, _) = said(&ntg(folder, &all), 0);
    serde_json::from_str(&out).expect("JSON")
}

#[test]
fn constants_and_parameters_are_set_alike() {
    let folder = folder();
    let chi2 = |arguments: &[&str]| solved(folder.path(), arguments)["estimate"]["chi2"].as_f64().expect("a number");
    // More pieces follow the points more closely: the last knots are the points themselves.
    let (two, four) = (chi2(&[]), chi2(&["--set", "pieces=4"]));
    assert!(two > 0.1 && four < 1e-12, "{two}, {four}");
    let half = chi2(&["--set", "noise=50 cm"]);
    assert!((half / two - 4.0).abs() < 1e-6, "{half}");
}

#[test]
fn json_has_residuals_and_deviations() {
    let document = solved(folder().path(), &[]);
    let estimate = &document["estimate"];
    let track = &estimate["measurements"][0];
    let residuals = track["residuals"].as_array().expect("a list");
    assert_eq!((estimate["count"].as_u64(), residuals.len(), track["name"].as_str()), (Some(5), 5, Some("track")));
    let squares: f64 = residuals.iter().map(|r| r["ratio"].as_f64().expect("a number").powi(2)).sum();
    assert!((squares / estimate["chi2"].as_f64().expect("a number") - 1.0).abs() < 1e-12);
    assert!(estimate["deviations"]["offset"]["sigma"].as_f64().is_some_and(|sigma| (0.5..1.0).contains(&sigma)));
}

#[test]
fn names_that_are_no_constants_are_told_of() {
    let folder = folder();
    let (_, err) = said(&ntg(folder.path(), &["check", "spec.ntg", "--set", "peaces=4"]), 2);
    assert!(err.contains("the problem has no constant `peaces`") && err.contains("did you mean `pieces`?"), "{err}");
    let (_, err) = said(&ntg(folder.path(), &["expand", "spec.ntg", "--set", "noise=4"]), 2);
    assert!(err.contains("--set noise=4: only constants change what a spec becomes"), "{err}");
    let (_, err) = said(&ntg(folder.path(), &["solve", "spec.ntg", "--set", "q=4"]), 2);
    assert!(err.contains("the parameters are: `seen`, `noise`; the constants are: `n`, `pieces`, `time`"), "{err}");
    let (_, err) = said(&ntg(folder.path(), &["solve", "spec.ntg", "--set", "pieces=many"]), 2);
    assert!(err.contains("error[E029]: `pieces = many`: `many` is no number"), "{err}");
    let (_, err) = said(&ntg(folder.path(), &["check", "spec.ntg", "--set", "n=4"]), 2);
    assert!(err.contains("error[E074]: \"data/run.csv\" has 5 rows, `time` has 4"), "{err}");
    said(&ntg(folder.path(), &["check", "spec.ntg", "--set", "pieces=3"]), 0);
}

#[test]
fn saved_runs_and_reports_hold_the_estimate() {
    let folder = folder();
    let printed = solved(folder.path(), &["--save", "run.json"]);
    let saved = std::fs::read_to_string(folder.path().join("run.json")).expect("the saved run");
    let mut saved: Value = serde_json::from_str(&saved).expect("JSON");
    // The saved run says of each residual when and of what it is, too.
    let residuals = saved["estimate"]["measurements"][0]["residuals"].as_array_mut().expect("residuals");
    for residual in residuals.iter_mut().filter_map(Value::as_object_mut) {
        for field in ["t", "of", "measured", "sigma"] {
            assert!(residual.remove(field).is_some(), "{field}");
        }
    }
    assert_eq!(saved["estimate"], printed["estimate"]);
    said(&ntg(folder.path(), &["report", "run.json", "-o", "run.html"]), 0);
    let page = std::fs::read_to_string(folder.path().join("run.html")).expect("the page");
    let section = page.split("id=\"estimate\"").nth(1).and_then(|rest| rest.split("</section>").next());
    let section = section.expect("a section about the estimate");
    for words in ["5 measured numbers", ">offset<", "standard deviation", ">track<", "100 %"] {
        assert!(section.contains(words), "`{words}` is missing in {section}");
    }
    // Without measurements there is no such section.
    let plain = SPEC
        .replace("measure {", "trajectory {")
        .replace(" sigma noise", "")
        .replace("at(time[i], x) == seen[i]", "x >= 0 [m]");
    std::fs::write(
        folder.path().join("plain.ntg"),
        plain.replace("variable offset", "minimize integral(x);\n    variable offset"),
    )
    .expect("a file can be written");
    said(&ntg(folder.path(), &["solve", "plain.ntg", "--save", "plain.json"]), 0);
    said(&ntg(folder.path(), &["report", "plain.json", "-o", "plain.html"]), 0);
    let page = std::fs::read_to_string(folder.path().join("plain.html")).expect("the page");
    assert!(!page.contains("id=\"estimate\""));
}

#[test]
fn a_file_of_numbers_that_cannot_be_read_says_why_and_which_may_be_meant() {
    let folder = folder();
    let spec = SPEC.replace("data/run.csv", "data/rnu.csv");
    std::fs::write(folder.path().join("slip.ntg"), spec).expect("a file can be written");
    let (_, err) = said(&ntg(folder.path(), &["check", "slip.ntg"]), 2);
    let words = "`data/rnu.csv` cannot be read: there is no such file; did you mean `data/run.csv`?";
    assert!(err.contains(words), "{err}");
    std::fs::write(folder.path().join("data/run.csv"), b"0, \xe9\n").expect("a file can be written");
    let (_, err) = said(&ntg(folder.path(), &["check", "spec.ntg"]), 2);
    let words =
        "`data/run.csv` cannot be read: it is not UTF-8 text, line 1 has the byte 0xe9; save it in the encoding UTF-8";
    assert!(err.contains(words), "{err}");
}

#[cfg(unix)]
#[test]
fn a_file_without_an_end_or_too_large_is_refused_before_it_fills_the_memory() {
    let folder = folder();
    let large = std::fs::File::create(folder.path().join("large.csv")).expect("a file can be made");
    large.set_len(300 << 20).expect("a file of nothing");
    let use_of = |path: &str| format!("use \"{path}\" as f; {SPEC}");
    let data = |path: &str| SPEC.replace("data/run.csv", path);
    let table = |path: &str| SPEC.replacen('{', &format!("{{ table f(a) = linear from \"{path}\"; "), 1);
    let device = "it is no regular file but a folder, a device or a pipe";
    let size = "its 300 MiB are more than is read of a file, 256 MiB";
    for (path, why, help) in [
        ("/dev/zero", device, "help: copy what it gives to a file and name that"),
        ("large.csv", size, "help: leave out rows that are not needed"),
    ] {
        for (spec, code) in [(data(path), "E072"), (table(path), "E072"), (use_of(path), "E087")] {
            std::fs::write(folder.path().join("endless.ntg"), spec).expect("a file can be written");
            let (_, err) = said(&ntg(folder.path(), &["check", "endless.ntg"]), 2);
            let words = format!("error[{code}]: `{path}` cannot be read: {why}");
            assert!(err.contains(&words) && err.contains(help) && err.contains("^^^"), "{err}");
        }
    }
    // What a user names on the command line, too.
    std::fs::write(folder.path().join("spec.ntg"), SPEC).expect("a file can be written");
    for words in [
        &["check", "/dev/zero"][..],
        &["solve", "spec.ntg", "--guess", "/dev/zero"],
        &["report", "/dev/zero", "-o", "page.html"],
        &["check-solution", "spec.ntg", "/dev/zero"],
        &["sweep", "spec.ntg", "--from", "/dev/zero", "-o", "study.csv"],
        &["summary", "/dev/zero"],
    ] {
        let (_, err) = said(&ntg(folder.path(), words), 2);
        assert!(err.contains(device), "{words:?}: {err}");
    }
}

#[test]
fn a_table_of_numbers_is_no_spec() {
    let folder = folder();
    for command in [&["check"][..], &["solve"], &["report", "-o", "page.html"]] {
        let (_, err) = said(&ntg(folder.path(), &[command, &["data/run.csv"]].concat()), 2);
        assert!(err.contains("`data/run.csv` is a table of numbers; name a spec"), "{command:?}: {err}");
    }
}

#[test]
fn elements_of_a_matrix_are_set_by_row_and_column() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = "problem M { param B[2, 3] = ((1, 2, 3), (4, 5, 6)) [m]; param c[2] = (1, 2); duration T = 1 [s]; output x: spline(order = 2, intervals = 1); \
                variable v[6] [m]; minimize sum(i in 1 .. 6, v[i]^2); initial { x == 0; } final { x == 1; } \
                temporal { for i in 1 .. 2 { for j in 1 .. 3 { v[3 * i + j - 3] == B[i, j] * c[1]; } } } }";
    std::fs::write(folder.path().join("m.ntg"), spec).expect("written");
    let run = |arguments: &[&str], status: i32| said(&ntg(folder.path(), arguments), status);
    let (out, _) = run(&["solve", "m.ntg", "--set", "B[2,1]=0.3 km", "--set", "B[1, 3]=7", "--format", "json"], 0);
    let found: Value = serde_json::from_str(&out).expect("JSON");
    let value = |k: usize| found["variables"]["v"]["value"][k - 1].as_f64().expect("a number");
    for (k, wanted) in [1.0, 2.0, 7.0, 300.0, 5.0, 6.0].into_iter().enumerate() {
        assert!((value(k + 1) - wanted).abs() < 1e-6, "{k}: {} {found}", value(k + 1));
    }
    run(&["sweep", "m.ntg", "--set", "B[2,2]=1:3:3", "-o", "rows.csv"], 0);
    let rows = std::fs::read_to_string(folder.path().join("rows.csv")).expect("written");
    assert!(rows.lines().next().is_some_and(|head| head.contains("\"B[2,2]\"")), "{rows}");
    let (out, _) = run(&["solve", "m.ntg", "--sensitivity=B[2,3]"], 0);
    assert!(out.contains("B[2, 3]"), "{out}");
    let wrong = [
        ("B[1]=1", "--set B[1]=1: `B` is a matrix and takes two indices, a row and a column: `B[1, 1]` to `B[2, 3]`"),
        ("B[3,1]=1", "--set B[3,1]=1: there is no `B[3, 1]`; the members are `B[1, 1]` to `B[2, 3]`"),
        ("B[1,4]=1", "--set B[1,4]=1: there is no `B[1, 4]`; the members are `B[1, 1]` to `B[2, 3]`"),
        ("c[1,1]=1", "--set c[1,1]=1: `c` takes one index: `c[1]` to `c[2]`"),
        ("B[1;1]=1", "an index is a whole number in brackets, as in `B[2]`, of a matrix `B[2, 1]`"),
    ];
    for (set, words) in wrong {
        let (_, err) = run(&["solve", "m.ntg", "--set", set], 2);
        assert!(err.contains(words), "{set}: {err}");
    }
    let (_, err) = run(&["sweep", "m.ntg", "--set", "B[1]=1:3:3", "-o", "no.csv"], 2);
    assert!(err.contains("`B` is a matrix and takes two indices"), "{err}");
}
