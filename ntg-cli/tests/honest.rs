//! What a person is told beside numbers: indices as the spec counts them, units as the spec has them, ends that are none
//! between the points, poles, fits that their deviations do not bear out.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::{Value, json};
use tempfile::TempDir;

/// Rows of vectors and a matrix of variables.
const MATRIX: &str = "problem Matrix {
    duration T = 5 [s];
    output p[0 .. 1, 1 .. 3] [m]: spline(order = 5, intervals = 3);
    variable k[2, 2] in 0 .. 5;
    param M[2, 3] = ((1, 2, 3), (4, 5, 6));
    let trace = k[1, 1] + k[2, 2];
    let both = (k[1, 1], k[2, 2]);
    minimize integral(sum(i in 0 .. 1, dot(der(p[i], 2), der(p[i], 2)))) + 1 [m^2/s^3] * (k[1, 2] - 1)^2;
    initial { for i in 0 .. 1 { p[i] == ((i, 2 * i, 1) * 1 [m]);  der(p[i]) == 0; } }
    final { for i in 0 .. 1 { p[i] == (0, 0, 0) [m]; } }
}
";

/// A train from rest to rest as a function of its way: its time per metre is not finite at both ends.
const POLE: &str = "problem Pole {
    domain s [m];
    duration S = 1000 [m];
    state v [m/s];
    input a in -1 .. 1 [m/s^2];
    collocation gauss(points = 3, intervals = 20);
    minimize time: integral(1 / v);
    dynamics { v * der(v) == a; }
    initial { v == 0; }
    final { v == 0; }
    guess { v = 10 [m/s]; }
}
";

/// A line through three points that lie on a parabola, with a slope that may not be what it would have to be.
const FIT: &str = "problem Fit {
    const at_time[5] = (0, 1, 2, 3, 4) [s];
    param seen[5] = (0, 1, 4, 9, 16) [m];
    duration T = 4 [s];
    state x [m];
    collocation gauss(points = 2, intervals = 4);
    variable slope in 0 .. 3 [m/s];
    dynamics { der(x) == slope; }
    measure { for i in 1 .. 5 { place: at(at_time[i], x) == seen[i] sigma 0.1 [m]; } }
    guess { slope = 1 [m/s];  x = 1 [m]; }
}
";

/// A low flight over terrain with a mast 4 m wide and 300 m high, which no point of any mesh sees.
const MAST: &str = "problem Mast {
    domain x [km];
    duration X = 10 [km];
    output h [m]: spline(order = 5, intervals = 8);
    table ground(x [km]) [m] = linear { 0: 50; 3: 120; 4.313: 90; 4.315: 390; 4.317: 90; 7: 150; 10: 50; }
    minimize integral((h / 100 [m] - 1)^2) / 1 [km];
    trajectory { clear: h >= WHERE + 20 [m]; }
}
";

fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(folder).args(arguments).output().expect("the command starts")
}

fn with(spec: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("spec.ntg"), spec).expect("the spec is written");
    folder
}

fn said(output: &Output) -> String {
    format!("{}{}", String::from_utf8_lossy(&output.stdout), String::from_utf8_lossy(&output.stderr))
}

