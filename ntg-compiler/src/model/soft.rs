//! Constraints that may be missed at a price: `soft(w): c`, `soft(square = w): c`.
//!
//! Takes the bodies `lo <= g <= hi` of such a constraint, adds what it is missed by, `s >= 0`: an output along the way,
//! a variable elsewhere; the rows `g + s >= lo` and `g - s <= hi`; and the price, `w s` or `w s^2`, as a term of the
//! objective, along the way integrated. Along the way `s` has a value at each point of the quadrature, and its rows stand at
//! these points alone, as those of a helper do (docs/maths.md, section 18).
//! Finds: prices of another unit than the objective's, prices that are not positive.

use ntg_structure::{Spline, Unit};

use super::constraints::{Body, Site};
use super::dimension::Dimension;
use super::elaborator::Elaborator;
use super::problem::{
    At, Bounds, Collocation, Constraint, Domain, Form, Imposed, Instant, Leaf, Loop, Output, Part, PhaseAt, Term,
    Variable,
};
use super::scope::{Allow, Context, Point};
use super::settle::Use;
use super::shape::Ends;
use super::units;
use super::value::OpenIndex;
use crate::diagnostic::{Code, Diagnostic};
use crate::expr::NodeId;
use crate::source::Span;
use crate::syntax::ast::{self, Expr, Softness};

/// By how much constraints of one statement are missed.
pub(super) struct Slack {
    /// Where the statement stands, in which phase (none: a variable), and the members that are made one by one.
    key: (Span, Option<usize>, Vec<i64>),
    /// Where the loops over the other members begin: parts of a range have slacks of their own.
    firsts: Vec<Option<i64>>,
    /// Index into the outputs of the phase, or into the variables.
    place: usize,
    /// Index into the terms of the objective: its price.
    term: usize,
    name: String,
}

/// The loops around a constraint for which it is missed by an amount of its own.
pub(super) struct Members {
    loops: Vec<Loop>,
    /// How many there are, and which one is meant inside the loops; none without loops.
    pub(super) family: Option<(i64, Form)>,
}

/// The prices of missing a constraint: for the amount, and for its square.
struct Prices {
    linear: Option<NodeId>,
    square: Option<NodeId>,
    /// By how much it is missed along the way as it is written, where one formula says so.
    written: Option<NodeId>,
}

impl<'a> Elaborator<'a> {
    /// Notes a constraint that has the name `soft` and no price.
    pub(super) fn note_soft_name(&mut self, constraint: &ast::Constraint) {
        if let Some(name) = constraint.name.as_ref().filter(|name| name.text == "soft") {
            let note = Diagnostic::new(Code::SoftName, name.span, "this constraint is named `soft`, and must hold");
            self.report(note.help("a constraint that may be missed has a price: `soft(200 [1/s]): x <= 1;`"));
        }
    }

