//! Envelope (skyline) storage of the condensed matrix: where every entry is stored (docs/maths.md, section 11.3).
//!
//! Unknowns are numbered in three groups: the *band*, in the program's order; the variables of the *border*
//! (durations, static variables, ends that meet a far start); the border rows (integrals and
//! other rows that touch many unknowns).
//!
//! ```text
//! [ K            ]   lower triangle in blocks of four by four, each column of them as long as the farthest
//! [              ]   unknown it meets
//! [ B    C       ]   for each component of the band the rows of the border that touch it; C is dense
//! ```
//!
//! A column of blocks is at least as long as what is left of its predecessor, so that the factors need no
//! more memory than the matrix. Every component begins with a block of its own, and padding fills up its last block:
//! unknowns with a diagonal of 1 and no other entries. Loops over a block thus have a constant length, which makes them
//! fast.

/// Unknowns of a block.
pub(super) const BLOCK: usize = 4;

/// A stretch of the band that no entry connects with the rest: an agent, as a rule.
#[derive(Clone, Debug)]
pub(super) struct Component {
    /// The first unknown.
    pub(super) first: usize,
    /// One past the last unknown.
    pub(super) last: usize,
    /// The columns of blocks.
    pub(super) blocks: std::ops::Range<usize>,
    /// The unknowns of the border that touch it, counted from the first of the border.
    pub(super) columns: Vec<u32>,
    /// Where the part of `B` of this component begins: one row for each of `columns`.
    pub(super) at: usize,
}

impl Component {
    /// Where a row of this component's part of `B` is stored, by its place among `columns`.
    #[inline(always)]
    pub(super) fn row(&self, place: usize) -> std::ops::Range<usize> {
        let stride = BLOCK * self.blocks.len();
        self.at + place * stride..self.at + (place + 1) * stride
    }
}

/// The storage of a matrix and of its factors.
#[derive(Clone, Debug)]
pub(super) struct Envelope {
    /// Unknowns of the band.
    pub(super) band: usize,
    /// Unknowns of the border that are variables.
    pub(super) border_variables: usize,
    /// Unknowns of the border.
    pub(super) border: usize,
    /// The padded index of each unknown of the band: its number once components are filled up.
    pub(super) padded: Vec<usize>,
    /// Where each column of blocks begins, its diagonal first, counted in blocks; and the end.
    pub(super) column: Vec<usize>,
    /// The components of the band, in order.
    pub(super) components: Vec<Component>,
    /// The component of each unknown of the band.
    component_of: Vec<u32>,
    /// For each component the position of each unknown of the border among its columns.
    place: Vec<Vec<u32>>,
    /// Where the diagonal entries of the padding are stored.
    fillers: Vec<usize>,
    /// Where `C` begins: row by row, the full square.
    pub(super) corner: usize,
    /// Length of the storage. Its last entry is the sink, which is written to and never read.
    pub(super) len: usize,
}

/// No position.
const NONE: u32 = u32::MAX;

impl Envelope {
    /// The envelope for cliques of unknowns: every two unknowns of a clique meet. `border` counts the
    /// border's variables and border rows.
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
        let mut envelope = Self {
            band,
            border_variables: border[0],
            border: border[0] + border[1],
            padded: vec![],
            column: vec![0],
            components: vec![],
            component_of: vec![],
            place: vec![],
            fillers: vec![],
            corner: 0,
            len: 0,
        };
        envelope.find_components(&last);
        envelope.find_blocks(&last);
        envelope.find_touching(cliques);
        envelope
    }

    fn find_components(&mut self, last: &[usize]) {
        let (mut first, mut block) = (0, 0);
        for (j, last) in last.iter().enumerate() {
            self.component_of.push(self.components.len() as u32);
            self.padded.push(BLOCK * block + j - first);
            if *last == j {
                let blocks = block..block + (j + 1 - first).div_ceil(BLOCK);
                block = blocks.end;
                self.components.push(Component { first, last: j + 1, blocks, columns: vec![], at: 0 });
                first = j + 1;
            }
        }
    }

    /// Columns of blocks as long as the farthest unknown of any of their columns.
    fn find_blocks(&mut self, last: &[usize]) {
        let mut far: Vec<usize> = (0..self.components.last().map_or(0, |c| c.blocks.end)).collect();
        for (padded, last) in self.padded.iter().zip(last) {
            far[padded / BLOCK] = far[padded / BLOCK].max(self.padded[*last] / BLOCK);
        }
        for (block, far) in far.iter().enumerate() {
            self.column.push(self.column[block] + far - block + 1);
        }
        self.len = BLOCK * BLOCK * self.column[far.len()];
        for component in &self.components {
            let filled = BLOCK * component.blocks.start + component.last - component.first;
            let fillers = filled..BLOCK * component.blocks.end;
            self.fillers.extend(fillers.map(|padded| entry(&self.column, padded, padded)));
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
            self.len = component.row(component.columns.len()).start;
            self.place.push(place);
        }
        self.corner = self.len;
        self.len += self.border * self.border + 1;
    }

    /// How many unknowns there are.
    pub(super) fn unknowns(&self) -> usize {
        self.band + self.border
    }

    /// Where the entry of two unknowns that meet in some clique is stored; of the corner the lower triangle.
    pub(super) fn position(&self, a: usize, b: usize) -> usize {
        let (low, high) = (a.min(b), a.max(b));
        if high < self.band {
            entry(&self.column, self.padded[high], self.padded[low])
        } else if low < self.band {
            let of = self.component_of[low] as usize;
            let component = &self.components[of];
            component.row(self.place[of][high - self.band] as usize).start + low - component.first
        } else {
            self.corner + (high - self.band) * self.border + low - self.band
        }
    }

    /// Where the entries of an unknown of the border with the variables are stored.
    pub(super) fn row(&self, unknown: usize) -> impl Iterator<Item = usize> + '_ {
        let border = unknown - self.band;
        let parts = self.components.iter().zip(&self.place).filter(move |(_, place)| place[border] != NONE);
        let band = parts.flat_map(move |(c, place)| {
            let first = c.row(place[border] as usize).start;
            first..first + c.last - c.first
        });
        let corner = self.corner + border * self.border;
        band.chain(corner..corner + border.min(self.border_variables))
    }

    /// Sets a matrix to zero, but for the diagonal of the padding.
    pub(super) fn clear(&self, matrix: &mut [f64]) {
        matrix.fill(0.0);
        self.fillers.iter().for_each(|&at| matrix[at] = 1.0);
    }

    /// The sink: where entries of padding are written.
    pub(super) fn sink(&self) -> usize {
        self.len - 1
    }
}

/// Where the entry of two padded indices of the band is stored, the later index first: block by block, column by
/// column.
fn entry(column: &[usize], high: usize, low: usize) -> usize {
    let block = column[low / BLOCK] + high / BLOCK - low / BLOCK;
    BLOCK * BLOCK * block + BLOCK * (low % BLOCK) + high % BLOCK
}
