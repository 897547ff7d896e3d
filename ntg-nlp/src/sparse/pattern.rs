//! The shape of the Hessian with the variables in their own order: a band, and an arrow.
//!
//! Variables that meet variables far away (durations, static variables) form the *border*; what
//! remains is a band. A solver that knows both factorises in time linear in the number of variables.

use super::{Assembly, Csc};
use std::fmt;

/// Where entries stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Pattern {
    /// Number of variables.
    pub variables: usize,
    /// Number of constraint rows.
    pub rows: usize,
    /// Largest distance from the diagonal of an entry between variables outside the border, where
    /// two variables also meet when they stand in one row.
    pub half_band: usize,
    /// The variables of the border, increasing.
    pub border: Vec<usize>,
    /// Entries of the Jacobian.
    pub jacobian_entries: usize,
    /// Entries of the Hessian's upper triangle.
    pub hessian_entries: usize,
    picture: Vec<String>,
}

/// Characters a side of the picture has at most.
const PICTURE: usize = 48;

impl Pattern {
    /// The shape of an assembly's matrices. Equality rows and path rows count like second
    /// derivatives: eliminating a row joins all its variables. Rows that join more than half of
    /// all variables (integrals) are left to the border of the rows and do not widen the band.
    pub fn of(assembly: &Assembly) -> Self {
        let n = assembly.hessian.columns();
        let mut edges: Vec<(usize, usize)> = Vec::new();
        for j in 0..n {
            edges.extend(assembly.hessian.column(j).map(|(i, _)| (i, j)));
        }
        for row in by_row(&assembly.jacobian) {
            if row.len() * 2 <= n.max(2) {
                edges.extend(row.iter().enumerate().flat_map(|(k, &j)| row[..k].iter().map(move |&i| (i, j))));
            }
        }
        edges.sort_unstable();
        edges.dedup();
        let (border, half_band) = border(n, &edges);
        Self {
            variables: n,
            rows: assembly.jacobian.rows,
            half_band,
            border,
            jacobian_entries: assembly.jacobian.row.len(),
            hessian_entries: assembly.hessian.row.len(),
            picture: picture(n, &edges),
        }
    }
}

/// The columns of each row.
fn by_row(matrix: &Csc) -> Vec<Vec<usize>> {
    let mut rows = vec![Vec::new(); matrix.rows];
    for j in 0..matrix.columns() {
        matrix.column(j).for_each(|(i, _)| rows[i].push(j));
    }
    rows
}

/// Moves the variable with the farthest reach to the border as long as that makes
/// `(half_band + 1)^2 + border * half_band`-like work smaller; gives border and half band.
fn border(n: usize, edges: &[(usize, usize)]) -> (Vec<usize>, usize) {
    let mut inside = vec![true; n];
    let band =
        |inside: &[bool]| edges.iter().filter(|(i, j)| inside[*i] && inside[*j]).map(|(i, j)| j - i).max().unwrap_or(0);
    let mut best = (Vec::new(), band(&inside));
    let work = |half_band: usize, border: usize| (half_band + border + 1).pow(2);
    let mut border = Vec::new();
    while border.len() * 4 < n {
        let mut reach = vec![(0, 0); n];
        for &(i, j) in edges.iter().filter(|(i, j)| inside[*i] && inside[*j]) {
            for k in [i, j] {
                reach[k] = (reach[k].0.max(j - i), reach[k].1 + 1);
            }
        }
        let Some(far) = (0..n).filter(|j| inside[*j]).max_by_key(|j| reach[*j]) else { break };
        inside[far] = false;
        border.push(far);
        let half_band = band(&inside);
        if work(half_band, border.len()) < work(best.1, best.0.len()) {
            best = (border.clone(), half_band);
        }
        if half_band == 0 || border.len() > best.0.len() + 8 {
            break;
        }
    }
    best.0.sort_unstable();
    best
}

/// The pattern drawn small: `#` where a cell holds entries.
fn picture(n: usize, edges: &[(usize, usize)]) -> Vec<String> {
    let side = n.min(PICTURE);
    let mut cells = vec![vec![' '; side]; side];
    for &(i, j) in edges {
        let (a, b) = (i * side / n, j * side / n);
        cells[a][b] = '#';
        cells[b][a] = '#';
    }
    cells.into_iter().map(|row| row.into_iter().collect::<String>().trim_end().to_string()).collect()
}

impl fmt::Display for Pattern {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{} variables, {} rows", self.variables, self.rows)?;
        writeln!(f, "Jacobian: {} entries", self.jacobian_entries)?;
        writeln!(f, "Hessian: {} entries in the upper triangle", self.hessian_entries)?;
        writeln!(f, "band: half width {}; border: {} variables", self.half_band, self.border.len())?;
        self.picture.iter().try_for_each(|row| writeln!(f, "  |{row}"))
    }
}