    /// The rows of a soft constraint.
    pub(super) fn push_soft(
        &mut self,
        cx: &Context<'a>,
        constraint: &'a ast::Constraint,
        softness: &'a Softness,
        (site, domain, bodies): (&Site, Domain, Vec<Body>),
    ) {
        let Some(first) = bodies.first() else { return };
        let (unit, dimension) = (first.unit.clone(), first.value.dimension_or_none());
        let phase = match &domain {
            Domain::Path(at, _) => Some(at.phase),
            _ => None,
        };
        // The members of a phase each have the output of their own.
        let is_family = |over: &&Loop| {
            let forms = cx.agent.iter().chain(&cx.phase);
            forms.flat_map(|form| &form.terms).any(|(index, _)| *index == over.index)
        };
        let outer = if phase.is_some() { cx.loops.iter().take_while(is_family).count() } else { 0 };
        let Some(members) = self.members_missed(&cx.loops[outer.min(cx.loops.len())..], constraint.span) else {
            return;
        };
        let mut indices = (*cx.members).clone();
        if phase.is_none() {
            indices.extend(cx.phase.iter().chain(&cx.agent).filter_map(Form::as_number));
        }
        let key = (constraint.span, phase, indices);
        let firsts: Vec<Option<i64>> = members.loops.iter().map(|over| over.first.as_number()).collect();
        let place = match self.slacks.iter().find(|slack| slack.key == key && slack.firsts == firsts) {
            Some(slack) => {
                // It is missed in several parts or members: no one formula is that of all.
                self.problem.objective[slack.term].written = None;
                slack.place
            }
            None => {
                let Some(mut prices) = self.prices(cx, softness, dimension, phase.is_some()) else { return };
                prices.written = self.missed_as_written(cx, &domain, &bodies);
                let name = self.slack_name(constraint, &key, &firsts);
                let place = match phase {
                    Some(phase) => self.missed_along((phase, dimension, unit), &members, (&name, constraint), &prices),
                    None => self.missed_once(cx, (site, unit), &members, (&name, constraint), &prices),
                };
                let term = self.problem.objective.len() - 1;
                self.slacks.push(Slack { key, firsts, place, term, name });
                place
            }
        };
        let index = members.family.map(|(_, member)| member);
        let missed = match phase {
            Some(phase) => {
                self.leaf(Leaf::Flat { phase: cx.phase_at(phase), at: At::Here, output: place, index, order: 0 })
            }
            None => self.leaf(Leaf::Variable { variable: place, index }),
        };
        let imposed = if phase.is_some() { Imposed::AtIntegrands } else { Imposed::Everywhere };
        for body in bodies {
            let Bounds { lower, upper } = body.bounds;
            let dag = &mut self.problem.dag;
            // What is missed as it is written leaves the bound.
            let above = lower.map(|lower| {
                let (node, written) = (dag.add(body.value.node, missed), dag.max(body.value.node, lower));
                (node, written, Bounds { lower: Some(lower), upper: None })
            });
            let below = upper.map(|upper| {
                let (node, written) = (dag.sub(body.value.node, missed), dag.min(body.value.node, upper));
                (node, written, Bounds { lower: None, upper: Some(upper) })
            });
            for (node, written, bounds) in above.into_iter().chain(below) {
                let name = self.constraint_name(cx, constraint, site);
                self.origin(node, constraint.span);
                self.problem.constraints.push(Constraint {
                    name,
                    span: constraint.span,
                    block: site.block,
                    unit: body.unit.clone(),
                    loops: (*cx.loops).clone(),
                    sides: 0,
                    written: phase.map(|_| written),
                    domain: domain.clone(),
                    imposed: imposed.clone(),
                    body: node,
                    bounds,
                });
            }
        }
    }

    /// The members of loops, counted from 1; none where an index must be known first.
    pub(super) fn members_missed(&mut self, loops: &[Loop], span: Span) -> Option<Members> {
        let mut count: i64 = 1;
        let mut member = Form::number(0);
        for over in loops {
            let (Some(first), Some(last)) = (over.first.as_number(), over.last.as_number()) else {
                let (index, _) = over.first.terms.iter().chain(&over.last.terms).next()?;
                self.opened = Some(OpenIndex { index: *index, cut: None, span });
                return None;
            };
            let extent = (last - first + 1).max(0);
            count = count.saturating_mul(extent);
            let own = Form::index(over.index).plus(-1, &Form::number(first))?;
            member = own.plus(extent, &member)?;
        }
        let member = member.plus(1, &Form::number(1))?;
        let family = (!loops.is_empty()).then_some((count, member));
        (count > 0).then(|| Members { loops: loops.to_vec(), family })
    }

    /// A name for what is missed that nothing else has; phases of an agent share it.
    fn slack_name(
        &self,
        constraint: &ast::Constraint,
        (span, _, members): &(Span, Option<usize>, Vec<i64>),
        firsts: &[Option<i64>],
    ) -> String {
        let same = |slack: &&Slack| slack.key.0 == *span && slack.key.2 == *members && slack.firsts == firsts;
        if let Some(known) = self.slacks.iter().find(same) {
            return known.name.clone();
        }
        let mut name = match &constraint.name {
            Some(name) => format!("{}_miss", name.text),
            None => "miss".to_owned(),
        };
        members.iter().for_each(|member| name += &format!("_{}", member.unsigned_abs()));
        let taken = |name: &str| {
            self.slacks.iter().any(|slack| slack.name == name)
                || self.scopes.iter().any(|scope| scope.names.contains_key(name))
        };
        let numbered = (2..).map(|k: usize| format!("{name}_{k}"));
        let mut names = std::iter::once(name.clone()).chain(numbered);
        names.find(|name| !taken(name)).unwrap_or(name)
    }

