//! What every operation of the language means: the functions of `ntg-math`, and tables.
//!
//! Generated code and the interpreter call these and no others, so that both give the same bits
//! (docs/maths.md, section 2.8).

pub use ntg_math::*;
use ntg_splines::Table;

/// Partial derivatives of a table in every lane, all at the same place: `orders[k][i]` times with
/// respect to argument `i`.
#[inline(always)]
pub fn table<S: Simd, const N: usize, const K: usize>(
    simd: S,
    table: &Table,
    args: [Pack<S>; N],
    orders: [[u8; N]; K],
) -> [Pack<S>; K] {
    let mut out = [[0.0; MOST_LANES]; K];
    table.look_up(S::LANES, &args.map(Pack::to_array), orders.as_flattened(), &mut out);
    out.map(|derivative| Pack::load(simd, &derivative))
}
