//! Specs on the command line: files, or all below a folder.

use ntg_compiler::model::Loader;
use ntg_compiler::program::Program;
use ntg_compiler::source::Source;
use ntg_interp::Interpreted;
use std::path::{Path, PathBuf};

/// All specs that the paths stand for, those of a folder in order of their names.
///
/// # Errors
/// A path that cannot be read.
pub fn below(paths: &[PathBuf]) -> Result<Vec<PathBuf>, String> {
    let mut found = vec![];
    for path in paths {
        collect(path, &mut found).map_err(|error| format!("cannot read {}: {error}", path.display()))?;
    }
    Ok(found)
}

fn collect(path: &Path, found: &mut Vec<PathBuf>) -> std::io::Result<()> {
    if !path.is_dir() {
        found.push(path.to_owned());
        return Ok(());
    }
    let mut inside: Vec<PathBuf> = std::fs::read_dir(path)?.filter_map(Result::ok).map(|entry| entry.path()).collect();
    inside.sort();
    for path in inside {
        if path.is_dir() || path.extension().is_some_and(|extension| extension == "ntg") {
            collect(&path, found)?;
        }
    }
    Ok(())
}

/// Tables are found relative to the spec that names them.
struct BesideSpec<'a>(&'a Path);

impl Loader for BesideSpec<'_> {
    fn load(&self, path: &str) -> Result<String, String> {
        std::fs::read_to_string(self.0.join(path)).map_err(|error| error.to_string())
    }
}

/// The program of a spec.
///
/// # Errors
/// The findings of the compiler, in words.
pub fn program(path: &Path) -> Result<Program, String> {
    let text = std::fs::read_to_string(path).map_err(|error| error.to_string())?;
    let source = Source::new(path.display().to_string(), text);
    let folder = path.parent().unwrap_or(Path::new(""));
    match ntg_compiler::compile(&source, &BesideSpec(folder)) {
        Ok(compiled) => Ok(compiled.program),
        Err(found) => Err(found.iter().map(|finding| finding.message.clone()).collect::<Vec<_>>().join("; ")),
    }
}

/// The problem of a spec, interpreted.
///
/// # Errors
/// The findings of the compiler, in words.
pub fn problem(path: &Path) -> Result<Interpreted, String> {
    program(path).map(|program| Interpreted::new(&program))
}
