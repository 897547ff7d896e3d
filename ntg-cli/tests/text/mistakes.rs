//! Mistakes planted in the spec that `ntg new` writes, and on the command line: what is said of each has the right
//! place and says what to do.

use std::fs;
use std::path::Path;

use super::{folder, ntg_in, said};

/// A mistake in the spec.
struct Planted {
    /// What is replaced, at its last place in the spec.
    right: &'static str,
    /// By what.
    wrong: &'static str,
    code: &'static str,
    /// How the text begins to which the message points.
    at: &'static str,
    /// What to do.
    help: &'static str,
}

const fn planted(
    (right, wrong): (&'static str, &'static str),
    code: &'static str,
    at: &'static str,
    help: &'static str,
) -> Planted {
    Planted { right, wrong, code, at, help }
}

const SPLINE: &str = "order = 6, intervals = 8, smoothness = 4";

/// Found by `ntg check`.
#[rustfmt::skip]
const IN_THE_SPEC: &[Planted] = &[
    planted(("der(y, 2)^2 <=", "der(yy, 2)^2 <="), "E020", "yy, 2", "did you mean `y`?"),
    planted(("v_max^2;", "vmax^2;"), "E020", "vmax^2", "did you mean `v_max`?"),
    planted(("hypot(der(x)", "hypott(der(x)"), "E024", "hypott(", "did you mean `hypot`?"),
    planted(("trajectory {", "trajectry {"), "E001", "trajectry", "did you mean `trajectory`?"),
    planted(("distance >= radius", "speed >= radius"), "E041", "speed >= radius", "same dimension"),
    planted(("4 [m/s];", "4 [mps];"), "E040", "mps]", "did you mean `m/s`?"),
    planted(("4 [m/s];", "4m/s;"), "E006", "4m/s", "a unit stands in brackets, `4 [m]`"),
    planted(("x == 0 [m];", "x == 1;"), "E041", "x == 1;", "give the number a unit: `1 [m]`"),
    planted(("1.5 [m/s^2];", "1,5 [m/s^2];"), "E001", ",5", "the decimal point is `.`"),
    planted(("y_target = 0 [m];", "y_target = 0 [m]"), "E002", "\n", "every statement ends with `;`"),
    planted(("der(y));", "der(y);"), "E003", "(der(x), der(y);", "write `)` where it ends"),
    planted(("x == x_target", "x = x_target"), "E013", "= x_target", "write `==`"),
    planted(("<= v_max^2", "< v_max^2"), "E013", "< v_max^2", "write `<=`"),
    planted(("v_max^2;", "v_max**2;"), "E001", "**2", "write `^` for a power"),
    planted(("distance >= radius", "distance ≥ radius"), "E008", "≥", "write `>=`"),
    planted((SPLINE, "order = 6, knots = (0, 0.6, 0.4, 1)"), "E055", "0.4, 1)", "increase from 0 to 1"),
    planted((SPLINE, "order = 6, knots = (0, 0.5, 2)"), "E055", "(0, 0.5, 2)", "from 0 to 1"),
    planted((SPLINE, "order = 2, intervals = 8"), "E054", "der(x, 2)^2 + der(y, 2)^2);", "`order = 3` or more"),
    planted((SPLINE, "order = 6, intervals = 8, smothness = 4"), "E016", "smothness", "did you mean `smoothness`?"),
    planted(("* integral(", "* ("), "E050", "x, 2)", "write `integral(x)`, `initial(x)` or `final(x)`"),
    planted(("0.2 [s^4/m^2]", "0.2 [s^3/m^2]"), "E044", "[s]: 0.2", "remove the unit, or multiply by one"),
    planted(("1 .. 60 [s]", "60 .. 1 [s]"), "E056", "60 .. 1", "exchange the two bounds"),
    planted(("clearance: distance", "clearance: y / (0 * x)"), "E032", "y / (0", "divide by something else"),
    planted(("clearance: distance", "clearance: sin(distance)"), "E042", "distance) >=", "`sin(distance / 1 [m])`"),
    planted(("through (0, 0)", "through (0)"), "E017", "(0)", "one coordinate for each output"),
    planted(("T = 20 [s];\n    }\n}", "T = 20;\n    }\n}"), "E041", "T = 20;", "give the number a unit: `20 [s]`"),
    planted(("T = 20 [s];\n    }\n}", "Tf = 20 [s];\n    }\n}"), "E020", "Tf", "did you mean `T`?"),
    planted(("radius = 6 [m];", "radius = 6 [m]; table d(v) = linear from \"d.csv\";"), "E072", "\"d.csv\"", "relative to the spec"),
    planted(("radius = 6 [m];", "radius = 6 [m]; table d(v) = linear from \"bad.csv\";"), "E072", "\"bad.csv\"", "write numbers with commas between them"),
];

