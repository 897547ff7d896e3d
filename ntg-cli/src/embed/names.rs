//! Names of a spec as names of C.
//!
//! Takes names in any letters; gives identifiers of C99 and C++ that no two things share.

use std::collections::BTreeSet;

use ntg_c::readings::Reading;
use ntg_compiler::codegen::in_unit;
use ntg_structure::{Parameter, Structure, Unit};

/// Words that C99, C++20 and their compilers keep for themselves, and that names of parameters could meet.
const KEPT: [&str; 107] = [
    "NULL",
    "alignas",
    "alignof",
    "and",
    "and_eq",
    "asm",
    "auto",
    "bitand",
    "bitor",
    "bool",
    "break",
    "case",
    "catch",
    "char",
    "char16_t",
    "char32_t",
    "char8_t",
    "class",
    "co_await",
    "co_return",
    "co_yield",
    "compl",
    "concept",
    "const",
    "const_cast",
    "consteval",
    "constexpr",
    "constinit",
    "continue",
    "decltype",
    "default",
    "delete",
    "do",
    "double",
    "dynamic_cast",
    "else",
    "enum",
    "explicit",
    "export",
    "extern",
    "false",
    "far",
    "float",
    "for",
    "friend",
    "goto",
    "if",
    "inline",
    "int",
    "interface",
    "linux",
    "long",
    "mutable",
    "namespace",
    "near",
    "new",
    "noexcept",
    "not",
    "not_eq",
    "nullptr",
    "operator",
    "or",
    "or_eq",
    "private",
    "protected",
    "public",
    "register",
    "reinterpret_cast",
    "requires",
    "restrict",
    "return",
    "short",
    "signed",
    "sizeof",
    "small",
    "static",
    "static_assert",
    "static_cast",
    "struct",
    "switch",
    "template",
    "this",
    "thread_local",
    "throw",
    "true",
    "try",
    "typedef",
    "typeid",
    "typename",
    "typeof",
    "union",
    "unix",
    "unsigned",
    "using",
    "virtual",
    "void",
    "volatile",
    "wchar_t",
    "while",
    "xor",
    "xor_eq",
    "_Bool",
    "_Complex",
    "_Imaginary",
    "final",
    "override",
    "errno",
];
/// Names of libraries that a library of ours would hide, and of crates that the crate itself needs.
const TAKEN: [&str; 14] =
    ["c", "m", "dl", "rt", "util", "pthread", "gcc", "ntg", "ntg_c", "std", "core", "alloc", "test", "proc_macro"];

