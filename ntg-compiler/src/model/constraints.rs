//! Constraints in all their forms.
//!
//! Takes the four kinds of blocks, fills `Problem::constraints`.
//! What does not change while the problem is solved goes into the bounds (`fixed_terms`); otherwise the body is a
//! difference, bounded by 0.
//! Finds: sides of different dimensions, constraints that constants decide.

use ntg_structure::{Block, Unit};

use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::element_text::member_text;
use super::problem::{Bounds, Constraint, Domain, Form, Imposed, Part};
use super::scope::{Allow, Context, Point};
use super::settle::Use;
use super::value::Value;
use crate::diagnostic::{Code, Diagnostic};
use crate::syntax::ast::{self, BlockPlace, Comparison, Expr, ItemKind, Relation, Statement};

/// Where the constraints of a block are given a meaning.
#[derive(Clone)]
pub(super) struct Site {
    pub(super) block: Block,
    pub(super) agent: Option<usize>,
    pub(super) phase: Option<usize>,
    /// Which part of the phase, for a trajectory.
    pub(super) part: Part,
}

/// What is bounded, by what, and in which unit it is shown.
pub(super) struct Body {
    pub(super) value: Value,
    pub(super) bounds: Bounds,
    pub(super) unit: Unit,
}

impl<'a> Elaborator<'a> {
    /// All constraints, scope by scope.
    pub(super) fn constraints(&mut self) {
        for scope in 0..self.scopes.len() {
            for item in self.items[scope] {
                match &item.kind {
                    ItemKind::Block(block) => self.block_at_its_place(scope, block),
                    ItemKind::At(block) => self.at_block(scope, block),
                    _ => continue,
                }
                self.settle_open();
            }
        }
        for phase in 0..self.phases.len() {
            self.declared_bounds(phase);
            self.count_equations(phase);
        }
    }

    fn block_at_its_place(&mut self, scope: usize, block: &'a ast::Block) {
        let agent = self.scopes[scope].agent;
        let phase = self.scopes[scope].phase;
        if let (Some(part), Some(agent), BlockPlace::Trajectory) = (&block.part, agent, block.place) {
            return self.part_block(scope, agent, block, part);
        }
        match (block.place, agent) {
            (BlockPlace::Temporal, _) => {
                let cx = match (phase, agent) {
                    (Some(phase), _) => self.phase_context(phase, Allow::All, Point::Nowhere),
                    (None, Some(agent)) => self.agent_context(agent, Allow::All),
                    (None, None) => Context::of(scope, Allow::All),
                };
                let site = Site { block: Block::Temporal, agent, phase, part: Part::WHOLE };
                self.statements(&cx, &block.statements, &site);
            }
            // Terms of the objective.
            (BlockPlace::Measure, _) => {}
            (_, None) => {} // Told of as standing at the wrong level.
            (BlockPlace::Trajectory | BlockPlace::Dynamics, Some(agent)) => {
                let phases = phase.map_or_else(|| self.agents[agent].phases.clone(), |phase| vec![phase]);
                for phase in phases {
                    if block.place == BlockPlace::Dynamics {
                        self.dynamics(scope, phase, block);
                        continue;
                    }
                    let cx = self.phase_context(phase, Allow::All, Point::Path);
                    let site =
                        Site { block: Block::Trajectory, agent: Some(agent), phase: Some(phase), part: Part::WHOLE };
                    self.statements(&Context { lexical: scope, ..cx }, &block.statements, &site);
                }
            }
            (BlockPlace::Initial | BlockPlace::Final, Some(agent)) => {
                self.end_block(scope, agent, phase, block);
            }
        }
    }

