//! Mistakes in a file: the messages carry path, line, column and a picture.
ntg::ntg_file!("ui/broken.ntg");

fn main() {}
