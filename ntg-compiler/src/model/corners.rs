//! Corners, `abs`, `max`, `min`, `norm`, where they are minimised or limited (docs/maths.md, section 18).
//!
//! Takes the terms of the objective, and constraints. Where a corner enters with a weight that is not negative, and the
//! objective pushes it against its corner, a helper stands for it (`epigraph.rs`) and the gradient jumps no more: this is
//! exact, at the points. The term keeps what was written, for reports. Those of constraints are in `sides.rs`.
//! A corner that a factor smooths, `abs(v) * v`, is none (`smoothed.rs`).
//! Afterwards: notes of corners that are gone are gone; `Problem::corners` holds the places of all others.

use ntg_structure::Block;

use super::elaborator::Elaborator;
use super::monotone::Push;
use super::piecewise::Lines;
use super::problem::{Bounds, Constraint, Domain, Form, Imposed, Leaf, Loop, PhaseAt};
use super::ranges::Ranges;
use super::signs::{Relied, Signs};
use super::smoothed;
use super::unknowns::is_given;
use super::widths::Widths;
use crate::diagnostic::Code;
use crate::expr::{self, Binary, Dag, Fold, Map, Node, NodeId, Set, Unary};
use crate::source::Span;

/// Where an expression stands.
#[derive(Clone, PartialEq, Eq, Hash)]
pub(super) struct Site {
    /// The loops around it.
    pub(super) loops: Vec<Loop>,
    /// The phase along which it is integrated.
    pub(super) along: Option<PhaseAt>,
    /// How what is around it pushes a helper there: by a weight that may vanish, or fades, to a bound away from its corner too.
    pub(super) push: Push,
}

/// The pass's state.
pub(super) struct Corners {
    pub(super) signs: Signs,
    /// Between which numbers expressions stay where all outputs are within their bounds.
    pub(super) ranges: Ranges,
    pub(super) widths: Widths,
    /// The nodes in which there are corners.
    within: Set<NodeId>, // Asked, never iterated.
    /// Tables that are convex or concave, by their lines.
    pub(super) tables: Map<NodeId, Lines>, // Looked up, never iterated.
    /// What stands for conditions whose branches meet.
    pub(super) branches: Map<NodeId, NodeId>, // Looked up, never iterated.
    /// Corners that are none in what is made of them.
    pub(super) smoothed: Set<NodeId>, // Asked, never iterated.
    done: Map<(NodeId, bool, Site), NodeId>, // Looked up, never iterated.
    /// The corners for which helpers stand.
    pub(super) treated: Set<NodeId>, // Asked, never iterated.
    /// The choices between the tip of a cone and the rest of it, which are no corners.
    pub(super) tips: Set<NodeId>, // Asked, never iterated.
    pub(super) helpers: usize,
    /// The helpers, by what they stand for, of corners that are pushed down.
    pub(super) known: Map<(NodeId, Site), NodeId>, // Looked up, never iterated.
    /// The term in hand.
    pub(super) span: Span,
}

impl Corners {
    /// The helper that stands for a corner in what is minimised or limited.
    pub(super) fn helper_of(&self, corner: NodeId, site: &Site) -> Option<NodeId> {
        self.known.get(&(corner, site.clone())).copied()
    }

    /// Whether there are corners in a node.
    pub(super) fn has_corners(&self, node: NodeId) -> bool {
        self.within.contains(&node)
    }
}

/// How deep expressions are looked into; deeper corners stay.
const MAX_DEPTH: usize = 500;

