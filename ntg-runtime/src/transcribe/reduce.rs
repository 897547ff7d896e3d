//! Sums, products, minima and maxima over the members of a reduction, with their derivatives by
//! the members (docs/maths.md, equations 4.8 to 4.11).
//!
//! Arrays hold all elements of one copy side by side.

use super::node::Edge;
use ntg_structure::ReduceOp;

/// Writes the results for every copy above from the values of the copies below.
pub(crate) fn values(edge: &Edge, elements: usize, members: &[f64], results: &mut [f64]) {
    for (copy, out) in results.chunks_exact_mut(elements).enumerate() {
        out.fill(neutral(edge.op));
        for member in edge.first[copy]..edge.first[copy + 1] {
            for (result, value) in out.iter_mut().zip(&members[member * elements..][..elements]) {
                *result = combine(edge.op, *result, *value);
            }
        }
    }
}

/// Writes the derivative of the result by each member (equations 4.9 to 4.11).
pub(crate) fn factors(edge: &Edge, elements: usize, members: &[f64], factor: &mut [f64]) {
    for copy in 0..edge.first.len() - 1 {
        let range = edge.first[copy]..edge.first[copy + 1];
        match edge.op {
            ReduceOp::Sum => factor[range.start * elements..range.end * elements].fill(1.0),
            ReduceOp::Product => {
                for member in range.clone() {
                    for e in 0..elements {
                        let others = range.clone().filter(|other| *other != member);
                        factor[member * elements + e] = others.map(|other| members[other * elements + e]).product();
                    }
                }
            }
            ReduceOp::Min | ReduceOp::Max => {
                for e in 0..elements {
                    let active = active(edge.op, range.clone(), |member| members[member * elements + e]);
                    for member in range.clone() {
                        factor[member * elements + e] = f64::from(Some(member) == active);
                    }
                }
            }
        }
    }
}

/// The product of the members other than two: the second derivative of a product (equation 4.10).
pub(crate) fn without_two(
    members: &[f64],
    elements: usize,
    range: (usize, usize),
    pair: (usize, usize),
    e: usize,
) -> f64 {
    let others = (range.0..range.1).filter(|member| *member != pair.0 && *member != pair.1);
    others.map(|member| members[member * elements + e]).product()
}

fn neutral(op: ReduceOp) -> f64 {
    match op {
        ReduceOp::Sum => 0.0,
        ReduceOp::Product => 1.0,
        ReduceOp::Min => f64::INFINITY,
        ReduceOp::Max => f64::NEG_INFINITY,
    }
}

fn combine(op: ReduceOp, a: f64, b: f64) -> f64 {
    match op {
        ReduceOp::Sum => a + b,
        ReduceOp::Product => a * b,
        ReduceOp::Min => crate::math::min(a, b),
        ReduceOp::Max => crate::math::max(a, b),
    }
}

/// The member that decides a minimum or maximum: the first of equals, or one that is not a number.
fn active(op: ReduceOp, mut range: std::ops::Range<usize>, value: impl Fn(usize) -> f64) -> Option<usize> {
    let first = range.next()?;
    Some(range.fold(first, |best, member| {
        let (held, new) = (value(best), value(member));
        let better = if op == ReduceOp::Min { new < held } else { new > held };
        if better || (new.is_nan() && !held.is_nan()) { member } else { best }
    }))
}
