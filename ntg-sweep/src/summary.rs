//! What a study's rows say together: how many are solved, quantiles of numbers, which limits bind.

use std::collections::BTreeMap;
use std::fmt;

use crate::table::Table;

/// The quantiles that are shown, in percent.
const SHOWN: [f64; 5] = [0.0, 5.0, 50.0, 95.0, 100.0];

/// What the rows of a table say together.
#[derive(Clone, Debug, PartialEq)]
pub struct Summary {
    /// How many rows ended with each status, the most frequent first.
    pub statuses: Vec<(String, usize)>,
    /// In how many solved rows each limit binds, the most frequent first.
    pub binding: Vec<(String, usize)>,
    /// Every column of numbers over the solved rows.
    pub columns: Vec<Spread>,
}

/// A column of numbers.
#[derive(Clone, Debug, PartialEq)]
pub struct Spread {
    /// Its name.
    pub name: String,
    /// Its finite numbers in solved rows, by size.
    pub values: Vec<f64>,
}

impl Spread {
    /// The value below which lie `percent` of all, between two values in proportion (definition 7 of R. J. Hyndman and
    /// Y. Fan, "Sample quantiles in statistical packages", The American Statistician 50, 361 (1996)); NaN without values.
    pub fn quantile(&self, percent: f64) -> f64 {
        let Some(last) = self.values.len().checked_sub(1) else { return f64::NAN };
        let place = (percent / 100.0).clamp(0.0, 1.0) * last as f64;
        let below = self.values[place.floor() as usize];
        let above = self.values[place.ceil() as usize];
        below + (above - below) * place.fract()
    }
}

impl Summary {
    /// The summary of a table that `ntg sweep` has written.
    ///
    /// # Errors
    /// In words: a table without a column `status`.
    pub fn of(table: &Table) -> Result<Self, String> {
        let column = |name: &str| table.names.iter().position(|known| known == name);
        let status = column("status").ok_or("there is no column `status`: this is no table of `ntg sweep`")?;
        let solved: Vec<&Vec<String>> = table.rows.iter().filter(|row| row[status] == crate::SOLVED).collect();
        let limits = column("binding").into_iter().flat_map(|at| {
            solved.iter().flat_map(move |row| row[at].split("; ").filter(|name| !name.is_empty()).map(str::to_owned))
        });
        let words = [column("row"), Some(status), column("binding")];
        let numbers = (0..table.names.len()).filter(|at| !words.contains(&Some(*at)));
        let columns = numbers.map(|at| {
            let values = solved.iter().filter_map(|row| row[at].parse::<f64>().ok());
            let mut values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
            values.sort_by(f64::total_cmp);
            Spread { name: table.names[at].clone(), values }
        });
        Ok(Self {
            statuses: counted(table.rows.iter().map(|row| row[status].clone())),
            binding: counted(limits),
            columns: columns.collect(),
        })
    }

    /// How many rows there are.
    pub fn rows(&self) -> usize {
        self.statuses.iter().map(|status| status.1).sum()
    }

    /// How many are solved.
    pub fn solved(&self) -> usize {
        self.statuses.iter().find(|status| status.0 == crate::SOLVED).map_or(0, |status| status.1)
    }
}

/// Words with their counts, the most frequent first, then by name.
fn counted(words: impl Iterator<Item = String>) -> Vec<(String, usize)> {
    let mut counts: BTreeMap<String, usize> = BTreeMap::new();
    words.for_each(|word| *counts.entry(word).or_insert(0) += 1);
    let mut counts: Vec<(String, usize)> = counts.into_iter().collect();
    counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    counts
}

impl fmt::Display for Summary {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (rows, solved) = (self.rows(), self.solved());
        let share = |count: usize, of: usize| 100.0 * count as f64 / of.max(1) as f64;
        writeln!(f, "{rows} rows, {solved} solved ({:.1} %)", share(solved, rows))?;
        for (status, count) in self.statuses.iter().filter(|status| status.0 != crate::SOLVED) {
            writeln!(f, "  {count} {status}")?;
        }
        if !self.binding.is_empty() {
            writeln!(f, "\nlimits that bind, in percent of the solved rows")?;
            for (name, count) in &self.binding {
                writeln!(f, "{:>7.1}  {name}", share(*count, solved))?;
            }
        }
        let width = self.columns.iter().map(|column| column.name.chars().count()).max().unwrap_or(0);
        write!(f, "\n{:width$}", "over solved rows")?;
        for percent in SHOWN {
            let head = match percent {
                0.0 => "least".to_owned(),
                50.0 => "median".to_owned(),
                100.0 => "greatest".to_owned(),
                _ => format!("{percent} %"),
            };
            write!(f, "  {head:>12}")?;
        }
        let padding = "over solved rows".len().max(width);
        for column in &self.columns {
            write!(f, "\n{:padding$}", column.name)?;
            for percent in SHOWN {
                write!(f, "  {:>12}", short(column.quantile(percent)))?;
            }
        }
        Ok(())
    }
}

/// Six digits.
fn short(value: f64) -> String {
    match value {
        value if value.is_nan() => String::new(),
        0.0 => "0".to_owned(),
        value if (1e-4..1e7).contains(&value.abs()) => {
            let digits = (5 - value.abs().log10().floor() as i32).clamp(0, 9) as usize;
            format!("{value:.digits$}")
        }
        value => format!("{value:.5e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn table() -> Table {
        let text = "row,a,status,binding,T\n0,1,solved,turn; fast,10\n1,2,solved,fast,20\n2,3,infeasible: no,,99\n3,4,solved,,40\n";
        crate::csv::read(text.as_bytes()).expect("a table")
    }

    #[test]
    fn only_solved_rows_count_and_every_limit_is_counted_once_a_row() {
        let summary = Summary::of(&table()).expect("a summary");
        assert_eq!((summary.rows(), summary.solved()), (4, 3));
        assert_eq!(summary.binding, [("fast".to_owned(), 2), ("turn".to_owned(), 1)]);
        let names: Vec<&str> = summary.columns.iter().map(|column| column.name.as_str()).collect();
        assert_eq!(names, ["a", "T"]);
        let t = &summary.columns[1];
        assert_eq!([0.0, 25.0, 50.0, 100.0].map(|percent| t.quantile(percent)), [10.0, 15.0, 20.0, 40.0]);
        assert!(Summary::of(&Table::default()).is_err());
    }

    #[test]
    fn the_words_are_these() {
        let words = Summary::of(&table()).expect("a summary").to_string();
        let wanted = [
            "4 rows, 3 solved (75.0 %)",
            "  1 infeasible: no",
            "",
            "limits that bind, in percent of the solved rows",
            "   66.7  fast",
            "   33.3  turn",
            "",
            "over solved rows         least           5 %        median          95 %      greatest",
            "a                      1.00000       1.10000       2.00000       3.80000       4.00000",
            "T                      10.0000       11.0000       20.0000       38.0000       40.0000",
        ];
        assert_eq!(words.lines().collect::<Vec<_>>(), wanted);
    }
}
