//! One argument of a table: its nodes and its symmetry.
//!
//! Symmetry is made before interpolation, not after it: an even argument is mirrored and a
//! periodic one repeated, so that every method sees plain nodes and its result is smooth
//! where the symmetry closes (docs/maths.md, section 7.2). The part that is not needed is cut
//! away afterwards.
//!
//! Finds: nodes that are too few, not finite, not increasing, or against the symmetry.

use super::TableError;

/// What is known of a table beyond the nodes of one argument.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Symmetry {
    /// Nothing.
    #[default]
    Plain,
    /// The table is the same at `-x` as at `x`; nodes are given for `x >= 0` only.
    Even,
    /// The last node is one period after the first and has the same values.
    Periodic,
}

/// One argument of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Where values are given, increasing, at least two, in the unit of the argument.
    pub nodes: Vec<f64>,
    /// What holds beyond them.
    pub symmetry: Symmetry,
}

impl Axis {
    /// An argument without symmetry.
    pub fn plain(nodes: Vec<f64>) -> Self {
        Self { nodes, symmetry: Symmetry::Plain }
    }

    /// An argument mirrored at 0.
    pub fn even(nodes: Vec<f64>) -> Self {
        Self { nodes, symmetry: Symmetry::Even }
    }

    /// A closed argument.
    pub fn periodic(nodes: Vec<f64>) -> Self {
        Self { nodes, symmetry: Symmetry::Periodic }
    }

    pub(super) fn first(&self) -> f64 {
        self.nodes[0]
    }

    pub(super) fn last(&self) -> f64 {
        self.nodes[self.nodes.len() - 1]
    }

    /// Everything about the nodes that can be wrong; `axis` is the position for the message.
    pub(super) fn check(&self, axis: usize) -> Result<(), TableError> {
        let nodes = &self.nodes;
        if nodes.len() < 2 {
            return Err(TableError::TooFewNodes { axis, found: nodes.len() });
        }
        if let Some(index) = nodes.iter().position(|node| !node.is_finite()) {
            return Err(TableError::NodeNotFinite { axis, index });
        }
        if let Some(before) = nodes.windows(2).position(|pair| pair[0] >= pair[1]) {
            return Err(TableError::NodesNotIncreasing { axis, index: before + 1 });
        }
        if self.symmetry == Symmetry::Even && nodes[0] < 0.0 {
            return Err(TableError::EvenNegative { axis, node: nodes[0] });
        }
        Ok(())
    }

    /// The nodes with their mirror images or copies. `padding` is the least number of copied
    /// nodes on each side of a periodic argument.
    pub(super) fn extended(&self, padding: usize) -> Extended {
        let count = self.nodes.len();
        match self.symmetry {
            Symmetry::Plain => Extended { nodes: self.nodes.clone(), rows: (0..count).collect() },
            Symmetry::Even => {
                // A node at 0 is its own mirror image.
                let own = usize::from(self.nodes[0] == 0.0);
                let mirrored = (own..count).rev();
                Extended {
                    nodes: mirrored.clone().map(|i| -self.nodes[i]).chain(self.nodes.iter().copied()).collect(),
                    rows: mirrored.chain(0..count).collect(),
                }
            }
            Symmetry::Periodic => {
                let (each, period) = (count - 1, self.last() - self.first());
                let copies = padding.div_ceil(each) as i64;
                let (mut nodes, mut rows) = (vec![], vec![]);
                for copy in -copies..=copies {
                    nodes.extend(self.nodes[..each].iter().map(|node| node + copy as f64 * period));
                    rows.extend(0..each);
                }
                nodes.push(self.last() + copies as f64 * period);
                rows.push(each);
                Extended { nodes, rows }
            }
        }
    }
}

/// Plain nodes that carry a symmetry.
pub(super) struct Extended {
    /// Increasing.
    pub(super) nodes: Vec<f64>,
    /// Which of the given nodes each one copies.
    pub(super) rows: Vec<usize>,
}