/// Found by `ntg solve` before any iteration, because parameters decide.
#[rustfmt::skip]
const BY_PARAMETERS: &[Planted] = &[
    planted(("clearance: distance >= radius", "clearance: radius <= distance <= 2 [m]"), "E056", "clearance:", "change the parameters"),
    planted(("x == x_target;", "x == x_target; x == 30 [m];"), "E057", "x == 30 [m]", "loosen the bound, or change what is fixed"),
    planted(("y == y_target", "x == y_target"), "E057", "x == y_target", "loosen the bound, or change what is fixed"),
    planted(("1 .. 60 [s];", "1 [s] .. x_target / v_max - 11 [s];"), "E056", "", "change the parameters"),
];

/// On the command line; every file but `mission.ntg`, `run.json` and the three bad ones is missing.
const ON_THE_COMMAND_LINE: &[(&[&str], &str)] = &[
    (&["slove", "mission.ntg"], "'solve'"),
    (&["solve", "mission.ntg", "--sett", "v_max=3"], "'--set'"),
    (
        &["solve", "mission.ntg", "--method", "ipopt"],
        "[possible values: auto, sqp, interior-point, augmented-lagrangian]",
    ),
    (&["solve", "mission.ntg", "--restoration", "cubed"], "[possible values: absolute, squared]"),
    (&["solve", "mission.ntg", "--inertia-correction", "none"], "[possible values: by-element, by-shift]"),
    (&["check", "misson.ntg"], "did you mean `mission.ntg`?"),
    (&["solve", "specs/mission.ntg"], "there is no folder `specs`"),
    (&["solve", "."], "`.` is a folder; name a file in it, such as `mission.ntg`"),
    (&["check", "empty"], "there is no .ntg file below `empty`; `ntg new NAME` writes one"),
    (&["solve", "mission.ntg", "--set", "vmax=3"], "the parameters are: `x_target`"),
    (&["solve", "mission.ntg", "--set", "T=3"], "change them in the spec"),
    (&["solve", "mission.ntg", "--set", "v_max=fast"], "write a number"),
    (&["solve", "mission.ntg", "--set", "v_max=3 [m]"], "a unit such as `1 [m/s]`"),
    (&["solve", "mission.ntg", "--set", "v_max="], "write NAME=VALUE"),
    (&["solve", "mission.ntg", "--route", "route.csv"], "write OUTPUTS: POINT; POINT"),
    (&["solve", "mission.ntg", "--route", "x, z: 0, 0; 1, 1"], "the outputs are: `x`, `y`"),
    (&["solve", "mission.ntg", "--guess", "old.json"], "there is no such file"),
    (&["solve", "mission.ntg", "--guess", "runs.json"], "did you mean `run.json`?"),
    (&["solve", "mission.ntg", "--guess", "mission.ntg"], "give a file that `ntg solve --save` has written"),
    (&["solve", "mission.ntg", "--guess", "bad.json"], "give a file that `ntg solve --save` has written"),
    (&["check-solution", "mission.ntg", "bad.json"], "`ntg solve --save` has written, or the `.sol` of a solver"),
    (&["solve", "mission.ntg", "--save", "run.json"], "give --force to replace it, or another name"),
    (&["solve", "mission.ntg", "--save", "nowhere/run.json"], "`nowhere` is no folder; make it first"),
    (&["solve", "mission.ntg", "--time-limit", "-1"], "a positive number of seconds"),
    (&["solve", "mission.ntg", "--time-limit", "1e300"], "--time-limit 1e300: at most 1.8e19 seconds"),
    (
        &["sweep", "mission.ntg", "--set", "v_max=1:2:2", "-o", "o.csv", "--time-limit", "1e300"],
        "at most 1.8e19 seconds",
    ),
    (&["solve", "mission.ntg", "--refine", "-1"], "the tolerance -1 is not between 1e-12 and 0.1"),
    (&["solve", "mission.ntg", "--max-iterations", "-1"], "for '--max-iterations <N>': a whole number from 1 on"),
    (&["solve", "mission.ntg", "--starts", "-1"], "for '--starts <N>': a whole number from 1 to 1000000"),
    (&["solve", "mission.ntg", "--starts", "2", "--seed", "x"], "for '--seed <N>': a whole number from 0 on"),
    (&["solve", "mission.ntg", "--time-limit", "1m"], "for '--time-limit <SECONDS>': a number, such as"),
    (
        &["sweep", "mission.ntg", "--from", "none.csv", "-o", "o.csv"],
        "`none.csv` is empty; its first line names parameters",
    ),
    (&["solve", "mission.ntg", "--tolerance", "-1"], "between 1e-12 and 0.1"),
    (&["plot", "mission.ntg", "--show", "sped", "-o", "a.svg"], "there are: `x`, `y`, `speed`"),
    (&["plot", "mission.ntg", "-o", "a.pdf"], "plots are .svg or .png files"),
    (&["report", "run.json", "-o", "a.pdf"], "reports are .html files"),
    (&["solve", "mission.ntg", "--guess", "."], "`.` is a folder; name a file in it, such as `run.json`"),
    (&["sweep", "mission.ntg", "--from", "unit.csv", "-o", "o.csv"], "without the unit of `v_max [m/s]`"),
    (&["report", "bad.json", "-o", "a.html"], "give a file that `ntg solve --save` has written"),
    (&["sweep", "mission.ntg", "--from", "bad.csv", "-o", "o.csv"], "row 0, `v_max` = `fast`: write a number"),
    (&["sweep", "mission.ntg", "--from", "bat.csv", "-o", "o.csv"], "did you mean `bad.csv`?"),
    (&["sweep", "mission.ntg", "--set", "v_max=1..2", "-o", "o.csv"], "a range is NAME=FIRST:LAST:COUNT"),
    (&["explain", "E999"], "`ntg explain` lists all of them"),
    (&["new", "mission"], "give --force to replace it, or another name"),
    (&["new", "3d"], "begins with a letter"),
];

