//! The language server of ntg: what an editor asks about a spec, answered by the compiler.
//!
//! ```text
//! editor ──JSON-RPC──► server ──text──► analysis (syntax, names, model) ──► hover, complete, rename, outline
//! ```
//!
//! `ntg lsp` starts it on standard input and output. It knows no more of the language than the compiler tells it, and
//! keeps nothing but the open documents.

pub mod analysis;
pub mod complete;
pub mod hover;
pub mod lines;
pub mod names;
pub mod outline;
pub mod rename;
mod server;
pub mod words;

pub use server::{ProtocolError, serve};

/// Answers the editor at the other end of standard input and output.
///
/// # Errors
/// The connection broke, or the editor does not speak the protocol.
pub fn run() -> Result<(), ProtocolError> {
    let (connection, threads) = lsp_server::Connection::stdio();
    let served = serve(&connection);
    // The threads end when the channel to them does.
    drop(connection);
    threads.join()?;
    served
}
