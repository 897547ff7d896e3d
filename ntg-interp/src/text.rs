//! Parameters set by text, as a person writes them: `0.2`, `200 [m/s]`, `200 m/s`, `-100, -97 [km]`.

use ntg_compiler::diagnostic::{Code, Diagnostic};
use ntg_compiler::source::Source;
use ntg_structure::Unit;

use crate::Interpreted;

impl Interpreted {
    /// Sets a parameter, all members of an array (`a`, `1, 2, 3`), or one member (`a[2]`, `1`); numbers without a
    /// unit are in the declared one.
    ///
    /// # Errors
    /// In words: unknown names, values that cannot be read, units that do not fit.
    pub fn assign(&mut self, target_text: &str, text: &str) -> Result<(), String> {
        let (name, index) = target(target_text.trim())?;
        let unit = self.structure.parameters.iter().find(|p| p.name == name).map(|p| p.unit.clone());
        let values = quantity(text, &unit.unwrap_or_default())?;
        let done = match (index, values.as_slice()) {
            (None, values) => self.set(name, values),
            (Some(index), [value]) => self.set_member(name, index, *value),
            (Some(index), values) => {
                return Err(format!("`{name}[{index}]` takes one value, but {} are given", values.len()));
            }
        };
        done.map_err(|error| error.to_string())
    }
}

/// `name` or `name[index]`.
///
/// # Errors
/// In words: an index that is no whole number in brackets.
pub fn target(target: &str) -> Result<(&str, Option<i64>), String> {
    let Some((name, rest)) = target.split_once('[') else { return Ok((target, None)) };
    let index = rest.strip_suffix(']').and_then(|i| i.trim().parse().ok());
    let index =
        index.ok_or_else(|| format!("`{target}`: the index is a whole number in brackets, as in `{name}[2]`"))?;
    Ok((name.trim(), Some(index)))
}

/// Values in SI units; numbers without a unit are in `unit`.
///
/// # Errors
/// In words: what cannot be read, units that do not fit.
pub fn quantity(text: &str, unit: &Unit) -> Result<Vec<f64>, String> {
    if text.trim().is_empty() {
        return Err("no value is given".to_owned());
    }
    let source = Source::new("the command line", bracketed(text));
    ntg_compiler::model::given(&source, unit).map_err(|found| {
        if found.iter().any(|finding| finding.code == Code::UnknownName) {
            let unit = if unit.symbol.is_empty() { "1" } else { &unit.symbol };
            return format!("write a number, alone or with a unit such as `1 [{unit}]`");
        }
        let one = |finding: &Diagnostic| match &finding.help {
            Some(help) => format!("{}; {help}", finding.message),
            None => finding.message.clone(),
        };
        format!("`{}`: {}", text.trim(), found.iter().map(one).collect::<Vec<_>>().join("; "))
    })
}

/// `240 m/s` and `240m/s` as the language writes them: `240 [m/s]`.
pub fn bracketed(text: &str) -> String {
    let trimmed = text.trim();
    // The longest beginning that is a number: `1e3m` is a thousand metres.
    let cuts = trimmed.char_indices().map(|(at, _)| at).rev();
    let number = cuts.map(|at| trimmed.split_at(at)).find(|(number, _)| number.trim_end().parse::<f64>().is_ok());
    match number.map(|(number, unit)| (number.trim_end(), unit.trim_start())) {
        Some((number, unit)) if unit.starts_with(char::is_alphabetic) => format!("{number} [{unit}]"),
        _ => text.to_owned(),
    }
}