#[test]
fn elements_of_a_matrix_keep_both_of_their_indices() {
    let folder = with(MATRIX);
    let solve = |arguments: &[&str]| ntg(folder.path(), &[&["solve", "spec.ntg"], arguments].concat());
    let text = said(&solve(&["--csv", "run.csv", "--save", "run.json"]));
    for name in ["p[0, 1] [m]", "p[1, 3] [m]", "k[1, 2]", "k[2, 1]"] {
        assert!(text.contains(name), "{name} in {text}");
    }
    let csv = fs::read_to_string(folder.path().join("run.csv")).expect("a table");
    assert!(csv.starts_with("t [s],\"p[0, 1] [m]\",\"p[0, 2] [m]\""), "{csv}");
    let json = solve(&["--format", "json"]);
    let found: Value = serde_json::from_slice(&json.stdout).expect("a document");
    // In documents and files a matrix is one entry, its rows one for each time.
    let saved = fs::read_to_string(folder.path().join("run.json")).expect("a saved run");
    let saved: Value = serde_json::from_str(&saved).expect("a document");
    for found in [&found, &saved] {
        let p = &found["outputs"]["p"];
        assert_eq!(
            (&p["first"], p["value"].as_array().map(Vec::len)),
            (&json!([0, 1]), p["t"].as_array().map(Vec::len))
        );
        let start = &p["value"][0];
        assert_eq!((start.as_array().map(Vec::len), start[0].as_array().map(Vec::len)), (Some(2), Some(3)), "{p}");
        assert!((start[1][1].as_f64().expect("an element") - 2.0).abs() < 1e-9, "{p}");
        assert!((found["variables"]["k"]["value"][0][1].as_f64().expect("a number") - 1.0).abs() < 1e-6);
        assert!(found["outputs"].get("p[0, 1]").is_none() && found["variables"].get("k[1, 2]").is_none());
        assert_eq!(found["parameters"]["M"]["value"], json!([[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]));
        assert!(found["lets"]["trace"]["value"].is_f64(), "{}", found["lets"]);
        assert_eq!(found["lets"]["both"]["value"].as_array().map(Vec::len), Some(2), "{}", found["lets"]);
    }
    // Of a file without a layout only the named quantities are taken.
    let mut named = saved.clone();
    for key in ["layout", "unknowns"] {
        named.as_object_mut().expect("an object").remove(key);
    }
    fs::write(folder.path().join("named.json"), named.to_string()).expect("a file is written");
    fs::write(folder.path().join("first.json"), in_the_first_form(saved).to_string()).expect("a file is written");
    // The same names are understood: in routes, as guesses from saved runs, in plots.
    let route = &["--route", "p[1, 1], p[1, 2]: 1, 2; 0, 0 [m]"][..];
    for arguments in [route, &["--guess", "run.json"], &["--guess", "first.json"], &["--guess", "named.json"]] {
        let again = solve(arguments);
        assert_eq!(again.status.code(), Some(0), "{}", said(&again));
    }
    let drawn = ["run.json", "first.json"].map(|run| {
        let plot = ["plot", run, "--xy", "p[1, 1],p[1, 2]", "--show", "p[0, 3]", "-o", "p.svg", "--force"];
        let plot = ntg(folder.path(), &plot);
        assert_eq!(plot.status.code(), Some(0), "{}", said(&plot));
        fs::read_to_string(folder.path().join("p.svg")).expect("a picture")
    });
    assert!(drawn[0] == drawn[1], "files of the first version are read as those of the second");
}

/// A saved run as the first version wrote it: elements had entries of their own, single numbers were lists of one.
fn in_the_first_form(mut run: Value) -> Value {
    run["version"] = json!(1);
    for key in ["outputs", "lets", "variables"] {
        let entries = run[key].as_object_mut().expect("entries");
        *entries = ntg_report::run::elements(std::mem::take(entries));
    }
    let lets = run["lets"].as_object_mut().expect("entries").values_mut();
    lets.filter(|one| one["value"].is_f64()).for_each(|one| one["value"] = json!([one["value"]]));
    let members = |value: &Value| match value.as_array() {
        Some(rows) => {
            rows.iter().flat_map(|row| row.as_array().cloned().unwrap_or_else(|| vec![row.clone()])).collect()
        }
        None => vec![value.clone()],
    };
    let parameters = run["parameters"].as_object_mut().expect("entries").values_mut();
    parameters.for_each(|one| one["value"] = members(&one["value"]).into());
    run
}

#[test]
fn text_document_and_page_end_alike_and_a_pole_is_named() {
    let folder = with(POLE);
    let text = said(&ntg(folder.path(), &["solve", "spec.ntg", "--save", "run.json"]));
    assert!(text.starts_with("Pole: solved at the points\n"), "{text}");
    assert!(text.contains("`1 / v` (line 7, column 29) is singular in the motion that was found at s = 0 m"), "{text}");
    let json = ntg(folder.path(), &["solve", "spec.ntg", "--format", "json"]);
    let found: Value = serde_json::from_slice(&json.stdout).expect("a document");
    assert_eq!((found["status"].as_str(), found["ending"].as_str()), (Some("solved"), Some("solved at the points")));
    let page = ntg(folder.path(), &["report", "run.json", "-o", "page.html"]);
    assert_eq!(page.status.code(), Some(0), "{}", said(&page));
    let page = fs::read_to_string(folder.path().join("page.html")).expect("a page");
    assert!(page.contains("<b>solved at the points</b>"), "the page's head");
}

#[test]
fn a_bad_fit_and_a_parameter_at_its_bound_are_told() {
    let folder = with(FIT);
    let text = said(&ntg(folder.path(), &["solve", "spec.ntg"]));
    assert!(text.contains("`slope` ends at its bound 3 m/s"), "{text}");
    assert!(text.contains("where about 4 is expected: the model does not meet the measurements"), "{text}");
    let good = FIT.replace("(0, 1, 4, 9, 16)", "(0, 2.1, 3.9, 6, 8.1)");
    let text = said(&ntg(with(&good).path(), &["solve", "spec.ntg"]));
    assert!(text.starts_with("Fit: solved\n") && !text.contains("warning"), "{text}");
}

/// A speed that turns 159 times between few points, beside a controlled one.
const SPIN: &str = "problem Spin {
    duration T = 10;
    param rate = 100;
    state th, y;
    input u;
    collocation gauss(points = 3, intervals = 80);
    minimize integral(u^2);
    dynamics { der(th) == rate;  der(y) == 10 * sin(th) + u; }
    initial { th == 0;  y == 0; }
    final { y == 1; }
}
";

