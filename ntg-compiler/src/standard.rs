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

/// The names of all libraries, sorted.
pub fn names() -> Vec<&'static str> {
    LIBRARIES.iter().map(|(name, _)| *name).collect()
}