    /// `initial` or `final`: of a phase, or of the whole agent.
    fn end_block(&mut self, scope: usize, agent: usize, phase: Option<usize>, block: &'a ast::Block) {
        let (kind, point) = match block.place {
            BlockPlace::Initial => (Block::Initial, Point::Start),
            _ => (Block::Final, Point::End),
        };
        let cx = match phase {
            Some(phase) => self.phase_context(phase, Allow::All, point),
            None => {
                let stretches = self.stretches(agent, None);
                let ends = (stretches.first(), stretches.last());
                let (Some(first), Some(last)) = ends else { return };
                let stretch = if kind == Block::Initial { self.first_member(first) } else { self.last_member(last) };
                let outer = self.agent_context(agent, Allow::All);
                Context { scope: self.phases[stretch.phase].scope, phase: stretch.index, point, ..outer }
            }
        };
        let site = Site { block: kind, agent: Some(agent), phase, part: Part::WHOLE };
        self.statements(&Context { lexical: scope, ..cx }, &block.statements, &site);
    }

    pub(super) fn statements(&mut self, cx: &Context<'a>, statements: &'a [Statement<ast::Constraint>], site: &Site) {
        for statement in statements {
            self.for_families(cx, &mut |this, cx| this.statement(cx, statement, site));
        }
    }

    fn statement(&mut self, cx: &Context<'a>, statement: &'a Statement<ast::Constraint>, site: &Site) {
        match statement {
            Statement::One(constraint) => self.constraint(cx, constraint, site),
            Statement::For(inner) => {
                let Some((over, _)) = self.range(cx, &inner.over) else { return };
                let name = Some(inner.over.index.text.as_str());
                self.repeat(cx, name, &over, &mut |this, cx, _| {
                    inner.body.iter().for_each(|statement| this.statement(cx, statement, site));
                });
            }
        }
    }

    /// A constraint between numbers, or one for each element of its vectors.
    fn constraint(&mut self, cx: &Context<'a>, constraint: &'a ast::Constraint, site: &Site) {
        let Some(shape) = self.sides(cx, &constraint.relation.sides()) else { return };
        if shape.is_number() {
            return self.element_constraint(cx, constraint, site, &[]);
        }
        self.for_elements(cx, shape.axes(), &[], &mut |this, cx, at| {
            this.element_constraint(cx, constraint, site, at);
        });
    }

    fn element_constraint(&mut self, cx: &Context<'a>, constraint: &'a ast::Constraint, site: &Site, at: &[Form]) {
        self.event = None;
        // Elements of an open index share one formula, and its text.
        self.element_axes = if at.iter().all(|form| form.as_number().is_some()) { at.len() } else { 0 };
        let bodies = self.relation(cx, &constraint.relation, site, at);
        let event = self.event.take();
        match site.block {
            Block::Trajectory => {
                self.event = event;
                self.no_event(constraint.span, "this constraint holds at every point of the trajectory");
            }
            // A boundary value or integral beside values at the end itself: a constraint of the mission.
            Block::Initial | Block::Final if event.as_ref().is_some_and(|mark| !mark.is_time) => {
                let mission = if cx.point == Point::Start { Point::MissionStart } else { Point::MissionEnd };
                let moved = cx.at(mission);
                let bodies = self.relation(&moved, &constraint.relation, site, at);
                self.event = None;
                return self.push_all(&moved, constraint, site, bodies);
            }
            _ => {}
        }
        self.push_all(cx, constraint, site, bodies);
    }

    /// The bodies with their bounds that a relation demands.
    fn relation(&mut self, cx: &Context<'a>, relation: &'a Relation, site: &Site, at: &[Form]) -> Vec<Body> {
        let place = if site.block == Block::Temporal { Use::Temporal } else { Use::Point };
        let value = |this: &mut Self, expr: &'a Expr| this.usable_side(cx, expr, at, place);
        match relation {
            Relation::Compare { left, comparison, right, .. } => {
                let (left, right) = (value(self, left), value(self, right));
                let (Some(left), Some(right)) = (left, right) else { return vec![] };
                self.compare(*comparison, &left, &right).into_iter().collect()
            }
            Relation::Between { first, comparison, middle, last } => {
                let (first, middle, last) = (value(self, first), value(self, middle), value(self, last));
                let (Some(first), Some(middle), Some(last)) = (first, middle, last) else { return vec![] };
                match comparison {
                    Comparison::AtLeast => self.within(Some(&last), &middle, Some(&first)),
                    _ => self.within(Some(&first), &middle, Some(&last)),
                }
            }
            Relation::In { value: body, bounds } => {
                let body = value(self, body);
                let lower = bounds.lower.as_ref().map(|end| value(self, end));
                let upper = bounds.upper.as_ref().map(|end| value(self, end));
                let (Some(body), false) = (body, matches!(lower, Some(None)) || matches!(upper, Some(None))) else {
                    return vec![];
                };
                self.within(lower.flatten().as_ref(), &body, upper.flatten().as_ref())
            }
        }
    }