impl Elaborator<'_> {
    /// The pass.
    pub(super) fn corners(&mut self) {
        if self.has_failed() {
            return;
        }
        let straight = self.straighten_tables();
        let parted = self.part_clamps();
        let paired = self.pair_corners();
        let terms = self.problem.objective.iter().map(|term| term.body);
        let bodies: Vec<NodeId> = terms.chain(self.problem.constraints.iter().map(|own| own.body)).collect();
        let (_, smoothed) = self.corners_left(&Set::default());
        let mut ranges = Ranges::within(&self.problem);
        let all = self.below(&bodies);
        let branches = self.branches_that_meet(&all);
        let bodies: Vec<NodeId> = bodies.into_iter().chain(branches.values().copied()).collect();
        let tables = self.tables_of_lines(&mut ranges, &bodies);
        let mut pass = Corners {
            signs: Signs::of(&self.problem),
            ranges,
            widths: Widths::of(&self.problem),
            within: self.with_corners((&tables, &branches), &bodies),
            tables,
            branches,
            smoothed,
            done: Map::default(),
            treated: Set::default(),
            tips: Set::default(),
            helpers: 0,
            known: Map::default(),
            span: Span::default(),
        };
        self.corners_limited(&mut pass);
        for term in 0..self.problem.objective.len() {
            let own = &self.problem.objective[term];
            let (body, site) = (own.body, Site { loops: own.loops.clone(), along: None, push: Push::Steep });
            pass.span = own.span;
            let smooth = self.smooth(&mut pass, body, (&site, true), 0);
            if smooth != body {
                self.origin(smooth, self.problem.objective[term].span);
                let own = &mut self.problem.objective[term];
                (own.body, own.written) = (smooth, own.written.or(Some(body)));
            }
        }
        self.corners_relaxed(&mut pass);
        self.weights_held(&pass);
        let (left, smoothed) = self.corners_left(&pass.tips);
        let is_gone = |(_, one): &&(NodeId, NodeId)| !left.contains(one);
        pass.treated.extend(straight);
        pass.treated.extend(paired.iter().chain(&parted).filter(is_gone).map(|(corner, _)| *corner));
        self.unnoted((&pass, &smoothed), &left);
        let mut spans: Vec<Span> = left.iter().filter_map(|node| self.problem.origin.get(node).copied()).collect();
        spans.sort_by_key(|span| (span.start, span.end));
        spans.dedup();
        self.problem.corners = spans;
    }

    /// All nodes below some, those of integrands too, operands first.
    pub(super) fn below(&self, bodies: &[NodeId]) -> Vec<NodeId> {
        let mut roots = bodies.to_vec();
        let mut known: Set<NodeId> = Set::default();
        let mut next = 0;
        while next < roots.len() {
            for input in self.problem.dag.inputs_of(&[roots[next]]) {
                if let Leaf::Integral { integrand, .. } = self.problem.leaves.leaf(input)
                    && known.insert(*integrand)
                {
                    roots.push(*integrand);
                }
            }
            next += 1;
        }
        let mut all = self.problem.dag.schedule(&roots);
        all.sort();
        all
    }

    /// The tables among all nodes below some that are made of lines, and are not given.
    fn tables_of_lines(&self, ranges: &mut Ranges, bodies: &[NodeId]) -> Map<NodeId, Lines> {
        let mut tables = Map::default();
        for node in self.below(bodies) {
            if let Some(lines) = self.lines_of(ranges, node)
                && !is_given(&self.problem, node)
            {
                tables.insert(node, lines);
            }
        }
        tables
    }

    fn with_corners(
        &mut self,
        (tables, branches): (&Map<NodeId, Lines>, &Map<NodeId, NodeId>),
        bodies: &[NodeId],
    ) -> Set<NodeId> {
        let mut within = Set::default();
        for node in self.below(bodies) {
            let mut has = tables.contains_key(&node) || branches.contains_key(&node) || self.is_corner(node);
            match self.problem.dag.node(node) {
                Node::Input(input) => {
                    if let Leaf::Integral { integrand, .. } = self.problem.leaves.leaf(*input) {
                        has |= within.contains(integrand);
                    }
                }
                other => other.for_each_operand(|operand| has |= within.contains(&operand)),
            }
            if has {
                within.insert(node);
            }
        }
        within
    }

    /// Whether there are no corners in a node.
    pub(super) fn has_none(&self, pass: &Corners, node: NodeId) -> bool {
        !self.below(&[node]).into_iter().any(|node| pass.has_corners(node))
    }

    /// Takes in a node that was made later.
    pub(super) fn corners_found(&mut self, pass: &mut Corners, node: NodeId) {
        let all = self.below(&[node]);
        let branches = self.branches_that_meet(&all);
        let bodies: Vec<NodeId> = branches.values().copied().chain([node]).collect();
        let tables = self.tables_of_lines(&mut pass.ranges, &bodies);
        pass.within.extend(self.with_corners((&tables, &branches), &bodies));
        pass.tables.extend(tables);
        pass.branches.extend(branches);
    }

    /// Whether the gradient of a node itself may jump where its value is pushed to.
    pub(super) fn is_corner(&mut self, node: NodeId) -> bool {
        let has = match *self.problem.dag.node(node) {
            Node::Unary(Unary::Abs, _) | Node::Binary(Binary::Min | Binary::Max, ..) => true,
            Node::Reduce { fold: Fold::Min | Fold::Max, .. } => true,
            // What is given is a width, by which the root is smooth.
            Node::Unary(Unary::Sqrt, sum) => squares(&self.problem.dag, sum)
                .is_some_and(|squared| squared.into_iter().all(|side| !is_given(&self.problem, side))),
            Node::Binary(Binary::Hypot, a, b) => [a, b].into_iter().all(|side| !is_given(&self.problem, side)),
            _ => false,
        };
        has && !is_given(&self.problem, node)
    }

    /// What stands for a node; `growing` says whether the objective grows with it, or falls.
    pub(super) fn smooth(
        &mut self,
        pass: &mut Corners,
        node: NodeId,
        (site, growing): (&Site, bool),
        depth: usize,
    ) -> NodeId {
        if depth > MAX_DEPTH || !pass.within.contains(&node) {
            return node;
        }
        let key = (node, growing, site.clone());
        if let Some(known) = pass.done.get(&key) {
            return *known;
        }
        let by_branches = pass.branches.get(&node).copied().and_then(|sum| {
            let smooth = self.smooth(pass, sum, (site, growing), depth + 1);
            self.has_none(pass, smooth).then_some(smooth)
        });
        let by_products = || {
            let product = self.with_weight_inside(pass, node)?;
            let smooth = self.smooth(pass, product, (site, growing), depth + 1);
            self.has_none(pass, smooth).then_some(smooth)
        };
        let in_other_form = by_branches.or_else(by_products);
        let smooth = match in_other_form.or_else(|| self.helper(pass, node, (site, growing), depth)) {
            Some(smooth) => {
                pass.treated.insert(node);
                smooth
            }
            None => self.below_smooth(pass, node, (site, growing), depth + 1),
        };
        pass.done.insert(key, smooth);
        smooth
    }

    /// A node with smooth operands, as far as it is known to grow or to fall with each.
    fn below_smooth(
        &mut self,
        pass: &mut Corners,
        node: NodeId,
        (site, growing): (&Site, bool),
        depth: usize,
    ) -> NodeId {
        let own = self.problem.dag.node(node).clone();
        if let Node::Input(input) = own {
            let Leaf::Integral { phase, integrand } = self.problem.leaves.leaf(input).clone() else { return node };
            if site.along.is_some() {
                return node;
            }
            let along = Site { along: Some(phase.clone()), ..site.clone() };
            let integrand = self.smooth(pass, integrand, (&along, growing), depth);
            return self.leaf(Leaf::Integral { phase, integrand });
        }
        // A corner that is pushed away from its corner, and one for which no helper can stand, is flat on one side: nothing
        // would push a helper inside of it there.
        if matches!(own, Node::Binary(Binary::Min | Binary::Max, ..) | Node::Reduce { fold: Fold::Min | Fold::Max, .. })
        {
            return node;
        }
        let mut inner = site.clone();
        if let Node::Reduce { range, .. } = own {
            inner.loops.push(self.problem.ranges[range as usize].clone());
        }
        // An even power of a root has none.
        if let Node::Powi(x, n) = own
            && n % 2 == 0
            && matches!(self.problem.dag.node(x), Node::Unary(Unary::Sqrt, _) | Node::Binary(Binary::Hypot, ..))
        {
            return node;
        }
        let operands = own.operands();
        // Rows of a helper are there once it is: whether one may stand for a corner is known before.
        let both = operands.iter().filter(|operand| pass.has_corners(**operand)).count() > 1;
        let mut images: Map<NodeId, NodeId> = Map::default();
        for (at, operand) in operands.into_iter().enumerate() {
            let rises = if pass.has_corners(operand) { self.slope(pass, &own, at) } else { None };
            let push = rises.map(|rises| (rises, self.push(pass, &own, at, growing == rises, both)));
            let image = match push {
                Some((rises, push)) if push != Push::Nothing => {
                    let site = Site { push: push.max(inner.push), ..inner.clone() };
                    self.smooth(pass, operand, (&site, growing == rises), depth)
                }
                _ => operand,
            };
            // One operand that the node both grows and falls with stays.
            if images.insert(operand, image).is_some_and(|before| before != image) {
                return node;
            }
        }
        self.problem.dag.rebuild(&own, |operand| images[&operand])
    }

    /// Parameters on whose sign it rests that a helper may stand for a corner: they must not be set to less than 0.
    fn weights_held(&mut self, pass: &Corners) {
        if pass.treated.is_empty() {
            return;
        }
        let zero = self.problem.dag.constant(0.0);
        for relied in &pass.signs.relied {
            let parameter = match relied {
                Relied::Parameter(parameter) => parameter,
                Relied::Difference(node) => {
                    self.difference_held(*node);
                    continue;
                }
            };
            let declared = &self.problem.parameters[*parameter];
            let (name, unit, count) = (declared.name.clone(), declared.unit.clone(), declared.value.len());
            let over = declared.array.then(|| self.new_index(Form::number(1), Form::number(count as i64)));
            let index = over.as_ref().map(|over| Form::index(over.index));
            let body = self.leaf(Leaf::Parameter { parameter: *parameter, index });
            self.problem.constraints.push(Constraint {
                name: Some(format!("{name} >= 0, the weight of a corner")),
                span: self.parameters[*parameter].0.span,
                block: Block::Corner,
                unit,
                loops: over.into_iter().collect(),
                sides: 0,
                written: None,
                domain: Domain::Mission,
                imposed: Imposed::Everywhere,
                body,
                bounds: Bounds { lower: Some(zero), upper: None },
            });
        }
    }

    /// A row that holds a difference of parameters above 0.
    fn difference_held(&mut self, node: NodeId) {
        let inputs = self.problem.dag.inputs_of(&[node]).into_iter();
        let parameters = inputs.filter_map(|input| match self.problem.leaves.leaf(input) {
            Leaf::Parameter { parameter, .. } => Some(*parameter),
            _ => None,
        });
        let parameters: Vec<usize> = parameters.collect();
        let Some(first) = parameters.first() else { return };
        let span = self.parameters[*first].0.span;
        let names: Vec<&str> =
            parameters.iter().map(|parameter| &self.problem.parameters[*parameter].name[..]).collect();
        let name = format!("a weight of a corner, made of {}, >= 0", names.join(", "));
        let zero = self.problem.dag.constant(0.0);
        self.hold(Domain::Mission, vec![], (node, Bounds { lower: Some(zero), upper: None }), span);
        if let Some(row) = self.problem.constraints.last_mut() {
            row.name = Some(name);
        }
    }

    /// The corners in what is solved, and those that are none because a factor vanishes where they are; of what is only shown
    /// there are these too. Equations that have a form with helpers are left out as they are written.
    fn corners_left(&mut self, tips: &Set<NodeId>) -> (Vec<NodeId>, Set<NodeId>) {
        let held: Set<usize> = self.problem.relaxations.iter().map(|own| own.other).collect();
        let constraints = self.problem.constraints.iter().enumerate();
        let bodies = constraints.filter(|(number, _)| !held.contains(number)).map(|(_, constraint)| constraint.body);
        let bodies: Vec<NodeId> = bodies.chain(self.problem.objective.iter().map(|term| term.body)).collect();
        let all = self.below(&bodies);
        let kinks: Set<NodeId> = expr::kinks(&self.problem.dag, &all).into_iter().collect();
        let has_kink = |node: &NodeId| kinks.contains(node) || self.is_piecewise(*node);
        let mut left: Vec<NodeId> = all.iter().copied().filter(has_kink).collect();
        left.retain(|node| !tips.contains(node) && self.may_jump(*node));
        let mut smoothed = smoothed::among(&mut self.kinds, (&self.problem, &all), &bodies, &left);
        left.retain(|node| !smoothed.contains(node));
        let solved: Set<NodeId> = all.into_iter().collect();
        let noted = self.kinks.iter().map(|(node, _)| *node);
        let mut others: Vec<NodeId> = noted.filter(|node| !solved.contains(node)).collect();
        if !others.is_empty() {
            let shown: Vec<NodeId> = self.problem.named.iter().map(|named| named.body).collect();
            let all = self.below(&shown);
            others.retain(|node| all.binary_search(node).is_ok());
            smoothed.extend(smoothed::among(&mut self.kinds, (&self.problem, &all), &shown, &others));
        }
        (left, smoothed)
    }

    /// Whether what is solved for decides on which side of a kink its gradient is taken.
    fn may_jump(&mut self, kink: NodeId) -> bool {
        let decides = match *self.problem.dag.node(kink) {
            Node::Select { condition, .. } => condition,
            _ => kink,
        };
        !self.kinds(decides).is_fixed()
    }

    /// Takes back the notes of corners that are gone.
    fn unnoted(&mut self, (pass, smoothed): (&Corners, &Set<NodeId>), left: &[NodeId]) {
        let left: Set<NodeId> = left.iter().copied().collect();
        let kinks = &self.kinks;
        self.found.retain(|finding| {
            let own = || kinks.iter().filter(|(_, span)| *span == finding.span).map(|(node, _)| node);
            let is_none = |node: &NodeId| pass.treated.contains(node) || smoothed.contains(node);
            let is_gone = own().any(is_none) && !own().any(|node| left.contains(node));
            finding.code != Code::GradientJumps || !is_gone
        });
    }
}

/// What is squared in a sum of squares, whose root is the tip of a cone where all are 0; none of another sum.
pub(super) fn squares(dag: &Dag, sum: NodeId) -> Option<Vec<NodeId>> {
    let (mut open, mut squared) = (vec![sum], vec![]);
    let mut depth = 0;
    while let Some(node) = open.pop() {
        depth += 1;
        match *dag.node(node) {
            Node::Binary(Binary::Add, a, b) if depth < MAX_DEPTH => open.extend([a, b]),
            Node::Reduce { fold: Fold::Sum, body, .. } => open.push(body),
            Node::Binary(Binary::Mul, a, b) if is_number(dag, a) => open.push(b),
            Node::Binary(Binary::Mul | Binary::Div, a, b) if is_number(dag, b) => open.push(a),
            Node::Binary(Binary::Mul, a, b) if a == b => squared.push(a),
            Node::Powi(x, 2) => squared.push(x),
            _ => return None,
        }
    }
    Some(squared)
}

fn is_number(dag: &Dag, node: NodeId) -> bool {
    dag.is_constant(node).is_some_and(|number| number > 0.0)
}