    /// An output that is not negative, with the integral of its price; gives its place among the outputs.
    fn missed_along(
        &mut self,
        (phase, dimension, unit): (usize, Dimension, Unit),
        members: &Members,
        (name, constraint): (&str, &'a ast::Constraint),
        prices: &Prices,
    ) -> usize {
        let family = members.family.as_ref().map(|(count, _)| (1, *count));
        let place = self.problem.phases[phase].outputs.len();
        let spline = self.slack_spline(phase, self.points_within(phase));
        let (doc, span) = (self.slack_doc(constraint), constraint.span);
        let output =
            Output { name: name.to_owned(), doc, unit: unit.clone(), family, grid: None, vector: None, spline, span };
        self.problem.phases[phase].outputs.push(output);
        self.output_axes[phase].push(family.iter().map(|(_, count)| Ends::to(*count)).collect());
        self.output_dimensions[phase].push(Some(dimension));

        let whole = self.phase_context(phase, Allow::All, Point::Path);
        let at = whole.phase_at(phase);
        let flat = |this: &mut Self, at: &PhaseAt, index: Option<Form>| {
            this.leaf(Leaf::Flat { phase: at.clone(), at: At::Here, output: place, index, order: 0 })
        };
        let mut loops = (*whole.loops).clone();
        let over = family.map(|(first, last)| self.new_index(Form::number(first), Form::number(last)));
        let body = flat(self, &at, over.as_ref().map(|over| Form::index(over.index)));
        loops.extend(over);
        let zero = self.problem.dag.constant(0.0);
        let amount = self.problem.dag.max(body, zero);
        self.origin(body, span);
        let agent = self.phases[phase].agent;
        self.problem.constraints.push(Constraint {
            name: Some(self.path_name(agent, Some(phase), name)),
            span,
            block: ntg_structure::Block::Trajectory,
            unit,
            loops,
            sides: 0,
            written: Some(amount),
            domain: Domain::Path(at.clone(), Part::WHOLE),
            imposed: Imposed::AtIntegrands,
            body,
            bounds: Bounds { lower: Some(zero), upper: None },
        });

        let missed = flat(self, &at, members.family.as_ref().map(|(_, member)| member.clone()));
        let mut priced = |missed: NodeId| {
            let squared = self.problem.dag.powi(missed, 2);
            let mut part = |price: Option<NodeId>, integrand: NodeId| {
                let total = self.leaf(Leaf::Integral { phase: at.clone(), integrand });
                price.map(|price| self.problem.dag.mul(price, total))
            };
            let parts = [part(prices.linear, missed), part(prices.square, squared)];
            parts.into_iter().flatten().collect::<Vec<NodeId>>()
        };
        let (parts, written) = (priced(missed), prices.written.map(&mut priced));
        let loops = whole.loops.iter().chain(&members.loops).cloned().collect();
        let label = constraint.name.as_ref().map(|name| self.path_name(agent, Some(phase), &name.text));
        self.price_term((label, span), loops, &parts, written);
        place
    }

    /// A variable that is not negative, with its price; gives its number.
    fn missed_once(
        &mut self,
        cx: &Context<'a>,
        (site, unit): (&Site, Unit),
        members: &Members,
        (name, constraint): (&str, &'a ast::Constraint),
        prices: &Prices,
    ) -> usize {
        let place = self.problem.variables.len();
        let zero = self.problem.dag.constant(0.0);
        let family = members.family.as_ref().map(|(count, _)| self.new_index(Form::number(1), Form::number(*count)));
        let (doc, span) = (self.slack_doc(constraint), constraint.span);
        let bounds = Bounds { lower: Some(zero), upper: None };
        self.problem.variables.push(Variable { name: name.to_owned(), doc, unit, family, grid: None, bounds, span });
        let index = members.family.as_ref().map(|(_, member)| member.clone());
        let missed = self.leaf(Leaf::Variable { variable: place, index });
        let linear = prices.linear.map(|price| self.problem.dag.mul(price, missed));
        let square = prices.square.map(|price| {
            let squared = self.problem.dag.powi(missed, 2);
            self.problem.dag.mul(price, squared)
        });
        let label = self.constraint_name(cx, constraint, site);
        let parts: Vec<NodeId> = linear.into_iter().chain(square).collect();
        self.price_term((label, span), (*cx.loops).clone(), &parts, None);
        place
    }

    fn price_term(
        &mut self,
        (name, span): (Option<String>, Span),
        loops: Vec<Loop>,
        parts: &[NodeId],
        written: Option<Vec<NodeId>>,
    ) {
        let body = self.problem.dag.sum(parts);
        self.origin(body, span);
        let written = written.map(|written| self.problem.dag.sum(&written));
        let unit = self.problem.objective_unit.clone();
        self.problem.objective.push(Term { name, span, unit, loops, body, written });
    }

    /// By how much bodies are missed along the way; none where that is a formula of some members of the phase alone.
    fn missed_as_written(&mut self, cx: &Context<'a>, domain: &Domain, bodies: &[Body]) -> Option<NodeId> {
        let Domain::Path(at, part) = domain else { return None };
        let whole = self.phase_context(at.phase, Allow::All, Point::Path).phase_at(at.phase);
        if cx.phase_at(at.phase) != whole {
            return None;
        }
        let dag = &mut self.problem.dag;
        let zero = dag.constant(0.0);
        let mut missed = zero;
        for body in bodies {
            let below = body.bounds.lower.map(|lower| dag.sub(lower, body.value.node));
            let above = body.bounds.upper.map(|upper| dag.sub(body.value.node, upper));
            for by in below.into_iter().chain(above) {
                missed = dag.max(missed, by);
            }
        }
        if part.from == Instant::START && part.to == Instant::END {
            return Some(missed);
        }
        let tau = self.leaf(Leaf::Tau);
        let dag = &mut self.problem.dag;
        let (from, to) = (dag.constant(part.from.tau()), dag.constant(part.to.tau()));
        let (is_after, is_before) = (dag.less_eq(from, tau), dag.less_eq(tau, to));
        let is_within = dag.mul(is_after, is_before);
        Some(dag.select(is_within, missed, zero))
    }

    fn slack_doc(&self, constraint: &ast::Constraint) -> String {
        match &constraint.name {
            Some(name) => format!("By how much `{}` is missed.", name.text),
            None => format!("By how much `{}` is missed.", self.text(constraint.span)),
        }
    }

    /// How many values in each interval a number has that is free at every point of the quadrature.
    pub(super) fn points_within(&self, phase: usize) -> usize {
        match self.problem.phases[phase].collocation {
            Collocation::Gauss { points, .. } => points,
            Collocation::Uniform { .. } => 2,
        }
    }

    /// A polynomial of an order in each interval, which may jump between them, or lines between equally spaced points.
    pub(super) fn slack_spline(&self, phase: usize, order: usize) -> Spline {
        match self.problem.phases[phase].collocation {
            Collocation::Gauss { .. } => {
                let outputs = &self.problem.phases[phase].outputs;
                let mut breakpoints: Vec<f64> = outputs
                    .iter()
                    .flat_map(|output| output.spline.breakpoints.iter().copied())
                    .chain([0.0, 1.0])
                    .collect();
                breakpoints.sort_by(f64::total_cmp);
                const SAME: f64 = 1e-12;
                breakpoints.dedup_by(|next, kept| (*next - *kept).abs() <= SAME);
                Spline { order, smoothness: 0, breakpoints }
            }
            Collocation::Uniform { points } => {
                let last = points.saturating_sub(1).max(1);
                let breakpoints = (0..=last).map(|k| k as f64 / last as f64).collect();
                Spline { order: 2, smoothness: 1, breakpoints }
            }
        }
    }

    /// The prices of missing something of a dimension; none where something is wrong with them.
    fn prices(&mut self, cx: &Context<'a>, softness: &'a Softness, of: Dimension, along: bool) -> Option<Prices> {
        let over = if along { of.times(&self.time) } else { of };
        let linear = match &softness.linear {
            Some(price) => Some(self.price(cx, price, &over)?),
            None => None,
        };
        let square = match &softness.square {
            Some(price) => Some(self.price(cx, price, &over.times(&of))?),
            None => None,
        };
        Some(Prices { linear, square, written: None })
    }

    /// A price whose product with something of dimension `of` has the dimension of the objective.
    fn price(&mut self, cx: &Context<'a>, price: &'a Expr, of: &Dimension) -> Option<NodeId> {
        let value = self.usable(&cx.at(Point::Nowhere).allowing(Allow::Parameters), price, Use::Bound("a price"))?;
        let own = value.dimension_or_none();
        let objective = *self.objective_dimension.get_or_insert_with(|| own.times(of));
        if self.problem.objective.is_empty() {
            self.problem.objective_unit = units::si(&objective);
        }
        let wanted = objective.over(of);
        if value.dimension.is_some_and(|dimension| dimension != wanted) {
            let unit = if wanted.is_none() { "1".to_owned() } else { wanted.to_string() };
            let (this, total) = (own.describe(), objective.describe());
            let message = format!("a price in [{unit}] is needed here, this is {this}");
            let finding = Diagnostic::new(Code::DimensionMismatch, price.span, message);
            let text = self.text(price.span);
            let help = match text.parse::<f64>() {
                Ok(_) => format!("write `{text} [{unit}]`: the objective is {total}"),
                Err(_) => format!("what is missed, times its price, is a part of the objective, which is {total}"),
            };
            self.report(finding.help(help));
            return None;
        }
        if self.problem.dag.is_constant(value.node).is_some_and(|price| price <= 0.0) {
            let finding = Diagnostic::new(Code::Setting, price.span, "a price is greater than 0");
            self.report(finding.help("write a positive price; remove a constraint that costs nothing"));
            return None;
        }
        Some(value.node)
    }
}
