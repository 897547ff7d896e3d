//! Files that are either whole or not there, and in the place of none that the same command reads.
//!
//! Takes paths and bytes; everything that the command writes into files goes through here. A link leads to what is written,
//! a device or a pipe is written into, what is read-only is refused, and a file that is replaced keeps its permissions.

use std::fs::{File, Metadata, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};

use tempfile::Builder;

use crate::files::is_standard_input;

/// Links after which a path is taken to lead in a circle: as many as Linux follows.
const MOST_LINKS: usize = 40;

/// Refuses a file that exists, before anything is computed; and a spec in any case: a result never replaces one.
pub(crate) fn may_write(path: &Path, force: bool) -> Result<(), String> {
    let is_spec = |path: &Path| path.extension().is_some_and(|extension| extension == "ntg");
    if is_spec(path) || target(path).is_ok_and(|target| is_spec(&target)) {
        return Err(format!("`{}` is a spec by its ending; give the result another name", path.display()));
    }
    may_replace(path, force).map(|_| ())
}

/// What is written to: what a path leads to, through all links.
enum Place {
    /// An ordinary file, or none yet: a whole one takes its place.
    File(PathBuf),
    /// A device or a pipe, which stays what it is.
    Stream,
}

/// Where a path leads to. Refuses what exists, unless it may be replaced, and what cannot be replaced.
fn may_replace(path: &Path, force: bool) -> Result<Place, String> {
    let shown = path.display();
    let failed = |error: std::io::Error| format!("cannot write `{shown}`: {error}");
    let Ok(about) = path.metadata() else {
        let target = target(path).map_err(failed)?;
        return match target.parent() {
            Some(folder) if !folder.as_os_str().is_empty() && !folder.is_dir() => Err(no_folder(folder)),
            _ => Ok(Place::File(target)),
        };
    };
    if about.is_dir() {
        return Err(format!("`{shown}` is a folder; name a file in it"));
    }
    let is_file = about.is_file();
    if !force {
        let what = if is_file { "replace it" } else { "write into it" };
        return Err(format!("`{shown}` exists; give --force to {what}, or another name"));
    }
    if about.permissions().readonly() {
        return Err(format!("cannot write `{shown}`: it is read-only"));
    }
    if is_file { path.canonicalize().map(Place::File).map_err(failed) } else { Ok(Place::Stream) }
}

/// What to say of a folder that there is not.
fn no_folder(folder: &Path) -> String {
    match file_above(folder) {
        Some(file) => format!("`{}` is a file, and no folder; give another name", file.display()),
        None => format!("`{}` is no folder; make it first", folder.display()),
    }
}

/// The file that stands where a folder or one above it would.
pub(crate) fn file_above(folder: &Path) -> Option<&Path> {
    folder.ancestors().find(|above| above.exists()).filter(|there| !there.is_dir())
}

/// Where links lead to, the last of which leads to nothing yet.
fn target(path: &Path) -> std::io::Result<PathBuf> {
    let mut target = path.to_owned();
    for _ in 0..MOST_LINKS {
        if !target.symlink_metadata().is_ok_and(|about| about.is_symlink()) {
            return Ok(target);
        }
        let link = target.read_link()?;
        target = target.parent().unwrap_or(Path::new("")).join(link);
    }
    Err(std::io::Error::other("its links lead in a circle"))
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
    let [one, other] = [one, other].map(|path| target(path).unwrap_or_else(|_| path.to_owned()));
    let [one, other] = [&one, &other];
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

/// Writes a file beside its place first and then moves it there, with the owner and the permissions of the one that it
/// replaces. Links are followed; what is written to a device or a pipe goes into it.
pub(crate) fn whole(path: &Path, force: bool, bytes: &[u8]) -> Result<(), String> {
    let failed = |error: &dyn std::fmt::Display| format!("cannot write `{}`: {error}", path.display());
    let target = match may_replace(path, force)? {
        Place::File(target) => target,
        Place::Stream => {
            let stream = OpenOptions::new().write(true).open(path);
            return stream.and_then(|mut stream| stream.write_all(bytes)).map_err(|error| failed(&error));
        }
    };
    let folder = target.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut partial = builder().tempfile_in(folder).map_err(|e| failed(&e))?;
    partial.write_all(bytes).map_err(|e| failed(&e))?;
    if let Ok(replaced) = target.metadata() {
        like(partial.as_file(), &replaced).map_err(|e| failed(&e))?;
    }
    partial.as_file().sync_all().map_err(|e| failed(&e))?;
    // Without `force`, a file that someone else has made in the meantime is kept too.
    if force { partial.persist(&target) } else { partial.persist_noclobber(&target) }.map_err(|e| failed(&e.error))?;
    Ok(())
}

/// Gives a file the permissions of another one, and its owner where the user may.
fn like(file: &File, replaced: &Metadata) -> std::io::Result<()> {
    #[cfg(unix)]
    {
        use std::os::unix::fs::{MetadataExt, fchown};
        let _ = fchown(file, Some(replaced.uid()), Some(replaced.gid()));
    }
    file.set_permissions(replaced.permissions())
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
