//! Constraints that are met where their bodies are least, and nowhere else: `norm(r - pad) == 0`, `cos(psi - north) == 1`.
//!
//! Such a body has no gradient where the constraint holds, so that no multiplier makes the point stationary (docs/maths.md,
//! equation 18.10). Takes a body and its bounds; where the body is a sum of terms each of which is least, gives the constraint as those
//! on what vanishes there, which have gradients: `r - pad == 0`; `sin(psi - north) == 0` and `cos(psi - north) >= 0`.

use super::constraints::Body;
use super::dimension::{Dimension, Ratio};
use super::elaborator::Elaborator;
use super::problem::Bounds;
use super::value::Value;
use crate::expr::{Binary, Fold, Node, NodeId, Unary};

/// How deep terms stand in one another; of deeper ones nothing is known.
const MAX_DEPTH: usize = 50;
/// Most members of a sum over an index that are written out, and most terms of all. A choice.
const MOST_TERMS: usize = 64;
/// Constants of a sum cancel where they leave this part of them. Rounding of a sine and a cosine that were computed.
const ROUNDING: f64 = 1e-12;

/// What is 0 where a term is least, and the power of the dimension of the whole that it has.
type Zero = (NodeId, f64);

/// `cosine * cos(angle) + sine * sin(angle)`.
struct Wave {
    angle: NodeId,
    cosine: f64,
    sine: f64,
}

/// The terms of a sum, each of which has a least value.
#[derive(Default)]
struct Terms {
    constant: f64,
    zeros: Vec<Zero>,
    waves: Vec<Wave>,
}

