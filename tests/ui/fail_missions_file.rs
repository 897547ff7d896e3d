//! Mistakes about missions in files: path, line, column and picture.
ntg::ntg_file!("ui/circle.ntg");
ntg::ntg_file!("ui/paths.ntg");

fn main() {}
