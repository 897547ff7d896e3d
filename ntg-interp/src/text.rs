//! Parameters set by text, as a person writes them: `0.2`, `200 [m/s]`, `200 m/s`, `-100, -97 [km]`.

use ntg_compiler::diagnostic::{Code, Diagnostic};
use ntg_compiler::source::Source;
use ntg_structure::Unit;

use crate::Interpreted;

impl Interpreted {
    /// Sets a parameter, all members of an array (`a`, `1, 2, 3`), or one member (`a[2]`, `1`; of a matrix `A[1, 2]`); numbers without a
    /// unit are in the declared one.
    ///
    /// # Errors
    /// In words: unknown names, values that cannot be read, units that do not fit.
    pub fn assign(&mut self, target_text: &str, text: &str) -> Result<(), String> {
        let (name, indices) = target(target_text.trim())?;
        let unit = self.structure.parameters.iter().find(|p| p.name == name).map(|p| p.unit.clone());
        let values = quantity(text, &unit.unwrap_or_default())?;
        let done = match (indices.as_slice(), values.as_slice()) {
            ([], values) => self.set(name, values),
            (indices, [value]) => self.set_member(name, indices, *value),
            (indices, values) => {
                return Err(format!("`{name}{}` takes one value, but {} are given", written(indices), values.len()));
            }
        };
        done.map_err(|error| error.to_string())
    }
}

/// `name`, `name[index]` or `name[row, column]`: the name and its indices.
///
/// # Errors
/// In words: an index that is no whole number in brackets.
pub fn target(target: &str) -> Result<(&str, Vec<i64>), String> {
    let Some((name, rest)) = target.split_once('[') else { return Ok((target, vec![])) };
    let indices = rest.strip_suffix(']').map(|inside| inside.split(',').map(|i| i.trim().parse().ok()).collect());
    let indices: Option<Vec<i64>> = indices.flatten();
    let message = || {
        let name = name.trim();
        format!("`{target}`: an index is a whole number in brackets, as in `{name}[2]`, of a matrix `{name}[2, 1]`")
    };
    Ok((name.trim(), indices.ok_or_else(message)?))
}

/// Indices as the language writes them: `[2]`, `[2, 1]`.
pub(crate) fn written(indices: &[i64]) -> String {
    let numbers: Vec<String> = indices.iter().map(i64::to_string).collect();
    format!("[{}]", numbers.join(", "))
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
    if let Some(number) = as_written(trimmed) {
        return number;
    }
    // The longest beginning that is a number: `1e3m` is a thousand metres.
    let cuts = trimmed.char_indices().map(|(at, _)| at).rev();
    let number = cuts.map(|at| trimmed.split_at(at)).find_map(|(number, unit)| Some((as_written(number)?, unit)));
    match number.map(|(number, unit)| (number, unit.trim_start())) {
        Some((number, unit)) if unit.starts_with(char::is_alphabetic) => format!("{number} [{unit}]"),
        Some((number, unit)) if unit.starts_with('[') => format!("{number} {unit}"),
        _ => text.to_owned(),
    }
}

/// A number as the language writes it, which has no `+3`, `.5` or `2.`; none of what is no number.
fn as_written(text: &str) -> Option<String> {
    let text = text.trim();
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite())?;
    let digits = text.strip_prefix('-').unwrap_or(text);
    let bare = |(at, c): (usize, char)| c == '.' && !digits[at + 1..].starts_with(|c: char| c.is_ascii_digit());
    let plain = digits.starts_with(|c: char| c.is_ascii_digit()) && !digits.char_indices().any(bare);
    Some(if plain { text.to_owned() } else { format!("{number:?}") })
}

#[cfg(test)]
mod tests {
    use super::bracketed;

    /// Whatever Rust reads as a number is one, and the language reads what is made of it.
    #[test]
    fn numbers_in_all_forms_are_numbers() {
        for text in ["1e8", "1E8", "1e+8", "2.5e8", "1e-3", "1e08", "-1e-3", "0", "-7", "100000000", "1e308"] {
            assert_eq!(bracketed(text), text);
        }
        let unwritten = [("+3", "3.0"), (".5", "0.5"), ("2.", "2.0"), ("-.5e-3", "-0.0005"), ("+1e8", "100000000.0")];
        for (text, written) in unwritten {
            assert_eq!(bracketed(text), written);
        }
    }

    #[test]
    fn what_follows_a_number_is_its_unit() {
        for (text, written) in [
            ("240 m/s", "240 [m/s]"),
            ("1e3m", "1e3 [m]"),
            ("1e-3 m", "1e-3 [m]"),
            ("1eV", "1 [eV]"),
            ("2e3eV", "2e3 [eV]"),
            (".5 [km]", "0.5 [km]"),
            ("1, 2, 3", "1, 2, 3"),
            ("inf", "inf"),
            ("m", "m"),
        ] {
            assert_eq!(bracketed(text), written);
        }
    }
}
