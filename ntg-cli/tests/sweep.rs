//! `ntg sweep` as a user runs it, and as the world interrupts it.

use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

fn spec(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../specs").join(name).to_str().expect("UTF-8").to_owned()
}

fn command(folder: &Path, arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
    command.current_dir(folder).arg("sweep").args(arguments);
    command
}

fn ntg(folder: &Path, arguments: &[&str]) -> Output {
    command(folder, arguments).output().expect("the command starts")
}

/// Cells by row, the header first.
fn table(path: PathBuf) -> Vec<Vec<String>> {
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let cells = |row: csv::StringRecord| row.iter().map(str::to_owned).collect();
    let mut reader = csv::ReaderBuilder::new().has_headers(false).from_reader(text.as_bytes());
    reader.records().map(|row| cells(row.expect("a row"))).collect()
}

fn column(table: &[Vec<String>], name: &str) -> Vec<String> {
    let at =
        table[0].iter().position(|head| head == name).unwrap_or_else(|| panic!("no column {name}: {:?}", table[0]));
    table[1..].iter().map(|row| row[at].clone()).collect()
}

fn lines(path: &Path) -> usize {
    std::fs::read_to_string(path).map_or(0, |text| text.matches('\n').count())
}

/// Lets a study run until its journal has so many lines.
fn wait(child: &mut Child, journal: &Path, least: usize) {
    let began = Instant::now();
    while lines(journal) < least {
        assert!(child.try_wait().expect("our child").is_none(), "the study ended before it could be interrupted");
        assert!(began.elapsed() < Duration::from_secs(300), "no {least} rows in five minutes");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_study_that_is_killed_twice_ends_with_every_row_once_and_the_same_numbers() {
    const ROWS: usize = 48;
    let folder = tempfile::tempdir().expect("a temporary folder");
    let flight = spec("low_observable.ntg");
    let study = [&flight, "--set", "signature_max=7", "--set", "v_max=0.22:0.28:8", "--set", "reach=500:3000:6 [m]"];
    let study = [&study[..], &["--value", "final(x)", "--value", "max(speed)"]].concat();
    let interrupted = [&study[..], &["-o", "killed.csv"]].concat();
    let journal = folder.path().join("killed.csv.journal");
    for least in [6, 20] {
        let mut child = command(folder.path(), &interrupted).stderr(Stdio::null()).spawn().expect("the command starts");
        wait(&mut child, &journal, least);
        child.kill().expect("SIGKILL");
        child.wait().expect("it is dead");
        assert!(!folder.path().join("killed.csv").exists());
    }
    // The end of a line that the disk never saw.
    let mut text = std::fs::read_to_string(&journal).expect("the journal");
    text.push_str("{\"row\":4,\"sta");
    std::fs::write(&journal, text).expect("the journal");

    let last = ntg(folder.path(), &interrupted);
    assert_eq!(last.status.code(), Some(0), "{}", String::from_utf8_lossy(&last.stderr));
    assert!(!journal.exists());
    let whole = ntg(folder.path(), &[&study[..], &["-o", "whole.csv", "--jobs", "1"]].concat());
    assert_eq!(whole.status.code(), Some(0), "{}", String::from_utf8_lossy(&whole.stderr));

    let (killed, whole) = (table(folder.path().join("killed.csv")), table(folder.path().join("whole.csv")));
    assert_eq!(column(&killed, "row"), (0..ROWS).map(|row| row.to_string()).collect::<Vec<_>>());
    for name in ["v_max", "reach", "status", "objective", "iterations", "T", "final(x)", "max(speed)"] {
        assert_eq!(column(&killed, name), column(&whole, name), "{name}");
    }
    assert!(column(&killed, "status").iter().all(|status| status == "solved"));
    assert_eq!(column(&killed, "reach")[..2], ["0.5", "1"]);
    let fastest = column(&killed, "max(speed)");
    for (fastest, limit) in fastest.iter().zip(column(&killed, "v_max")) {
        assert!(fastest.parse::<f64>().expect("a number") < 1.05 * limit.parse::<f64>().expect("a number"));
    }
}

#[test]
fn shards_one_core_and_two_give_the_same_rows_and_merge_says_what_is_missing() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let flight = spec("low_observable.ntg");
    let study = [&flight, "--set", "signature_max=7", "--set", "v_max=0.24:0.26:3", "--set", "reach=500:3000:5 [m]"];
    let study = [&study[..], &["--value", "max(speed)", "--block", "4"]].concat();
    for (jobs, output) in [("1", "one.csv"), ("2", "two.csv")] {
        let ran = ntg(folder.path(), &[&study[..], &["--jobs", jobs, "-o", output]].concat());
        assert_eq!(ran.status.code(), Some(0), "{}", String::from_utf8_lossy(&ran.stderr));
    }
    let merge = |more: &[&str]| {
        let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
        let output = command.current_dir(folder.path()).arg("merge").args(more).output().expect("the command starts");
        (output.status.code(), String::from_utf8_lossy(&output.stderr).into_owned())
    };
    assert!(merge(&["s.csv"]).1.contains("there is no journal `s.csv.1-of-N.journal`"));
    for part in ["3/3", "1/3", "2/3"] {
        if part == "2/3" {
            let (code, said) = merge(&["s.csv"]);
            assert!(code == Some(2) && said.contains("1 of 3 shards have no journal: 2/3"), "{said}");
        }
        let ran = ntg(folder.path(), &[&study[..], &["-o", "s.csv", "--shard", part]].concat());
        assert_eq!(ran.status.code(), Some(0), "{}", String::from_utf8_lossy(&ran.stderr));
        assert!(!folder.path().join("s.csv").exists());
    }
    let (code, said) = merge(&["s.csv"]);
    assert_eq!(code, Some(0), "{said}");
    assert!(!folder.path().join("s.csv.1-of-3.journal").exists());
    let [one, two, merged] = ["one.csv", "two.csv", "s.csv"].map(|name| table(folder.path().join(name)));
    let clock = one[0].iter().position(|name| name == "seconds").expect("a clock");
    assert_eq!(one.len(), 16);
    for (a, (b, c)) in one.iter().zip(two.iter().zip(&merged)) {
        for (i, cell) in a.iter().enumerate().filter(|(i, _)| *i != clock) {
            assert_eq!((cell, cell), (&b[i], &c[i]));
        }
    }
    assert!(column(&one, "binding").iter().all(|names| names == "arrival"), "{:?}", column(&one, "binding"));
    // Neighbours lead to the minima that each row's own guess leads to.
    let alone = ntg(folder.path(), &[&study[..], &["--block", "1", "-o", "alone.csv"]].concat());
    assert_eq!(alone.status.code(), Some(2), "an option given twice is refused");
    let study = [&study[..study.len() - 2], &["--block", "1", "-o", "alone.csv"]].concat();
    assert_eq!(ntg(folder.path(), &study).status.code(), Some(0));
    let alone = table(folder.path().join("alone.csv"));
    for (a, b) in column(&one, "objective").iter().zip(column(&alone, "objective")) {
        let number = |text: &str| text.parse::<f64>().expect("a number");
        assert!((number(a) / number(&b) - 1.0).abs() < 1e-6, "{a} {b}");
    }
    let iterations = |table: &[Vec<String>]| -> f64 {
        column(table, "iterations").iter().map(|text| text.parse::<f64>().expect("a number")).sum()
    };
    assert!(iterations(&one) < 0.8 * iterations(&alone));
}

#[test]
fn dispersed_parameters_are_sampled_alike_every_time_and_summarised() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let car = spec("kinematic_car.ntg");
    let study = |design: &str, output: &str| {
        let words = [&car, "--disperse", "wheel_base ~ normal(300, 10) [cm]", "--samples", "16", "--design", design];
        let ran =
            ntg(folder.path(), &[&words[..], &["--seed", "7", "--value", "max(steering)", "-o", output]].concat());
        assert_eq!(ran.status.code(), Some(0), "{}", String::from_utf8_lossy(&ran.stderr));
        column(&table(folder.path().join(output)), "wheel_base")
    };
    for design in ["monte-carlo", "latin-hypercube", "sobol"] {
        let (one, two) = (study(design, &format!("{design}-1.csv")), study(design, &format!("{design}-2.csv")));
        assert_eq!(one, two);
        let bases: Vec<f64> = one.iter().map(|text| text.parse().expect("a number")).collect();
        let mean = bases.iter().sum::<f64>() / 16.0;
        assert!((mean - 3.0).abs() < 0.1 && bases.iter().all(|base| (2.5..3.5).contains(base)), "{bases:?}");
    }
    let mut command = Command::new(env!("CARGO_BIN_EXE_ntg"));
    let output = command.current_dir(folder.path()).args(["summary", "sobol-1.csv"]).output().expect("it starts");
    let said = String::from_utf8_lossy(&output.stdout);
    assert!(said.starts_with("16 rows, 16 solved (100.0 %)") && said.contains("max(steering)"), "{said}");
}

