//! Corners in equations, `der(m) == -c * norm(F)` (docs/maths.md, equation 18.6).
//!
//! Takes equations that hold all along a phase, and those of the whole mission; a helper stands for each corner that is a
//! summand in them, or a factor of one, held on the convex side of the corner alone. Whether the solution has it at the
//! corner is seen when it is known: each [`Relaxation`] has the rows that hold the helper beside its corner, and those that
//! hold it at the corner, of which a solver poses the ones or the others. Signs decide nothing here.

use super::corners::{Corners, Site};
use super::elaborator::Elaborator;
use super::problem::{Bounds, Domain, Imposed, Leaf, Part};
use super::unknowns::is_given;
use crate::expr::{Binary, Fold, Map, Node, NodeId, Unary};
use ntg_structure::Relaxation;

/// How deep equations are looked into; deeper corners stay.
const MAX_DEPTH: usize = 500;

/// The helpers that stand for corners of equations.
type Known = Map<(NodeId, Site), NodeId>; // Looked up, never iterated.

impl Elaborator<'_> {
    /// Takes the corners out of equations.
    pub(super) fn corners_relaxed(&mut self, pass: &mut Corners) {
        let mut known = Known::default();
        for number in 0..self.problem.constraints.len() {
            let own = &self.problem.constraints[number];
            let is_equation = own.bounds.lower.is_some() && own.bounds.lower == own.bounds.upper;
            if !is_equation || own.imposed != Imposed::Everywhere || !pass.has_corners(own.body) {
                continue;
            }
            let along = match &own.domain {
                Domain::Path(phase, part) if *part == Part::WHOLE => Some(phase.clone()),
                Domain::Mission => None,
                _ => continue,
            };
            let (body, site) = (own.body, Site { loops: own.loops.clone(), along, floats: false });
            pass.span = own.span;
            let relaxed = self.relaxed(pass, &mut known, (body, false), &site, 0);
            if relaxed != body {
                self.origin(relaxed, pass.span);
                let own = &mut self.problem.constraints[number];
                (own.body, own.written) = (relaxed, Some(body));
            }
        }
    }

    /// An equation's node in which helpers stand for corners; `is_multiplied` says whether it is multiplied by what is solved
    /// for.
    fn relaxed(
        &mut self,
        pass: &mut Corners,
        known: &mut Known,
        (node, is_multiplied): (NodeId, bool),
        site: &Site,
        depth: usize,
    ) -> NodeId {
        if depth > MAX_DEPTH || !pass.has_corners(node) || pass.smoothed.contains(&node) {
            return node;
        }
        if let Some(helper) = known.get(&(node, site.clone())) {
            return *helper;
        }
        if let Some(sum) = pass.branches.get(&node).copied() {
            let relaxed = self.relaxed(pass, known, (sum, is_multiplied), site, depth + 1);
            return if self.has_none(pass, relaxed) { relaxed } else { node };
        }
        let own = self.problem.dag.node(node).clone();
        match own {
            Node::Unary(Unary::Neg, _)
            | Node::Binary(Binary::Add | Binary::Sub | Binary::Mul | Binary::Div, ..)
            | Node::Reduce { fold: Fold::Sum, .. } => {
                let mut inner = site.clone();
                if let Node::Reduce { range, .. } = own {
                    inner.loops.push(self.problem.ranges[range as usize].clone());
                }
                let is_product = matches!(own, Node::Binary(Binary::Mul | Binary::Div, ..));
                let operands = own.operands();
                let mut images: Map<NodeId, NodeId> = Map::default();
                for (at, operand) in operands.iter().enumerate() {
                    let is_divisor = at > 0 && matches!(own, Node::Binary(Binary::Div, ..));
                    let others = operands.iter().enumerate().filter(|(other, _)| *other != at);
                    let by_unknown = is_product && others.into_iter().any(|(_, other)| !is_given(&self.problem, *other));
                    let image = match is_divisor {
                        true => *operand,
                        false => self.relaxed(pass, known, (*operand, is_multiplied || by_unknown), &inner, depth + 1),
                    };
                    images.insert(*operand, image);
                }
                self.problem.dag.rebuild(&own, |operand| images[&operand])
            }
            Node::Input(input) => match self.problem.leaves.leaf(input).clone() {
                Leaf::Integral { phase, integrand } if site.along.is_none() => {
                    let along = Site { along: Some(phase.clone()), ..site.clone() };
                    let integrand = self.relaxed(pass, known, (integrand, is_multiplied), &along, depth + 1);
                    self.leaf(Leaf::Integral { phase, integrand })
                }
                _ => node,
            },
            // What a distance is a factor of seldom vanishes with it: gravitation, a spring.
            Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Hypot, ..) if is_multiplied => node,
            _ => {
                let helper = self.relaxation(pass, (node, site), depth);
                known.extend(helper.map(|helper| ((node, site.clone()), helper)));
                helper.unwrap_or(node)
            }
        }
    }

    /// A helper beside a corner with the rows that hold it there; none where nothing is known of the corner's sides.
    fn relaxation(&mut self, pass: &mut Corners, (corner, site): (NodeId, &Site), depth: usize) -> Option<NodeId> {
        let (before, helpers) = (self.problem.constraints.len(), pass.made.len());
        if !self.has_one_corner(pass, corner) {
            return None;
        }
        let found = [true, false].into_iter().find_map(|growing| self.helper(pass, corner, (site, growing), depth))?;
        pass.treated.insert(corner);
        let sides = (before..self.problem.constraints.len()).collect();
        let first = self.problem.constraints.len();
        let zero = self.problem.dag.constant(0.0);
        for made in pass.made.split_off(helpers) {
            let body = self.problem.dag.sub(made.helper, made.corner);
            let equal = Bounds { lower: Some(zero), upper: Some(zero) };
            self.hold_helper(&made.site, vec![], (body, equal), made.span);
            pass.relaxed.push(made.span);
        }
        let exact = (first..self.problem.constraints.len()).collect();
        self.problem.relaxations.push(Relaxation { sides, exact, is_exact: false });
        Some(found)
    }

    /// Whether the sides of a corner have no corners; `max(a, max(b, c))` is one with three sides.
    fn has_one_corner(&self, pass: &Corners, corner: NodeId) -> bool {
        let own = self.problem.dag.node(corner).clone();
        own.operands().into_iter().filter(|side| pass.has_corners(*side)).all(|side| {
            match (&own, self.problem.dag.node(side)) {
                (Node::Binary(one, ..), Node::Binary(other, ..)) if one == other => self.has_one_corner(pass, side),
                _ => false,
            }
        })
    }
}
