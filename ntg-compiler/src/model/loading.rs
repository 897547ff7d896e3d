//! Which files are read for a spec, and how what is not read is told.
//!
//! Takes what a loader knows of a file before it reads it, gives a reason against it. A device has no end, a pipe may have no
//! writer, and what is larger than all memory is no table.

/// The most bytes of a file that is read for a spec. A choice: ten million numbers of a dozen signs, and room for twice as many.
pub const LARGEST_FILE: u64 = 256 << 20;

/// Bytes of a mebibyte.
const MEBIBYTE: u64 = 1 << 20;
/// What is said of something that is no regular file.
const NO_FILE: &str = "it is no regular file but a folder, a device or a pipe";
/// What is said of a file that is too large, behind its size.
const TOO_LARGE: &str = "MiB are more than is read of a file";

/// Why a loader does not read what stands at a path: whether it is a regular file, and how many bytes it has; none where it is read.
pub fn unfit(is_regular: bool, bytes: u64) -> Option<String> {
    if !is_regular {
        return Some(NO_FILE.to_owned());
    }
    let (whole, most) = (bytes.div_ceil(MEBIBYTE), LARGEST_FILE / MEBIBYTE);
    (bytes > LARGEST_FILE).then(|| format!("its {whole} {TOO_LARGE}, {most} MiB"))
}

/// The text of a file as loaders read it: `about` has whether it is a regular file and how many bytes it has, and nothing is read
/// of one that is unfit.
///
/// # Errors
/// The reason against the file, or what `failed` says of an error of the system.
pub fn text<E>(
    about: Result<(bool, u64), E>,
    read: impl FnOnce() -> Result<String, E>,
    failed: impl Fn(E) -> String,
) -> Result<String, String> {
    let (is_regular, bytes) = about.map_err(&failed)?;
    unfit(is_regular, bytes).map_or_else(|| read().map_err(failed), Err)
}

/// What to do about a file that cannot be read, by the reason for it; `from` is what its path is relative to.
pub(super) fn help(why: &str, from: &str) -> String {
    if why == NO_FILE {
        "copy what it gives to a file and name that".to_owned()
    } else if why.contains(TOO_LARGE) {
        "leave out rows that are not needed, or digits".to_owned()
    } else {
        format!("paths are relative to {from}, or to Cargo.toml for a spec inside Rust")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_has_no_end_is_not_read_and_the_largest_file_is() {
        assert_eq!(unfit(true, LARGEST_FILE), None);
        assert_eq!(
            unfit(true, LARGEST_FILE + 1).as_deref(),
            Some("its 257 MiB are more than is read of a file, 256 MiB")
        );
        assert_eq!(unfit(false, 0).as_deref(), Some(NO_FILE));
        assert_eq!(help(NO_FILE, "the spec file"), "copy what it gives to a file and name that");
        assert!(unfit(true, 1 << 60).is_some_and(|why| help(&why, "the spec file").starts_with("leave out rows")));
        let failed = |error: &str| format!("cannot read it: {error}");
        assert_eq!(text(Ok((true, 5)), || Ok("words".to_owned()), failed), Ok("words".to_owned()));
        assert_eq!(text(Ok((false, 0)), || panic!("a device is read"), failed), Err(NO_FILE.to_owned()));
        assert_eq!(text(Err("gone"), || panic!("nothing is read"), failed), Err("cannot read it: gone".to_owned()));
        assert!(help("no such file", "the spec file").starts_with("paths are relative to the spec file"));
    }
}
