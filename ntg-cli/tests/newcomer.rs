//! What a person reads who uses vectors, units and terrain for the first time: names of elements, of options, of what may be
//! set; and what pictures show of them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// Vectors as states, a bound in their declaration, limits on some of the time, a list at both ends.
const VECTORS: &str = "problem Vectors {
    duration T in 1 .. 20 [s];
    state r[2] [m], v[2] [m/s];
    input a[2] in -2 .. 2 [m/s^2];
    collocation gauss(points = 3, intervals = 10);
    minimize T;
    dynamics { der(r) == v;  der(v) == a; }
    initial { r == (0, 0);  v == 0; }
    trajectory { swift: v[1] <= 3 [m/s]; }
    trajectory from T / 4 to T / 2 { slow: v[1] <= 1.5 [m/s]; }
    final { r == (10, 5) [m];  v == 0; }
}
";

/// A track over a table of heights, and the same in a view from the side.
const TERRAIN: &str = "problem Terrain {
    duration T in 20 .. 200 [s];
    output x, y, z [m]: spline(order = 5, intervals = 6);
    table ground(x [m], y [m]) [m] = monotone {
              0, 500, 1000;
        0:    0, 20, 10;
        500:  10, 120, 30;
        1000: 0, 40, 20;
    }
    minimize integral(der(x, 2)^2 + der(y, 2)^2 + der(z, 2)^2);
    initial { x == 100 [m];  y == 500 [m];  z == 120 [m]; }
    trajectory { above: z >= ground(x, y) + 40 [m]; }
    final { x == 900 [m];  y == 550 [m];  z == 120 [m]; }
    guess { x = 100 [m] + 800 [m] * tau;  y = 500 [m];  z = 200 [m];  T = 60 [s]; }
}
";
const SIDE: &str = "problem Side {
    duration T = 100 [s];
    output x, z [m]: spline(order = 5, intervals = 8);
    table ground(x [m]) [m] = monotone { 0: 10; 300: 40; 500: 120; 700: 30; 1000: 20; }
    minimize integral(der(x, 2)^2 + der(z, 2)^2);
    initial { x == 0;  z == 60 [m]; }
    trajectory { above: z >= ground(x) + 30 [m]; }
    final { x == 1000 [m];  z == 60 [m]; }
    guess { x = 1000 [m] * tau;  z = 180 [m]; }
}
";

fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(folder).args(arguments).output().expect("the command starts")
}

fn with(spec: &str) -> TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("spec.ntg"), spec).expect("writable");
    folder
}

/// What goes to standard output and to standard error.
fn said(spec: &str, arguments: &[&str]) -> (String, String) {
    let folder = with(spec);
    let output = ntg(folder.path(), arguments);
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (text(&output.stdout), text(&output.stderr))
}

/// The saved run, and the charts of its page.
fn saved(spec: &str) -> (Value, Value) {
    let folder = with(spec);
    let (path, place) = (folder.path(), folder.path().join("run.json"));
    let output = ntg(path, &["solve", "spec.ntg", "--save", "run.json"]);
    assert!(place.exists(), "{}", String::from_utf8_lossy(&output.stderr));
    ntg(path, &["report", "run.json", "-o", "run.html"]);
    let page = fs::read_to_string(path.join("run.html")).expect("a page");
    let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).expect("charts");
    let run = serde_json::from_str(&fs::read_to_string(place).expect("a run")).expect("JSON");
    (run, serde_json::from_str(data).expect("JSON"))
}

