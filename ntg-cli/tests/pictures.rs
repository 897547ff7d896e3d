//! What reports, plots and tables of samples hold, as a user gets them.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;
use tempfile::TempDir;

/// Over a hill, past a mast, round a balloon, to a pad: everything that a track may pass.
const SPEC: &str = "/// Past all kinds of things.
problem Tour {
    duration T in 5 .. 60 [s];
    output r[3] [m]: spline(order = 5, intervals = 6, smoothness = 3);
    collocation gauss(points = 3);
    param pad[3] = (100, 20, 30) [m];
    param mast_place[2] = (30, -10) [m];
    let far [m] = norm(r - pad);
    let low = r[3] - 10 [m];
    let wind [m/s] = 3 [m/s] * sin(r[1] / 40 [m]) + 0.01 [1/s] * r[2];
    let turned = atan2(der(r[2]), der(r[1]));
    minimize time [s]: T;
    minimize effort [s]: 1e-3 [s^4/m^2] * integral(norm(der(r, 2))^2);
    initial { r == (0, 0, 30) [m]; }
    trajectory {
        balloon: norm(r - (60, 10, 40) [m]) >= 15 [m];
        mast: (r[1] - mast_place[1])^2 + (r[2] - mast_place[2])^2 >= (8 [m])^2;
        quiet: exp(-((r[1] - 80 [m])^2 + 4 * (r[2] + 30 [m])^2) / (20 [m])^2) <= 0.5;
        ground: r[3] >= 10 [m] + 0.1 * r[1];
        box: r[2] in -50 .. 50 [m];
        speed: norm(der(r))^2 <= (20 [m/s])^2;
    }
    final { r == pad; }
    guess { r through (0, 0, 30), (60, 40, 40), (100, 20, 30) [m];  T = 20 [s]; }
}
";

fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(folder).args(arguments).output().expect("the command starts")
}

#[track_caller]
fn done(folder: &Path, arguments: &[&str]) {
    let output = ntg(folder, arguments);
    assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).expect("it was written")
}

fn tour() -> (TempDir, Value) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("tour.ntg"), SPEC).expect("writable");
    done(folder.path(), &["solve", "tour.ntg", "--save", "tour.json", "--csv", "tour.csv", "--every", "100ms"]);
    let run = serde_json::from_str(&read(folder.path(), "tour.json")).expect("JSON");
    (folder, run)
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn named<'v>(list: &'v Value, name: &str) -> &'v Value {
    let found: Vec<&Value> = list.as_array().expect("a list").iter().filter(|one| one["name"] == name).collect();
    assert_eq!(found.len(), 1, "`{name}` stands once in {list}");
    found[0]
}