/// The name with which every name of C begins.
pub(super) fn prefix(wanted: Option<&str>, problem: &str) -> Result<String, String> {
    let name = wanted.map_or_else(|| snake(problem), str::to_owned);
    let is_plain = name.chars().all(|c| c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_')
        && name.starts_with(|c: char| c.is_ascii_lowercase());
    if !is_plain {
        return Err(format!(
            "--name `{name}`: small letters, digits and `_` that begin with a letter, such as `flight`"
        ));
    }
    if TAKEN.contains(&name.as_str()) || KEPT.contains(&name.as_str()) {
        return Err(format!("a library named `{name}` would hide another one; give another name by --name"));
    }
    Ok(name)
}

/// `LowObservable` becomes `low_observable`, `UAV2Path` becomes `uav2_path`.
fn snake(name: &str) -> String {
    let letters: Vec<char> = ascii(name).chars().collect();
    let mut snake = String::new();
    for (i, letter) in letters.iter().enumerate() {
        let before = i.checked_sub(1).map(|i| letters[i]);
        let ends_run = letters.get(i + 1).is_some_and(char::is_ascii_lowercase);
        let begins = before.is_some_and(|before| before != '_' && (!before.is_ascii_uppercase() || ends_run));
        if letter.is_ascii_uppercase() && begins {
            snake.push('_');
        }
        snake.push(letter.to_ascii_lowercase());
    }
    snake
}

/// A name in the letters of C: `uav[2].x` becomes `uav_2_x`, `p[2, 1]` becomes `p_2_1`, a letter that is not ASCII its number.
fn ascii(name: &str) -> String {
    let mut plain = String::new();
    for c in name.chars() {
        match c {
            c if c.is_ascii_alphanumeric() || c == '_' => plain.push(c),
            '[' | '.' | '(' | ',' => plain.push('_'),
            c if c.is_ascii() => {}
            c => plain.push_str(&format!("u{:04x}", u32::from(c))),
        }
    }
    if plain.starts_with(|c: char| c.is_ascii_digit()) {
        plain.insert(0, 'n');
    }
    plain
}

/// A parameter as a member of the struct of C.
pub(super) struct Member {
    pub(super) name: String,
    /// The name in the spec.
    pub(super) of: String,
    pub(super) doc: String,
    pub(super) unit: Unit,
    /// How many numbers, if it is an array.
    pub(super) length: Option<usize>,
    /// Defaults in the declared unit.
    pub(super) defaults: Vec<f64>,
}

/// All parameters as members.
pub(super) fn parameters(structure: &Structure) -> Vec<Member> {
    let mut taken: BTreeSet<String> = KEPT.iter().map(|word| (*word).to_owned()).collect();
    let member = |parameter: &Parameter| Member {
        name: free(ascii(&parameter.name), &mut taken),
        of: parameter.name.clone(),
        doc: parameter.doc.clone(),
        unit: parameter.unit.clone(),
        length: parameter.array.then_some(parameter.value.len()),
        defaults: parameter.value.iter().map(|si| in_unit(*si, &parameter.unit)).collect(),
    };
    structure.parameters.iter().map(member).collect()
}

/// Something that can be read, as a constant of C.
pub(super) struct Constant {
    pub(super) name: String,
    /// The path in the spec.
    pub(super) of: String,
    pub(super) doc: String,
    pub(super) unit: Unit,
    pub(super) is_output: bool,
    pub(super) is_function: bool,
}

/// Everything that can be read, by number.
pub(super) struct Readings {
    pub(super) all: Vec<Constant>,
}

impl Readings {
    pub(super) fn new(prefix: &str, readings: &[Reading<'_>]) -> Self {
        let upper = prefix.to_ascii_uppercase();
        // The names of statuses and of the macro with the defaults.
        let statuses = ntg_c::Code::ALL.iter().map(|code| code.name());
        let mut taken: BTreeSet<String> =
            statuses.chain(["DEFAULTS", "READINGS", "H"]).map(|name| format!("{upper}_{name}")).collect();
        let constant = |reading: &Reading<'_>| Constant {
            name: free(format!("{upper}_{}", ascii(&reading.name)), &mut taken),
            of: reading.name.clone(),
            doc: reading.doc.clone(),
            unit: reading.unit.clone(),
            is_output: reading.is_output(),
            is_function: reading.is_function(),
        };
        Self { all: readings.iter().map(constant).collect() }
    }

    /// The reading with a name of the spec.
    pub(super) fn find(&self, name: &str) -> Option<&Constant> {
        self.all.iter().find(|constant| constant.of == name)
    }
}

/// A name that is not taken yet, with as many `_` after it as make it so.
fn free(mut name: String, taken: &mut BTreeSet<String>) -> String {
    while !taken.insert(name.clone()) {
        name.push('_');
    }
    name
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_identifiers_of_c_and_readable() {
        for (name, wanted) in
            [("LowObservable", "low_observable"), ("UAV2Path", "uav2_path"), ("NLP", "nlp"), ("a_B", "a_b")]
        {
            assert_eq!(snake(name), wanted);
        }
        assert_eq!(ascii("uav[2].x"), "uav_2_x");
        assert_eq!(ascii("p[2, 1]"), "p_2_1");
        assert_eq!(ascii("start(covert)"), "start_covert");
        assert_eq!(ascii("θ"), "u03b8");
    }

    #[test]
    fn names_that_mean_something_else_are_refused() {
        for name in ["m", "Flight", "2x", "double", "ntg", "a-b", ""] {
            assert!(prefix(Some(name), "P").is_err(), "{name}");
        }
        assert_eq!(prefix(None, "Landing"), Ok("landing".to_owned()));
    }
}
