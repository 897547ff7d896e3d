//! Readable, distinct names for kernels and their inputs.

use std::collections::{HashMap, HashSet};

/// Hands out names, none twice.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>, // Asked, never iterated.
    /// The last number behind each wish; up to there all are taken.
    last: HashMap<String, usize>, // Looked up, never iterated.
}

impl Names {
    /// `wish`, or `wish` with the first free number behind it.
    pub(super) fn distinct(&mut self, wish: &str) -> String {
        if self.taken.insert(wish.to_owned()) {
            return wish.to_owned();
        }
        let count = self.last.entry(wish.to_owned()).or_insert(1);
        loop {
            *count += 1;
            let name = format!("{wish}_{count}");
            if self.taken.insert(name.clone()) {
                return name;
            }
        }
    }
}

/// A name that is legal in Rust: letters, digits and underscores, beginning with a letter.
pub(super) fn identifier(text: &str) -> String {
    let mut name: String = text.chars().map(|c| if unicode_ident::is_xid_continue(c) { c } else { '_' }).collect();
    if !name.chars().next().is_some_and(unicode_ident::is_xid_start) {
        name.insert(0, 'n');
    }
    name
}
