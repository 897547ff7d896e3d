//! `ntg lsp`: the language server.

use crate::Exit;

pub(crate) fn run() -> Exit {
    match ntg_lsp::run() {
        Ok(()) => Exit::Done,
        Err(error) => {
            tell!("error: {error}");
            Exit::Bad
        }
    }
}
