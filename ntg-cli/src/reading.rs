//! Reads whole files, and none without an end.
//!
//! Takes paths that a user has named, gives bytes and text; a device is refused before it is opened, and a file that is larger than
//! `LARGEST_FILE` before it fills the memory.

use std::fs::{File, Metadata};
use std::io::{Error, ErrorKind, Read, Result};
use std::path::Path;

use ntg_compiler::model::loading::{LARGEST_FILE, unfit};

/// The text of a file that a spec names.
pub(crate) fn named(path: &Path) -> Result<String> {
    let about = std::fs::metadata(path)?;
    refused(about.is_file(), about.len())?;
    text(path)
}

/// The text of a file or a pipe.
pub(crate) fn text(path: &Path) -> Result<String> {
    String::from_utf8(bytes(path)?).map_err(|error| Error::new(ErrorKind::InvalidData, error))
}

/// The bytes of a file or a pipe.
pub(crate) fn bytes(path: &Path) -> Result<Vec<u8>> {
    checked(path)?;
    all(File::open(path)?)
}

/// Everything up to the end of what can be read, if that is not too much.
pub(crate) fn all(from: impl Read) -> Result<Vec<u8>> {
    let mut bytes = vec![];
    from.take(LARGEST_FILE + 1).read_to_end(&mut bytes)?;
    refused(true, bytes.len() as u64)?;
    Ok(bytes)
}

/// Whether there is a file or a pipe, and not too much in it, before another crate reads it.
pub(crate) fn checked(path: &Path) -> Result<()> {
    let about = std::fs::metadata(path)?;
    refused(about.is_file() || is_pipe(&about), about.len())
}

fn refused(is_file: bool, bytes: u64) -> Result<()> {
    unfit(is_file, bytes).map_or(Ok(()), |why| Err(Error::other(why)))
}

#[cfg(unix)]
fn is_pipe(about: &Metadata) -> bool {
    use std::os::unix::fs::FileTypeExt;
    about.file_type().is_fifo()
}

#[cfg(not(unix))]
fn is_pipe(_: &Metadata) -> bool {
    false
}