#[test]
fn what_a_track_passes_is_found_from_the_constraints_alone() {
    let (_folder, run) = tour();
    let scene = &run["scene"];
    assert_eq!(scene["tracks"][0]["paths"], serde_json::json!(["r[1]", "r[2]", "r[3]"]));
    assert_eq!(scene["up"], 2);

    let pad = named(&scene["places"], "pad");
    assert_eq!(pad["at"], serde_json::json!([100.0, 20.0, 30.0]));
    let balloon = named(&scene["balls"], "balloon");
    assert_eq!(balloon["keep_out"], true);
    for (axis, wanted) in [60.0, 10.0, 40.0].into_iter().enumerate() {
        assert!((number(&balloon["centre"][axis]) - wanted).abs() < 1e-6);
        assert!((number(&balloon["half_axes"][axis][axis]) - 15.0).abs() < 1e-6);
    }
    let mast = named(&scene["outlines"], "mast");
    assert_eq!(mast["keep_out"], true);
    for at in mast["lines"][0].as_array().expect("points") {
        let away = (number(&at[0]) - 30.0).hypot(number(&at[1]) + 10.0);
        assert!((away - 8.0).abs() < 1e-6, "{away}");
    }
    // No quadratic, so its line is found on a grid; closed, and forbidden inside.
    let quiet = named(&scene["outlines"], "quiet");
    assert_eq!(quiet["keep_out"], true);
    for at in quiet["lines"][0].as_array().expect("points") {
        let (x, y) = (number(&at[0]) - 80.0, number(&at[1]) + 30.0);
        let value = (-(x * x + 4.0 * y * y) / 400.0).exp();
        assert!((value - 0.5).abs() < 1e-3, "{value}");
    }
    let ground = named(&scene["surfaces"], "ground");
    assert_eq!(ground["floor"], true);
    let (x, y, z) = (&ground["x"], &ground["y"], &ground["z"]);
    let across = y.as_array().expect("grid lines").len();
    for (i, x) in x.as_array().expect("grid lines").iter().enumerate() {
        assert!((number(&z[i * across]) - 10.0 - 0.1 * number(x)).abs() < 1e-9);
    }
    // What is named and depends on the place alone has lines of equal value.
    let levels = scene["levels"].as_array().expect("lines of equal value");
    assert!(levels.len() > 3 && levels.iter().all(|level| level["name"] == "wind"));
    for level in levels {
        for at in level["lines"].as_array().expect("lines").iter().flat_map(|line| line.as_array().expect("points")) {
            let wind = 3.0 * (number(&at[0]) / 40.0).sin() + 0.01 * number(&at[1]);
            assert!((wind - number(&level["value"])).abs() < 1e-3, "{wind}");
        }
    }
    // Both sides of the box are borders, one of them in the picture of the track at least.
    let borders = scene["outlines"].as_array().expect("a list").iter().filter(|one| one["name"] == "box");
    assert!(borders.clone().count() >= 1 && borders.clone().all(|one| one["keep_out"] == false));
    // What depends on the velocity is nowhere.
    assert!(!scene.to_string().contains("speed"));
}

/// Over a table of heights, which a constraint holds (HOLD) or an integral alone asks for, past two radars.
const HILLS: &str = "problem Hills {
    const R = 2;
    duration T = 100 [s];
    output r[2] [km]: spline(order = 4, intervals = 4);
    output z [m]: spline(order = 4, intervals = 4);
    table ground(east [km], north [km]) [m] = bspline(order = 3) {
           0,   2,   4;
      0:   0, 100,   0;
      2: 100, 400, 100;
      4:   0, 100,   0;
    }
    param radar[R, 2] = ((1, 3), (3, 1)) [km];
    param reach[R] = (3, 2) [km];
    minimize effort: integral(norm(der(r, 2))^2 + der(z, 2)^2) / 1 [m^2/s^3];
    minimize height: integral((z - ground(r[1], r[2]))^2) / 1 [km^2*s];
    minimize seen: sum(i in 1 .. R, integral(exp(-dot(r - radar[i], r - radar[i]) / reach[i]^2))) / 1 [s];
    initial { r == (0.5, 0.5) [km];  z == 300 [m]; }
    HOLD
    final { r == (3.5, 3) [km];  z == 300 [m]; }
}
";

fn hills(hold: &str) -> Value {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("hills.ntg"), HILLS.replace("HOLD", hold)).expect("writable");
    done(folder.path(), &["solve", "hills.ntg", "--save", "hills.json"]);
    let run: Value = serde_json::from_str(&read(folder.path(), "hills.json")).expect("JSON");
    run["scene"].clone()
}

