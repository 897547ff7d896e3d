//! A file that is not there: the path that was tried.
ntg::ntg_file!("/nowhere/absent.ntg");

fn main() {}
