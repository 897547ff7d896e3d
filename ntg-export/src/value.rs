//! Values of a kernel's expressions: a linear part that is known as numbers, and a nonlinear rest.
//!
//! Additions and products with numbers keep the two apart, so that the linear part of a row comes out as coefficients,
//! whatever the formula looked like.

use crate::graph::{Affine, Binary, Graph, Id};

/// `affine + rest`.
#[derive(Clone, Debug, Default)]
pub(crate) struct Value {
    pub(crate) affine: Affine,
    pub(crate) rest: Option<Id>,
}

impl Value {
    pub(crate) fn constant(constant: f64) -> Self {
        Self { affine: Affine { constant, terms: vec![] }, rest: None }
    }

    pub(crate) fn nonlinear(rest: Id) -> Self {
        Self { affine: Affine::default(), rest: Some(rest) }
    }

    /// The number that it is, if it depends on nothing.
    pub(crate) fn number(&self) -> Option<f64> {
        (self.rest.is_none() && self.affine.terms.is_empty()).then_some(self.affine.constant)
    }

    /// As one expression.
    pub(crate) fn id(&self, graph: &mut Graph) -> Id {
        match self.rest {
            None => graph.affine(&self.affine),
            Some(rest) if self.affine == Affine::default() => rest,
            Some(rest) => {
                let affine = graph.affine(&self.affine);
                graph.binary(Binary::Add, affine, rest)
            }
        }
    }

    /// `self + factor * other`.
    pub(crate) fn plus(&self, factor: f64, other: &Self, graph: &mut Graph) -> Self {
        let other = other.times(factor, graph);
        let rest = match (self.rest, other.rest) {
            (Some(a), Some(b)) => Some(graph.binary(Binary::Add, a, b)),
            (a, b) => a.or(b),
        };
        Self { affine: sum(&self.affine, &other.affine), rest }
    }

    /// `factor * self`.
    pub(crate) fn times(&self, factor: f64, graph: &mut Graph) -> Self {
        if factor == 1.0 {
            return self.clone();
        }
        let terms = self.affine.terms.iter().map(|(variable, c)| (*variable, factor * c)).filter(|(_, c)| *c != 0.0);
        let affine = Affine { constant: factor * self.affine.constant, terms: terms.collect() };
        let rest = self.rest.filter(|_| factor != 0.0).map(|rest| {
            let factor = graph.constant(factor);
            graph.binary(Binary::Mul, factor, rest)
        });
        Self { affine, rest }
    }
}

/// The sum of two affine functions.
fn sum(a: &Affine, b: &Affine) -> Affine {
    let mut terms = Vec::with_capacity(a.terms.len() + b.terms.len());
    let (mut left, mut right) = (a.terms.iter().peekable(), b.terms.iter().peekable());
    while let (Some((i, x)), Some((j, y))) = (left.peek(), right.peek()) {
        if i == j {
            terms.push((*i, x + y));
        } else if i < j {
            terms.push((*i, *x));
        } else {
            terms.push((*j, *y));
        }
        let (i, j) = (*i, *j);
        left.next_if(|_| i <= j);
        right.next_if(|_| j <= i);
    }
    terms.extend(left.chain(right));
    terms.retain(|(_, c)| *c != 0.0);
    Affine { constant: a.constant + b.constant, terms }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn linear_parts_stay_numbers() {
        let mut graph = Graph::default();
        let of =
            |terms: &[(u32, f64)], constant| Value { affine: Affine { constant, terms: terms.to_vec() }, rest: None };
        let a = of(&[(0, 1.0), (2, 3.0)], 1.0);
        let b = of(&[(1, 5.0), (2, 1.5), (4, 1.0)], 2.0);
        let sum = a.plus(-2.0, &b, &mut graph);
        assert_eq!(sum.affine, Affine { constant: -3.0, terms: vec![(0, 1.0), (1, -10.0), (4, -2.0)] });
        assert_eq!(sum.plus(-1.0, &sum, &mut graph).number(), Some(0.0));
    }
}
