//! The append-only record of finished rows, one JSON document a line.
//!
//! The first line says which study it is and which shard of it; a later one, before the first row that has any, what
//! the rows' numbers are. A process that is killed leaves at worst a last line without its end, which is dropped; a
//! row counts once its line is whole. Rows that a process has written survive it; a power failure may cost those of
//! the last second, which are then solved again.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use serde::{Deserialize, Serialize};

use crate::shard::Shard;
use crate::study::{Results, Row};

/// What the first line says it is.
const FORMAT: &str = "ntg-sweep-journal";
const VERSION: u64 = 2;
/// How often at most the disk is asked to keep what it was given.
const SYNC: Duration = Duration::from_secs(1);

#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Header {
    format: String,
    version: u64,
    pub(crate) fingerprint: String,
    pub(crate) rows: usize,
    /// Which of how many.
    pub(crate) shard: (usize, usize),
    pub(crate) inputs: Vec<String>,
}

/// Every line but the first.
#[derive(Serialize, Deserialize)]
#[serde(untagged)]
enum Line {
    Row(Row),
    Names { names: Vec<String> },
}

/// Which study a journal is of.
#[derive(Clone, Copy, Debug)]
pub struct Of<'a> {
    /// The study's fingerprint.
    pub fingerprint: &'a str,
    /// How many rows the whole study has.
    pub rows: usize,
    /// The part of it.
    pub shard: Shard,
    /// What is set in every row.
    pub inputs: &'a [String],
}

/// An open journal. No other process can open it at the same time.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
    has_names: bool,
    synced: Instant,
}

/// Where the journal of an output file stands: `study.csv.journal`, `study.csv.3-of-16.journal`.
pub fn beside(output: &Path, shard: Shard) -> PathBuf {
    let mut name = output.file_name().unwrap_or_default().to_owned();
    if shard != Shard::WHOLE {
        name.push(format!(".{}-of-{}", shard.part(), shard.of()));
    }
    name.push(".journal");
    output.with_file_name(name)
}

/// The journals of all shards of an output file that are there, in order of their names.
///
/// # Errors
/// In words: a folder that cannot be read.
pub fn all_beside(output: &Path) -> Result<Vec<PathBuf>, String> {
    let folder = output.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let failed = |error: std::io::Error| format!("cannot read `{}`: {error}", folder.display());
    let name = output.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let mut found = vec![];
    for entry in std::fs::read_dir(folder).map_err(failed)? {
        let path = entry.map_err(failed)?.path();
        let own = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
        let shard = own.strip_prefix(&format!("{name}.")).and_then(|rest| rest.strip_suffix(".journal"));
        let shard = shard.and_then(|rest| rest.split_once("-of-"));
        if shard.is_some_and(|(part, of)| part.parse::<usize>().is_ok() && of.parse::<usize>().is_ok()) {
            found.push(path);
        }
    }
    found.sort();
    Ok(found)
}

/// Reads a journal, whoever writes it.
///
/// # Errors
/// In words: a file that cannot be read, or is no journal.
pub(crate) fn read(path: &Path) -> Result<(Header, Results), String> {
    let bytes = std::fs::read(path).map_err(|error| format!("cannot read `{}`: {error}", path.display()))?;
    let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
    let text = std::str::from_utf8(&bytes[..whole]).map_err(|_| damaged(path, 0))?;
    let mut lines = text.lines();
    let header = header(path, lines.next().unwrap_or_default())?;
    let results = rows(path, lines, &header)?;
    Ok((header, results))
}