#[test]
fn heights_in_a_table_are_hills_under_the_track_and_a_list_of_lengths_is_no_place() {
    let scene = hills("trajectory { terrain: z >= ground(r[1], r[2]) + 50 [m]; }");
    assert_eq!(scene["tracks"][0]["paths"], serde_json::json!(["r[1]", "r[2]", "z"]));
    assert_eq!((&scene["up"], &scene["axes"][2]["unit"]), (&Value::from(2), &Value::from("m")));
    let terrain = named(&scene["surfaces"], "terrain");
    let highest = terrain["z"].as_array().expect("heights").iter().map(number).fold(0.0, f64::max);
    assert!(terrain["floor"] == true && (highest - 450.0).abs() < 1.0, "{highest}");
    let places = |scene: &Value| {
        let places = scene["places"].as_array().expect("places").iter();
        places.map(|place| place["name"].as_str().unwrap_or_default().to_owned()).collect::<Vec<_>>()
    };
    assert_eq!(places(&scene), ["radar[1]", "radar[2]"]);
    assert_eq!(scene["places"][0]["at"][1], 3.0);

    // Where no constraint draws the ground, the table itself does.
    let scene = hills("");
    let levels = scene["levels"].as_array().expect("lines of equal value");
    assert!(levels.len() > 3 && levels.iter().all(|level| level["name"] == "ground"), "{levels:?}");
    // Beyond its nodes, 0 and 4, the table keeps its end value: where a line leaves them, it goes straight on.
    let lines = levels.iter().flat_map(|level| level["lines"].as_array().expect("lines"));
    let beyond = lines.map(|line| {
        let points = line.as_array().expect("points").iter();
        points.map(|at| [number(&at[0]), number(&at[1])]).filter(|[x, _]| *x < -0.1).collect::<Vec<_>>()
    });
    let beyond: Vec<_> = beyond.filter(|points| points.len() > 1).collect();
    assert!(!beyond.is_empty(), "{levels:?}");
    assert!(
        beyond.iter().flatten().all(|[_, y]| beyond.iter().any(|line| (line[0][1] - y).abs() < 0.05)),
        "{beyond:?}"
    );
    assert_eq!(places(&scene), ["radar[1]", "radar[2]"]);
}

/// A glider over hills, its height above them given, and a speed limit that falls with time.
fn glider(clearance: &str) -> Value {
    let spec = "problem Glider {
        duration T = 10 [s];
        state x [m], z [m], w [m/s];
        input a in -9 .. 9 [m/s^2]: held;
        collocation gauss(points = 3, intervals = 10);
        table hills(s [m]) [m] = monotone { 0: 0; 100: 20; 200: 5; 300: 30; 400: 0; }
        minimize integral(a^2) / 1 [m^2/s^3];
        dynamics { der(x) == 40 [m/s]; der(z) == w; der(w) == a; }
        initial { x == 0; z == 30 [m]; w == 0; }
        final { z == 30 [m]; }
        trajectory { clear: z >= hills(x) CLEARANCE; w <= 20 [m/s] - 1 [m/s^2] * t; }
        trajectory from 4 [s] to 6 [s] { slow: w >= -5 [m/s]; }
    }";
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("glider.ntg"), spec.replace("CLEARANCE", clearance)).expect("written");
    let saved = ["solve", "glider.ntg", "--save", "run.json", "--between-tolerance", "1"];
    assert!(matches!(ntg(folder.path(), &saved).status.code(), Some(0 | 3)));
    serde_json::from_str(&read(folder.path(), "run.json")).expect("a run")
}

#[test]
fn a_table_is_the_ground_whatever_its_argument_is_called() {
    let grounds = |run: &Value| -> Vec<(String, bool)> {
        let outlines = run["scene"]["outlines"].as_array().cloned().unwrap_or_default();
        let of = |own: &Value| (own["name"].as_str().unwrap_or_default().to_owned(), own["ground"] == true);
        outlines.iter().map(of).collect()
    };
    let told = |pairs: &[(&str, bool)]| pairs.iter().map(|(name, is)| ((*name).to_owned(), *is)).collect::<Vec<_>>();
    assert_eq!(grounds(&glider("+ 8 [m]")), told(&[("hills", true), ("clear", false)]));
    assert_eq!(grounds(&glider("")), told(&[("clear", true)]));
}

#[test]
fn a_limit_over_time_is_saved_as_a_curve_and_that_of_a_part_holds_there() {
    let run = glider("+ 8 [m]");
    let all = run["constraints"].as_array().expect("a list");
    let member = |text: &str| {
        let of = |own: &&Value| own["text"].as_str().is_some_and(|own| own.starts_with(text));
        &all.iter().find(of).expect("it is there")["members"][0]
    };
    let curve = &member("w <= 20")["curve"];
    assert_eq!((&curve["of"], &curve["upper"]), (&Value::from("w"), &Value::from(true)));
    let (t, limit) = (&member("w <= 20")["t"], &curve["limit"]);
    for (t, limit) in t.as_array().expect("times").iter().zip(limit.as_array().expect("limits")) {
        assert!((number(limit) - (20.0 - number(t))).abs() < 1e-6, "{t}: {limit}");
    }
    let slow = member("slow")["t"].as_array().expect("times");
    let ends = (number(&slow[0]), number(slow.last().expect("times")));
    assert!((ends.0 - 4.0).abs() < 1e-9 && (ends.1 - 6.0).abs() < 1e-9, "{ends:?}");
    assert!(member("slow")["curve"].is_null());
}