#[test]
fn a_changed_study_is_refused_and_the_old_one_goes_on() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let car = spec("low_observable.ntg");
    // Long enough that the first process is at work when the second one begins.
    let study = |last: &'static str| {
        vec![car.clone(), "--set".into(), format!("v_max=0.22:{last}:200"), "-o".into(), "s.csv".into()]
    };
    let run = |arguments: &[String]| {
        command(folder.path(), &arguments.iter().map(String::as_str).collect::<Vec<_>>()).output().expect("it starts")
    };
    let first: Vec<String> = study("0.28");
    let mut child = command(folder.path(), &first.iter().map(String::as_str).collect::<Vec<_>>())
        .stderr(Stdio::null())
        .spawn()
        .expect("the command starts");
    let journal = folder.path().join("s.csv.journal");
    wait(&mut child, &journal, 3);
    // A second process of the same study would repeat rows.
    let second = run(&first);
    assert_eq!(second.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&second.stderr).contains("is running already"));
    child.kill().expect("SIGKILL");
    child.wait().expect("it is dead");

    let before = std::fs::read(&journal).expect("the journal");
    let changed = run(&study("0.29"));
    assert_eq!(changed.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&changed.stderr).contains("belongs to another study"));
    assert_eq!(std::fs::read(&journal).expect("the journal"), before);
    let last = run(&first);
    assert_eq!(last.status.code(), Some(0), "{}", String::from_utf8_lossy(&last.stderr));
    assert_eq!(table(folder.path().join("s.csv")).len(), 201);
}

