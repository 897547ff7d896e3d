//! Corners of constraints: `abs`, `max`, `min` where they are limited (docs/maths.md, section 18).
//!
//! Takes constraints with one bound; in integrals helpers stand for their corners (`epigraph.rs`). Elsewhere, where the
//! bound limits a corner on the side of its corner, as in `max(a, b) <= c`, the constraint has a member for each side of
//! it: `a <= c` and `b <= c`. That is exact at every point, needs no convexity, and no gradient jumps.
//! A sum over an index is written out for it (`unrolled.rs`).

use super::corners::{Corners, Site};
use super::elaborator::Elaborator;
use super::monotone::Push;
use super::problem::{Domain, Form, Leaf, Loop};
use crate::expr::{Binary, Fold, Map, Node, NodeId, Unary};

/// Most members of the sides of one constraint, beyond which its corners stay: two sides each of six corners. A choice.
const MOST_SIDES: i64 = 64;

/// How deep expressions are looked into; deeper corners stay.
const MAX_DEPTH: usize = 500;

/// The sides of the corners of one constraint.
#[derive(Default)]
struct Sides {
    /// One for each corner.
    loops: Vec<Loop>,
    /// Members of all of them.
    count: i64,
    done: Map<(NodeId, bool), NodeId>, // Looked up, never iterated.
    treated: Vec<NodeId>,
}

impl Sides {
    /// Takes back all sides but the first, of a node that stays as it is.
    fn forget(&mut self, (loops, count, treated): (usize, i64, usize)) {
        self.loops.truncate(loops);
        self.count = count;
        self.treated.truncate(treated);
        self.done.clear();
    }
}

