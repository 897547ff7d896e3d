//! What only the values of parameters make wrong, shown as the compiler shows its findings: code, place and help.

use ntg_compiler::source::Source;
use ntg_interp::finding;
use ntg_runtime::Error;

use crate::files;

/// What to say of a solve that could not begin; empty where a finding has been shown.
pub(crate) fn words(error: &Error, source: &Source) -> String {
    match error {
        Error::Setup(error) => match finding(error, source) {
            Some(finding) => {
                files::show(source, std::iter::once(&finding));
                String::new()
            }
            None => format!("{}: {error}", source.name),
        },
        other => other.to_string(),
    }
}