#[test]
fn a_solution_of_the_points_alone_is_less_than_was_asked_for() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("spin.ntg");
    fs::write(&path, SPIN).expect("a spec");
    let run = |words: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
        command.arg(words[0]).arg(&path).args(&words[1..]).output().expect("ntg runs")
    };
    let found = run(&["solve"]);
    let said = String::from_utf8_lossy(&found.stdout);
    assert_eq!(found.status.code(), Some(3), "{said}");
    assert!(said.starts_with("Spin: solved at the points, and not between them\n  try: Use more points"), "{said}");
    assert!(said.contains("(`--refine`, `--between refine`)") && said.contains("(`--starts`)"), "{said}");
    let found = run(&["solve", "--format", "json"]);
    let said: Value = serde_json::from_slice(&found.stdout).expect("JSON");
    assert_eq!((found.status.code(), &said["resolution"]), (Some(3), &Value::from("unresolved")));
    // Fine enough a mesh is what was asked for.
    let found = run(&["solve", "--refine", "1e-2"]);
    assert_eq!(found.status.code(), Some(0), "{}", String::from_utf8_lossy(&found.stdout));
    // Neither does a table count it as solved, nor a certificate: that its equations hold to within 19 is proved.
    let table = folder.path().join("spin.csv");
    let path = |file: &Path| file.to_str().expect("a path").to_owned();
    let found = run(&["sweep", "--set", "rate=100:101:2", "-o", &path(&table)]);
    assert_eq!(found.status.code(), Some(3), "{}", String::from_utf8_lossy(&found.stderr));
    let rows = fs::read_to_string(&table).expect("a table");
    assert_eq!(rows.matches("solved at the points, and not between them").count(), 2, "{rows}");
    let found = run(&["certify"]);
    assert_eq!(found.status.code(), Some(1), "{}", String::from_utf8_lossy(&found.stdout));
    assert!(String::from_utf8_lossy(&found.stdout).starts_with("Spin: solved at the points, and not between them"));
    let page = folder.path().join("spin.html");
    let found = run(&["report", "-o", page.to_str().expect("a path")]);
    assert_eq!(found.status.code(), Some(3));
    assert!(fs::read_to_string(page).expect("a page").contains("solved at the points, and not between them"));
}

