//! Equations with points at which all of their slopes vanish and at which branches of their solutions meet.
//!
//! Where `(x - y)^2 == 0` holds, its rate vanishes whatever the motion; where branches of `x * y == 0` meet, that does not say on
//! which one the motion goes on. Such an equation follows from no derivative of it. The apex of a cone is no such point: few
//! motions go through it.

use super::Candidate;
use super::draws;
use super::motion::Motion;
use super::sample::{Budget, Point};
use super::surface::{self, Row};
use crate::expr::{Node, NodeId, gradient};
use crate::model::elaborator::Elaborator;
use crate::model::problem::Leaf;

/// Points from which such a point is looked for. A choice: what is at most of second order is found from any.
const DRAWS: usize = 3;
/// Steps of Newton's method, which slopes that vanish make fast.
const STEPS: usize = 12;
/// With so many independent second derivatives and fewer, branches meet: one is a square, two a product.
const MEETING: usize = 2;

impl Elaborator<'_> {
    /// Whether the solutions of an equation have no branches that meet, as far as that is found; sums are not looked at.
    pub(super) fn is_regular(&mut self, motion: &Motion, own: &Candidate, budget: &mut Budget) -> bool {
        let Some(row) = own.rows.first() else { return true };
        let dag = &mut self.problem.dag;
        if dag.schedule(&[row.body]).iter().any(|id| matches!(dag.node(*id), Node::Reduce { .. })) {
            return true;
        }
        let inputs = dag.inputs_of(&[row.body]);
        let is_state = |input: &_| matches!(self.problem.leaves.leaf(*input), Leaf::Flat { .. });
        let states: Vec<_> = inputs.into_iter().filter(is_state).collect();
        let Ok(slopes) = gradient(dag, row.body, &states) else { return true };
        let is_slope = |node: &NodeId| dag.is_constant(*node).is_some_and(|value| value != 0.0);
        if slopes.iter().any(is_slope) {
            return true;
        }
        let zero = dag.constant(0.0);
        let slopes: Vec<Row> = slopes.into_iter().map(|body| Row { body, bound: zero, ..row.clone() }).collect();
        let slopes: Vec<&Row> = slopes.iter().collect();
        let all: Vec<&Row> = [row].into_iter().chain(slopes.iter().copied()).collect();
        let is_meeting = |draw| {
            let mut point = Point::new(&self.problem, motion, draw, budget);
            row.miss(&mut point);
            let mut states = std::mem::take(&mut point.met);
            states.sort_unstable();
            states.dedup();
            surface::reach(&all, &states, &mut point, STEPS)
                && surface::slopes(&slopes, &states, &mut point).is_some_and(|curved| surface::rank(curved) <= MEETING)
        };
        !draws(300, motion.has_branches).take(DRAWS).any(is_meeting)
    }
}