#[test]
fn a_row_that_cannot_be_solved_says_why_and_the_others_are_solved() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    // Row 1 has a lower limit above the upper one; row 2 is in another unit.
    std::fs::write(folder.path().join("sets.csv"), "v_min, v_max\n# slow\n0.1, 0.25\n0.3, 0.25\n0.1, 240 [m/s]\n")
        .expect("a table");
    let flight = spec("low_observable.ntg");
    let output = ntg(folder.path(), &[&flight, "--from", "sets.csv", "--set", "signature_max=7", "-o", "o.csv"]);
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("3 rows, 2 solved") && said.contains("the first that is not: row 1"), "{said}");
    let found = table(folder.path().join("o.csv"));
    let status = column(&found, "status");
    assert!(status[1].contains("speed_limits") && status[0] == "solved" && status[2] == "solved", "{status:?}");
    assert_eq!(column(&found, "v_max"), ["0.25", "0.25", "0.24"]);
    let objective = column(&found, "objective");
    assert!((objective[0].parse::<f64>().expect("a number") / 128.252_905_291 - 1.0).abs() < 1e-6);
    assert_eq!(objective[1], "");
}

#[cfg(feature = "parquet")]
#[test]
fn parquet_is_written_and_read_back_and_a_column_that_is_no_parameter_is_refused() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let flight = spec("low_observable.ntg");
    let study = [flight.as_str(), "--set", "signature_max=7"];
    let first = [&study[..], &["--set", "v_max=0.22:0.26:3", "-o", "first.parquet"]].concat();
    assert_eq!(ntg(folder.path(), &first).status.code(), Some(0));
    let read = ntg_sweep::read(&folder.path().join("first.parquet")).expect("a table");
    assert_eq!(read.names[..5], ["row", "v_max", "status", "binding", "objective"]);
    assert_eq!(read.rows.len(), 3);

    // Its parameter column is the table of another study.
    let rows = vec![ntg_sweep::Row::failed(0, &[0.22], ""), ntg_sweep::Row::failed(1, &[0.26], "")];
    let results = ntg_sweep::Results { inputs: vec!["v_max".into()], names: vec![], rows };
    let bytes = ntg_sweep::write(&results, ntg_sweep::Format::Parquet).expect("bytes");
    std::fs::write(folder.path().join("sets.parquet"), bytes).expect("a table");
    let refused = ntg(folder.path(), &[&study[..], &["--from", "sets.parquet", "-o", "second.csv"]].concat());
    assert!(String::from_utf8_lossy(&refused.stderr).contains("there is no parameter `row`"));
}

