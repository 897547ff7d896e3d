//! Helpers that stand for corners of the objective and in integrals of limits (docs/maths.md, section 18).
//!
//! Takes a corner that is pushed down, gives a number `s` held above it: `s >= e` and `s >= -e` for `abs(e)`, `s >= a`
//! and `s >= b` for `max(a, b)`, `s^2 >= v . v` and `s >= 0` for `norm(v)`; `s <= a` and `s <= b` for `min(a, b)` that is
//! pushed up. Inside an integral it has a value at each point of the quadrature, and the rows stand at these points
//! alone, so that the discretised problem keeps its minimum; elsewhere it is a variable.

use ntg_structure::{Block, Unit};

use super::corners::{Corners, Site, squares};
use super::elaborator::Elaborator;
use super::monotone::Push;
use super::problem::{At, Bounds, Constraint, Domain, Form, Imposed, Leaf, Loop, Output, Part, PhaseAt, Variable};
use super::soft::Members;
use super::unknowns::{is_affine, is_given};
use crate::expr::{Binary, Fold, Node, NodeId, Unary};
use crate::source::Span;

/// What a helper is held against.
enum Against {
    /// All of these, each for the members of loops of its own.
    Members(Vec<(NodeId, Vec<Loop>)>),
    /// The root of a sum of squares.
    Root(NodeId),
}

