//! Files that are either whole or not there.

use std::io::Write;
use std::path::Path;

use tempfile::Builder;

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
