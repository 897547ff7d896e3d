//! From the journals of all shards to the whole study.

use std::path::PathBuf;

use crate::journal;
use crate::study::{Results, Row};

/// Rows that a message names, at most.
const NAMED: usize = 5;

/// The results of a study from the journals of its shards, or of the one journal of a whole study.
///
/// # Errors
/// In words: no journal, journals of different studies, the same shard twice, shards or rows that are missing.
pub fn merge(journals: &[PathBuf]) -> Result<Results, String> {
    let mut all: Option<(journal::Header, Vec<Option<Row>>, Results)> = None;
    let mut parts = vec![];
    for path in journals {
        let (header, results) = journal::read(path)?;
        let (first, rows, whole) = all.get_or_insert_with(|| {
            let whole = Results { inputs: header.inputs.clone(), ..Results::default() };
            (header.clone(), vec![None; header.rows], whole)
        });
        let same = header.fingerprint == first.fingerprint && header.rows == first.rows;
        if !same || header.shard.1 != first.shard.1 {
            return Err(format!(
                "`{}` and `{}` belong to different studies, or to different numbers of shards",
                journals[0].display(),
                path.display()
            ));
        }
        if parts.contains(&header.shard.0) {
            return Err(format!("`{}`: shard {} is given twice", path.display(), header.shard.0));
        }
        parts.push(header.shard.0);
        if whole.names.is_empty() {
            whole.names.clone_from(&results.names);
        }
        if !results.names.is_empty() && results.names != whole.names {
            return Err(format!("`{}`: its rows have other results than those of the other shards", path.display()));
        }
        for row in results.rows {
            let place = row.row;
            if rows[place].replace(row).is_some() {
                return Err(format!("`{}`: row {place} stands in another journal too", path.display()));
            }
        }
    }
    let (header, rows, mut whole) = all.ok_or("there is no journal to merge")?;
    complete(&header, &parts, &rows)?;
    whole.rows = rows.into_iter().flatten().collect();
    Ok(whole)
}

/// Refuses a study of which something is missing, and says what.
fn complete(header: &journal::Header, parts: &[usize], rows: &[Option<Row>]) -> Result<(), String> {
    let of = header.shard.1;
    let absent: Vec<String> =
        (1..=of).filter(|part| !parts.contains(part)).map(|part| format!("{part}/{of}")).collect();
    if !absent.is_empty() {
        let more = if absent.len() > NAMED { format!(" and {} more", absent.len() - NAMED) } else { String::new() };
        return Err(format!(
            "{} of {of} shards have no journal: {}{more}; run `ntg sweep ... --shard` for them",
            absent.len(),
            absent[..absent.len().min(NAMED)].join(", ")
        ));
    }
    let missing = rows.iter().filter(|row| row.is_none()).count();
    if missing > 0 {
        return Err(format!(
            "{missing} of {} rows are not solved yet; the commands of their shards go on from there",
            rows.len()
        ));
    }
    Ok(())
}
