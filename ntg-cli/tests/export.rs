//! `ntg export` and `ntg check-solution` as a user runs them.

use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn ntg(arguments: &[&str], folder: &Path) -> Output {
    let specs = Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs");
    let arguments = arguments.iter().map(|word| match word.strip_prefix("specs/") {
        Some(spec) => specs.join(spec).into_os_string(),
        None => word.into(),
    });
    Command::new(env!("CARGO_BIN_EXE_ntg")).current_dir(folder).args(arguments).output().expect("the command starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

#[test]
fn three_files_are_written_and_none_is_replaced() {
    let folder = tempfile::tempdir().expect("a folder");
    let export =
        |more: &[&str]| ntg(&[&["export", "specs/van_der_pol.ntg", "-o", "v.nl"], more].concat(), folder.path());
    let done = export(&[]);
    assert_eq!(text(&done.stdout), "v.nl: 7 variables, 3 rows; names in v.col and v.row\n", "{}", text(&done.stderr));
    let read = |name: &str| std::fs::read_to_string(folder.path().join(name)).expect(name);
    assert!(read("v.nl").starts_with("g3 1 1 0\t# problem VanDerPol\n 7 3 1 0 3\t"));
    assert_eq!(read("v.row"), "z == 1 at the start\nder(z) == 0 at the start\nder(z) - z == 1 at the end\nobjective\n");
    assert_eq!(read("v.col").lines().next(), Some("coefficient 1 of z"));
    let again = export(&[]);
    assert_eq!(again.status.code(), Some(2));
    assert!(text(&again.stderr).contains("`v.nl` exists; give --force to replace it"), "{}", text(&again.stderr));
    assert_eq!(export(&["--force"]).status.code(), Some(0));
    // The names would go where the program goes.
    let bad = ntg(&["export", "specs/van_der_pol.ntg", "-o", "v.row"], folder.path());
    assert_eq!(bad.status.code(), Some(2));
}

#[test]
fn a_saved_solution_is_judged_and_a_changed_problem_is_not_solved_by_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let solved = ntg(&["solve", "specs/low_observable.ntg", "--save", "run.json"], folder.path());
    assert_eq!(solved.status.code(), Some(0), "{}", text(&solved.stderr));
    let check = |more: &[&str]| {
        let all = [&["check-solution", "specs/low_observable.ntg", "run.json", "--format", "json"], more].concat();
        let done = ntg(&all, folder.path());
        let found: Value = serde_json::from_slice(&done.stdout).unwrap_or_else(|_| panic!("{}", text(&done.stderr)));
        (done.status.code(), found)
    };
    let (code, found) = check(&[]);
    assert_eq!((code, &found["solution"]), (Some(0), &Value::Bool(true)), "{found:#}");
    let stationarity = found["stationarity"]["relative"].as_f64().expect("judged by its multipliers");
    assert!(stationarity < 1e-6, "{stationarity}");
    let objective = found["objective"].as_f64().expect("a number");
    assert!((objective / 130.907_227_498 - 1.0).abs() < 1e-6, "{objective}");
    let (code, found) = check(&["--set", "signature_max=4"]);
    assert_eq!((code, &found["solution"]), (Some(1), &Value::Bool(false)), "{found:#}");
    let worst = found["missed"][0]["name"].as_str().expect("a name");
    assert!(worst.starts_with("`low_observable`"), "{worst}");
}

/// A feasible point that is none: a saved solution of another price, with its multipliers and without.
#[test]
fn a_point_that_meets_all_constraints_is_called_a_solution_only_by_its_multipliers() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = |price: f64| {
        format!(
            "problem Force {{\n    duration T = 1;\n    output x: spline(order = 5, intervals = 4);\n    minimize integral(der(x, 2)^2) + {price} * at(T / 2, x)^2;\n    initial {{ x == 0;  der(x) == 0; }}\n    final {{ x == 1;  der(x) == 0; }}\n}}\n"
        )
    };
    for (name, price) in [("dear", 100.0), ("cheap", 0.0)] {
        std::fs::write(folder.path().join(format!("{name}.ntg")), spec(price)).expect("written");
    }
    let solved = ntg(&["solve", "cheap.ntg", "--save", "run.json"], folder.path());
    assert_eq!(solved.status.code(), Some(0), "{}", text(&solved.stderr));
    let check = |of: &str, point: &str| ntg(&["check-solution", of, point], folder.path());
    let [same, other] = ["cheap.ntg", "dear.ntg"].map(|of| check(of, "run.json"));
    assert!(text(&same.stdout).ends_with("\na solution\n"), "{}", text(&same.stdout));
    assert_eq!((other.status.code(), text(&other.stdout).ends_with("\nno solution\n")), (Some(1), true));
    // A problem with other splines.
    std::fs::write(folder.path().join("fine.ntg"), spec(0.0).replace("intervals = 4", "intervals = 5"))
        .expect("written");
    let fine = text(&check("fine.ntg", "run.json").stdout);
    assert!(
        fine.starts_with("point:            interpolated: it was saved by a problem with other splines\n"),
        "{fine}"
    );
    assert!(!text(&same.stdout).contains("interpolated"), "{}", text(&same.stdout));
    // A file from before multipliers were saved.
    let saved = std::fs::read_to_string(folder.path().join("run.json")).expect("saved");
    let mut saved: Value = serde_json::from_str(&saved).expect("JSON");
    saved.as_object_mut().expect("an object").remove("row_multipliers");
    std::fs::write(folder.path().join("old.json"), saved.to_string()).expect("written");
    let old = check("dear.ntg", "old.json");
    assert_eq!((same.status.code(), old.status.code()), (Some(0), Some(3)), "0 is for what is known to be a solution");
    let old = text(&old.stdout);
    let words = "it meets all constraints; whether it is optimal is not known without multipliers\n";
    assert!(old.contains("the point has no multipliers") && old.ends_with(words), "{old}");
}