fn list(value: &Value) -> impl Iterator<Item = &Value> {
    value.as_array().into_iter().flatten()
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

#[test]
fn a_vector_is_the_position_that_starts_vary() {
    let (found, _) = said(VECTORS, &["solve", "spec.ntg", "--starts", "5", "--start-kind", "routes"]);
    assert!(found.contains("a random route") && !found.contains("form a position"), "{found}");
}

#[test]
fn advice_and_refusals_name_options() {
    let (found, _) = said(VECTORS, &["solve", "spec.ntg", "--max-iterations", "1", "--method", "sqp"]);
    assert!(found.contains("try: Allow more iterations (`--max-iterations`)"), "{found}");
    let (_, refused) = said(VECTORS, &["solve", "spec.ntg", "--max-iterations", "0"]);
    assert!(refused.contains("'--max-iterations <N>': a whole number from 1 on"), "{refused}");
    let (_, refused) = said(VECTORS, &["solve", "spec.ntg", "--scale", "r"]);
    assert!(refused.contains("--scale r: write NAME=SIZE"), "{refused}");
}

#[test]
fn every_element_has_a_name_of_its_own() {
    let (run, _) = saved(VECTORS);
    let names: Vec<&str> = list(&run["constraints"]).filter_map(|c| c["name"].as_str()).collect();
    let bounds = "a[..] in -2 .. 2 [m/s^2]";
    assert_eq!(names[2..4], ["r[1] == 0", "r[2] == 0"], "{names:?}");
    assert!(["r[1] == 10 [m]", "r[2] == 5 [m]", bounds].iter().all(|name| names.contains(name)), "{names:?}");
    let mut rows: Vec<(&str, &str)> =
        list(&run["constraints"]).filter_map(|c| c["name"].as_str().zip(c["block"].as_str())).collect();
    rows.sort_unstable();
    assert!(rows.windows(2).all(|pair| pair[0] != pair[1]), "one row each: {rows:?}");
    let warnings: Vec<&str> = list(&run["warnings"]).filter_map(Value::as_str).collect();
    let told = warnings.iter().filter(|warning| warning.contains("in -2 .. 2"));
    assert!(told.into_iter().all(|w| w.starts_with("`a[1] in") || w.starts_with("`a[2] in")), "{warnings:?}");
}

#[test]
fn a_limit_is_drawn_and_held_against_while_it_holds() {
    let (run, charts) = saved(VECTORS);
    let lasting = number(&run["times"]["T"]);
    let slow = list(&charts).find(|chart| chart["title"] == "slow" && list(&chart["limits"]).next().is_some());
    let limit = &slow.expect("its chart")["limits"][0];
    assert!((number(&limit[2]) - lasting / 4.0).abs() < 1e-3 && (number(&limit[3]) - lasting / 2.0).abs() < 1e-3);
}

#[test]
fn the_mean_multipliers_of_intervals_add_up_to_the_derivative_by_the_bound() {
    let (run, charts) = saved(VECTORS);
    for constraint in list(&run["constraints"]).filter(|c| c["block"] == "trajectory" && c["line"] != 7) {
        let mut sum = 0.0;
        for member in list(&constraint["members"]) {
            let (t, mean): (Vec<f64>, Vec<f64>) =
                list(&member["mean_t"]).map(number).zip(list(&member["mean"]).map(number)).unzip();
            assert!(!t.is_empty(), "{}", constraint["name"]);
            sum += t.chunks_exact(2).zip(mean.chunks_exact(2)).map(|(t, mean)| (t[1] - t[0]) * mean[0]).sum::<f64>();
        }
        // A part of the time begins within an interval, and so do its means.
        let whole = number(&constraint["sensitivity"]);
        assert!((sum - whole).abs() <= 1e-9 * whole.abs().max(1e-3), "{}: {sum} {whole}", constraint["name"]);
    }
    let drawn = list(&charts).find(|chart| chart["y"] == "dJ*/d(bound), per second");
    assert!(drawn.is_some(), "densities are per second");
}

#[test]
fn the_ground_is_the_table_and_the_limit_above_it_a_line() {
    let (run, charts) = saved(TERRAIN);
    let surfaces = &run["scene"]["surfaces"];
    let flags: Vec<_> = list(surfaces).map(|s| (s["name"].as_str(), s["clearance"].as_bool())).collect();
    assert_eq!(flags, [(Some("ground"), Some(false)), (Some("above"), Some(true))]);
    let apart = list(&surfaces[1]["z"]).zip(list(&surfaces[0]["z"])).map(|(a, b)| number(a) - number(b));
    assert!(apart.into_iter().all(|apart| (apart - 40.0).abs() < 1e-3));
    let side = list(&charts).find(|chart| chart["title"] == "z from the side").expect("a view from the side");
    let kinds: Vec<_> = list(&side["shapes"]).map(|shape| (shape[0].as_str(), shape[1].as_str())).collect();
    assert_eq!(kinds, [(Some("ground"), Some("ground")), (Some("border"), Some("above: stay above"))]);
    let (run, _) = saved(SIDE);
    let lines: Vec<_> = list(&run["scene"]["outlines"]).map(|o| (o["name"].as_str(), o["ground"].as_bool())).collect();
    assert_eq!(lines, [(Some("ground"), Some(true)), (Some("above"), Some(false))]);
}

#[test]
fn lines_of_equal_value_go_as_far_as_a_map_shows() {
    let chart = TERRAIN.replace("above: z >= ground(x, y) + 40 [m];", "der(z) <= 100 [m/s];").replace(
        "+ der(z, 2)^2);",
        "
        + der(z, 2)^2) + 0.001 [m/s^4] * integral(ground(x, y));",
    );
    let (run, _) = saved(&chart);
    let across = list(&run["scene"]["levels"]).flat_map(|level| list(&level["lines"])).flat_map(list);
    let (low, high) = across.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), at| {
        (low.min(number(&at[0])), high.max(number(&at[0])))
    });
    // The track goes from 100 to 900, the table ends at 0 and 1000.
    assert!(low < -10.0 && high > 1010.0, "{low} {high}");
}

