//! The table of codes: one line each, with its number and its one-line title.
//!
//! | numbers     | about                                                    |
//! |-------------|----------------------------------------------------------|
//! | E001 - E019 | syntax                                                   |
//! | E020 - E039 | names and declarations                                   |
//! | E040 - E049 | units and dimensions                                     |
//! | E050 - E069 | meaning: time, scopes, orders, bounds                    |
//! | E070 - E079 | tables                                                   |
//! | E080 - E089 | families, phases, agents                                 |
//! | E090 -      | limits                                                   |
//! | N001 -      | notes: jumping gradients, fit reports                    |
//!
//! A number, once given, keeps its meaning. Each code has an entry in docs/errors.md.

use super::Severity;

/// Makes the enum and its table; adding a code is adding one line.
macro_rules! codes {
    ($($variant:ident $number:literal $title:literal;)*) => {
        /// Which kind of finding; its text (`E013`) is stable, its entry is in docs/errors.md.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Code {
            $(#[doc = concat!($number, ": ", $title, ".")] $variant,)*
        }

        impl Code {
            /// Every code, in the table's order.
            pub const ALL: &[Self] = &[$(Self::$variant,)*];

            /// The stable text, `E001`.
            pub const fn text(self) -> &'static str {
                match self {
                    $(Self::$variant => $number,)*
                }
            }

            /// What the code stands for, in one line.
            pub const fn title(self) -> &'static str {
                match self {
                    $(Self::$variant => $title,)*
                }
            }
        }
    };
}

codes! {
    Unexpected "E001" "something else was expected here";
    MissingSemicolon "E002" "a statement without its `;`";
    Unclosed "E003" "a bracket, comment or string that is never closed";
    Unopened "E004" "a closing bracket that closes nothing";
    TooDeep "E005" "brackets nested too deeply";
    MalformedNumber "E006" "a number that is not written as numbers are";
    NumberTooLarge "E007" "a number beyond the largest that can be held";
    UnknownCharacter "E008" "a character that the language does not use";
    MalformedString "E009" "a string that would not survive inline";
    Comment "E010" "a comment of a kind that is refused, or one that documents nothing";
    MalformedName "E011" "a word that cannot be a name";
    ReservedWord "E012" "a reserved word used as a name";
    WrongRelation "E013" "a relation other than `==`, `<=`, `>=`";
    MixedChain "E014" "a chain of relations that is no double bound";
    RangeOperator "E015" "a range written otherwise than `first .. last`";
    Setting "E016" "a setting that is unknown, given twice or not taken here";
    Misplaced "E017" "something that may not stand here";
    MalformedUnit "E018" "a unit that is not written as units are";
    OneProblem "E019" "a spec is exactly one problem";

    SourceTooLarge "E090" "a spec too large to be read";
}

impl Code {
    /// Errors have an `E`, warnings a `W`, notes an `N`.
    pub const fn severity(self) -> Severity {
        match self.text().as_bytes()[0] {
            b'N' => Severity::Note,
            b'W' => Severity::Warning,
            _ => Severity::Error,
        }
    }
}

impl std::fmt::Display for Code {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(self.text())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_unique_well_formed_and_rising() {
        let texts: Vec<&str> = Code::ALL.iter().map(|code| code.text()).collect();
        for text in &texts {
            assert!(
                matches!(text.as_bytes(), [b'E' | b'W' | b'N', d @ ..] if d.len() == 3 && d.iter().all(u8::is_ascii_digit))
            );
        }
        // Errors before notes, each kind in rising order: a number given twice would show here.
        let key = |text: &str| (text.starts_with('N'), text.starts_with('W'), text.to_owned());
        assert!(texts.windows(2).all(|pair| key(pair[0]) < key(pair[1])), "{texts:?}");
    }
}