#[test]
fn samples_are_equally_spaced_and_end_at_the_end() {
    let (folder, run) = tour();
    let text = read(folder.path(), "tour.csv");
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let heads: Vec<String> = reader.headers().expect("a header").iter().map(str::to_owned).collect();
    assert_eq!(heads[..4], ["t [s]", "r[1] [m]", "r[2] [m]", "r[3] [m]"]);
    assert!(heads.contains(&"far [m]".to_owned()));
    let rows: Vec<Vec<f64>> = reader
        .records()
        .map(|row| row.expect("a row").iter().map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    for (step, row) in rows.iter().enumerate().take(rows.len() - 1) {
        assert!((row[0] - 0.1 * step as f64).abs() < 1e-12);
    }
    let last = rows.last().expect("rows");
    assert!((last[0] - number(&run["times"]["T"])).abs() < 1e-12);
    assert!((last[1] - 100.0).abs() < 1e-6 && (last[2] - 20.0).abs() < 1e-6);

    for (arguments, words) in [
        (&["--every", "1s"][..], "--csv FILE"),
        (&["--csv", "b.csv", "--every", "-1s"], "one positive time"),
        (&["--csv", "b.csv", "--every", "1 m"], "--every 1 m"),
        (&["--csv", "b.csv", "--every", "soon"], "write a number"),
        (&["--csv", "tour.csv"], "--force"),
        // What another program would open as what it is not.
        (&["--csv", "b.xlsx"], "`b.xlsx`: samples are .csv or .parquet files; spreadsheets open .csv"),
        (&["--csv", "b.Parquet"], "name a .csv file, or give --parquet b.Parquet"),
        (&["--csv", "b.json"], "samples are .csv or .parquet files"),
        (&["--parquet", "b.csv"], "name a .parquet file, or give --csv b.csv"),
        (&["--parquet", "b.xlsx"], "`b.xlsx`: samples are .csv or .parquet files"),
    ] {
        let output = ntg(folder.path(), &[&["solve", "tour.ntg"], arguments].concat());
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.code() == Some(2) && said.contains(words), "{arguments:?}: {said}");
    }
}

#[test]
fn a_report_shows_tracks_extremes_and_helpers_on_demand() {
    let (folder, run) = tour();
    assert_eq!((&run["lets"]["low"]["helper"], &run["lets"]["far"]["helper"]), (&Value::Bool(true), &Value::Null));
    done(folder.path(), &["report", "tour.json", "-o", "tour.html"]);
    let page = read(folder.path(), "tour.html");
    assert!(page.len() < 1_500_000, "{}", page.len());
    assert!(!page.contains("http://") || !page.contains("src=\"http"), "no network");
    for part in ["\"kind\":\"space\"", "id=\"extremes\"", "id=\"clock\"", "Not drawn, because they only serve"] {
        assert!(page.contains(part), "{part}");
    }
    let title = "\"title\":\"low\"";
    assert!(!page.contains(title));
    done(folder.path(), &["report", "tour.json", "-o", "all.html", "--all"]);
    assert!(read(folder.path(), "all.html").contains(title));

    done(folder.path(), &["plot", "tour.json", "-o", "tour.svg"]);
    let picture = read(folder.path(), "tour.svg");
    assert!(picture.contains("balloon") && picture.contains("pad"), "what is passed is drawn");
    // A line over time has points between whole pixels.
    assert!(
        picture.starts_with("<svg width=\"1600\"") && picture.contains("viewBox=\"0 0 16000 "),
        "{}",
        &picture[..99]
    );
}

