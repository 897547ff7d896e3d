//! Reads .sol files: a solver's words, multipliers and point.
//!
//! ```text
//! words ...
//! (blank)
//! Options
//! 3, three numbers (or more)
//! rows, multipliers given, variables, values given
//! multipliers, values, one a line
//! objno 0 CODE
//! suffix KIND, how many, length of its name, length of its table, lines of its table
//! the name, the table, a place and a value on each line
//! ```
//!
//! The last two are left out or repeated as a solver likes, and read past.

use super::Order;
use std::fmt;

/// What a solver has found, in the order of the transcription.
#[derive(Clone, Debug, PartialEq)]
pub struct Solution {
    /// What the solver says.
    pub message: String,
    /// The point.
    pub x: Vec<f64>,
    /// Multipliers of the rows, where the file has them: `d(objective) / d(bound)`, the objective in the user's sense.
    pub multipliers: Option<Vec<f64>>,
}

/// Why a file is no solution of a program.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SolutionError {
    /// A line, from 1, where something else is expected.
    Line(usize, &'static str),
    /// The file has another number of something than the program.
    Count {
        /// Of what.
        what: &'static str,
        /// In the file.
        found: usize,
        /// In the program.
        expected: usize,
    },
}

impl fmt::Display for SolutionError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(line, expected) => write!(f, "line {line}: {expected} is expected"),
            Self::Count { what, found, expected } => {
                write!(f, "it has {found} {what}, but the program has {expected}; it belongs to another program")
            }
        }
    }
}

impl std::error::Error for SolutionError {}

impl Solution {
    /// Reads the text of a file that answers to a program in this order.
    ///
    /// # Errors
    /// What is not as it should be.
    pub fn read(text: &str, order: &Order) -> Result<Self, SolutionError> {
        let mut lines = Lines { lines: text.lines().enumerate().collect(), next: 0 };
        let mut message = vec![];
        loop {
            match lines.take("the line `Options`")?.trim() {
                "Options" => break,
                words => message.push(words.to_owned()),
            }
        }
        let options: usize = lines.number("the number of options")?;
        for _ in 0..options {
            lines.take("an option")?;
        }
        // Options of which the second is 3 are followed by a tolerance, which four numbers of counts cannot be taken for.
        let (rows, mut given, variables, mut values): (usize, usize, usize, usize) = (
            lines.number("the number of rows")?,
            lines.number("the number of multipliers")?,
            lines.number("the number of variables")?,
            lines.number("the number of values")?,
        );
        let same = |what, found, expected| {
            if found == expected { Ok(()) } else { Err(SolutionError::Count { what, found, expected }) }
        };
        same("rows", rows, order.rows.len())?;
        same("variables", variables, order.variables.len())?;
        same("values", values, order.variables.len())?;
        let mut column = |count: &mut usize| -> Result<Vec<f64>, SolutionError> {
            (0..std::mem::take(count)).map(|_| lines.number("a number")).collect()
        };
        let (multipliers, x) = (column(&mut given)?, column(&mut values)?);
        lines.rest()?;
        let has_multipliers = multipliers.len() == rows && rows > 0;
        Ok(Self {
            message: message.join("\n").trim().to_owned(),
            x: Order::to_own(&order.variables, &x),
            multipliers: has_multipliers.then(|| Order::to_own(&order.rows, &multipliers)),
        })
    }

    /// The text of a .sol file, for a program in this order.
    pub fn text(&self, order: &Order) -> String {
        let multipliers = self.multipliers.as_deref().unwrap_or_default();
        let sorted = |places: &[usize], values: &[f64]| -> Vec<f64> {
            places.iter().filter_map(|p| values.get(*p).copied()).collect()
        };
        let (y, x) = (sorted(&order.rows, multipliers), sorted(&order.variables, &self.x));
        let counts = [order.rows.len(), y.len(), order.variables.len(), x.len()];
        let mut lines =
            vec![self.message.clone(), String::new(), "Options".into(), "3".into(), "1".into(), "1".into(), "0".into()];
        lines.extend(counts.iter().map(usize::to_string));
        lines.extend(y.iter().chain(&x).map(|value| format!("{value:?}")));
        lines.join("\n") + "\nobjno 0 0\n"
    }
}

struct Lines<'a> {
    lines: Vec<(usize, &'a str)>,
    next: usize,
}

impl<'a> Lines<'a> {
    fn take(&mut self, expected: &'static str) -> Result<&'a str, SolutionError> {
        let line = self.lines.get(self.next).map(|(_, line)| *line);
        self.next += 1;
        line.ok_or(SolutionError::Line(self.next, expected))
    }

    /// Reads past what stands behind the values.
    fn rest(&mut self) -> Result<(), SolutionError> {
        const EXPECTED: &str = "`objno`, a suffix or the end";
        while self.next < self.lines.len() {
            let words: Vec<&str> = self.take(EXPECTED)?.split_whitespace().collect();
            let is_number = |word: &&str| word.parse::<i64>().is_ok();
            match words[..] {
                [] => {}
                ["objno", ref numbers @ ..] if matches!(numbers.len(), 1 | 2) && numbers.iter().all(is_number) => {}
                ["suffix", _, values, _, _, table] => {
                    let count =
                        |word: &str| word.parse::<usize>().map_err(|_| SolutionError::Line(self.next, EXPECTED));
                    let (values, table) = (count(values)?, count(table)?);
                    for _ in 0..=table {
                        self.take("the name of a suffix and its table")?;
                    }
                    (0..values).try_for_each(|_| self.place_and_value())?;
                }
                _ => return Err(SolutionError::Line(self.next, EXPECTED)),
            }
        }
        Ok(())
    }

    /// Reads past one value of a suffix.
    fn place_and_value(&mut self) -> Result<(), SolutionError> {
        const EXPECTED: &str = "a place and a value of a suffix";
        let mut words = self.take(EXPECTED)?.split_whitespace();
        let place = words.next().is_some_and(|word| word.parse::<usize>().is_ok());
        let value = words.next().is_some_and(|word| word.parse::<f64>().is_ok());
        if place && value && words.next().is_none() { Ok(()) } else { Err(SolutionError::Line(self.next, EXPECTED)) }
    }

    fn number<T: std::str::FromStr>(&mut self, expected: &'static str) -> Result<T, SolutionError> {
        let text = self.take(expected)?;
        text.trim().parse().map_err(|_| SolutionError::Line(self.next, expected))
    }
}