    fn compare(&mut self, comparison: Comparison, left: &Value, right: &Value) -> Option<Body> {
        if self.clash("compare", left, right) {
            return None;
        }
        self.decided(comparison, left, right);
        self.note_bare_angle(left, right);
        let (a, b) = (self.kinds(left.node).is_fixed(), self.kinds(right.node).is_fixed());
        // The side that changes is the body; a difference where both do.
        let (body, bound, swapped) = match (a, b) {
            (_, true) => (left.clone(), right.node, false),
            (true, false) => (right.clone(), left.node, true),
            (false, false) => {
                let node = self.problem.dag.sub(left.node, right.node);
                let zero = self.problem.dag.constant(0.0);
                (Value { node, ..left.clone() }, zero, false)
            }
        };
        let mut bounds = match (comparison, swapped) {
            (Comparison::Equal, _) => Bounds { lower: Some(bound), upper: Some(bound) },
            (Comparison::AtMost, false) | (Comparison::AtLeast, true) => Bounds { lower: None, upper: Some(bound) },
            (Comparison::AtLeast, false) | (Comparison::AtMost, true) => Bounds { lower: Some(bound), upper: None },
        };
        let unit = self.shown(&[&body, left, right]);
        // Equations of motion are sums of 0 as they are written, and limits by something else differences.
        let is_limit = comparison != Comparison::Equal && (a || b);
        let body = if is_limit { self.limited(body, &mut bounds) } else { body };
        Some(Body { value: body, bounds, unit })
    }

    /// `lower <= body <= upper`; two constraints where a bound changes along the way.
    fn within(&mut self, lower: Option<&Value>, body: &Value, upper: Option<&Value>) -> Vec<Body> {
        let bodies = self.bounded(lower, body, upper);
        if !bodies.is_empty() {
            [lower, upper].into_iter().flatten().for_each(|bound| self.note_bare_angle(body, bound));
        }
        bodies
    }

    /// The same without a word on bare numbers beside angles.
    pub(super) fn bounded(&mut self, lower: Option<&Value>, body: &Value, upper: Option<&Value>) -> Vec<Body> {
        if self.misfit(lower, body, upper) {
            return vec![];
        }
        let fixed = [lower, upper].into_iter().flatten().all(|end| self.kinds(end.node).is_fixed());
        if !fixed || self.kinds(body.node).is_fixed() {
            let above = lower.and_then(|lower| self.compare(Comparison::AtMost, lower, body));
            let below = upper.and_then(|upper| self.compare(Comparison::AtMost, body, upper));
            return above.into_iter().chain(below).collect();
        }
        let sides: Vec<&Value> = [Some(body), lower, upper].into_iter().flatten().collect();
        let unit = self.shown(&sides);
        let mut bounds = Bounds { lower: lower.map(|v| v.node), upper: upper.map(|v| v.node) };
        if let (Some(lower), Some(upper)) = (lower, upper) {
            self.crossing(&bounds, lower.span.to(upper.span));
        }
        let body = self.limited(body.clone(), &mut bounds);
        vec![Body { value: body, bounds, unit }]
    }

