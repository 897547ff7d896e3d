//! Parts of a study that are solved by processes of their own.

use std::fmt;
use std::str::FromStr;

use crate::blocks::Block;

/// The `part`-th of `of` parts, counted from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    part: usize,
    of: usize,
}

impl Shard {
    /// The only part.
    pub const WHOLE: Self = Self { part: 1, of: 1 };

    /// The `part`-th of `of` parts.
    ///
    /// # Errors
    /// In words: a part that does not exist.
    pub fn new(part: usize, of: usize) -> Result<Self, String> {
        match (1..=of).contains(&part) {
            true => Ok(Self { part, of }),
            false => Err(format!("there is no shard {part} of {of}; shards are counted from 1")),
        }
    }

    /// Which part.
    pub fn part(self) -> usize {
        self.part
    }

    /// Of how many.
    pub fn of(self) -> usize {
        self.of
    }

    /// Its blocks: every `of`-th, so that all shards have blocks from everywhere, easy ones and hard ones.
    pub fn blocks(self, all: Vec<Block>) -> Vec<Block> {
        all.into_iter().skip(self.part - 1).step_by(self.of).collect()
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').and_then(|(part, of)| Some((part.parse().ok()?, of.parse().ok()?)));
        let (part, of) = parts.ok_or_else(|| format!("`{text}`: a shard is PART/PARTS, such as 3/16"))?;
        Self::new(part, of)
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.part, self.of)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::blocks;

    #[test]
    fn every_block_is_in_one_shard() {
        let sets: Vec<Vec<f64>> = (0..100).map(|i| vec![f64::from(i)]).collect();
        let all = blocks(&sets, 7);
        for of in [1, 2, 5, 40] {
            let parts = (1..=of).map(|part| Shard::new(part, of).expect("a shard").blocks(all.clone()));
            let mut joined: Vec<Block> = parts.flatten().collect();
            joined.sort_by_key(|block| all.iter().position(|other| other == block));
            assert_eq!(joined, all);
        }
    }

    #[test]
    fn what_is_no_shard_is_said_in_words() {
        assert_eq!("3/16".parse::<Shard>().map(|shard| shard.to_string()), Ok("3/16".to_owned()));
        for text in ["0/4", "5/4", "1/0", "3", "a/b", "-1/2"] {
            let said = text.parse::<Shard>().expect_err(text);
            assert!(said.contains("shard"), "{said}");
        }
    }
}
