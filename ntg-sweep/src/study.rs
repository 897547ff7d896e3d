//! What is studied, and what one row of it gave.

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

/// Parameter sets for one problem.
#[derive(Clone, Debug, PartialEq)]
pub struct Study {
    /// What is set in every row: `v_max`, `start_x[2]`.
    pub inputs: Vec<String>,
    /// One set a row, in declared units.
    pub sets: Vec<Vec<f64>>,
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
    /// `solved`, or why not.
    pub status: String,
    /// Results by name; none where a number is not finite.
    pub numbers: Vec<(String, Option<f64>)>,
}

impl Row {
    /// A row that could not be solved at all.
    pub fn failed(row: usize, status: impl Into<String>) -> Self {
        Self { row, status: status.into(), numbers: vec![] }
    }

    /// Adds a result.
    pub fn push(&mut self, name: impl Into<String>, value: f64) {
        self.numbers.push((name.into(), value.is_finite().then_some(value)));
    }
}

#[cfg(test)]
mod tests {
    use super::Study;

    #[test]
    fn whatever_is_changed_changes_the_fingerprint() {
        let study = Study { inputs: vec!["a".into()], sets: vec![vec![1.0], vec![2.0]], about: vec!["spec".into()] };
        let mut prints = vec![study.fingerprint()];
        prints.push(Study { inputs: vec!["b".into()], ..study.clone() }.fingerprint());
        prints.push(Study { sets: vec![vec![1.0]], ..study.clone() }.fingerprint());
        prints.push(Study { sets: vec![vec![1.0], vec![2.0 + f64::EPSILON * 2.0]], ..study.clone() }.fingerprint());
        prints.push(Study { about: vec!["spe".into(), "c".into()], ..study.clone() }.fingerprint());
        prints.push(Study { about: vec!["spec".into(), "a".into()], inputs: vec![], ..study.clone() }.fingerprint());
        let last = prints.pop().expect("six");
        for (i, print) in prints.iter().enumerate() {
            assert!(prints[..i].iter().all(|other| other != print));
        }
        assert_ne!(last, prints[1]);
        assert_eq!(study.fingerprint(), study.clone().fingerprint());
    }
}
