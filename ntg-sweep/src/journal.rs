//! The append-only record of finished rows, one JSON document a line.
//!
//! The first line says which study it is. A process that is killed leaves at worst a last line
//! without its end, which is dropped; a row counts once its line is whole.

use std::fs::{File, OpenOptions, TryLockError};
use std::io::{Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use crate::study::Row;

/// What the first line says it is.
const FORMAT: &str = "ntg-sweep-journal";
const VERSION: u64 = 1;

#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Header {
    format: String,
    version: u64,
    fingerprint: String,
    rows: usize,
}

/// An open journal. No other process can open it at the same time.
#[derive(Debug)]
pub struct Journal {
    file: File,
    path: PathBuf,
}

/// Where the journal of an output file stands.
pub fn beside(output: &Path) -> PathBuf {
    let mut name = output.file_name().unwrap_or_default().to_owned();
    name.push(".journal");
    output.with_file_name(name)
}

impl Journal {
    /// Opens the journal of a study, or begins it; gives what is finished already.
    ///
    /// # Errors
    /// In words: a journal of another study or that is in use, a damaged one, the system's own.
    pub fn open(path: &Path, fingerprint: &str, rows: usize) -> Result<(Self, Vec<Row>), String> {
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
        file.set_len(whole as u64).and_then(|()| file.seek(SeekFrom::End(0))).map_err(failed)?;
        let mut journal = Self { file, path: path.to_owned() };
        let header = Header { format: FORMAT.to_owned(), version: VERSION, fingerprint: fingerprint.to_owned(), rows };
        if whole == 0 {
            journal.write(&line(&header)?)?;
            return Ok((journal, vec![]));
        }
        let text = std::str::from_utf8(&bytes[..whole]).map_err(|_| damaged(path, 0))?;
        let mut lines = text.lines();
        check(path, lines.next().unwrap_or_default(), &header)?;
        let mut done: Vec<Row> = vec![];
        let mut seen = vec![false; rows];
        for (number, line) in lines.enumerate() {
            let row: Row = serde_json::from_str(line).map_err(|_| damaged(path, number + 2))?;
            match seen.get_mut(row.row) {
                Some(seen) if !*seen => *seen = true,
                _ => return Err(damaged(path, number + 2)),
            }
            done.push(row);
        }
        Ok((journal, done))
    }

    /// Adds rows; when this returns they will survive.
    ///
    /// # Errors
    /// The system's own, in words.
    pub fn append(&mut self, rows: &[Row]) -> Result<(), String> {
        let lines: Result<Vec<String>, String> = rows.iter().map(line).collect();
        self.write(&lines?.concat())
    }

    fn write(&mut self, text: &str) -> Result<(), String> {
        let written = self.file.write_all(text.as_bytes()).and_then(|()| self.file.sync_data());
        written.map_err(|error| format!("cannot write the journal `{}`: {error}", self.path.display()))
    }
}

fn line(value: &impl Serialize) -> Result<String, String> {
    serde_json::to_string(value).map(|text| text + "\n").map_err(|error| error.to_string())
}

fn check(path: &Path, line: &str, wanted: &Header) -> Result<(), String> {
    let found: Header = serde_json::from_str(line)
        .map_err(|_| format!("`{}` is no journal of a study; remove it or write elsewhere", path.display()))?;
    if found.format != wanted.format || found.version != wanted.version {
        return Err(format!("`{}` is a journal of another version; remove it to begin anew", path.display()));
    }
    if found.fingerprint != wanted.fingerprint || found.rows != wanted.rows {
        return Err(format!(
            "`{}` belongs to another study: the spec, the parameter sets, the wanted values or the settings have \
             changed since it was interrupted. Change them back to go on, or remove the journal to begin anew",
            path.display()
        ));
    }
    Ok(())
}

fn damaged(path: &Path, line: usize) -> String {
    format!("`{}` is damaged at line {line}; remove it to begin anew", path.display())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(row: usize) -> Row {
        Row { row, status: "solved".into(), numbers: vec![("T".into(), Some(0.1 + row as f64)), ("x".into(), None)] }
    }

    #[test]
    fn whatever_byte_the_process_dies_at_every_whole_row_is_kept_and_no_other() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("out.csv.journal");
        let (mut journal, done) = Journal::open(&path, "f", 3).expect("a new one");
        assert!(done.is_empty());
        journal.append(&[row(2), row(0)]).expect("written");
        drop(journal);
        let bytes = std::fs::read(&path).expect("bytes");
        let ends: Vec<usize> = bytes.iter().enumerate().filter(|(_, b)| **b == b'\n').map(|(i, _)| i + 1).collect();
        for cut in 0..=bytes.len() {
            std::fs::write(&path, &bytes[..cut]).expect("cut");
            let (mut journal, done) = Journal::open(&path, "f", 3).unwrap_or_else(|e| panic!("{cut}: {e}"));
            let whole = ends.iter().filter(|end| **end <= cut).count().saturating_sub(1);
            assert_eq!(done, [row(2), row(0)][..whole], "cut at {cut}");
            // And it goes on from there.
            journal.append(&[row(1)]).expect("written");
            drop(journal);
            let (_, again) = Journal::open(&path, "f", 3).expect("opens again");
            assert_eq!(again.len(), whole + 1);
        }
    }

    #[test]
    fn another_study_a_second_process_and_damage_are_refused_with_words() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("j");
        let (mut journal, _) = Journal::open(&path, "f", 2).expect("a new one");
        assert!(Journal::open(&path, "f", 2).expect_err("in use").contains("is running already"));
        journal.append(&[row(0)]).expect("written");
        drop(journal);
        assert!(Journal::open(&path, "g", 2).expect_err("changed").contains("belongs to another study"));
        assert!(Journal::open(&path, "f", 3).expect_err("changed").contains("belongs to another study"));
        let text = std::fs::read_to_string(&path).expect("text");
        let last = text.lines().last().expect("a row");
        std::fs::write(&path, format!("{text}{last}\n")).expect("twice");
        assert!(Journal::open(&path, "f", 2).expect_err("a row twice").contains("damaged at line 3"));
        std::fs::write(&path, "mine\n").expect("a file");
        assert!(Journal::open(&path, "f", 2).expect_err("no journal").contains("is no journal"));
        assert_eq!(std::fs::read_to_string(&path).expect("text"), "mine\n");
    }
}
