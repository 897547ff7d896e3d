//! Corners in equations, `der(m) == -c * norm(F)` (docs/maths.md, equation 18.5).
//!
//! Takes equations that hold all along a phase, and those of the whole mission. In another form of each a helper stands for
//! each corner that the equation is a smooth function of, and is held on the convex side of the corner alone. Whether the
//! solution has it at the corner is seen when it is known: a solver poses the one form or the other
//! (`ntg_structure::Relaxation`). Signs decide nothing here.

use super::corners::{Corners, Site};
use super::elaborator::Elaborator;
use super::monotone::Push;
use super::problem::{Bounds, Constraint, Domain, Imposed, Leaf, Part, Relaxation};
use super::unknowns::is_given;
use crate::expr::{Binary, Fold, Map, Node, NodeId, Unary};
use crate::source::Span;
use ntg_structure::{Block, Helper};

/// How deep equations are looked into; deeper corners stay.
const MAX_DEPTH: usize = 500;

/// A helper in equations.
#[derive(Clone)]
struct Used {
    node: NodeId,
    span: Span,
    /// Its rows; one that stands for a corner in what is minimised or limited too has its rows from there.
    held: Option<Helper>,
    /// Whether inputs have no part in the corner.
    has_states_alone: bool,
}

/// What a node of an equation is to the rest of it.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Role {
    /// A term, with given factors.
    Term,
    /// A factor of something that is solved for.
    Factor,
    /// What something is divided by, or the base of a power.
    Divisor,
}

/// What is known of the equations.
struct Known {
    /// The helpers, by what they stand for: equations share them, as work, wear and fuel of one thrust do.
    helpers: Map<(NodeId, Site), Used>, // Looked up, never iterated.
    /// Those of the equation in hand.
    used: Vec<Used>,
    /// The highest derivative of each output in all that is solved, by phase and output.
    orders: Map<(usize, usize), usize>, // Looked up, never iterated.
}

