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
fn a_changed_study_is_refused_and_the_old_one_goes_on() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let car = spec("low_observable.ntg");
    let study = |last: &'static str| {
        vec![car.clone(), "--set".into(), format!("v_max=0.22:{last}:40"), "-o".into(), "s.csv".into()]
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
    assert_eq!(table(folder.path().join("s.csv")).len(), 41);
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
    assert_eq!(read.names[..4], ["row", "v_max", "status", "objective"]);
    assert_eq!(read.rows.len(), 3);

    // Its parameter column is the table of another study.
    let study_of = ntg_sweep::Study { inputs: vec!["v_max".into()], sets: vec![vec![0.22], vec![0.26]], about: vec![] };
    let rows = [ntg_sweep::Row::failed(0, ""), ntg_sweep::Row::failed(1, "")];
    let bytes = ntg_sweep::write(&study_of, &rows, ntg_sweep::Format::Parquet).expect("bytes");
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
        (&["--set", "v_max[1]=1:2:2", "-o", "o.csv"], "`v_max[1]` does not exist"),
        (&["--set", "v_max=1:2:2", "--set", "v_max=1:2:2", "-o", "o.csv"], "`v_max` is varied twice"),
        (&["--from", "bad.csv", "-o", "o.csv"], "row 0, `v_max` = `fast`"),
        (&["--from", "ragged.csv", "-o", "o.csv"], "ragged.csv"),
        (&["--from", "nowhere.csv", "-o", "o.csv"], "cannot read `nowhere.csv`"),
        (&["--set", "v_max=1:2:2", "-o", "o.xlsx"], "tables are .csv or .parquet files"),
        (&["--set", "v_max=1:2:2", "-o", "mine.csv"], "give --force"),
        (&["--set", "v_max=1:2:2", "--value", "final(w)", "-o", "o.csv"], "`w` is none of: `x`, `y`"),
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
