//! Constants that are not written as `name = value`.
ntg::ntg_file!("ui/chain.ntg", links);
ntg::ntg_file!("ui/chain.ntg", links =);
ntg::ntg_file!("ui/chain.ntg", links: 3);
ntg::ntg_file!("ui/chain.ntg", 3);
ntg::ntg_file!("ui/chain.ntg" links = 3);
ntg::ntg_file!("ui/chain.ntg", links = 3 gravity = 4);

fn main() {}