impl Journal {
    /// Opens the journal of a study, or begins it; gives what is finished already.
    ///
    /// # Errors
    /// In words: a journal of another study or that is in use, a damaged one, the system's own.
    pub fn open(path: &Path, of: Of<'_>) -> Result<(Self, Results), String> {
        let failed = |error: std::io::Error| format!("cannot use the journal `{}`: {error}", path.display());
        let mut file =
            OpenOptions::new().read(true).write(true).create(true).truncate(false).open(path).map_err(failed)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => {
                return Err(format!("`{}` is in use: the same study is running already", path.display()));
            }
            Err(TryLockError::Error(error)) => return Err(failed(error)),
        }
        let mut bytes = vec![];
        file.read_to_end(&mut bytes).map_err(failed)?;
        let whole = bytes.iter().rposition(|byte| *byte == b'\n').map_or(0, |last| last + 1);
        let wanted = Header {
            format: FORMAT.to_owned(),
            version: VERSION,
            fingerprint: of.fingerprint.to_owned(),
            rows: of.rows,
            shard: (of.shard.part(), of.shard.of()),
            inputs: of.inputs.to_vec(),
        };
        let mut journal = Self { file, path: path.to_owned(), has_names: false, synced: Instant::now() };
        if whole == 0 {
            journal.cut(0).map_err(failed)?;
            journal.write(&line(&wanted)?)?;
            return Ok((journal, Results { inputs: wanted.inputs, ..Results::default() }));
        }
        let text = std::str::from_utf8(&bytes[..whole]).map_err(|_| damaged(path, 0))?;
        let mut lines = text.lines();
        if header(path, lines.next().unwrap_or_default())? != wanted {
            return Err(changed(path));
        }
        let done = rows(path, lines, &wanted)?;
        journal.cut(whole).map_err(failed)?;
        journal.has_names = !done.names.is_empty();
        Ok((journal, done))
    }

    /// Adds rows; when this returns they will survive the process. `names` are what their numbers are.
    ///
    /// # Errors
    /// The system's own, in words.
    pub fn append(&mut self, names: Option<&[String]>, rows: &[Row]) -> Result<(), String> {
        let mut text = String::new();
        if let (false, Some(names)) = (self.has_names, names) {
            text = line(&serde_json::json!({ "names": names }))?;
            self.has_names = true;
        }
        for row in rows {
            text += &line(row)?;
        }
        self.write(&text)
    }

    /// Asks the disk to keep everything.
    ///
    /// # Errors
    /// The system's own, in words.
    pub fn sync(&mut self) -> Result<(), String> {
        self.synced = Instant::now();
        self.file.sync_data().map_err(|error| self.unwritten(&error))
    }

    /// Drops what stands after the last whole line.
    fn cut(&mut self, whole: usize) -> std::io::Result<()> {
        self.file.set_len(whole as u64).and_then(|()| self.file.seek(SeekFrom::End(0))).map(|_| ())
    }

    fn write(&mut self, text: &str) -> Result<(), String> {
        self.file.write_all(text.as_bytes()).map_err(|error| self.unwritten(&error))?;
        if self.synced.elapsed() >= SYNC { self.sync() } else { Ok(()) }
    }

    fn unwritten(&self, error: &std::io::Error) -> String {
        format!("cannot write the journal `{}`: {error}", self.path.display())
    }
}

/// All lines but the first.
fn rows<'a>(path: &Path, lines: impl Iterator<Item = &'a str>, header: &Header) -> Result<Results, String> {
    let mut results = Results { inputs: header.inputs.clone(), ..Results::default() };
    let mut seen = vec![false; header.rows];
    for (number, line) in lines.enumerate() {
        match serde_json::from_str(line).map_err(|_| damaged(path, number + 2))? {
            Line::Names { names } if results.names.is_empty() => results.names = names,
            Line::Row(row) if seen.get(row.row) == Some(&false) && fits(&row, &results) => {
                seen[row.row] = true;
                results.rows.push(row);
            }
            _ => return Err(damaged(path, number + 2)),
        }
    }
    Ok(results)
}

fn fits(row: &Row, results: &Results) -> bool {
    row.set.len() == results.inputs.len() && (row.numbers.is_empty() || row.numbers.len() == results.names.len())
}

fn line(value: &impl Serialize) -> Result<String, String> {
    serde_json::to_string(value).map(|text| text + "\n").map_err(|error| error.to_string())
}

