//! Where a written crate gets ntg from.

use std::path::{Path, PathBuf};

/// The crates of ntg as a dependency.
pub(super) enum Dependency {
    /// A folder with the source.
    Folder(PathBuf),
    /// A git repository.
    Git(String),
    /// A version of the registry.
    Version(String),
}

/// What a word of the command line says, or what is around some paths and the command.
pub(super) fn of(wanted: Option<&str>, around: &[&Path]) -> Result<Dependency, String> {
    let Some(wanted) = wanted else {
        let command = std::env::current_exe().ok();
        let places = around.iter().map(|path| path.to_path_buf()).chain(command).chain([PathBuf::from(".")]);
        let found = places.filter_map(|path| std::path::absolute(path).ok()).find_map(|path| checkout(&path));
        return Ok(match found {
            Some(folder) => Dependency::Folder(folder),
            None => Dependency::Version(env!("CARGO_PKG_VERSION").to_owned()),
        });
    };
    let is_version = |word: &str| word.starts_with(|c: char| c.is_ascii_digit()) && !word.contains(['/', '"', '\\']);
    if Path::new(wanted).is_dir() {
        let folder = Path::new(wanted).canonicalize().map_err(|error| format!("--ntg `{wanted}`: {error}"))?;
        return match is_checkout(&folder) {
            true => Ok(Dependency::Folder(folder)),
            false => Err(format!("--ntg `{wanted}`: this folder is not the source of ntg")),
        };
    }
    if wanted.contains("://") || wanted.starts_with("git@") {
        return Ok(Dependency::Git(wanted.to_owned()));
    }
    if is_version(wanted) {
        return Ok(Dependency::Version(wanted.to_owned()));
    }
    Err(format!("--ntg `{wanted}`: a folder with the source of ntg, a git address such as `https://...`, or a version"))
}

/// The source of ntg that holds a path.
fn checkout(path: &Path) -> Option<PathBuf> {
    path.ancestors().find(|folder| is_checkout(folder)).map(Path::to_path_buf)
}

fn is_checkout(folder: &Path) -> bool {
    let manifest = |part: &str| std::fs::read_to_string(folder.join(part)).unwrap_or_default();
    folder.join("ntg-c/Cargo.toml").is_file() && manifest("Cargo.toml").lines().any(|line| line == "name = \"ntg\"")
}

impl Dependency {
    /// The line of `Cargo.toml` for one of the crates.
    pub(super) fn line(&self, name: &str) -> String {
        match self {
            Self::Folder(folder) => {
                let place = if name == "ntg" { folder.clone() } else { folder.join(name) };
                format!("{name} = {{ path = {:?} }}", place.display().to_string())
            }
            Self::Git(address) => format!("{name} = {{ git = {address:?} }}"),
            Self::Version(version) => format!("{name} = {version:?}"),
        }
    }

    /// The versions of all crates with which this source is tested.
    pub(super) fn lock(&self) -> Option<String> {
        match self {
            Self::Folder(folder) => std::fs::read_to_string(folder.join("Cargo.lock")).ok(),
            _ => None,
        }
    }
}
