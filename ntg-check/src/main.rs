//! `ntg-check FILE ...`: proves every claim of certificates again.
//!
//! Exit status: 0 when all claims hold, 1 when one does not, 2 when a file cannot be read.

use std::process::ExitCode;

fn main() -> ExitCode {
    let files: Vec<String> = std::env::args().skip(1).collect();
    if files.is_empty() || files.iter().any(|file| file.starts_with('-')) {
        eprintln!("usage: ntg-check FILE ...");
        return ExitCode::from(2);
    }
    let mut status = 0;
    for file in files {
        match std::fs::read_to_string(&file).map(|text| ntg_check::verify(&text)) {
            Ok(Ok(checked)) => {
                let counts: Vec<String> = checked.iter().map(|(verdict, count)| format!("{count} {verdict}")).collect();
                println!("{file}: every claim holds: {}", counts.join(", "));
            }
            Ok(Err(error)) => {
                println!("{file}: REJECTED: {error}");
                status = status.max(1);
            }
            Err(error) => {
                eprintln!("{file}: {error}");
                status = 2;
            }
        }
    }
    ExitCode::from(status)
}