#[test]
fn what_is_no_study_is_refused_with_words() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let flight = spec("low_observable.ntg");
    std::fs::write(folder.path().join("bad.csv"), "v_max\nfast\n").expect("a table");
    std::fs::write(folder.path().join("ragged.csv"), "v_max,v_min\n1\n").expect("a table");
    std::fs::write(folder.path().join("mine.csv"), "mine").expect("a table");
    for (arguments, words) in [
        (&["-o", "o.csv"][..], "nothing is varied; give a range"),
        (&["--set", "v=1:2:3", "-o", "o.csv"], "there is no parameter `v`; the parameters are: `x_start`"),
        (&["--set", "v_max=1:2", "-o", "o.csv"], "a range is NAME=FIRST:LAST:COUNT"),
        (&["--set", "v_max=1:2:many", "-o", "o.csv"], "`many` is no number of values"),
        (&["--set", "v_max=1:2:3 [kg]", "-o", "o.csv"], "1 [km/s]"),
        (&["--set", "v_max=1:2:0", "-o", "o.csv"], "there is no parameter set"),
        (&["--set", "v_max[1]=1:2:2", "-o", "o.csv"], "there is no `v_max[1]`: `v_max` is one number, not an array"),
        (&["--set", "v_max=1:2:2", "--set", "v_max=1:2:2", "-o", "o.csv"], "`v_max` is varied twice"),
        (&["--from", "bad.csv", "-o", "o.csv"], "row 0, `v_max` = `fast`"),
        (&["--from", "ragged.csv", "-o", "o.csv"], "ragged.csv"),
        (&["--from", "nowhere.csv", "-o", "o.csv"], "cannot read `nowhere.csv`"),
        (&["--set", "v_max=1:2:2", "-o", "o.xlsx"], "tables are .csv or .parquet files"),
        (&["--set", "v_max=1:2:2", "-o", "mine.csv"], "give --force"),
        (&["--set", "v_max=1:2:2", "--value", "final(w)", "-o", "o.csv"], "`w` is none of: `x`, `y`"),
        (&["--disperse", "v_max = 3", "--samples", "4", "-o", "o.csv"], "a dispersed parameter is"),
        (&["--disperse", "v_max ~ gauss(1)", "--samples", "4", "-o", "o.csv"], "a distribution is normal(MEAN"),
        (&["--disperse", "v_max ~ normal(1, 2) [kg]", "--samples", "4", "-o", "o.csv"], "1 [km/s]"),
        (&["--disperse", "v_max ~ normal(1, 2)", "-o", "o.csv"], "--samples"),
        (&["--set", "v_max=1:2:2", "--shard", "4/3", "-o", "o.csv"], "there is no shard 4 of 3"),
        (&["--set", "v_max=1:2:2", "--value", "mean(x)", "-o", "o.csv"], "write initial(NAME), final(NAME)"),
    ] {
        let output = ntg(folder.path(), &[&[flight.as_str()], arguments].concat());
        let said = String::from_utf8_lossy(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {said}");
        assert!(said.contains(words), "{arguments:?} says: {said}");
    }
    assert_eq!(std::fs::read_to_string(folder.path().join("mine.csv")).expect("a table"), "mine");
    assert!(!folder.path().join("o.csv").exists() && !folder.path().join("o.csv.journal").exists());
}

