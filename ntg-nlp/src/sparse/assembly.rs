//! From elements to the gradient, the Jacobian and the Hessian (docs/maths.md, section 4).
//!
//! ```text
//! gradient  = sum over elements and objective rows  weight * E^T phi'
//! J[i, :]   = sum over elements and rows with target i  weight * (E^T phi')^T
//! H         = sum over elements  E^T K E,   K = the element's weighted second derivatives
//! ```
//!
//! Takes [`Block`]s once, to find the patterns, and an [`Evaluation`] at each point.
//! Afterwards: no call but [`Assembly::new`] and [`Assembly::of_slopes`] allocates.

use super::Csc;
use crate::contract::{Block, Evaluation, Target};

/// Where the entries of one block go.
#[derive(Clone, Debug)]
struct Routes {
    /// Jacobian pattern sorted by row: `(entry of the pattern, slot)`.
    row_entries: Vec<(usize, usize)>,
    /// Where each row starts in `row_entries`: `rows + 1` entries.
    row_start: Vec<usize>,
    /// Where each `(element, row)` starts in `places`: `elements * rows + 1` entries.
    place_start: Vec<usize>,
    /// Local variable, and where it goes: a position in the Jacobian, or a variable.
    places: Vec<(u32, u32)>,
    /// Where each element starts in `pairs`: `elements + 1` entries.
    pair_start: Vec<usize>,
    /// Two local variables, and their position in the Hessian.
    pairs: Vec<(u32, u32, u32)>,
}

/// The patterns of a program's derivatives and the way from elements to them.
#[derive(Clone, Debug)]
pub struct Assembly {
    /// The gradient of the objective.
    pub gradient: Vec<f64>,
    /// The Jacobian of the rows.
    pub jacobian: Csc,
    /// Pattern of the Hessian's upper triangle, with every diagonal entry; its values are the last
    /// ones assembled by [`Assembly::hessian`].
    pub hessian: Csc,
    routes: Vec<Routes>,
    slopes: Vec<f64>,
    matrix: Vec<f64>,
    product: Vec<f64>,
}

impl Assembly {
    /// Finds the patterns of a program with `n` variables and `m` rows.
    pub fn new(n: usize, m: usize, blocks: &[Block]) -> Self {
        Self::with_orders(n, m, blocks, true)
    }

    /// As [`Assembly::new`], for gradient and Jacobian alone: the Hessian has no entries. Much less to find where elements of
    /// many variables have second derivatives.
    pub fn of_slopes(n: usize, m: usize, blocks: &[Block]) -> Self {
        Self::with_orders(n, m, blocks, false)
    }

    fn with_orders(n: usize, m: usize, blocks: &[Block], second: bool) -> Self {
        let mut jacobian_places = Vec::new();
        let mut hessian_places: Vec<(u32, u32)> =
            if second { (0..n as u32).map(|j| (j, j)).collect() } else { Vec::new() };
        for block in blocks {
            let rows = entries_by_row(block);
            let part = components(block);
            for e in 0..block.elements {
                let variables = block.variables(e);
                each_place(block, &rows, e, |row, local| {
                    if let Target::Row(i) = block.target[row * block.elements + e] {
                        jacobian_places.push((variables[local], i));
                    }
                });
                if second {
                    each_pair(block, &part, e, |a, b| hessian_places.push((variables[b], variables[a])));
                }
            }
        }
        let jacobian = Csc::with_pattern(m, n, jacobian_places);
        let hessian = Csc::with_pattern(n, n, hessian_places);
        let routes = blocks.iter().map(|block| routes(block, &jacobian, second.then_some(&hessian))).collect();
        let slots = blocks.iter().map(|block| block.slots).max().unwrap_or(0);
        let widest = blocks.iter().flat_map(|b| (0..b.elements).map(|e| b.variables(e).len())).max().unwrap_or(0);
        Self {
            gradient: vec![0.0; n],
            jacobian,
            hessian,
            routes,
            slopes: vec![0.0; slots],
            matrix: vec![0.0; slots * slots],
            product: vec![0.0; slots * widest],
        }
    }

    /// Refreshes gradient and Jacobian from an evaluation with derivatives.
    pub fn first(&mut self, blocks: &[Block], at: &Evaluation) {
        self.gradient.fill(0.0);
        self.jacobian.value.fill(0.0);
        for ((block, values), routes) in blocks.iter().zip(&at.blocks).zip(&self.routes) {
            for e in 0..block.elements {
                let (map, width) = (block.map(e), block.variables(e).len());
                for row in 0..block.rows {
                    let lane = row * block.elements + e;
                    let entries = &routes.row_entries[routes.row_start[row]..routes.row_start[row + 1]];
                    let at_row = e * block.rows + row;
                    let places = &routes.places[routes.place_start[at_row]..routes.place_start[at_row + 1]];
                    let out = match block.target[lane] {
                        Target::Objective => &mut self.gradient,
                        Target::Row(_) => &mut self.jacobian.value,
                    };
                    for &(local, position) in places {
                        let column = local as usize;
                        let slope: f64 = entries
                            .iter()
                            .map(|&(entry, slot)| {
                                values.jacobian[entry * block.elements + e] * map[slot * width + column]
                            })
                            .sum();
                        out[position as usize] += block.weight[lane] * slope;
                    }
                }
            }
        }
    }

