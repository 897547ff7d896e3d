//! Where every entry of the condensed matrix is stored (docs/maths.md, section 11.3).
//!
//! Unknowns are numbered in three runs: the *band*, in order of time; the variables of the *border*
//! (durations, static variables, ends that meet a far start); the rows of the border (integrals and
//! other rows that touch many unknowns).
//!
//! ```text
//! [ K            ]   lower triangle by columns, each as long as the farthest unknown it meets
//! [ B    C       ]   for each component of the band the border's rows that touch it; C is dense
//! ```
//!
//! A column is at least as long as what is left of its predecessor, so that the factors need no
//! more room than the matrix.

/// A stretch of the band that no entry connects with the rest: an agent, as a rule.
#[derive(Clone, Debug)]
pub(super) struct Component {
    /// Its first unknown.
    pub(super) first: usize,
    /// One past its last unknown.
    pub(super) last: usize,
    /// The unknowns of the border that touch it, counted from the first of the border.
    pub(super) columns: Vec<u32>,
    /// Where its part of `B` begins: row by row, one entry for each of `columns`.
    pub(super) at: usize,
}

/// The layout of a matrix and of its factors.
#[derive(Clone, Debug)]
pub(super) struct Shape {
    /// Unknowns of the band.
    pub(super) band: usize,
    /// Unknowns of the border that are variables.
    pub(super) border_variables: usize,
    /// Unknowns of the border.
    pub(super) border: usize,
    /// Where the column of each unknown of the band begins, its diagonal first; and the end.
    pub(super) column: Vec<usize>,
    /// The components of the band, in order.
    pub(super) components: Vec<Component>,
    /// The component of each unknown of the band.
    component_of: Vec<u32>,
    /// For each component the position of each unknown of the border among its columns.
    place: Vec<Vec<u32>>,
    /// Where `C` begins: row by row, the full square.
    pub(super) corner: usize,
    /// Length of the storage; its last entry is written to and never read.
    pub(super) len: usize,
}

/// No position.
const NONE: u32 = u32::MAX;

impl Shape {
    /// The shape for cliques of unknowns: every two unknowns of a clique meet. `border` counts the
    /// variables and the rows of the border.
    pub(super) fn new<'a>(band: usize, border: [usize; 2], cliques: impl Iterator<Item = &'a [u32]> + Clone) -> Self {
        let mut last: Vec<usize> = (0..band).collect();
        for clique in cliques.clone() {
            if let Some(end) = clique.iter().map(|&u| u as usize).filter(|&u| u < band).max() {
                clique.iter().map(|&u| u as usize).filter(|&u| u < band).for_each(|u| last[u] = last[u].max(end));
            }
        }
        for j in 1..band {
            last[j] = last[j].max(last[j - 1]);
        }
        let mut column = vec![0];
        column.extend(last.iter().enumerate().scan(0, |at, (j, last)| {
            *at += last - j + 1;
            Some(*at)
        }));
        let mut shape = Self {
            band,
            border_variables: border[0],
            border: border[0] + border[1],
            len: column[band],
            column,
            components: vec![],
            component_of: vec![],
            place: vec![],
            corner: 0,
        };
        shape.find_components(&last);
        shape.find_touching(cliques);
        shape
    }

    fn find_components(&mut self, last: &[usize]) {
        let mut first = 0;
        for (j, last) in last.iter().enumerate() {
            self.component_of.push(self.components.len() as u32);
            if *last == j {
                self.components.push(Component { first, last: j + 1, columns: vec![], at: 0 });
                first = j + 1;
            }
        }
    }

    fn find_touching<'a>(&mut self, cliques: impl Iterator<Item = &'a [u32]>) {
        let mut touches = vec![vec![false; self.border]; self.components.len()];
        for clique in cliques {
            for &b in clique.iter().filter(|&&u| u as usize >= self.band) {
                for &u in clique.iter().filter(|&&u| (u as usize) < self.band) {
                    touches[self.component_of[u as usize] as usize][b as usize - self.band] = true;
                }
            }
        }
        for (component, touches) in self.components.iter_mut().zip(touches) {
            let mut place = vec![NONE; self.border];
            for (b, _) in touches.iter().enumerate().filter(|(_, touches)| **touches) {
                place[b] = component.columns.len() as u32;
                component.columns.push(b as u32);
            }
            component.at = self.len;
            self.len += (component.last - component.first) * component.columns.len();
            self.place.push(place);
        }
        self.corner = self.len;
        self.len += self.border * self.border + 1;
    }

    /// How many unknowns there are.
    pub(super) fn unknowns(&self) -> usize {
        self.band + self.border
    }

    /// Where the entry of two unknowns is stored; in the corner that is its lower triangle.
    /// They meet in some clique.
    pub(super) fn position(&self, a: usize, b: usize) -> usize {
        let (low, high) = (a.min(b), a.max(b));
        if high < self.band {
            self.column[low] + high - low
        } else if low < self.band {
            let of = self.component_of[low] as usize;
            let component = &self.components[of];
            let place = self.place[of][high - self.band];
            component.at + (low - component.first) * component.columns.len() + place as usize
        } else {
            self.corner + (high - self.band) * self.border + low - self.band
        }
    }

    /// Where the entries of an unknown of the border with the variables are stored.
    pub(super) fn row(&self, unknown: usize) -> impl Iterator<Item = usize> + '_ {
        let border = unknown - self.band;
        let parts = self.components.iter().zip(&self.place).filter(move |(_, place)| place[border] != NONE);
        let band = parts.flat_map(move |(c, place)| {
            (0..c.last - c.first).map(move |i| c.at + i * c.columns.len() + place[border] as usize)
        });
        let corner = self.corner + border * self.border;
        band.chain(corner..corner + border.min(self.border_variables))
    }

    /// Where what nobody reads is written.
    pub(super) fn trash(&self) -> usize {
        self.len - 1
    }
}
