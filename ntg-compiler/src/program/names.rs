//! Readable, distinct names for kernels and their inputs.

use std::collections::HashSet;

/// Hands out names, none twice.
#[derive(Clone, Debug, Default)]
pub(super) struct Names {
    taken: HashSet<String>, // Asked, never iterated.
}

impl Names {
    /// `wish`, or `wish` with the first free number behind it.
    pub(super) fn distinct(&mut self, wish: &str) -> String {
        let mut name = wish.to_owned();
        let mut count = 1;
        while !self.taken.insert(name.clone()) {
            count += 1;
            name = format!("{wish}_{count}");
        }
        name
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
