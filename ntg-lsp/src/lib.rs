//! The language server of ntg: what an editor asks about a spec, answered by the compiler.
//!
//! ```text
//! editor ──JSON-RPC──► server ──text──► analysis (syntax, names, model) ──► hover, complete, rename, outline
//! ```
//!
//! `ntg lsp` starts it on standard input and output. It knows no more of the language than the compiler tells it, and
//! keeps nothing but the open documents.

pub mod actions;
pub mod analysis;
pub mod complete;
pub mod explained;
pub mod hover;
pub mod libraries;
pub mod lines;
pub mod names;
pub mod outline;
pub mod rename;
mod server;
pub mod signature;
pub mod words;

pub use server::{ProtocolError, serve};

use lsp_server::Connection;

/// Answers the editor at the other end of standard input and output.
///
/// # Errors
/// The connection broke, or the editor does not speak the protocol.
pub fn run() -> Result<(), ProtocolError> {
    let (Connection { sender, receiver }, threads) = Connection::stdio();
    // The thread that reads hands over one message at a time; those that come while the compiler looks at a text wait
    // in a queue, for `serve` to see them together.
    let (filled, queue) = Connection::memory();
    let reader = std::thread::spawn(move || receiver.iter().all(|message| filled.sender.send(message).is_ok()));
    let connection = Connection { sender, receiver: queue.receiver };
    let served = serve(&connection);
    // The threads end when the channels to them do.
    drop(connection);
    threads.join()?;
    // Messages behind the last that `serve` took are for nobody.
    let _ = reader.join();
    served
}
