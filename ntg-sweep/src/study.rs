//! What is studied, and what one row of it gave.

use ntg_runtime::report::Resolution;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Parameter sets for one problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// What is set in every row: `v_max`, `start_x[2]`.
    pub inputs: Vec<String>,
    /// One set a row, in declared units.
    pub sets: Vec<Vec<f64>>,
    /// How many rows start from one solution, see [`crate::blocks`]; 1 for rows that all start from the spec's guess.
    pub block: usize,
    /// Everything else that decides the results: the spec, its tables, settings, wanted values.
    pub about: Vec<String>,
}

impl Study {
    /// A number that is another one whenever anything is that decides the results.
    pub fn fingerprint(&self) -> String {
        let mut hash = Sha256::new();
        // Lengths tell apart what would run together.
        let mut text = |text: &str| {
            hash.update((text.len() as u64).to_le_bytes());
            hash.update(text.as_bytes());
        };
        text(env!("CARGO_PKG_VERSION"));
        text(&self.block.to_string());
        text(&self.about.len().to_string());
        for part in self.about.iter().chain(&self.inputs) {
            text(part);
        }
        for set in &self.sets {
            hash.update((set.len() as u64).to_le_bytes());
            for value in set {
                hash.update(value.to_bits().to_le_bytes());
            }
        }
        hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect()
    }
}

/// The results of one parameter set.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Row {
    /// Its number, from 0.
    pub row: usize,
    /// The parameter set, in declared units.
    #[serde(with = "numbers")]
    pub set: Vec<f64>,
    /// `solved`, or why not.
    pub status: String,
    /// The constraints that bind, `; ` between them.
    pub binding: String,
    /// Results in the order of [`Results::names`], NaN where there is none; empty where the row could not be solved
    /// at all.
    #[serde(with = "numbers")]
    pub numbers: Vec<f64>,
}

impl Row {
    /// A row that could not be solved at all.
    pub fn failed(row: usize, set: &[f64], status: impl Into<String>) -> Self {
        Self { row, set: set.to_vec(), status: status.into(), ..Self::default() }
    }

    /// Whether it has a solution that is less than a solved one: acceptable, or one of the points alone.
    pub fn is_less_than_solved(&self) -> bool {
        let alone = |status: &str| Resolution::Unresolved.ending(status);
        [ACCEPTABLE.to_owned(), STATIONARY.to_owned(), alone(SOLVED), alone(ACCEPTABLE), alone(STATIONARY)]
            .contains(&self.status)
    }

    /// Whether it was solved.
    pub fn is_solved(&self) -> bool {
        self.status == SOLVED
    }
}

/// The status of a row that was solved to 1e-6 only.
const ACCEPTABLE: &str = "acceptable";
/// The status of a row whose solution is stationary and no minimum.
const STATIONARY: &str = "stationary";
/// The status of a row that was solved.
pub const SOLVED: &str = "solved";

/// Rows, and what their numbers are.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Results {
    /// What was set in every row.
    pub inputs: Vec<String>,
    /// What the numbers of a row are.
    pub names: Vec<String>,
    /// The rows, by increasing number.
    pub rows: Vec<Row>,
}

/// JSON has no NaN: `null` stands for it.
mod numbers {
    use serde::{Deserialize, Deserializer, Serializer};

    pub(super) fn serialize<S: Serializer>(values: &[f64], to: S) -> Result<S::Ok, S::Error> {
        to.collect_seq(values.iter().map(|value| value.is_finite().then_some(*value)))
    }

    pub(super) fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Vec<f64>, D::Error> {
        let values = Vec::<Option<f64>>::deserialize(from)?;
        Ok(values.into_iter().map(|value| value.unwrap_or(f64::NAN)).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::Study;

    #[test]
    fn whatever_is_changed_changes_the_fingerprint() {
        let study =
            Study { inputs: vec!["a".into()], sets: vec![vec![1.0], vec![2.0]], block: 8, about: vec!["spec".into()] };
        let mut prints = vec![study.fingerprint()];
        prints.push(Study { inputs: vec!["b".into()], ..study.clone() }.fingerprint());
        prints.push(Study { sets: vec![vec![1.0]], ..study.clone() }.fingerprint());
        prints.push(Study { sets: vec![vec![1.0], vec![2.0 + f64::EPSILON * 2.0]], ..study.clone() }.fingerprint());
        prints.push(Study { about: vec!["spe".into(), "c".into()], ..study.clone() }.fingerprint());
        prints.push(Study { about: vec!["spec".into(), "a".into()], inputs: vec![], ..study.clone() }.fingerprint());
        prints.push(Study { block: 1, ..study.clone() }.fingerprint());
        for (i, print) in prints.iter().enumerate() {
            assert!(prints[..i].iter().all(|other| other != print));
        }
        assert_eq!(study.fingerprint(), study.clone().fingerprint());
    }
}