impl Elaborator<'_> {
    /// What stands for a corner; none where the node is none, or is pushed away from its corner.
    pub(super) fn helper(
        &mut self,
        pass: &mut Corners,
        corner: NodeId,
        (site, growing): (&Site, bool),
        depth: usize,
    ) -> Option<NodeId> {
        let limit = if site.push == Push::Steep { None } else { self.limit_of(pass, corner, growing) };
        if site.push == Push::Fading && limit.is_none() {
            return None;
        }
        let against = self.against(pass, corner, (site, growing), depth)?;
        if let Against::Members(members) = &against
            && let [(only, loops)] = members.as_slice()
            && loops.is_empty()
            && matches!(self.problem.dag.node(corner), Node::Table { .. })
        {
            return Some(*only);
        }
        let span = self.problem.origin.get(&corner).copied().unwrap_or(pass.span);
        let helper = self.helper_leaf(pass, corner, site, span)?;
        if growing {
            pass.known.insert((corner, site.clone()), helper);
        }
        let zero = self.problem.dag.constant(0.0);
        let above = |node| (node, Bounds { lower: Some(zero), upper: None });
        match against {
            Against::Members(members) => {
                for (member, loops) in members {
                    let body = match growing {
                        true => self.problem.dag.sub(helper, member),
                        false => self.problem.dag.sub(member, helper),
                    };
                    self.hold_helper(site, loops, above(body), span);
                }
            }
            Against::Root(sum) => {
                let square = self.problem.dag.powi(helper, 2);
                let body = self.problem.dag.sub(square, sum);
                self.hold_helper(site, vec![], above(body), span);
                let upper = pass.widths.of_root(&mut self.problem, (corner, sum));
                self.hold_helper(site, vec![], (helper, Bounds { lower: Some(zero), upper }), span);
            }
        }
        if let Some(limit) = limit {
            let bounds = match growing {
                true => Bounds { lower: None, upper: Some(limit) },
                false => Bounds { lower: Some(limit), upper: None },
            };
            self.hold_helper(site, vec![], (helper, bounds), span);
        }
        Some(helper)
    }

    /// What a corner is at most, where what it is in grows with it, else at least: a number, or an expression of parameters.
    fn limit_of(&mut self, pass: &mut Corners, corner: NodeId, growing: bool) -> Option<NodeId> {
        match pass.ranges.of(&self.problem, corner) {
            Some((least, most)) => Some(self.problem.dag.constant(if growing { most } else { least })),
            None => self.limit_in_parameters(corner, growing),
        }
    }

    /// Whether the sides of a corner are affine in what is solved for, but for corners in them: the rows of a helper are
    /// convex then.
    fn has_affine_sides(&self, pass: &Corners, corner: NodeId) -> bool {
        let dag = &self.problem.dag;
        let sides = match *dag.node(corner) {
            Node::Unary(Unary::Abs, x) => vec![x],
            Node::Binary(Binary::Max | Binary::Min | Binary::Hypot, a, b) => vec![a, b],
            Node::Reduce { fold: Fold::Max | Fold::Min, body, .. } => vec![body],
            Node::Unary(Unary::Sqrt, sum) => squares(dag, sum).unwrap_or_default(),
            _ => vec![],
        };
        sides
            .into_iter()
            .all(|side| pass.has_corners(side) || is_affine(&self.problem, side) || is_given(&self.problem, side))
    }

    fn against(
        &mut self,
        pass: &mut Corners,
        corner: NodeId,
        (site, growing): (&Site, bool),
        depth: usize,
    ) -> Option<Against> {
        if !self.has_helper(site) || is_given(&self.problem, corner) {
            return None;
        }
        let fold = if growing { (Binary::Max, Fold::Max) } else { (Binary::Min, Fold::Min) };
        // The clamp of a smooth step needs none, and would be posed by rows that are not convex.
        if pass.smoothed.contains(&corner) && !self.has_affine_sides(pass, corner) {
            return None;
        }
        let is_root = growing && self.is_corner(corner);
        match *self.problem.dag.node(corner) {
            // A corner inside is pushed both ways, unless what is inside is never negative.
            Node::Unary(Unary::Abs, x) if growing && pass.has_corners(x) => {
                let positive = pass.signs.is_positive(&self.problem, x);
                positive.then(|| Against::Members(vec![(self.smooth(pass, x, (site, true), depth + 1), vec![])]))
            }
            Node::Unary(Unary::Abs, x) if growing => {
                let minus = self.problem.dag.neg(x);
                Some(Against::Members(vec![(x, vec![]), (minus, vec![])]))
            }
            Node::Binary(op, ..) if op == fold.0 => {
                let mut members = vec![];
                let mut open = vec![corner];
                while let Some(node) = open.pop() {
                    match *self.problem.dag.node(node) {
                        Node::Binary(own, a, b) if own == op => {
                            pass.treated.insert(node);
                            open.extend([b, a]);
                        }
                        _ => members.push((self.smooth(pass, node, (site, growing), depth + 1), vec![])),
                    }
                }
                Some(Against::Members(members))
            }
            Node::Reduce { fold: own, range, body, .. } if own == fold.1 => {
                let over = self.problem.ranges[range as usize].clone();
                let mut inner = site.clone();
                inner.loops.push(over.clone());
                let body = self.smooth(pass, body, (&inner, growing), depth + 1);
                Some(Against::Members(vec![(body, vec![over])]))
            }
            Node::Table { .. } => {
                let mut members = vec![];
                for line in self.lines_pushed(pass, corner, growing)? {
                    members.push((self.smooth(pass, line, (site, growing), depth + 1), vec![]));
                }
                Some(Against::Members(members))
            }
            Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Hypot, ..) if is_root => {
                let sum = self.square_of_root(corner)?;
                Some(Against::Root(self.smooth(pass, sum, (site, true), depth + 1)))
            }
            _ => None,
        }
    }

    /// Whether a helper can be made for each member of the loops at a place.
    fn has_helper(&self, site: &Site) -> bool {
        own_loops(site).iter().all(|over| match (over.first.as_number(), over.last.as_number()) {
            (Some(first), Some(last)) => first <= last,
            _ => false,
        })
    }

    /// A number for each point and for each member of the loops at a place.
    fn helper_leaf(&mut self, pass: &mut Corners, corner: NodeId, site: &Site, span: Span) -> Option<NodeId> {
        pass.helpers += 1;
        let (name, doc) = (format!("corner({})", pass.helpers), format!("Stands for `{}`.", self.text(span)));
        let unit = self.unit_within(pass, corner);
        let Some(at) = &site.along else {
            let members = self.members_missed(&own_loops(site), span)?;
            let count = members.family.as_ref().map(|(count, _)| *count);
            let index = members.family.map(|(_, member)| member);
            let place = self.problem.variables.len();
            let family = count.map(|count| self.new_index(Form::number(1), Form::number(count)));
            let bounds = Bounds::default();
            self.problem.variables.push(Variable { name, doc, unit, family, grid: None, bounds, span });
            return Some(self.leaf(Leaf::Variable { variable: place, index }));
        };
        let members = self.members_missed(&own_loops(site), span)?;
        let spline = self.slack_spline(at.phase, self.points_within(at.phase));
        let helper = Output { name, doc, unit, family: None, grid: None, vector: None, spline, span };
        Some(self.helper_output(at, members, helper))
    }

    /// A helper of the compiler's own along a phase, one for each member.
    pub(super) fn helper_output(&mut self, at: &PhaseAt, members: Members, helper: Output) -> NodeId {
        let family = members.family.as_ref().map(|(count, _)| (1, *count));
        let index = members.family.map(|(_, member)| member);
        let outputs = &mut self.problem.phases[at.phase].outputs;
        let place = outputs.len();
        outputs.push(Output { family, ..helper });
        self.leaf(Leaf::Flat { phase: at.clone(), at: At::Here, output: place, index, order: 0 })
    }

    /// The unit of the first output or variable in a corner, which is the corner's own where that is affine; where it is curved,
    /// no unit is known.
    fn unit_within(&self, pass: &Corners, corner: NodeId) -> Unit {
        let problem = &self.problem;
        if let Node::Table { table, .. } = problem.dag.node(corner) {
            return problem.tables[*table as usize].unit.clone();
        }
        if !self.has_affine_sides(pass, corner) {
            return Unit::default();
        }
        let inputs = problem.dag.inputs_of(&[corner]);
        let units = inputs.into_iter().filter_map(|input| match problem.leaves.leaf(input) {
            Leaf::Flat { phase, output, order: 0, .. } => Some(&problem.phases[phase.phase].outputs[*output].unit),
            Leaf::Variable { variable, .. } => Some(&problem.variables[*variable].unit),
            _ => None,
        });
        units.into_iter().next().cloned().unwrap_or_default()
    }

    /// A row that holds a helper at its place.
    pub(super) fn hold_helper(&mut self, site: &Site, loops: Vec<Loop>, row: (NodeId, Bounds), span: Span) {
        let domain = site.along.as_ref().map_or(Domain::Mission, |at| Domain::Path(at.clone(), Part::WHOLE));
        self.hold(domain, site.loops.iter().cloned().chain(loops).collect(), row, span);
    }

    /// A row of the compiler's own.
    pub(super) fn hold(&mut self, domain: Domain, loops: Vec<Loop>, (body, bounds): (NodeId, Bounds), span: Span) {
        self.origin(body, span);
        self.problem.constraints.push(Constraint {
            name: None,
            span,
            block: Block::Corner,
            unit: Unit::default(),
            loops,
            sides: 0,
            written: None,
            domain,
            imposed: Imposed::Everywhere,
            body,
            bounds,
        });
    }
}

/// The loops at a place that do not say which phase it is.
fn own_loops(site: &Site) -> Vec<Loop> {
    loops_within(&site.loops, site.along.as_ref())
}

/// The loops that do not say which phase it is.
pub(super) fn loops_within(loops: &[Loop], along: Option<&PhaseAt>) -> Vec<Loop> {
    let of_phase = |over: &&Loop| {
        let forms = along.into_iter().flat_map(|at| [&at.agent, &at.index]).flatten();
        forms.flat_map(|form| &form.terms).all(|(index, _)| *index != over.index)
    };
    loops.iter().filter(of_phase).cloned().collect()
}