/// Two satellites far out, whose distance is small beside where they are: a limit is missed by what it is, in its unit.
#[test]
fn what_a_limit_is_missed_by_is_relative_to_the_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = |gap: &str| {
        format!(
            "problem Gap {{
                duration T = 100 [s];
                output x, y [km]: spline(order = 5, intervals = 4);
                minimize integral(der(x, 2)^2 + der(y, 2)^2) * 1 [s^3/m^2];
                initial {{ x == 7000 [km]; y == 7000 [km]; }}
                final {{ x == 7010 [km]; y == 7010 [km]; }}
                {gap}
            }}"
        )
    };
    std::fs::write(folder.path().join("far.ntg"), spec("at 50 [s] { x == y + 0.8 [m]; }")).expect("written");
    std::fs::write(folder.path().join("gap.ntg"), spec("trajectory { gap: -50 [cm] <= x - y <= 50 [cm]; }"))
        .expect("written");
    let solved = ntg(&["solve", "far.ntg", "--save", "run.json"], folder.path());
    assert_eq!(solved.status.code(), Some(0), "{}", text(&solved.stderr));
    let check = |more: &[&str]| ntg(&[&["check-solution", "gap.ntg", "run.json"], more].concat(), folder.path());
    let said = text(&check(&[]).stdout);
    assert!(said.ends_with("\nno solution\n"), "{said}");
    assert!(
        said.contains("`gap`")
            && said.contains("is 8.000000e-4 km and misses its bound by 3.000e-4 km (6.0e-1 relative)"),
        "{said}"
    );
    let found: Value = serde_json::from_str(&text(&check(&["--format", "json"]).stdout)).expect("JSON");
    assert_eq!(found["missed"][0]["unit"], "km");
    // Another limit has another number of rows, and its multipliers say nothing here.
    std::fs::write(folder.path().join("two.ntg"), spec("trajectory { far: x >= 0; high: y >= 0; }")).expect("written");
    let two = text(&ntg(&["check-solution", "two.ntg", "run.json"], folder.path()).stdout);
    assert!(two.contains("multipliers of another program"), "{two}");
    // A number that is none.
    let saved = std::fs::read_to_string(folder.path().join("run.json")).expect("saved");
    let mut saved: Value = serde_json::from_str(&saved).expect("JSON");
    saved["unknowns"][3] = Value::Null;
    std::fs::write(folder.path().join("run.json"), saved.to_string()).expect("written");
    let refused = check(&[]);
    assert!(text(&refused.stderr).contains("not all of `unknowns` are finite numbers"), "{}", text(&refused.stderr));
}

