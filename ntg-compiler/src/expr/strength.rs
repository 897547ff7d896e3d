//! The same formulas with cheaper operations.
//!
//! A division takes as long as a dozen multiplications, and derivatives divide by the same few
//! numbers again and again. Takes finished roots, gives roots that multiply by the inverse of a
//! constant, or of a number that several quotients divide by (made once), and that take a power
//! with half an odd number as its exponent by multiplication and a square root.
//!
//! This changes the last place of a result, so it is done once, after differentiation, and to all
//! roots of a kernel together: values alone and values beside derivatives keep the same bits
//! (docs/maths.md, section 2.9).

use super::dag::Dag;
use super::hash::Map;
use super::node::{Binary, Node, NodeId};

/// Larger exponents are left to the general power.
const LARGEST_HALF: f64 = 8.5;

impl Dag {
    /// The roots, computed with fewer divisions and powers.
    pub fn strengthened(&mut self, roots: &[NodeId]) -> Vec<NodeId> {
        let schedule = self.schedule(roots);
        let mut quotients: Map<NodeId, usize> = Map::default(); // By divisor; looked up, never iterated.
        for id in &schedule {
            if let Node::Binary(Binary::Div, _, divisor) = self.node(*id) {
                *quotients.entry(*divisor).or_default() += 1;
            }
        }
        let mut images: Map<NodeId, NodeId> = Map::default();
        for id in schedule {
            let node = self.node(id).clone();
            let image = match node {
                Node::Binary(Binary::Div, a, b) => self.quotient((images[&a], images[&b]), quotients[&b] > 1),
                Node::Binary(Binary::Pow, a, b) => self.half_power(images[&a], images[&b]),
                _ if node.operands().iter().all(|x| images[x] == *x) => id,
                _ => self.rebuild(&node, |x| images[&x]),
            };
            images.insert(id, image);
        }
        roots.iter().map(|root| images[root]).collect()
    }

    /// `a / b`, as a product if the inverse of `b` is a constant, or `shared` with other quotients.
    fn quotient(&mut self, (a, b): (NodeId, NodeId), shared: bool) -> NodeId {
        let inverse = match self.is_constant(b) {
            Some(divisor) if (1.0 / divisor).is_normal() => self.constant(1.0 / divisor),
            None if shared => {
                let one = self.constant(1.0);
                self.div(one, b)
            }
            _ => return self.div(a, b),
        };
        self.mul(a, inverse)
    }

    /// `a^b`; where `b` is `n` and a half, `a^n sqrt(a)`.
    fn half_power(&mut self, a: NodeId, b: NodeId) -> NodeId {
        let Some(exponent) = self.is_constant(b).filter(|x| x.abs() <= LARGEST_HALF && (x.abs() % 1.0) == 0.5) else {
            return self.pow(a, b);
        };
        #[expect(clippy::cast_possible_truncation, reason = "a small number, as just compared")]
        let whole = exponent.abs().floor() as i32;
        let (power, root) = (self.powi(a, whole), self.sqrt(a));
        let product = self.mul(power, root);
        if exponent < 0.0 { self.powi(product, -1) } else { product }
    }
}
