//! Solves what is not finished yet, on all cores.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::mpsc::{Receiver, Sender, channel};

use rayon::prelude::*;

use crate::blocks::{Block, blocks};
use crate::journal::{Journal, Of};
use crate::shard::Shard;
use crate::study::{Results, Row, Study};

/// Rows at a time at most. Threads beyond the cores only wait for each other, and so many cores no machine has.
const MOST_JOBS: usize = 1024;

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
    /// All rows of the study, or of the shard, in order.
    Finished(Results),
    /// So many rows are there; the rest waits.
    Stopped(usize),
}

/// Makes the rows of a study, from several threads.
pub trait Solve: Sync {
    /// What the other rows of a block start from.
    type Start: Sync + Send;

    /// The row of a block's first parameter set and its solution, if there is one. None when it was stopped on the
    /// way.
    fn first(&self, row: usize, set: &[f64]) -> Option<(Row, Option<Self::Start>)>;

    /// The row of another parameter set of the block. None when it was stopped on the way.
    fn next(&self, row: usize, set: &[f64], start: Option<&Self::Start>) -> Option<Row>;

    /// What the numbers of a row are; none as long as no row has any.
    fn names(&self) -> Option<&[String]>;
}

/// Which part of a study is solved, and how.
#[derive(Clone, Copy, Debug)]
pub struct Plan<'a> {
    /// Rows at a time; 0 for one on each core.
    pub jobs: usize,
    /// The part.
    pub shard: Shard,
    /// Where finished rows are recorded.
    pub journal: &'a Path,
}

/// Runs a study, or a shard of it, with its journal. Panics of solves are caught and become rows that say so.
///
/// # Errors
/// In words: a journal that cannot be used.
pub fn run<S: Solve>(study: &Study, plan: Plan<'_>, watcher: &dyn Watcher, solve: &S) -> Result<Ended, String> {
    let fingerprint = study.fingerprint();
    let of = Of { fingerprint: &fingerprint, rows: study.sets.len(), shard: plan.shard, inputs: &study.inputs };
    let (journal, done) = Journal::open(plan.journal, of)?;
    let mut finished = vec![false; study.sets.len()];
    done.rows.iter().for_each(|row| finished[row.row] = true);
    let work = Work { study, blocks: plan.shard.blocks(blocks(&study.sets, study.block)), finished, solve, watcher };
    watcher.done(done.rows.len());
    let (send, receive) = channel();
    let before = done.rows.len();
    let rows = std::thread::scope(|scope| {
        let names = || solve.names().map(<[String]>::to_vec);
        let writer = scope.spawn(move || record(journal, receive, before, watcher, &names));
        let worked = work.on_cores(plan.jobs, send);
        worked.and(writer.join().unwrap_or_else(|_| Err("the journal's writer has failed".to_owned())))
    })?;
    let all = done.rows.into_iter().chain(rows).collect();
    Ok(work.ended(if done.names.is_empty() { None } else { Some(done.names) }, all))
}

/// Runs blocks of a study without a journal: what is not finished when it is stopped is lost.
///
/// # Errors
/// In words: the system's own, where it has no threads to give.
pub fn solve_all<S: Solve>(
    study: &Study,
    blocks: Vec<Block>,
    jobs: usize,
    watcher: &dyn Watcher,
    solve: &S,
) -> Result<Ended, String> {
    let finished = vec![false; study.sets.len()];
    let work = Work { study, blocks, finished, solve, watcher };
    let (send, receive) = channel::<Row>();
    let rows = std::thread::scope(|scope| {
        let keeper = scope.spawn(move || {
            let mut all = vec![];
            for row in receive {
                all.push(row);
                watcher.done(all.len());
            }
            all
        });
        let worked = work.on_cores(jobs, send);
        worked.and(keeper.join().map_err(|_| "the keeper of the rows has failed".to_owned()))
    })?;
    Ok(work.ended(None, rows))
}

/// What is to be done.
struct Work<'a, S> {
    study: &'a Study,
    blocks: Vec<Block>,
    finished: Vec<bool>,
    solve: &'a S,
    watcher: &'a dyn Watcher,
}