    /// Tells when bounds have another dimension than what they bound: once for a range `lo .. hi`, whose unit is
    /// that of both ends.
    fn misfit(&mut self, lower: Option<&Value>, body: &Value, upper: Option<&Value>) -> bool {
        if let (Some(lower), Some(upper)) = (lower, upper)
            && lower.dimension == upper.dimension
            && lower.span.start >= body.span.end
        {
            let bare = upper.dimension == Some(Dimension::NONE);
            let span = if bare { upper.span } else { lower.span.to(upper.span) };
            return self.clash("compare", body, &Value { span, ..upper.clone() });
        }
        let below = lower.is_some_and(|lower| self.clash("compare", lower, body));
        let above = upper.is_some_and(|upper| self.clash("compare", body, upper));
        below || above
    }

    /// Tells when both sides are constants.
    fn decided(&mut self, comparison: Comparison, left: &Value, right: &Value) {
        let known = |value: &Value| self.problem.dag.is_constant(value.node);
        let (Some(a), Some(b)) = (known(left), known(right)) else { return };
        let span = left.span.to(right.span);
        let holds = match comparison {
            Comparison::Equal => a == b,
            Comparison::AtMost => a <= b,
            Comparison::AtLeast => a >= b,
        };
        if holds {
            let finding =
                Diagnostic::new(Code::AlwaysHolds, span, "this constraint always holds: both sides are constants");
            self.report(finding.help("remove it, or check which name was meant"));
        } else {
            let finding =
                Diagnostic::new(Code::NeverHolds, span, "this constraint can never hold: both sides are constants");
            self.report(finding.help("check the signs and units of both sides"));
        }
    }

    fn push_all(&mut self, cx: &Context<'a>, constraint: &'a ast::Constraint, site: &Site, bodies: Vec<Body>) {
        // Those of a constant are decided, and told.
        let is_open = |body: &Body| self.problem.dag.is_constant(body.value.node).is_none();
        let bodies: Vec<Body> = bodies.into_iter().filter(is_open).collect();
        let domain = match self.domain(cx) {
            Domain::Path(phase, _) => Domain::Path(phase, site.part),
            other => other,
        };
        if let Some(softness) = &constraint.softness {
            return self.push_soft(cx, constraint, softness, (site, domain, bodies));
        }
        self.note_soft_name(constraint);
        let posed = bodies.into_iter().flat_map(|Body { value, mut bounds, unit }| {
            let is_equation = bounds.lower.is_some() && bounds.lower == bounds.upper;
            let value = if is_equation { self.limited(value, &mut bounds) } else { value };
            self.regular(Body { value, bounds, unit })
        });
        let bodies: Vec<Body> = posed.collect();
        for Body { value: body, bounds, unit } in bodies {
            let name = self.constraint_name(cx, constraint, site);
            self.origin(body.node, constraint.span);
            self.problem.constraints.push(Constraint {
                name,
                span: constraint.span,
                block: site.block,
                unit,
                loops: (*cx.loops).clone(),
                sides: 0,
                written: None,
                domain: domain.clone(),
                imposed: Imposed::Everywhere,
                body: body.node,
                bounds,
            });
        }
    }

    /// The name of a constraint with its path and the members that are made one by one; without a name, the text of such
    /// a member.
    pub(super) fn constraint_name(
        &mut self,
        cx: &Context<'a>,
        constraint: &'a ast::Constraint,
        site: &Site,
    ) -> Option<String> {
        let member = member_text(&cx.members);
        match (&constraint.name, site.agent) {
            (Some(name), Some(agent)) => Some(self.path_name(agent, site.phase, &name.text) + &member),
            (Some(name), None) => Some(name.text.clone() + &member),
            (None, _) => self.element_words(cx, constraint),
        }
    }

    /// Where an expression elaborated in a context lives.
    pub(super) fn domain(&self, cx: &Context<'a>) -> Domain {
        let phase = self.scopes[cx.scope].phase.map(|phase| cx.phase_at(phase));
        match (cx.point, phase) {
            (Point::Path, Some(phase)) => Domain::Path(phase, Part::WHOLE),
            (Point::Start, Some(phase)) => Domain::Start(phase),
            (Point::End, Some(phase)) => Domain::End(phase),
            _ => Domain::Mission,
        }
    }
}