#[test]
fn five_commands_lead_from_nothing_to_a_picture_of_a_descent_that_turns() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    done(folder, &["new", "lander", "--three-dimensional"]);
    done(folder, &["check", "lander.ntg"]);
    done(folder, &["solve", "lander.ntg", "--save", "lander.json"]);
    done(folder, &["plot", "lander.json", "-o", "lander.svg"]);
    done(folder, &["report", "lander.json", "-o", "lander.html"]);

    done(folder, &["fmt", "--check", "lander.ntg"]);
    let run: Value = serde_json::from_str(&read(folder, "lander.json")).expect("JSON");
    assert_eq!(
        (&run["status"], &run["warnings"]),
        (&Value::from("solved"), &Value::Null),
        "a newcomer sees no warning"
    );
    let scene = &run["scene"];
    assert!(
        named(&scene["balls"], "clear")["keep_out"] == true
            && named(&scene["surfaces"], "glide_slope")["floor"] == true
    );
    let page = read(folder, "lander.html");
    assert!(page.contains("\"kind\":\"space\"") && page.contains("status good"), "solved, in green");
}

/// The charts of a page.
fn charts(page: &str) -> Value {
    let data = page.split("id=\"data\">").nth(1).and_then(|rest| rest.split("</script>").next()).expect("data");
    serde_json::from_str(data).expect("a list of charts")
}

#[test]
fn runs_that_are_compared_have_their_own_zones_in_their_own_colours() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    done(folder, &["new", "lander", "--three-dimensional"]);
    done(folder, &["solve", "lander.ntg", "--save", "wide.json"]);
    done(folder, &["solve", "lander.ntg", "--set", "hill_radius=500", "--save", "narrow.json"]);
    done(folder, &["report", "wide.json", "-o", "one.html"]);
    done(folder, &["report", "wide.json", "narrow.json", "-o", "both.html"]);
    let kind = |charts: &Value, title: &str| {
        let all = charts.as_array().expect("charts");
        all.iter().find(|chart| chart["title"] == title).expect(title).clone()
    };
    let both = charts(&read(folder, "both.html"));
    let balls: Vec<(String, Value)> = kind(&both, "in space")["balls"]
        .as_array()
        .expect("balls")
        .iter()
        .map(|ball| (ball["name"].as_str().unwrap_or_default().to_owned(), ball["of"].clone()))
        .collect();
    assert_eq!(balls, [("clear (wide)".to_owned(), Value::from(0)), ("clear (narrow)".to_owned(), Value::from(1))]);
    // Kind, name, and line of what lies beneath a map. The glide slope is the same, and each track is over a part of its own.
    let beneath = |charts: &Value, title: &str| -> Vec<(String, String, Value)> {
        let shapes = kind(charts, title)["shapes"].as_array().expect("shapes").clone();
        let word = |value: &Value| value.as_str().unwrap_or_default().to_owned();
        let all = shapes.iter().map(|shape| (word(&shape[0]), word(&shape[1]), shape[4].clone()));
        all.filter(|(kind, ..)| kind == "area" || kind == "ground").collect()
    };
    let of = |kind: &str, name: &str, line: Value| (kind.to_owned(), name.to_owned(), line);
    assert_eq!(
        beneath(&both, "r[3] from the side"),
        [
            of("ground", "glide_slope", Value::from(0)),
            of("area", "clear (wide)", Value::from(0)),
            of("ground", "glide_slope", Value::from(1)),
            of("area", "clear (narrow)", Value::from(1)),
        ]
    );
    let own = [of("area", "clear (wide)", Value::from(0)), of("area", "clear (narrow)", Value::from(1))];
    assert_eq!(beneath(&both, "r[2] over r[1], from above"), own);
    // Alone, the hill is cut along the track, and is nobody's.
    let one = charts(&read(folder, "one.html"));
    let cut = [of("ground", "glide_slope", Value::Null), of("area", "clear", Value::Null)];
    assert_eq!(beneath(&one, "r[3] from the side"), cut);
}