impl<S: Solve> Work<'_, S> {
    /// Solves all blocks on threads of its own; rows go to `send`.
    fn on_cores(&self, jobs: usize, send: Sender<Row>) -> Result<(), String> {
        let jobs = jobs.min(self.study.sets.len()).min(MOST_JOBS);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(jobs).build().map_err(|error| error.to_string())?;
        // One block at a time, first blocks first: solves differ in length.
        pool.install(|| {
            self.blocks.par_iter().with_max_len(1).for_each_with(send, |send, block| self.block(block, send));
        });
        Ok(())
    }

    /// Solves what a block still needs. Its first row is solved again where only others are missing.
    fn block(&self, block: &Block, send: &Sender<Row>) {
        let rest: Vec<usize> = block.rest.iter().copied().filter(|row| !self.finished[*row]).collect();
        let is_new = !self.finished[block.first];
        if self.watcher.stopped() || (rest.is_empty() && !is_new) {
            return;
        }
        let (row, set) = (block.first, &self.study.sets[block.first]);
        let made = caught(|| self.solve.first(row, set), |words| Some((Row::failed(row, set, words), None)));
        let Some((found, start)) = made else { return };
        if is_new {
            // The receiver goes away only after it has failed, which it reports itself.
            let _ = send.send(found);
        }
        // Rows of a block wait for nothing but its first: many cores may share a block.
        rest.par_iter().with_max_len(1).for_each_with(send.clone(), |send, row| {
            if self.watcher.stopped() {
                return;
            }
            let set = &self.study.sets[*row];
            let made =
                caught(|| self.solve.next(*row, set, start.as_ref()), |words| Some(Row::failed(*row, set, words)));
            if let Some(found) = made {
                let _ = send.send(found);
            }
        });
    }

    fn ended(&self, names: Option<Vec<String>>, mut rows: Vec<Row>) -> Ended {
        let wanted: usize = self.blocks.iter().map(|block| 1 + block.rest.len()).sum();
        if rows.len() < wanted {
            return Ended::Stopped(rows.len());
        }
        rows.sort_by_key(|row| row.row);
        let names = names.or_else(|| self.solve.names().map(<[String]>::to_vec)).unwrap_or_default();
        Ended::Finished(Results { inputs: self.study.inputs.clone(), names, rows })
    }
}

/// Writes rows as they come, all that wait at once, so that solves never wait for the disk.
fn record(
    mut journal: Journal,
    rows: Receiver<Row>,
    before: usize,
    watcher: &dyn Watcher,
    names: &dyn Fn() -> Option<Vec<String>>,
) -> Result<Vec<Row>, String> {
    let mut all = vec![];
    let mut known = None;
    while let Ok(first) = rows.recv() {
        let waiting: Vec<Row> = std::iter::once(first).chain(rows.try_iter()).collect();
        known = known.or_else(names);
        journal.append(known.as_deref(), &waiting)?;
        all.extend(waiting);
        watcher.done(before + all.len());
    }
    journal.sync()?;
    Ok(all)
}

