//! The manual's entries, so that every tool can say more about a code.

use super::Code;

/// docs/errors.md, as it was when the compiler was built.
const MANUAL: &str = include_str!("../../errors.md");

impl Code {
    /// The entry of docs/errors.md, from its heading on, without a line break at its end.
    pub fn manual(self) -> &'static str {
        let heading = format!("## {} ", self.text());
        let Some(start) = MANUAL.find(&heading) else { return self.title() };
        let rest = &MANUAL[start..];
        let end = rest[heading.len()..].find("\n## ").map_or(rest.len(), |end| heading.len() + end);
        rest[..end].trim_end()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_code_has_an_entry_of_its_own_with_its_title() {
        for code in Code::ALL {
            let entry = code.manual();
            assert_eq!(entry.lines().next(), Some(format!("## {code} {}", code.title()).as_str()));
            assert!(entry.lines().count() > 2 && entry.matches("\n## ").count() == 0, "{entry}");
        }
    }
}
