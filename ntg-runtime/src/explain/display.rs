//! A conflict as a person reads about it.

use super::{Conflict, Explanation, Near, Part};
use crate::digits::brief;
use std::fmt;

impl fmt::Display for Explanation {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Conflict(conflict) => conflict.fmt(f),
            Self::Consistent(near) => write!(
                f,
                "all constraints can hold together near {near}: it is not they that keep the solve from a solution"
            ),
            Self::Unknown => f.write_str(
                "whether all constraints can hold together near the last point or the guess could not be shown",
            ),
        }
    }
}

impl fmt::Display for Near {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::End => "the last point",
            Self::Guess => "the guess",
        })
    }
}

impl fmt::Display for Conflict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.settled {
            f.write_str("the solve was stopped before its end, at a point that is no solution; ")?;
        }
        let alone = self.parts.len() == 1 && self.undecided == 0;
        write!(f, "near {} {}", self.near, if alone { "this cannot hold" } else { "these cannot hold together" })?;
        f.write_str(if alone {
            ", whatever else does:"
        } else if self.minimal {
            "; without any one of them the others could:"
        } else {
            "; perhaps not all of them are needed for that:"
        })?;
        self.parts.iter().try_for_each(|part| write!(f, "\n  {part}"))?;
        match self.undecided {
            0 => Ok(()),
            1 => f.write_str("\n  perhaps with one more that holds there"),
            more => write!(f, "\n  perhaps with {more} more that hold there"),
        }
    }
}

impl Conflict {
    /// The status of a solve that ends in it, led by the culprit: a point at which constraints give way together names
    /// equations that only carry what the culprit asks for.
    pub fn headline(&self) -> Option<String> {
        let culprit = self.parts.first().filter(|part| part.amount > 0.0)?;
        let others = match self.parts.len() {
            1 => String::new(),
            2 => ", beside one other".to_owned(),
            count => format!(", beside {} others", count - 1),
        };
        Some(format!("infeasible: {culprit}{others}"))
    }
}

impl fmt::Display for Part {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words())?;
        if self.place.line > 0 {
            write!(f, " (line {}, column {})", self.place.line, self.place.column)?;
        }
        if self.amount == 0.0 {
            return f.write_str(", which holds only because others do not");
        }
        write!(f, ", missed by {}", brief(self.amount))?;
        if !self.unit.symbol.is_empty() {
            write!(f, " {}", self.unit.symbol)?;
        }
        if let Some(time) = self.time {
            write!(f, " at {}", self.independent.place(time, brief))?;
        }
        if self.phase.is_empty() { Ok(()) } else { write!(f, " in `{}`", self.phase) }
    }
}

impl Part {
    /// What it is: "`turn`\[2\]", "the upper bound of the duration of phase `covert`".
    pub fn words(&self) -> String {
        match (self.is_bound, &self.indices[..]) {
            (true, _) => self.name.clone(),
            (false, []) => format!("`{}`", self.name),
            (false, [index]) => format!("`{}`[{index}]", self.name),
            (false, several) => format!("`{}`{several:?}", self.name),
        }
    }
}