impl Elaborator<'_> {
    /// Takes the corners out of constraints with one bound: of integrals by helpers, elsewhere by sides.
    pub(super) fn corners_limited(&mut self, pass: &mut Corners) {
        for number in 0..self.problem.constraints.len() {
            let own = &self.problem.constraints[number];
            let growing = match (own.bounds.lower, own.bounds.upper) {
                (None, Some(_)) => true,
                (Some(_), None) => false,
                _ => continue,
            };
            if !pass.has_corners(own.body) {
                continue;
            }
            let (is_mission, relied) = (own.domain == Domain::Mission, pass.signs.relied.len());
            let is_smooth = self.by_cone(pass, number, growing)
                || (is_mission && self.by_helpers(pass, number, growing))
                || self.by_sides(pass, number, growing);
            if !is_smooth {
                // Nothing rests on the signs that were asked for.
                pass.signs.relied.truncate(relied);
            }
        }
    }

    /// Whether helpers stand for corners of a constraint now.
    fn by_helpers(&mut self, pass: &mut Corners, number: usize, growing: bool) -> bool {
        let own = &self.problem.constraints[number];
        let (body, site) = (own.body, Site { loops: own.loops.clone(), along: None, push: Push::Steep });
        pass.span = own.span;
        let smooth = self.smooth(pass, body, (&site, growing), 0);
        if smooth == body {
            return false;
        }
        self.origin(smooth, pass.span);
        let own = &mut self.problem.constraints[number];
        (own.body, own.written) = (smooth, own.written.or(Some(body)));
        true
    }

    /// Whether a constraint has a member for each side of its corners now.
    fn by_sides(&mut self, pass: &mut Corners, number: usize, growing: bool) -> bool {
        let own = &self.problem.constraints[number];
        let (body, span) = (own.body, own.span);
        let mut sides = Sides { count: 1, ..Sides::default() };
        let smooth = self.side(pass, &mut sides, body, growing, 0);
        if smooth == body || sides.count > MOST_SIDES {
            return false;
        }
        self.origin(smooth, span);
        pass.treated.extend(sides.treated);
        let own = &mut self.problem.constraints[number];
        own.body = smooth;
        own.sides = sides.loops.len();
        own.loops.extend(sides.loops);
        true
    }

    /// A node in which one side stands for each corner.
    fn side(&mut self, pass: &mut Corners, sides: &mut Sides, node: NodeId, growing: bool, depth: usize) -> NodeId {
        if depth > MAX_DEPTH || !pass.has_corners(node) {
            return node;
        }
        if let Some(known) = sides.done.get(&(node, growing)) {
            return *known;
        }
        let own = self.problem.dag.node(node).clone();
        let (max, fold) = if growing { (Binary::Max, Fold::Max) } else { (Binary::Min, Fold::Min) };
        let one = match own {
            Node::Unary(Unary::Abs, x) if growing && pass.signs.is_positive(&self.problem, x) => {
                self.side(pass, sides, x, growing, depth + 1)
            }
            Node::Unary(Unary::Abs, x) if growing && !pass.has_corners(x) => {
                let minus = self.problem.dag.neg(x);
                self.choice(sides, &[x, minus])
            }
            Node::Binary(op, ..) if op == max => {
                let (mut members, mut open) = (vec![], vec![node]);
                while let Some(node) = open.pop() {
                    match *self.problem.dag.node(node) {
                        Node::Binary(own, a, b) if own == op => {
                            sides.treated.push(node);
                            open.extend([b, a]);
                        }
                        _ => members.push(self.side(pass, sides, node, growing, depth + 1)),
                    }
                }
                self.choice(sides, &members)
            }
            Node::Reduce { fold: own, range, body, .. } if own == fold => {
                let over = self.problem.ranges[range as usize].clone();
                match (over.first.as_number(), over.last.as_number()) {
                    (Some(first), Some(last)) if first <= last && !sides.loops.contains(&over) => {
                        sides.loops.push(over);
                        self.side(pass, sides, body, growing, depth + 1)
                    }
                    _ => node,
                }
            }
            Node::Reduce { fold: Fold::Sum, body, .. } => match self.unrolled(node, MOST_SIDES.ilog2().into()) {
                Some(sum) => {
                    self.corners_found(pass, sum);
                    let smooth = self.other_side(pass, sides, (node, sum), growing, depth);
                    if smooth != node {
                        sides.treated.extend(self.below(&[body]).into_iter().filter(|node| pass.has_corners(*node)));
                    }
                    smooth
                }
                None => node,
            },
            Node::Select { .. } => match pass.branches.get(&node).copied() {
                Some(sum) => self.other_side(pass, sides, (node, sum), growing, depth),
                None => self.below_sides(pass, sides, (node, &own), growing, depth + 1),
            },
            Node::Table { .. } => match self.lines_pushed(pass, node, growing) {
                Some(lines) => {
                    let lines: Vec<NodeId> =
                        lines.into_iter().map(|line| self.side(pass, sides, line, growing, depth + 1)).collect();
                    self.choice(sides, &lines)
                }
                None => self.below_sides(pass, sides, (node, &own), growing, depth + 1),
            },
            _ => self.below_sides(pass, sides, (node, &own), growing, depth + 1),
        };
        if one != node {
            sides.treated.push(node);
        }
        sides.done.insert((node, growing), one);
        one
    }

    /// A node in another form, in which one side stands for each corner; the node itself where that leaves corners.
    fn other_side(
        &mut self,
        pass: &mut Corners,
        sides: &mut Sides,
        (node, form): (NodeId, NodeId),
        growing: bool,
        depth: usize,
    ) -> NodeId {
        let before = (sides.loops.len(), sides.count, sides.treated.len());
        let smooth = self.side(pass, sides, form, growing, depth + 1);
        if self.has_none(pass, smooth) {
            return smooth;
        }
        sides.forget(before);
        node
    }

    /// One of several nodes, by a new index.
    fn choice(&mut self, sides: &mut Sides, members: &[NodeId]) -> NodeId {
        if let [only] = members {
            return *only;
        }
        let count = members.len() as i64;
        let over = self.new_index(Form::number(1), Form::number(count));
        let index = self.leaf(Leaf::Index(Form::index(over.index)));
        sides.loops.push(over);
        sides.count = sides.count.saturating_mul(count);
        let (last, others) = members.split_last().expect("a corner has sides");
        let mut one = *last;
        for (at, member) in others.iter().enumerate().rev() {
            let number = self.problem.dag.constant((at + 1) as f64);
            let is_other = self.problem.dag.sub(index, number);
            one = self.problem.dag.select(is_other, one, *member);
        }
        one
    }

    fn below_sides(
        &mut self,
        pass: &mut Corners,
        sides: &mut Sides,
        (node, own): (NodeId, &Node),
        growing: bool,
        depth: usize,
    ) -> NodeId {
        if matches!(own, Node::Input(_) | Node::Reduce { .. }) {
            return node;
        }
        let before = (sides.loops.len(), sides.count, sides.treated.len());
        let mut images: Map<NodeId, NodeId> = Map::default();
        for (at, operand) in own.operands().into_iter().enumerate() {
            let rises = if pass.has_corners(operand) { self.slope(pass, own, at) } else { None };
            let image = match rises {
                Some(rises) => self.side(pass, sides, operand, growing == rises, depth),
                None => operand,
            };
            // One operand that the node both grows and falls with stays.
            if images.insert(operand, image).is_some_and(|before| before != image) {
                sides.forget(before);
                return node;
            }
        }
        let rebuilt = self.problem.dag.rebuild(own, |operand| images[&operand]);
        if self.keeps_slope(pass, own, rebuilt) {
            return rebuilt;
        }
        sides.forget(before);
        node
    }

    /// Whether a node has a value, and grows or falls as before, where one side of a corner stands for the corner: a side
    /// may be negative where the corner is not, as that of `max(0, x)^2`.
    fn keeps_slope(&self, pass: &mut Corners, before: &Node, rebuilt: NodeId) -> bool {
        let after = self.problem.dag.node(rebuilt).clone();
        let (old, new) = (before.operands(), after.operands());
        if old.len() != new.len() || std::mem::discriminant(before) != std::mem::discriminant(&after) {
            return false; // It has become another node, of which nothing is known.
        }
        let has_value = match after {
            Node::Unary(Unary::Sqrt | Unary::Log, x) => x == old[0] || pass.signs.is_positive(&self.problem, x),
            _ => true,
        };
        let is_same = |pass: &mut Corners, at: usize| {
            self.slope(pass, before, at).is_none_or(|slope| self.slope(pass, &after, at) == Some(slope))
        };
        has_value && (0..new.len()).filter(|at| old[*at] != new[*at]).all(|at| is_same(pass, at))
    }
}