#[test]
fn a_spec_without_units_has_no_seconds() {
    let spec = "problem Pure { duration T = 1;  output x: spline(order = 4, intervals = 1);
        minimize integral(der(x, 2)^2);  initial { x == 0; }  final { x == 1; } }";
    let (found, _) = said(spec, &["solve", "spec.ntg"]);
    assert!(found.lines().any(|line| line.trim_start().starts_with("t ")) && !found.contains("[s]"), "{found}");
    let (run, _) = saved(spec);
    assert_eq!(run["independent"]["unit"], "");
}

#[test]
fn a_duration_that_is_as_short_as_it_may_be_is_told() {
    let spec = "problem Short { duration T in 0 .. 10 [s];  output x [m]: spline(order = 4, intervals = 1);
        minimize T;  initial { x == 0; } }";
    let (found, _) = said(spec, &["solve", "spec.ntg"]);
    let wanted = "warning: `T` is as short as a duration may be, 0.00001 s: a millionth of its upper bound; give it a lower \
                  bound above 0";
    assert!(found.contains(wanted), "{found}");
    let (found, _) = said(&spec.replace("in 0 ..", "in 0.1 .."), &["solve", "spec.ntg"]);
    assert!(!found.contains("as short as"), "{found}");
}

#[test]
fn what_is_no_parameter_is_told_how_to_become_one() {
    let fixed = SIDE.replace("duration T = 100 [s];", "duration T = 100 [s];  param gap = 30 [m];");
    for (spec, words) in [
        (
            fixed.as_str(),
            "--set T=5: `T` is no parameter but a fixed duration: write `param T_set = ...;` and `duration T = T_set;` in \
             the spec, and set `T_set`; the parameters are: `gap`",
        ),
        (VECTORS, "--set T=5: `T` is no parameter but declared with bounds: change them in the spec"),
    ] {
        let (_, refused) = said(spec, &["solve", "spec.ntg", "--set", "T=5"]);
        assert!(refused.contains(words), "{refused}");
    }
}

#[test]
fn the_array_of_a_scenario_is_no_name_of_the_spec() {
    let spec = |limit: &str, outside: &str| {
        format!(
            "problem Cases {{ duration T = 6 [s];  collocation gauss(points = 3, intervals = 4);
            scenario case[k in 1 .. 3] {{
                state p [m];  input u in -2 .. 2 [m/s];  shared u;
                dynamics {{ der(p) == u / k; }}  initial {{ p == 0; }}  trajectory {{ {limit} }}
            }}
            minimize final(case[1].p)^2 + {outside}; }}"
        )
    };
    let (_, found) = said(&spec("case_p <= 1 [m];", "0 [m]^2"), &["check", "spec.ntg"]);
    assert!(found.contains("error[E020]: unknown name `case_p`\n"), "{found}");
    assert!(found.contains("= help: the member's own is `p`") && found.contains("spec.ntg: 1 error"), "{found}");
    let (_, found) = said(&spec("p <= 1 [m];", "final(case_p[2])^2"), &["check", "spec.ntg"]);
    assert!(found.contains("= help: a member's is `case[1].p`") && found.contains("spec.ntg: 1 error"), "{found}");
}
