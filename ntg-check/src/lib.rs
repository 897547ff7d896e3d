//! Checks certificates.
