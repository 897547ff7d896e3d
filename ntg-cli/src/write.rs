//! Files that are either whole or not there, and in the place of none that the same command reads.

use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::Builder;

use crate::files::is_standard_input;

/// Refuses a file that exists, before anything is computed; and a spec in any case: a result never replaces one.
pub(crate) fn may_write(path: &Path, force: bool) -> Result<(), String> {
    if path.extension().is_some_and(|extension| extension == "ntg") {
        return Err(format!("`{}` is a spec by its ending; give the result another name", path.display()));
    }
    may_replace(path, force)
}

/// Refuses a file that exists.
fn may_replace(path: &Path, force: bool) -> Result<(), String> {
    if path.exists() && !force {
        return Err(format!("`{}` exists; give --force to replace it, or another name", path.display()));
    }
    match path.parent() {
        Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => {
            Err(format!("`{}` is no folder; make it first", folder.display()))
        }
        _ => Ok(()),
    }
}

/// Refuses outputs that are one of the files that a command reads, by whatever name, or one another.
pub(crate) fn spares<P: AsRef<Path>>(outputs: &[P], inputs: &[PathBuf]) -> Result<(), String> {
    for (number, output) in outputs.iter().enumerate() {
        let output = output.as_ref();
        let shown = output.display();
        if let Some(input) = inputs.iter().find(|input| is_same(input, output)) {
            let by = if input == output { String::new() } else { format!(" as `{}`", input.display()) };
            return Err(format!("`{shown}` is read by this command{by}; give the result another name"));
        }
        if outputs[..number].iter().any(|other| is_same(other.as_ref(), output)) {
            return Err(format!("`{shown}` would be written twice; give each result a name of its own"));
        }
    }
    Ok(())
}

/// Whether two paths lead to one file.
pub(crate) fn is_same(one: &Path, other: &Path) -> bool {
    let [one, other] = [one, other].map(|path| match is_standard_input(path) {
        // Where a shell has put a file in the place of standard input.
        true => Path::new("/dev/stdin"),
        false => path,
    });
    std::path::absolute(one).ok().zip(std::path::absolute(other).ok()).is_some_and(|(one, other)| one == other)
        || identity(one).zip(identity(other)).is_some_and(|(one, other)| one == other)
}

/// What all names of a file have in common; none of a file that is not there.
#[cfg(unix)]
fn identity(path: &Path) -> Option<(u64, u64)> {
    use std::os::unix::fs::MetadataExt;
    path.metadata().ok().map(|about| (about.dev(), about.ino()))
}

#[cfg(not(unix))]
fn identity(path: &Path) -> Option<PathBuf> {
    path.canonicalize().ok()
}

/// Writes a file beside its place first and then moves it there.
pub(crate) fn whole(path: &Path, force: bool, bytes: &[u8]) -> Result<(), String> {
    may_replace(path, force)?;
    let failed = |error: &dyn std::fmt::Display| format!("cannot write `{}`: {error}", path.display());
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut partial = builder().tempfile_in(folder).map_err(|e| failed(&e))?;
    partial.write_all(bytes).and_then(|()| partial.as_file().sync_all()).map_err(|e| failed(&e))?;
    // Without `force`, a file that someone else has made in the meantime is kept too.
    if force { partial.persist(path) } else { partial.persist_noclobber(path) }.map_err(|e| failed(&e.error))?;
    Ok(())
}

/// Makes files that others may read as far as the user's mask lets them, like any other program.
#[cfg(unix)]
fn builder() -> Builder<'static, 'static> {
    use std::os::unix::fs::PermissionsExt;
    let mut builder = Builder::new();
    builder.prefix(".ntg-").permissions(std::fs::Permissions::from_mode(0o666));
    builder
}

#[cfg(not(unix))]
fn builder() -> Builder<'static, 'static> {
    let mut builder = Builder::new();
    builder.prefix(".ntg-");
    builder
}