impl Elaborator<'_> {
    /// A constraint; in the place of one that is met only where its body is least, those on what vanishes there.
    pub(super) fn regular(&mut self, body: Body) -> Vec<Body> {
        let Some(terms) = self.least(&body) else { return vec![body] };
        let (whole, span) = (body.value.dimension_or_none(), body.value.span);
        let zero = self.problem.dag.constant(0.0);
        let [equation, ahead] = [Some(zero), None].map(|upper| Bounds { lower: Some(zero), upper });
        let mut rows = vec![];
        for (node, power) in terms.zeros {
            rows.push((node, whole.power(Ratio::of(power).unwrap_or(Ratio::whole(1))), equation.clone()));
        }
        for wave in terms.waves {
            let [across, along] = self.across_and_along(&wave);
            rows.extend([(across, Dimension::NONE, equation.clone()), (along, Dimension::NONE, ahead.clone())]);
        }
        let own = rows.into_iter().map(|(node, dimension, bounds)| {
            let value = Value::new(node, dimension, span);
            let unit = self.shown(&[&value]);
            Body { value, bounds, unit }
        });
        own.collect()
    }

    /// Sine and cosine of an angle less the angle at which a wave is least.
    fn across_and_along(&mut self, wave: &Wave) -> [NodeId; 2] {
        let dag = &mut self.problem.dag;
        let [east, north] = [wave.cosine, wave.sine].map(|part| dag.constant(-part / wave.cosine.hypot(wave.sine)));
        let [cos, sin] = [Unary::Cos, Unary::Sin].map(|op| dag.unary(op, wave.angle));
        let [a, b] = [(sin, east), (cos, north)].map(|(factor, part)| dag.mul(factor, part));
        let across = dag.sub(a, b);
        let [a, b] = [(cos, east), (sin, north)].map(|(factor, part)| dag.mul(factor, part));
        [across, dag.add(a, b)]
    }

    /// The terms of a body that meets its bounds only where all of them are least.
    fn least(&mut self, body: &Body) -> Option<Terms> {
        let number = |bound: Option<NodeId>| bound.map(|bound| self.problem.dag.is_constant(bound));
        let (lower, upper) = match (number(body.bounds.lower), number(body.bounds.upper)) {
            (Some(Some(lower)), Some(Some(upper))) if lower == upper => (Some(lower), Some(upper)),
            (Some(lower), None) => (lower, None),
            (None, Some(upper)) => (None, upper),
            _ => return None,
        };
        let mut terms_from = |factor: f64, bound: f64| {
            let mut terms = Terms { constant: -factor * bound, ..Terms::default() };
            self.collect(&mut terms, (body.value.node, factor), 1.0, 0)?;
            // Waves may cancel.
            terms.waves.retain(|wave| wave.cosine.hypot(wave.sine) > 0.0);
            let depth: f64 = terms.waves.iter().map(|wave| wave.cosine.hypot(wave.sine)).sum();
            let is_least = (terms.constant - depth).abs() <= ROUNDING * depth;
            (is_least && (1..=MOST_TERMS).contains(&(terms.zeros.len() + terms.waves.len()))).then_some(terms)
        };
        upper.and_then(|bound| terms_from(1.0, bound)).or_else(|| lower.and_then(|bound| terms_from(-1.0, bound)))
    }

    /// Adds the terms of a node times a factor to others; none where a term has no least value that is known.
    fn collect(&mut self, terms: &mut Terms, (node, factor): (NodeId, f64), power: f64, depth: usize) -> Option<()> {
        if depth > MAX_DEPTH || terms.zeros.len() > MOST_TERMS {
            return None;
        }
        let constant = |node: NodeId| self.problem.dag.is_constant(node);
        let parts = match *self.problem.dag.node(node) {
            Node::Const(number) => {
                terms.constant += factor * number.value();
                vec![]
            }
            Node::Unary(Unary::Neg, x) => vec![(x, -factor)],
            Node::Unary(op @ (Unary::Cos | Unary::Sin), angle) => {
                let (cosine, sine) = if op == Unary::Cos { (factor, 0.0) } else { (0.0, factor) };
                match terms.waves.iter_mut().find(|wave| wave.angle == angle) {
                    Some(wave) => (wave.cosine, wave.sine) = (wave.cosine + cosine, wave.sine + sine),
                    None => terms.waves.push(Wave { angle, cosine, sine }),
                }
                vec![]
            }
            Node::Binary(Binary::Add, a, b) => vec![(a, factor), (b, factor)],
            Node::Binary(Binary::Sub, a, b) => vec![(a, factor), (b, -factor)],
            Node::Binary(Binary::Div, a, b) if constant(b).is_some_and(|b| b != 0.0) => {
                vec![(a, factor / constant(b).expect("a number"))]
            }
            Node::Binary(Binary::Mul, a, b) if constant(a).is_some() => {
                vec![(b, factor * constant(a).expect("a number"))]
            }
            Node::Binary(Binary::Mul, a, b) if constant(b).is_some() => {
                vec![(a, factor * constant(b).expect("a number"))]
            }
            Node::Reduce { fold: Fold::Sum, .. } => vec![(self.unrolled(node, MOST_TERMS as i64)?, factor)],
            _ if factor > 0.0 => return self.vanish(terms, (node, factor), power, depth + 1),
            _ => return None,
        };
        parts.into_iter().try_for_each(|part| self.collect(terms, part, power, depth + 1))
    }

    /// Adds what is 0 where a node that is never negative is 0; none where it may be negative.
    fn vanish(&mut self, terms: &mut Terms, (node, factor): (NodeId, f64), power: f64, depth: usize) -> Option<()> {
        match *self.problem.dag.node(node) {
            Node::Unary(Unary::Sqrt, x) => self.vanish_inner(terms, (x, factor.powi(2)), 2.0 * power, depth),
            Node::Unary(Unary::Abs, x) => {
                self.zero(terms, (x, factor), power, depth);
                Some(())
            }
            Node::Powi(x, n) if n > 0 && n % 2 == 0 => {
                let root = 1.0 / f64::from(n);
                self.zero(terms, (x, factor.powf(root)), power * root, depth);
                Some(())
            }
            Node::Binary(Binary::Mul, a, b) if a == b => {
                self.zero(terms, (a, factor.sqrt()), power / 2.0, depth);
                Some(())
            }
            Node::Binary(Binary::Hypot, a, b) => {
                [a, b].into_iter().for_each(|x| self.zero(terms, (x, factor), power, depth));
                Some(())
            }
            Node::Binary(Binary::Max, a, b) => {
                [a, b].into_iter().try_for_each(|x| self.vanish_inner(terms, (x, factor), power, depth))
            }
            _ => None,
        }
    }

    /// Adds what is 0 where a node is that is a sum of its own; none where it may be negative.
    fn vanish_inner(&mut self, terms: &mut Terms, own: (NodeId, f64), power: f64, depth: usize) -> Option<()> {
        let mut inner = Terms::default();
        self.collect(&mut inner, own, power, depth + 1)?;
        if !inner.waves.is_empty() || inner.constant != 0.0 {
            return None;
        }
        terms.zeros.append(&mut inner.zeros);
        Some(())
    }

    /// Adds a node that is to be 0, or what is 0 where it is least.
    fn zero(&mut self, terms: &mut Terms, (node, factor): (NodeId, f64), power: f64, depth: usize) {
        if self.vanish_inner(terms, (node, factor), power, depth).is_none() {
            let dag = &mut self.problem.dag;
            let factor = dag.constant(factor);
            terms.zeros.push((dag.mul(factor, node), power));
        }
    }
}
