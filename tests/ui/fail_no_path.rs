//! Something other than a path.
ntg::ntg_file!(specs / van_der_pol);

fn main() {}