/// A guess at which a current is 1e20 A/m^2 tells a size of the energy beside which any initial value is 0.
#[test]
fn a_point_is_judged_by_what_it_is_and_not_by_a_guess_at_which_terms_explode() {
    let folder = tempfile::tempdir().expect("a folder");
    let spec = "problem Load {
        domain t [h];
        duration T = 24 [h];
        param first = 0 [kWh/m^2];
        state energy [kWh/m^2];
        input v in 0 .. 5 [V];
        collocation gauss(points = 3, intervals = 24);
        let j [A/m^2] = 20 [A/m^2] * sinh(v / 0.0514 [V]);
        minimize final(energy);
        dynamics { der(energy) == j * v; }
        trajectory { j == 2000 [A/m^2] - 1500 [A/m^2] * cos(2 * pi * t / 24 [h]); }
        initial { charge: energy == first; }
    }";
    std::fs::write(folder.path().join("load.ntg"), spec).expect("written");
    let solved = ntg(&["solve", "load.ntg", "--set", "first=2.85", "--save", "run.json"], folder.path());
    assert_eq!(solved.status.code(), Some(0), "{}", text(&solved.stderr));
    let check = |more: &[&str]| ntg(&[&["check-solution", "load.ntg", "run.json"], more].concat(), folder.path());
    assert_eq!(check(&["--set", "first=2.85"]).status.code(), Some(0));
    let other = text(&check(&[]).stdout);
    assert!(other.contains("`charge`") && other.ends_with("\nno solution\n"), "{other}");
}

#[test]
fn an_answer_to_another_program_is_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("v.sol"), "found\n\nOptions\n3\n1\n1\n0\n1\n0\n2\n2\n0.5\n0.5\n")
        .expect("written");
    let done = ntg(&["check-solution", "specs/van_der_pol.ntg", "v.sol"], folder.path());
    assert_eq!(done.status.code(), Some(2));
    let said = text(&done.stderr);
    assert!(said.contains("it has 1 rows, but the program has 3; it belongs to another program"), "{said}");
}

/// Equations with corners that are solved with helpers in the place of these (a battery), as they are written (a thrust by which
/// mass is lost, in the least time), one of each, and with helpers held at sides (an input that saturates): a saved solution is
/// one, and none of another battery.
#[test]
fn solutions_of_equations_with_corners_are_confirmed_in_the_form_in_which_they_were_found() {
    const BATTERY: &str = "problem Battery {
        param r = 0.9; duration T = 24; state e in 0 .. 10; input p in -4 .. 4; collocation gauss(points = 3, intervals = 12);
        minimize integral((0.25 + 0.12 * sin(2 * pi * (t - 13) / 24)) * p); dynamics { der(e) == min(r * p, p / r); }
        initial { e == 2; } final { e == 2; }
    }";
    const HURRY: &str = "problem Hurry {
        duration T in 0.5 .. 20; state x, v, m; input F in -1 .. 1; collocation gauss(points = 3, intervals = 20);
        minimize T; dynamics { der(x) == v; der(v) == F / m; der(m) == -0.2 * abs(F); }
        initial { x == 0; v == 0; m == 1; } final { x == 4; v == 0; }
    }";
    const BOTH: &str = "problem Both {
        duration T in 0.5 .. 20; state x, v, m, y, w, E; input F in -1 .. 1, G in -1 .. 1;
        collocation gauss(points = 3, intervals = 20); minimize T + 0.2 * final(E);
        dynamics {
            der(x) == v; der(v) == F / m; der(m) == -0.2 * abs(F);
            der(y) == w; der(w) == G; der(E) == abs(G);
        }
        initial { x == 0; v == 0; m == 1; y == 0; w == 0; E == 0; } final { x == 4; v == 0; y == 1; w == 0; }
    }";
    const SATURATED: &str = "problem Saturated {
        duration T = 6; state x, v, E; input u in -3 .. 3; collocation gauss(points = 3, intervals = 24);
        minimize final(E); dynamics { der(x) == v; der(v) == max(-0.6, min(0.6, u)); der(E) == u^2; }
        initial { x == 0; v == 0; E == 0; } final { x == 4; v == 0; }
    }";
    let folder = tempfile::tempdir().expect("a folder");
    for (name, spec) in [("battery", BATTERY), ("hurry", HURRY), ("both", BOTH), ("saturated", SATURATED)] {
        let [spec_file, saved] = ["ntg", "json"].map(|extension| format!("{name}.{extension}"));
        std::fs::write(folder.path().join(&spec_file), spec).expect("written");
        let solved = ntg(&["solve", &spec_file, "--save", &saved], folder.path());
        assert_eq!(solved.status.code(), Some(0), "{name}: {}", text(&solved.stdout));
        let checked = text(&ntg(&["check-solution", &spec_file, &saved], folder.path()).stdout);
        assert!(checked.ends_with("\na solution\n"), "{name}: {checked}");
    }
    let other = ntg(&["check-solution", "battery.ntg", "battery.json", "--set", "r=0.8"], folder.path());
    assert!(text(&other.stdout).ends_with("\nno solution\n"), "{}", text(&other.stdout));
    let exported = ntg(&["export", "battery.ntg", "-o", "battery.nl"], folder.path());
    assert_eq!(exported.status.code(), Some(0), "{}", text(&exported.stderr));
}
