//! Files that are either whole or not there.

use std::io::Write;
use std::path::Path;

use tempfile::Builder;

/// Refuses a file that exists, before anything is computed.
pub(crate) fn may_write(path: &Path, force: bool) -> Result<(), String> {
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
    may_write(path, force)?;
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
