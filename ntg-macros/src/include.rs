//! Files that a spec is made of: where they are, what they hold, and that cargo watches them.
//!
//! Takes paths as the user wrote them, gives texts, the tokens that make cargo rebuild when one of
//! the files changes, and those by which the program itself has the texts. A macro cannot tell cargo
//! so directly; a constant that includes the file's bytes can, and costs nothing in the binary.

use std::cell::RefCell;
use std::path::{Path, PathBuf};

use ntg_compiler::model::{Loader, loading};
use proc_macro2::TokenStream;
use quote::quote;

/// Reads files, all relative to one folder, and remembers them.
pub(crate) struct Files {
    root: PathBuf,
    /// As the spec writes the path, and as it was opened.
    read: RefCell<Vec<(String, PathBuf)>>,
}

impl Files {
    /// Files relative to the crate that calls the macro.
    ///
    /// # Errors
    /// There is no `CARGO_MANIFEST_DIR`: the macro runs outside cargo.
    pub(crate) fn of_crate() -> Result<Self, String> {
        let root = std::env::var_os("CARGO_MANIFEST_DIR").map(PathBuf::from);
        let root = root.ok_or("the folder of Cargo.toml is unknown: `CARGO_MANIFEST_DIR` is not set")?;
        Ok(Self::of_folder(root))
    }

    /// Files relative to a folder.
    fn of_folder(root: PathBuf) -> Self {
        Self { root, read: RefCell::default() }
    }

    /// The files beside one of ours: a spec's tables.
    pub(crate) fn beside(&self, path: &str) -> Self {
        let path = self.root.join(path);
        Self::of_folder(path.parent().unwrap_or(&self.root).to_path_buf())
    }

    /// The tokens that make cargo watch every file that was read.
    pub(crate) fn watch(&self) -> TokenStream {
        let read = self.read.borrow();
        let paths = read.iter().filter_map(|(_, path)| path.to_str());
        quote! { #(const _: &[u8] = ::core::include_bytes!(#paths);)* }
    }

    /// The tokens of an array of all files: the path as the spec writes it, and the text.
    pub(crate) fn texts(&self) -> TokenStream {
        let read = self.read.borrow();
        let pairs = read.iter().filter_map(|(name, path)| Some((name, path.to_str()?)));
        let (names, paths): (Vec<_>, Vec<_>) = pairs.unzip();
        quote! { [#((#names, ::core::include_str!(#paths))),*] }
    }
}

impl Loader for Files {
    fn load(&self, path: &str) -> Result<String, String> {
        let place = absolute(&self.root.join(path));
        let about = std::fs::metadata(&place).map(|about| (about.is_file(), about.len()));
        let failed = |error: std::io::Error| format!("`{}`: {error}", place.display());
        let text = loading::text(about, || std::fs::read_to_string(&place), failed)?;
        let mut read = self.read.borrow_mut();
        if read.iter().all(|(name, _)| name != path) {
            read.push((path.to_owned(), place));
        }
        Ok(text)
    }
}

/// The path from the root of the file system; `..` stays, as links may make it matter.
fn absolute(path: &Path) -> PathBuf {
    std::path::absolute(path).unwrap_or_else(|_| path.to_path_buf())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_that_was_read_is_watched_by_its_absolute_path_once() {
        let files = Files::of_folder(env!("CARGO_MANIFEST_DIR").into());
        assert!(files.watch().is_empty());
        assert!(files.load("Cargo.toml").is_ok_and(|text| text.contains("ntg-macros")));
        files.load("Cargo.toml").expect("it was there a moment ago");
        let watch = files.watch().to_string();
        assert_eq!(watch.matches("include_bytes").count(), 1);
        assert!(watch.contains(concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml")), "{watch}");
    }

    #[test]
    fn a_file_that_is_missing_is_named_by_the_path_that_was_tried() {
        let files = Files::of_folder(env!("CARGO_MANIFEST_DIR").into()).beside("specs/x.ntg");
        let error = files.load("nowhere.csv").expect_err("there is no such file");
        assert!(error.contains(concat!(env!("CARGO_MANIFEST_DIR"), "/specs/nowhere.csv")), "{error}");
        assert!(files.watch().is_empty());
    }
}
