//! Constants set from outside: unknown names, wrong units, what is no number and what cannot be read.
ntg::ntg_file!("ui/chain.ntg", lnks = 50);
ntg::ntg_file!("ui/chain.ntg", mass = 3 [kg]);
ntg::ntg_file!("ui/chain.ntg", goal = 3 [m]);
ntg::ntg_file!("ui/chain.ntg", x = 3);
ntg::ntg_file!("ui/chain.ntg", gravity = 3.7 [kg]);
ntg::ntg_file!("ui/chain.ntg", gravity = 3.7 [parsec]);
ntg::ntg_file!("ui/chain.ntg", links = "fifty");
ntg::ntg_file!("ui/chain.ntg", links = fifty);
ntg::ntg_file!("ui/chain.ntg", links = 2.5);
ntg::ntg_file!("ui/chain.ntg", links = 1 / 0);
ntg::ntg_file!("ui/chain.ntg", links = 2 +);
ntg::ntg_file!("ui/chain.ntg", links = (2, 3));
ntg::ntg_file!("ui/chain.ntg", links = 3, links = 4);

fn main() {}
