//! The header: C99 and C++, every name with its unit and its words from the spec.

use std::fmt::Write;

use ntg_c::Code;
use ntg_structure::Structure;

use super::names::{Member, Readings};

/// What a header is made of.
pub(super) struct Header<'a> {
    pub(super) name: &'a str,
    pub(super) structure: &'a Structure,
    pub(super) parameters: &'a [Member],
    pub(super) readings: &'a Readings,
    pub(super) source: &'a str,
}

/// The parts that are the same for all problems.
const TEMPLATE: &str = include_str!("template/header.h");

impl Header<'_> {
    /// The whole text.
    pub(super) fn text(&self) -> String {
        let upper = self.name.to_ascii_uppercase();
        let text = TEMPLATE
            .replace("@DOC@", &self.doc())
            .replace("@MEMBERS@", self.members().trim_end())
            .replace("@DEFAULTS@", &self.defaults())
            .replace("@READINGS@", self.constants().trim_end())
            .replace("@COUNT@", &self.readings.all.len().to_string())
            .replace("@STATUSES@", statuses(&upper).trim_end())
            .replace("@OBJECTIVE@", &unit(&self.structure.objective_unit.symbol))
            .replace("@VERSION@", env!("CARGO_PKG_VERSION"))
            .replace("@SOURCE@", &in_comment(self.source))
            .replace("@PROBLEM@", &in_comment(&self.structure.name));
        text.replace("@NAME@", self.name).replace("@UPPER@", &upper)
    }

    /// The problem's own words, as lines of a comment.
    fn doc(&self) -> String {
        let lines = self.structure.doc.lines().map(|line| format!(" * {}", in_comment(line)).trim_end().to_owned());
        lines.map(|line| line + "\n").collect()
    }

    fn members(&self) -> String {
        let mut text = String::new();
        for member in self.parameters {
            let length = member.length.map_or_else(String::new, |length| format!("[{length}]"));
            let words = described(&member.doc, &unit(&member.unit.symbol));
            let _ = writeln!(text, "    /** {words} */\n    double {}{length};", member.name);
        }
        if self.parameters.is_empty() {
            text.push_str("    /** The problem has no parameters. */\n    double none;\n");
        }
        text
    }

    /// The defaults as an initialiser.
    fn defaults(&self) -> String {
        let numbers = |values: &[f64]| values.iter().map(|value| format!("{value:?}")).collect::<Vec<_>>().join(", ");
        let member = |member: &Member| match member.length {
            Some(_) => format!("{{{}}}", numbers(&member.defaults)),
            None => numbers(&member.defaults),
        };
        let all: Vec<String> =
            self.parameters.iter().map(|m| format!("{} /* {} */", member(m), in_comment(&m.of))).collect();
        if all.is_empty() { "0.0".to_owned() } else { all.join(", \\\n    ") }
    }

    fn constants(&self) -> String {
        let mut text = String::new();
        for (number, constant) in self.readings.all.iter().enumerate() {
            let kind = match (constant.is_output, constant.is_function) {
                (true, _) => "output, with derivatives",
                (_, true) => "function of time",
                _ => "the same at all times",
            };
            let words = described(&constant.doc, &format!("{}, {kind}", unit(&constant.unit.symbol)));
            let path = in_comment(&constant.of);
            let _ = writeln!(text, "    /** `{path}`. {words} */\n    {} = {number},", constant.name);
        }
        // A comma after the last constant is not C++98's, but C99's and C++11's.
        text
    }
}

fn statuses(upper: &str) -> String {
    let mut text = String::new();
    for code in Code::ALL {
        let words = code.text().to_string_lossy();
        let _ = writeln!(text, "    /** {}. */\n    {upper}_{} = {},", capital(&words), code.name(), code as i32);
    }
    text
}

/// The spec's words and the unit, as one line or several.
fn described(doc: &str, unit: &str) -> String {
    let doc: Vec<&str> = doc.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    let unit = capital(unit);
    match doc.is_empty() {
        true => format!("{unit}."),
        false => format!("{} {unit}.", in_comment(&doc.join("\n     *  "))),
    }
}

fn unit(symbol: &str) -> String {
    if symbol.is_empty() || symbol == "1" { "a pure number".to_owned() } else { format!("in {}", in_comment(symbol)) }
}

fn capital(words: &str) -> String {
    let mut letters = words.chars();
    letters.next().map_or_else(String::new, |first| first.to_uppercase().chain(letters).collect())
}

/// Text that neither ends a comment, nor begins one, nor is a trigraph, nor joins lines.
pub(super) fn in_comment(text: &str) -> String {
    text.replace("*/", "* /").replace("/*", "/ *").replace("??", "? ?").replace('\\', "/")
}
