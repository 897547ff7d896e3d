//! Tables of jets: the interpolant of docs/maths.md, section 7, cell by cell.
//!
//! Where the argument stays in one cell the table is one polynomial there and has all derivatives; where it may touch
//! several, only values are enclosed, by the hull over the cells.

use ntg_splines::{AxisParts, Symmetry};

use crate::interval::Interval;
use crate::jet::Jet;
use crate::statement::Table;

/// Most combinations of cells that are looked at; beyond, nothing is said and the box is halved.
const MOST_CELLS: usize = 512;

/// Where an argument may be: a cell, and the coordinate in it.
#[derive(Clone, Copy)]
struct Place<const N: usize> {
    cell: usize,
    local: Jet<N>,
    /// How far beyond the end of the table, where it is outside.
    beyond: Option<Jet<N>>,
    /// -1 on the mirrored side of an even argument.
    sign: f64,
}

/// A derivative of a table at these arguments.
pub(crate) fn look_up<const N: usize>(table: &Table, derivative: &[u8], args: &[Jet<N>]) -> Jet<N> {
    let total = args.iter().all(|x| x.total);
    let mut places = vec![];
    for (axis, x) in table.axes.iter().zip(args) {
        match places_of(axis, x) {
            Some(found) => places.push(found),
            None => return Jet::rough(Interval::ENTIRE, total),
        }
    }
    let combinations = places.iter().fold(1, |product: usize, found| product.saturating_mul(found.len()));
    if combinations == 0 || combinations > MOST_CELLS {
        return Jet::rough(Interval::ENTIRE, total);
    }
    let at = |mut number: usize| -> Vec<Place<N>> {
        let pick = |found: &Vec<Place<N>>| {
            let place = found[number % found.len()];
            number /= found.len();
            place
        };
        places.iter().map(pick).collect()
    };
    if combinations == 1 {
        return Jet { total, ..contract(table, derivative, &at(0), (0, 0)) };
    }
    let values = (0..combinations).map(|number| {
        let mut here = at(number);
        // Only values are wanted, so the coordinates are numbers.
        here.iter_mut().for_each(|place| {
            place.local = Jet::constant(place.local.c[0]);
            place.beyond = place.beyond.map(|beyond| Jet::constant(beyond.c[0]));
        });
        contract(table, derivative, &here, (0, 0)).c[0]
    });
    Jet::rough(values.reduce(Interval::hull).unwrap_or(Interval::ENTIRE), total)
}

/// Every cell that the argument may touch; none where that is not known.
fn places_of<const N: usize>(axis: &AxisParts, x: &Jet<N>) -> Option<Vec<Place<N>>> {
    if !x.c[0].is_bounded() {
        return None;
    }
    let mut found = vec![];
    match axis.symmetry {
        Symmetry::Plain => cells_of(axis, x, 1.0, &mut found),
        Symmetry::Even => {
            if x.c[0].high() >= 0.0 {
                cells_of(axis, &clipped(x, 0.0, f64::INFINITY), 1.0, &mut found);
            }
            if x.c[0].low() < 0.0 {
                cells_of(axis, &clipped(&-*x, 0.0, f64::INFINITY), -1.0, &mut found);
            }
        }
        Symmetry::Periodic => {
            let period = Interval::point(axis.ends.1) - Interval::point(axis.ends.0);
            let turns = (x.c[0] - Interval::point(axis.ends.0)).over(period);
            let (first, last) = (turns.low().floor(), turns.high().floor());
            if !(last - first <= 3.0 && first.abs() < 1e9) {
                return None;
            }
            for turn in 0..=(last - first) as u32 {
                let moved = *x - Jet::constant(period * (first + f64::from(turn)));
                if let Some(inside) = moved.c[0].within(axis.ends.0, axis.ends.1) {
                    cells_of(axis, &Jet { c: with_first(&moved, inside), ..moved }, 1.0, &mut found);
                }
            }
        }
    }
    Some(found)
}

fn with_first<const N: usize>(x: &Jet<N>, value: Interval) -> [Interval; N] {
    let mut c = x.c;
    c[0] = value;
    c
}

/// The part between two numbers, which is not empty.
fn clipped<const N: usize>(x: &Jet<N>, low: f64, high: f64) -> Jet<N> {
    Jet { c: with_first(x, x.c[0].within(low, high).unwrap_or(x.c[0])), ..*x }
}