/// What was made, or what is made of the words with which it panicked.
fn caught<T>(make: impl FnOnce() -> T, failed: impl FnOnce(String) -> T) -> T {
    catch_unwind(AssertUnwindSafe(make)).unwrap_or_else(|panic| {
        let words = panic.downcast_ref::<String>().map(String::as_str).or(panic.downcast_ref::<&str>().copied());
        failed(format!("failed: {}", words.unwrap_or("a fault of ntg")))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::journal::beside;
    use crate::merge;
    use std::sync::atomic::{AtomicUsize, Ordering};

    /// Stops after so many rows were begun.
    struct After(usize, AtomicUsize);

    impl Watcher for After {
        fn done(&self, _: usize) {}
        fn stopped(&self) -> bool {
            self.1.fetch_add(1, Ordering::SeqCst) >= self.0
        }
    }

    fn after(rows: usize) -> After {
        After(rows, AtomicUsize::new(0))
    }

    /// Squares numbers, and remembers how often it made which row. A row says which start it had.
    struct Squares {
        names: Vec<String>,
        made: Vec<AtomicUsize>,
    }

    impl Squares {
        fn new() -> Self {
            let made = std::iter::repeat_with(AtomicUsize::default).take(50).collect();
            Self { names: vec!["square".into(), "start".into()], made }
        }

        fn row(&self, row: usize, set: &[f64], start: f64) -> Row {
            self.made[row].fetch_add(1, Ordering::SeqCst);
            assert!(set[0] != 13.0, "thirteen");
            let numbers = vec![set[0] * set[0], start];
            Row { row, set: set.to_vec(), status: "solved".into(), binding: String::new(), numbers }
        }
    }

    impl Solve for Squares {
        type Start = f64;
        fn first(&self, row: usize, set: &[f64]) -> Option<(Row, Option<f64>)> {
            Some((self.row(row, set, f64::NAN), Some(set[0])))
        }
        fn next(&self, row: usize, set: &[f64], start: Option<&f64>) -> Option<Row> {
            Some(self.row(row, set, start.copied().unwrap_or(f64::NAN)))
        }
        fn names(&self) -> Option<&[String]> {
            Some(&self.names)
        }
    }

    fn study() -> Study {
        let sets = (0..50).map(|i| vec![f64::from(i)]).collect();
        Study { inputs: vec!["a".into()], sets, block: 8, about: vec![] }
    }

    /// The same bits, with one NaN like any other.
    fn bits(results: &Results) -> Vec<(usize, String, Vec<u64>)> {
        let rows = results.rows.iter();
        rows.map(|row| (row.row, row.status.clone(), row.numbers.iter().map(|n| n.to_bits()).collect())).collect()
    }

    #[test]
    fn no_more_threads_are_begun_than_there_are_rows() {
        /// Says how many threads its pool has.
        struct Threads(Vec<String>);

        impl Solve for Threads {
            type Start = ();
            fn first(&self, row: usize, set: &[f64]) -> Option<(Row, Option<()>)> {
                Some((self.next(row, set, None)?, Some(())))
            }
            fn next(&self, row: usize, set: &[f64], _: Option<&()>) -> Option<Row> {
                let numbers = vec![rayon::current_num_threads() as f64];
                Some(Row { row, set: set.to_vec(), status: "solved".into(), binding: String::new(), numbers })
            }
            fn names(&self) -> Option<&[String]> {
                Some(&self.0)
            }
        }

        let threads = Threads(vec!["threads".into()]);
        for (jobs, wanted) in [(2, 2.0), (50, 50.0), (51, 50.0), (1_000_000, 50.0), (usize::MAX, 50.0)] {
            let all = blocks(&study().sets, 8);
            let Ok(Ended::Finished(rows)) = solve_all(&study(), all, jobs, &after(1000), &threads) else {
                panic!("it is not stopped");
            };
            assert!(rows.rows.iter().all(|row| row.numbers == [wanted]), "{jobs}");
        }
    }

    #[test]
    fn a_study_stopped_again_and_again_records_every_row_once_and_ends_as_one_left_alone() {
        let Ok(Ended::Finished(whole)) =
            solve_all(&study(), blocks(&study().sets, 8), 1, &after(1000), &Squares::new())
        else {
            panic!("it is not stopped");
        };
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("j");
        let squares = Squares::new();
        let plan = Plan { jobs: 2, shard: Shard::WHOLE, journal: &path };
        let mut stops = 0;
        let rows = loop {
            match run(&study(), plan, &after(9), &squares).expect("a journal") {
                Ended::Finished(rows) => break rows,
                Ended::Stopped(there) => assert!(there < 50),
            }
            stops += 1;
        };
        assert!(stops > 2, "{stops}");
        assert_eq!(bits(&rows), bits(&whole));
        assert_eq!(rows.rows[13].status, "failed: thirteen");
        assert_eq!(rows.rows[7].numbers[0], 49.0);
        // Only first rows are made more than once.
        let firsts: Vec<usize> = blocks(&study().sets, 8).iter().map(|block| block.first).collect();
        for (row, made) in squares.made.iter().enumerate() {
            assert!(made.load(Ordering::SeqCst) == 1 || firsts.contains(&row), "row {row}");
        }
    }

    #[test]
    fn shards_merge_to_what_the_whole_study_gives_and_nothing_less_is_taken() {
        let folder = tempfile::tempdir().expect("a folder");
        let output = folder.path().join("s.csv");
        let whole = match run(
            &study(),
            Plan { jobs: 1, shard: Shard::WHOLE, journal: &folder.path().join("whole") },
            &after(1000),
            &Squares::new(),
        ) {
            Ok(Ended::Finished(whole)) => whole,
            other => panic!("{other:?}"),
        };
        let mut journals = vec![];
        for part in 1..=3 {
            let shard = Shard::new(part, 3).expect("a shard");
            let journal = beside(&output, shard);
            let plan = Plan { jobs: 2, shard, journal: &journal };
            if part == 3 {
                assert!(matches!(run(&study(), plan, &after(5), &Squares::new()), Ok(Ended::Stopped(_))));
                let said = merge(&[&journals[..], std::slice::from_ref(&journal)].concat()).expect_err("unfinished");
                assert!(said.contains("rows are not solved yet"), "{said}");
            }
            if part == 2 {
                let said = merge(&journals).expect_err("two shards are missing");
                assert!(said.contains("2 of 3 shards have no journal: 2/3, 3/3"), "{said}");
            }
            assert!(matches!(run(&study(), plan, &after(1000), &Squares::new()), Ok(Ended::Finished(_))));
            journals.push(journal);
        }
        assert_eq!(crate::journal::all_beside(&output).expect("a folder"), journals);
        let merged = merge(&journals).expect("all shards");
        assert_eq!(bits(&merged), bits(&whole));
        assert_eq!((merged.inputs, merged.names), (whole.inputs, whole.names));
        let twice = merge(&[&journals[..], &journals[..1]].concat()).expect_err("twice");
        assert!(twice.contains("shard 1 is given twice"), "{twice}");
        let mixed = merge(&[journals[0].clone(), folder.path().join("whole")]).expect_err("mixed");
        assert!(mixed.contains("different studies"), "{mixed}");
        assert!(merge(&[]).is_err());
    }
}