    /// Refreshes the Hessian from an evaluation with derivatives. `shape` is given each element's
    /// full symmetric matrix `K` in slot space, row by row, with the element's block and number,
    /// and may change it (as long as it keeps the blocks of slots that the pattern connects).
    pub fn hessian(&mut self, blocks: &[Block], at: &Evaluation, mut shape: impl FnMut(&mut [f64], usize, usize)) {
        self.hessian.value.fill(0.0);
        for (number, block) in blocks.iter().enumerate() {
            if block.hessian.is_empty() {
                continue;
            }
            for e in 0..block.elements {
                let slots = block.slots;
                let k = &mut self.matrix[..slots * slots];
                k.fill(0.0);
                for (entry, &(i, j)) in block.hessian.iter().enumerate() {
                    let value = at.blocks[number].hessian[entry * block.elements + e];
                    k[i * slots + j] = value;
                    k[j * slots + i] = value;
                }
                shape(k, number, e);
                let (map, width) = (block.map(e), block.variables(e).len());
                product(k, map, width, &mut self.product, &mut self.slopes);
                let routes = &self.routes[number];
                for &(a, b, position) in &routes.pairs[routes.pair_start[e]..routes.pair_start[e + 1]] {
                    let (a, b) = (a as usize, b as usize);
                    let value: f64 = (0..slots).map(|s| map[s * width + a] * self.product[s * width + b]).sum();
                    self.hessian.value[position as usize] += value;
                }
            }
        }
    }
}

/// `out = K E`, row by row, where `E` has `width` columns.
fn product(k: &[f64], map: &[f64], width: usize, out: &mut [f64], row: &mut [f64]) {
    let slots = map.len().checked_div(width).unwrap_or(0);
    for s in 0..slots {
        row[..slots].copy_from_slice(&k[s * slots..(s + 1) * slots]);
        let out = &mut out[s * width..(s + 1) * width];
        out.fill(0.0);
        for (t, &factor) in row[..slots].iter().enumerate().filter(|(_, factor)| **factor != 0.0) {
            for (out, e) in out.iter_mut().zip(&map[t * width..(t + 1) * width]) {
                *out += factor * e;
            }
        }
    }
}

/// The Jacobian pattern of a block by rows: `(entry, slot)` for each row.
fn entries_by_row(block: &Block) -> Vec<Vec<(usize, usize)>> {
    let mut rows = vec![Vec::new(); block.rows];
    for (entry, &(row, slot)) in block.jacobian.iter().enumerate() {
        rows[row].push((entry, slot));
    }
    rows
}

/// For each slot a number that it shares with the slots that second derivatives connect it to;
/// none for a slot that no second derivative concerns.
fn components(block: &Block) -> Vec<Option<usize>> {
    let mut part: Vec<Option<usize>> = vec![None; block.slots];
    for &(i, j) in &block.hessian {
        let (a, b) = (part[i].unwrap_or(i), part[j].unwrap_or(j));
        let (low, high) = (a.min(b), a.max(b));
        part[i] = Some(low);
        part[j] = Some(low);
        part.iter_mut().filter(|p| **p == Some(high)).for_each(|p| *p = Some(low));
    }
    part
}

/// Calls `visit(row, local variable)` wherever a row of element `e` depends on a variable.
fn each_place(block: &Block, rows: &[Vec<(usize, usize)>], e: usize, mut visit: impl FnMut(usize, usize)) {
    let (map, width) = (block.map(e), block.variables(e).len());
    for (row, entries) in rows.iter().enumerate() {
        for local in 0..width {
            if entries.iter().any(|&(_, slot)| map[slot * width + local] != 0.0) {
                visit(row, local);
            }
        }
    }
}

/// Calls `visit(a, b)`, `a <= b`, for the pairs of local variables that second derivatives connect.
fn each_pair(block: &Block, part: &[Option<usize>], e: usize, mut visit: impl FnMut(usize, usize)) {
    let (map, width) = (block.map(e), block.variables(e).len());
    let touches =
        |p: usize, local: usize| (0..block.slots).any(|slot| part[slot] == Some(p) && map[slot * width + local] != 0.0);
    for b in 0..width {
        for a in 0..=b {
            if (0..block.slots).any(|p| part[p] == Some(p) && touches(p, a) && touches(p, b)) {
                visit(a, b);
            }
        }
    }
}

/// The routes of one block, once the patterns are known.
fn routes(block: &Block, jacobian: &Csc, hessian: Option<&Csc>) -> Routes {
    let rows = entries_by_row(block);
    let part = components(block);
    let mut routes = Routes {
        row_start: vec![0],
        row_entries: Vec::new(),
        place_start: vec![0; block.elements * block.rows + 1],
        places: Vec::new(),
        pair_start: vec![0],
        pairs: Vec::new(),
    };
    for row in &rows {
        routes.row_entries.extend(row);
        routes.row_start.push(routes.row_entries.len());
    }
    for e in 0..block.elements {
        let variables = block.variables(e);
        each_place(block, &rows, e, |row, local| {
            let variable = variables[local];
            let position = match block.target[row * block.elements + e] {
                Target::Objective => variable,
                Target::Row(i) => position(jacobian, i, variable),
            };
            routes.places.push((local as u32, position));
            routes.place_start[e * block.rows + row + 1] = routes.places.len();
        });
        if let Some(hessian) = hessian {
            each_pair(block, &part, e, |a, b| {
                routes.pairs.push((a as u32, b as u32, position(hessian, variables[a], variables[b])));
            });
        }
        routes.pair_start.push(routes.pairs.len());
    }
    // A row without places starts where its predecessor ends.
    for at in 1..routes.place_start.len() {
        routes.place_start[at] = routes.place_start[at].max(routes.place_start[at - 1]);
    }
    routes
}

/// The position of an entry that the pattern was built from.
fn position(matrix: &Csc, row: u32, column: u32) -> u32 {
    let at = matrix.position(row as usize, column as usize).expect("the pattern holds every place it was built from");
    at as u32
}