impl Elaborator<'_> {
    /// Gives equations with corners a form without.
    pub(super) fn corners_relaxed(&mut self, pass: &mut Corners) {
        let mut known = Known { helpers: Map::default(), used: vec![], orders: Map::default() };
        let bodies: Vec<NodeId> = self.problem.constraints.iter().map(|own| own.body).collect();
        for (place, order) in self.outputs_in(&bodies) {
            let highest = known.orders.entry(place).or_insert(0);
            *highest = order.max(*highest);
        }
        for number in 0..self.problem.constraints.len() {
            let own = &self.problem.constraints[number];
            let is_equation = own.bounds.lower.is_some() && own.bounds.lower == own.bounds.upper;
            if is_equation && own.imposed == Imposed::Everywhere && pass.has_corners(own.body) {
                self.equation_relaxed(pass, &mut known, number);
            }
        }
    }

    fn equation_relaxed(&mut self, pass: &mut Corners, known: &mut Known, number: usize) {
        let own = self.problem.constraints[number].clone();
        let along = match &own.domain {
            Domain::Path(phase, part) if *part == Part::WHOLE => Some(phase.clone()),
            Domain::Mission => None,
            _ => return,
        };
        let site = Site { loops: own.loops.clone(), along, push: Push::Steep };
        pass.span = own.span;
        let relaxed = self.relaxed(pass, known, (own.body, Role::Term), &site, 0);
        let used = std::mem::take(&mut known.used);
        if relaxed == own.body {
            return;
        }
        self.origin(relaxed, own.span);
        let other = self.problem.constraints.len();
        let as_written = Constraint { name: None, block: Block::Corner, written: None, ..own.clone() };
        self.problem.constraints.push(as_written);
        let equation = &mut self.problem.constraints[number];
        (equation.body, equation.written) = (relaxed, own.written.or(Some(own.body)));
        self.problem.relaxations.push(Relaxation {
            equation: number,
            other,
            helpers: used.iter().filter_map(|helper| helper.held.clone()).collect(),
            corners: used.iter().map(|helper| helper.span).collect(),
            exact_first: used.iter().all(|helper| helper.has_states_alone),
        });
    }

    /// An equation's node in which helpers stand for corners.
    fn relaxed(
        &mut self,
        pass: &mut Corners,
        known: &mut Known,
        (node, role): (NodeId, Role),
        site: &Site,
        depth: usize,
    ) -> NodeId {
        if depth > MAX_DEPTH || !pass.has_corners(node) || pass.smoothed.contains(&node) {
            return node;
        }
        if let Some(sum) = pass.branches.get(&node).copied() {
            let relaxed = self.relaxed(pass, known, (sum, role), site, depth + 1);
            if !self.has_none(pass, relaxed) {
                return node;
            }
            pass.treated.insert(node);
            return relaxed;
        }
        let own = self.problem.dag.node(node).clone();
        match own {
            _ if is_smooth(&own) => self.relaxed_below(pass, known, (&own, role), site, depth + 1),
            Node::Input(input) => match self.problem.leaves.leaf(input).clone() {
                Leaf::Integral { phase, integrand } if site.along.is_none() => {
                    let along = Site { along: Some(phase.clone()), ..site.clone() };
                    let integrand = self.relaxed(pass, known, (integrand, role), &along, depth + 1);
                    self.leaf(Leaf::Integral { phase, integrand })
                }
                _ => node,
            },
            Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Hypot, ..) if self.is_distance(known, node, role) => {
                node
            }
            _ => self.in_place_of(pass, known, node, (site, depth)).unwrap_or(node),
        }
    }

    /// A smooth function with helpers in its operands.
    fn relaxed_below(
        &mut self,
        pass: &mut Corners,
        known: &mut Known,
        (own, role): (&Node, Role),
        site: &Site,
        depth: usize,
    ) -> NodeId {
        let mut inner = site.clone();
        if let Node::Reduce { range, .. } = own {
            inner.loops.push(self.problem.ranges[*range as usize].clone());
        }
        let is_sum = matches!(
            own,
            Node::Unary(Unary::Neg, _) | Node::Binary(Binary::Add | Binary::Sub, ..) | Node::Reduce { .. }
        );
        let operands = own.operands();
        let mut images: Map<NodeId, NodeId> = Map::default();
        for (at, operand) in operands.iter().enumerate() {
            let mut others = operands.iter().enumerate().filter(|(other, _)| *other != at);
            let by_unknown = !is_sum && others.any(|(_, other)| !is_given(&self.problem, *other));
            let is_divisor = at > 0 && matches!(own, Node::Binary(Binary::Div, ..));
            let role = match role {
                _ if is_divisor || matches!(own, Node::Powi(..)) => Role::Divisor,
                Role::Term if by_unknown => Role::Factor,
                role => role,
            };
            let image = self.relaxed(pass, known, (*operand, role), &inner, depth);
            images.insert(*operand, image);
        }
        self.problem.dag.rebuild(own, |operand| images[&operand])
    }

    /// What stands for a corner; none where nothing is known of its sides. The greater and the lesser of two values are half their
    /// sum and half of how far they are apart, for which there is one helper: of `0.9 * max(p, 0) + min(p, 0) / 0.9` and
    /// `0.9 * max(p, 0) - max(-p, 0) / 0.9` either corner alone would be pushed away from its tip.
    fn in_place_of(
        &mut self,
        pass: &mut Corners,
        known: &mut Known,
        corner: NodeId,
        at: (&Site, usize),
    ) -> Option<NodeId> {
        let corner = self.helpers_within(pass, known, corner, at);
        let (a, b, is_greater) = match *self.problem.dag.node(corner) {
            Node::Binary(op @ (Binary::Max | Binary::Min), a, b) => (a, b, op == Binary::Max),
            _ => return self.held_beside(pass, known, corner, at),
        };
        if pass.has_corners(a) || pass.has_corners(b) {
            return self.held_beside(pass, known, corner, at);
        }
        let dag = &mut self.problem.dag;
        let (apart, sum) = (dag.sub(a, b), dag.add(a, b));
        let apart = dag.unary(Unary::Abs, apart);
        if let Some(span) = self.problem.origin.get(&corner).copied() {
            self.origin(apart, span);
        }
        let helper = self.held_beside(pass, known, apart, at)?;
        pass.treated.insert(corner);
        let dag = &mut self.problem.dag;
        let twice = if is_greater { dag.add(sum, helper) } else { dag.sub(sum, helper) };
        let half = dag.constant(0.5);
        Some(dag.mul(half, twice))
    }

    /// A corner of corners with helpers for those within: `max(0, abs(u) - 0.3)` is `max(0, s - 0.3)` with `s` beside `abs(u)`.
    fn helpers_within(
        &mut self,
        pass: &mut Corners,
        known: &mut Known,
        corner: NodeId,
        (site, depth): (&Site, usize),
    ) -> NodeId {
        let own = self.problem.dag.node(corner).clone();
        let is_lattice = matches!(
            own,
            Node::Unary(Unary::Abs, _)
                | Node::Binary(Binary::Max | Binary::Min, ..)
                | Node::Reduce { fold: Fold::Max | Fold::Min, .. }
        );
        if !is_lattice || self.has_one_corner(pass, corner) {
            return corner;
        }
        let within = self.relaxed_below(pass, known, (&own, Role::Term), site, depth + 1);
        if within != corner {
            pass.treated.insert(corner);
            if let Some(span) = self.problem.origin.get(&corner).copied() {
                self.origin(within, span);
            }
        }
        within
    }

    /// A helper that is held beside a corner; none where nothing is known of the corner's sides.
    fn held_beside(
        &mut self,
        pass: &mut Corners,
        known: &mut Known,
        corner: NodeId,
        (site, depth): (&Site, usize),
    ) -> Option<NodeId> {
        let key = (corner, site.clone());
        let helper = match known.helpers.get(&key) {
            Some(helper) => helper.clone(),
            None => {
                let helper = self.helper_of_equations(pass, known, corner, (site, depth))?;
                known.helpers.insert(key, helper.clone());
                helper
            }
        };
        pass.treated.insert(corner);
        let node = helper.node;
        if known.used.iter().all(|used| used.node != node) {
            known.used.push(helper);
        }
        Some(node)
    }

    /// A new helper, or that of the same corner in what is minimised or limited.
    fn helper_of_equations(
        &mut self,
        pass: &mut Corners,
        known: &Known,
        corner: NodeId,
        (site, depth): (&Site, usize),
    ) -> Option<Used> {
        if self.is_kept_away(corner) || !self.has_one_corner(pass, corner) {
            return None;
        }
        let span = self.problem.origin.get(&corner).copied().unwrap_or(pass.span);
        let has_states_alone = self.has_states_alone(&known.orders, corner);
        if let Some(node) = pass.helper_of(corner, site) {
            return Some(Used { node, span, held: None, has_states_alone });
        }
        let first = self.problem.constraints.len();
        // What nothing pushes is held by what it can be at all.
        let free = Site { push: Push::Floating, ..site.clone() };
        let node = [true, false].into_iter().find_map(|growing| self.helper(pass, corner, (&free, growing), depth))?;
        let after = self.problem.constraints.len();
        let zero = self.problem.dag.constant(0.0);
        self.hold_helper(site, vec![], (node, Bounds { lower: Some(zero), upper: Some(zero) }), span);
        let (bounds, sides) = (first..after).partition(|row| self.problem.constraints[*row].body == node);
        let held = Some(Helper { sides, bounds, at_zero: after });
        Some(Used { node, span, held, has_states_alone })
    }

    /// Whether a root is one that seldom vanishes: a distance or a speed in gravitation, a spring, a drag, or what a direction is
    /// divided by. The magnitude of an input vanishes along coasts, whatever it is a factor of.
    fn is_distance(&self, known: &Known, root: NodeId, role: Role) -> bool {
        match role {
            Role::Term => false,
            Role::Factor => self.has_states_alone(&known.orders, root),
            Role::Divisor => true,
        }
    }

    /// Whether a limit keeps a corner at 0 away from it: the least magnitude of a thrust.
    fn is_kept_away(&self, corner: NodeId) -> bool {
        self.problem.constraints.iter().any(|own| {
            let least = own.bounds.lower.and_then(|lower| self.problem.dag.is_constant(lower));
            own.body == corner && least.is_some_and(|least| least > 0.0)
        })
    }

    /// Whether a corner is made of outputs whose derivatives stand in equations, and of no others.
    fn has_states_alone(&self, orders: &Map<(usize, usize), usize>, corner: NodeId) -> bool {
        let mut outputs = self.outputs_in(&[corner]).into_iter().peekable();
        outputs.peek().is_some() && outputs.all(|(place, order)| orders.get(&place).is_some_and(|own| order < *own))
    }

    /// The outputs in some nodes and in their integrands, by phase and output, with the order of the derivative.
    fn outputs_in(&self, nodes: &[NodeId]) -> Vec<((usize, usize), usize)> {
        let all = self.below(nodes);
        let leaves = self.problem.dag.inputs_of(&all).into_iter().map(|input| self.problem.leaves.leaf(input));
        let outputs = leaves.filter_map(|leaf| match leaf {
            Leaf::Flat { phase, output, order, .. } => Some(((phase.phase, *output), *order)),
            _ => None,
        });
        outputs.collect()
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

/// Whether a node is a smooth function of its operands.
fn is_smooth(node: &Node) -> bool {
    match node {
        Node::Unary(op, _) => !matches!(op, Unary::Abs | Unary::Sign | Unary::Sqrt),
        Node::Binary(op, ..) => matches!(op, Binary::Add | Binary::Sub | Binary::Mul | Binary::Div | Binary::Pow),
        Node::Powi(..) => true,
        Node::Reduce { fold, .. } => *fold == Fold::Sum,
        _ => false,
    }
}