fn header(path: &Path, line: &str) -> Result<Header, String> {
    let value: serde_json::Value = serde_json::from_str(line).unwrap_or_default();
    if value["format"] != FORMAT {
        return Err(format!("`{}` is no journal of a study; remove it or write elsewhere", path.display()));
    }
    match serde_json::from_value::<Header>(value) {
        Ok(header) if header.version == VERSION => Ok(header),
        _ => Err(format!("`{}` is a journal of another version; remove it to begin anew", path.display())),
    }
}

fn changed(path: &Path) -> String {
    format!(
        "`{}` belongs to another study: the spec, the parameter sets, the wanted values, the settings or the number \
         of shards have changed since it was interrupted. Change them back to go on, or remove the journal to begin \
         anew",
        path.display()
    )
}

fn damaged(path: &Path, line: usize) -> String {
    format!("`{}` is damaged at line {line}; remove it to begin anew", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(row: usize) -> Row {
        Row {
            row,
            set: vec![1.0 / 3.0],
            status: "solved".into(),
            binding: "a; b".into(),
            numbers: vec![0.1, row as f64],
        }
    }

    fn of<'a>(fingerprint: &'a str, rows: usize, inputs: &'a [String]) -> Of<'a> {
        Of { fingerprint, rows, shard: Shard::WHOLE, inputs }
    }

    #[test]
    fn whatever_byte_the_process_dies_at_every_whole_row_is_kept_and_no_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.csv.journal");
        let (inputs, names) = ([String::from("a")], [String::from("T"), String::from("x")]);
        let study = of("f", 3, &inputs);
        let (mut journal, done) = Journal::open(&path, study).expect("a new one");
        assert!(done.rows.is_empty());
        journal.append(Some(&names), &[row(2), row(0)]).expect("written");
        drop(journal);
        let bytes = std::fs::read(&path).expect("bytes");
        let ends: Vec<usize> = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(i, _)| i + 1).collect();
        for cut in 0..=bytes.len() {
            std::fs::write(&path, &bytes[..cut]).expect("cut");
            let (mut journal, done) = Journal::open(&path, study).unwrap_or_else(|e| panic!("{cut}: {e}"));
            // Two lines are no rows.
            let whole = ends.iter().filter(|end| **end <= cut).count().saturating_sub(2);
            assert_eq!(done.rows, [row(2), row(0)][..whole], "cut at {cut}");
            // And it goes on from there.
            journal.append(Some(&names), &[row(1)]).expect("written");
            drop(journal);
            let (_, again) = Journal::open(&path, study).expect("opens again");
            assert_eq!((again.rows.len(), &again.names[..]), (whole + 1, &names[..]));
        }
    }

    #[test]
    fn another_study_a_second_process_and_damage_are_refused_with_words() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("j");
        let inputs = [String::from("a")];
        let (first, names) = (of("f", 2, &inputs), [String::from("T"), String::from("x")]);
        let (mut journal, _) = Journal::open(&path, first).expect("a new one");
        assert!(Journal::open(&path, first).expect_err("in use").contains("is running already"));
        journal.append(Some(&names), &[row(0)]).expect("written");
        drop(journal);
        let part = Shard::new(1, 2).expect("a shard");
        for changed in [of("g", 2, &inputs), of("f", 3, &inputs), of("f", 2, &[]), Of { shard: part, ..first }] {
            assert!(Journal::open(&path, changed).expect_err("changed").contains("belongs to another study"));
        }
        let text = std::fs::read_to_string(&path).expect("text");
        let last = text.lines().last().expect("a row");
        std::fs::write(&path, format!("{text}{last}\n")).expect("twice");
        assert!(Journal::open(&path, first).expect_err("a row twice").contains("damaged at line 4"));
        std::fs::write(&path, "mine\n").expect("a file");
        assert!(Journal::open(&path, first).expect_err("no journal").contains("is no journal"));
        assert_eq!(std::fs::read_to_string(&path).expect("text"), "mine\n");
    }
}
