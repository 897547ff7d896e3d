//! Checks certificates of ntg trajectories.
//!
//! A certificate holds a trajectory as exact numbers, the compiled formulas over it, and what is claimed of them for all
//! times (docs/certificate-format.md). This crate proves every claim again. It shares no code with the programs that
//! write certificates: reader, arithmetic, functions and proofs are its own, and the arithmetic is made of integer
//! operations alone, so that neither a floating-point unit nor a library of functions is trusted.
//!
//! ```no_run
//! let text = std::fs::read_to_string("mission.cert")?;
//! let checked = ntg_check::verify(&text)?;
//! println!("{} constraints hold at all times", checked["proved"]);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod boxes;
mod check;
mod evaluate;
mod interval;
mod jet;
mod read;
mod real;
mod tube;

pub use check::Checked;

use sha2::{Digest, Sha256};

/// Checks the text of a certificate: that it is whole, and that every claim holds.
///
/// # Errors
/// Words about the first thing that is wrong.
pub fn verify(text: &str) -> Result<Checked, String> {
    let (body, end) = text.rsplit_once("digest ").ok_or("there is no digest: the file is not whole")?;
    let digest: String = Sha256::digest(body).iter().map(|byte| format!("{byte:02x}")).collect();
    if end.trim_end_matches('\n') != digest || !body.ends_with('\n') {
        return Err("the digest is that of another text: the file has been changed".to_owned());
    }
    verify_claims(body)
}

/// As [`verify`], for a text without its last line, the digest.
///
/// # Errors
/// Words about the first thing that is wrong.
pub fn verify_claims(text: &str) -> Result<Checked, String> {
    check::check(&read::read(text)?)
}