/// Solved at the points alone.
const EPIDEMIC: &str = include_str!("specs/epidemic.ntg");

#[test]
fn a_row_that_no_shorter_intervals_confirm_is_none_of_the_solved() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("epidemic.ntg"), EPIDEMIC).expect("written");
    let done = ntg(folder.path(), &["epidemic.ntg", "--set", "w=150:200:2", "-o", "rows.csv"]);
    let rows = table(folder.path().join("rows.csv"));
    for (status, objective) in column(&rows, "status").iter().zip(column(&rows, "objective")) {
        let is_below = objective.parse::<f64>().expect("a number") < 0.0;
        assert_eq!(is_below, status == "solved at the points, and not between them", "{status} {objective}");
    }
    assert!(column(&rows, "objective").iter().any(|objective| objective.starts_with('-')), "{rows:?}");
    assert_ne!(done.status.code(), Some(0));
}

#[test]
fn what_is_wanted_of_arrays_and_agents_is_a_column_for_each_member() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let arm = "problem Arm {
        param far = 2;
        duration T = 1;
        output r[3]: spline(order = 5, intervals = 2);
        variable slack[2];
        let twice[3] = 2 * r;
        let sides[2] = (1, far);
        initial { r == 0; }
        final { goal: r == (far, 0, 1); }
        temporal { slack == (3, 4); }
        minimize integral(norm(der(r, 2))^2);
    }";
    let fleet = "problem Fleet {
        param far = 2;
        agent uav[k in 1 .. 2] {
            phase out { duration = 1; output r[2]: spline(order = 5, intervals = 2); final { r == (far * k, 1); } }
            phase back after out { duration = 1; output r[2]: spline(order = 5, intervals = 2); final { r == 0; } }
            initial { r == 0; }
            let speed = norm(der(r));
            minimize integral(norm(der(r, 2))^2);
        }
    }";
    for (name, text) in [("arm.ntg", arm), ("fleet.ntg", fleet)] {
        std::fs::write(folder.path().join(name), text).expect("a file can be written");
    }
    let study = |spec: &str, values: &[&str]| {
        let mut words = vec![spec, "--set", "far=1:2:2", "-o", "o.csv", "--force"];
        words.extend(values.iter().flat_map(|value| ["--value", value]));
        let ran = ntg(folder.path(), &words);
        (ran.status.code(), String::from_utf8_lossy(&ran.stderr).into_owned())
    };
    let (code, said) = study("arm.ntg", &["final(r)", "final(r)", "max(twice)", "sides", "slack", "final(r[3])"]);
    assert_eq!(code, Some(0), "{said}");
    let arm = table(folder.path().join("o.csv"));
    for (name, values) in [
        ("final(r[1])", [1.0, 2.0]),
        ("final(r[2])", [0.0, 0.0]),
        ("final(r[3])", [1.0, 1.0]),
        ("max(twice[1])", [2.0, 4.0]),
        ("max(twice[3])", [2.0, 2.0]),
        ("sides[1]", [1.0, 1.0]),
        ("sides[2]", [1.0, 2.0]),
        ("slack[2]", [4.0, 4.0]),
    ] {
        assert_eq!(arm[0].iter().filter(|head| *head == name).count(), 1, "{name}: {:?}", arm[0]);
        for (cell, value) in column(&arm, name).iter().zip(values) {
            let cell: f64 = cell.parse().unwrap_or_else(|_| panic!("{name} is `{cell}`"));
            assert!((cell - value).abs() < 1e-6, "{name}: {cell} for {value}");
        }
    }
    let (code, said) = study("fleet.ntg", &["max(speed)", "final(uav[2].out.r)", "final(uav.r[1])"]);
    assert_eq!(code, Some(0), "{said}");
    let fleet = table(folder.path().join("o.csv"));
    for name in ["max(uav[1].speed)", "max(uav[2].speed)", "final(uav[1].r[1])"] {
        assert!(column(&fleet, name).iter().all(|cell| !cell.is_empty()), "{name}");
    }
    let reached: Vec<f64> =
        column(&fleet, "final(uav[2].out.r[1])").iter().map(|cell| cell.parse().expect("a number")).collect();
    assert!((reached[0] - 2.0).abs() < 1e-6 && (reached[1] - 4.0).abs() < 1e-6, "{reached:?}");
    for (wanted, words) in
        [("final(r[4])", "solutions have no `r[4]`; they have `r[1]`, `r[2]`"), ("slack[3]", "`slack[3]`")]
    {
        let (code, said) = study("arm.ntg", &[wanted]);
        assert!(code == Some(2) && said.contains(words), "{code:?}: {said}");
    }
}

