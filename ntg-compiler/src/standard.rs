//! The libraries of the language: texts inside the compiler.
//!
//! They are only ever extended: a name that is there stays, with its meaning.

/// Every library, by its name.
const LIBRARIES: &[(&str, &str)] = &[
    ("std::aero", include_str!("standard/aero.ntg")),
    ("std::atmosphere", include_str!("standard/atmosphere.ntg")),
    ("std::constants", include_str!("standard/constants.ntg")),
    ("std::gravity", include_str!("standard/gravity.ntg")),
    ("std::orbit", include_str!("standard/orbit.ntg")),
    ("std::rotation", include_str!("standard/rotation.ntg")),
];

/// The text of a library, `std::rotation`.
pub fn library(name: &str) -> Option<&'static str> {
    LIBRARIES.iter().find(|(own, _)| *own == name).map(|(_, text)| *text)
}

/// The words that declare what stands as a value, and what is applied.
pub const VALUES: &[&str] = &["const "];
/// See [`VALUES`].
pub const APPLIED: &[&str] = &["fn ", "table "];

/// The library in which one of these words declares a name, and the name there: the same words in any order,
/// `earth_radius` for `radius_earth`.
pub fn holder(name: &str, kinds: &[&str]) -> Option<(&'static str, &'static str)> {
    let words = |name: &'static str| name.split('_').collect::<std::collections::BTreeSet<_>>();
    let wanted: std::collections::BTreeSet<&str> = name.split('_').collect();
    let declared = |line: &'static str| {
        let rest = kinds.iter().find_map(|kind| line.strip_prefix(kind))?;
        rest.split(|c: char| !c.is_alphanumeric() && c != '_').next()
    };
    let all = || {
        LIBRARIES.iter().flat_map(|(library, text)| text.lines().filter_map(declared).map(move |own| (*library, own)))
    };
    all().find(|(_, own)| *own == name).or_else(|| all().find(|(_, own)| words(own) == wanted))
}

/// The names of all libraries, sorted.
pub fn names() -> Vec<&'static str> {
    LIBRARIES.iter().map(|(name, _)| *name).collect()
}