#[test]
fn documents_of_a_solve_have_the_notes_of_the_spec_as_those_of_check_do() {
    let folder = with(
        "problem Noted {
    duration T = 2;
    state v;
    input u, w in -1 .. 1;
    collocation gauss(points = 3, intervals = 4);
    minimize integral(u^2 + w^2);
    dynamics { der(v) == u - w; }
    initial { v == 1; }
    final { v == 0; }
}
",
    );
    let document = |command: &str| -> Value {
        let found = ntg(folder.path(), &[command, "spec.ntg", "--format", "json"]);
        serde_json::from_slice(&found.stdout).expect("a document")
    };
    let found = document("solve");
    assert_eq!(found["findings"], document("check")["findings"]);
    assert_eq!(
        (&found["findings"][0]["code"], &found["findings"][0]["range"]["start"]["line"]),
        (&json!("N007"), &json!(4))
    );
}

#[test]
fn a_solve_for_which_there_is_no_time_is_no_mistake_of_the_spec() {
    let folder = with(FIT);
    for more in [&[][..], &["--starts", "3"]] {
        let found = ntg(folder.path(), &[&["solve", "spec.ntg", "--time-limit", "1e-9"], more].concat());
        assert_eq!(found.status.code(), Some(1), "{}", said(&found));
        assert!(said(&found).contains("the time limit was reached before"), "{}", said(&found));
    }
    // What is wrong with it is told where there is time.
    fs::write(folder.path().join("wrong.ntg"), FIT.replace("duration", "durations")).expect("a file can be written");
    let found = ntg(folder.path(), &["solve", "wrong.ntg", "--time-limit", "1000"]);
    assert_eq!(found.status.code(), Some(2), "{}", said(&found));
}

/// Forty thousand nodes take longer to be read than the limit is.
#[test]
fn the_time_limit_holds_for_the_compiler_too() {
    let nodes: Vec<String> = (0..40_000).map(|k| format!("{k}: {}", k % 7)).collect();
    let table = format!("table f(a) = monotone {{ {} }};", nodes.join("; "));
    let folder = with(&FIT.replacen('{', &format!("{{ {table} "), 1));
    let found = ntg(folder.path(), &["solve", "spec.ntg", "--time-limit", "1e-3"]);
    assert_eq!(found.status.code(), Some(1), "{}", said(&found));
    assert!(said(&found).contains("the time limit was reached before the spec was compiled"), "{}", said(&found));
}

#[test]
fn a_limit_is_looked_at_where_the_argument_of_its_table_passes_a_node() {
    // By its own argument, by one that the line between two points does not know, as one of several limits, and in a table of
    // two arguments.
    let two = "table ground(x [km], y) [m] = linear { 0, 1; 0: 50, 50; 4.313: 90, 90; 4.315: 390, 390; 4.317: 90, 90; 10: 50, 50; }";
    let flat = "table ground(x [km]) [m] = linear { 0: 50; 3: 120; 4.313: 90; 4.315: 390; 4.317: 90; 7: 150; 10: 50; }";
    for spec in [
        MAST.replace("WHERE", "ground(x)"),
        MAST.replace("WHERE", "ground(x * (1 + 0.2 * sin(x / 1 [km])))"),
        MAST.replace("WHERE", "max(0 [m], ground(x))"),
        MAST.replace(flat, two)
            .replace("WHERE", "ground(x, 0.3 + 0.01 * h / 1 [m])")
            .replace("}\n}", "h <= 5 [km]; }\n}"),
    ] {
        let folder = with(&spec);
        let found = ntg(folder.path(), &["solve", "spec.ntg", "--format", "json"]);
        let document: Value = serde_json::from_slice(&found.stdout).expect("a document");
        let clear = document["constraints"].as_array().into_iter().flatten().find(|c| c["name"] == "clear");
        let missed = clear.expect("the limit")["between"]["violation"].as_f64().expect("a number");
        assert!(missed > 250.0, "{missed} in {spec}");
        assert_eq!((found.status.code(), document["resolution"].as_str()), (Some(3), Some("unresolved")), "{spec}");
    }
    // A path that clears the mast by itself is told of nothing.
    let folder = with(&MAST.replace("WHERE", "ground(x)").replace("h / 100 [m] - 1", "h / 600 [m] - 1"));
    let found = ntg(folder.path(), &["solve", "spec.ntg"]);
    assert_eq!(found.status.code(), Some(0), "{}", said(&found));
}