#[test]
fn values_in_another_unit_and_between_the_ends_of_a_range_are_written_as_one_would_type_them() {
    const SPEC: &str = "\
problem Cart {
    param v = 18 [km/h];
    duration T = 1 [s];
    output z [m]: spline(order = 4, intervals = 1);
    minimize integral(der(z, 2)^2);
    initial { z == 0 [m]; }
    final { z == v * 1 [s]; }
}
";
    let folder = tempfile::tempdir().expect("a temporary folder");
    std::fs::write(folder.path().join("cart.ntg"), SPEC).expect("a file can be written");
    let written = |range: &str| {
        let output = ntg(folder.path(), &["cart.ntg", "--set", range, "-o", "study.csv", "--force"]);
        assert_eq!(output.status.code(), Some(0), "{}", String::from_utf8_lossy(&output.stderr));
        column(&table(folder.path().join("study.csv")), "v")
    };
    assert_eq!(written("v=1:3:2 [m/s]"), ["3.6", "10.8"]);
    assert_eq!(written("v=0.1:0.7:7"), ["0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7"]);
}

#[test]
fn a_table_that_cannot_be_read_is_told_with_its_line() {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("move.ntg"), MOVE).expect("a spec");
    let ragged = "line 4: this row has 1 cell, the first line names 2 columns; write as many cells in every row";
    let coded = "line 2: this is not UTF-8 text: byte 0xff; save the file in the encoding UTF-8";
    for (bytes, words) in [(&b"from,to\n# first\n1,2\n3\n"[..], ragged), (&b"from,to\n1,\xff2\n"[..], coded)] {
        std::fs::write(folder.path().join("sets.csv"), bytes).expect("a table");
        for command in [&["sweep", "move.ntg", "--from", "sets.csv", "-o", "o.csv"][..], &["summary", "sets.csv"]] {
            let mut ntg = Command::new(env!("CARGO_BIN_EXE_ntg"));
            let output = ntg.current_dir(folder.path()).args(command).output().expect("the command starts");
            let said = String::from_utf8_lossy(&output.stderr).into_owned();
            assert!(
                output.status.code() == Some(2) && said.contains(&format!("`sets.csv`, {words}")),
                "{command:?}: {said}"
            );
        }
    }
}

const MOVE: &str = "problem Move {
    duration T = 1;
    param from = 0;
    param to = 1;
    output x: spline(order = 4, intervals = 2);
    minimize integral(der(x, 2)^2);
    initial { x == from; }
    final { x == to; }
}";