/// The spec of `ntg new`, as `mission.ntg`.
fn written(folder: &Path) -> String {
    said(&ntg_in(folder, &["new", "mission"], b""), 0);
    fs::write(folder.join("none.csv"), "").expect("writable");
    fs::write(folder.join("unit.csv"), "v_max [m/s]\n1\n").expect("writable");
    fs::write(folder.join("bad.csv"), "v_max\nfast\n").expect("writable");
    fs::read_to_string(folder.join("mission.ntg")).expect("readable")
}

/// What is said of a planted mistake, which is to have code, place and help.
#[track_caller]
fn check(folder: &Path, spec: &str, verb: &str, planted: &Planted) {
    let at = spec.rfind(planted.right).unwrap_or_else(|| panic!("`{}` stands in the spec", planted.right));
    let wrong = format!("{}{}{}", &spec[..at], planted.wrong, &spec[at + planted.right.len()..]);
    fs::write(folder.join("mission.ntg"), &wrong).expect("writable");
    let (_, err) = said(&ntg_in(folder, &[verb, "mission.ntg"], b""), 2);
    assert!(err.starts_with(&format!("error[{}]: ", planted.code)), "`{}`: {err}", planted.wrong);
    assert!(err.contains("= help: ") && err.contains(planted.help), "`{}`: {err}", planted.wrong);
    let place = err.split("--> mission.ntg:").nth(1).and_then(|rest| rest.lines().next()).expect("a place");
    let (line, column) = place.split_once(':').expect("line and column");
    let (line, column): (usize, usize) = (line.parse().expect("a number"), column.parse().expect("a number"));
    let line = wrong.split_inclusive('\n').nth(line - 1).expect("a line of the spec");
    let pointed: String = line.chars().skip(column - 1).collect();
    assert!(pointed.starts_with(planted.at), "`{}` is to be at `{}`: {err}", planted.wrong, planted.at);
}

#[test]
fn mistakes_in_a_spec_have_code_place_and_help() {
    let folder = folder();
    let spec = written(folder.path());
    for planted in IN_THE_SPEC {
        check(folder.path(), &spec, "check", planted);
    }
}

#[test]
fn mistakes_that_parameters_decide_have_code_place_and_help() {
    let folder = folder();
    let spec = written(folder.path());
    for planted in BY_PARAMETERS {
        check(folder.path(), &spec, "solve", planted);
    }
}

#[test]
fn mistakes_on_the_command_line_say_what_to_write() {
    let folder = folder();
    let here = folder.path();
    written(here);
    fs::create_dir(here.join("empty")).expect("writable");
    fs::write(here.join("bad.json"), "{\"a\":").expect("writable");
    said(&ntg_in(here, &["solve", "mission.ntg", "--save", "run.json"], b""), 0);
    for (arguments, words) in ON_THE_COMMAND_LINE {
        let (_, err) = said(&ntg_in(here, arguments, b""), 2);
        assert!(err.contains(words), "{arguments:?} says: {err}");
    }
}