#[test]
fn what_was_measured_is_drawn_beside_the_curves_and_as_residuals() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let folder = folder.path();
    let spec = "problem Line {
    param seen[3] = (0.1, 0.9, 2.1) [m];
    const time[3] = (0, 1, 2) [s];
    duration T = 2 [s];
    state p[2] [m];
    collocation gauss(points = 2, intervals = 2);
    variable speed [m/s];
    dynamics { der(p) == (speed, 0 [m/s]); }
    let half [cm] = p[1] / 2;
    measure {
        for i in 1 .. 3 { tape: at(time[i], p[1]) == seen[i] sigma 10 [cm]; }
        ruler: 60 [cm] == at(1 [s], half) sigma 2 [cm];
        plane: initial(p) == (0, 0) [m] sigma 1 [m];
        twice: 2 * final(p[1]) == 4.2 [m] sigma 1 [m];
        speed == 1 [m/s] sigma 1 [m/s];
    }
}
";
    fs::write(folder.join("line.ntg"), spec).expect("a spec");
    done(folder, &["solve", "line.ntg", "--save", "line.json"]);
    let run: Value = serde_json::from_str(&read(folder, "line.json")).expect("JSON");
    let measured = run["estimate"]["measurements"].as_array().expect("measurements");
    let told = |residual: &Value| (residual["of"].as_str().map(str::to_owned), residual["t"].as_f64());
    let all: Vec<_> = measured.iter().flat_map(|m| m["residuals"].as_array().expect("residuals")).collect();
    let of = |of: &str, t: f64| (Some(of.to_owned()), Some(t));
    assert_eq!(
        all.iter().map(|residual| told(residual)).collect::<Vec<_>>(),
        [
            of("p[1]", 0.0),
            of("p[1]", 1.0),
            of("p[1]", 2.0),
            of("half", 1.0),
            of("p[1]", 0.0),
            of("p[2]", 0.0),
            (None, Some(2.0)),
            (None, None)
        ]
    );
    // What was measured, and its deviation, in the unit of the quantity, whichever side it stands on.
    let expected = [(0.1, 0.1), (0.9, 0.1), (2.1, 0.1), (60.0, 2.0), (0.0, 1.0)];
    for (residual, (measured, sigma)) in all.iter().zip(expected) {
        assert!((number(&residual["measured"]) - measured).abs() < 1e-6, "{residual}");
        assert!((number(&residual["sigma"]) - sigma).abs() < 1e-6, "{residual}");
    }
    done(folder, &["report", "line.json", "-o", "line.html"]);
    let page = read(folder, "line.html");
    let charts = charts(&page);
    let lines = |title: &str| -> Vec<(String, Value, usize)> {
        let all = charts.as_array().expect("charts").iter().find(|chart| chart["title"] == title).expect(title);
        let name = |line: &Value| line["name"].as_str().unwrap_or_default().to_owned();
        let bars = |line: &Value| line["sigma"].as_array().map_or(0, Vec::len);
        let lines = all["lines"].as_array().expect("lines").iter();
        lines.map(|line| (name(line), line["like"].clone(), bars(line))).collect()
    };
    let curve = |name: &str| (name.to_owned(), Value::Null, 0);
    let points = |name: &str, like: usize, count: usize| (name.to_owned(), Value::from(like), count);
    let p = [curve("p[1]"), curve("p[2]"), points("tape: p[1]", 0, 3), points("plane: p[1]", 0, 1)];
    assert_eq!(lines("p")[..4], p);
    assert_eq!(lines("half"), [curve("half"), points("ruler: half", 0, 1)]);
    assert_eq!(lines("tape"), [("p[1]".to_owned(), Value::Null, 3)]);
    assert!(page.contains("<h2>Residuals</h2>") && lines("twice").len() == 1);
    done(folder, &["plot", "line.json", "--show", "p", "-o", "line.svg"]);
    assert!(read(folder, "line.svg").contains("tape: p[1]"));
}

#[test]
fn curves_of_constraints_go_on_in_time() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let spec = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs/low_observable.ntg");
    let spec = spec.to_str().expect("UTF-8");
    // Its limit is looked at between the points too.
    let output = ntg(folder.path(), &["solve", spec, "--save", "run.json"]);
    assert!(output.status.code() == Some(3) || output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let run: Value = serde_json::from_str(&read(folder.path(), "run.json")).expect("JSON");
    let members = run["constraints"].as_array().expect("constraints").iter().flat_map(|one| one["members"].as_array());
    let mut count = 0;
    for member in members.flatten() {
        let times: Vec<f64> = member["t"].as_array().into_iter().flatten().map(number).collect();
        assert!(times.len() < 2 || times.is_sorted(), "{}: {times:?}", member["name"]);
        count += usize::from(times.len() > 1);
    }
    assert!(count >= 3, "only {count} constraints along the way");
}