/// Adds the cells of an argument that has been mirrored or moved into its period.
fn cells_of<const N: usize>(axis: &AxisParts, x: &Jet<N>, sign: f64, found: &mut Vec<Place<N>>) {
    let (low, high) = (axis.ends.0, axis.ends.1);
    let range = x.c[0];
    let last = axis.cells.len() - 1;
    let outside = |cell: usize, end: f64| {
        let local =
            (Interval::point(end) - Interval::point(axis.cells[cell].0)).over(Interval::point(axis.cells[cell].1));
        let beyond = *x - Jet::constant(Interval::point(end));
        (Jet::constant(local), beyond)
    };
    // An even argument is not negative here, and has no lower end.
    if axis.symmetry != Symmetry::Even && range.low() < low {
        let (local, beyond) = outside(0, low);
        let beyond = clipped(&beyond, f64::NEG_INFINITY, 0.0);
        found.push(Place { cell: 0, local, beyond: Some(beyond), sign });
    }
    for (cell, (begin, width)) in axis.cells.iter().enumerate() {
        let from = if cell == 0 && axis.symmetry != Symmetry::Even { low } else { *begin };
        let to = axis.cells.get(cell + 1).map_or(high, |next| next.0);
        let Some(inside) = range.within(from, to) else { continue };
        let x = Jet { c: with_first(x, inside), ..*x };
        let local = (x - Jet::constant(Interval::point(*begin))).over(&Jet::constant(Interval::point(*width)));
        found.push(Place { cell, local: Jet { total: true, ..local }, beyond: None, sign });
    }
    if range.high() > high {
        let (local, beyond) = outside(last, high);
        let beyond = clipped(&beyond, 0.0, f64::INFINITY);
        found.push(Place { cell: last, local, beyond: Some(beyond), sign });
    }
}

/// The tensor product from argument `axis` on, whose first active coefficient is `first`.
fn contract<const N: usize>(
    table: &Table,
    derivative: &[u8],
    places: &[Place<N>],
    (axis, first): (usize, usize),
) -> Jet<N> {
    let Some(place) = places.get(axis) else {
        return Jet::constant(table.coefficients.get(first).map_or(Interval::ENTIRE, |c| Interval::point(*c)));
    };
    let parts = &table.axes[axis];
    let stride: usize = table.axes[axis + 1..].iter().map(|inner| inner.coefficients).product();
    let start = first + place.cell * parts.step * stride;
    let inner: Vec<Jet<N>> =
        (0..parts.order).map(|j| contract(table, derivative, places, (axis + 1, start + j * stride))).collect();
    let weights = &parts.weights[place.cell * parts.order * parts.order..][..parts.order * parts.order];
    let bernstein: Vec<Jet<N>> = weights
        .chunks_exact(parts.order)
        .map(|row| {
            let terms = row.iter().zip(&inner).filter(|(w, _)| **w != 0.0);
            let scaled = terms.map(|(w, c)| if *w == 1.0 { *c } else { Jet::constant(Interval::point(*w)) * *c });
            scaled.reduce(|a, b| a + b).unwrap_or(Jet::constant(Interval::ZERO))
        })
        .collect();
    let d = usize::from(derivative[axis]);
    let width = Interval::point(parts.cells[place.cell].1);
    let value = match &place.beyond {
        None => polynomial(&bernstein, &place.local, d, width),
        Some(beyond) => match (table.linear_outside, d) {
            (_, 0) if !table.linear_outside => polynomial(&bernstein, &place.local, 0, width),
            (true, 0) => {
                let slope = polynomial(&bernstein, &place.local, 1, width);
                polynomial(&bernstein, &place.local, 0, width) + *beyond * slope
            }
            (true, 1) => polynomial(&bernstein, &place.local, 1, width),
            _ => Jet::constant(Interval::ZERO),
        },
    };
    if d % 2 == 1 && place.sign < 0.0 { -value } else { value }
}

/// Derivative `d` of a polynomial in Bernstein form at `u`, on a cell of this width.
fn polynomial<const N: usize>(bernstein: &[Jet<N>], u: &Jet<N>, d: usize, width: Interval) -> Jet<N> {
    let mut row = bernstein.to_vec();
    if d >= row.len() {
        return Jet::constant(Interval::ZERO);
    }
    let mut factor = Interval::ONE;
    for _ in 0..d {
        factor = (factor * ((row.len() - 1) as f64)).over(width);
        row = row.windows(2).map(|pair| pair[1] - pair[0]).collect();
    }
    let hull = row.iter().map(|b| b.c[0]).reduce(Interval::hull).unwrap_or(Interval::ENTIRE);
    while row.len() > 1 {
        row = row.windows(2).map(|pair| pair[0] + *u * (pair[1] - pair[0])).collect();
    }
    let mut value = row[0];
    if Interval::of_constants(0.0, 1.0).encloses(u.c[0]) {
        value.c[0] = value.c[0].meet(hull);
    }
    Jet::constant(factor) * value
}
