//! Solves what is not finished yet, on all cores.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};

use rayon::prelude::*;

use crate::journal::Journal;
use crate::study::{Row, Study};

/// Who wants to know how far it is, and may stop it.
pub trait Watcher: Sync {
    /// So many rows are finished.
    fn done(&self, rows: usize);
    /// Whether to begin no more rows.
    fn stopped(&self) -> bool;
}

/// How a study ended.
#[derive(Clone, Debug, PartialEq)]
pub enum Ended {
    /// All rows, in order.
    Finished(Vec<Row>),
    /// So many rows are in the journal; the rest waits.
    Stopped(usize),
}

/// Runs a study with its journal. `solve` makes the row of one parameter set, none when it was
/// stopped on the way; its panics are caught and become rows that say so. `jobs` rows are solved
/// at a time, 0 for one on each core.
///
/// # Errors
/// In words: a journal that cannot be used.
pub fn run(
    study: &Study,
    journal: &Path,
    jobs: usize,
    watcher: &dyn Watcher,
    solve: impl Fn(usize, &[f64]) -> Option<Row> + Sync,
) -> Result<Ended, String> {
    let count = study.sets.len();
    let (journal, done) = Journal::open(journal, &study.fingerprint(), count)?;
    let mut finished: Vec<Option<Row>> = vec![None; count];
    for row in done {
        let place = row.row;
        finished[place] = Some(row);
    }
    let pending: Vec<usize> = (0..count).filter(|row| finished[*row].is_none()).collect();
    watcher.done(count - pending.len());

    let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build().map_err(|error| error.to_string())?;
    let (send, receive) = channel();
    let before = count - pending.len();
    let rows = std::thread::scope(|scope| {
        let writer = scope.spawn(|| record(journal, receive, before, watcher));
        pool.install(|| {
            // One row at a time, first rows first: solves differ in length.
            pending.par_iter().with_max_len(1).for_each_with(send, |send, row| {
                if watcher.stopped() {
                    return;
                }
                if let Some(found) = caught(*row, || solve(*row, &study.sets[*row])) {
                    // The writer goes away only after it has failed, which it reports itself.
                    let _ = send.send(found);
                }
            });
        });
        writer.join().unwrap_or_else(|_| Err("the journal's writer has failed".to_owned()))
    })?;
    for row in rows {
        let place = row.row;
        finished[place] = Some(row);
    }
    let there = finished.iter().flatten().count();
    Ok(match finished.into_iter().collect() {
        Some(rows) => Ended::Finished(rows),
        None => Ended::Stopped(there),
    })
}

/// Writes rows as they come, all that wait at once, so that solves never wait for the disk.
fn record(mut journal: Journal, rows: Receiver<Row>, before: usize, watcher: &dyn Watcher) -> Result<Vec<Row>, String> {
    let mut all = vec![];
    while let Ok(first) = rows.recv() {
        let waiting: Vec<Row> = std::iter::once(first).chain(rows.try_iter()).collect();
        journal.append(&waiting)?;
        all.extend(waiting);
        watcher.done(before + all.len());
    }
    Ok(all)
}

/// The row, or one that says how its solve panicked.
fn caught(row: usize, solve: impl FnOnce() -> Option<Row>) -> Option<Row> {
    catch_unwind(AssertUnwindSafe(solve)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        Some(Row::failed(row, format!("failed: {}", words.unwrap_or("a fault of ntg"))))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Stops after so many rows were begun.
    struct After(usize, AtomicUsize);

    impl Watcher for After {
        fn done(&self, _: usize) {}
        fn stopped(&self) -> bool {
            self.1.fetch_add(1, Ordering::SeqCst) >= self.0
        }
    }

    fn study() -> Study {
        Study { inputs: vec!["a".into()], sets: (0..50).map(|i| vec![f64::from(i)]).collect(), about: vec![] }
    }

    fn square(row: usize, set: &[f64]) -> Option<Row> {
        assert!(set[0] != 13.0, "thirteen");
        let mut made = Row { row, status: "solved".into(), numbers: vec![] };
        made.push("square", set[0] * set[0]);
        Some(made)
    }

    #[test]
    fn a_study_stopped_again_and_again_solves_every_row_once() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("j");
        let solved = AtomicUsize::new(0);
        let count = |row: usize, set: &[f64]| {
            solved.fetch_add(1, Ordering::SeqCst);
            square(row, set)
        };
        let rows = loop {
            match run(&study(), &path, 2, &After(9, AtomicUsize::new(0)), count).expect("a journal") {
                Ended::Finished(rows) => break rows,
                Ended::Stopped(there) => assert_eq!(there, solved.load(Ordering::SeqCst)),
            }
        };
        assert_eq!(solved.load(Ordering::SeqCst), 50);
        for (i, row) in rows.iter().enumerate() {
            assert_eq!(row.row, i);
            match i {
                13 => assert_eq!(row.status, "failed: thirteen"),
                _ => assert_eq!(row.numbers, [("square".to_owned(), Some((i * i) as f64))]),
            }
        }
    }
}
