//! ntg.
